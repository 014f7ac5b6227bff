/* brute.h - the slow, readable twin of every fast kernel, in double precision.
 *
 * Regions by breadth-first search over one-ring links, sums by plain loops, the step exactly as
 * fastlsm eqs. 1-2, 9-14 print it. O(w^3) per particle. Only tests and the check of a measured
 * scene link it. */
#ifndef REF_BRUTE_H
#define REF_BRUTE_H

#include "../lib/engine.h"

/* Regions in CSR form: members of region r are member[start[r]] .. member[start[r + 1]], rising. */
typedef struct {
    long count;
    long *start;  /* [count + 1] */
    int *member;
} RefRegions;

/* Members of every region: particles reachable within w one-ring steps (fastlsm section 2). Two
 * particles are neighbours when they share a material cell. `broken` lists `broken_count` links
 * (pairs of particles) that no longer join neighbours. */
void ref_regions_build(const SmVoxels *voxels, int w, const int (*broken)[2], long broken_count,
                       RefRegions *regions);
void ref_regions_free(RefRegions *regions);

/* How many different member sets there are ("unique regions"). */
long ref_regions_unique(const RefRegions *regions);

/* g_i of fastlsm eqs. 9-12 for positions x; rest positions x0, masses m, all [count]. The polar
 * decomposition is ref_polar(). */
void ref_goals(const RefRegions *regions, const double (*x0)[3], const double *m,
               const double (*x)[3], double (*g)[3]);

/* u_i, the rigid velocity averaged over R_i (fastlsm eq. 14), for positions x, velocities v. */
void ref_rigid_velocity(const RefRegions *regions, const double *m, const double (*x)[3],
                        const double (*v)[3], double (*u)[3]);

/* The whole as an engine named "brute" behind the common interface. */
extern const SmEngineType ref_brute_engine;

#endif
