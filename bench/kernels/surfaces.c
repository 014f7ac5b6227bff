#include "surfaces.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/mesh/embed.h"
#include "../../lib/shapes/shape.h"
#include "../../lib/stage.h"
#include "../../lib/system/team.h"
#include "../../lib/voxel/voxelise.h"
#include "../../octree/surface/surface.h"
#include "../../octree/tree/sampling.h"

enum { PARTICLES = 57626, DEFORM_ROUNDS = 2 };

typedef struct {
    SmMesh mesh;
    SmVoxels voxels;
    SmEmbedding embedding;
    OctSurface carried;
    double (*x)[3];                      /* [particle_count] the lattice, turned */
    double (*node)[3];                   /* [nodes] the octree, turned */
    double (*position)[3], (*normal)[3]; /* [vertex_count] */
} Statue;

static bool in_material(const SmVoxels *v, const double at[3])
{
    int cell[3];
    for (int d = 0; d < 3; d++) cell[d] = (int)floor((at[d] - v->origin[d]) / v->cell);
    for (int n = 0; n < 27; n++) { /* a point on a face may round into the next cell */
        int near[3] = {cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1};
        double out = 0;
        for (int d = 0; d < 3; d++) {
            double q = (at[d] - v->origin[d]) / v->cell - near[d];
            out = fmax(out, fmax(-q, q - 1));
        }
        if (out < 1e-6 && sm_voxel_get(v, near[0], near[1], near[2])) return true;
    }
    return false;
}

static void check_voxels(const Statue *statue, BenchSurface *surface)
{
    const SmMesh *mesh = &statue->mesh;
    long outside = 0;
    for (long t = 0; t < mesh->triangle_count; t++) {
        double centre[3] = {0};
        for (int c = 0; c < 3; c++)
            for (int d = 0; d < 3; d++) centre[d] += mesh->position[mesh->triangle[t][c]][d] / 3;
        outside += !in_material(&statue->voxels, centre);
    }
    for (long v = 0; v < mesh->vertex_count; v++)
        outside += !in_material(&statue->voxels, mesh->position[v]);
    struct BenchSurfaceTime *kernel = &surface->kernel[BENCH_VOXELISE];
    kernel->valid = outside == 0;
    if (outside)
        snprintf(kernel->reason, sizeof kernel->reason,
                 "%ld points of the surface lie outside the material", outside);
}

/* (x, y, z) about the origin: a third of a turn, so (y, z, x), and a shift. */
static void turn(const double from[3], double to[3])
{
    for (int d = 0; d < 3; d++) to[d] = from[(d + 1) % 3] + d;
}

static void deform(Statue *statue, BenchSurfaceKernel kernel)
{
    if (kernel == BENCH_EMBED)
        sm_embed_apply(&statue->embedding, (const double(*)[3])statue->x, statue->position,
                       statue->normal);
    else
        oct_surface_move(&statue->carried, (const double(*)[3])statue->node, statue->position,
                         statue->normal);
}

/* Have the vertices turned with what carries them? */
static void check_turned(Statue *statue, BenchSurfaceKernel which, BenchSurface *surface)
{
    double largest = 0, cell = statue->voxels.cell;
    struct BenchSurfaceTime *kernel = &surface->kernel[which];
    deform(statue, which);
    for (long v = 0; v < statue->mesh.vertex_count; v++) {
        double wanted[3];
        turn(statue->mesh.position[v], wanted);
        for (int d = 0; d < 3; d++) {
            double off = fabs(statue->position[v][d] - wanted[d]);
            largest = off <= largest ? largest : off;
        }
    }
    kernel->valid = largest <= 1e-4 * cell;
    if (!kernel->valid)
        snprintf(kernel->reason, sizeof kernel->reason,
                 "vertices are off by %.3g cells; at most 1e-4 allowed", largest / cell);
}

static SmCode make_octree(Statue *statue, SmError *error)
{
    OctSampling sampling = {.levels = 4, .criteria_count = 1};
    sampling.criteria[0] = (OctCriterion){.kind = OCT_FEATURES, .level = 4};
    OctTree tree;
    OctGraph graph;
    SmCode code = oct_sampling_tree(&sampling, &statue->voxels, &tree, NULL, error);
    if (code) return code;
    oct_graph_build(&tree, &statue->voxels, &graph);
    oct_surface_build(&statue->mesh, &(OctCarrier){&statue->voxels, &tree, &graph, NULL},
                      &statue->carried);
    statue->node = sm_alloc((size_t)tree.leaves, sizeof *statue->node);
    for (long leaf = 0; leaf < tree.leaves; leaf++)
        turn(statue->carried.centre[leaf], statue->node[leaf]);
    oct_graph_free(&graph);
    oct_tree_free(&tree);
    return SM_OK;
}

static SmCode make_statue(Statue *statue, SmError *error)
{
    SmVoxelParams params = {.fill = SM_SOLID, .particles = PARTICLES};
    SmCode code = sm_shape_mesh("statue", &statue->mesh, error);
    if (!code) code = sm_voxelise(&statue->mesh, &params, "statue", &statue->voxels, error);
    if (code) return code;
    size_t particles = (size_t)statue->voxels.particle_count;
    size_t vertices = (size_t)statue->mesh.vertex_count;
    int(*at)[3] = sm_alloc(particles, sizeof *at);
    statue->x = sm_alloc(particles, sizeof *statue->x);
    statue->position = sm_alloc(vertices, sizeof *statue->position);
    statue->normal = sm_alloc(vertices, sizeof *statue->normal);
    sm_voxels_particles(&statue->voxels, at);
    for (size_t p = 0; p < particles; p++) {
        double rest[3];
        for (int d = 0; d < 3; d++)
            rest[d] = statue->voxels.origin[d] + statue->voxels.cell * at[p][d];
        turn(rest, statue->x[p]);
    }
    free(at);
    sm_embed_create(&statue->mesh, &statue->voxels, &statue->embedding);
    return make_octree(statue, error);
}

static void free_statue(Statue *statue)
{
    sm_mesh_free(&statue->mesh);
    sm_voxels_free(&statue->voxels);
    sm_embed_free(&statue->embedding);
    oct_surface_free(&statue->carried);
    free(statue->node);
    free(statue->x);
    free(statue->position);
    free(statue->normal);
}

/* Seconds of one voxelisation at the statue's cell size. */
static double voxelise_once(const Statue *statue, BenchSurface *surface)
{
    SmVoxelParams params = {.fill = SM_SOLID, .cell = statue->voxels.cell};
    SmVoxels voxels;
    SmError error;
    struct BenchSurfaceTime *kernel = &surface->kernel[BENCH_VOXELISE];
    bench_watch_start(&kernel->watch);
    SmCode code = sm_voxelise(&statue->mesh, &params, "statue", &voxels, &error);
    double seconds = bench_watch_stop(&kernel->watch);
    if (code) {
        kernel->valid = false;
        snprintf(kernel->reason, sizeof kernel->reason, "%.100s", error.text);
        return 0;
    }
    sm_voxels_free(&voxels);
    return seconds;
}

static double deform_once(Statue *statue, BenchSurfaceKernel kernel, BenchWatch *watch)
{
    bench_watch_start(watch);
    for (int i = 0; i < DEFORM_ROUNDS; i++) deform(statue, kernel);
    return bench_watch_stop(watch) / DEFORM_ROUNDS;
}

/* Nanoseconds an item of one run of a kernel. */
static double time_once(Statue *statue, BenchSurfaceKernel kernel, BenchSurface *surface)
{
    if (kernel == BENCH_VOXELISE)
        return 1e9 * voxelise_once(statue, surface) / (double)surface->triangles;
    return 1e9 * deform_once(statue, kernel, &surface->kernel[kernel].watch) /
           (double)surface->vertices;
}

static double sample(Statue *statue, BenchSurfaceKernel kernel, BenchSurface *surface)
{
    double ns;
    do ns = time_once(statue, kernel, surface);
    while (bench_watch_again(&surface->kernel[kernel].watch));
    return ns;
}

SmCode bench_surface_time(int threads, int repeats, BenchSurface *surface, SmError *error)
{
    Statue statue = {0};
    SmCode code = make_statue(&statue, error);
    if (code) {
        free_statue(&statue);
        return code;
    }
    surface->triangles = statue.mesh.triangle_count;
    surface->vertices = statue.mesh.vertex_count;
    surface->particles = statue.voxels.particle_count;
    surface->nodes = statue.carried.gradients.count;
    surface->nodes_blended = (double)statue.carried.rows.live / (double)surface->vertices;
    int before = sm_team_enter(threads);
    for (int k = 0; k < BENCH_SURFACE_KERNELS; k++) {
        surface->kernel[k].ns = sm_alloc((size_t)repeats, sizeof(double));
        if (!surface->kernel[k].wanted) continue;
        if (k == BENCH_VOXELISE)
            check_voxels(&statue, surface);
        else
            check_turned(&statue, (BenchSurfaceKernel)k, surface);
        surface->kernel[k].watch = bench_watch(k == BENCH_VOXELISE ? 1 : threads);
    }
    for (int r = 0; r < repeats; r++)
        for (int k = 0; k < BENCH_SURFACE_KERNELS; k++)
            if (surface->kernel[k].wanted && surface->kernel[k].valid)
                surface->kernel[k].ns[r] = sample(&statue, (BenchSurfaceKernel)k, surface);
    sm_team_leave(before);
    free_statue(&statue);
    return SM_OK;
}
