#include "side.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../engines.h"

bool view_side_is_there(const ViewSide *side)
{
    return side->play.group != NULL;
}

RefElastic *view_side_elastic(const ViewSide *side)
{
    if (!view_side_is_there(side)) return NULL;
    const BenchRunner *runner = &side->play.group[0].runner; /* such a body is alone */
    return runner->type == &ref_meshless_engine ? ref_meshless_elastic(runner->engine) : NULL;
}

RefShellBody *view_side_shell(const ViewSide *side)
{
    if (!view_side_is_there(side)) return NULL;
    const BenchRunner *runner = &side->play.group[0].runner;
    return runner->type == &ref_shell_engine ? ref_shell_body(runner->engine) : NULL;
}

/* The scene as this engine can play it. */
static void suit(BenchScene *scene, const BenchEngine *engine)
{
    bool sampled = bench_engine(scene->engine)->sampled;
    const SmEngineType *type = engine->type[0];
    if (!type->refines) scene->touch_count = scene->view.level = 0;
    if (!type->get_shapes) scene->octree.creep = 0;
    if (type->refines || !type->cut) scene->params.strain_limit = 0;
    if (engine->sampled && !sampled) /* regions as wide as its cells; its own way to sum */
        engine->set_width(scene, 1, scene->octree.epsilon, false);
    strcpy(scene->engine, type->name);
}

void view_side_create(const BenchScene *scene, const BenchBody *body, const char *engine,
                      const ViewAllowed *allowed, ViewSide *side)
{
    static const ViewAllowed nothing;
    const SmEngineType *type = bench_engine(engine)->type[0];
    double start = sm_now();
    *side = (ViewSide){.scene = *scene};
    suit(&side->scene, bench_engine(engine));
    BenchScene plain = side->scene;
    view_tools_add(&side->scene, allowed, type->refines, &side->tools);
    SmCode code = bench_playback_create(&side->scene, body, type, 1, 1, &side->play, &side->absent);
    if (code && (side->tools.blade >= 0 || side->tools.fingers > 0)) { /* perhaps without them */
        side->scene = plain;
        view_tools_add(&side->scene, &nothing, false, &side->tools);
        code = bench_playback_create(&side->scene, body, type, 1, 1, &side->play, &side->absent);
    }
    if (code) return;
    side->absent = (SmError){0};
    view_grips_create(&side->play, &side->grips);
    side->build_seconds = sm_now() - start;
    view_side_draw(side);
}

void view_side_push_as(ViewSide *side, const ViewSide *own)
{
    if (!view_side_is_there(side) || !view_side_is_there(own)) return;
    const long *wanted = own->play.group[0].runner.push_first;
    for (int i = 0; i < side->scene.force_count; i++) {
        const long *pushed = side->play.group[0].runner.push_first;
        double share = (double)wanted[i] / (double)pushed[i];
        for (int d = 0; d < 3; d++) side->scene.force[i].force[d] *= share;
        for (int g = 0; g < side->play.count; g++) {
            BenchRunner *runner = &side->play.group[g].runner;
            for (long n = 0; n < runner->push_count[i]; n++)
                for (int d = 0; d < 3; d++) runner->push_impulse[i][n][d] *= share;
        }
    }
}

/* What is drawn and belongs to one structure of the surface. */
static void free_surface(ViewSide *side)
{
    sm_free_all(side->place, side->normal, side->point32, side->normal32, side->index);
    side->vertices = side->triangles = 0;
    side->place = side->normal = NULL;
    side->point32 = side->normal32 = NULL;
    side->index = NULL;
}

void view_side_free(ViewSide *side)
{
    view_grips_free(&side->grips);
    free_surface(side);
    bench_playback_free(&side->play);
    *side = (ViewSide){0};
}

bool view_side_is_whole(const ViewSide *side)
{
    for (int g = 0; view_side_is_there(side) && g < side->play.count; g++) {
        SmCounts counts;
        const BenchGroup *group = &side->play.group[g];
        group->runner.type->count(group->runner.engine, &counts);
        if (counts.broken > 0 || sm_skin_cut_triangles(&group->skin) > 0) return false;
    }
    return true;
}

/* Of an elastic body its nodes, of a shell the numbers of its state; 0: they are no such, or that
 * cannot be told. */
static long own_size(const ViewSide *side)
{
    const RefElastic *elastic = view_side_elastic(side);
    if (elastic) return elastic->motion.nodes;
    if (!view_side_shell(side)) return 0;
    return ref_shell_engine.get_state(side->play.group[0].runner.engine, NULL);
}

bool view_side_is_like(const ViewSide *side, const ViewSide *other)
{
    if (view_side_is_there(side) != view_side_is_there(other)) return false;
    if (side->scene.instances != other->scene.instances) return false;
    if (strcmp(side->scene.engine, other->scene.engine) != 0) return false;
    if (own_size(side) != own_size(other)) return false;
    if (view_side_shell(side) && own_size(side) == 0) return false;
    const ViewSide *both[] = {side, other};
    for (int s = 0; s < 2; s++) /* bodies at rest are all alike */
        for (int g = 0; g < both[s]->play.count; g++)
            if (both[s]->play.group[g].runner.count != side->play.group[0].runner.count)
                return false;
    return true;
}

/* A field of all particles, body after body as the scene numbers them, from the engines or to them:
 * the same bodies may be grouped otherwise. */
static void exchange(const BenchGroup *group, SmField field, bool set, double (*all)[3])
{
    const BenchRunner *runner = &group->runner;
    double(*value)[3] = sm_alloc((size_t)runner->particles, sizeof *value);
    if (!set) runner->type->get(runner->engine, field, value);
    for (long k = 0; k < group->body.instances; k++) {
        double(*own)[3] = value + k * runner->count;
        double(*body)[3] = all + group->instance[k] * runner->count;
        memcpy(set ? own : body, set ? body : own, (size_t)runner->count * sizeof *own);
    }
    if (set) runner->type->set(runner->engine, field, (const double(*)[3])value);
    free(value);
}

static void copy_field(ViewSide *side, const ViewSide *from, SmField field)
{
    double(*all)[3] = sm_alloc((size_t)bench_playback_particles(&from->play), sizeof *all);
    for (int g = 0; g < from->play.count; g++) exchange(&from->play.group[g], field, false, all);
    for (int g = 0; g < side->play.count; g++) exchange(&side->play.group[g], field, true, all);
    free(all);
}

static void copy_state(SmEngine *shell, SmEngine *from, long size)
{
    double *state = sm_alloc((size_t)size, sizeof *state);
    ref_shell_engine.get_state(from, state);
    ref_shell_engine.set_state(shell, state);
    free(state);
}

void view_side_go_on(ViewSide *side, const ViewSide *from)
{
    assert(view_side_is_like(side, from));
    if (!view_side_is_there(side)) return;
    SmEngine *engine = side->play.group[0].runner.engine,
             *before = from->play.group[0].runner.engine;
    if (view_side_elastic(side)) {
        ref_meshless_go_on(engine, before);
    } else if (view_side_shell(side)) {
        copy_state(engine, before, own_size(side));
    } else {
        copy_field(side, from, SM_POSITION);
        copy_field(side, from, SM_VELOCITY);
    }
    for (int g = 0; g < side->play.count; g++) side->play.group[g].runner.time = from->play.time;
    side->play.time = from->play.time;
    side->steps = from->steps;
    memcpy(side->grips.followed, from->grips.followed, sizeof side->grips.followed);
}

/* ---- steps */

/* After a change of the body: particles that are split or merged have other numbers, and what is
 * held is found again. */
static void follow_change(ViewSide *side, const ViewHand *hand)
{
    if (view_grips_are_lost(&side->grips, &side->play))
        view_grips_hold(&side->grips, &side->play, hand, true);
    if (bench_playback_split(&side->play)) free_surface(side);
}

/* What the scene does before the steps of a frame. What cannot be done is left. */
static void change(ViewSide *side, const ViewHand *hand)
{
    SmError left;
    if (!bench_playback_changes(&side->play)) return;
    bench_playback_change(&side->play, &left);
    follow_change(side, hand);
}

bool view_side_cut(ViewSide *side, const double a[3], const double b[3], const ViewHand *hand)
{
    const long most = 100000; /* that cuts may have added: then each takes seconds */
    long vertices, triangles;
    bench_playback_size(&side->play, &vertices, &triangles);
    if (side->tools.blade < 0 || triangles - side->play.body->mesh.triangle_count > most)
        return false;
    view_tools_cut(&side->tools, &side->scene, &side->play, a, b);
    follow_change(side, hand);
    return true;
}

/* One step, whose laps are taken unless NULL; what is held goes `share` of its way to the hand. */
static void step(ViewSide *side, const ViewHand *hand, double share, SmLaps *laps)
{
    if (side->steps++ % side->scene.steps_per_frame == 0) change(side, hand);
    view_grips_follow(&side->grips, hand, share);
    bench_playback_prepare(&side->play);
    view_tools_blow(&side->tools, &side->play);
    sm_lap(laps, SM_OTHER);
    bench_playback_advance(&side->play, laps);
}

void view_side_step(ViewSide *side, int steps, const ViewHand *hand)
{
    const long sampled = 3; /* one of so many, odd for what goes on in every second: clocks cost */
    if (!view_side_is_there(side)) return;
    for (int i = 0; i < steps; i++) {
        SmLaps laps;
        bool timed = side->untimed-- == 0;
        if (timed) sm_laps_start(&laps);
        step(side, hand, 1.0 / (steps - i), timed ? &laps : NULL);
        if (!timed) continue;
        side->untimed = sampled - 1;
        side->timed++;
        for (int s = 0; s < SM_STAGES; s++) {
            side->lap[s] += laps.seconds[s];
            side->laps[s] += laps.count[s];
        }
    }
}

void view_side_motion(const ViewSide *side, double *energy, double *momentum)
{
    double sum[3] = {0};
    *energy = *momentum = 0;
    for (int g = 0; view_side_is_there(side) && g < side->play.count; g++) {
        const BenchRunner *runner = &side->play.group[g].runner;
        double *mass = sm_alloc((size_t)runner->count, sizeof *mass);
        double(*v)[3] = sm_alloc((size_t)runner->particles, sizeof *v);
        runner->type->masses(runner->engine, mass);
        runner->type->get(runner->engine, SM_VELOCITY, v);
        for (long p = 0; p < runner->particles; p++)
            for (int d = 0; d < 3; d++) {
                *energy += mass[p % runner->count] / 2 * v[p][d] * v[p][d];
                sum[d] += mass[p % runner->count] * v[p][d];
            }
        free(mass);
        free(v);
    }
    *momentum = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
}

/* ---- the surface */

/* What triangles hang together, and of a shell that is drawn as two sheets both: the inner one's
 * vertices follow the outer one's. */
static void count_pieces(ViewSide *side)
{
    long sheet = side->play.group[0].skin.drawn ? side->vertices / 2 : 0;
    unsigned char *absent = sm_alloc((size_t)side->vertices, 1);
    SmPieces pieces;
    sm_pieces_init(side->vertices, &pieces);
    memset(absent, 1, (size_t)side->vertices);
    for (long c = 0; c < 3 * side->triangles; c++) {
        sm_pieces_link(&pieces, side->index[c], side->index[c - c % 3]);
        absent[side->index[c]] = 0;
    }
    for (long v = 0; v < sheet; v++) sm_pieces_link(&pieces, v, v + sheet);
    sm_pieces_finish(&pieces, absent, side->vertices);
    side->pieces = pieces.count;
    sm_pieces_free(&pieces);
    free(absent);
}

static void make_surface(ViewSide *side)
{
    static int made; /* of any side */
    SmMesh mesh = bench_playback_surface(&side->play);
    size_t vertices = (size_t)mesh.vertex_count, triangles = (size_t)mesh.triangle_count;
    free_surface(side);
    side->generation = ++made;
    side->vertices = mesh.vertex_count;
    side->triangles = mesh.triangle_count;
    side->place = sm_alloc(vertices, sizeof *side->place);
    side->normal = sm_alloc(vertices, sizeof *side->normal);
    side->point32 = sm_alloc(3 * vertices, sizeof *side->point32);
    side->normal32 = sm_alloc(3 * vertices, sizeof *side->normal32);
    side->index = sm_alloc(3 * triangles, sizeof *side->index);
    memcpy(side->index, mesh.triangle, triangles * sizeof *mesh.triangle);
    if (view_side_shell(side)) count_pieces(side);
    sm_mesh_free(&mesh);
}

void view_side_draw(ViewSide *side)
{
    if (!view_side_is_there(side)) return;
    if (!side->index) make_surface(side);
    long first = 0;
    for (int g = 0; g < side->play.count; g++) {
        BenchGroup *group = &side->play.group[g];
        sm_skin_points(&group->skin, NULL, side->place + first, side->normal + first);
        first += group->body.instances * group->skin.surface.vertex_count;
    }
    for (long v = 0; v < side->vertices; v++)
        for (int d = 0; d < 3; d++) {
            side->point32[3 * v + d] = (float)side->place[v][d];
            side->normal32[3 * v + d] = (float)side->normal[v][d];
        }
}

bool view_side_vertex(const ViewSide *side, long vertex, long *instance, double rest[3])
{
    for (int g = 0; view_side_is_there(side) && g < side->play.count && vertex >= 0; g++) {
        const BenchGroup *group = &side->play.group[g];
        long each = group->skin.surface.vertex_count, all = each * group->body.instances;
        if (vertex < all) {
            *instance = group->instance[vertex / each];
            memcpy(rest, group->skin.surface.position[vertex % each], sizeof(double[3]));
            return true;
        }
        vertex -= all;
    }
    return false;
}
