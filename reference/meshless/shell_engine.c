/* The engine: a map of the mesh's surface, a shell over it, its motion, and its vertices. */
#include "shell_engine.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/box.h"
#include "../../lib/engine/boundary.h"
#include "../../lib/vector.h"
#include "motion/grip.h"
#include "shell/foot.h"

enum { MOST_POINTS = 12, MOST_LOOSE = 4 };

/* The holds that a handle has become. */
typedef struct {
    int first, count;
} Held;

struct SmEngine {
    long count;
    double mass;       /* of a particle */
    double pose[3][4]; /* rest to initial position: a translation */
    RefShellBody body;
    long *place; /* [count] where a particle is in the skin */
    double (*rest)[3];
    double (*before)[3]; /* [count] in the skin's order, a step ago */
    SmHandles handles;
    Held *held;         /* [handles.count] */
    int (*triangle)[3]; /* the mesh's, of one that breaks */
    bool drawn;         /* its surface was taken once */
    double pressure, pulse, time;
    double (*press)[3]; /* [nodes] what a pressure of 1 does to a shell that does not break */
    double outwards;    /* 1 or -1: the way normals look */
    RefShape shape;     /* scratch: functions at a place */
    RefModes modes;     /* of the free shell, if they were asked for, and */
    RefWarp shown;      /* how it warps then */
};

#define CONST(array) ((const double(*)[3])(array))

static void shell_destroy(SmEngine *engine)
{
    if (!engine) return;
    ref_skin_free(&engine->body.skin);
    ref_torn_free(&engine->body.torn);
    if (engine->body.breaking) ref_breaking_free(engine->body.breaking);
    free(engine->body.breaking);
    ref_sheet_free(&engine->body.sheet);
    ref_surface_map_free(&engine->body.map);
    sm_handles_free(&engine->handles);
    ref_shape_free(&engine->shape);
    ref_modes_free(&engine->modes);
    ref_warp_free(&engine->shown);
    sm_free_all(engine->triangle, engine->body.carried, engine->place, engine->rest, engine->before,
                engine->held, engine->press, engine);
}

static void carry(SmEngine *engine)
{
    RefShellBody *body = &engine->body;
    ref_skin_place(&body->skin, CONST(body->sheet.warp.moved), CONST(body->sheet.warp.turned),
                   body->carried);
}

/* The particles, the mesh's vertices, and their map. */
static SmCode map_surface(const RefMeshlessOptions *options, SmEngine *engine, SmError *error)
{
    const SmMesh *mesh = options->mesh;
    engine->count = mesh->vertex_count;
    engine->rest = sm_copy(mesh->position, (size_t)engine->count, sizeof *engine->rest);
    return ref_surface_map_create(mesh, options->of_points,
                                  options->of_points ? "the points" : "the mesh", &engine->body.map,
                                  error);
}

/* Cells are split where a crack takes more than a quarter of a cover, once. */
static SmCode make_breaking(const RefMeshlessOptions *options, SmEngine *engine, SmError *error)
{
    RefCrackedOptions cracked = {.least_share = 0.75, .most_splits = 1};
    RefFractureOptions fracture = {
        .strength = options->strength, .branching = options->branching, .most_starts = 4};
    engine->pressure = options->pressure;
    engine->pulse = options->pulse;
    if (!(options->strength > 0)) return SM_OK;
    engine->body.breaking = sm_alloc(1, sizeof *engine->body.breaking);
    return ref_breaking_create(&engine->body.sheet, &cracked, &fracture, engine->body.breaking,
                               error);
}

RefShellOptions ref_shell_options(const RefMeshlessOptions *options, double longest)
{
    bool linear = options->basis == REF_MESHLESS_USUAL ? options->covers > 0
                                                       : options->basis == REF_MESHLESS_LINEAR;
    return (RefShellOptions){.nodes = options->nodes > 0 ? options->nodes : REF_SHELL_NODES,
                             .basis = linear ? REF_MLS_PLANE_LINEAR : REF_MLS_PLANE_QUADRATIC,
                             .eta = options->covers,
                             .thickness = options->thickness > 0 ? options->thickness
                                                                 : REF_SHELL_THIN * longest,
                             .material = options->material};
}

/* Functions of a shell that does not break are not kept: they are taken once more. */
static SmCode make_press(SmEngine *engine, SmError *error)
{
    RefShell *shell = &engine->body.sheet.shell;
    RefSamples samples;
    SmCode code = ref_samples_take(&shell->tree, &shell->nodes, shell->basis, &samples, error);
    if (code != SM_OK) return code;
    engine->press = sm_alloc((size_t)shell->nodes.count, sizeof *engine->press);
    ref_middle_areas(CONST(shell->X), &samples);
    ref_middle_press(&samples, 1, engine->press);
    ref_samples_free(&samples);
    return SM_OK;
}

static SmCode make_sheet(const SmEngineParams *params, SmEngine *engine, SmError *error)
{
    const RefMeshlessOptions *options = params->meshless;
    SmCode code = map_surface(options, engine, error);
    if (code != SM_OK) return code;
    SmBox box = sm_box_around(engine->count, CONST(engine->rest));
    RefSheetOptions sheet = {.shell = ref_shell_options(options, sm_box_longest(&box)),
                             .damping = {params->damping / (1 - params->damping) / params->h,
                                         options->stiffness_damping},
                             .h = params->h};
    if (sheet.shell.thickness > sm_box_longest(&box))
        return sm_fail(error, SM_INPUT,
                       "thickness %g is more than the body's longest extent, %g, both in the "
                       "mesh's units: give "
                       "less, or none for a hundredth of that",
                       sheet.shell.thickness, sm_box_longest(&box));
    memcpy(sheet.gravity, params->gravity, sizeof sheet.gravity);
    double start = sm_now();
    code = ref_sheet_create(&engine->body.map.chart, &sheet, &engine->body.sheet, error);
    if (code == SM_OK) code = make_breaking(options, engine, error);
    if (code == SM_OK && options->pressure != 0 && !engine->body.breaking)
        code = make_press(engine, error);
    engine->body.matrix_seconds = sm_now() - start;
    return code;
}

/* Whether normals look out of a closed surface: by the volume that places enclose with them. */
static double outwards(const RefWarp *warp)
{
    double volume = 0;
    for (long n = 0; n < warp->nodes; n++)
        volume += warp->mass[n] * sm_dot(warp->X[n], warp->rest_normal[n]);
    double middle[3] = {0}, side[3] = {0};
    for (long n = 0; n < warp->nodes; n++)
        for (int d = 0; d < 3; d++) {
            middle[d] += warp->mass[n] * warp->X[n][d];
            side[d] += warp->mass[n] * warp->rest_normal[n][d];
        }
    return volume < sm_dot(middle, side) ? -1 : 1;
}

static void make_particles(const SmMesh *mesh, SmEngine *engine)
{
    RefShellBody *body = &engine->body;
    size_t count = (size_t)engine->count;
    double start = sm_now(), mass = 0;
    engine->before = sm_alloc(count, sizeof *engine->before);
    engine->place = sm_alloc(count, sizeof *engine->place);
    body->carried = sm_alloc(count, sizeof *body->carried);
    ref_foot_skin(&body->sheet.shell, &body->sheet.warp, engine->count,
                  (const double(*)[2])body->map.theta, CONST(engine->rest), &body->skin,
                  &body->loose);
    for (long s = 0; s < engine->count; s++) engine->place[body->skin.order[s]] = s;
    double *masses = sm_alloc((size_t)body->sheet.warp.nodes, sizeof *masses);
    ref_sparse_sums(&body->sheet.shell.matrices.mass, masses);
    for (long n = 0; n < body->sheet.warp.nodes; n++) mass += masses[n];
    free(masses);
    engine->mass = mass / (double)engine->count;
    if (body->breaking) {
        engine->triangle = sm_alloc((size_t)mesh->triangle_count, sizeof *engine->triangle);
        memcpy(engine->triangle, mesh->triangle,
               (size_t)mesh->triangle_count * sizeof *engine->triangle);
        ref_torn_create(&body->map.chart, engine->count, mesh->triangle_count,
                        (const int(*)[3])engine->triangle, (const double(*)[2])body->map.theta,
                        CONST(engine->rest), &body->torn);
    }
    engine->outwards = outwards(&body->sheet.warp);
    engine->shape = ref_shape_create(&body->sheet.shell.nodes);
    carry(engine);
    memcpy(engine->before, body->carried, count * sizeof *engine->before);
    body->skin_seconds = sm_now() - start;
}

static SmCode shell_create(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **result,
                           SmError *error)
{
    SmCode code = ref_meshless_check(voxels, params, error);
    if (code != SM_OK) return code;
    SmEngine *engine = sm_alloc(1, sizeof *engine);
    sm_engine_pose(params, 0, engine->pose);
    code = make_sheet(params, engine, error);
    if (code != SM_OK) {
        shell_destroy(engine);
        return code;
    }
    make_particles(params->meshless->mesh, engine);
    *result = engine;
    return SM_OK;
}

/* The pressure's push of one step. */
static void blow(SmEngine *engine)
{
    RefShellBody *body = &engine->body;
    RefSheet *sheet = &body->sheet;
    double push = engine->pressure * sheet->options.h * engine->outwards;
    if (body->breaking) ref_cracked_press(&body->breaking->cracked, push, sheet->impulse);
    for (long n = 0; !body->breaking && n < sheet->warp.nodes; n++)
        for (int d = 0; d < 3; d++) sheet->impulse[n][d] += push * engine->press[n][d];
    sheet->pushed = true;
}

static void bind(SmEngine *engine);

/* What follows where cracks have changed. */
static void follow_cracks(SmEngine *engine)
{
    RefShellBody *body = &engine->body;
    ref_foot_renew(&body->breaking->cracked, &body->sheet.warp, (const double(*)[2])body->map.theta,
                   CONST(engine->rest), &body->skin, &body->loose);
    ref_shape_free(&engine->shape);
    engine->shape = ref_shape_create(&body->sheet.shell.nodes);
    if (engine->handles.count) bind(engine);
}

static void shell_step(SmEngine *engine, SmLaps *laps)
{
    RefShellBody *body = &engine->body;
    bool changed = false;
    if (body->broke) {
        memcpy(engine->before, body->carried, (size_t)engine->count * sizeof *engine->before);
        return;
    }
    if (engine->pressure != 0 && engine->time < engine->pulse) blow(engine);
    engine->time += body->sheet.options.h;
    if (body->breaking)
        body->broke = ref_breaking_step(body->breaking, &changed, NULL) != SM_OK;
    else
        ref_sheet_step(&body->sheet);
    if (changed) follow_cracks(engine);
    sm_lap(laps, SM_SHAPE_MATCHING);
    double(*now)[3] = engine->before;
    engine->before = body->carried;
    body->carried = now;
    carry(engine);
    sm_lap(laps, SM_OTHER);
}

static void shell_get(SmEngine *engine, SmField field, double (*values)[3])
{
    for (long p = 0; p < engine->count; p++) {
        const double *now = engine->body.carried[engine->place[p]];
        const double *before = engine->before[engine->place[p]];
        for (int d = 0; d < 3; d++)
            values[p][d] = field == SM_VELOCITY
                               ? (now[d] - before[d]) / engine->body.sheet.options.h
                           : field == SM_REST ? engine->rest[p][d] + engine->pose[d][3]
                                              : now[d] + engine->pose[d][3];
    }
}

/* Displacements and velocities of the parameters, the time, and the tension that steps bear. Cracks
 * are more than that. */
static long shell_get_state(SmEngine *engine, double *state)
{
    const RefSheet *sheet = &engine->body.sheet;
    long size = 3 * sheet->warp.nodes, places = REF_WARP_PLACES * sheet->warp.cells;
    if (engine->body.breaking) return 0;
    if (state) {
        memcpy(state, sheet->steps.u, (size_t)size * sizeof *state);
        memcpy(state + size, sheet->steps.v, (size_t)size * sizeof *state);
        state[2 * size] = engine->time;
        memset(state + 2 * size + 1, 0, (size_t)places * sizeof *state);
        if (sheet->tension.borne)
            memcpy(state + 2 * size + 1, sheet->tension.borne, (size_t)places * sizeof *state);
    }
    return 2 * size + 1 + places;
}

static void shell_set_state(SmEngine *engine, const double *state)
{
    RefSheet *sheet = &engine->body.sheet;
    long size = 3 * sheet->warp.nodes;
    if (engine->body.breaking) return;
    engine->time = state[2 * size];
    ref_tension_set(&sheet->tension, state + 2 * size + 1, &sheet->warp, &sheet->steps);
    for (long n = 0; n < size; n++)
        sheet->steps.u[n] = state[n] - sheet->options.h * state[size + n];
    ref_sheet_pose(sheet);
    carry(engine);
    memcpy(engine->before, engine->body.carried, (size_t)engine->count * sizeof *engine->before);
    memcpy(sheet->steps.u, state, (size_t)size * sizeof *state);
    memcpy(sheet->steps.v, state + size, (size_t)size * sizeof *state);
    ref_sheet_pose(sheet);
    carry(engine);
}

static void shell_push(SmEngine *engine, long count, const long *particle,
                       const double (*impulse)[3])
{
    RefSheet *sheet = &engine->body.sheet;
    for (long n = 0; n < count; n++) {
        assert(particle[n] >= 0 && particle[n] < engine->count);
        ref_skin_push(&engine->body.skin, engine->place[particle[n]], impulse[n], sheet->impulse);
    }
    sheet->pushed = sheet->pushed || count > 0;
}

/* How long cells' edges are on the surface, on average. */
static double cell_length(const RefSheet *sheet)
{
    double area = 0;
    for (long p = 0; p < REF_WARP_PLACES * sheet->warp.cells; p++)
        area += sheet->warp.place[p].area;
    return sqrt(area / (double)sheet->warp.cells);
}

/* A handle's points that the shell's functions cover, the one nearest to their middle first;
 * whether they are all in a line. */
static bool choose_points(SmEngine *engine, const SmHandle *handle, RefSheetGrip *grip)
{
    double(*x)[3] = sm_alloc((size_t)handle->count, sizeof *x), least = INFINITY;
    for (long k = 0; k < handle->count; k++)
        memcpy(x[k], engine->rest[handle->particle[k]], sizeof x[k]);
    RefGrip chosen =
        ref_grip_choose(handle->count, CONST(x), cell_length(&engine->body.sheet), MOST_POINTS);
    double middle[3] = {0};
    long nearest = 0;
    for (long k = 0; k < handle->count; k++)
        for (int d = 0; d < 3; d++) middle[d] += x[k][d] / (double)handle->count;
    for (long k = 0; k < handle->count; k++) {
        double way[3] = {x[k][0] - middle[0], x[k][1] - middle[1], x[k][2] - middle[2]};
        if (sm_dot(way, way) >= least) continue;
        least = sm_dot(way, way);
        nearest = k;
    }
    *grip = (RefSheetGrip){.theta = sm_alloc((size_t)chosen.count + 1, sizeof *grip->theta)};
    for (int c = -1; c < chosen.count; c++) {
        long point = c < 0 ? nearest : chosen.point[c];
        const double *theta = engine->body.map.theta[handle->particle[point]];
        const double at[3] = {theta[0], theta[1]};
        if ((c >= 0 && point == nearest) ||
            !ref_shell_shape(&engine->body.sheet.shell, at, &engine->shape))
            continue;
        memcpy(grip->theta[grip->count++], at, sizeof at);
    }
    bool line = !chosen.rigid || grip->count < 3;
    ref_grip_free(&chosen);
    free(x);
    return line;
}

/* Other holds than before, where the surface is; the motion goes on. Where they cannot be made,
 * none. */
static void bind(SmEngine *engine)
{
    int count = 0, handles = engine->handles.count;
    RefSheetGrip *grip = sm_alloc((size_t)(handles * MOST_LOOSE), sizeof *grip);
    engine->held = sm_realloc(engine->held, (size_t)handles, sizeof *engine->held);
    for (int n = 0; n < handles; n++) {
        Held *held = engine->held + n;
        *held = (Held){count, 0};
        RefSheetGrip all;
        if (engine->handles.handle[n].count == 0) continue;
        bool line = choose_points(engine, engine->handles.handle + n, &all);
        held->count = !line ? 1 : all.count < MOST_LOOSE ? all.count : MOST_LOOSE;
        for (int k = 0; line && k < held->count; k++) {
            grip[count + k] = (RefSheetGrip){
                .count = 1, .theta = sm_alloc(1, sizeof *grip->theta), .loose = true};
            memcpy(grip[count + k].theta, all.theta[k], sizeof *all.theta);
        }
        if (line)
            free(all.theta);
        else
            grip[count] = all;
        count += held->count;
    }
    if (ref_sheet_hold(&engine->body.sheet, count, grip, NULL) != SM_OK) {
        ref_sheet_hold(&engine->body.sheet, 0, NULL, NULL);
        for (int n = 0; n < handles; n++) engine->held[n].count = 0;
    }
    for (int k = 0; k < count; k++) free(grip[k].theta);
    free(grip);
}

static void shell_bound(SmEngine *engine, const SmBoundary *boundary)
{
    if (engine->body.broke) return;
    if (sm_handles_set(&engine->handles, boundary, engine->count)) bind(engine);
    for (int n = 0; n < engine->handles.count; n++) {
        double pose[3][4];
        memcpy(pose, engine->handles.handle[n].pose, sizeof pose);
        for (int d = 0; d < 3; d++) {
            pose[d][3] -= engine->pose[d][3];
            for (int e = 0; e < 3; e++) pose[d][3] += pose[d][e] * engine->pose[e][3];
        }
        for (int k = 0; k < engine->held[n].count; k++)
            ref_sheet_aim(&engine->body.sheet, engine->held[n].first + k, (const double(*)[4])pose);
    }
}

static void draw(SmEngine *engine, bool rest, double (*point)[3])
{
    RefShellBody *body = &engine->body;
    double(*outer)[3] = sm_alloc((size_t)engine->count, sizeof *outer);
    for (long p = 0; p < engine->count; p++)
        memcpy(outer[p], rest ? engine->rest[p] : body->carried[engine->place[p]], sizeof *outer);
    ref_torn_place(&body->torn, &body->breaking->cracked, rest ? NULL : &body->sheet.warp,
                   CONST(outer), body->sheet.options.shell.thickness, point);
    free(outer);
}

static bool shell_surface(SmEngine *engine, SmMesh *surface)
{
    RefShellBody *body = &engine->body;
    if (!body->breaking) return false;
    bool changed = ref_torn_update(&body->torn, &body->breaking->cracked);
    if (engine->drawn && !changed) return false;
    engine->drawn = true;
    sm_mesh_free(surface);
    *surface = ref_torn_mesh(&body->torn);
    draw(engine, true, surface->position);
    return true;
}

static void shell_surface_points(SmEngine *engine, double (*point)[3])
{
    draw(engine, false, point);
    for (long n = 0; n < 2 * (engine->body.torn.vertices + engine->body.torn.copies); n++)
        for (int d = 0; d < 3; d++) point[n][d] += engine->pose[d][3];
}

static int shell_surface_particle(const SmEngine *engine, long vertex)
{
    const RefTornSurface *torn = &engine->body.torn;
    long outer = vertex % (torn->vertices + torn->copies);
    return outer < torn->vertices ? (int)outer : torn->of[outer - torn->vertices];
}

static void shell_masses(SmEngine *engine, double *mass)
{
    for (long p = 0; p < engine->count; p++) mass[p] = engine->mass;
}

static void shell_count(SmEngine *engine, SmCounts *counts)
{
    const RefShellBody *body = &engine->body;
    *counts = (SmCounts){
        .particles = engine->count,
        .regions = body->sheet.warp.nodes,
        .stopped = body->broke,
        .build_seconds = body->map.seconds + body->matrix_seconds + body->skin_seconds,
    };
}

RefShellBody *ref_shell_body(SmEngine *engine)
{
    return &engine->body;
}

SmCode ref_shell_find_modes(SmEngine *engine, int shapes, const RefModes **modes, SmError *error)
{
    const RefShell *shell = &engine->body.sheet.shell;
    *modes = &engine->modes;
    if (engine->modes.count >= REF_RIGID_MODES + shapes) return SM_OK;
    ref_modes_free(&engine->modes);
    SmCode code = engine->shown.nodes ? SM_OK : ref_warp_create(shell, &engine->shown, error);
    if (code != SM_OK) return code;
    return ref_modes_find(&shell->matrices, NULL, REF_RIGID_MODES + shapes, &engine->modes, error);
}

/* Places the particles as the free shell warps them by so much of a mode; returns how far the one
 * that moves most is from rest. */
static double show(SmEngine *engine, size_t k, double amount)
{
    const RefModes *modes = &engine->modes;
    RefShellBody *body = &engine->body;
    size_t count = (size_t)modes->count, size = 3 * (size_t)modes->nodes;
    double most = 0, *u = sm_alloc(size, sizeof *u);
    for (size_t n = 0; n < size; n++) u[n] = amount * modes->shape[n * count + k];
    ref_warp_pose(&engine->shown, (const double(*)[3])u);
    ref_skin_place(&body->skin, CONST(engine->shown.moved), CONST(engine->shown.turned),
                   body->carried);
    for (long p = 0; p < engine->count; p++)
        most = fmax(most, sm_square_between(body->carried[engine->place[p]], engine->rest[p]));
    free(u);
    return sqrt(most);
}

/* Parameters say little of how far the surface moves: where the map draws it out, theirs are far
 * larger than what they are of. A little of the mode says it. */
double ref_shell_show(SmEngine *engine, int mode, double far)
{
    const RefModes *modes = &engine->modes;
    size_t count = (size_t)modes->count, k = (size_t)mode + REF_RIGID_MODES;
    double most = 0;
    assert(mode >= 0 && k < count && modes->nodes == engine->body.sheet.warp.nodes);
    for (size_t n = 0; n < 3 * (size_t)modes->nodes; n++)
        most = fmax(most, fabs(modes->shape[n * count + k]));
    double little = 1e-3 * fabs(far) / most;
    double moved = far != 0 ? show(engine, k, little) : 0;
    show(engine, k, moved > 0 ? far * little / moved : 0);
    memcpy(engine->before, engine->body.carried, (size_t)engine->count * sizeof *engine->before);
    return sqrt(fmax(modes->lambda[k], 0)) / (2 * M_PI);
}

const SmEngineType ref_shell_engine = {
    .name = "shell",
    .precision = "double",
    .unstopped = true,
    .vertices = true,
    .stages = &ref_meshless_stages,
    .create = shell_create,
    .destroy = shell_destroy,
    .step = shell_step,
    .get = shell_get,
    .push = shell_push,
    .bound = shell_bound,
    .get_state = shell_get_state,
    .set_state = shell_set_state,
    .masses = shell_masses,
    .surface = shell_surface,
    .surface_points = shell_surface_points,
    .surface_particle = shell_surface_particle,
    .count = shell_count,
};
