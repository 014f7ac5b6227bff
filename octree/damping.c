/* damping.c - region damping by HF: each region's rigid velocity, averaged over the regions of a
 * node, pulls the node's velocity towards it (fastlsm eq. 14). */
#include "damping.h"

#include "../lib/simd/rigid_lanes.h"
#include "ghosts.h"

static void weigh(OctTask *task, long first, long last)
{
    const Oct *oct = task->oct;
    for (long block = first; block < last; block++) {
        const OctConst *k = &oct->block[block];
        vec product[4], field[16];
        real *row[SM_LANES];
        for (int d = 0; d < 3; d++) {
            damping_products(k->weight, task->body->x + block * 3 * SM_LANES,
                             task->body->v + block * 3 * SM_LANES, d, product);
            for (int i = 0; i < 4; i++) field[4 * i + d] = product[i];
        }
        field[3] = lanes_set(0);
        for (int d = 0; d < 3; d++) field[7 + 4 * d] = k->centre[d];
        for (int lane = 0; lane < SM_LANES; lane++)
            row[lane] = task->rows->transform + (long)oct->row[block * SM_LANES + lane] * OCT_ROW;
        lanes_to_rows(field, row);
    }
    sm_lap(task->laps, SM_DAMPING);
}

static void sums_up(OctTask *task, long first, long last)
{
    const Oct *oct = task->oct;
    real *rows = task->rows->transform + oct->lists.base * OCT_ROW;
    for (long i = first; i < last; i++) {
        long node = task->inner[i];
        const real *child = rows + (long)oct->child[node] * OCT_ROW;
        Row sum = {0};
        for (int c = 0; c < oct->children[node]; c++)
            sum = row_add(sum, row_load(child + c * OCT_ROW));
        row_keep(rows + node * OCT_ROW, sum);
    }
}

SM_INLINE Row list_sum(const OctTask *task, long t)
{
    const OctSumLists *lists = &task->oct->lists;
    const int *row = lists->rows.item + lists->rows.first[t];
    const int *end = lists->rows.item + lists->rows.end[t];
    Row sum[OCT_GROUP] = {{{{0}}}};
    for (; row < end; row += OCT_GROUP)
        for (int i = 0; i < OCT_GROUP; i++)
            sum[i] = row_add(sum[i], row_load(task->rows->transform + (long)row[i] * OCT_ROW));
    return row_total(sum);
}

static void sums_down(OctTask *task, long first, long last)
{
    for (long k = first; k < last; k++)
        row_keep(task->rows->transform + oct_prefix_row(k) * OCT_ROW, list_sum(task, k));
}

/* omega and v - omega x c of every region, times m_r. */
static void solve(OctTask *task, long first, long last)
{
    const Oct *oct = task->oct;
    for (long block = first; block < last; block++) {
        if (!oct->live[block]) continue;
        const OctConst *k = &oct->block[block];
        real sums[SM_LANES][OCT_ROW] __attribute__((aligned(64)));
        const real *row[SM_LANES];
        vec padded[16], F[12], c[3], out[6];
        for (int lane = 0; lane < SM_LANES; lane++) {
            row_store(sums[lane], list_sum(task, oct->lists.prefixes + block * SM_LANES + lane));
            row[lane] = sums[lane];
        }
        lanes_from_rows(row, padded);
        for (int i = 0; i < 12; i++) F[i] = padded[i / 3 * 4 + i % 3];
        load3(task->rows->centre + block * 3 * SM_LANES, c);
        rigid_velocity(F, c, k->inverse_mass, out);
        vec field[8] = {k->mass * out[0], k->mass * out[1], k->mass * out[2], lanes_set(0),
                        k->mass * out[3], k->mass * out[4], k->mass * out[5], lanes_set(0)};
        lanes_interleave(field, 8);
        for (int lane = 0; lane < SM_LANES; lane++)
            half_store(task->rows->velocity +
                           (long)oct->row[block * SM_LANES + lane] * OCT_ROW_VELOCITY,
                       half_load((const real *)field + lane * OCT_ROW_VELOCITY));
    }
    sm_lap(task->laps, SM_DAMPING);
}

static void velocities_up(OctTask *task, long first, long last)
{
    const Oct *oct = task->oct;
    real *velocity = task->rows->velocity + oct->lists.base * OCT_ROW_VELOCITY;
    for (long i = first; i < last; i++) {
        long node = task->inner[i];
        const real *child = velocity + (long)oct->child[node] * OCT_ROW_VELOCITY;
        HalfRow sum = {0};
        for (int c = 0; c < oct->children[node]; c++)
            sum = half_add(sum, half_load(child + c * OCT_ROW_VELOCITY));
        half_store(velocity + node * OCT_ROW_VELOCITY, sum);
    }
}

SM_INLINE HalfRow list_velocity(const OctSumLists *lists, const real *velocity, long t)
{
    const int *row = lists->rows.item + lists->rows.first[t];
    const int *end = lists->rows.item + lists->rows.end[t];
    HalfRow sum[OCT_GROUP] = {0};
    for (; row < end; row += OCT_GROUP)
        for (int i = 0; i < OCT_GROUP; i++)
            sum[i] = half_add(sum[i], half_load(velocity + (long)row[i] * OCT_ROW_VELOCITY));
    for (int i = 1; i < OCT_GROUP; i++) sum[0] = half_add(sum[0], sum[i]);
    return sum[0];
}

static void velocities_down(OctTask *task, long first, long last)
{
    const OctSumLists *lists = oct_goal_lists(task->oct);
    real *velocity = task->rows->velocity;
    for (long k = first; k < last; k++)
        half_store(velocity + oct_prefix_row(k) * OCT_ROW_VELOCITY,
                   list_velocity(lists, velocity, k));
}

static void slow(OctTask *task, long first, long last)
{
    const Oct *oct = task->oct;
    const OctSumLists *lists = oct_goal_lists(oct);
    for (long block = first; block < last; block++) {
        if (!oct->live[block]) continue;
        long at = block * 3 * SM_LANES;
        vec x[3], v[3], field[8], sum[6], shift[3];
        for (int lane = 0; lane < SM_LANES; lane++)
            half_store((real *)field + lane * OCT_ROW_VELOCITY,
                       list_velocity(lists, task->rows->velocity,
                                     lists->prefixes + block * SM_LANES + lane));
        lanes_separate(field, 8);
        for (int i = 0; i < 6; i++) sum[i] = field[i / 3 * 4 + i % 3];
        load3(task->body->x + at, x);
        load3(task->body->v + at, v);
        pull(sum, oct->block[block].inverse_reach, (real)oct->params.damping, x, v);
        oct_shift(oct, task->body, block, shift);
        integrate_position(&oct->obstacles, shift, oct_block(oct, task->body, block), x, v);
        store3(task->body->v + at, v);
        store3(task->body->x + at, x);
    }
    sm_lap(task->laps, SM_DAMPING);
}

void oct_damp(OctTask *task)
{
    oct_each_block(task, weigh);
    oct_climb(task, sums_up);
    oct_each_ghost(task, oct_ghosts_products);
    oct_descend(task, &task->oct->lists, sums_down);
    oct_each_block(task, solve);
    oct_climb(task, velocities_up);
    oct_each_ghost(task, oct_ghosts_velocities);
    oct_descend(task, oct_goal_lists(task->oct), velocities_down);
    oct_each_block(task, slow);
}
