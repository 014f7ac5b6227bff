#include "voxel.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void sm_voxels_init(SmVoxels *voxels, int nx, int ny, int nz, double cell)
{
    assert(nx > 0 && ny > 0 && nz > 0 && cell > 0);
    int words = (nx - 1) / 64 + 1;
    *voxels = (SmVoxels){.size = {nx, ny, nz}, .cell = cell, .words = words};
    voxels->bits = sm_alloc(sm_voxels_words(voxels), sizeof *voxels->bits);
}

void sm_voxels_block(SmVoxels *voxels, int nx, int ny, int nz, double cell)
{
    sm_voxels_init(voxels, nx, ny, nz, cell);
    for (int k = 0; k < nz; k++)
        for (int j = 0; j < ny; j++)
            for (int i = 0; i < nx; i++) sm_voxel_set(voxels, i, j, k);
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
    long cells = 0;
    for (size_t w = 0; w < sm_voxels_words(voxels); w++)
        cells += __builtin_popcountll(voxels->bits[w]);
    return cells;
}

/* The row of cells (j, k), or the row of no material outside the box. */
static const uint64_t *row_of(const SmVoxels *v, int j, int k, const uint64_t *none)
{
    if (j < 0 || k < 0 || j >= v->size[1] || k >= v->size[2]) return none;
    return v->bits + sm_voxels_row(v, j, k);
}

/* The four rows of cells that touch the row of lattice vertices (j, k). */
typedef struct {
    const uint64_t *row[4];
    uint64_t last; /* the last cell of the word before */
} VertexRow;

static VertexRow vertex_row(const SmVoxels *v, int j, int k, const uint64_t *none)
{
    return (VertexRow){{row_of(v, j - 1, k - 1, none), row_of(v, j, k - 1, none),
                        row_of(v, j - 1, k, none), row_of(v, j, k, none)},
                       0};
}

/* The vertices of word w, in rising order of w: cell i has vertices i and i + 1. A row of n words
 * of cells has vertices in words 0..n. */
static inline uint64_t vertex_word(VertexRow *r, int w, int words)
{
    uint64_t cells = 0;
    if (w < words) cells = r->row[0][w] | r->row[1][w] | r->row[2][w] | r->row[3][w];
    uint64_t vertices = cells | cells << 1 | r->last;
    r->last = cells >> 63;
    return vertices;
}

void sm_voxels_count(SmVoxels *voxels)
{
    uint64_t *none = sm_alloc((size_t)voxels->words, sizeof *none);
    long particles = 0;
    for (int k = 0; k <= voxels->size[2]; k++)
        for (int j = 0; j <= voxels->size[1]; j++) {
            VertexRow row = vertex_row(voxels, j, k, none);
            for (int w = 0; w <= voxels->words; w++)
                particles += __builtin_popcountll(vertex_word(&row, w, voxels->words));
        }
    free(none);
    voxels->cell_count = sm_voxels_cells(voxels);
    voxels->particle_count = particles;
}

void sm_voxels_particles(const SmVoxels *voxels, int (*coordinate)[3])
{
    uint64_t *none = sm_alloc((size_t)voxels->words, sizeof *none);
    long p = 0;
    for (int k = 0; k <= voxels->size[2]; k++)
        for (int j = 0; j <= voxels->size[1]; j++) {
            VertexRow row = vertex_row(voxels, j, k, none);
            for (int w = 0; w <= voxels->words; w++) {
                uint64_t vertices = vertex_word(&row, w, voxels->words);
                for (; vertices; vertices &= vertices - 1, p++) {
                    coordinate[p][0] = w * 64 + __builtin_ctzll(vertices);
                    coordinate[p][1] = j;
                    coordinate[p][2] = k;
                }
            }
        }
    free(none);
}

void sm_voxels_rest(const SmVoxels *voxels, double (*position)[3])
{
    int(*at)[3] = sm_alloc((size_t)voxels->particle_count, sizeof *at);
    sm_voxels_particles(voxels, at);
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
    for (long p = 0; p < voxels->particle_count; p++) {
        mass[p] = 0;
        for (int corner = 0; corner < 8; corner++)
            if (sm_voxel_get(voxels, at[p][0] - (corner & 1), at[p][1] - (corner >> 1 & 1),
                             at[p][2] - (corner >> 2)))
                mass[p] += eighth;
    }
    free(at);
}
