#include "body.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/box.h"
#include "../../lib/mesh/import.h"
#include "../../lib/printable.h"
#include "../../lib/shapes/shape.h"
#include "../../lib/system/file.h"
#include "../../lib/voxel/voxelise.h"
#include "../../reference/meshless/surface/cloud.h"
#include "../../reference/meshless/surface/local_triangles.h"
#include "../system/remark.h"
#include "memory.h"

static SmCode import(const char *path, SmMesh *mesh, SmError *error)
{
    SmMeshLeftOut left_out;
    char text[SM_LEFT_OUT_TEXT];
    SmCode code = sm_import(path, NULL, mesh, &left_out, error);
    if (!code && *sm_mesh_left_out(&left_out, text)) bench_remark("%s: left out: %s", path, text);
    return code;
}

SmCode bench_mesh_load(const char *mesh, SmMesh *result, SmError *error)
{
    if (!strncmp(mesh, "shape:", 6)) return sm_shape_mesh(mesh + 6, result, error);
    return import(mesh, result, error);
}

/* Whether a file is of points: text, or one of points alone that is no mesh. Else its mesh is read.
 */
static bool has_points(const char *path, SmMesh *mesh, SmCode *code, SmError *error)
{
    SmError why;
    long count;
    double(*position)[3], (*normal)[3];
    *mesh = (SmMesh){0};
    *code = SM_OK;
    if (ref_points_text(path)) return true;
    *code = bench_mesh_load(path, mesh, &why);
    if (*code == SM_OK) return false;
    *mesh = (SmMesh){0};
    if (!sm_import_points(path, &count, &position, &normal, NULL)) {
        sm_free_all(position, normal);
        return true;
    }
    if (error) *error = why;
    return false;
}

SmCode bench_points_or_mesh(const char *path, RefPoints *points, SmMesh *mesh, SmError *error)
{
    SmCode code;
    *points = (RefPoints){0};
    return has_points(path, mesh, &code, error) ? ref_points_read(path, points, error) : code;
}

SmCode bench_sheet_load(const char *path, SmMesh *mesh, bool *of_points, SmError *error)
{
    SmCode code;
    *of_points = has_points(path, mesh, &code, error);
    return *of_points ? ref_local_triangles_read(path, mesh, error) : code;
}

static SmBox box_of(const SmMesh *mesh)
{
    return sm_box_around(mesh->vertex_count, (const double(*)[3])mesh->position);
}

/* Moves `mesh` to where `model` is. */
static void fit(SmMesh *mesh, const SmMesh *model)
{
    SmBox is = box_of(mesh), wanted = box_of(model);
    double scale = sm_box_longest(&wanted) / sm_box_longest(&is);
    for (long i = 0; i < mesh->vertex_count; i++)
        for (int d = 0; d < 3; d++) {
            double from = d == 1 ? is.low[d] : is.low[d] / 2 + is.high[d] / 2;
            double to = d == 1 ? wanted.low[d] : (wanted.low[d] + wanted.high[d]) / 2;
            mesh->position[i][d] = (mesh->position[i][d] - from) * scale + to;
        }
}

SmCode bench_mesh_of_scene(const BenchScene *scene, const char *substitute, SmMesh *result,
                           SmError *error)
{
    SmMesh model;
    SmCode code = bench_mesh_load(scene->mesh, &model, error);
    if (code || !substitute) {
        *result = model;
        return code;
    }
    code = import(substitute, result, error);
    if (!code) fit(result, &model);
    sm_mesh_free(&model);
    return code;
}

static bool lies_flat(const SmBox *box)
{
    return box->high[1] - box->low[1] <= 0.01 * sm_box_longest(box);
}

/* What stands for a body's height: of one that lies flat, its length. */
static double height_of(const SmBox *box)
{
    return lies_flat(box) ? sm_box_longest(box) : box->high[1] - box->low[1];
}

void bench_mesh_name(const char *path, char name[BENCH_NAME])
{
    const char *slash = strrchr(path, '/');
    snprintf(name, BENCH_NAME, "%.*s", BENCH_NAME - 1, slash ? slash + 1 : path);
    sm_printable(name);
}

void bench_scene_drop(const SmMesh *mesh, const char *path, BenchScene *scene)
{
    bench_scene_init(scene);
    bench_mesh_name(path, scene->name);
    snprintf(scene->title, sizeof scene->title, "%s dropped on the ground", scene->name);
    snprintf(scene->mesh, sizeof scene->mesh, "%s", path);
    snprintf(scene->file, sizeof scene->file, "%s", path);
    scene->voxel.fill = SM_SOLID;
    scene->voxel.particles = 2000;
    scene->voxel.fewer = true;
    SmBox box = box_of(mesh);
    double height = height_of(&box);
    scene->params.gravity[1] = -9.81 * height;
    scene->params.damping = 0.1;
    scene->obstacle_count = 1;
    scene->obstacle[0] = (SmObstacle){.kind = SM_PLANE, .b = {0, 1, 0}, .friction = 0.2};
    for (int d = 0; d < 3; d++) scene->obstacle[0].a[d] = (box.low[d] + box.high[d]) / 2;
    scene->obstacle[0].a[1] = box.low[1] - height / 2;
}

void bench_scene_hold(const SmMesh *mesh, BenchScene *scene)
{
    SmBox box = box_of(mesh);
    bool flat = lies_flat(&box), wide = box.high[0] - box.low[0] >= box.high[2] - box.low[2];
    scene->metre = height_of(&box);
    snprintf(scene->title, sizeof scene->title, "%s held at %s", scene->name,
             flat ? "one end" : "its foot");
    scene->obstacle_count = 0;
    scene->handle_count = 1;
    scene->handle[0] = (BenchHandle){.select = {.high = {1, 1, 1}}};
    scene->handle[0].select.high[flat ? wide ? 0 : 2 : 1] = 0.1;
}

void bench_scene_hold_shell(const SmMesh *mesh, BenchScene *scene)
{
    bench_scene_hold(mesh, scene);
    scene->voxel.fill = SM_SHELL;
}

void bench_scene_sample(const SmMesh *mesh, BenchScene *scene)
{
    (void)mesh;
    scene->voxel.particles = 35000;
    scene->octree.epsilon = 0.5;
}

static void stand_instances(const BenchScene *scene, BenchBody *body)
{
    body->instances = scene->instances;
    body->pose = sm_alloc((size_t)body->instances, sizeof *body->pose);
    long columns = (long)ceil(sqrt((double)body->instances));
    long rows = (body->instances + columns - 1) / columns;
    double dx = scene->spacing * (body->high[0] - body->low[0]);
    double dz = scene->spacing * (body->high[2] - body->low[2]);
    for (long i = 0; i < body->instances; i++) {
        for (int d = 0; d < 3; d++) body->pose[i][d][d] = 1;
        body->pose[i][0][3] = dx * ((double)(i % columns) - (double)(columns - 1) / 2);
        body->pose[i][2][3] = dz * ((double)(i / columns) - (double)(rows - 1) / 2);
    }
}

static SmCode read_masses(const char *path, long count, double *mass, SmError *error)
{
    FILE *file = sm_file_open(path, NULL, error);
    if (!file) return SM_INPUT;
    long i = 0;
    bool good = true;
    while (i < count && good) {
        good = fscanf(file, "%lf", &mass[i]) == 1 && mass[i] > 0 && mass[i] < 1e30;
        i += good;
    }
    double extra;
    bool over = good && fscanf(file, "%lf", &extra) == 1;
    fclose(file);
    if (good && !over) return SM_OK;
    return sm_fail(error, SM_INPUT,
                   "%s: value %ld: wanted %ld masses above 0 kg, one for each mesh vertex after "
                   "equal positions are merged ('shapebench info' counts them)",
                   path, i + 1, count);
}

/* Each particle has the mass given for the mesh vertex nearest to it. */
static SmCode weigh_vertices(const char *path, BenchBody *body, SmError *error)
{
    double *given = sm_alloc((size_t)body->mesh.vertex_count, sizeof *given);
    SmCode code = read_masses(path, body->mesh.vertex_count, given, error);
    if (!code) {
        double(*none)[3] = sm_alloc((size_t)body->mesh.vertex_count, sizeof *none), distance;
        const RefPoints points = {
            .count = body->mesh.vertex_count, .position = body->mesh.position, .normal = none};
        RefCloud cloud;
        ref_cloud_create(&points, &cloud);
        for (long p = 0, near; p < body->voxels.particle_count; p++) {
            ref_cloud_nearest(&cloud, body->x0[p], 1, &near, &distance);
            body->mass[p] = given[near];
        }
        ref_cloud_free(&cloud);
        free(none);
    }
    free(given);
    return code;
}

static SmCode place_particles(const BenchScene *scene, BenchBody *body, SmError *error)
{
    const SmVoxels *voxels = &body->voxels;
    size_t count = (size_t)voxels->particle_count;
    int(*at)[3] = sm_alloc(count, sizeof *at);
    sm_voxels_particles(voxels, at);
    body->x0 = sm_alloc(count, sizeof *body->x0);
    for (size_t p = 0; p < count; p++)
        for (int d = 0; d < 3; d++) body->x0[p][d] = voxels->origin[d] + voxels->cell * at[p][d];
    SmCode code = SM_OK;
    if (scene->density > 0 || scene->vertex_mass[0]) body->mass = sm_alloc(count, sizeof(double));
    if (scene->vertex_mass[0])
        code = weigh_vertices(scene->vertex_mass, body, error);
    else if (scene->density > 0)
        sm_voxels_weigh(voxels, scene->density, body->mass);
    free(at);
    return code;
}

static double log_off(const SmVoxels *voxels, long cells)
{
    return fabs(log((double)voxels->cell_count / (double)cells));
}

/* The lattice whose material cells are nearest to as many as wanted, of a few whose wanted
 * particles approach them. */
static SmCode voxelise_cells(const BenchScene *scene, const SmMesh *mesh, SmVoxels *voxels,
                             SmError *error)
{
    SmVoxelParams params = {scene->voxel.fill, 0, scene->cells > 8 ? scene->cells : 8, false};
    SmCode code = sm_voxelise(mesh, &params, scene->mesh, voxels, error);
    for (int i = 0; i < 4 && !code && log_off(voxels, scene->cells) > 0.002; i++) {
        SmVoxels next;
        double share = (double)scene->cells / (double)voxels->cell_count;
        params.particles = (long)rint(fmax((double)voxels->particle_count * share, 8));
        if (sm_voxelise(mesh, &params, scene->mesh, &next, NULL)) break;
        bool nearer = log_off(&next, scene->cells) < log_off(voxels, scene->cells);
        sm_voxels_free(nearer ? voxels : &next);
        if (!nearer) break;
        *voxels = next;
    }
    return code;
}

SmCode bench_body_create(const BenchScene *scene, SmMesh *mesh, BenchBody *body, SmError *error)
{
    *body = (BenchBody){.mesh = *mesh, .hash = sm_mesh_hash(mesh)};
    *mesh = (SmMesh){0};
    const SmMesh *m = &body->mesh;
    SmBox box = box_of(m);
    memcpy(body->low, box.low, sizeof box.low);
    memcpy(body->high, box.high, sizeof box.high);
    double start = sm_now(),
           wishes = (double)(scene->cells ? scene->cells : scene->voxel.particles);
    SmCode code = bench_memory_check(scene, wishes, error); /* before minutes of voxelising */
    if (!code)
        code = scene->cells > 0 ? voxelise_cells(scene, m, &body->voxels, error)
                                : sm_voxelise(m, &scene->voxel, scene->mesh, &body->voxels, error);
    body->voxelise_seconds = sm_now() - start;
    if (!code) code = bench_memory_check(scene, (double)body->voxels.particle_count, error);
    if (!code) {
        stand_instances(scene, body);
        code = place_particles(scene, body, error);
    }
    if (code) bench_body_free(body);
    return code;
}

SmCode bench_body_of_scene(const BenchScene *scene, const char *substitute, BenchBody *body,
                           SmError *error)
{
    SmMesh mesh;
    *body = (BenchBody){0};
    SmCode code = bench_mesh_of_scene(scene, substitute, &mesh, error);
    return code ? code : bench_body_create(scene, &mesh, body, error);
}

void bench_body_free(BenchBody *body)
{
    sm_mesh_free(&body->mesh);
    sm_voxels_free(&body->voxels);
    free(body->x0);
    free(body->mass);
    free(body->pose);
    *body = (BenchBody){0};
}

double bench_body_size(const BenchBody *body)
{
    double size = 0;
    for (int d = 0; d < 3; d++) size = fmax(size, body->high[d] - body->low[d]);
    return size;
}
