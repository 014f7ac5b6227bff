/* weights.h - what a body's structure and masses say once and for all, in double precision. */
#ifndef OCT_WEIGHTS_H
#define OCT_WEIGHTS_H

#include "breadth.h"

typedef enum {
    OCT_CONSERVING, /* m~_i = m_i / M_i: linear and angular momentum are kept */
    OCT_PLAIN,      /* m_i, as octree eqs. 6 and 7 print it */
} OctWeighting;

/* Goal positions: the sum over the regions that contain a node. */
typedef enum {
    OCT_HIERARCHICAL, /* HF over the node's own region: right where regions are symmetric (eq. 8) */
    OCT_ADJOINT,      /* the transpose of the region sums: right for any regions */
} OctGoalForm;

/* Lengths in finest cells. Of simulation node i and region r, which share a number. */
typedef struct {
    double mass_unit;    /* kg: the mean mass */
    double *mass;        /* [leaves] m_r, in mass_unit */
    double *weight;      /* [leaves] what m_i counts in region sums, by the weighting */
    double *reach;       /* [leaves] M_i: sum of m_r over the regions r that contain i (eq. 8) */
    double *region_mass; /* [leaves] sum of the weights in region r */
    double (*offset)[3]; /* [leaves] c0_r - x0_r */
    bool *thin;          /* [leaves] the region's nodes lie on a line, or it has but one */
    double (*axis)[3];   /* [leaves] of thin regions the line's direction, or 0; else 0 */
    double (*spread)[6]; /* [leaves] sum of weight (x0 - c0_r)(x0 - c0_r)^T: xx yy zz yz zx xy */
} OctWeights;

/* `mass` is [leaves] kg, positive. O(entries of the lists). The caller frees. */
void oct_weights_build(const OctTree *tree, const OctBreadth *lists, const double *mass,
                       OctWeighting weighting, OctWeights *weights);
void oct_weights_free(OctWeights *weights);

#endif
