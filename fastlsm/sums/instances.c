#include "instances.h"

#include <stdlib.h>

#include "../../lib/simd/rigid_lanes.h"
#include "../../lib/system/team.h"
#include "../match.h"
#include "window.h"

/* Vectors in a row of each kind. Rows keep their width whatever a pass stores in them, so that row
 * 0 stays zero. */
enum { L = SM_LANES, P = 6, BAR = 12, PLATE = 12, TRANSFORM = 12, BAR_DOWN = 9, PLATE_DOWN = 6 };

/* Rows of one group, [row][values][lanes]; row 0 of each is zero, but for `centre`, whose row p is
 * region p's. Lists name rows of `p` and `transform` by slot, as those of one body (state.h): a
 * body of several layers has slots that no particle has. */
typedef struct {
    real *p, *bar, *plate, *transform, *bar_down, *plate_down, *centre;
} GroupRows;

SM_INLINE long row_of(const Instances *instances, long p)
{
    return instances->lsm->slot[p] + 1;
}

static size_t rows_size(const Instances *instances, GroupRows *rows, real *memory)
{
    const LsmLists *lists = &instances->lsm->lists;
    size_t n = (size_t)instances->lsm->lattice.count,
           slots = (size_t)instances->lsm->blocks * L + 1, bars = (size_t)lists->bar_count,
           plates = (size_t)lists->plate_count, at = 0;
    const size_t counts[7] = {
        slots * P,       bars * BAR,          plates * PLATE, slots * TRANSFORM,
        bars * BAR_DOWN, plates * PLATE_DOWN, n * 3};
    real **part[7] = {&rows->p,        &rows->bar,        &rows->plate, &rows->transform,
                      &rows->bar_down, &rows->plate_down, &rows->centre};
    for (int i = 0; i < 7; i++) {
        if (memory) *part[i] = memory + at;
        at += counts[i] * L;
    }
    return at;
}

Instances *instances_build(const Lsm *lsm, long bodies)
{
    Instances *instances = sm_alloc(1, sizeof *instances);
    size_t n = (size_t)lsm->lattice.count;
    instances->lsm = lsm;
    instances->bodies = bodies;
    instances->groups = (bodies + L - 1) / L;
    size_t lanes = (size_t)instances->groups * n * L;
    instances->x = sm_alloc(lanes * 3, sizeof(real));
    instances->v = sm_alloc(lanes * 3, sizeof(real));
    instances->g = sm_alloc(lanes * 3, sizeof(real));
    instances->last = sm_alloc(lanes * 6, sizeof(short));
    instances->origin = sm_alloc((size_t)instances->groups * L, sizeof *instances->origin);
    instances->weight = sm_alloc(n, sizeof(real));
    instances->inverse_count = sm_alloc(n, sizeof(real));
    instances->region = sm_alloc(n, sizeof *instances->region);
    instances->original = sm_alloc(n, sizeof(int));
    for (size_t p = 0; p < n; p++) {
        const ParticleConst *k = &lsm->particle_const[lsm->block_const[lsm->slot[p] / L]];
        instances->weight[p] = k->weight[lsm->slot[p] % L];
        instances->inverse_count[p] = k->inverse_count[lsm->slot[p] % L];
        instances->original[p] = (int)p;
    }
    for (long i = 0; i < lsm->copies; i++)
        instances->original[lsm->particle[lsm->copy[i][0]]] = lsm->particle[lsm->copy[i][1]];
    for (long s = 0; s < lsm->tiles * L; s++) {
        if (lsm->tile_slot[s] < 0) continue;
        const RegionConst *k = &lsm->region_const[lsm->tile_const[s / L]];
        real *region = instances->region[lsm->particle[lsm->tile_slot[s]]];
        region[0] = k->inverse_mass[s % L];
        for (int d = 0; d < 3; d++) region[1 + d] = k->offset[d][s % L];
    }
    int threads = sm_team(lsm->params.threads);
    instances->threads = threads > instances->groups ? (int)instances->groups : threads;
    instances->scratch = sm_alloc((size_t)instances->threads, sizeof *instances->scratch);
    GroupRows rows;
    for (int t = 0; t < instances->threads; t++)
        instances->scratch[t] = sm_alloc(rows_size(instances, &rows, NULL), sizeof(real));
    return instances;
}

long instances_bytes(const Instances *instances)
{
    GroupRows rows;
    size_t n = (size_t)instances->lsm->lattice.count, lanes = (size_t)instances->groups * L;
    size_t state = lanes * n * (9 * sizeof(real) + 6 * sizeof(short));
    size_t scratch = (size_t)instances->threads * rows_size(instances, &rows, NULL) * sizeof(real);
    return (long)(state + scratch + n * (6 * sizeof(real) + sizeof(int)) +
                  lanes * sizeof(double[3]));
}

void instances_free(Instances *instances)
{
    if (!instances) return;
    for (int t = 0; t < instances->threads; t++) free(instances->scratch[t]);
    void *all[] = {instances->x,
                   instances->v,
                   instances->g,
                   instances->last,
                   instances->origin,
                   instances->weight,
                   instances->inverse_count,
                   instances->region,
                   instances->original,
                   instances->scratch,
                   instances};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
}

/* F window sums over the rows at[0 ..]; moments of three of them, from `first` on unless that is
 * -1, follow in sum[F ..]. */
SM_INLINE void row_sums(const real *const *at, int side, int F, int first, vec *sum)
{
    for (int f = 0; f < F; f++) {
        bool weighted = first >= 0 && f >= first && f < first + 3;
        window_sum(at, f * L, side / 2, &sum[f], weighted ? &sum[F + f - first] : NULL);
    }
}

_Static_assert(L % LSM_NAME == 0, "a name is a whole part of a vector's address");

/* Where the members of a list (subsum_lists.h) are, `pitch` vectors each. */
SM_INLINE void members_at(const int *name, int side, const real *in, int pitch, const real **at)
{
    for (int i = 0; i < side; i++) at[i] = in + (long)name[i] * pitch * (L / LSM_NAME);
}

/* One list level: out[row] = window sum over the members of row `row` of the list, F values in and
 * out_F out. `first` is where the moments are taken (window.h), or -1; `down` takes them off
 * instead of keeping them. */
SM_INLINE void level(const int *list, long from, long to, int side, const real *in, int pitch,
                     int F, real *out, int out_pitch, int out_F, int first, bool down)
{
    for (long row = from; row < to; row++) {
        const real *at[LSM_MAX_SIDE];
        vec sum[15];
        members_at(list + row * side, side, in, pitch, at);
        row_sums(at, side, F, first, sum);
        for (int d = 0; d < 3 && down; d++) sum[d] -= sum[F + d];
        for (int f = 0; f < out_F; f++) lanes_store(out + (row * out_pitch + f) * L, sum[f]);
    }
}

SM_INLINE void sums(const Instances *instances, const GroupRows *r, int side, bool damping,
                    bool down)
{
    const LsmLists *s = &instances->lsm->lists;
    if (!damping && !down) {
        level(s->bar, 1, s->bar_count, side, r->p, P, 3, r->bar, BAR, 6, 0, false);
        level(s->plate, 1, s->plate_count, side, r->bar, BAR, 6, r->plate, PLATE, 9, 0, false);
    } else if (!damping) {
        level(s->bar, 1, s->bar_count, side, r->transform, TRANSFORM, 12, r->bar_down, BAR_DOWN, 9,
              9, true);
        level(s->plate, 1, s->plate_count, side, r->bar_down, BAR_DOWN, 9, r->plate_down,
              PLATE_DOWN, 6, 6, true);
    } else if (!down) {
        level(s->bar, 1, s->bar_count, side, r->transform, TRANSFORM, 12, r->bar, BAR, 12, -1,
              false);
        level(s->plate, 1, s->plate_count, side, r->bar, BAR, 12, r->plate, PLATE, 12, -1, false);
    } else {
        level(s->bar, 1, s->bar_count, side, r->p, P, 6, r->bar_down, BAR_DOWN, 6, -1, false);
        level(s->plate, 1, s->plate_count, side, r->bar_down, BAR_DOWN, 6, r->plate_down,
              PLATE_DOWN, 6, -1, false);
    }
}

/* The last level up (12 sums of region p) or down (3 or 6 sums of particle p). */
SM_INLINE void last_level(const Instances *instances, int side, const real *in, int pitch, long p,
                          int F, int first, vec sum[15])
{
    const int *name = instances->lsm->lists.region + p * side;
    const real *at[LSM_MAX_SIDE];
    members_at(name, side, in, pitch, at);
    row_sums(at, side, F, first, sum);
}

SM_INLINE void match_region(Instances *instances, int side, long group, const GroupRows *r, long p,
                            SmLaps *laps)
{
    const Lsm *lsm = instances->lsm;
    vec sums[15], S[12], R[9], q[3];
    RegionConst k = {.inverse_mass = lanes_set(instances->region[p][0])};
    for (int d = 0; d < 3; d++) k.offset[d] = lanes_set(instances->region[p][1 + d]);
    last_level(instances, side, r->plate, PLATE, p, 9, 0, sums); /* (C, Cx, Cy, Cz) */
    for (int i = 0; i < 3; i++) {
        S[i] = sums[i];
        for (int d = 0; d < 3; d++) S[MOMENT + 3 * i + d] = sums[3 * d + 3 + i];
    }
    sm_lap(laps, SM_FAST_SUM);
    match_moments(&k, S);
    store3(r->centre + p * 3 * L, S);
    sm_lap(laps, SM_SHAPE_MATCHING);
    polar_fast_lanes(S + MOMENT, LANES_ALL, POLAR_LATTICE,
                     instances->last + (group * lsm->lattice.count + p) * 6 * L, R);
    sm_lap(laps, SM_POLAR);
    match_centre(S, R, &k, q);
    real *T = r->transform + row_of(instances, p) * TRANSFORM * L;
    for (int i = 0; i < 3; i++) {
        lanes_store(T + i * L, q[i]);
        for (int d = 0; d < 3; d++) lanes_store(T + (3 + 3 * (2 - d) + i) * L, R[i * 3 + d]);
    }
    sm_lap(laps, SM_SHAPE_MATCHING);
}

/* A region that equals another takes its rotation, and its centre from there. */
static void copy_region(const Instances *instances, const GroupRows *r, long p)
{
    const LsmLattice *l = &instances->lsm->lattice;
    long from = instances->original[p];
    const real *in = r->transform + row_of(instances, from) * TRANSFORM * L;
    real *out = r->transform + row_of(instances, p) * TRANSFORM * L;
    for (int f = 3; f < 12; f++) lanes_store(out + f * L, lanes_load(in + f * L));
    for (int i = 0; i < 3; i++) {
        vec q = lanes_load(in + i * L);
        for (int d = 0; d < 3; d++)
            q += (real)(l->coord[p][d] - l->coord[from][d]) *
                 lanes_load(in + (3 + 3 * (2 - d) + i) * L);
        lanes_store(out + i * L, q);
    }
}

SM_INLINE void match_group(Instances *instances, int side, long group, const GroupRows *r,
                           SmLaps *laps)
{
    long n = instances->lsm->lattice.count;
    const real *x = instances->x + group * n * 3 * L;
    for (long p = 0; p < n; p++)
        for (int d = 0; d < 3; d++)
            lanes_store(r->p + (row_of(instances, p) * P + d) * L,
                        instances->weight[p] * lanes_load(x + (p * 3 + d) * L));
    sums(instances, r, side, false, false);
    sm_lap(laps, SM_FAST_SUM);
    for (long p = 0; p < n; p++)
        if (instances->original[p] == p) match_region(instances, side, group, r, p, laps);
    for (long p = 0; p < n; p++)
        if (instances->original[p] != p) copy_region(instances, r, p);
    sm_lap(laps, SM_SHAPE_MATCHING);
    sums(instances, r, side, false, true);
    sm_lap(laps, SM_FAST_SUM);
}

/* Eqs. 1 and 2 for one group; with `goals` only g. */
SM_INLINE void move_group(Instances *instances, int side, long group, const GroupRows *r,
                          bool goals, bool damp, const vec shift[3])
{
    const Lsm *lsm = instances->lsm;
    long n = lsm->lattice.count;
    for (long p = 0; p < n; p++) {
        long at = (group * n + p) * 3 * L;
        vec sum[15], x[3], v[3];
        last_level(instances, side, r->plate_down, PLATE_DOWN, p, 6, 3, sum);
        for (int d = 0; d < 3; d++) sum[d] = (sum[d] - sum[6 + d]) * instances->inverse_count[p];
        if (goals) {
            store3(instances->g + at, sum);
            continue;
        }
        load3(instances->x + at, x);
        load3(instances->v + at, v);
        for (int d = 0; d < 3; d++) sum[d] -= x[d];
        integrate_velocity(sum, lsm->gravity, lsm->rounding, lanes_set(1), v);
        if (!damp) {
            integrate_position(lsm->obstacle, lsm->obstacle_count, shift, x, v);
            store3(instances->x + at, x);
        }
        store3(instances->v + at, v);
    }
}

/* Eq. 14, then x += v. */
SM_INLINE void damp_group(Instances *instances, int side, long group, const GroupRows *r,
                          const vec shift[3])
{
    const Lsm *lsm = instances->lsm;
    long n = lsm->lattice.count;
    vec x[3], v[3], F[15], c[3];
    for (long p = 0; p < n; p++) {
        long at = (group * n + p) * 3 * L;
        for (int d = 0; d < 3; d++) {
            damping_products(lanes_set(instances->weight[p]), instances->x + at, instances->v + at,
                             d, F);
            for (int k = 0; k < 4; k++)
                lanes_store(r->transform + (row_of(instances, p) * TRANSFORM + 3 * k + d) * L,
                            F[k]);
        }
    }
    sums(instances, r, side, true, false);
    for (long p = 0; p < n; p++) {
        long from = instances->original[p];
        vec out[6];
        last_level(instances, side, r->plate, PLATE, from, 12, -1, F);
        load3(r->centre + from * 3 * L, c);
        rigid_velocity(F, c, lanes_set(instances->region[from][0]), out);
        for (int f = 0; f < 6; f++) lanes_store(r->p + (row_of(instances, p) * P + f) * L, out[f]);
    }
    sums(instances, r, side, true, true);
    for (long p = 0; p < n; p++) {
        long at = (group * n + p) * 3 * L;
        load3(instances->x + at, x);
        load3(instances->v + at, v);
        last_level(instances, side, r->plate_down, PLATE_DOWN, p, 6, -1, F);
        pull(F, lanes_set(instances->inverse_count[p]), (real)lsm->params.damping, x, v);
        integrate_position(lsm->obstacle, lsm->obstacle_count, shift, x, v);
        store3(instances->x + at, x);
        store3(instances->v + at, v);
    }
}

SM_INLINE void run_group_of(Instances *instances, int side, long group, int thread, bool goals,
                            SmLaps *laps)
{
    const Lsm *lsm = instances->lsm;
    GroupRows rows;
    vec shift[3];
    rows_size(instances, &rows, instances->scratch[thread]);
    for (int lane = 0; lane < L; lane++)
        for (int d = 0; d < 3; d++)
            shift[d][lane] =
                (real)((instances->origin[group * L + lane][d] - lsm->home[d]) / lsm->cell);
    match_group(instances, side, group, &rows, laps);
    bool damp = lsm->damp_now && !goals;
    move_group(instances, side, group, &rows, goals, damp, shift);
    sm_lap(laps, SM_FAST_SUM);
    if (damp) damp_group(instances, side, group, &rows, shift);
    sm_lap(laps, damp ? SM_DAMPING : SM_OTHER);
}

static void run_group(Instances *instances, long group, int thread, bool goals, SmLaps *laps)
{
    switch (instances->lsm->side) { /* constants for the usual widths */
    case 3:
        run_group_of(instances, 3, group, thread, goals, laps);
        break;
    case 5:
        run_group_of(instances, 5, group, thread, goals, laps);
        break;
    default:
        run_group_of(instances, instances->lsm->side, group, thread, goals, laps);
        break;
    }
}

static void run_share(Instances *instances, int thread, bool goals, SmLaps *laps)
{
    for (long group = thread; group < instances->groups; group += instances->threads)
        run_group(instances, group, thread, goals, thread ? NULL : laps);
}

static void run(Instances *instances, bool goals, SmLaps *laps)
{
    if (instances->threads == 1) {
        run_share(instances, 0, goals, laps);
        return;
    }
#pragma omp parallel for schedule(static) num_threads(instances->threads)
    for (int t = 0; t < instances->threads; t++) run_share(instances, t, goals, laps);
}

void instances_step(Instances *instances, SmLaps *laps)
{
    run(instances, false, laps);
}

void instances_goals(Instances *instances)
{
    run(instances, true, NULL);
}

double instances_recentre(Instances *instances, Momentum *momentum)
{
    double far = 0;
    long n = instances->lsm->lattice.count;
    for (long group = 0; group < instances->groups; group++) {
        vec middle[3] = {{0}};
        for (long p = 0; p < n; p++)
            for (int d = 0; d < 3; d++)
                middle[d] += lanes_load(instances->x + ((group * n + p) * 3 + d) * L);
        for (int d = 0; d < 3; d++)
            for (int lane = 0; lane < L; lane++) {
                middle[d][lane] = (real)rint((double)middle[d][lane] / (double)n);
                instances->origin[group * L + lane][d] +=
                    (double)middle[d][lane] * instances->lsm->cell;
                far = fmax(far, fabs((double)middle[d][lane]));
            }
        for (int lane = 0; lane < L && group * L + lane < instances->bodies; lane++)
            momentum_shift(momentum, group * L + lane,
                           (const double[3]){(double)middle[0][lane], (double)middle[1][lane],
                                             (double)middle[2][lane]});
        for (long p = 0; p < n; p++)
            for (int d = 0; d < 3; d++) {
                real *x = instances->x + ((group * n + p) * 3 + d) * L;
                lanes_store(x, lanes_load(x) - middle[d]);
            }
    }
    return far;
}
