/* Windows against their sums term by term, in both precisions (SM_REAL_BITS). Values are small
 * whole numbers, so every order of summation gives the same bits. */
#include "prefix_sums.h"
#include "window.h"

#include "../../lib/test_frame.h"
#include "../../lib/test_random.h"

enum { MOST = 16, PLACES = 64 };

static real row[PLACES][2 * SM_LANES]; /* values, and what they weigh */
static const real *place[PLACES];

static void fill(unsigned *seed)
{
    for (int c = 0; c < PLACES; c++) {
        for (int i = 0; i < 2 * SM_LANES; i++) row[c][i] = (real)(random_int(seed, 31) - 15);
        place[c] = row[c];
    }
}

/* Of a lane: the values' sum over the places `first` .. first + 2w, and with their offsets. */
static void sums_of(int first, int w, int lane, real *sum, real *moment)
{
    *sum = *moment = 0;
    for (int c = 0; c <= 2 * w; c++) {
        *sum += row[first + c][lane];
        *moment += (real)(c - w) * row[first + c][lane];
    }
}

static void check_window(int first, int w, int at, vec sum, vec moment)
{
    for (int i = 0; i < SM_LANES; i++) {
        real want, want_moment;
        sums_of(first, w, at + i, &want, &want_moment);
        if (sum[i] != want || moment[i] != want_moment)
            fail_msg("w %d from %d on, lane %d: sum %g, moment %g; wanted %g, %g", w, first, i,
                     (double)sum[i], (double)moment[i], (double)want, (double)want_moment);
    }
}

TEST(windows_are_summed_anew_and_by_moving)
{
    unsigned seed = 1;
    for (int w = 1; w <= MOST; w++) {
        vec sum, moment = lanes_set(0), alone, moved, moved_moment;
        fill(&seed);
        int at = w % SM_LANES;
        window_sum(place, at, w, &moved, &moved_moment);
        for (int first = 0; first + 2 * w < PLACES; first++) {
            window_sum(place + first, at, w, &sum, &moment);
            check_window(first, w, at, sum, moment);
            check_window(first, w, at, moved, moved_moment);
            window_sum(place + first, at, w, &alone, NULL);
            assert_memory_equal(&alone, &sum, sizeof sum);
            if (first + 2 * w + 1 == PLACES) break;
            window_move(lanes_load(row[first] + at), lanes_load(row[first + 2 * w + 1] + at), w,
                        &moved, &moved_moment);
        }
    }
}

/* Of values less their offsets times what they weigh. */
static void check_less(int first, int w, vec sum, vec rest)
{
    for (int i = 0; i < SM_LANES; i++) {
        real value, weighed, moment, unused;
        sums_of(first, w, i, &value, &unused);
        sums_of(first, w, SM_LANES + i, &weighed, &moment);
        assert_true(sum[i] == value - moment);
        assert_true(rest[i] == weighed);
    }
}

TEST(adjoints_of_windows_are_summed_anew_and_by_moving)
{
    unsigned seed = 2;
    for (int w = 1; w <= MOST; w++) {
        vec sum, rest, moved, moved_rest;
        fill(&seed);
        window_less(place, 0, SM_LANES, w, &moved, &moved_rest);
        for (int first = 0; first + 2 * w < PLACES; first++) {
            window_less(place + first, 0, SM_LANES, w, &sum, &rest);
            check_less(first, w, sum, rest);
            check_less(first, w, moved, moved_rest);
            int next = first + 2 * w + 1;
            if (next == PLACES) break;
            const vec leave[2] = {lanes_load(row[first]), lanes_load(row[first] + SM_LANES)},
                      enter[2] = {lanes_load(row[next]), lanes_load(row[next] + SM_LANES)};
            window_less_move(leave, enter, w, &moved, &moved_rest);
        }
    }
}

/* Lane i of a run against its terms; beyond the run there are zeros. */
static void check_along_x(const real *value, int lanes, int w, int i, real sum, real moment)
{
    real want = 0, want_moment = 0;
    for (int a = -w; a <= w; a++)
        if (i + a >= 0 && i + a < lanes) {
            want += value[i + a];
            want_moment += (real)a * value[i + a];
        }
    if (sum != want || moment != want_moment)
        fail_msg("w %d, place %d of %d: sum %g, moment %g; wanted %g, %g", w, i, lanes, (double)sum,
                 (double)moment, (double)want, (double)want_moment);
}

/* Along x, runs of blocks: by sliding, which takes one block to either side, and by prefixes. */
TEST(windows_along_x_slide_or_subtract_prefixes)
{
    enum { MOST_BLOCKS = 12, STRIDE = 3 * SM_LANES, MOMENT = 2 * SM_LANES };
    unsigned seed = 3;
    for (int trial = 0; trial < 20; trial++)
        for (int w = 1; w <= SM_MOST_W; w++) {
            int count = 1 + random_int(&seed, MOST_BLOCKS), lanes = count * SM_LANES;
            real value[MOST_BLOCKS * SM_LANES];
            Prefixes room[MOST_BLOCKS + 2 * PREFIX_AROUND(SM_MOST_W)] = {{{0}, {0}}};
            real run[2][MOST_BLOCKS * STRIDE]; /* sums, unused, moments of each block */
            for (int i = 0; i < lanes; i++) value[i] = (real)(random_int(&seed, 31) - 15);
            for (int b = 0; b < count; b++) {
                const real *from = value + b * SM_LANES;
                vec none = lanes_set(0), here = lanes_load(from), moment = none;
                vec before = b > 0 ? lanes_load(from - SM_LANES) : none;
                vec after = b + 1 < count ? lanes_load(from + SM_LANES) : none;
                lanes_store(run[0] + b * STRIDE, here);
                lanes_store(run[1] + b * STRIDE, here);
                if (w > SM_LANES) continue;
                vec sum = window_sum_x(before, here, after, w, &moment);
                for (int i = 0; i < SM_LANES; i++)
                    check_along_x(value, lanes, w, b * SM_LANES + i, sum[i], moment[i]);
            }
            prefix_sums_far(room, w, run[0], count, STRIDE, MOMENT);
            if (w <= SM_LANES) prefix_sums_near(w, run[1], count, STRIDE, MOMENT);
            for (int way = 0; way < (w <= SM_LANES ? 2 : 1); way++)
                for (int i = 0; i < lanes; i++) {
                    const real *at = run[way] + i / SM_LANES * STRIDE + i % SM_LANES;
                    check_along_x(value, lanes, w, i, at[0], at[MOMENT]);
                }
        }
}
