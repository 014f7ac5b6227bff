/* octree.c - one step of octree shape matching (octree section 4), top to bottom.
 *
 *     depth      every inner node sums the moments of its children (ghosts.h: of several frames)
 *     breadth    every region sums its summation nodes (octree eqs. 6, 7)
 *     match      c_r, A_r, polar decomposition, transform m_r T_r
 *     depth      every inner node sums the transforms of its children
 *     breadth    every simulation node sums over the regions that contain it (octree eq. 8)
 *     move       v, damping, x (fastlsm eqs. 1, 14, 2)
 *
 * A breadth goes by sum_lists.h: first the prefixes, from the roots down, then the leaves. With the
 * lists transposed the second is the adjoint of the first. */
#include "octree.h"

#include <stdlib.h>
#include <string.h>

#include "../lib/system/team.h"
#include "collinear_regions.h"
#include "damping.h"
#include "ghosts.h"
#include "plastic.h"

/* m~ x of the simulation nodes; a node has no moments about itself. */
static void weigh(OctTask *task, long first, long last)
{
    const Oct *oct = task->oct;
    for (long block = first; block < last; block++) {
        vec p[4];
        load3(task->body->x + block * 3 * SM_LANES, p);
        for (int d = 0; d < 3; d++) p[d] *= oct->block[block].weight;
        p[3] = lanes_set(0);
        lanes_interleave(p, 4);
        const int *row = oct->row + block * SM_LANES;
        for (int lane = 0; lane < SM_LANES; lane++)
            store4(task->rows->moment + (long)row[lane] * OCT_ROW,
                   load4((const real *)p + 4 * lane));
    }
    sm_lap(task->laps, SM_FAST_SUM);
}

static void moments_up(OctTask *task, long first, long last)
{
    const Oct *oct = task->oct;
    real *moment = task->rows->moment + oct->lists.base * OCT_ROW;
    for (long i = first; i < last; i++) {
        long node = task->inner[i];
        real *to = moment + node * OCT_ROW;
        const real *from = moment + (long)oct->child[node] * OCT_ROW;
        Row centre = row_pads(row_load(to)), sum = {0}, moved = {0};
        for (int c = 0; c < oct->children[node]; c++)
            row_add_moments(from + c * OCT_ROW, &centre, &sum, &moved);
        row_keep(to, row_add(sum, moved));
    }
    sm_lap(task->laps, SM_FAST_SUM);
}

/* The sum of list t about the centre of row `to`. */
SM_INLINE Row list_moments(const OctTask *task, long t, long to)
{
    const OctSumLists *lists = &task->oct->lists;
    const real *moment = task->rows->moment;
    const int *row = lists->rows.item + lists->rows.first[t];
    const int *end = lists->rows.item + lists->rows.end[t];
    Row centre = row_pads(row_load(moment + to * OCT_ROW));
    Row sum[OCT_GROUP] = {{{{0}}}}, moved[OCT_GROUP] = {{{{0}}}};
    for (; row < end; row += OCT_GROUP)
        for (int i = 0; i < OCT_GROUP; i++)
            row_add_moments(moment + (long)row[i] * OCT_ROW, &centre, &sum[i], &moved[i]);
    return row_add(row_total(sum), row_total(moved));
}

static void moments_down(OctTask *task, long first, long last)
{
    for (long k = first; k < last; k++) {
        long row = oct_prefix_row(k);
        row_keep(task->rows->moment + row * OCT_ROW, list_moments(task, k, row));
    }
    sm_lap(task->laps, SM_FAST_SUM);
}

/* The sums of a block's regions, in lanes. */
SM_INLINE void region_sums(const OctTask *task, long block, vec S[16])
{
    const Oct *oct = task->oct;
    real sums[SM_LANES][OCT_ROW] __attribute__((aligned(64)));
    const real *row[SM_LANES];
    for (int lane = 0; lane < SM_LANES; lane++) {
        long slot = block * SM_LANES + lane;
        row_store(sums[lane], list_moments(task, oct->lists.prefixes + slot, oct->row[slot]));
        row[lane] = sums[lane];
    }
    lanes_from_rows(row, S);
}

/* c_r (eq. 6) and A_r = sum m~ x (x0 - c0_r)^T (eq. 7) from the sums about the regions' nodes. */
SM_INLINE void centre_moments(const vec S[16], const OctConst *k, vec c[3], vec A[9])
{
    for (int i = 0; i < 3; i++) {
        c[i] = S[i] * k->inverse_mass;
        for (int d = 0; d < 3; d++) A[i * 3 + d] = S[4 + 4 * d + i] - S[i] * k->offset[d];
    }
}

/* m_r T_r as rows: the place that the region gives its node, and the linear part F. */
SM_INLINE void store_transforms(const OctTask *task, long block, const vec c[3], const vec F[9])
{
    const OctConst *k = &task->oct->block[block];
    vec field[16];
    real *row[SM_LANES];
    for (int i = 0; i < 3; i++) {
        vec q = c[i];
        for (int d = 0; d < 3; d++) q -= F[i * 3 + d] * k->offset[d];
        field[i] = k->mass * q;
        for (int d = 0; d < 3; d++) field[4 + 4 * d + i] = k->mass * F[i * 3 + d];
        field[7 + 4 * i] = k->centre[i];
    }
    field[3] = lanes_set(0);
    for (int lane = 0; lane < SM_LANES; lane++)
        row[lane] = task->rows->transform + (long)task->oct->row[block * SM_LANES + lane] * OCT_ROW;
    lanes_to_rows(field, row);
}

/* c_r, and A_r as it is to be rotated, of a block's regions. */
SM_INLINE void block_moments(OctTask *task, long block, vec c[3], vec A[9])
{
    const Oct *oct = task->oct;
    const OctState *body = task->body;
    vec S[16];
    region_sums(task, block, S);
    sm_lap(task->laps, SM_FAST_SUM);
    centre_moments(S, &oct->block[block], c, A);
    if (oct->damp_now) store3(task->rows->centre + block * 3 * SM_LANES, c);
    if (body->plastic) plastic_moments(body->plastic + block * 9 * SM_LANES, A);
    sm_lap(task->laps, SM_SHAPE_MATCHING);
    if (oct->collinear_of[block] >= 0)
        collinear_rotations(&oct->collinear[oct->collinear_of[block]],
                            body->last + block * 6 * SM_LANES, A);
}

/* The transforms of a block's regions from their rotations. */
SM_INLINE void block_transforms(OctTask *task, long block, const vec c[3], const vec A[9],
                                const vec R[9])
{
    vec F[9];
    sm_lap(task->laps, SM_POLAR);
    if (task->body->plastic) plastic_block(task, block, A, R, F);
    store_transforms(task, block, c, task->body->plastic ? F : R);
    sm_lap(task->laps, SM_SHAPE_MATCHING);
}

/* By the paper's way to decompose. */
static __attribute__((noinline)) void match_jacobi(OctTask *task, int blocks, const long *block)
{
    for (int t = 0; t < blocks; t++) {
        OctState *body = task->body;
        vec c[3], A[9], R[9];
        block_moments(task, block[t], c, A);
        polar_jacobi_lanes(A, LANES_ALL, body->last + block[t] * 6 * SM_LANES,
                           body->stretch + block[t] * 9 * SM_LANES, R);
        block_transforms(task, block[t], c, A, R);
    }
}

/* A group of blocks: the iterations of their rotations alternate, and need not wait for each other.
 */
static void match_group(OctTask *task, int blocks, const long *block)
{
    vec c[POLAR_TILES][3], A[POLAR_TILES][9], trace[POLAR_TILES];
    PolarInvariants of[POLAR_TILES];
    unsigned live[POLAR_TILES];
    for (int t = 0; t < blocks; t++) {
        block_moments(task, block[t], c[t], A[t]);
        polar_invariants(A[t], &of[t]);
        live[t] = LANES_ALL;
        sm_lap(task->laps, SM_POLAR);
    }
    polar_traces(blocks, of, live, trace);
    for (int t = 0; t < blocks; t++) {
        vec R[9];
        polar_finish(A[t], &of[t], trace[t], LANES_ALL, POLAR_NARROW,
                     task->body->last + block[t] * 6 * SM_LANES, R);
        block_transforms(task, block[t], c[t], A[t], R);
    }
}

/* Groups are cut where a share may be (build.h), so that they are the same for any threads. */
static void match(OctTask *task, long first, long last)
{
    while (first < last) {
        long block[POLAR_TILES], end = first + POLAR_TILES < last ? first + POLAR_TILES : last;
        int blocks = 0;
        for (; first < end; first++)
            if (task->oct->live[first]) block[blocks++] = first;
        (task->body->stretch ? match_jacobi : match_group)(task, blocks, block);
    }
}

/* A row of a sum of transforms: the values summed over the quarters, the linear part. */
SM_INLINE void keep_transform(real *to, Row linear, const Row *value)
{
    vec4 sum = {0};
    real quarter[OCT_ROW] __attribute__((aligned(64)));
    row_store(quarter, *value);
    for (int i = 0; i < 4; i++) sum += load4(quarter + 4 * i);
    row_keep(to, linear);
    sum[3] = 0;
    store4(to, sum);
}

static void transforms_up(OctTask *task, long first, long last)
{
    const Oct *oct = task->oct;
    real *transform = task->rows->transform + oct->lists.base * OCT_ROW;
    for (long i = first; i < last; i++) {
        long node = task->inner[i];
        real *to = transform + node * OCT_ROW;
        const real *child = transform + (long)oct->child[node] * OCT_ROW;
        Row from = row_from(row_pads(row_load(to))), linear = {0}, value = {0};
        for (int c = 0; c < oct->children[node]; c++) {
            Row row = row_load(child + c * OCT_ROW);
            row_add_values(row, &from, &value);
            linear = row_add(linear, row);
        }
        keep_transform(to, linear, &value);
    }
    sm_lap(task->laps, SM_FAST_SUM);
}

static void transforms_down(OctTask *task, long first, long last)
{
    const OctSumLists *lists = oct_goal_lists(task->oct);
    const real *transform = task->rows->transform;
    for (long k = first; k < last; k++) {
        real *to = task->rows->transform + oct_prefix_row(k) * OCT_ROW;
        Row from = row_from(row_pads(row_load(to))), linear = {0}, value = {0};
        for (long at = lists->rows.first[k]; at < lists->rows.end[k]; at++) {
            Row row = row_load(transform + (long)lists->rows.item[at] * OCT_ROW);
            row_add_values(row, &from, &value);
            linear = row_add(linear, row);
        }
        keep_transform(to, linear, &value);
    }
    sm_lap(task->laps, SM_FAST_SUM);
}

/* M_i g_i of a block's nodes. */
SM_INLINE void goal_sums(const OctTask *task, long block, vec sum[3])
{
    const Oct *oct = task->oct;
    const OctSumLists *lists = oct_goal_lists(oct);
    const real *transform = task->rows->transform;
    real values[SM_LANES][OCT_ROW] __attribute__((aligned(64)));
    const real *row[SM_LANES];
    vec field[16];
    for (int lane = 0; lane < SM_LANES; lane++) {
        long slot = block * SM_LANES + lane;
        const int *entry = lists->rows.item + lists->rows.first[lists->prefixes + slot];
        const int *end = lists->rows.item + lists->rows.end[lists->prefixes + slot];
        Row from = row_from(row_pads(row_load(transform + (long)oct->row[slot] * OCT_ROW)));
        Row value[OCT_GROUP] = {{{{0}}}};
        for (; entry < end; entry += OCT_GROUP)
            for (int i = 0; i < OCT_GROUP; i++)
                row_add_values(row_load(transform + (long)entry[i] * OCT_ROW), &from, &value[i]);
        row_store(values[lane], row_total(value));
        row[lane] = values[lane];
    }
    lanes_from_rows(row, field);
    for (int i = 0; i < 3; i++) sum[i] = (field[i] + field[4 + i]) + (field[8 + i] + field[12 + i]);
}

/* Eqs. 1 and 2 (fastlsm); x is moved later where damping follows. */
static void move(OctTask *task, long first, long last)
{
    const Oct *oct = task->oct;
    OctState *body = task->body;
    real push[3]; /* gravity, and what is left of a change (state.h) */
    for (int d = 0; d < 3; d++) push[d] = (real)((double)oct->gravity[d] + body->kick[d]);
    for (long block = first; block < last; block++) {
        if (!oct->live[block]) continue;
        long at = block * 3 * SM_LANES;
        vec g[3], x[3], v[3];
        goal_sums(task, block, g);
        sm_lap(task->laps, SM_FAST_SUM);
        for (int d = 0; d < 3; d++) g[d] *= oct->block[block].inverse_reach;
        if (task->goals) {
            store3(body->g + at, g);
            continue;
        }
        load3(body->x + at, x);
        load3(body->v + at, v);
        for (int d = 0; d < 3; d++) g[d] -= x[d];
        integrate_velocity(g, push, oct->rounding, lanes_set(1), v);
        if (!oct->damp_now) {
            vec shift[3];
            oct_shift(oct, body, block, shift);
            integrate_position(&oct->obstacles, shift, oct_block(oct, body, block), x, v);
            store3(body->x + at, x);
        }
        store3(body->v + at, v);
        sm_lap(task->laps, SM_OTHER);
    }
}

static void step_body(OctTask *task)
{
    oct_each_block(task, weigh);
    oct_climb(task, moments_up);
    oct_each_ghost(task, oct_ghosts_moments);
    oct_descend(task, &task->oct->lists, moments_down);
    oct_each_block(task, match);
    oct_climb(task, transforms_up);
    oct_each_ghost(task, oct_ghosts_transforms);
    oct_descend(task, oct_goal_lists(task->oct), transforms_down);
    oct_each_block(task, move);
    if (task->oct->damp_now && !task->goals) oct_damp(task);
}

static void step_one(Oct *oct, int me, int team, bool goals, SmLaps *laps)
{
    step_body(&(OctTask){.oct = oct,
                         .body = oct->body,
                         .rows = oct->rows,
                         .me = me,
                         .team = team,
                         .goals = goals,
                         .laps = me ? NULL : laps});
}

/* The bodies of one thread. */
static void step_some(Oct *oct, int worker, bool goals, SmLaps *laps)
{
    for (long i = worker; i < oct->instances; i += oct->workers)
        step_body(&(OctTask){.oct = oct,
                             .body = &oct->body[i],
                             .rows = &oct->rows[worker],
                             .team = 1,
                             .goals = goals,
                             .laps = worker ? NULL : laps});
}

/* One body is shared by all threads; of several, each thread steps some. A team of one would be
 * made anew in every step, with memory and system calls. */
static void step_all(Oct *oct, bool goals, SmLaps *laps)
{
    bool several = oct->instances > 1;
    if ((several ? oct->workers : oct->threads) == 1) {
        if (several)
            step_some(oct, 0, goals, laps);
        else
            step_one(oct, 0, 1, goals, laps);
    } else if (several) {
#pragma omp parallel for schedule(static) num_threads(oct->workers)
        for (int w = 0; w < oct->workers; w++) step_some(oct, w, goals, laps);
    } else {
#pragma omp parallel num_threads(oct->threads)
        step_one(oct, omp_get_thread_num(), omp_get_num_threads(), goals, laps);
    }
}

OctState *oct_turn(Oct *oct)
{
    OctState *bodies = oct->body;
    size_t blocks = (size_t)oct->block_room * SM_LANES;
    oct->body = sm_copy(bodies, (size_t)oct->instances, sizeof *bodies);
    for (long i = 0; i < oct->instances; i++) {
        oct->body[i].last = sm_copy(bodies[i].last, 6 * blocks, sizeof(short));
        if (bodies[i].stretch)
            oct->body[i].stretch = sm_copy(bodies[i].stretch, 9 * blocks, sizeof(real));
    }
    step_all(oct, true, NULL);
    return bodies;
}

void oct_turn_back(Oct *oct, OctState *bodies)
{
    for (long i = 0; i < oct->instances; i++) sm_free_all(oct->body[i].last, oct->body[i].stretch);
    free(oct->body);
    oct->body = bodies;
}

void oct_goals(Oct *oct)
{
    oct_turn_back(oct, oct_turn(oct));
}

void oct_step(Oct *oct, SmLaps *laps)
{
    int every = oct->params.damping_every > 0 ? oct->params.damping_every : 1;
    oct->damp_now = oct->params.damping > 0 && oct->steps % every == 0;
    step_all(oct, false, laps);
    for (long i = 0; i < oct->instances; i++) memset(oct->body[i].kick, 0, sizeof oct->body->kick);
    oct->steps++;
    sm_lap(laps, SM_OTHER);
}
