#include "voxel.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../bits.h"
#include "../system/team.h"

void sm_voxels_init(SmVoxels *voxels, int nx, int ny, int nz, double cell)
{
    assert(nx > 0 && ny > 0 && nz > 0 && cell > 0);
    int words = (nx - 1) / 64 + 1;
    *voxels = (SmVoxels){.size = {nx, ny, nz}, .cell = cell, .words = words};
    voxels->bits = sm_alloc(sm_voxels_words(voxels), sizeof *voxels->bits);
}

void sm_voxels_fill(SmVoxels *voxels)
{
    uint64_t last = ~(uint64_t)0 >> (63 - ((voxels->size[0] - 1) & 63));
    long words = (long)sm_voxels_words(voxels);
#pragma omp parallel for schedule(static) num_threads(sm_team_for(words))
    for (long w = 0; w < words; w++)
        voxels->bits[w] = (w + 1) % voxels->words ? ~(uint64_t)0 : last;
}

void sm_voxels_block(SmVoxels *voxels, int nx, int ny, int nz, double cell)
{
    sm_voxels_init(voxels, nx, ny, nz, cell);
    sm_voxels_fill(voxels);
    sm_voxels_count(voxels);
}

void sm_voxels_copy(const SmVoxels *from, SmVoxels *to)
{
    *to = *from;
    to->bits = sm_alloc(sm_voxels_words(from), sizeof *to->bits);
    memcpy(to->bits, from->bits, sm_voxels_words(from) * sizeof *to->bits);
}

void sm_voxels_free(SmVoxels *voxels)
{
    free(voxels->bits);
    *voxels = (SmVoxels){0};
}

long sm_voxels_cells(const SmVoxels *voxels)
{
    long cells = 0, words = (long)sm_voxels_words(voxels);
#pragma omp parallel for schedule(static) num_threads(sm_team_for(words)) reduction(+ : cells)
    for (long w = 0; w < words; w++) cells += sm_count_bits(voxels->bits[w]);
    return cells;
}

/* ORs a row of cells into the row of vertices at their ends: cell i has vertices i and i + 1. */
static void add_ends(const uint64_t *cells, int words, uint64_t *vertex)
{
    uint64_t last = 0;
    for (int w = 0; w < words; w++) {
        vertex[w] |= cells[w] | cells[w] << 1 | last;
        last = cells[w] >> 63;
    }
    if (last) vertex[words] |= last;
}

int sm_voxels_vertices(const SmVoxels *v, int y, int z, uint64_t *vertex)
{
    int count = 0, words = v->size[0] / 64 + 1;
    memset(vertex, 0, (size_t)words * sizeof *vertex);
    for (int k = z - 1; k <= z; k++)
        for (int j = y - 1; j <= y; j++)
            if (j >= 0 && k >= 0 && j < v->size[1] && k < v->size[2])
                add_ends(v->bits + sm_voxels_row(v, j, k), v->words, vertex);
    for (int w = 0; w < words; w++) count += sm_count_bits(vertex[w]);
    return count;
}

/* Particles before each plane of lattice vertices, [size[2] + 2]; the caller frees. */
static long *count_planes(const SmVoxels *voxels)
{
    int planes = voxels->size[2] + 1;
    long *first = sm_alloc((size_t)planes + 1, sizeof *first);
#pragma omp parallel num_threads(sm_team_for((long)sm_voxels_words(voxels)))
    {
        uint64_t *vertex = sm_alloc((size_t)voxels->size[0] / 64 + 1, sizeof *vertex);
#pragma omp for schedule(static)
        for (int k = 0; k < planes; k++)
            for (int j = 0; j <= voxels->size[1]; j++)
                first[k + 1] += sm_voxels_vertices(voxels, j, k, vertex);
        free(vertex);
    }
    for (int k = 0; k < planes; k++) first[k + 1] += first[k];
    return first;
}

void sm_voxels_count(SmVoxels *voxels)
{
    long *first = count_planes(voxels);
    voxels->cell_count = sm_voxels_cells(voxels);
    voxels->particle_count = first[voxels->size[2] + 1];
    free(first);
}

/* The particles of one plane; `vertex` is scratch for a row. */
static void plane_particles(const SmVoxels *voxels, int k, uint64_t *vertex, int (*coordinate)[3])
{
    for (int j = 0; j <= voxels->size[1]; j++) {
        sm_voxels_vertices(voxels, j, k, vertex);
        for (int w = 0; w <= voxels->size[0] / 64; w++)
            for (uint64_t rest = vertex[w]; rest; rest &= rest - 1, coordinate++) {
                (*coordinate)[0] = w * 64 + __builtin_ctzll(rest);
                (*coordinate)[1] = j;
                (*coordinate)[2] = k;
            }
    }
}

void sm_voxels_particles(const SmVoxels *voxels, int (*coordinate)[3])
{
    long *first = count_planes(voxels);
#pragma omp parallel num_threads(sm_team_for((long)sm_voxels_words(voxels)))
    {
        uint64_t *vertex = sm_alloc((size_t)voxels->size[0] / 64 + 1, sizeof *vertex);
#pragma omp for schedule(static)
        for (int k = 0; k <= voxels->size[2]; k++)
            plane_particles(voxels, k, vertex, coordinate + first[k]);
        free(vertex);
    }
    free(first);
}

void sm_voxels_rest(const SmVoxels *voxels, double (*position)[3])
{
    int(*at)[3] = sm_alloc((size_t)voxels->particle_count, sizeof *at);
    sm_voxels_particles(voxels, at);
#pragma omp parallel for schedule(static) num_threads(sm_team_for(voxels->particle_count))
    for (long p = 0; p < voxels->particle_count; p++)
        for (int d = 0; d < 3; d++) position[p][d] = voxels->origin[d] + voxels->cell * at[p][d];
    free(at);
}

/* Squared distance, in cells, from lattice position q to the cell. */
static double cell_distance(const double q[3], const int cell[3])
{
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        double d = fmax(fmax(cell[a] - q[a], q[a] - cell[a] - 1), 0);
        sum += d * d;
    }
    return sum;
}

/* Nearest material cell among those at most `reach` from `middle`; false: none. */
static bool nearest_within(const SmVoxels *voxels, const double q[3], const int middle[3],
                           int reach, int nearest[3])
{
    double best = DBL_MAX;
    int low[3], high[3];
    for (int a = 0; a < 3; a++) {
        low[a] = middle[a] - reach > 0 ? middle[a] - reach : 0;
        high[a] = middle[a] < voxels->size[a] - 1 - reach ? middle[a] + reach : voxels->size[a] - 1;
    }
    for (int k = low[2]; k <= high[2]; k++)
        for (int j = low[1]; j <= high[1]; j++)
            for (int i = low[0]; i <= high[0]; i++) {
                int cell[3] = {i, j, k};
                if (!sm_voxel_get(voxels, i, j, k) || cell_distance(q, cell) >= best) continue;
                best = cell_distance(q, cell);
                memcpy(nearest, cell, sizeof cell);
            }
    return best < DBL_MAX;
}

void sm_nearest_cell(const SmVoxels *voxels, const double q[3], int cell[3])
{
    int middle[3];
    for (int a = 0; a < 3; a++) middle[a] = (int)fmin(fmax(floor(q[a]), 0), voxels->size[a] - 1);
    memcpy(cell, middle, sizeof middle);
    if (sm_voxel_get(voxels, cell[0], cell[1], cell[2])) return;
    int largest = voxels->size[0] > voxels->size[1] ? voxels->size[0] : voxels->size[1];
    if (voxels->size[2] > largest) largest = voxels->size[2];
    int reach = 1;
    while (!nearest_within(voxels, q, middle, reach, cell) && reach < largest)
        reach = reach < largest / 2 ? 2 * reach : largest;
    /* A cell on a side may be nearer than one found in a corner of the range. */
    if (reach > 1)
        nearest_within(voxels, q, middle, reach < largest / 2 ? 2 * reach : largest, cell);
}

void sm_voxels_weigh(const SmVoxels *voxels, double density, double *mass)
{
    double eighth = density * voxels->cell * voxels->cell * voxels->cell / 8;
    int(*at)[3] = sm_alloc((size_t)voxels->particle_count, sizeof *at);
    sm_voxels_particles(voxels, at);
#pragma omp parallel for schedule(static) num_threads(sm_team_for(voxels->particle_count))
    for (long p = 0; p < voxels->particle_count; p++) {
        mass[p] = 0;
        for (int corner = 0; corner < 8; corner++)
            if (sm_voxel_get(voxels, at[p][0] - (corner & 1), at[p][1] - (corner >> 1 & 1),
                             at[p][2] - (corner >> 2)))
                mass[p] += eighth;
    }
    free(at);
}
