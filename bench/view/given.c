#include "given.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/mesh/reader.h"
#include "../scene/body.h"

static const long most_triangles = 1000000; /* the page draws each of them on both sides */

typedef struct {
    char *name;
    unsigned char *bytes;
    size_t size;
} GivenFile;

static struct {
    GivenFile *file;
    long files, room;
    char name[BENCH_PATH]; /* of the mesh; one without triangles: none is given */
    SmMesh mesh;
    char left_out[2 * BENCH_PATH], scene[2 * BENCH_PATH];
    SmError error;
} given;

/* The shape that was made last: some take seconds. */
static struct {
    char name[BENCH_PATH];
    SmMesh mesh;
} made;

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

int view_given_readable(const char *name)
{
    return sm_mesh_readable(name);
}

unsigned char *view_given_room(const char *name, int bytes)
{
    size_t size = (size_t)bytes;
    sm_make_room(given.file, given.room, given.files + 1);
    GivenFile *file = &given.file[given.files++];
    *file = (GivenFile){sm_copy(name, strlen(name) + 1, 1), sm_alloc(size, 1), size};
    return file->bytes;
}

static const GivenFile *find_file(const char *name)
{
    for (long f = 0; f < given.files; f++)
        if (!strcmp(given.file[f].name, name)) return &given.file[f];
    return NULL;
}

/* SmMeshBeside of the files that were given with the mesh, in whatever folder below the mesh's. */
static bool copy_file(void *of, const char *name, unsigned char **bytes, size_t *size)
{
    (void)of;
    const GivenFile *file = find_file(base_name(name));
    bool below = *name != '/' && !strstr(name, "..") && !strstr(name, "//");
    if (!file || !below) return false;
    *bytes = sm_copy(file->bytes, file->size, 1);
    *size = file->size;
    return true;
}

static SmCode read_mesh(const char *name)
{
    char text[SM_LEFT_OUT_TEXT];
    SmMeshLeftOut left_out = {0};
    const GivenFile *given_file = find_file(name);
    assert(given_file);
    SmMeshFile file = {
        .name = name, .bytes = given_file->bytes, .size = given_file->size, .beside = copy_file};
    SmCode code = sm_mesh_read(&file, &given.mesh, &left_out, &given.error);
    if (code) return code;
    if (given.mesh.triangle_count > most_triangles) {
        code = sm_fail(&given.error, SM_INPUT,
                       "%s: %ld triangles; the page takes at most %ld: simplify the mesh", name,
                       given.mesh.triangle_count, most_triangles);
        sm_mesh_free(&given.mesh);
        return code;
    }
    if (sm_mesh_left_out(&left_out, text)[0])
        snprintf(given.left_out, sizeof given.left_out, "%s: left out: %s", name, text);
    return SM_OK;
}

const char *view_given_take(const char *name)
{
    snprintf(given.name, sizeof given.name, "%s", name);
    sm_mesh_free(&given.mesh);
    given.left_out[0] = '\0';
    SmCode code = read_mesh(name);
    for (long f = 0; f < given.files; f++) sm_free_all(given.file[f].name, given.file[f].bytes);
    given.files = 0;
    return code ? given.error.text : "";
}

const char *view_given_left_out(void)
{
    return given.left_out;
}

const double *view_given_facts(void)
{
    static double facts[15];
    SmMeshInfo info = sm_mesh_info(&given.mesh);
    const long counts[] = {info.triangles,  info.vertices,          info.components,
                           info.open_edges, info.nonmanifold_edges, info.flipped_edges,
                           info.degenerate, info.duplicates};
    for (int i = 0; i < 8; i++) facts[i] = (double)counts[i];
    memcpy(facts + 8, info.low, sizeof info.low);
    memcpy(facts + 11, info.high, sizeof info.high);
    facts[14] = info.volume;
    return facts;
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
    const char *name = base_name(mesh);
    if (!given.mesh.triangle_count || strcmp(name, given.name))
        return sm_fail(error, SM_INPUT,
                       "the scene's mesh '%s' is not in this page: drop that file on it, and the "
                       "scene opens with it",
                       name);
    *result = sm_mesh_copy(&given.mesh);
    return SM_OK;
}
