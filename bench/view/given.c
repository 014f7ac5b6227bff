#include "given.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/mesh/polygon.h"
#include "../scene/body.h"

static const double most_cut = 5e8; /* about three seconds of cutting polygons in a browser */

static struct {
    long vertices, polygons, corners; /* in the room */
    double (*point)[3];
    int *size, *corner;
    char name[BENCH_PATH]; /* of the mesh; one without triangles: none is given */
    SmMesh mesh;
    char scene[2 * BENCH_PATH];
    SmError error;
} given;

/* The shape that was made last: some take seconds. */
static struct {
    char name[BENCH_PATH];
    SmMesh mesh;
} made;

static void leave_room(void)
{
    sm_free_all(given.point, given.size, given.corner);
    given.point = NULL;
    given.size = given.corner = NULL;
    given.vertices = given.polygons = given.corners = 0;
}

void view_given_room(int vertices, int polygons, int corners)
{
    leave_room();
    sm_mesh_free(&given.mesh);
    given.vertices = vertices;
    given.polygons = polygons;
    given.corners = corners;
    given.point = sm_alloc((size_t)vertices, sizeof *given.point);
    given.size = sm_alloc((size_t)polygons, sizeof *given.size);
    given.corner = sm_alloc((size_t)corners, sizeof *given.corner);
}

double *view_given_points(void)
{
    return given.point[0];
}

int *view_given_sizes(void)
{
    return given.size;
}

int *view_given_corners(void)
{
    return given.corner;
}

/* How many triangles the polygons make. */
static SmCode count_triangles(long *triangles, SmError *error)
{
    long corners = 0;
    double cost = 0;
    *triangles = 0;
    for (long p = 0; p < given.polygons; p++) {
        long size = given.size[p];
        if (size < 0 || size > given.corners - corners)
            return sm_fail(error, SM_INPUT, "%s: its polygons have more corners than were read",
                           given.name);
        corners += size;
        if (size > 2) *triangles += size - 2;
        if (size > 3) cost += (double)size * (double)size;
    }
    if (cost <= most_cut) return SM_OK;
    return sm_fail(error, SM_INPUT,
                   "%s: its polygons have more corners than a page can cut: export it as triangles",
                   given.name);
}

/* Cuts a polygon; one with a corner that is not there into triangles without any, which are refused
 * later. */
static void cut(const int *corner, int size, int (*triangle)[3])
{
    bool sound = true;
    for (int c = 0; c < size; c++) sound &= corner[c] >= 0 && corner[c] < given.vertices;
    if (sound && size > 3) {
        sm_polygon_cut((const double(*)[3])given.point, corner, size, triangle);
        return;
    }
    for (int t = 0; t < size - 2; t++)
        for (int c = 0; c < 3; c++) triangle[t][c] = sound ? corner[c] : -1;
}

static void make_triangles(void)
{
    const int *corner = given.corner;
    int(*triangle)[3] = given.mesh.triangle;
    memcpy(given.mesh.position, given.point, (size_t)given.vertices * sizeof *given.point);
    for (long p = 0; p < given.polygons; p++) {
        int size = given.size[p];
        if (size > 2) {
            cut(corner, size, triangle);
            triangle += size - 2;
        }
        corner += size;
    }
}

const char *view_given_take(const char *name)
{
    long triangles;
    snprintf(given.name, sizeof given.name, "%s", name);
    sm_mesh_free(&given.mesh);
    SmCode code = count_triangles(&triangles, &given.error);
    if (!code) {
        given.mesh = sm_mesh_new(given.vertices, triangles);
        make_triangles();
    }
    if (!code) code = sm_mesh_prepare(&given.mesh, given.name, &given.error);
    if (code) sm_mesh_free(&given.mesh);
    leave_room();
    return code ? given.error.text : "";
}

/* A vector as a scene file has it: of reals. */
static const char *vector(const double v[3], size_t size, char *text)
{
    size_t used = 0;
    for (int d = 0; d < 3 && used < size; d++) {
        char number[40];
        snprintf(number, sizeof number, "%.17g", v[d]);
        used += (size_t)snprintf(text + used, size - used, "%s%s%s", d ? ", " : "", number,
                                 strpbrk(number, ".en") ? "" : ".0");
    }
    return text;
}

const char *view_given_scene(void)
{
    static BenchScene scene;
    char gravity[160], point[160];
    if (!given.mesh.triangle_count) return "";
    bench_scene_drop(&given.mesh, given.name, &scene);
    const SmObstacle *ground = &scene.obstacle[0];
    snprintf(given.scene, sizeof given.scene,
             "# What `shapebench run %s` plays.\n"
             "title = \"%s\";\nmesh = \"%s\";\nfill = \"solid\";\nparticles = %ld;\nw = %d;\n"
             "h = %g;\ndamping = %g;\ngravity = [%s];\n"
             "planes = ( { point = [%s]; normal = [0.0, 1.0, 0.0]; friction = %g; } );\n"
             "steps_per_frame = %d;\nframes = %d;\n",
             scene.name, scene.title, given.name, scene.voxel.particles, scene.params.w,
             scene.params.h, scene.params.damping,
             vector(scene.params.gravity, sizeof gravity, gravity),
             vector(ground->a, sizeof point, point), ground->friction, scene.steps_per_frame,
             scene.frames);
    return given.scene;
}

static SmCode load_shape(const char *name, SmMesh *result, SmError *error)
{
    SmMesh mesh;
    if (strcmp(name, made.name) != 0) {
        SmCode code = bench_mesh_load(name, &mesh, error);
        if (code) return code;
        sm_mesh_free(&made.mesh);
        made.mesh = mesh;
        snprintf(made.name, sizeof made.name, "%s", name);
    }
    *result = sm_mesh_copy(&made.mesh);
    return SM_OK;
}

SmCode view_given_load(const char *mesh, SmMesh *result, SmError *error)
{
    *result = (SmMesh){0};
    if (!strncmp(mesh, "shape:", 6)) return load_shape(mesh, result, error);
    const char *slash = strrchr(mesh, '/'), *name = slash ? slash + 1 : mesh;
    if (!given.mesh.triangle_count || strcmp(name, given.name))
        return sm_fail(error, SM_INPUT,
                       "the scene's mesh '%s' is not in this page: drop that file on it, and the "
                       "scene opens with it",
                       name);
    *result = sm_mesh_copy(&given.mesh);
    return SM_OK;
}
