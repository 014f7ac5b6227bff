/* brute.h - the slow, readable twin of every fast kernel, in double precision.
 *
 * Regions by breadth-first search over one-ring links, sums by plain loops, the step exactly as
 * fastlsm eqs. 1-2, 9-14 print it. O(w^3) per particle. Only tests and the check of a measured
 * scene link it. Every result is gathered in a fixed order: any thread count gives the same bits.
 * Arrays over particles or regions are [count] of the RefRegions given; lengths are mesh units. */
#ifndef REF_BRUTE_H
#define REF_BRUTE_H

#include "../lib/engine/engine.h"
#include "link.h"

/* Regions in CSR form: members of region r are member[start[r]] ..
 * member[start[r + 1] - 1], rising. Those of many are not kept: `member` is NULL. */
typedef struct {
    long count;
    long *start; /* [count + 1] */
    int *member;
    RefLinks links; /* where they are not kept, and how far regions reach; */
    int w;
    struct RefWalk *walk; /* [SM_MOST_THREADS] the region that each thread found last */
} RefRegions;

typedef struct {
    const int *member;
    long count;
} RefMembers;

/* The members of region r, until the calling thread, one of a team's, asks for those of another.
 * Where they are not kept they are found anew, not rising: O(members). */
RefMembers ref_members(const RefRegions *regions, long r);

/* Members of every region: particles reachable within w one-ring steps (fastlsm section 2). Two
 * particles are neighbours when they share a material cell. `broken` lists `broken_count` links
 * (pairs of particles) that no longer join neighbours. They are kept if there cannot be more than
 * REF_KEPT. The caller frees `regions`. */
#define REF_KEPT 1e8
void ref_regions_build(const SmVoxels *voxels, int w, const int (*broken)[2], long broken_count,
                       RefRegions *regions);
void ref_regions_free(RefRegions *regions);

/* The same over a one-ring graph that the caller has already; members are kept. */
void ref_regions_reach(const RefLinks *links, int w, RefRegions *regions);

/* The same, not kept: the regions take the graph over. */
void ref_regions_walk(const RefLinks *links, int w, RefRegions *regions);

/* (1/M) sum of weight_i y_i over region r, formed relative to y_r, into `mean`; returns M, the sum
 * of the weights. O(members). */
double ref_region_mean(const RefRegions *regions, const double *weight, const double (*y)[3],
                       long r, double mean[3]);

/* A = sum of weight_i (y_i - mean) (x0_i - c0)^T over region r, row-major. O(members). */
void ref_region_moments(const RefRegions *regions, const double *weight, const double (*y)[3],
                        const double mean[3], const double (*x0)[3], const double c0[3], long r,
                        double A[9]);

/* How many different member sets there are ("unique regions"); where they are not kept, by 128 bits
 * of each. */
long ref_regions_unique(const RefRegions *regions);

/* One region's shape matching. */
typedef struct {
    double M;     /* sum of m~ */
    double c[3];  /* centre of mass, eq. 9 */
    double c0[3]; /* at rest */
    double A[9];  /* eq. 10, row-major */
    double R[9];  /* its rotation */
} RefMatch;

/* M, c, c0 and A of every region (eqs. 9-10); R is left as it is. */
void ref_match_sums(const RefRegions *regions, const double (*x0)[3], const double *m,
                    const double (*x)[3], RefMatch *match);

/* R of every region from A by ref_polar(); on entry R holds the last rotation, for ties. */
void ref_match_rotations(const RefRegions *regions, RefMatch *match);

/* g_i, the regions' rigid motions of x0_i averaged over R_i (eq. 12). */
void ref_match_goals(const RefRegions *regions, const RefMatch *match, const double (*x0)[3],
                     const double (*x)[3], double (*g)[3]);

/* g_i of fastlsm eqs. 9-12 for positions x; rest positions x0, masses m, all [count]. The polar
 * decomposition is ref_polar(), ties resolved towards the identity. */
void ref_goals(const RefRegions *regions, const double (*x0)[3], const double *m,
               const double (*x)[3], double (*g)[3]);

/* The same of so many particles alone, g[particle[i]]; their regions and these regions' members
 * are found anew: O(members) of the particles within 2 w. */
void ref_goals_of(const RefLinks *links, int w, const double (*x0)[3], const double *m,
                  const double (*x)[3], const long *particle, long count, double (*g)[3]);

/* How an engine sums up for eq. 14: in numbers of a precision, about origins. Where that does not
 * know a region's inertia, the engine damps by the rule of lib/simd/rigid_lanes.h, which says why:
 * with noise = 8 epsilon |c_r - origin_r|^2 and I over M_r, a region is solid if
 * 1 / tr(I^-1) > thinnest tr(S) + noise, and then J = (1 + n) I with n = noise tr(I^-1), else
 * J = tr(S) + noise; n and noise are left out where they are below a 64th of what they add to. */
typedef struct {
    const double (*origin)[3]; /* of the regions, lengths as x */
    double epsilon, thinnest;
} RefSums;

/* u_i, the rigid velocity averaged over R_i (fastlsm eq. 14), for positions x, velocities v.
 * omega_r = J_r^-1 L_r by that rule, or with `sums` NULL pseudo-inverse(I_r) L_r: eigenvalues of
 * I_r below 1e-10 of the largest count as 0. */
void ref_rigid_velocity(const RefRegions *regions, const double *m, const double (*x)[3],
                        const double (*v)[3], const RefSums *sums, double (*u)[3]);

/* v_r and omega_r of eq. 14 about c_r, of region r whose particles count `weight`. O(members). */
typedef struct {
    double c[3], v[3], omega[3];
} RefRigidMotion;
void ref_rigid_motion(const RefRegions *regions, const double *weight, const double (*x)[3],
                      const double (*v)[3], const RefSums *sums, long r, RefRigidMotion *motion);

/* Velocity of a rigid motion at x. */
void ref_motion_at(const RefRigidMotion *motion, const double x[3], double v[3]);

/* The whole as an engine named "brute" behind the common interface. The first step is damped, then
 * every damping_every-th. A posed instance is matched to its posed rest shape. */
extern const SmEngineType ref_brute_engine;

#endif
