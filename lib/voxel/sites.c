#include "sites.h"

#include <stdlib.h>

static size_t row_of(const SmVoxels *voxels, int j, int k)
{
    return (size_t)k * ((size_t)voxels->size[1] + 1) + (size_t)j;
}

void sm_sites_init(const SmVoxels *voxels, SmSites *sites)
{
    size_t rows = row_of(voxels, 0, voxels->size[2] + 1);
    sites->voxels = voxels;
    sites->coordinate = sm_alloc((size_t)voxels->particle_count, sizeof *sites->coordinate);
    sites->row = sm_alloc(rows + 1, sizeof *sites->row);
    sm_voxels_particles(voxels, sites->coordinate);
    for (long p = 0; p < voxels->particle_count; p++)
        sites->row[row_of(voxels, sites->coordinate[p][1], sites->coordinate[p][2]) + 1]++;
    for (size_t r = 0; r < rows; r++) sites->row[r + 1] += sites->row[r];
}

void sm_sites_free(SmSites *sites)
{
    free(sites->coordinate);
    free(sites->row);
    *sites = (SmSites){0};
}

int sm_sites_find(const SmSites *sites, int i, int j, int k)
{
    const int *size = sites->voxels->size;
    if (i < 0 || j < 0 || k < 0 || i > size[0] || j > size[1] || k > size[2]) return -1;
    size_t row = row_of(sites->voxels, j, k);
    int low = sites->row[row], high = sites->row[row + 1];
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (sites->coordinate[middle][0] <= i)
            low = middle;
        else
            high = middle;
    }
    return low < high && sites->coordinate[low][0] == i ? low : -1;
}

int sm_sites_ring(const SmSites *sites, long p, int neighbour[SM_RING])
{
    const int *c = sites->coordinate[p];
    unsigned ring = 0;
    int count = 0;
    for (int n = 0; n < 8; n++) {
        int low[3] = {(n & 1) - 1, (n >> 1 & 1) - 1, (n >> 2) - 1};
        if (!sm_voxel_get(sites->voxels, c[0] + low[0], c[1] + low[1], c[2] + low[2])) continue;
        for (int i = 0; i < 8; i++)
            ring |= 1u << ((low[0] + 1 + (i & 1)) + 3 * (low[1] + 1 + (i >> 1 & 1)) +
                           9 * (low[2] + 1 + (i >> 2)));
    }
    for (int n = 0; n < 27; n++)
        if (n != 13 && ring >> n & 1)
            neighbour[count++] =
                sm_sites_find(sites, c[0] + n % 3 - 1, c[1] + n / 3 % 3 - 1, c[2] + n / 9 - 1);
    return count;
}
