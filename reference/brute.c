#include "brute.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/csr.h"
#include "../lib/system/team.h"
#include "../lib/vector.h"
#include "svd_polar.h"

/* Breadth-first search from r over w rings. Writes what it reaches in the order found and returns
 * how many; seen[p] == mark tells particles found already. */
static long reach(const RefLinks *links, int w, long r, long mark, long *seen, int *found)
{
    long begin = 0, end = 1;
    found[0] = (int)r;
    seen[r] = mark;
    for (int ring = 0; ring < w && begin < end; ring++) {
        long next = end;
        for (long f = begin; f < end; f++) {
            int p = found[f];
            for (long l = links->start[p]; l < links->start[p + 1]; l++) {
                int q = links->neighbour[l];
                if (seen[q] == mark) continue;
                seen[q] = mark;
                found[next++] = q;
            }
        }
        begin = end;
        end = next;
    }
    return end;
}

void ref_regions_reach(const RefLinks *links, int w, RefRegions *regions)
{
    SmCsr rows;
    SmCsrParts members;
    sm_csr_parts_init(&members, links->count);
#pragma omp parallel num_threads(sm_team(0)) if (links->count > REF_SERIAL)
    {
        long *seen = sm_alloc((size_t)links->count, sizeof *seen);
        int *found = sm_alloc((size_t)links->count, sizeof *found);
#pragma omp for schedule(dynamic)
        for (long block = 0; block < members.blocks; block++)
            for (long r = sm_csr_parts_from(block); r < sm_csr_parts_to(&members, block); r++) {
                long count = reach(links, w, r, r + 1, seen, found);
                sm_sort_ints(found, count);
                sm_csr_parts_add(&members, r, found, count);
            }
        free(found);
        free(seen);
    }
    sm_csr_parts_join(&members, &rows, 0);
    *regions = (RefRegions){.count = links->count, .start = rows.first, .member = rows.item};
}

struct RefWalk {
    long region, count; /* + 1, and its members */
    long mark, *seen;   /* as reach() has them */
    int *found;
};

RefMembers ref_members(const RefRegions *regions, long r)
{
    if (regions->member)
        return (RefMembers){regions->member + regions->start[r],
                            regions->start[r + 1] - regions->start[r]};
    struct RefWalk *walk = regions->walk + omp_get_thread_num();
    if (!walk->seen) {
        walk->seen = sm_alloc((size_t)regions->count, sizeof *walk->seen);
        walk->found = sm_alloc((size_t)regions->count, sizeof *walk->found);
    }
    if (walk->region != r + 1) {
        walk->count = reach(&regions->links, regions->w, r, ++walk->mark, walk->seen, walk->found);
        walk->region = r + 1;
    }
    return (RefMembers){walk->found, walk->count};
}

void ref_regions_walk(const RefLinks *links, int w, RefRegions *regions)
{
    long count = links->count;
    *regions = (RefRegions){.count = count, .links = *links, .w = w};
    regions->walk = sm_alloc(SM_MOST_THREADS, sizeof *regions->walk);
    regions->start = sm_alloc((size_t)count + 1, sizeof *regions->start);
#pragma omp parallel for schedule(dynamic, 64) num_threads(sm_team(0))
    for (long r = 0; r < count; r++) regions->start[r + 1] = ref_members(regions, r).count;
    for (long r = 0; r < count; r++) regions->start[r + 1] += regions->start[r];
}

void ref_regions_build(const SmVoxels *voxels, int w, const int (*broken)[2], long broken_count,
                       RefRegions *regions)
{
    RefLinks links;
    double side = 2.0 * w + 1;
    ref_links_build(voxels, broken, broken_count, &links);
    if ((double)links.count * fmin(side * side * side, (double)links.count) > REF_KEPT) {
        ref_regions_walk(&links, w, regions);
        return;
    }
    ref_regions_reach(&links, w, regions);
    ref_links_free(&links);
}

static void free_walk(RefRegions *regions)
{
    for (int t = 0; t < SM_MOST_THREADS && regions->walk; t++)
        sm_free_all(regions->walk[t].seen, regions->walk[t].found);
    free(regions->walk);
}

void ref_regions_free(RefRegions *regions)
{
    if (regions->walk) ref_links_free(&regions->links);
    free_walk(regions);
    sm_free_all(regions->start, regions->member);
    memset(regions, 0, sizeof *regions);
}

typedef struct {
    uint64_t hash[2];
    long size;
    const int *member; /* or NULL */
} Set;

/* Orders sets by hash; equal hashes by what they hold, so that a collision changes nothing. */
static int compare_sets(const void *a, const void *b)
{
    const Set *p = a, *q = b;
    for (int i = 0; i < 2; i++)
        if (p->hash[i] != q->hash[i]) return p->hash[i] < q->hash[i] ? -1 : 1;
    if (p->size != q->size) return p->size < q->size ? -1 : 1;
    return p->member ? memcmp(p->member, q->member, (size_t)p->size * sizeof *p->member) : 0;
}

/* In whatever order the members come. */
static Set set_of(const RefRegions *regions, long r)
{
    RefMembers of = ref_members(regions, r);
    Set set = {.size = of.count, .member = regions->walk ? NULL : of.member};
    for (long n = 0; n < of.count; n++)
        for (int i = 0; i < 2; i++) { /* the finaliser of MurmurHash3 */
            uint64_t h = (uint64_t)of.member[n] + (i ? 0x9e3779b97f4a7c15u : 1);
            h = (h ^ h >> 33) * 0xff51afd7ed558ccdu;
            h = (h ^ h >> 33) * 0xc4ceb9fe1a85ec53u;
            set.hash[i] += h ^ h >> 33;
        }
    return set;
}

long ref_regions_unique(const RefRegions *regions)
{
    Set *set = sm_alloc((size_t)regions->count, sizeof *set);
#pragma omp parallel for schedule(dynamic, 64) num_threads(sm_team(0)) if (regions->walk)
    for (long r = 0; r < regions->count; r++) set[r] = set_of(regions, r);
    qsort(set, (size_t)regions->count, sizeof *set, compare_sets);
    long unique = regions->count > 0;
    for (long r = 1; r < regions->count; r++) unique += compare_sets(set + r - 1, set + r) != 0;
    free(set);
    return unique;
}

/* m~_i = m_i / |R_i| of every particle; the caller frees. */
static double *modified_masses(const RefRegions *regions, const double *m)
{
    double *modified = sm_alloc((size_t)regions->count, sizeof *modified);
    for (long i = 0; i < regions->count; i++)
        modified[i] = m[i] / (double)(regions->start[i + 1] - regions->start[i]);
    return modified;
}

double ref_region_mean(const RefRegions *regions, const double *weight, const double (*y)[3],
                       long r, double mean[3])
{
    double M = 0, sum[3] = {0};
    RefMembers of = ref_members(regions, r);
    for (long n = 0; n < of.count; n++) {
        int i = of.member[n];
        M += weight[i];
        for (int a = 0; a < 3; a++) sum[a] += weight[i] * (y[i][a] - y[r][a]);
    }
    for (int a = 0; a < 3; a++) mean[a] = y[r][a] + sum[a] / M;
    return M;
}

void ref_region_moments(const RefRegions *regions, const double *weight, const double (*y)[3],
                        const double mean[3], const double (*x0)[3], const double c0[3], long r,
                        double A[9])
{
    RefMembers of = ref_members(regions, r);
    memset(A, 0, 9 * sizeof *A);
    for (long n = 0; n < of.count; n++) {
        int i = of.member[n];
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                A[3 * a + b] += weight[i] * (y[i][a] - mean[a]) * (x0[i][b] - c0[b]);
    }
}

static void match_sums(const RefRegions *regions, const double *modified, const double (*x0)[3],
                       const double (*x)[3], long r, RefMatch *t)
{
    ref_region_mean(regions, modified, x0, r, t->c0);
    t->M = ref_region_mean(regions, modified, x, r, t->c);              /* eq. 9 */
    ref_region_moments(regions, modified, x, t->c, x0, t->c0, r, t->A); /* eq. 10 */
}

void ref_match_sums(const RefRegions *regions, const double (*x0)[3], const double *m,
                    const double (*x)[3], RefMatch *match)
{
    double *modified = modified_masses(regions, m);
#pragma omp parallel for num_threads(sm_team(0))                                                   \
    schedule(dynamic, 64) if (regions->count > REF_SERIAL)
    for (long r = 0; r < regions->count; r++) match_sums(regions, modified, x0, x, r, match + r);
    free(modified);
}

static void match_rotation(RefMatch *match)
{
    double R[9];
    ref_polar(match->A, match->R, R);
    memcpy(match->R, R, sizeof R);
}

void ref_match_rotations(const RefRegions *regions, RefMatch *match)
{
#pragma omp parallel for num_threads(sm_team(0))                                                   \
    schedule(dynamic, 64) if (regions->count > REF_SERIAL)
    for (long r = 0; r < regions->count; r++) match_rotation(match + r);
}

static void match_goal(const RefRegions *regions, const RefMatch *match, const double (*x0)[3],
                       const double (*x)[3], long i, double g[3])
{
    double sum[3] = {0}; /* of T_r x0_i - x_i; the regions that hold i are R_i's members */
    RefMembers in = ref_members(regions, i);
    for (long n = 0; n < in.count; n++) {
        const RefMatch *t = match + in.member[n];
        for (int a = 0; a < 3; a++) {
            sum[a] += t->c[a] - x[i][a];
            for (int b = 0; b < 3; b++) sum[a] += t->R[3 * a + b] * (x0[i][b] - t->c0[b]);
        }
    }
    double size = (double)in.count;
    for (int a = 0; a < 3; a++) g[a] = x[i][a] + sum[a] / size; /* eq. 12 */
}

void ref_match_goals(const RefRegions *regions, const RefMatch *match, const double (*x0)[3],
                     const double (*x)[3], double (*g)[3])
{
#pragma omp parallel for num_threads(sm_team(0))                                                   \
    schedule(dynamic, 64) if (regions->count > REF_SERIAL)
    for (long i = 0; i < regions->count; i++) match_goal(regions, match, x0, x, i, g[i]);
}

void ref_goals(const RefRegions *regions, const double (*x0)[3], const double *m,
               const double (*x)[3], double (*g)[3])
{
    RefMatch *match = sm_alloc((size_t)regions->count, sizeof *match);
    for (long r = 0; r < regions->count; r++)
        for (int a = 0; a < 3; a++) match[r].R[4 * a] = 1;
    ref_match_sums(regions, x0, m, x, match);
    ref_match_rotations(regions, match);
    ref_match_goals(regions, match, x0, x, g);
    free(match);
}

/* Marks the members of all marked regions. */
static void mark_members(const RefRegions *regions, const char *of, char *marked)
{
#pragma omp parallel for schedule(dynamic, 64) num_threads(sm_team(0))
    for (long r = 0; r < regions->count; r++) {
        RefMembers held = of[r] ? ref_members(regions, r) : (RefMembers){0};
        for (long n = 0; n < held.count; n++) {
#pragma omp atomic write
            marked[held.member[n]] = 1;
        }
    }
}

void ref_goals_of(const RefLinks *links, int w, const double (*x0)[3], const double *m,
                  const double (*x)[3], const long *particle, long count, double (*g)[3])
{
    size_t all = (size_t)links->count;
    RefRegions regions = {.count = links->count, .links = *links, .w = w};
    regions.walk = sm_alloc(SM_MOST_THREADS, sizeof *regions.walk);
    RefMatch *match = sm_alloc(all, sizeof *match); /* memory of those that are made alone */
    double *modified = sm_alloc(all, sizeof *modified);
    char *asked = sm_alloc(all, 1), *near = sm_alloc(all, 1), *around = sm_alloc(all, 1);
    for (long i = 0; i < count; i++) asked[particle[i]] = 1;
    mark_members(&regions, asked, near);
    mark_members(&regions, near, around);
#pragma omp parallel num_threads(sm_team(0))
    {
#pragma omp for schedule(dynamic, 64)
        for (long i = 0; i < regions.count; i++)
            if (around[i]) modified[i] = m[i] / (double)ref_members(&regions, i).count;
#pragma omp for schedule(dynamic, 64)
        for (long r = 0; r < regions.count; r++) {
            if (!near[r]) continue;
            match[r].R[0] = match[r].R[4] = match[r].R[8] = 1;
            match_sums(&regions, modified, x0, x, r, &match[r]);
            match_rotation(&match[r]);
        }
    }
    for (long i = 0; i < count; i++)
        match_goal(&regions, match, x0, x, particle[i], g[particle[i]]);
    free_walk(&regions);
    sm_free_all(match, modified, asked, near, around);
}

/* J^-1 L. What is all in one point does not turn. */
static void solve_known(const double I[9], const double L[3], double noise, double thinnest,
                        double omega[3])
{
    double C[3][3], trace = (I[0] + I[4] + I[8]) / 2; /* tr(S); C: I's adjugate */
    for (int a = 0; a < 3; a++) sm_cross(I + (a + 1) % 3 * 3, I + (a + 2) % 3 * 3, C[a]);
    double over = sm_dot(I, C[0]), trace_C = C[0][0] + C[1][1] + C[2][2], more = noise * trace_C;
    bool solid = over > thinnest * trace * trace_C + more;
    if (!solid) {
        over = trace;
        more = noise;
    }
    if (64 * more > over) over += more;
    for (int a = 0; a < 3; a++) omega[a] = over > 0 ? (solid ? sm_dot(C[a], L) : L[a]) / over : 0;
}

/* omega of region r by the rule of RefSums, from its I (destroyed) and L about c, which are `units`
 * times what they are over M_r. */
static void solve_inertia(double I[9], const double L[3], const RefSums *sums, long r,
                          const double c[3], double units, double omega[3])
{
    if (sums) {
        double square = 0;
        for (int a = 0; a < 3; a++) square += pow(c[a] - sums->origin[r][a], 2);
        solve_known(I, L, 8 * sums->epsilon * square * units, sums->thinnest, omega);
        return;
    }
    double value[3], vector[9];
    ref_eigen(I, value, vector);

    double largest = fmax(value[0], fmax(value[1], value[2]));
    memset(omega, 0, 3 * sizeof *omega);
    for (int e = 0; e < 3; e++) {
        if (!(value[e] > 1e-10 * largest)) continue;
        double along = (vector[e] * L[0] + vector[3 + e] * L[1] + vector[6 + e] * L[2]) / value[e];
        for (int a = 0; a < 3; a++) omega[a] += along * vector[3 * a + e];
    }
}

/* Largest distance along an axis from c in R_r: the unit that keeps I_r in range. */
static double extent(const RefRegions *regions, const double (*x)[3], long r, const double c[3])
{
    double largest = 0;
    RefMembers of = ref_members(regions, r);
    for (long n = 0; n < of.count; n++)
        for (int a = 0; a < 3; a++) largest = fmax(largest, fabs(x[of.member[n]][a] - c[a]));
    return largest;
}

/* X X^T with X = [d]x is |d|^2 1 - d d^T: positive semidefinite, so the signs of eq. 14 stand as
 * printed. */
void ref_rigid_motion(const RefRegions *regions, const double *weight, const double (*x)[3],
                      const double (*v)[3], const RefSums *sums, long r, RefRigidMotion *motion)
{
    double L[3] = {0}, I[9] = {0};
    ref_region_mean(regions, weight, x, r, motion->c);
    double M = ref_region_mean(regions, weight, v, r, motion->v);
    double unit = extent(regions, x, r, motion->c);
    memset(motion->omega, 0, sizeof motion->omega);
    if (!(unit > 0 && isfinite(unit))) return; /* all in one point: nothing turns */
    RefMembers of = ref_members(regions, r);
    for (long n = 0; n < of.count; n++) {
        int i = of.member[n];
        double share = weight[i] / M, d[3], dv[3], turn[3];
        for (int a = 0; a < 3; a++) {
            d[a] = (x[i][a] - motion->c[a]) / unit;
            dv[a] = v[i][a] - motion->v[a];
        }
        sm_cross(d, dv, turn);
        double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        for (int a = 0; a < 3; a++) {
            L[a] += share * turn[a];
            for (int b = 0; b < 3; b++)
                I[3 * a + b] += share * ((a == b ? square : 0) - d[a] * d[b]);
        }
    }
    solve_inertia(I, L, sums, r, motion->c, 1 / (unit * unit), motion->omega);
    for (int a = 0; a < 3; a++) motion->omega[a] /= unit;
}

void ref_motion_at(const RefRigidMotion *motion, const double x[3], double v[3])
{
    double d[3] = {x[0] - motion->c[0], x[1] - motion->c[1], x[2] - motion->c[2]}, turn[3];
    sm_cross(motion->omega, d, turn);
    for (int a = 0; a < 3; a++) v[a] = motion->v[a] + turn[a];
}

void ref_rigid_velocity(const RefRegions *regions, const double *m, const double (*x)[3],
                        const double (*v)[3], const RefSums *sums, double (*u)[3])
{
    double *modified = modified_masses(regions, m);
    RefRigidMotion *motion = sm_alloc((size_t)regions->count, sizeof *motion);
#pragma omp parallel for num_threads(sm_team(0))                                                   \
    schedule(dynamic, 64) if (regions->count > REF_SERIAL)
    for (long r = 0; r < regions->count; r++)
        ref_rigid_motion(regions, modified, x, v, sums, r, motion + r);
#pragma omp parallel for num_threads(sm_team(0))                                                   \
    schedule(dynamic, 64) if (regions->count > REF_SERIAL)
    for (long i = 0; i < regions->count; i++) {
        double sum[3] = {0};
        RefMembers in = ref_members(regions, i);
        for (long n = 0; n < in.count; n++) {
            double here[3];
            ref_motion_at(motion + in.member[n], x[i], here);
            for (int a = 0; a < 3; a++) sum[a] += here[a];
        }
        double size = (double)in.count;
        for (int a = 0; a < 3; a++) u[i][a] = sum[a] / size;
    }
    free(motion);
    free(modified);
}
