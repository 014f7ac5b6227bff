#include "sampled.h"

#include <stdlib.h>
#include <string.h>

#include "../../lib/shapes/shape.h"
#include "../scene/room.h"

/* Of the hand's solid lattice; the second has 35,000 material cells. */
enum { PARTICLES = 35000, REGULAR_PARTICLES = 41400, BASES = 28, NODES = 661, LEVELS = 4 };

/* Of a cube, measured: voxels, tree, graph and regions, and an engine on them. */
static const double node_bytes = 1300;

void bench_sampled_widths(const OctTree *tree, double edges, int **w, double **mass)
{
    *w = sm_alloc((size_t)tree->leaves, sizeof **w);
    *mass = sm_alloc((size_t)tree->leaves, sizeof **mass);
    for (long leaf = 0; leaf < tree->leaves; leaf++) {
        int node = tree->node[leaf];
        (*w)[leaf] = (int)(edges * tree->size[node]);
        (*mass)[leaf] = (double)tree->material[node];
    }
}

/* The rest, from voxels, sampling and widths; takes them over even on error. */
static SmCode sample(BenchSampled *body, SmError *error)
{
    SmCode code = oct_sampling_tree(&body->sampling, &body->voxels, &body->tree, NULL, error);
    if (!code) {
        bench_sampled_widths(&body->tree, body->edges, &body->w, &body->mass);
        oct_graph_build(&body->tree, &body->voxels, &body->graph);
        code = oct_regions_build(&body->tree, &body->graph, body->w, body->epsilon, OCT_UNION,
                                 &body->regions, error);
    }
    if (code) bench_sampled_free(body);
    return code;
}

SmCode bench_sampled_hand(bool regular, BenchSampled *body, SmError *error)
{
    SmMesh mesh = {0};
    SmVoxelParams params = {.fill = SM_SOLID, .particles = regular ? REGULAR_PARTICLES : PARTICLES};
    *body = (BenchSampled){
        .sampling = {.levels = LEVELS,
                     .bases = BASES,
                     .nodes = regular ? 0 : NODES,
                     .criteria = {{.kind = regular ? OCT_UNIFORM : OCT_FEATURES, .level = LEVELS}},
                     .criteria_count = 1},
        .edges = regular ? 1 : 0.75,
        .epsilon = 0.5};
    SmCode code = sm_shape_mesh("hand", &mesh, error);
    if (!code) code = sm_voxelise(&mesh, &params, "hand", &body->voxels, error);
    sm_mesh_free(&mesh);
    return code ? code : sample(body, error);
}

SmCode bench_sampled_cube(int side, BenchSampled *body, SmError *error)
{
    *body = (BenchSampled){.sampling = {.levels = LEVELS,
                                        .criteria = {{.kind = OCT_UNIFORM, .level = LEVELS}},
                                        .criteria_count = 1},
                           .edges = 1,
                           .epsilon = 0.5};
    if (bench_room_cube(side, "octree", node_bytes, error)) {
        *body = (BenchSampled){0};
        return SM_MEMORY;
    }
    sm_voxels_block(&body->voxels, side, side, side, 1);
    return sample(body, error);
}

void bench_sampled_free(BenchSampled *body)
{
    sm_voxels_free(&body->voxels);
    oct_tree_free(&body->tree);
    oct_graph_free(&body->graph);
    oct_regions_free(&body->regions);
    free(body->w);
    free(body->mass);
    memset(body, 0, sizeof *body);
}

double bench_sampled_members(const BenchSampled *body)
{
    double members = 0;
    for (long i = 0; i < body->regions.leaves; i++) members += body->regions.size[i];
    return members;
}
