#include "mass.h"

#include <stdlib.h>

#include "../../lib/bits.h"

/* A box within the lattice: cells low .. high - 1. */
typedef struct {
    int low[3], high[3];
} Box;

static Box box_within(const SmVoxels *v, const int low[3], int wide)
{
    Box box;
    for (int d = 0; d < 3; d++) {
        box.low[d] = low[d] > 0 ? low[d] : 0;
        box.high[d] = low[d] + wide < v->size[d] ? low[d] + wide : v->size[d];
    }
    return box;
}

static long row_number(const SmVoxels *v, int j, int k)
{
    return (long)k * v->size[1] + j;
}

/* Cells low .. high - 1 of word w of a row. */
static uint64_t cells_of(const SmVoxels *v, long row, int w, int low, int high)
{
    uint64_t bits = v->bits[row * v->words + w];
    int from = low - 64 * w, to = high - 64 * w;
    if (from >= 64 || to <= 0) return 0;
    if (from > 0) bits &= ~(uint64_t)0 << from;
    if (to < 64) bits &= ((uint64_t)1 << to) - 1;
    return bits;
}

long oct_mass_cells(const SmVoxels *voxels, const int low[3], int wide)
{
    Box box = box_within(voxels, low, wide);
    long cells = 0;
    for (int k = box.low[2]; k < box.high[2]; k++)
        for (int j = box.low[1]; j < box.high[1]; j++)
            for (int w = box.low[0] / 64; w <= (box.high[0] - 1) / 64; w++)
                cells += sm_count_bits(
                    cells_of(voxels, row_number(voxels, j, k), w, box.low[0], box.high[0]));
    return cells;
}

/* The number of a material cell. */
static long cell_number(const OctMass *mass, const SmVoxels *v, int i, int j, int k)
{
    long row = row_number(v, j, k), number = mass->row_first[row];
    for (int w = 0; 64 * w < i; w++) number += sm_count_bits(cells_of(v, row, w, 0, i));
    return number;
}

static void share(const OctMass *mass, const SmVoxels *v, const int at[3], double vertex)
{
    long cell[8];
    int count = 0;
    for (int corner = 0; corner < 8; corner++) {
        int i = at[0] - (corner & 1), j = at[1] - (corner >> 1 & 1), k = at[2] - (corner >> 2);
        if (sm_voxel_get(v, i, j, k)) cell[count++] = cell_number(mass, v, i, j, k);
    }
    for (int n = 0; n < count; n++) mass->cell[cell[n]] += vertex / count;
}

void oct_mass_init(OctMass *mass, const SmVoxels *voxels, const double *vertex, OctMassRule rule)
{
    *mass = (OctMass){.rule = rule};
    if (!vertex) return;
    long rows = (long)voxels->size[1] * voxels->size[2], cells = 0;
    mass->cell = sm_alloc((size_t)voxels->cell_count, sizeof *mass->cell);
    mass->row_first = sm_alloc((size_t)rows, sizeof *mass->row_first);
    for (long row = 0; row < rows; row++) {
        mass->row_first[row] = cells;
        for (int w = 0; w < voxels->words; w++)
            cells += sm_count_bits(voxels->bits[row * voxels->words + w]);
    }
    int(*at)[3] = sm_alloc((size_t)voxels->particle_count, sizeof *at);
    sm_voxels_particles(voxels, at);
    for (long p = 0; p < voxels->particle_count; p++) share(mass, voxels, at[p], vertex[p]);
    free(at);
}

void oct_mass_free(OctMass *mass)
{
    free(mass->cell);
    free(mass->row_first);
    *mass = (OctMass){0};
}

static double material_of(const OctMass *mass, const OctTree *tree, const SmVoxels *voxels,
                          int node)
{
    if (!mass->cell) return (double)tree->material[node];
    int low[3];
    for (int d = 0; d < 3; d++) low[d] = oct_tree_low(tree, node, d);
    Box box = box_within(voxels, low, tree->size[node] / 2);
    double sum = 0;
    for (int k = box.low[2]; k < box.high[2]; k++)
        for (int j = box.low[1]; j < box.high[1]; j++) {
            long row = row_number(voxels, j, k), cells = 0;
            for (int w = box.low[0] / 64; w <= (box.high[0] - 1) / 64; w++)
                cells += sm_count_bits(cells_of(voxels, row, w, box.low[0], box.high[0]));
            if (cells == 0) continue;
            const double *cell = mass->cell + cell_number(mass, voxels, box.low[0], j, k);
            for (long n = 0; n < cells; n++) sum += cell[n];
        }
    return sum;
}

double oct_mass_of(const OctMass *mass, const OctTree *tree, const SmVoxels *voxels, int node)
{
    double material = material_of(mass, tree, voxels, node);
    return mass->rule == OCT_VOLUME ? material / oct_tree_filled(tree, node) : material;
}
