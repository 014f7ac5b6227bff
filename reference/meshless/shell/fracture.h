/* fracture.h - where cracks of a shell begin, go on and branch (meshless section 4.2 says that they
 * do; the rules are filled in: Rankine's for brittle plates).
 *
 * The stress of a face is E / (1 - nu^2) H (eps +- t/2 kap). Where the larger principal stress of
 * both faces is above the strength, a crack begins across its direction, through the thickness,
 * half a cell to either side, unless another one is near. A tip goes on by half a cell where the
 * stress about it is above the strength, across its direction but not by a sharp turn, and in two
 * where it is above the strength by a factor. What is less than a cell wide is no ligament: a tip
 * goes on to a rim or another crack that is no farther ahead. */
#ifndef REF_FRACTURE_H
#define REF_FRACTURE_H

#include "cracked.h"

typedef struct {
    double strength;  /* Pa where lengths are m; above 0 */
    double branching; /* a tip goes on in two from this many times the strength; 0: never */
    int most_starts;  /* in a step */
} RefFractureOptions;

/* The stress of a face in the plane of the parameters. */
typedef struct {
    double theta[2];
    double
        sigma[3]; /* contravariant, 11, 22, 12, of the face where the principal stress is larger */
    double metric[3];
    double principal; /* the larger principal stress, and */
    double along[2];  /* the direction across it, in which a crack goes */
} RefFaceStress;

/* The stresses of displacements u, [nodes][3], in the middles of the quarters of all terminal
 * cells, four of each; zero, with a metric of zero, where the shell is not stiff. The caller frees.
 * `count` receives how many. O(cells * covers). */
RefFaceStress *ref_fracture_stresses(const RefCracked *cracked, const double (*u)[3], long *count);

/* Lets cracks begin, go on and branch by these displacements, once; the update is the caller's.
 * Returns how many pieces of cracks that made. */
int ref_fracture_grow(RefCracked *cracked, const RefFractureOptions *options, const double (*u)[3]);

#endif
