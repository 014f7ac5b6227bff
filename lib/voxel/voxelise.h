/* voxelise.h - one mesh, voxelised at one or many cell sizes. */
#ifndef SM_VOXELISE_H
#define SM_VOXELISE_H

#include "voxel.h"

/* Of one call of sm_voxelise(), which makes it. */
typedef struct {
    const SmMesh *mesh;
    const char *name; /* for messages */
    SmFill fill;
    double low[3], extent[3]; /* of the triangles' box */
    double longest;           /* the largest extent */
    bool closed;              /* every edge is used by an even number of triangles */
    double (*point)[3];       /* [vertex_count], scratch */
} SmVoxeliser;

/* 64-bit words of a lattice of this cell size, moved by half a cell; INFINITY beyond the limits of
 * sm_voxelise(). */
double sm_voxeliser_words(const SmVoxeliser *voxeliser, double cell);

/* Makes a lattice, its box moved by `shift` of a cell (0..1 along each axis) from the centred one;
 * fills all of `report` but its number of voxelisations. Errors as sm_voxelise(). */
SmCode sm_voxeliser_build(SmVoxeliser *voxeliser, double cell, const double shift[3],
                          SmVoxels *voxels, SmVoxelReport *report, SmError *error);

#endif
