/* octree_goals.h - the slow, readable twin of octree/: octree eqs. 6-10 and fastlsm eq. 14 by plain
 * sums over the leaves of every region, in double precision.
 *
 * O(members). Lengths are whatever x0 and x are in; all arrays are [regions.count]. */
#ifndef REF_OCTREE_GOALS_H
#define REF_OCTREE_GOALS_H

#include "../octree/region/region.h"
#include "brute.h"

typedef struct {
    RefRegions regions;        /* the leaves of every region */
    double (*x0)[3];           /* rest positions */
    double *m;                 /* masses */
    double *weight;            /* what m_i counts in region sums: m_i / M_i, or m_i if plain */
    double *reach;             /* M_i: sum of m_r over the regions r that contain i */
    double (*R)[9];            /* last rotations, for ties; the identity at first */
    double (*S)[9];            /* plastic states; the identity at first */
    double yield, creep, most; /* creep: share of the strain that stays in each step; 0: elastic */
} RefTreeBody;

/* Positions in finest cells from the corner of voxel (0,0,0); elastic. Leaf i is the i-th that
 * lives (structure.h), `m` is by leaf number. The caller frees. */
void ref_tree_init(const OctTree *tree, const OctRegions *regions, const double *m, bool plain,
                   RefTreeBody *body);
void ref_tree_free(RefTreeBody *body);

/* g_i = (1/M_i) sum of m_r (R_r S_r (x0_i - c0_r) + c_r) over the regions r that contain i (eq. 8);
 * R_r is the rotation of A_r = sum weight (x - c_r) (S_r (x0 - c0_r))^T (eqs. 6, 7, 9). Keeps R.
 * With `flow` every region then keeps what yields: with E = R^T A_r Aqq_r (eq. 10), where
 * |E - I| > yield, S <- (I + creep (E - I)) S, at most `most` from I, of volume 1. */
void ref_tree_goals(RefTreeBody *body, const double (*x)[3], bool flow, double (*g)[3]);

/* u_i = (1/M_i) sum of m_r (v_r + omega_r x (x_i - c_r)) over the regions that contain i; omega_r
 * and `sums` as in brute.h. */
void ref_tree_rigid_velocity(const RefTreeBody *body, const double (*x)[3], const double (*v)[3],
                             const RefSums *sums, double (*u)[3]);

#endif
