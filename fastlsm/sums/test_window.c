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

/* Along x, the middle one of blocks: by sliding, which takes one to either side, and by prefixes.
 */
TEST(windows_along_x_slide_or_subtract_prefixes)
{
    unsigned seed = 3;
    for (int trial = 0; trial < 20; trial++)
        for (int w = 1; w <= SM_MOST_W; w++) {
            enum { BLOCKS = PREFIX_MOST, LANES = BLOCKS * SM_LANES };
            real value[LANES];
            for (int i = 0; i < LANES; i++) value[i] = (real)(random_int(&seed, 31) - 15);
            vec block[BLOCKS], sum = {0}, moment = {0}, prefix_moment = {0};
            Prefixes prefix[BLOCKS];
            for (int b = 0; b < BLOCKS; b++) {
                block[b] = lanes_load(value + b * SM_LANES);
                prefix[b] = prefixes_of(block[b], true);
            }
            const int here = BLOCKS / 2, first = here * SM_LANES;
            if (w <= SM_LANES)
                sum = window_sum_x(block[here - 1], block[here], block[here + 1], w, &moment);
            vec prefix_sum = window_prefixes_x(prefix + here - PREFIX_BLOCKS(w) - 1, w,
                                               PREFIX_BLOCKS(w), &prefix_moment);
            for (int i = 0; i < SM_LANES; i++) {
                real want = 0, want_moment = 0;
                for (int a = -w; a <= w; a++) {
                    want += value[first + i + a];
                    want_moment += (real)a * value[first + i + a];
                }
                assert_true(w > SM_LANES || (sum[i] == want && moment[i] == want_moment));
                assert_true(prefix_sum[i] == want && prefix_moment[i] == want_moment);
            }
        }
}
