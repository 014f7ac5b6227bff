/* mpu.h - the surface of oriented points as an implicit function: multi-level partition of unity
 * (Ohtake et al. 2003; meshless section 4.1). */
#ifndef REF_MPU_H
#define REF_MPU_H

#include "cloud.h"
#include "field.h"

typedef struct {
    double tolerance; /* distance of points from their local shape, as a share of the box's
                       * diagonal; 0: 1e-3. Give points with noise twice the noise. */
} RefMpuOptions;

/* A cell's local shape Q = s^T A s + b s + c in s = (x - centre) / radius, times radius: a length.
 */
typedef struct {
    double centre[3], edge, radius; /* of the ball in which it counts */
    double low[3], high[3];         /* box of the balls of all its leaves */
    int child;                      /* the first of eight, or -1: a leaf */
    double shape[10];               /* of a leaf: xx xy xz yy yz zz x y z 1 */
} RefMpuCell;

typedef struct {
    RefPoints points; /* taken over */
    RefCloud cloud;
    double tolerance; /* a length */
    int count, room;
    RefMpuCell *cell;
    bool flipped; /* the normals pointed inwards and were turned round */
} RefMpu;

/* Builds the function and takes `points` over, also when it fails. Cells in whose ball no point
 * lies know the distance to the nearest point, and their side by how often the surface winds around
 * them, so that signs are sane everywhere and holes are closed. Errors (SM_INPUT): points that
 * leave more than a sixth of the directions open (a sheet, half a scan), or whose normals disagree
 * about what is inside. */
SmCode ref_mpu_build(RefPoints *points, const RefMpuOptions *options, RefMpu *mpu, SmError *error);
void ref_mpu_free(RefMpu *mpu);

/* Whether the points lie near enough to each other to tell inside from outside. True also where
 * ref_mpu_build() refuses them because they leave the surface open. */
bool ref_mpu_dense(const RefPoints *points);

/* The function as a field; `mpu` stays the caller's. O(log cells). */
RefField ref_mpu_field(const RefMpu *mpu);

#endif
