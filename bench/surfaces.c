#include "surfaces.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/embed.h"
#include "../lib/shape.h"
#include "../lib/stage.h"
#include "../lib/voxel.h"

enum { PARTICLES = 57626, EMBED_ROUNDS = 2 };

typedef struct {
    SmMesh mesh;
    SmVoxels voxels;
    SmEmbedding embedding;
    double (*x)[3];                      /* [particle_count] the lattice, turned */
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
    surface->voxelise_valid = outside == 0;
    if (outside)
        snprintf(surface->voxelise_reason, sizeof surface->voxelise_reason,
                 "%ld points of the surface lie outside the material", outside);
}

/* (x, y, z) about the origin: a third of a turn, so (y, z, x), and a shift. */
static void turn(const double from[3], double to[3])
{
    for (int d = 0; d < 3; d++) to[d] = from[(d + 1) % 3] + d;
}

static void check_embedding(Statue *statue, BenchSurface *surface)
{
    double largest = 0, cell = statue->voxels.cell;
    sm_embed_apply(&statue->embedding, (const double(*)[3])statue->x, statue->position,
                   statue->normal);
    for (long v = 0; v < statue->mesh.vertex_count; v++) {
        double wanted[3];
        turn(statue->mesh.position[v], wanted);
        for (int d = 0; d < 3; d++) {
            double off = fabs(statue->position[v][d] - wanted[d]);
            largest = off <= largest ? largest : off;
        }
    }
    surface->embed_valid = largest <= 1e-4 * cell;
    if (!surface->embed_valid)
        snprintf(surface->embed_reason, sizeof surface->embed_reason,
                 "vertices are off by %.3g cells; at most 1e-4 allowed", largest / cell);
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
    return SM_OK;
}

static void free_statue(Statue *statue)
{
    sm_mesh_free(&statue->mesh);
    sm_voxels_free(&statue->voxels);
    sm_embed_free(&statue->embedding);
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
    double start = sm_now();
    SmCode code = sm_voxelise(&statue->mesh, &params, "statue", &voxels, &error);
    double seconds = sm_now() - start;
    if (code) {
        surface->voxelise_valid = false;
        snprintf(surface->voxelise_reason, sizeof surface->voxelise_reason, "%.100s", error.text);
        return 0;
    }
    sm_voxels_free(&voxels);
    return seconds;
}

static double embed_once(Statue *statue)
{
    double start = sm_now();
    for (int i = 0; i < EMBED_ROUNDS; i++)
        sm_embed_apply(&statue->embedding, (const double(*)[3])statue->x, statue->position,
                       statue->normal);
    return (sm_now() - start) / EMBED_ROUNDS;
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
    surface->voxelise_ns = sm_alloc((size_t)repeats, sizeof(double));
    surface->embed_ns = sm_alloc((size_t)repeats, sizeof(double));
    int before = omp_get_max_threads();
    omp_set_num_threads(threads); /* the embedding takes OpenMP's number */
    if (surface->voxelise) check_voxels(&statue, surface);
    if (surface->embed) check_embedding(&statue, surface);
    for (int r = 0; r < repeats; r++) {
        if (surface->voxelise && surface->voxelise_valid)
            surface->voxelise_ns[r] =
                1e9 * voxelise_once(&statue, surface) / (double)surface->triangles;
        if (surface->embed && surface->embed_valid)
            surface->embed_ns[r] = 1e9 * embed_once(&statue) / (double)surface->vertices;
    }
    omp_set_num_threads(before);
    free_statue(&statue);
    return SM_OK;
}
