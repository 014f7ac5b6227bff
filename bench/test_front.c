/* The front of a sweep, and what it recommends. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "front.h"

/* Point 0 is the lattice's with w 1, those after it the octree's with epsilon 0, 0.5 and 1, and so
 * on with w 2; times' quartiles are 5% to each side. */
static BenchPoint make_point(int index, double ms, double path, double hz)
{
    BenchPoint point = bench_point_none();
    bool tree = index % 4 > 0;
    point.index = index;
    strcpy(point.engine, tree ? "octree" : "fastlsm");
    point.w = 1 + index / 4;
    point.epsilon = tree ? 0.5 * (index % 4 - 1) : 0;
    point.valid = isfinite(ms);
    point.particles = 295;
    point.total_ms = ms;
    point.total_low_ms = 0.95 * ms;
    point.total_high_ms = 1.05 * ms;
    point.path_rms = path;
    point.path_most = 2 * path;
    point.goal_rms = 0.02;
    point.frequency = hz;
    point.sag = 0.1;
    return point;
}

static void the_front_is_marked(void **state)
{
    (void)state;
    BenchPoint point[] = {
        make_point(0, 4, 0, 1),       /* on it: nothing deviates less */
        make_point(1, 5, 0, 1),       /* dearer, and no better */
        make_point(2, 1, 0.02, 1),    /* on it: the cheapest */
        make_point(3, 1.2, 0.03, 1),  /* dearer, and worse */
        make_point(4, 2, 0.01, 1),    /* on it */
        make_point(5, 2, 0.01, 1),    /* the same: neither beats the other */
        make_point(6, NAN, 0.001, 1), /* INVALID */
        make_point(7, 0.5, NAN, 1),   /* no deviation known */
    };
    static const bool expected[] = {true, false, true, false, true, true, false, false};
    bench_front_mark(point, 8);
    for (int i = 0; i < 8; i++) assert_int_equal(point[i].front, expected[i]);
}

/* Whichever of two costs that differ by less than their spread comes out lower, the front stays. */
static void noise_does_not_move_the_front(void **state)
{
    (void)state;
    for (int run = 0; run < 2; run++) {
        BenchPoint point[] = {
            make_point(0, run ? 2.05 : 2, 0.01, 1), make_point(1, run ? 2 : 2.05, 0.02, 1),
            make_point(2, 2.5, 0.015, 1), /* dearer than both, beyond the spread */
        };
        bench_front_mark(point, 3);
        assert_true(point[0].front && point[1].front && !point[2].front);
        point[1].total_high_ms = 3;
        point[1].total_low_ms = 1.04 * point[0].total_ms; /* still in the other's quartiles */
        bench_front_mark(point, 3);
        assert_true(point[1].front);
        point[1].total_low_ms = 1.06 * point[0].total_ms; /* now beyond them */
        bench_front_mark(point, 3);
        assert_true(point[0].front && !point[1].front);
    }
}

static void recommendations_meet_the_wish(void **state)
{
    (void)state;
    BenchPoint point[] = {
        make_point(0, 4, 0, 10),      make_point(1, 1, 0.03, 20),    make_point(2, 2, 0.008, 21),
        make_point(3, 1.5, 0.02, 40), make_point(4, NAN, 0.001, 30), make_point(5, 0.1, NAN, 20),
    };
    const struct {
        BenchWish wish;
        long expected;
        const char *words;
    } cases[] = {
        {{NAN, NAN, NAN},
         2,
         "For a deviation of at most 1% take the octree with w 1 edges and "
         "epsilon 0.5: 2.00 ms"},
        {{NAN, 3, NAN}, 1, "epsilon 0: 1.00 ms"},
        {{NAN, 0, NAN}, 0, "fastlsm with w 1"},
        {{20, NAN, NAN}, 1, "a beam of 20 Hz"},
        {{20, 1, NAN}, 2, "epsilon 0.5"},
        {{30, NAN, NAN}, 3, "nothing is within 10% of it"},
        {{NAN, NAN, 1.7}, 3, "a step of at most 1.7 ms"},
        {{NAN, NAN, 100}, 0, "itself full resolution"},
        {{NAN, 0.5, 3}, -1, "within the budget and the deviation"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        char sentence[BENCH_SENTENCE];
        long best = bench_recommend(point, 6, &cases[c].wish, "edges", sentence);
        if (best != cases[c].expected || !strstr(sentence, cases[c].words))
            fail_msg("case %zu: %ld: %s", c, best, sentence);
    }
    char sentence[BENCH_SENTENCE];
    point[1].parts = 4;
    bench_recommend(point, 6, &cases[3].wish, "edges", sentence);
    assert_non_null(strstr(sentence, "295 nodes in 4 parts that no region joins"));
    assert_int_equal(bench_recommend(point + 4, 2, &cases[0].wish, "edges", sentence), -1);
    assert_non_null(strstr(sentence, "no valid point"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_front_is_marked),
        cmocka_unit_test(noise_does_not_move_the_front),
        cmocka_unit_test(recommendations_meet_the_wish),
    };
    return cmocka_run_group_tests_name("front", tests, NULL, NULL);
}
