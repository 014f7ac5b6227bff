#include "view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/paper.h"
#include "../engines.h"
#include "../scene/builtin.h"
#include "given.h"
#include "side.h"
#include "stored_bodies.h"

static struct {
    char *text; /* the room for it */
    char message[600];
    BenchBody *body;
    ViewSide *side[VIEW_SIDES];
    ViewHand hand[VIEW_HANDS];
    ViewAllowed allowed;
    double wind[3];
    double bounds[6], middle[3], obstacle[8];
} view;

const char *view_scene_name(int number)
{
    static BenchScene scene;
    static const char *name[BENCH_MAX];
    static int count, seen;
    for (; bench_builtin[seen].name && count < BENCH_MAX; seen++) {
        const char *text = bench_builtin[seen].text; /* perhaps of an engine that is not here */
        if (!bench_scene_parse(text, strlen(text), "scene", &scene, NULL))
            name[count++] = bench_builtin[seen].name;
    }
    return number >= 0 && number < count ? name[number] : NULL;
}

const char *view_scene_text(const char *name)
{
    return bench_scene_text(name, NULL);
}

char *view_room(int bytes)
{
    free(view.text);
    return view.text = sm_alloc((size_t)bytes + 1, 1);
}

char *view_text(void)
{
    return view.text;
}

const char *view_message(void)
{
    return view.message;
}

static int refuse(const SmError *error)
{
    snprintf(view.message, sizeof view.message, "%s", error->text);
    return error->code;
}

/* Box of everything that is drawn of both sides now. */
static void find_bounds(void)
{
    for (int d = 0; d < 3; d++) view.bounds[d] = INFINITY, view.bounds[3 + d] = -INFINITY;
    for (int s = 0; s < VIEW_SIDES; s++)
        for (long v = 0; v < view.side[s]->vertices; v++)
            for (int d = 0; d < 3; d++) {
                double x = view.side[s]->place[v][d];
                view.bounds[d] = fmin(view.bounds[d], x);
                view.bounds[3 + d] = fmax(view.bounds[3 + d], x);
            }
}

static void close_sides(ViewSide *side[VIEW_SIDES], BenchBody *body)
{
    for (int s = 0; s < VIEW_SIDES; s++) {
        if (side[s]) view_side_free(side[s]);
        free(side[s]);
    }
    if (body) bench_body_free(body);
    free(body);
}

/* Is it the same body that was open, in as many places? */
static bool is_same(const BenchBody *body)
{
    return view.body && body->hash == view.body->hash && body->instances == view.body->instances;
}

/* Goes on where another side is, unless that is NULL, held by what hands hold. An elastic body
 * moves by what holds it, too: it goes on again once it is held. */
static void take_over(ViewSide *side, const ViewSide *from)
{
    if (from) view_side_go_on(side, from);
    if (!view_side_is_there(side)) return;
    view_grips_hold(&side->grips, &side->play, view.hand, true);
    if (!from || !view_side_elastic(side)) return;
    view_side_go_on(side, from);
    view_grips_hold(&side->grips, &side->play, view.hand, true);
}

/* Takes the place of what was open. Motion goes on only where both sides' does. */
static void replace(ViewSide *side[VIEW_SIDES], BenchBody *body, bool keep)
{
    bool same = keep && is_same(body), on = same;
    for (int s = 0; s < VIEW_SIDES && on; s++)
        on = view_side_is_like(side[s], view.side[s]) && view_side_is_whole(view.side[s]);
    if (!same) memset(view.hand, 0, sizeof view.hand);
    for (int s = 0; s < VIEW_SIDES; s++) take_over(side[s], on ? view.side[s] : NULL);
    close_sides(view.side, view.body);
    memcpy(view.side, side, sizeof view.side);
    view.body = body;
    for (int s = 0; s < VIEW_SIDES; s++) {
        memcpy(side[s]->tools.wind, view.wind, sizeof view.wind);
        view_side_draw(side[s]);
    }
    if (!same) find_bounds();
}

/* The page's memory ends at 4 GB, which nothing there says. */
static SmCode check_size(const BenchScene *scene, SmError *error)
{
    const double most = 1e6;
    double wanted =
        fmax((double)scene->voxel.particles, (double)scene->cells) * (double)scene->instances;
    if (wanted <= most && (double)scene->instances <= 1e4) return SM_OK;
    return sm_fail(error, SM_MEMORY,
                   "scene: %.3g particles in %ld bodies; a page takes 1e6 in 10000: ask for fewer",
                   wanted, scene->instances);
}

/* What is drawn of all bodies, which takes more memory than they do. */
static SmCode check_surface(const BenchScene *scene, const SmMesh *mesh, SmError *error)
{
    const double most = 5e6;
    double triangles = (double)mesh->triangle_count * (double)scene->instances;
    if (triangles <= most) return SM_OK;
    return sm_fail(error, SM_MEMORY,
                   "scene: %.3g triangles in %ld bodies; a page takes 5e6: ask for fewer bodies",
                   triangles, scene->instances);
}

/* A lattice, which is not made yet, weighs what the shell does that is beside it, unless the scene
 * says what. */
static void weigh_as(const ViewSide *shell, BenchBody *body)
{
    if (!view_side_shell(shell) || body->mass) return;
    const BenchRunner *runner = &shell->play.group[0].runner;
    double *mass = sm_alloc((size_t)runner->count, sizeof *mass), all = 0;
    runner->type->masses(runner->engine, mass);
    for (long p = 0; p < runner->count; p++) all += mass[p];
    free(mass);
    body->mass = sm_alloc((size_t)body->voxels.particle_count, sizeof *body->mass);
    for (long p = 0; p < body->voxels.particle_count; p++)
        body->mass[p] = all / (double)body->voxels.particle_count;
}

/* Of the program's shapes, or of the mesh that was given. A page takes fewer particles rather than
 * none where so many take too large a lattice. */
static SmCode make_body(BenchScene *scene, BenchBody *body, SmError *error)
{
    SmMesh mesh;
    scene->voxel.fewer = true;
    if (scene->vertex_mass[0])
        return sm_fail(error, SM_INPUT,
                       "scene: 'vertex_mass' names a file of masses, and a page takes none: give "
                       "'density'");
    SmCode code = view_given_load(scene->mesh, &mesh, error);
    if (!code) code = check_surface(scene, &mesh, error);
    if (code) {
        sm_mesh_free(&mesh);
        return code;
    }
    code = bench_body_create(scene, &mesh, body, error);
    if (!code) body->stored = view_stored_find(scene, &body->mesh);
    return code;
}

int view_open(int bytes, int keep)
{
    static BenchScene scene;
    SmError error;
    if (bench_scene_parse(view.text, (size_t)bytes, "scene", &scene, &error) ||
        check_size(&scene, &error))
        return refuse(&error);
    static const ViewAllowed nothing;
    const ViewAllowed *allowed = keep ? &view.allowed : &nothing;
    BenchBody *body = sm_alloc(1, sizeof *body);
    ViewSide *side[VIEW_SIDES] = {NULL, NULL};
    unsigned own_kind = bench_engine(scene.engine)->own;
    bool elastic = own_kind == BENCH_OF_ELASTIC, shell = own_kind == BENCH_OF_SHELL;
    const char *const engine[VIEW_SIDES] = {"fastlsm", elastic || shell ? scene.engine : "octree"};
    if (elastic && scene.density == 0) /* as heavy on both sides */
        scene.density = scene.meshless.material.density / pow(scene.metre, 3);
    if (make_body(&scene, body, &error)) {
        free(body);
        return refuse(&error);
    }
    for (int s = VIEW_SIDES - 1; s >= 0; s--) {
        side[s] = sm_alloc(1, sizeof *side[s]);
        view_side_create(&scene, body, engine[s], allowed, side[s]);
        weigh_as(side[s], body);
    }
    int own = strcmp(scene.engine, engine[VIEW_OTHER]) == 0 ? VIEW_OTHER : VIEW_LATTICE;
    view_side_push_as(side[!own], side[own]);
    if (!view_side_is_there(side[VIEW_LATTICE]) && !view_side_is_there(side[VIEW_OTHER])) {
        error = side[VIEW_LATTICE]->absent;
        close_sides(side, body);
        return refuse(&error);
    }
    view.message[0] = '\0';
    if (!keep) view.allowed = nothing;
    replace(side, body, keep);
    return 0;
}

ViewSide *view_side_of(int number)
{
    ViewSide *side = number >= 0 && number < VIEW_SIDES ? view.side[number] : NULL;
    return side && view_side_is_there(side) ? side : NULL;
}

const char *view_engine(int side)
{
    if (side < 0 || side >= VIEW_SIDES || !view.side[side]) return "";
    return view.side[side]->scene.engine;
}

const char *view_absent(int side)
{
    if (side < 0 || side >= VIEW_SIDES || !view.side[side]) return "nothing is open";
    return view.side[side]->absent.text;
}

void view_step(int side, int steps)
{
    if (view_side_of(side)) view_side_step(view_side_of(side), steps, view.hand);
}

/* What the engines count, of all groups. */
static double counted(const ViewSide *side, int figure)
{
    double sum = 0, mean = 0;
    const RefElastic *elastic = view_side_elastic(side);
    const RefShellBody *shell = view_side_shell(side);
    if (elastic && figure == VIEW_PARTICLES) return (double)elastic->motion.nodes;
    if (shell && figure == VIEW_PARTICLES) return (double)shell->sheet.warp.nodes;
    for (int g = 0; g < side->play.count; g++) {
        SmCounts counts;
        const BenchRunner *runner = &side->play.group[g].runner;
        runner->type->count(runner->engine, &counts);
        long bodies = runner->particles / runner->count;
        long value[] = {
            [VIEW_PARTICLES] = counts.particles,  [VIEW_REGIONS] = bodies * counts.regions,
            [VIEW_LINKS] = bodies * counts.links, [VIEW_BROKEN] = counts.broken,
            [VIEW_CONTACTS] = counts.contacts,    [VIEW_SUMMATION_NODES] = 0};
        sum += (double)value[figure];
        mean = counts.summation_nodes;
    }
    return figure == VIEW_SUMMATION_NODES ? mean : sum;
}

double view_figure(int number, int figure)
{
    const ViewSide *side = view_side_of(number);
    double energy, momentum;
    if (!side || figure < 0 || figure >= VIEW_FIGURES) return NAN;
    switch (figure) {
    case VIEW_BUILD_MS:
        return 1e3 * side->build_seconds;
    case VIEW_TIME:
        return side->play.time;
    case VIEW_STEPS:
        return (double)side->steps;
    case VIEW_KINETIC:
        view_side_motion(side, &energy, &momentum);
        return energy;
    case VIEW_MOMENTUM:
        view_side_motion(side, &energy, &momentum);
        return momentum;
    case VIEW_CELL:
        return view.body->voxels.cell;
    case VIEW_H:
        return side->scene.params.h;
    case VIEW_STEPS_PER_FRAME:
        return side->scene.steps_per_frame;
    case VIEW_PIECES:
        return view_side_shell(side) ? (double)side->pieces : NAN;
    default:
        return counted(side, figure);
    }
}

double view_stage_ms(int number, int stage)
{
    const ViewSide *side = view_side_of(number);
    if (!side || stage < 0 || stage >= SM_STAGES || !side->timed) return NAN;
    static double clock; /* s a lap */
    if (clock == 0) clock = sm_lap_seconds();
    double seconds = side->lap[stage] - clock * (double)side->laps[stage];
    return 1e3 * fmax(0, seconds) / (double)side->timed;
}

const char *view_stage_name(int number, int stage)
{
    const ViewSide *side = view_side_of(number);
    if (!side || stage < 0 || stage >= SM_STAGES) return NULL;
    return sm_engine_stage(side->play.group[0].runner.type, (SmStage)stage);
}

double view_paper_percent(int number, int stage)
{
    const ViewSide *side = view_side_of(number);
    if (!side || stage < 0 || stage >= SM_STAGES) return NAN;
    const BenchScene *scene = &side->scene;
    bool own = strcmp(scene->paper, scene->engine) == 0;
    const RefPaperRow *row = own ? ref_paper_find(scene->paper, scene->row) : NULL;
    return row ? row->stage_percent[stage].value : NAN;
}

void view_clear_stages(int number)
{
    ViewSide *side = view_side_of(number);
    if (!side) return;
    side->timed = side->untimed = 0;
    memset(side->lap, 0, sizeof side->lap);
    memset(side->laps, 0, sizeof side->laps);
}

int view_surface(int side)
{
    if (!view_side_of(side)) return 0;
    view_side_draw(view_side_of(side));
    return view_side_of(side)->generation;
}

int view_vertices(int side)
{
    return view_side_of(side) ? (int)view_side_of(side)->vertices : 0;
}

int view_triangles(int side)
{
    return view_side_of(side) ? (int)view_side_of(side)->triangles : 0;
}

const float *view_points(int side)
{
    return view_side_of(side) ? view_side_of(side)->point32 : NULL;
}

const float *view_normals(int side)
{
    return view_side_of(side) ? view_side_of(side)->normal32 : NULL;
}

const int *view_indices(int side)
{
    return view_side_of(side) ? view_side_of(side)->index : NULL;
}

const double *view_bounds(void)
{
    return view.bounds;
}

/* The scene's; those of a side that is there. */
static const BenchScene *scene_of_sides(void)
{
    for (int s = 0; s < VIEW_SIDES; s++)
        if (view_side_of(s)) return &view_side_of(s)->scene;
    return NULL;
}

int view_obstacles(void)
{
    const BenchScene *scene = scene_of_sides();
    return scene ? scene->obstacle_count : 0;
}

const double *view_obstacle(int number)
{
    if (number < 0 || number >= view_obstacles()) return NULL;
    const SmObstacle *obstacle = &scene_of_sides()->obstacle[number];
    view.obstacle[0] = obstacle->kind;
    memcpy(view.obstacle + 1, obstacle->a, sizeof obstacle->a);
    memcpy(view.obstacle + 4, obstacle->b, sizeof obstacle->b);
    view.obstacle[7] = obstacle->radius;
    return view.obstacle;
}

/* ---- grips */

static void hold_all(void)
{
    for (int s = 0; s < VIEW_SIDES; s++)
        if (view_side_of(s))
            view_grips_hold(&view_side_of(s)->grips, &view_side_of(s)->play, view.hand, false);
}

static bool is_held(int grip)
{
    double middle[3];
    for (int s = 0; s < VIEW_SIDES; s++)
        if (view_side_of(s) &&
            view_grips_middle(&view_side_of(s)->grips, &view_side_of(s)->play, grip, middle))
            return true;
    return false;
}

int view_grab(int side, int vertex, double radius)
{
    int grip = 0;
    while (grip < VIEW_HANDS && view.hand[grip].holds) grip++;
    if (grip == VIEW_HANDS || !view_side_of(side)) return -1;
    ViewHand taken = {.holds = true, .radius = radius};
    if (!view_side_vertex(view_side_of(side), vertex, &taken.instance, taken.rest)) return -1;
    view.hand[grip] = taken;
    hold_all();
    if (is_held(grip)) return grip;
    view.hand[grip].holds = false;
    return -1;
}

void view_drag(int grip, double x, double y, double z)
{
    if (grip < 0 || grip >= VIEW_HANDS || !view.hand[grip].holds) return;
    if (!isfinite(x) || !isfinite(y) || !isfinite(z)) return;
    memcpy(view.hand[grip].moved, (double[3]){x, y, z}, sizeof(double[3]));
}

void view_release(int grip)
{
    if (grip < 0 || grip >= VIEW_HANDS || !view.hand[grip].holds) return;
    view.hand[grip].holds = false;
    hold_all();
}

const double *view_grip(int side, int grip)
{
    const ViewSide *of = view_side_of(side);
    return of && view_grips_middle(&of->grips, &of->play, grip, view.middle) ? view.middle : NULL;
}

/* ---- what else hands do */

void view_allow_cut(void)
{
    view.allowed.cut = true;
}

void view_allow_touch(int instance)
{
    if (instance >= 0 && instance < BENCH_MAX) view.allowed.touched[instance] = true;
}

int view_may_cut(int side)
{
    return view_side_of(side) && view_side_of(side)->tools.blade >= 0;
}

int view_may_touch(int side, int instance)
{
    return view_side_of(side) &&
           view_tools_may_touch(&view_side_of(side)->tools, &view_side_of(side)->scene, instance);
}

int view_cut(double ax, double ay, double az, double bx, double by, double bz)
{
    const double a[3] = {ax, ay, az}, b[3] = {bx, by, bz};
    int cut = 0;
    for (int d = 0; d < 3; d++)
        if (!isfinite(a[d]) || !isfinite(b[d])) return 0;
    for (int s = 0; s < VIEW_SIDES; s++)
        if (view_side_of(s)) cut += view_side_cut(view_side_of(s), a, b, view.hand);
    return cut;
}

void view_lift(void)
{
    for (int s = 0; s < VIEW_SIDES; s++)
        if (view_side_of(s)) view_tools_lift(&view_side_of(s)->tools, &view_side_of(s)->play);
}

int view_body(int side, int vertex)
{
    long instance;
    double rest[3];
    bool found =
        view_side_of(side) && view_side_vertex(view_side_of(side), vertex, &instance, rest);
    return found ? (int)instance : -1;
}

void view_touch(int side, int vertex, double radius)
{
    long instance;
    double rest[3];
    if (!view_side_of(side) || !view_side_vertex(view_side_of(side), vertex, &instance, rest))
        return;
    for (int s = 0; s < VIEW_SIDES; s++)
        if (view_side_of(s))
            view_tools_touch(&view_side_of(s)->tools, &view_side_of(s)->scene, instance, rest,
                             radius);
}

void view_leave(void)
{
    for (int s = 0; s < VIEW_SIDES; s++)
        if (view_side_of(s)) view_tools_leave(&view_side_of(s)->tools, &view_side_of(s)->scene);
}

void view_blow(double x, double y, double z)
{
    if (!isfinite(x) || !isfinite(y) || !isfinite(z)) return;
    memcpy(view.wind, (double[3]){x, y, z}, sizeof view.wind);
    for (int s = 0; s < VIEW_SIDES; s++)
        if (view_side_of(s)) memcpy(view_side_of(s)->tools.wind, view.wind, sizeof view.wind);
}
