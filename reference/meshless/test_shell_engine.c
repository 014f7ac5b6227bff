/* The engine shell behind engine.h: rest, falling, pushes, handles, states, and what it refuses. */
#include "../../lib/test_fields.h"
#include "../../lib/test_frame.h"
#include "../../lib/vector.h"
#include "../../lib/voxel/voxelise.h"
#include "map/test_surfaces.h"
#include "shell/foot.h"
#include "shell_engine.h"
#include "test_solver.h"

enum { AROUND = 48, ACROSS = 24, VERTICES = AROUND * ACROSS };

static const SmEngineType *const type = &ref_shell_engine;

typedef struct {
    SmMesh mesh;
    SmVoxels voxels;
    RefMeshlessOptions options;
    SmEngineParams params;
} Scene;

/* Takes the mesh. */
static Scene scene_of(SmMesh mesh)
{
    Scene scene = {.mesh = mesh,
                   .options = {.nodes = 120, .thickness = 0.01, .material = {1e6, 0.3, 1000}},
                   .params = {.w = 1, .h = 0.01}};
    SmVoxelParams shell = {.fill = SM_SHELL, .particles = 400};
    assert_int_equal(sm_voxelise(&scene.mesh, &shell, "mesh", &scene.voxels, NULL), SM_OK);
    return scene;
}

/* A ring around y with a bulge, 1 across. */
static Scene ring_create(void)
{
    SmMesh mesh = sm_mesh_new(VERTICES, 2L * VERTICES);
    for (int v = 0; v < VERTICES; v++) {
        double a = 2 * M_PI * (v % AROUND) / AROUND, b = 2 * M_PI * (v / AROUND) / ACROSS;
        double r = 0.13 * (1 + 0.2 * cos(a)), *x = mesh.position[v];
        x[0] = (0.35 + r * cos(b)) * cos(a);
        x[1] = r * sin(b);
        x[2] = -(0.35 + r * cos(b)) * sin(a);
        int right = v / AROUND * AROUND + (v + 1) % AROUND, up = (v + AROUND) % VERTICES;
        int corner = right / AROUND == ACROSS - 1 ? right % AROUND : right + AROUND;
        int triangle[2][3] = {{v, right, corner}, {v, corner, up}};
        memcpy(mesh.triangle[2 * v], triangle, sizeof triangle);
    }
    return scene_of(mesh);
}

static SmCode create(Scene *scene, SmEngine **engine, SmError *error)
{
    scene->options.mesh = &scene->mesh;
    scene->params.meshless = &scene->options;
    return type->create(&scene->voxels, &scene->params, engine, error);
}

static SmEngine *engine_of(Scene *scene)
{
    SmEngine *engine;
    SmError error;
    if (create(scene, &engine, &error) != SM_OK) fail_msg("%s", error.text);
    return engine;
}

static void scene_free(Scene *scene, SmEngine *engine)
{
    type->destroy(engine);
    sm_mesh_free(&scene->mesh);
    sm_voxels_free(&scene->voxels);
}

/* Vertices whose x is beyond a bound, on that side. */
static SmHandle handle_beyond(const Scene *scene, double bound, long *particle)
{
    SmHandle handle = {.particle = particle};
    for (int d = 0; d < 3; d++) handle.pose[d][d] = 1;
    for (long v = 0; v < VERTICES; v++)
        if (scene->mesh.position[v][0] * bound > bound * bound) particle[handle.count++] = v;
    assert_true(handle.count > 10);
    return handle;
}

TEST(it_rests_where_it_was_made)
{
    needs_solver();
    Scene scene = ring_create();
    SmEngine *engine = engine_of(&scene);
    static double x[VERTICES][3];
    double mass[VERTICES], all = 0, area = 0;
    SmCounts counts;
    for (int step = 0; step < 5; step++) type->step(engine, NULL);
    type->get(engine, SM_POSITION, x);
    for (int v = 0; v < VERTICES; v++)
        for (int d = 0; d < 3; d++) assert_true(fabs(x[v][d] - scene.mesh.position[v][d]) < 1e-9);
    type->count(engine, &counts);
    assert_int_equal(counts.particles, VERTICES);
    assert_true(counts.regions > 90 && counts.regions < 160);
    type->masses(engine, mass);
    for (int v = 0; v < VERTICES; v++) all += mass[v];
    for (long t = 0; t < scene.mesh.triangle_count; t++) {
        const int *c = scene.mesh.triangle[t];
        double u[3], v[3], n[3];
        sm_subtract(scene.mesh.position[c[1]], scene.mesh.position[c[0]], u);
        sm_subtract(scene.mesh.position[c[2]], scene.mesh.position[c[0]], v);
        sm_cross(u, v, n);
        area += sqrt(sm_dot(n, n)) / 2;
    }
    assert_true(fabs(all / (1000 * 0.01 * area) - 1) < 0.04); /* of a surface that is fitted */
    scene_free(&scene, engine);
}

/* Free, it falls, and a push on one vertex is its momentum. */
TEST(it_falls_and_is_pushed)
{
    needs_solver();
    Scene scene = ring_create();
    scene.params.gravity[1] = -9.81;
    SmEngine *engine = engine_of(&scene);
    static double x[VERTICES][3], v[VERTICES][3];
    double mass[VERTICES], speed[3] = {0}, all = 0;
    const long where = 17;
    const double impulse[1][3] = {{0.3, 0, 0.1}};
    type->push(engine, 1, &where, impulse);
    for (int step = 0; step < 20; step++) type->step(engine, NULL);
    const RefShellBody *body = ref_shell_body(engine);
    for (long n = 0; n < body->sheet.warp.nodes; n++)
        for (int d = 0; d < 3; d++)
            speed[d] += body->sheet.warp.mass[n] * body->sheet.steps.v[3 * n + d];
    type->masses(engine, mass);
    for (int p = 0; p < VERTICES; p++) all += mass[p];
    assert_true(fabs(speed[1] + 9.81 * 0.2) < 1e-9);
    assert_true(fabs(speed[0] * all - 0.3) < 1e-6 && fabs(speed[2] * all - 0.1) < 1e-6);
    type->get(engine, SM_POSITION, x);
    type->get(engine, SM_VELOCITY, v);
    for (int p = 0; p < VERTICES; p++) assert_true(isfinite(x[p][0]) && fabs(v[p][1] + 1.96) < 1);
    scene_free(&scene, engine);
}

/* Held at both ends, one of which turns by 90 degrees about the axis between them; states come back
 * to what follows them; let go, it goes on. */
TEST(handles_hold_and_turn)
{
    needs_solver();
    Scene scene = ring_create();
    scene.params.damping = 0.05;
    SmEngine *engine = engine_of(&scene);
    static long left[VERTICES], right[VERTICES];
    static double x[2][VERTICES][3], rest[VERTICES][3];
    SmHandle handle[2] = {handle_beyond(&scene, -0.42, left), handle_beyond(&scene, 0.44, right)};
    SmBoundary boundary = {2, handle, 0, NULL};
    RefSheet *sheet = &ref_shell_body(engine)->sheet;
    for (int step = 1; step <= 60; step++) {
        double angle = fmin(step / 50.0, 1) * M_PI / 2;
        handle[1].pose[1][1] = handle[1].pose[2][2] = cos(angle);
        handle[1].pose[2][1] = sin(angle);
        handle[1].pose[1][2] = -sin(angle);
        type->bound(engine, &boundary);
        type->step(engine, NULL);
        for (int k = 0; k < 2; k++) {
            double place, turn;
            ref_sheet_off(sheet, k, &place, &turn);
            assert_true(place < 1e-6 && turn < 1e-6);
        }
    }
    type->get(engine, SM_REST, rest);
    type->get(engine, SM_POSITION, x[0]);
    for (int k = 0; k < 2; k++)
        for (long p = 0; p < handle[k].count; p++) {
            double wanted[3], *at = x[0][handle[k].particle[p]];
            sm_pose_apply((const double(*)[4])handle[k].pose, rest[handle[k].particle[p]], wanted);
            for (int d = 0; d < 3; d++) assert_true(fabs(at[d] - wanted[d]) < 0.03);
        }
    double *kept = sm_alloc((size_t)type->get_state(engine, NULL), sizeof *kept);
    type->get_state(engine, kept);
    for (int round = 0; round < 2; round++) {
        type->set_state(engine, kept);
        for (int step = 0; step < 4; step++) type->step(engine, NULL);
        type->get(engine, SM_POSITION, x[round]);
    }
    assert_memory_equal(x[0], x[1], sizeof x[0]);
    boundary.handle_count = 0;
    type->bound(engine, &boundary);
    type->get(engine, SM_POSITION, x[0]);
    for (int p = 0; p < VERTICES; p++)
        for (int d = 0; d < 3; d++) assert_true(fabs(x[0][p][d] - x[1][p][d]) < 1e-3);
    for (int step = 0; step < 30; step++) type->step(engine, NULL);
    type->get(engine, SM_POSITION, x[0]);
    for (int p = 0; p < VERTICES; p++) assert_true(sm_dot(x[0][p], x[0][p]) < 4);
    free(kept);
    scene_free(&scene, engine);
}

/* A pulse that is over begins again where the state of before it is put back; one that breaks has
 * no state. */
TEST(a_state_knows_the_pulse)
{
    needs_solver();
    Scene scene = ring_create();
    scene.options.pressure = 1000;
    scene.options.pulse = 0.015;
    SmEngine *engine = engine_of(&scene);
    static double x[2][VERTICES][3];
    double *kept = sm_alloc((size_t)type->get_state(engine, NULL), sizeof *kept);
    type->get_state(engine, kept);
    for (int round = 0; round < 2; round++) {
        for (int step = 0; step < 4; step++) type->step(engine, NULL);
        type->get(engine, SM_POSITION, x[round]);
        type->set_state(engine, kept);
    }
    assert_memory_equal(x[0], x[1], sizeof x[0]);
    assert_true(sm_square_between(x[0][0], scene.mesh.position[0]) > 1e-10);
    free(kept);
    type->destroy(engine);
    scene.options.strength = 1e9;
    engine = engine_of(&scene);
    assert_int_equal(type->get_state(engine, NULL), 0);
    scene_free(&scene, engine);
}

/* A handle of one vertex moves its place and lets it turn. */
TEST(one_vertex_is_pulled)
{
    needs_solver();
    Scene scene = ring_create();
    scene.params.damping = 0.05;
    SmEngine *engine = engine_of(&scene);
    static long left[VERTICES], one[1];
    static double x[VERTICES][3];
    for (long v = 0; v < VERTICES; v++)
        if (scene.mesh.position[v][0] > scene.mesh.position[*one][0]) *one = v;
    SmHandle handle[2] = {handle_beyond(&scene, -0.42, left), {.count = 1, .particle = one}};
    for (int d = 0; d < 3; d++) handle[1].pose[d][d] = 1;
    SmBoundary boundary = {2, handle, 0, NULL};
    for (int step = 1; step <= 50; step++) {
        handle[1].pose[1][3] = 0.1 * step / 50;
        type->bound(engine, &boundary);
        type->step(engine, NULL);
    }
    type->get(engine, SM_POSITION, x);
    assert_true(fabs(x[*one][1] - scene.mesh.position[*one][1] - 0.1) < 0.01);
    scene_free(&scene, engine);
}

/* One whose crack cannot be followed, here as no step can be made with its damping, stands still
 * and is drawn as it was then. */
static void stops_where_a_crack_cannot_be_followed(SmEngine *engine, SmMesh *surface)
{
    static double x[3][VERTICES][3], v[VERTICES][3];
    RefShellBody *body = ref_shell_body(engine);
    type->surface(engine, surface);
    body->sheet.options.damping.mass_damping = -1;
    for (int step = 0; step < 40 && !body->broke; step++) {
        type->get(engine, SM_POSITION, x[0]);
        type->step(engine, NULL);
    }
    SmCounts counts;
    type->count(engine, &counts);
    assert_true(body->broke && counts.stopped);
    type->get(engine, SM_POSITION, x[1]);
    assert_memory_not_equal(x[0], x[1], sizeof x[0]);
    assert_false(type->surface(engine, surface));
    SmMesh drawn = sm_mesh_new(surface->vertex_count, 0);
    type->surface_points(engine, drawn.position);
    for (int step = 0; step < 2; step++) type->step(engine, NULL);
    type->get(engine, SM_POSITION, x[2]);
    type->get(engine, SM_VELOCITY, v);
    assert_memory_equal(x[1], x[2], sizeof x[1]);
    for (int p = 0; p < VERTICES; p++) assert_true(sm_dot(v[p], v[p]) == 0);
    assert_false(type->surface(engine, surface));
    type->surface_points(engine, surface->position);
    assert_memory_equal(drawn.position, surface->position,
                        (size_t)drawn.vertex_count * sizeof *drawn.position);
    sm_mesh_free(&drawn);
}

/* A ring that is pulled apart by two handles cracks between them, and they go on holding it. */
TEST(handles_hold_what_cracks)
{
    needs_solver();
    Scene scene = ring_create();
    scene.options.covers = 4.5;
    scene.options.strength = 2e4;
    scene.params.h = 2e-3;
    scene.params.damping = 0.02;
    SmEngine *engine = engine_of(&scene);
    static long left[VERTICES], right[VERTICES];
    static double x[VERTICES][3];
    SmHandle handle[2] = {handle_beyond(&scene, -0.42, left), handle_beyond(&scene, 0.44, right)};
    SmBoundary boundary = {2, handle, 0, NULL};
    const RefShellBody *body = ref_shell_body(engine);
    long nodes = body->sheet.shell.nodes.count, changes = 0;
    for (int step = 1; step <= 14; step++) {
        long arms = body->breaking->cracked.cracks.pieces;
        handle[1].pose[0][3] = 0.004 * step;
        type->bound(engine, &boundary);
        type->step(engine, NULL);
        changes += body->breaking->cracked.cracks.pieces > arms;
        assert_int_equal(body->sheet.holds, 2);
        for (int k = 0; k < 2 && body->breaking->cracked.cracks.pieces == arms; k++) {
            double place, turn;
            ref_sheet_off(&body->sheet, k, &place, &turn);
            assert_true(place < 1e-6 && turn < 1e-6);
        }
    }
    assert_true(changes > 2 && body->sheet.shell.nodes.count > nodes);
    type->get(engine, SM_POSITION, x);
    for (int k = 0; k < 2; k++)
        for (long p = 0; p < handle[k].count; p++) {
            const double *rest = scene.mesh.position[handle[k].particle[p]];
            double wanted[3] = {rest[0] + handle[k].pose[0][3], rest[1], rest[2]};
            assert_true(sm_square_between(x[handle[k].particle[p]], wanted) < 0.03 * 0.03);
        }
    scene_free(&scene, engine);
}

/* What carries points is what would be made of the shell as it is now. */
static void check_carried(SmEngine *engine, long count)
{
    const RefShellBody *body = ref_shell_body(engine);
    const RefWarp *warp = &body->sheet.warp;
    double(*rest)[3] = sm_alloc(3 * (size_t)count, sizeof *rest), (*x)[3] = rest + count;
    double(*place)[3] = x + count;
    RefSkin skin;
    long loose;
    type->get(engine, SM_REST, rest);
    type->get(engine, SM_POSITION, x);
    ref_foot_skin(&body->sheet.shell, warp, count, (const double(*)[2])body->map.theta,
                  (const double(*)[3])rest, &skin, &loose);
    ref_skin_place(&skin, (const double(*)[3])warp->moved, (const double(*)[3])warp->turned, place);
    assert_int_equal(loose, body->loose);
    for (long s = 0; s < count; s++)
        assert_true(sm_square_between(place[s], x[skin.order[s]]) < 1e-12);
    ref_skin_free(&skin);
    free(rest);
}

/* One step of a shell that is blown up: its energy is no more than what the pressure would give to
 * loose dust, and does not grow any more after the pulse, however cracks run. */
static void burst(const Scene *scene, SmEngine *engine, double *time, double *energy)
{
    const RefMeshlessOptions *options = &scene->options;
    RefSteps *steps = &ref_shell_body(engine)->sheet.steps;
    bool blown = *time < options->pulse;
    type->step(engine, NULL);
    *time += scene->params.h;
    size_t nodes = (size_t)steps->matrices->mass.columns;
    double *sum = sm_alloc(nodes, sizeof *sum), mass = 0, before = *energy;
    ref_sparse_sums(&steps->matrices->mass, sum);
    for (size_t n = 0; n < nodes; n++) mass += sum[n];
    double speed = options->pressure * fmin(*time, options->pulse) /
                   (options->material.density * options->thickness);
    *energy = ref_steps_energy(steps);
    assert_true(*energy <= (blown ? mass * speed * speed / 2 : before) * (1 + 1e-3));
    free(sum);
}

/* One that does not break takes no more from a pulse either. */
TEST(a_pulse_gives_no_more_than_to_dust)
{
    needs_solver();
    Scene scene = ring_create();
    double time = 0, energy = 0;
    scene.options.pressure = 1000;
    scene.options.pulse = 0.015;
    SmEngine *engine = engine_of(&scene);
    for (int step = 0; step < 40; step++) burst(&scene, engine, &time, &energy);
    assert_true(energy > 0);
    scene_free(&scene, engine);
}

/* A pulse of pressure bursts it: nodes are added where cracks run, and what is drawn of the surface
 * comes apart in pieces that are closed. `flying` is the share of its vertices that may be far
 * away: light slivers are. */
static SmEngine *blow_up(Scene *scene, int steps, double flying, SmMesh *surface)
{
    scene->options.covers = 4.5;
    scene->options.branching = 2;
    scene->params.h = 5e-4;
    SmEngine *engine = engine_of(scene);
    const RefShellBody *body = ref_shell_body(engine);
    assert_true(type->surface(engine, surface));
    SmMeshInfo before = sm_mesh_info(surface);
    long nodes = body->sheet.shell.nodes.count;
    double time = 0, energy = 0;
    long far = 0;
    for (int step = 0; step < steps; step++) burst(scene, engine, &time, &energy);
    assert_true(energy > 0 && body->sheet.shell.nodes.count > nodes);
    assert_true(type->surface(engine, surface));
    SmMeshInfo after = sm_mesh_info(surface);
    assert_true(after.watertight && after.triangles > before.triangles);
    assert_true(after.components > before.components);
    type->surface_points(engine, surface->position);
    for (long v = 0; v < surface->vertex_count; v++) {
        const double *x = surface->position[v];
        assert_true(isfinite(x[0] + x[1] + x[2]));
        far += sm_dot(x, x) >= 4;
    }
    assert_true((double)far <= flying * (double)surface->vertex_count);
    check_carried(engine, scene->mesh.vertex_count);
    print_message("%ld nodes that end as %ld, in %d pieces, %ld of them drawn\n", nodes,
                  body->sheet.shell.nodes.count, (int)body->sheet.warp.pieces, after.components);
    return engine;
}

TEST(one_that_is_blown_up_comes_apart)
{
    needs_solver();
    Scene scene = ring_create();
    SmMesh surface = {0};
    scene.options.strength = 1e5;
    scene.options.pressure = 2e4;
    scene.options.pulse = 0.004;
    SmEngine *engine = blow_up(&scene, 12, 0, &surface);
    stops_where_a_crack_cannot_be_followed(engine, &surface);
    sm_mesh_free(&surface);
    scene_free(&scene, engine);
}

/* So do a double torus and a sheet with two holes. */
TEST(so_do_those_of_several_cylinders)
{
    needs_solver();
    unsigned seed = 1;
    for (int open = 0; open < 2; open++) {
        SmMesh mesh =
            open ? plate_mesh(&two_holes, 30, 0.05, &seed) : tori_mesh(&double_torus, 45, &seed);
        for (long v = 0; v < mesh.vertex_count; v++)
            for (int d = 0; d < 3; d++) mesh.position[v][d] *= 0.16;
        sm_mesh_merge(&mesh);
        Scene scene = scene_of(mesh);
        SmMesh surface = {0};
        scene.options.nodes = 250;
        scene.options.strength = open ? 2e4 : 1e5;
        scene.options.pressure = 2e4;
        scene.options.pulse = 0.004;
        SmEngine *engine = blow_up(&scene, 20, 0.01, &surface);
        assert_non_null(ref_shell_body(engine)->map.chart.cylinders);
        sm_mesh_free(&surface);
        scene_free(&scene, engine);
    }
}

/* Modes that are shown leave the motion as it is; they rise from what deforms the body, and as
 * solid bodies' are as large as is asked for, in both ways. */
TEST(modes_are_shown_beside_the_motion)
{
    needs_solver();
    Scene scene = ring_create();
    scene.params.gravity[1] = -9.81;
    SmEngine *engine = engine_of(&scene);
    static double x[3][VERTICES][3], v[VERTICES][3];
    const RefModes *modes;
    double hertz = 0, least = INFINITY;
    for (int step = 0; step < 3; step++) type->step(engine, NULL);
    long size = type->get_state(engine, NULL);
    double *before = sm_alloc((size_t)size, sizeof *before),
           *after = sm_alloc((size_t)size, sizeof *after);
    type->get_state(engine, before);
    assert_int_equal(ref_shell_find_modes(engine, 5, &modes, NULL), SM_OK);
    assert_int_equal(modes->count, 11);
    for (int k = 0; k < 5; k++) {
        double far = 0;
        for (int n = 0; n < 3; n++) {
            double now = ref_shell_show(engine, k, 0.02 * (n - 1));
            assert_true(now >= hertz);
            hertz = now;
            type->get(engine, SM_POSITION, x[n]);
            type->get(engine, SM_VELOCITY, v);
            assert_true(sm_dot(v[0], v[0]) == 0);
        }
        for (int p = 0; p < VERTICES; p++) {
            double way[3], back[3];
            sm_subtract(x[2][p], x[1][p], way);
            sm_subtract(x[0][p], x[1][p], back);
            far = fmax(far, sqrt(sm_dot(way, way)));
            for (int d = 0; d < 3; d++) {
                assert_true(fabs(way[d] + back[d]) < 0.005); /* but for the squares of turns */
                assert_true(fabs(x[1][p][d] - scene.mesh.position[p][d]) < 1e-9);
            }
        }
        assert_true(fabs(far - 0.02) < 0.002);
        least = fmin(least, hertz);
    }
    assert_true(modes->lambda[5] < 1e-5 * pow(2 * M_PI * least, 2));
    type->get_state(engine, after);
    assert_memory_equal(before, after, (size_t)size * sizeof *before);
    sm_free_all(before, after);
    scene_free(&scene, engine);
}

TEST(what_it_refuses)
{
    needs_solver();
    Scene scene = ring_create();
    SmEngine *engine = NULL;
    SmError error;
    scene.options.material.poisson = 0.6;
    assert_int_equal(create(&scene, &engine, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "Poisson"));
    scene.options.material.poisson = 0.3;
    scene.params.strain_limit = 1.5;
    assert_int_equal(create(&scene, &engine, &error), SM_INPUT);
    scene.params.strain_limit = 0;
    scene.options.thickness = 1.1;
    assert_int_equal(create(&scene, &engine, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "thickness 1.1 is more than"));
    scene_free(&scene, NULL);
}
