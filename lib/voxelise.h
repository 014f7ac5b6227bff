/* voxelise.h - one mesh, voxelised at one or many cell sizes. */
#ifndef SM_VOXELISE_H
#define SM_VOXELISE_H

#include "voxel.h"

typedef struct {
    const SmMesh *mesh;
    const char *name; /* for messages */
    SmFill fill;
    double low[3], extent[3]; /* of the triangles' box */
    double longest;           /* the largest extent */
    bool closed;              /* every edge is used by an even number of triangles */
    double (*point)[3];       /* [vertex_count], scratch */
} SmVoxeliser;

/* Checks the mesh (the errors of sm_mesh_check()) and measures it. Free in any case. */
SmCode sm_voxeliser_init(SmVoxeliser *voxeliser, const SmMesh *mesh, SmFill fill, const char *name,
                         SmError *error);
void sm_voxeliser_free(SmVoxeliser *voxeliser);

/* 64-bit words of a lattice of this cell size, moved by half a cell; INFINITY beyond the limits of
 * sm_voxelise(). */
double sm_voxeliser_words(const SmVoxeliser *voxeliser, double cell);

/* Makes a lattice, its box moved by `shift` of a cell (0..1 along each axis) from the centred one;
 * fills all of `report` but its number of voxelisations. Errors as sm_voxelise(). */
SmCode sm_voxeliser_build(SmVoxeliser *voxeliser, double cell, const double shift[3],
                          SmVoxels *voxels, SmVoxelReport *report, SmError *error);

#endif
