/* slice.h - the signed distance from a body's surface function on a plane, in HDF5.
 *
 * The file: kind = "shapebench slice", schema = 1; the attributes source, axis (0 x, 1 y, 2 z: the
 * normal), at (where the plane is), low and high ([2]: of the picture, across and along), points,
 * flipped (the normals pointed inwards); the dataset distance [rows][columns], negative inside.
 * Columns go across: along x, or z where that is the normal; rows along y, or z where that is. */
#ifndef BENCH_SLICE_H
#define BENCH_SLICE_H

#include <stdbool.h>

#include "../../lib/error.h"

/* A plane: "z=0.5" is halfway through the box along z. */
typedef struct {
    int axis;
    double share; /* 0..1 of the body's box */
} BenchSlice;

/* Reads "z=0.5"; false for anything else. */
bool bench_slice_parse(const char *text, BenchSlice *slice);

/* Writes the slice of the points' (or the mesh's) surface function; a margin of a tenth is around
 * the body. Errors: those of reading points and of mpu.h, SM_OUTPUT. */
SmCode bench_slice_write(const char *source, const BenchSlice *slice, const char *path,
                         SmError *error);

#endif
