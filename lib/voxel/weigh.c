#include "weigh.h"

#include <stdlib.h>

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
