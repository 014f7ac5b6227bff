/* The public face, against what is behind it, and against misuse. */
#include "shapebench.h"

#include <pthread.h>

#include "../../fastlsm/fastlsm.h"
#include "../../octree/change/structure.h"
#include "../../octree/engine.h"
#include "../../octree/surface/surface.h"
#include "../../reference/brute.h"
#include "../../reference/meshless/engine.h"
#include "../../reference/meshless/shell_engine.h"
#include "../../reference/meshless/solve/solver.h"
#include "../mesh/import.h"
#include "../shapes/shape.h"
#include "../test_fields.h"
#include "../test_folder.h"
#include "../test_frame.h"
#include "../voxel/embed.h"
#include "../voxel/voxelise.h"

#define OK(call) assert_int_equal(call, SB_OK)

/* The call is refused, and its line has the text in it. */
static void refused(int code, int wanted, const sb_error *error, const char *text)
{
    assert_int_equal(code, wanted);
    assert_int_equal(error->code, wanted);
    if (!strstr(error->text, text)) fail_msg("\"%s\" lacks \"%s\"", error->text, text);
}
#define REFUSED(call, text)  refused(call, SB_USAGE, &error, text)
#define UNUSABLE(call, text) refused(call, SB_INPUT, &error, text)

static const double nowhere[3] = {0}, up[3] = {0, 1, 0};

static void *room_for(int64_t count, size_t size)
{
    return sm_alloc((size_t)count, size);
}

static sb_mesh *shape(const char *name)
{
    sb_mesh *mesh;
    OK(sb_mesh_shape(name, &mesh, NULL));
    return mesh;
}

static sb_voxels *voxels_of(const sb_mesh *mesh, int64_t particles)
{
    sb_voxel_params how;
    sb_voxels *voxels;
    sb_voxel_params_init(&how);
    how.particles = particles;
    OK(sb_voxels_of_mesh(mesh, &how, &voxels, NULL));
    return voxels;
}

static sb_voxels *block_of(int x, int y, int z)
{
    sb_voxels *voxels;
    OK(sb_voxels_make((int[3]){x, y, z}, 0.1, NULL, NULL, &voxels, NULL));
    return voxels;
}

/* A box with its corners a hundredth inside a block's. */
static sb_mesh *box_in(double x, double y, double z)
{
    static const int face[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                    {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                    {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    double corner[8][3];
    for (int c = 0; c < 8; c++) {
        corner[c][0] = c & 1 ? x - 0.001 : 0.001;
        corner[c][1] = c & 2 ? y - 0.001 : 0.001;
        corner[c][2] = c & 4 ? z - 0.001 : 0.001;
    }
    sb_mesh *mesh;
    OK(sb_mesh_make(8, corner[0], 12, face[0], &mesh, NULL));
    return mesh;
}

static sb_body_params params_of(int engine)
{
    sb_body_params params;
    sb_body_params_init(&params);
    params.engine = engine;
    params.gravity[1] = -9.81;
    params.damping = 0.1;
    return params;
}

/* Of a body that is soon made. */
static void small_meshless(sb_meshless_params *meshless)
{
    sb_meshless_params_init(meshless);
    meshless->young = 2e5;
    meshless->points = 3000;
    meshless->nodes = 60;
    meshless->modes = 12;
}

static void small_shell(sb_shell_params *shell)
{
    sb_shell_params_init(shell);
    shell->young = 2e5;
    shell->nodes = 60;
    shell->thickness = 0.02;
}

static sb_body *body_of(const sb_voxels *voxels, const sb_mesh *surface,
                        const sb_body_params *params)
{
    sb_body *body;
    sb_error error;
    if (sb_body_create(voxels, surface, params, &body, &error)) fail_msg("%s", error.text);
    assert_string_equal(error.text, "");
    return body;
}

static sb_body_counts counts_of(const sb_body *body)
{
    sb_body_counts counts;
    OK(sb_body_count(body, &counts, NULL));
    return counts;
}

static double *read_field(sb_body *body, int field)
{
    int64_t count = counts_of(body).particles;
    double *values = room_for(count, 3 * sizeof *values);
    OK(sb_body_read(body, field, values, count, NULL));
    return values;
}

TEST(the_library_says_what_it_is)
{
    char text[32];
    snprintf(text, sizeof text, "%d.%d.%d", sb_version() / 10000, sb_version() / 100 % 100,
             sb_version() % 100);
    assert_string_equal(sb_version_text(), text);
    assert_int_equal(sb_version(), SHAPEBENCH_VERSION);
    assert_string_equal(sb_engine_name(SB_OCTREE), "octree");
    assert_null(sb_engine_name(-1));
    assert_string_equal(sb_engine_name(SB_THIN_SHELL), "shell");
    assert_null(sb_engine_name(5));
    assert_true(sb_engine_available(SB_FASTLSM) && sb_engine_available(SB_OCTREE));
    assert_true(sb_engine_available(SB_BRUTE));
    assert_int_equal(sb_engine_available(SB_MESHLESS), ref_solver_built);
    assert_int_equal(sb_engine_available(SB_THIN_SHELL), ref_solver_built);
    int shapes, named = 0;
    sm_shapes(&shapes);
    while (sb_shape_name(named)) named++;
    assert_int_equal(named, shapes);
    assert_null(sb_shape_name(-1));
}

/* What the handles give of a mesh equals the mesh inside. */
static void compare_meshes(const sb_mesh *mesh, const SmMesh *inner)
{
    sb_mesh_facts facts;
    OK(sb_mesh_measure(mesh, &facts, NULL));
    SmMeshInfo info = sm_mesh_info(inner);
    assert_int_equal(facts.vertices, inner->vertex_count);
    assert_int_equal(facts.triangles, inner->triangle_count);
    assert_int_equal(facts.watertight, info.watertight);
    assert_int_equal(facts.components, info.components);
    assert_memory_equal(&facts.volume, &info.volume, sizeof info.volume);
    assert_memory_equal(facts.high, info.high, sizeof info.high);
    double *position = room_for(facts.vertices, 3 * sizeof *position);
    int *triangle = room_for(facts.triangles, 3 * sizeof *triangle);
    OK(sb_mesh_read_vertices(mesh, position, facts.vertices, NULL));
    OK(sb_mesh_read_triangles(mesh, triangle, facts.triangles, NULL));
    assert_memory_equal(position, inner->position, (size_t)facts.vertices * 24);
    assert_memory_equal(triangle, inner->triangle, (size_t)facts.triangles * 12);
    sm_free_all(position, triangle);
}

TEST(meshes_are_those_inside)
{
    const char *path = path_in("penguin.obj");
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    SmMesh inner;
    sb_mesh *mesh = shape("penguin");
    assert_int_equal(sm_shape_mesh("penguin", &inner, NULL), SM_OK);
    compare_meshes(mesh, &inner);
    sm_mesh_print_obj(&inner, stream);
    fclose(stream);
    sm_mesh_free(&inner);
    sb_mesh_free(mesh);
    sb_load_params limits;
    sb_load_params_init(&limits);
    limits.seconds = 60;
    sb_error error = {0};
    int code = sb_mesh_load(path, &limits, &mesh, &error);
    OK(code);
    assert_int_equal(sm_import(path, NULL, &inner, NULL, NULL), SM_OK);
    compare_meshes(mesh, &inner);
    sm_mesh_free(&inner);
    sb_mesh_free(mesh);
}

TEST(voxels_are_those_inside)
{
    SmMesh mesh;
    SmVoxels inner;
    sm_shape_mesh("penguin", &mesh, NULL);
    sm_voxelise(&mesh, &(SmVoxelParams){SM_SOLID, 0, 500, false}, "penguin", &inner, NULL);
    sb_mesh *outer = shape("penguin");
    sb_voxels *voxels = voxels_of(outer, 500), *copy;
    sb_voxel_facts facts;
    OK(sb_voxels_measure(voxels, &facts, NULL));
    assert_int_equal(facts.particles, inner.particle_count);
    assert_int_equal(facts.material, inner.cell_count);
    assert_int_equal(facts.inside, SB_INSIDE_CLOSED);
    assert_true(facts.cell == inner.cell && facts.origin[2] == inner.origin[2]);
    double *x = room_for(facts.particles, 24), *mass = room_for(facts.particles, 8),
           *wanted = room_for(facts.particles, 8);
    int(*at)[3] = room_for(facts.particles, sizeof *at);
    OK(sb_voxels_read_particles(voxels, x, facts.particles, NULL));
    sm_voxels_particles(&inner, at);
    for (long p = 0; p < facts.particles; p++)
        assert_true(x[3 * p + 1] == inner.origin[1] + inner.cell * at[p][1]);
    OK(sb_voxels_weigh(voxels, 700, mass, facts.particles, NULL));
    sm_voxels_weigh(&inner, 700, wanted);
    assert_memory_equal(mass, wanted, (size_t)facts.particles * 8);
    int64_t all = (int64_t)facts.cells[0] * facts.cells[1] * facts.cells[2], material = 0;
    uint8_t *filled = room_for(all, 1);
    OK(sb_voxels_read_cells(voxels, filled, all, NULL));
    OK(sb_voxels_make(facts.cells, facts.cell, facts.origin, filled, &copy, NULL));
    for (int64_t c = 0; c < all; c++) material += filled[c];
    assert_int_equal(material, facts.material);
    OK(sb_voxels_measure(copy, &facts, NULL));
    assert_int_equal(facts.particles, inner.particle_count);
    sm_mesh_free(&mesh);
    sm_voxels_free(&inner);
    sb_voxels_free(voxels);
    sb_voxels_free(copy);
    sb_mesh_free(outer);
    sm_free_all(x, mass, wanted, at, filled);
}

/* ---- bodies against their engines */

static const SmEngineType *const types[5][2] = {{&fastlsm_engine_f32, &fastlsm_engine_f64},
                                                {&octree_engine_f32, &octree_engine_f64},
                                                {NULL, &ref_brute_engine},
                                                {NULL, &ref_meshless_engine},
                                                {NULL, &ref_shell_engine}};

enum { STEPS = 12 };

/* [particles][3], and of the surface [vertices][3]. */
typedef struct {
    double *x, *v, *g, *surface;
} Motion;

static Motion motion_of(const sb_body_counts *counts)
{
    return (Motion){room_for(counts->particles, 24), room_for(counts->particles, 24),
                    room_for(counts->particles, 24), room_for(counts->surface_vertices, 24)};
}

static void carry_inside(const SmEngineType *type, const SmEngine *engine, const SmVoxels *voxels,
                         const SmMesh *mesh, const double (*x)[3], double (*surface)[3])
{
    if (type->vertices) {
        memcpy(surface, x, (size_t)mesh->vertex_count * sizeof *surface);
    } else if (!type->refines) {
        SmEmbedding embedding;
        sm_embed_create(mesh, voxels, &embedding);
        sm_embed_apply(&embedding, x, surface, NULL);
        sm_embed_free(&embedding);
    } else {
        OctSurface carried;
        const OctStructure *s = oct_engine_structure(engine);
        OctCarrier carrier = {voxels, &s->tree, &s->graph, NULL};
        oct_surface_build(mesh, &carrier, &carried);
        oct_surface_move(&carried, x, surface, NULL);
        oct_surface_free(&carried);
    }
}

/* The same motion by the engine itself. */
static void move_inside(const SmEngineType *type, const SmVoxels *voxels, const SmMesh *mesh,
                        const int64_t *held, int64_t count, Motion *to)
{
    SmEngine *engine;
    const RefMeshlessOptions meshless = {.mesh = mesh,
                                         .points = 3000,
                                         .nodes = 60,
                                         .modes = 12,
                                         .thickness = 0.02,
                                         .material = {2e5, 0.3, 1000}};
    SmEngineParams params = {.w = 2,
                             .h = 0.01,
                             .damping = 0.1,
                             .damping_every = 1,
                             .gravity = {0, -9.81, 0},
                             .meshless = &meshless};
    assert_int_equal(type->create(voxels, &params, &engine, NULL), SM_OK);
    SmHandle handle = {count, (const long *)held, {{1, 0, 0, 0.02}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    SmObstacle obstacles[] = {{SM_PLANE, {0, -0.01, 0}, {0, 1, 0}, 0, 0.2},
                              {SM_SPHERE, {0, 1, 0}, {0}, 0.3, 0},
                              {SM_BOX, {1, 0, 0}, {2, 1, 1}, 0, 0.5},
                              {SM_CAPSULE, {-1, 0, 0}, {-1, 1, 0}, 0.2, 1}};
    SmBoundary boundary = {1, &handle, type->unstopped ? 0 : 4, obstacles};
    type->bound(engine, &boundary);
    for (int step = 0; step < STEPS; step++) {
        long pushed = 3;
        type->push(engine, 1, &pushed, (const double[1][3]){{0.01, 0.02, 0}});
        type->step(engine, NULL);
    }
    type->get(engine, SM_POSITION, (double(*)[3])to->x);
    type->get(engine, SM_VELOCITY, (double(*)[3])to->v);
    if (type->goals) type->goals(engine);
    type->get(engine, SM_GOAL, (double(*)[3])to->g);
    carry_inside(type, engine, voxels, mesh, (const double(*)[3])to->x, (double(*)[3])to->surface);
    type->destroy(engine);
}

static void compare_field(sb_body *body, int field, const double *wanted)
{
    double *found = read_field(body, field);
    assert_memory_equal(found, wanted, (size_t)counts_of(body).particles * 24);
    free(found);
}

/* Particles in the uppermost tenth; there is nothing outside of a large ball. */
static int64_t select_top(sb_body *body, int64_t *held)
{
    int64_t all = counts_of(body).particles, count, again;
    double *rest = read_field(body, SB_REST), top = -1;
    for (int64_t p = 0; p < all; p++) top = fmax(top, rest[3 * p + 1]);
    free(rest);
    OK(sb_body_select_box(body, (double[3]){-9, top - 0.1, -9}, (double[3]){9, 9, 9}, held, all,
                          &count, NULL));
    assert_in_range(count, 1, all - 1);
    OK(sb_body_select_ball(body, nowhere, 100, NULL, 0, &again, NULL));
    assert_int_equal(again, all);
    return count;
}

static void obstacles_outside(sb_body *body)
{
    int obstacle;
    OK(sb_body_add_plane(body, (double[3]){0, -0.01, 0}, (double[3]){0, 3, 0}, 0.2, &obstacle,
                         NULL));
    OK(sb_body_add_sphere(body, nowhere, 9, 0, &obstacle, NULL));
    OK(sb_body_remove_obstacle(body, obstacle, NULL));
    OK(sb_body_add_sphere(body, (double[3]){0, 1, 0}, 0.3, 0, &obstacle, NULL));
    OK(sb_body_add_box(body, (double[3]){1, 0, 0}, (double[3]){2, 1, 1}, 0.5, &obstacle, NULL));
    OK(sb_body_add_capsule(body, (double[3]){-1, 0, 0}, (double[3]){-1, 1, 0}, 0.2, 1, &obstacle,
                           NULL));
}

/* A handle and obstacles, others of which come and go. */
static void bound_outside(sb_body *body, const int64_t *held, int64_t count, bool stopped)
{
    int handle, gone;
    OK(sb_body_add_handle(body, 1, (int64_t[1]){held[0]}, &gone, NULL));
    OK(sb_body_remove_handle(body, gone, NULL));
    OK(sb_body_add_handle(body, count, held, &handle, NULL));
    OK(sb_body_move_handle(body, handle, (double[12]){1, 0, 0, 0.02, 0, 1, 0, 0, 0, 0, 1, 0},
                           NULL));
    if (stopped) obstacles_outside(body);
}

static void compare_surface(sb_body *body, const double *wanted)
{
    int64_t vertices = counts_of(body).surface_vertices;
    double *found = room_for(vertices, 24), *normal = room_for(vertices, 24);
    OK(sb_body_read_surface(body, found, normal, vertices, NULL));
    assert_memory_equal(found, wanted, (size_t)vertices * 24);
    for (int64_t n = 0; n < 3 * vertices; n += 3)
        assert_float_equal(hypot(hypot(normal[n], normal[n + 1]), normal[n + 2]), 1, 1e-6);
    sm_free_all(found, normal);
}

static void compare_motion(int engine, int precision)
{
    sb_mesh *mesh = shape("penguin");
    sb_voxels *voxels = voxels_of(mesh, 500);
    SmMesh inner_mesh;
    SmVoxels inner;
    sm_shape_mesh("penguin", &inner_mesh, NULL);
    sm_voxelise(&inner_mesh, &(SmVoxelParams){SM_SOLID, 0, 500, false}, "", &inner, NULL);
    const SmEngineType *type = types[engine][precision];
    sb_meshless_params meshless;
    sb_shell_params shell;
    small_meshless(&meshless);
    small_shell(&shell);
    sb_body_params params = params_of(engine);
    params.precision = precision;
    params.meshless = &meshless;
    params.shell = &shell;
    sb_body *body = body_of(voxels, mesh, &params);
    sb_body_counts counts = counts_of(body);
    int64_t *held = room_for(counts.particles, sizeof *held), count = select_top(body, held);
    bound_outside(body, held, count, !type->unstopped);
    for (int step = 0; step < STEPS; step++) {
        OK(sb_body_push(body, 1, (int64_t[1]){3}, (double[3]){0.01, 0.02, 0}, NULL));
        OK(sb_body_step(body, 1, NULL));
    }
    Motion wanted = motion_of(&counts);
    move_inside(type, &inner, &inner_mesh, held, count, &wanted);
    compare_field(body, SB_POSITION, wanted.x);
    compare_field(body, SB_VELOCITY, wanted.v);
    if (type->goals) compare_field(body, SB_GOAL, wanted.g);
    compare_surface(body, wanted.surface);
    counts = counts_of(body);
    assert_int_equal(counts.steps, STEPS);
    assert_float_equal(counts.time, STEPS * 0.01, 1e-12);
    sb_body_free(body);
    sb_voxels_free(voxels);
    sb_mesh_free(mesh);
    sm_mesh_free(&inner_mesh);
    sm_voxels_free(&inner);
    sm_free_all(held, wanted.x, wanted.v, wanted.g, wanted.surface);
}

TEST(bodies_move_as_their_engines_do)
{
    for (int engine = SB_FASTLSM; engine <= SB_THIN_SHELL; engine++)
        for (int precision = SB_SINGLE; precision <= SB_DOUBLE; precision++)
            if (types[engine][precision] && sb_engine_available(engine))
                compare_motion(engine, precision);
}

/* What a shell has not: goals, regions, and particles that could be put anywhere. */
static void shell_refuses(sb_body *body)
{
    sb_error error;
    int64_t n = counts_of(body).particles, count;
    double *x = read_field(body, SB_POSITION);
    REFUSED(sb_body_read(body, SB_GOAL, x, n, &error), "no goals");
    REFUSED(sb_body_write(body, SB_POSITION, x, n, &error), "handles and pushes");
    REFUSED(sb_body_write(body, SB_VELOCITY, x, n, &error), "handles and pushes");
    REFUSED(sb_body_read_region(body, 0, NULL, 0, &count, &error), "no regions");
    REFUSED(sb_body_read_shapes(body, NULL, 9, &error), "'shape'");
    REFUSED(sb_body_add_detail(body, &(int){0}, &error), "a body of shell");
    double *after = read_field(body, SB_POSITION);
    assert_memory_equal(x, after, (size_t)n * 24);
    sm_free_all(x, after);
}

/* What a reference does not do is refused. */
static void refuses_what_it_has_not(int engine)
{
    static const double turned[12] = {0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0};
    bool elastic = engine != SB_BRUTE;
    sb_mesh *mesh = shape("block");
    sb_voxels *voxels = voxels_of(mesh, 100);
    sb_body *body;
    sb_error error;
    sb_body_params params = params_of(engine);
    sb_meshless_params meshless;
    sb_shell_params shell;
    int64_t count;
    int obstacle;
    double mass[1000] = {0};
    UNUSABLE(sb_body_create(voxels, mesh, &params, &body, &error), "double precision only");
    params.precision = SB_DOUBLE;
    params.cuttable = 1;
    if (engine != SB_MESHLESS)
        UNUSABLE(sb_body_create(voxels, mesh, &params, &body, &error), "cuts no bodies");
    params.cuttable = 0;
    small_meshless(&meshless);
    small_shell(&shell);
    params.meshless = TEST_FIGURES ? NULL : &meshless; /* all as it is without */
    params.shell = &shell;
    params.pose = turned;
    if (elastic) UNUSABLE(sb_body_create(voxels, mesh, &params, &body, &error), "'pose' turns");
    params.pose = NULL;
    params.mass = mass;
    if (elastic) UNUSABLE(sb_body_create(voxels, mesh, &params, &body, &error), "'density'");
    params.mass = NULL;
    body = body_of(voxels, mesh, &params);
    REFUSED(sb_body_read_contacts(body, NULL, 0, &count, &error), "does not list contacts");
    const double triangle[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    REFUSED(sb_body_cut(body, 3, triangle, 1, (int[3]){0, 1, 2}, &error), "not made to be cut");
    if (elastic)
        REFUSED(sb_body_add_sphere(body, nowhere, 9, 0, &obstacle, &error),
                "obstacles do not stop");
    if (engine == SB_THIN_SHELL) shell_refuses(body);
    sb_body_free(body);
    sb_voxels_free(voxels);
    sb_mesh_free(mesh);
}

TEST(references_refuse_what_they_do_not_do)
{
    for (int engine = SB_BRUTE; engine <= SB_THIN_SHELL; engine++)
        if (sb_engine_available(engine)) refuses_what_it_has_not(engine);
}

/* ---- shells that crack */

/* A block that is blown up, in both ways. */
static sb_body *bursting_body(const sb_mesh *mesh, const sb_voxels *voxels)
{
    sb_shell_params shell;
    small_shell(&shell);
    shell.covers = 4.5;
    shell.strength = 1e4;
    shell.branching = 2;
    shell.pressure = 1e4;
    shell.pulse = 0.01;
    sb_body_params params = params_of(SB_THIN_SHELL);
    params.precision = SB_DOUBLE;
    params.h = 0.001;
    params.shell = &shell;
    return body_of(voxels, mesh, &params);
}

static SmEngine *bursting_engine(const SmMesh *mesh, const SmVoxels *voxels)
{
    const RefMeshlessOptions options = {.mesh = mesh,
                                        .nodes = 60,
                                        .thickness = 0.02,
                                        .covers = 4.5,
                                        .strength = 1e4,
                                        .branching = 2,
                                        .pressure = 1e4,
                                        .pulse = 0.01,
                                        .material = {2e5, 0.3, 1000}};
    SmEngineParams params = {
        .w = 2, .h = 0.001, .damping = 0.1, .gravity = {0, -9.81, 0}, .meshless = &options};
    SmEngine *engine;
    assert_int_equal(ref_shell_engine.create(voxels, &params, &engine, NULL), SM_OK);
    return engine;
}

/* The body's surface, in place and at rest, is what the engine draws. */
static void compare_drawn(sb_body *body, SmEngine *engine, SmMesh *drawn)
{
    ref_shell_engine.surface(engine, drawn);
    sb_body_counts counts = counts_of(body);
    int64_t vertices = counts.surface_vertices, triangles = counts.surface_triangles;
    assert_int_equal(vertices, drawn->vertex_count);
    assert_int_equal(triangles, drawn->triangle_count);
    assert_int_equal(counts.stopped, 0);
    double *found = room_for(vertices, 24), *wanted = room_for(vertices, 24);
    int *triangle = room_for(triangles, 12);
    OK(sb_body_read_surface_triangles(body, triangle, triangles, NULL));
    assert_memory_equal(triangle, drawn->triangle, (size_t)triangles * 12);
    OK(sb_body_read_surface_rest(body, found, vertices, NULL));
    assert_memory_equal(found, drawn->position, (size_t)vertices * 24);
    ref_shell_engine.surface_points(engine, (double(*)[3])wanted);
    OK(sb_body_read_surface(body, found, NULL, vertices, NULL));
    assert_memory_equal(found, wanted, (size_t)vertices * 24);
    sm_free_all(found, wanted, triangle);
}

TEST(a_shell_comes_apart_as_in_its_engine)
{
    needs(ref_solver_built, "this library was built without CHOLMOD and ARPACK");
    sb_error error;
    sb_mesh *mesh = shape("block");
    sb_voxels *voxels = voxels_of(mesh, 100);
    SmMesh inner_mesh, drawn = {0};
    SmVoxels inner;
    sm_shape_mesh("block", &inner_mesh, NULL);
    sm_voxelise(&inner_mesh, &(SmVoxelParams){SM_SOLID, 0, 100, false}, "", &inner, NULL);
    sb_body *body = bursting_body(mesh, voxels);
    SmEngine *engine = bursting_engine(&inner_mesh, &inner);
    compare_drawn(body, engine, &drawn);
    sb_body_counts before = counts_of(body);
    assert_int_equal(before.surface_vertices, 2 * before.particles);
    for (int call = 0; call < 4; call++) {
        OK(sb_body_step(body, 4, NULL));
        for (int step = 0; step < 4; step++) ref_shell_engine.step(engine, NULL);
        compare_drawn(body, engine, &drawn);
    }
    sb_body_counts after = counts_of(body);
    assert_int_equal(after.particles, before.particles);
    assert_true(after.surface_vertices > before.surface_vertices);
    int piece[1000];
    int64_t count;
    REFUSED(sb_body_read_pieces(body, piece, 1000, &count, &error), "pieces of what cracks");
    ref_shell_engine.destroy(engine);
    sb_body_free(body);
    sb_voxels_free(voxels);
    sb_mesh_free(mesh);
    sm_voxels_free(&inner);
    sm_mesh_free(&inner_mesh);
    sm_mesh_free(&drawn);
}

TEST(shells_out_of_range_are_refused)
{
    needs(ref_solver_built, "this library was built without CHOLMOD and ARPACK");
    sb_error error;
    sb_mesh *mesh = shape("block");
    sb_voxels *voxels = voxels_of(mesh, 100);
    sb_body *body;
    static const struct {
        size_t place;
        double value;
        const char *text;
    } bad[] = {
        {offsetof(sb_shell_params, young), 0, "young"},
        {offsetof(sb_shell_params, poisson), 0.5, "poisson"},
        {offsetof(sb_shell_params, density), NAN, "density"},
        {offsetof(sb_shell_params, stiffness_damping), -1, "stiffness_damping"},
        {offsetof(sb_shell_params, thickness), -0.1, "thickness"},
        {offsetof(sb_shell_params, covers), 13, "covers"},
        {offsetof(sb_shell_params, strength), INFINITY, "strength"},
        {offsetof(sb_shell_params, branching), -2, "branching"},
        {offsetof(sb_shell_params, pressure), 1e30, "1e9 cells in a step"},
        {offsetof(sb_shell_params, pressure), NAN, "pressure"},
        {offsetof(sb_shell_params, pulse), NAN, "pulse"},
    };
    for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
        sb_shell_params shell;
        small_shell(&shell);
        memcpy((char *)&shell + bad[n].place, &bad[n].value, sizeof bad[n].value);
        sb_body_params params = params_of(SB_THIN_SHELL);
        params.precision = SB_DOUBLE;
        params.shell = &shell;
        REFUSED(sb_body_create(voxels, mesh, &params, &body, &error), bad[n].text);
        assert_null(body);
    }
    sb_voxels_free(voxels);
    sb_mesh_free(mesh);
}

TEST(what_is_written_is_read)
{
    sb_voxels *voxels = block_of(3, 4, 5);
    sb_body_params params = params_of(SB_OCTREE);
    sb_octree_params octree;
    sb_octree_params_init(&octree);
    octree.levels = 1;
    octree.creep = 20;
    octree.criteria_count = 1;
    octree.criteria[0] = (sb_criterion){.kind = SB_CELLS_ALL};
    octree.width_count = 1;
    octree.widths[0] = (sb_local_width){.edges = 2, .high = {9, 9, 9}};
    params.octree = &octree;
    params.precision = SB_DOUBLE;
    params.gravity[1] = 0;
    sb_body *body = body_of(voxels, NULL, &params);
    int64_t n = counts_of(body).particles, count, member[200];
    assert_int_equal(n, 60);
    double *x = read_field(body, SB_REST), *v = read_field(body, SB_VELOCITY), shape[60][9],
           kept[60][9], mass[60];
    for (int i = 0; i < 3 * n; i++) x[i] += 5, v[i] = 0.25 * (i % 3);
    OK(sb_body_write(body, SB_POSITION, x, n, NULL));
    OK(sb_body_write(body, SB_VELOCITY, v, n, NULL));
    double *again = read_field(body, SB_POSITION), *speed = read_field(body, SB_VELOCITY);
    for (int i = 0; i < 3 * n; i++) {
        assert_float_equal(again[i], x[i], 1e-12);
        assert_float_equal(speed[i], v[i], 1e-12);
    }
    OK(sb_body_read_shapes(body, shape[0], n, NULL));
    assert_float_equal(shape[7][0], 1, 0);
    shape[7][1] = shape[7][3] = 0.125;
    OK(sb_body_write_shapes(body, shape[0], n, NULL));
    OK(sb_body_read_shapes(body, kept[0], n, NULL));
    assert_memory_equal(shape, kept, sizeof shape);
    OK(sb_body_read_masses(body, mass, n, NULL));
    assert_float_equal(mass[11], 1, 0);
    OK(sb_body_read_region(body, 30, member, 200, &count, NULL));
    assert_true(count > 8 && count <= n);
    for (int64_t i = 1; i < count; i++) assert_true(member[i] > member[i - 1]);
    sm_free_all(x, v, again, speed);
    sb_body_free(body);
    sb_voxels_free(voxels);
}

/* ---- cuts */

static int pieces_of(sb_body *body)
{
    int64_t count, n = counts_of(body).particles;
    int *piece = room_for(n, sizeof *piece);
    OK(sb_body_read_pieces(body, piece, n, &count, NULL));
    for (int64_t p = 0; p < n; p++) assert_true(piece[p] >= 0 && piece[p] < count);
    free(piece);
    return (int)count;
}

/* Volume within the body's surface as it is now, and whether that is closed. */
static double volume_of(sb_body *body)
{
    sb_body_counts counts = counts_of(body);
    double *x = room_for(counts.surface_vertices, 24);
    int *triangle = room_for(counts.surface_triangles, 12);
    sb_mesh *mesh;
    sb_mesh_facts facts;
    OK(sb_body_read_surface_rest(body, x, counts.surface_vertices, NULL));
    OK(sb_body_read_surface_triangles(body, triangle, counts.surface_triangles, NULL));
    OK(sb_mesh_make(counts.surface_vertices, x, counts.surface_triangles, triangle, &mesh, NULL));
    OK(sb_mesh_measure(mesh, &facts, NULL));
    sb_mesh_free(mesh);
    sm_free_all(x, triangle);
    return facts.volume;
}

/* A bar that a blade has been drawn through, or a plane put through, is two. */
static void cut_through(int engine, int by_blade)
{
    sb_mesh *mesh = box_in(1.6, 0.4, 0.4);
    sb_voxels *voxels = block_of(16, 4, 4);
    sb_body_params params = params_of(engine);
    params.cuttable = 1;
    params.gravity[1] = 0;
    sb_body *body = body_of(voxels, mesh, &params);
    sb_body_counts before = counts_of(body);
    double volume = volume_of(body);
    assert_int_equal(pieces_of(body), 1);
    if (by_blade) {
        int blade;
        int64_t gained, all = 0;
        OK(sb_body_add_blade(body, engine == SB_OCTREE ? 12 : 0, 0.1, &blade, NULL));
        for (int k = 0; k <= 8; k++) {
            double y = 0.6 - 0.1 * k, a[3] = {0.77, y, -0.2}, b[3] = {0.77, y, 0.6};
            OK(sb_body_sweep_blade(body, blade, a, b, &gained, NULL));
            all += gained;
            OK(sb_body_step(body, 1, NULL));
        }
        OK(sb_body_lift_blade(body, blade, NULL));
        assert_int_equal(all, counts_of(body).cut_triangles);
    } else {
        static const int triangle[2][3] = {{0, 1, 2}, {0, 2, 3}};
        double corner[4][3] = {{0.77, -1, -1}, {0.77, 1.4, -1}, {0.77, 1.4, 1.4}, {0.77, -1, 1.4}};
        OK(sb_body_cut(body, 4, corner[0], 2, triangle[0], NULL));
        assert_int_equal(counts_of(body).cut_triangles, 2);
    }
    assert_int_equal(pieces_of(body), 2);
    sb_body_counts after = counts_of(body);
    assert_true(after.surface_vertices > before.surface_vertices);
    assert_int_equal(after.surface_incomplete, 0);
    assert_float_equal(volume_of(body), volume, 0.01 * volume);
    OK(sb_body_step(body, 5, NULL));
    sb_body_free(body);
    sb_voxels_free(voxels);
    sb_mesh_free(mesh);
}

TEST(a_cut_takes_a_body_apart)
{
    for (int engine = SB_FASTLSM; engine <= SB_OCTREE; engine++)
        for (int by_blade = 0; by_blade < 2; by_blade++) cut_through(engine, by_blade);
}

/* ---- details */

/* Particles that rest as high as those that were held are where the handle says. Returns how many
 * there are. */
static int64_t check_held(sb_body *body, double y)
{
    double *rest = read_field(body, SB_REST), *x = read_field(body, SB_POSITION);
    int64_t n = counts_of(body).particles, held = 0;
    for (int64_t p = 0; p < n; p++) {
        if (rest[3 * p + 1] < y) continue;
        held++;
        assert_float_equal(x[3 * p], rest[3 * p] + 0.01, 1e-5);
        assert_float_equal(x[3 * p + 1], rest[3 * p + 1], 1e-5);
    }
    sm_free_all(rest, x);
    return held;
}

TEST(details_come_and_go_and_handles_follow)
{
    sb_voxels *voxels = block_of(8, 8, 8);
    sb_body_params params = params_of(SB_OCTREE);
    sb_octree_params octree;
    sb_octree_params_init(&octree);
    octree.levels = 2;
    params.octree = &octree;
    sb_body *body = body_of(voxels, NULL, &params);
    int64_t n = counts_of(body).particles, count, held[8], changed, split;
    int handle, ball, eye, level[512];
    assert_int_equal(n, 8);
    OK(sb_body_select_box(body, (double[3]){0, 0.4, 0}, (double[3]){1, 1, 1}, held, 8, &count,
                          NULL));
    OK(sb_body_add_handle(body, count, held, &handle, NULL));
    OK(sb_body_move_handle(body, handle, (double[12]){1, 0, 0, 0.01, 0, 1, 0, 0, 0, 0, 1, 0},
                           NULL));
    OK(sb_body_step(body, 2, NULL));
    assert_int_equal(count, 4);
    assert_int_equal(check_held(body, 0.4), count);
    OK(sb_body_add_detail(body, &ball, NULL));
    OK(sb_body_add_detail(body, &eye, NULL));
    OK(sb_body_detail_ball(body, ball, (double[3]){0.1, 0.7, 0.1}, 0.05, 12, 0.02, &changed, NULL));
    assert_int_equal(counts_of(body).particles, n + 7 * changed); /* eight in place of one */
    split = changed;
    OK(sb_body_read_levels(body, level, counts_of(body).particles, NULL));
    for (int64_t p = 0; p < counts_of(body).particles; p++) assert_in_range(level[p], 0, 2);
    OK(sb_body_step(body, 3, NULL));
    assert_in_range(check_held(body, 0.4), 4 + 7, 4 + 7 * split);
    OK(sb_body_detail_eye(body, eye, (double[3]){0.8, 0.8, 0.8}, 0.3, 0.1, 2, 0, &changed, NULL));
    assert_int_equal(counts_of(body).particles, n + 7 * (split + changed));
    OK(sb_body_step(body, 3, NULL));
    assert_in_range(check_held(body, 0.4), 4 + 7, 4 + 7 * (split + changed));
    OK(sb_body_detail_eye(body, eye, (double[3]){90, 0, 0}, 0.3, 0.1, 2, 0, NULL, NULL));
    for (int k = 0; k < 3; k++) {
        OK(sb_body_detail_ball(body, ball, nowhere, 0, 2, 0, &changed, NULL));
        OK(sb_body_detail_eye(body, eye, (double[3]){90, 0, 0}, 0.3, 0.1, 2, 0, NULL, NULL));
        OK(sb_body_step(body, 1, NULL));
    }
    assert_int_equal(counts_of(body).particles, n);
    assert_int_equal(check_held(body, 0.4), count);
    sb_error error;
    REFUSED(sb_body_add_handle(body, 1, held, &handle, &error), "held");
    OK(sb_body_remove_handle(body, handle, NULL));
    OK(sb_body_step(body, 1, NULL));
    sb_body_free(body);
    sb_voxels_free(voxels);
}

/* ---- collisions */

TEST(instances_collide_as_in_their_engine)
{
    static const double pose[2][12] = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                                       {1, 0, 0, 0.11, 0, 1, 0, 0.35, 0, 0, 1, 0.07}};
    SmVoxels inner;
    sm_voxels_block(&inner, 4, 4, 4, 0.1);
    sb_voxels *voxels = block_of(4, 4, 4);
    for (int engine = SB_FASTLSM; engine <= SB_OCTREE; engine++) {
        sb_body_params params = params_of(engine);
        params.instances = 2;
        params.pose = pose[0];
        params.collide_instances = 1;
        params.collide_friction = 0.5;
        sb_body *body = body_of(voxels, NULL, &params);
        sb_contact *contact = room_for(10000, sizeof *contact);
        int64_t count;
        OK(sb_body_step(body, 3, NULL));
        OK(sb_body_read_contacts(body, contact, 10000, &count, NULL));
        const SmEngineType *type = types[engine][SB_SINGLE];
        SmEngineParams own = {.w = 2,
                              .h = 0.01,
                              .damping = 0.1,
                              .gravity = {0, -9.81, 0},
                              .instances = 2,
                              .instance_pose = (const double(*)[3][4])pose,
                              .collide = {.bodies = true, .friction = 0.5}};
        SmEngine *e;
        SmContact *wanted;
        assert_int_equal(type->create(&inner, &own, &e, NULL), SM_OK);
        for (int step = 0; step < 3; step++) type->step(e, NULL);
        assert_int_equal(type->contacts(e, NULL, &wanted), count);
        assert_true(count > 0);
        for (int64_t i = 0; i < count; i++) {
            assert_int_equal(contact[i].particle, wanted[i].particle);
            assert_int_equal(contact[i].cell, wanted[i].cell);
            assert_memory_equal(contact[i].out, wanted[i].out, 24);
        }
        double *x = read_field(body, SB_POSITION);
        double *same = room_for(counts_of(body).particles, 24);
        type->get(e, SM_POSITION, (double(*)[3])same);
        assert_memory_equal(x, same, (size_t)counts_of(body).particles * 24);
        pieces_of(body);
        type->destroy(e);
        sm_free_all(wanted, contact, x, same);
        sb_body_free(body);
    }
    sb_voxels_free(voxels);
    sm_voxels_free(&inner);
}

/* ---- threads, misuse */

static void *fall(void *of)
{
    sb_voxels *voxels = of;
    sb_body_params params = params_of(SB_FASTLSM);
    params.threads = 1;
    sb_body *body = body_of(voxels, NULL, &params);
    double *rest = read_field(body, SB_REST);
    OK(sb_body_write(body, SB_VELOCITY, rest, counts_of(body).particles, NULL));
    free(rest);
    OK(sb_body_step(body, 50, NULL));
    double *x = read_field(body, SB_POSITION);
    sb_body_free(body);
    return x;
}

TEST(bodies_move_in_threads_of_their_own)
{
    sb_voxels *voxels = block_of(9, 9, 9);
    double *alone = fall(voxels);
    pthread_t thread[3];
    for (int t = 0; t < 3; t++) assert_int_equal(pthread_create(&thread[t], NULL, fall, voxels), 0);
    for (int t = 0; t < 3; t++) {
        void *x;
        assert_int_equal(pthread_join(thread[t], &x), 0);
        assert_memory_equal(x, alone, 1000 * 24);
        free(x);
    }
    free(alone);
    sb_voxels_free(voxels);
}

TEST(misuse_of_meshes_and_voxels_is_refused)
{
    sb_error error;
    sb_mesh *mesh = (sb_mesh *)&error;
    sb_voxels *voxels;
    static const double corner[3][3] = {{0}, {1, 0, 0}, {0, NAN, 0}};
    static const int triangle[3] = {0, 1, 2}, beyond[3] = {0, 1, 3}, same[3] = {1, 1, 1};
    UNUSABLE(sb_mesh_load("/nowhere/at.obj", NULL, &mesh, &error), "/nowhere/at.obj");
    assert_null(mesh);
    REFUSED(sb_mesh_load(NULL, NULL, &mesh, &error), "path");
    REFUSED(sb_mesh_load("a", NULL, NULL, &error), "mesh");
    REFUSED(sb_mesh_shape("unicorn", &mesh, &error), "unicorn");
    UNUSABLE(sb_mesh_make(3, corner[0], 1, triangle, &mesh, &error), "finite");
    UNUSABLE(sb_mesh_make(2, corner[0], 1, beyond, &mesh, &error), "not there");
    UNUSABLE(sb_mesh_make(2, corner[0], 1, same, &mesh, &error), "one place");
    REFUSED(sb_mesh_make(-1, corner[0], 1, triangle, &mesh, &error), "vertices");
    REFUSED(sb_mesh_make(INT64_MAX, corner[0], 1, triangle, &mesh, &error), "vertices");
    REFUSED(sb_mesh_measure(NULL, NULL, &error), "NULL");
    sb_mesh_free(NULL);
    sb_voxels_free(NULL);
    sb_body_free(NULL);
    REFUSED(sb_voxels_make((int[3]){0, 1, 1}, 1, NULL, NULL, &voxels, &error), "cells");
    REFUSED(sb_voxels_make((int[3]){1, 1, 1}, NAN, NULL, NULL, &voxels, &error), "cell");
    UNUSABLE(sb_voxels_make((int[3]){1, 1, 1}, 1, NULL, (uint8_t[1]){0}, &voxels, &error),
             "0 cells");
    UNUSABLE(sb_voxels_make((int[3]){9999, 9999, 9999}, 1, NULL, NULL, &voxels, &error), "large");
    assert_null(voxels);
    mesh = shape("penguin");
    sb_voxel_params how;
    sb_voxel_params_init(&how);
    REFUSED(sb_voxels_of_mesh(mesh, &how, &voxels, &error), "cell");
    how.cell = NAN;
    REFUSED(sb_voxels_of_mesh(mesh, &how, &voxels, &error), "cell");
    how.cell = 1e-12;
    UNUSABLE(sb_voxels_of_mesh(mesh, &how, &voxels, &error), "2^31");
    REFUSED(sb_mesh_read_vertices(mesh, (double[3]){0}, 1, &error), "room");
    voxels = block_of(2, 2, 2);
    REFUSED(sb_voxels_weigh(voxels, -1, (double[27]){0}, 27, &error), "density");
    REFUSED(sb_voxels_read_particles(voxels, NULL, 27, &error), "NULL");
    sb_voxels_free(voxels);
    sb_mesh_free(mesh);
}

TEST(parameters_out_of_range_are_refused)
{
    sb_error error;
    sb_body *body = NULL;
    sb_voxels *voxels = block_of(2, 2, 2);
    sb_octree_params octree;
#define BAD(code, text, ...)                                                                       \
    do {                                                                                           \
        sb_body_params p = params_of(SB_FASTLSM);                                                  \
        sb_octree_params_init(&octree);                                                            \
        __VA_ARGS__;                                                                               \
        refused(sb_body_create(voxels, NULL, &p, &body, &error), code, &error, text);              \
        assert_null(body);                                                                         \
    } while (0)
    double mass[27] = {NAN}, pose[12] = {2};
    BAD(SB_USAGE, "engine", p.engine = 9);
    BAD(SB_INPUT, "brute", p.engine = SB_BRUTE);
    if (sb_engine_available(SB_MESHLESS))
        for (int engine = SB_MESHLESS; engine <= SB_THIN_SHELL; engine++)
            BAD(SB_USAGE, "'surface'", p.engine = engine, p.precision = SB_DOUBLE);
    BAD(SB_USAGE, "precision", p.precision = 2);
    BAD(SB_INPUT, "w", p.w = 0);
    BAD(SB_INPUT, "w", p.w = 1000);
    BAD(SB_USAGE, "'h'", p.h = NAN);
    BAD(SB_USAGE, "'h'", p.h = 0);
    BAD(SB_USAGE, "gravity", p.gravity[2] = NAN);
    BAD(SB_USAGE, "gravity", p.gravity[2] = 1e300);
    BAD(SB_INPUT, "damping", p.damping = NAN);
    BAD(SB_USAGE, "damping_every", p.damping_every = -1);
    BAD(SB_INPUT, "strain_limit", p.strain_limit = 0.5);
    BAD(SB_USAGE, "threads", p.threads = -1);
    BAD(SB_USAGE, "layout", p.layout = 3);
    BAD(SB_USAGE, "instances", p.instances = -1);
    BAD(SB_INPUT, "instances", p.instances = 2000000000);
    BAD(SB_INPUT, "cuttable", p.instances = 2; p.cuttable = 1);
    BAD(SB_INPUT, "mass", p.mass = mass);
    BAD(SB_USAGE, "pose", p.pose = pose);
    BAD(SB_INPUT, "friction", p.collide_friction = 2);
    BAD(SB_USAGE, "levels", p.engine = SB_OCTREE; p.octree = &octree; octree.levels = 13);
    BAD(SB_USAGE, "symmetry", p.engine = SB_OCTREE; p.octree = &octree; octree.symmetry = -1);
    BAD(SB_INPUT, "epsilon", p.engine = SB_OCTREE; p.octree = &octree; octree.epsilon = NAN);
    BAD(SB_USAGE, "criteria_count", p.engine = SB_OCTREE; p.octree = &octree;
        octree.criteria_count = 17);
    BAD(SB_USAGE, "kind", p.engine = SB_OCTREE; p.octree = &octree; octree.criteria_count = 1;
        octree.criteria[0].kind = 77);
    BAD(SB_USAGE, "widths", p.engine = SB_OCTREE; p.octree = &octree; octree.width_count = 1;
        octree.widths[0].radius = NAN);
    BAD(SB_INPUT, "creep", p.engine = SB_OCTREE; p.octree = &octree; octree.creep = NAN);
    const char *isa = getenv("SHAPEBENCH_ISA");
    char *was = isa ? strdup(isa) : NULL;
    BAD(SB_USAGE, "abacus", setenv("SHAPEBENCH_ISA", "abacus", 1));
    was ? setenv("SHAPEBENCH_ISA", was, 1) : unsetenv("SHAPEBENCH_ISA");
    free(was);
    sb_voxels_free(voxels);
}

static const double nan3[3] = {NAN, 0, 0};
static const double far_off[9] = {0, 0, 0, 1e6, 0, 0, 0, 1e6, 0};

/* A body of 27 particles. */
static sb_body *small_body(int cuttable)
{
    sb_voxels *voxels = block_of(2, 2, 2);
    sb_body_params params = params_of(SB_FASTLSM);
    params.cuttable = cuttable;
    sb_body *body = body_of(voxels, NULL, &params);
    sb_voxels_free(voxels);
    return body;
}

/* What was refused has changed nothing; frees `before`. */
static void assert_unmoved(sb_body *body, double *before)
{
    double *after = read_field(body, SB_POSITION);
    assert_memory_equal(before, after, 27 * 24);
    sm_free_all(before, after);
}

/* Moves the second of two bodies by so many cells in each of some steps. */
static int step_by(sb_body *body, int64_t count, double cells, int64_t steps, sb_error *error)
{
    double *v = room_for(count, 24);
    for (int64_t p = count / 2; p < count; p++) v[3 * p] = cells * 0.1 / 0.01;
    OK(sb_body_write(body, SB_VELOCITY, v, count, NULL));
    free(v);
    return sb_body_step(body, steps, error);
}

TEST(a_step_beyond_single_precision_is_an_error)
{
    sb_voxels *voxels = block_of(6, 3, 3);
    for (int n = 0; n < 4; n++) {
        sb_error error;
        sb_body_params params = params_of(n / 2 ? SB_FASTLSM : SB_OCTREE);
        params.precision = n % 2 ? SB_SINGLE : SB_DOUBLE, params.instances = 2;
        sb_body *body = body_of(voxels, NULL, &params);
        int64_t count = counts_of(body).particles;
        OK(step_by(body, count, 0.99e5, 30, &error));
        double *x = read_field(body, SB_POSITION);
        for (int64_t i = 0; i < 3 * count; i++) assert_true(isfinite(x[i]));
        assert_int_equal(step_by(body, count, 1.01e5, 30, &error), n % 2 ? SB_INPUT : SB_OK);
        assert_true(n % 2 == !!strstr(error.text, "give a shorter 'h', or SB_DOUBLE"));
        sb_body_free(body);
        free(x);
    }
    sb_voxels_free(voxels);
}

TEST(misuse_of_particles_is_refused)
{
    sb_error error;
    sb_voxels *voxels = block_of(2, 2, 2);
    sb_body *body = small_body(0);
    int64_t count, one = 1, wrong[2] = {27, -1};
    double values[243] = {0};
    double *before = read_field(body, SB_POSITION);
    REFUSED(sb_body_step(NULL, 1, &error), "NULL");
    REFUSED(sb_body_step(body, -1, &error), "steps");
    REFUSED(sb_body_read(body, 4, values, 27, &error), "field");
    REFUSED(sb_body_read(body, SB_REST, values, 26, &error), "room");
    REFUSED(sb_body_read(body, SB_REST, NULL, 27, &error), "NULL");
    REFUSED(sb_body_write(body, SB_REST, values, 27, &error), "field");
    REFUSED(sb_body_write(body, SB_POSITION, values, 28, &error), "27");
    values[80] = INFINITY;
    REFUSED(sb_body_write(body, SB_POSITION, values, 27, &error), "inf");
    REFUSED(sb_body_write_shapes(body, values, 27, &error), "inf");
    REFUSED(sb_body_read_shapes(body, values, 27, &error), "elastic");
    REFUSED(sb_body_push(body, 1, wrong, nowhere, &error), "27");
    REFUSED(sb_body_push(body, 1, wrong + 1, nowhere, &error), "-1");
    REFUSED(sb_body_push(body, 1, &one, nan3, &error), "impulse");
    REFUSED(sb_body_push(body, 1, &one, (double[3]){1e200, 0, 0}, &error), "faster");
    REFUSED(sb_body_push(body, 1, NULL, nowhere, &error), "particle");
    REFUSED(sb_body_read_masses(body, values, 1, &error), "room");
    REFUSED(sb_body_read_region(body, 27, wrong, 2, &count, &error), "27");
    REFUSED(sb_body_read_region(body, 0, wrong, -1, &count, &error), "room");
    REFUSED(sb_body_read_region(body, 0, wrong, 2, NULL, &error), "count");
    REFUSED(sb_body_select_box(body, nan3, up, NULL, 0, &count, &error), "low");
    REFUSED(sb_body_select_ball(body, up, NAN, NULL, 0, &count, &error), "radius");
    assert_unmoved(body, before);
    sb_voxels_free(voxels);
    sb_body_free(body);
}

TEST(misuse_of_handles_is_refused)
{
    static const double mirror[12] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    sb_error error;
    sb_body *body = small_body(0);
    int number = 0;
    int64_t one = 1, wrong[2] = {27, -1}, twice[2] = {4, 4};
    double *before = read_field(body, SB_POSITION);
    REFUSED(sb_body_add_handle(body, 0, &one, &number, &error), "no particles");
    REFUSED(sb_body_add_handle(body, 2, twice, &number, &error), "twice");
    REFUSED(sb_body_add_handle(body, 2, wrong, &number, &error), "27");
    REFUSED(sb_body_add_handle(body, 1, &one, NULL, &error), "handle");
    REFUSED(sb_body_move_handle(body, 0, mirror, &error), "handle 0");
    OK(sb_body_add_handle(body, 1, &one, &number, &error));
    REFUSED(sb_body_move_handle(body, number, mirror, &error), "rigid");
    REFUSED(sb_body_move_handle(body, number, NULL, &error), "pose");
    REFUSED(sb_body_remove_handle(body, 5, &error), "handle 5");
    OK(sb_body_remove_handle(body, number, &error));
    REFUSED(sb_body_remove_handle(body, number, &error), "handle");
    assert_unmoved(body, before);
    sb_body_free(body);
}

TEST(misuse_of_obstacles_is_refused)
{
    sb_error error;
    sb_body *body = small_body(0);
    int number = 0;
    double *before = read_field(body, SB_POSITION);
    REFUSED(sb_body_add_plane(body, nowhere, nowhere, 0, &number, &error), "normal");
    REFUSED(sb_body_add_plane(body, nan3, up, 0, &number, &error), "place");
    REFUSED(sb_body_add_sphere(body, nowhere, -1, 0, &number, &error), "radius");
    REFUSED(sb_body_add_sphere(body, nowhere, 1, 2, &number, &error), "friction");
    REFUSED(sb_body_add_box(body, up, nowhere, 0, &number, &error), "empty");
    REFUSED(sb_body_add_capsule(body, up, NULL, 1, 0, &number, &error), "place");
    REFUSED(sb_body_remove_obstacle(body, 0, &error), "obstacle 0");
    assert_unmoved(body, before);
    sb_body_free(body);
}

TEST(what_a_body_does_not_have_is_refused)
{
    static const int triangle[3] = {0, 1, 2};
    sb_error error;
    sb_body *body = small_body(0);
    int number = 0, ints[27];
    int64_t count;
    double values[3];
    double *before = read_field(body, SB_POSITION);
    REFUSED(sb_body_cut(body, 3, far_off, 1, triangle, &error), "cuttable");
    REFUSED(sb_body_add_blade(body, 0, 0, &number, &error), "cuttable");
    REFUSED(sb_body_add_detail(body, &number, &error), "SB_OCTREE");
    REFUSED(sb_body_detail_eye(body, 0, up, 1, 0, 1, 0, NULL, &error), "SB_OCTREE");
    REFUSED(sb_body_read_levels(body, ints, 27, &error), "SB_OCTREE");
    REFUSED(sb_body_read_pieces(body, ints, 2, &count, &error), "room");
    REFUSED(sb_body_read_contacts(body, NULL, 3, &count, &error), "contact");
    REFUSED(sb_body_read_surface(body, values, NULL, 0, &error), "no surface");
    REFUSED(sb_body_read_surface_rest(body, values, 0, &error), "no surface");
    REFUSED(sb_body_read_surface_triangles(body, ints, 0, &error), "no surface");
    OK(sb_body_read_contacts(body, NULL, 0, &count, &error));
    assert_int_equal(count, 0);
    assert_unmoved(body, before);
    sb_body_free(body);
}

TEST(misuse_of_cuts_is_refused)
{
    static const double close_by[9] = {0, 0, 0, 0.1, 0, 0, 0, 0.1, 0};
    static const int triangle[3] = {0, 1, 2}, beyond[3] = {0, 1, 9};
    sb_error error;
    sb_body *body = small_body(1);
    int number = 0;
    REFUSED(sb_body_cut(body, 3, far_off, 1, triangle, &error), "edge");
    REFUSED(sb_body_cut(body, 3, close_by, 1, beyond, &error), "not there");
    REFUSED(sb_body_cut(body, 3, NULL, 1, triangle, &error), "position");
    REFUSED(sb_body_add_blade(body, 3, 1, &number, &error), "level");
    REFUSED(sb_body_sweep_blade(body, 0, up, up, NULL, &error), "blade 0");
    OK(sb_body_add_blade(body, 0, 0, &number, &error));
    REFUSED(sb_body_sweep_blade(body, number, nan3, up, NULL, &error), "'a'");
    REFUSED(sb_body_lift_blade(body, 1, &error), "blade 1");
    sb_body_free(body);
}
