#include "cantilever.h"

#include <stdio.h>
#include <string.h>

static const double near_end = 1e-6; /* of a cell */

/* The whole as a box of twelve triangles. */
static SmMesh make_box(const double low[3], const double high[3])
{
    static const int side[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                    {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                    {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    SmMesh mesh = sm_mesh_new(8, 12);
    for (int c = 0; c < 8; c++)
        for (int d = 0; d < 3; d++) mesh.position[c][d] = c >> d & 1 ? high[d] : low[d];
    memcpy(mesh.triangle, side, sizeof side);
    return mesh;
}

static void make_scene(const BenchCantileverOptions *options, BenchScene *scene)
{
    bench_scene_init(scene);
    snprintf(scene->name, sizeof scene->name, "cantilever");
    snprintf(scene->file, sizeof scene->file, "cantilever");
    snprintf(scene->mesh, sizeof scene->mesh, "cantilever");
    snprintf(scene->engine, sizeof scene->engine, "%s", options->engine);
    scene->voxel = (SmVoxelParams){.fill = SM_SOLID, .cell = options->cell};
    scene->density = options->density;
    scene->params.h = options->h;
    scene->params.damping = options->damping;
    scene->params.w = (int)options->w;
    scene->octree.width = (OctWidth){.edges = options->w};
    scene->octree.epsilon = options->epsilon;
    scene->octree.sampling.criteria[0] = (OctCriterion){.kind = OCT_UNIFORM};
    scene->octree.sampling.criteria_count = 1;
    double held = options->root + near_end, all = options->root + options->along;
    scene->handle_count = 1;
    scene->handle[0] = (BenchHandle){.select = {.high = {held / all, 1, 1}}};
}

SmCode bench_cantilever_create(const BenchCantileverOptions *options, const SmEngineType *type,
                               BenchCantilever *cantilever, SmError *error)
{
    memset(cantilever, 0, sizeof *cantilever);
    BenchClampedBeam *beam = &cantilever->beam;
    BenchScene scene;
    make_scene(options, &scene);
    double a = options->cell, half = a * options->across / 2, length = a * options->along;
    SmMesh mesh =
        make_box((double[]){-a * options->root, -half, -half}, (double[]){length, half, half});
    SmCode code = bench_body_create(&scene, &mesh, &cantilever->body, error);
    if (!code) code = bench_clamped_beam_create(&scene, &cantilever->body, type, beam, error);
    beam->low = 0;
    beam->length = length;
    return code;
}

void bench_cantilever_free(BenchCantilever *cantilever)
{
    bench_clamped_beam_free(&cantilever->beam);
    bench_body_free(&cantilever->body);
    memset(cantilever, 0, sizeof *cantilever);
}
