#include "tree_body.h"

#include "../../lib/shapes/shape.h"
#include "../scene/memory.h"

/* Of the hand. */
enum { PARTICLES = 35000, BASES = 28, NODES = 661, LEVELS = 4 };

/* Of a cube, measured: voxels, tree, graph and regions, and an engine on them. */
static const double node_bytes = 1300;

static SmCode make_voxels(int side, SmVoxels *voxels, SmError *error)
{
    const SmVoxelParams params = {.fill = SM_SOLID, .particles = PARTICLES};
    SmMesh mesh = {0};
    SmCode code = side > 0 ? bench_memory_cube(side, "octree", node_bytes, error)
                           : sm_shape_mesh("hand", &mesh, error);
    if (!code && side > 0)
        sm_voxels_block(voxels, side, side, side, 1);
    else if (!code)
        code = sm_voxelise(&mesh, &params, "hand", voxels, error);
    sm_mesh_free(&mesh);
    return code;
}

SmCode bench_sampled(int side, OctStructure *body, SmError *error)
{
    bool fine = side == BENCH_HAND; /* only where features are; else everywhere */
    const OctOptions options = {
        .sampling = {.levels = LEVELS,
                     .bases = side > 0 ? 0 : BASES,
                     .nodes = fine ? NODES : 0,
                     .criteria = {{.kind = fine ? OCT_FEATURES : OCT_UNIFORM, .level = LEVELS}},
                     .criteria_count = 1},
        .epsilon = 0.5,
        .width = {.edges = fine ? 0.75 : 1}};
    SmVoxels voxels;
    *body = (OctStructure){0};
    SmCode code = make_voxels(side, &voxels, error);
    if (code) return code;
    code = oct_structure_build(&voxels, &options, NULL, body, error);
    sm_voxels_free(&voxels);
    return code;
}
