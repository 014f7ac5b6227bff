/* weights.h - what a body's structure and masses say, in double precision. */
#ifndef OCT_WEIGHTS_H
#define OCT_WEIGHTS_H

#include <stdbool.h>

#include "region.h"

typedef enum {
    OCT_CONSERVING, /* m~_i = m_i / M_i: linear and angular momentum are kept */
    OCT_PLAIN,      /* m_i, as octree eqs. 6 and 7 print it */
} OctWeighting;

/* Goal positions: the sum over the regions that contain a node. */
typedef enum {
    OCT_HIERARCHICAL, /* HF over the node's own region: right where regions are symmetric (eq. 8) */
    OCT_ADJOINT,      /* the transpose of the region sums: right for any regions */
} OctGoalForm;

/* Lengths in finest cells. */
enum { OCT_MOMENTS = 10 }; /* 1, d, d d^T: xx yy zz yz zx xy */

typedef struct {
    OctWeighting weighting;
    double mass_unit;           /* kg: the mean mass, when it was built */
    long nodes, leaves;         /* there is place for as many */
    double *below;              /* [nodes] mass of the leaves below, in mass_unit */
    double *reach;              /* [leaves] M_i: mass of the regions that contain i (eq. 8) */
    double (*sum)[OCT_MOMENTS]; /* [nodes] moments of what the leaves below count in region sums, by
                                 * the weighting, about the node's centre */
} OctWeights;

/* Of one region. */
typedef struct {
    double mass;      /* sum of the weights */
    double offset[3]; /* c0_r - x0_r */
    double spread[6]; /* sum of weight (x0 - c0_r)(x0 - c0_r)^T: xx yy zz yz zx xy */
    bool collinear;   /* the region's nodes lie on a line, or it has but one */
    double axis[3];   /* of a collinear region the line's direction, or 0; else 0 */
} OctRegionRest;

/* `mass` is [leaves] kg, positive. O(members of the regions). The caller frees. */
void oct_weights_build(const OctTree *tree, const OctRegions *regions, const double *mass,
                       OctWeighting weighting, OctWeights *weights);
void oct_weights_free(OctWeights *weights);

/* Mass of a leaf, in mass_unit, and what it counts in region sums. */
static inline double oct_weights_mass(const OctWeights *w, const OctTree *tree, long leaf)
{
    return w->below[tree->node[leaf]];
}

static inline double oct_weights_weight(const OctWeights *w, const OctTree *tree, long leaf)
{
    return w->sum[tree->node[leaf]][0];
}

/* Finds the sum of a leaf from its mass and M_i, or that of an inner node from its children's. */
void oct_weights_weigh(OctWeights *weights, const OctTree *tree, long leaf);
void oct_weights_sum(OctWeights *weights, const OctTree *tree, long node);

/* O(members of the region). */
void oct_weights_region(const OctWeights *weights, const OctTree *tree, const OctRegions *regions,
                        long leaf, OctRegionRest *rest);

#endif
