#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/shapes/shape.h"
#include "../../lib/voxel/embed.h"
#include "../../lib/voxel/voxelise.h"
#include "../../octree/surface/surface.h"
#include "../../octree/tree/sampling.h"
#include "kernel.h"

enum { PARTICLES = 57626, DEFORM_ROUNDS = 2 };
static const double tolerance = 1e-4; /* of a cell */

typedef struct {
    SmMesh mesh;
    SmVoxels voxels;
    SmEmbedding embedding;
    OctSurface carried;
    double (*x)[3];                      /* [particle_count] the lattice, turned */
    double (*node)[3];                   /* [nodes] the octree, turned */
    double (*position)[3], (*normal)[3]; /* [vertex_count] */
} Statue;

/* One of the kernels. */
typedef struct {
    BenchTrial trial;
    Statue *statue;
    SmVoxels voxels; /* of the last run */
} Surface;

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

/* Every vertex and triangle centre lies in a material cell. */
static void check_voxels(const Statue *statue, BenchTrial *trial)
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
    if (outside)
        bench_trial_fail(trial, "%ld points of the surface lie outside the material", outside);
}

/* (x, y, z) about the origin: a third of a turn, so (y, z, x), and a shift. */
static void turn(const double from[3], double to[3])
{
    for (int d = 0; d < 3; d++) to[d] = from[(d + 1) % 3] + d;
}

static void embed(void *subject, SmLaps *laps)
{
    const Statue *statue = ((Surface *)subject)->statue;
    (void)laps;
    sm_embed_apply(&statue->embedding, (const double(*)[3])statue->x, statue->position,
                   statue->normal);
}

static void carry(void *subject, SmLaps *laps)
{
    Statue *statue = ((Surface *)subject)->statue;
    (void)laps;
    oct_surface_move(&statue->carried, (const double(*)[3])statue->node, statue->position,
                     statue->normal);
}

/* Have the vertices turned with what carries them? */
static void check_turned(Surface *surface)
{
    const Statue *statue = surface->statue;
    double largest = 0, cell = statue->voxels.cell;
    surface->trial.timed.step(surface, NULL);
    for (long v = 0; v < statue->mesh.vertex_count; v++) {
        double wanted[3];
        turn(statue->mesh.position[v], wanted);
        for (int d = 0; d < 3; d++) {
            double off = fabs(statue->position[v][d] - wanted[d]);
            largest = off <= largest ? largest : off;
        }
    }
    if (!(largest <= tolerance * cell))
        bench_trial_fail(&surface->trial, "vertices are off by %.3g cells; at most 1e-4 allowed",
                         largest / cell);
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

static void free_statue(void *body)
{
    Statue *statue = body;
    sm_mesh_free(&statue->mesh);
    sm_voxels_free(&statue->voxels);
    sm_embed_free(&statue->embedding);
    oct_surface_free(&statue->carried);
    free(statue->node);
    free(statue->x);
    free(statue->position);
    free(statue->normal);
    free(statue);
}

/* Voxelised to about PARTICLES; the search for the cell size is not timed. */
static SmCode open_statue(const BenchKernel *kernel, const BenchKernelParams *params, void **body,
                          SmError *error)
{
    (void)kernel, (void)params;
    *body = sm_alloc(1, sizeof(Statue));
    return make_statue(*body, error);
}

static void forget_voxels(void *subject)
{
    sm_voxels_free(&((Surface *)subject)->voxels);
}

/* At the statue's cell size. */
static void voxelise(void *subject, SmLaps *laps)
{
    Surface *surface = subject;
    SmVoxelParams params = {.fill = SM_SOLID, .cell = surface->statue->voxels.cell};
    SmCode code = sm_voxelise(&surface->statue->mesh, &params, "statue", &surface->voxels, NULL);
    assert(!code); /* it has been voxelised before */
    (void)laps, (void)code;
}

static SmCode prepare(BenchJob *job, SmError *error)
{
    static const BenchTimed timed[] = {
        {NULL, forget_voxels, voxelise}, {NULL, NULL, embed}, {NULL, NULL, carry}};
    bool voxels = job->kernel->part == BENCH_VOXELISE;
    Surface *surface = job->subject = sm_alloc(1, sizeof *surface);
    (void)error;
    if (voxels) job->threads = 1;
    surface->statue = job->body;
    surface->trial = (BenchTrial){.timed = timed[job->kernel->part],
                                  .threads = job->threads,
                                  .runs = voxels ? 1 : DEFORM_ROUNDS,
                                  .valid = true};
    surface->trial.timed.subject = surface;
    if (voxels)
        check_voxels(surface->statue, &surface->trial);
    else
        check_turned(surface);
    const SmMesh *mesh = &surface->statue->mesh;
    job->trial = &surface->trial;
    job->arithmetic = "double";
    job->item = voxels ? "triangle" : "vertex";
    job->items = voxels ? mesh->triangle_count : mesh->vertex_count;
    job->per_run = (double)job->items;
    return SM_OK;
}

static void report(BenchJob *job, BenchKernelRow *row)
{
    const Statue *statue = job->body;
    double vertices = (double)statue->mesh.vertex_count;
    double triangles = (double)statue->mesh.triangle_count;
    double particles = (double)statue->voxels.particle_count;
    double nodes = (double)statue->carried.gradients.count;
    double blended = (double)statue->carried.rows.live / vertices;
    switch (job->kernel->part) {
    case BENCH_EMBED:
        job->least = sm_embed_operations(particles / vertices);
        job->footprint = 176 * vertices + 24 * particles;
        strcpy(row->note, "positions and normals");
        break;
    case BENCH_CARRY:
        job->least = oct_surface_operations(blended, nodes / vertices);
        job->footprint = (104 + 8 * blended) * vertices + 120 * nodes;
        snprintf(row->note, sizeof row->note, "positions and normals, %.0f nodes, %.2g a vertex",
                 nodes, blended);
        break;
    default:
        job->least = sm_voxelise_operations(vertices / triangles);
        job->footprint = 24 * vertices + 12 * triangles;
        snprintf(row->note, sizeof row->note, "%.3g million triangles/s", 1e3 / row->ns);
    }
}

const BenchKernelKind bench_surface_kernels = {.open = open_statue,
                                               .close = free_statue,
                                               .prepare = prepare,
                                               .report = report,
                                               .release = forget_voxels};
