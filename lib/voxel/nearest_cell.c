#include "nearest_cell.h"

#include <float.h>
#include <math.h>
#include <string.h>

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
