/* shape.h - procedural models: implicit shapes made into closed triangle meshes.
 *
 * They stand in for the papers' models, which cannot be shipped, and have their triangle counts.
 * The same name gives the same bytes on every machine and from every compiler. y is up; one unit is
 * one metre. */
#ifndef SM_SHAPE_H
#define SM_SHAPE_H

#include "../mesh/mesh.h"

typedef struct {
    const char *name;        /* "penguin", "statue", "infant", "hand", "liver", "flower", ... */
    const char *description; /* one line for `shapebench scenes` */
    long triangles;          /* of the mesh that sm_shape_mesh() makes */
} SmShape;

/* All shapes, in a fixed order; `count` receives how many. */
const SmShape *sm_shapes(int *count);

/* The shape with this name, or NULL. */
const SmShape *sm_shape_find(const char *name);

/* Makes the closed mesh. The caller frees it. SM_USAGE for a name that is not a shape. */
SmCode sm_shape_mesh(const char *name, SmMesh *mesh, SmError *error);

#endif
