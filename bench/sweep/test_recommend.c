/* The front of a sweep, and what it recommends. */
#include "../../lib/test_frame.h"
#include "recommend.h"
#include "test_point.h"

TEST(the_front_is_marked)
{
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
TEST(noise_does_not_move_the_front)
{
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

TEST(recommendations_meet_the_wish)
{
    BenchPoint point[] = {
        make_point(0, 4, 0, 10),      make_point(1, 1, 0.03, 20),    make_point(2, 2, 0.008, 21),
        make_point(3, 1.5, 0.02, 40), make_point(4, NAN, 0.001, 30), make_point(5, 0.1, NAN, 20),
    };
    const struct {
        BenchWish wish;
        long expected;
    } cases[] = {
        {{NAN, NAN, NAN}, 2}, /* up to 1.8% */
        {{NAN, 3, NAN}, 1},   {{NAN, 0.5, NAN}, -1}, {{20, NAN, NAN}, 1},  {{20, 1, NAN}, 2},
        {{30, NAN, NAN}, 3},  {{NAN, NAN, 1.7}, 3},  {{NAN, NAN, 100}, 2}, {{NAN, 0.5, 3}, -1},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        assert_int_equal(bench_recommend_point(point, 6, "octree", &cases[c].wish),
                         cases[c].expected);
        bool costly = cases[c].wish.budget < 4; /* the lattice deviates by nothing */
        assert_int_equal(bench_recommend_point(point, 6, "fastlsm", &cases[c].wish),
                         costly ? -1 : 0);
    }
    assert_int_equal(bench_recommend_point(point + 4, 2, "octree", &cases[0].wish), -1);
    point[2].parts = 4; /* falls apart, and the others do not */
    assert_int_equal(bench_recommend_point(point, 6, "octree", &cases[0].wish), 1);
}

/* What costs the same within its quartiles is chosen by what it does, in every run alike. */
TEST(noise_does_not_choose)
{
    const BenchWish any = {NAN, NAN, NAN};
    for (int run = 0; run < 2; run++) {
        BenchPoint lattice[] = {make_point(0, run ? 4.1 : 4, 0, 10),
                                make_point(0, run ? 4 : 4.1, 0, 20)};
        lattice[1].w = 2;
        assert_int_equal(bench_recommend_point(lattice, 2, "fastlsm", &any), 0);
        BenchPoint tree[] = {make_point(1, run ? 2.05 : 2, 0.012, 10),
                             make_point(2, run ? 2 : 2.05, 0.010, 20),
                             make_point(3, 1.7, 0.03, 20)};
        assert_int_equal(bench_recommend_point(tree, 3, "octree", &any), 1);
    }
}

TEST(what_is_recommended_can_be_run)
{
    BenchPlan plan = {.engines = "both", .scene = "hand", .width = "edges"};
    BenchPoint point[] = {make_point(0, 4, 0, 10), make_point(1, 1, 0.08, 20),
                          make_point(2, 2, 0.04, 21)};
    const BenchWish any = {NAN, NAN, NAN};
    static const char best[] =
        "octree: for a deviation of at most 5%, 1% more than its least take w 1 "
        "(edges of each node's own cell) and epsilon 0.5: 2.00 ms";
    static const char *const wanted[] = {
        "fastlsm: whatever is cheapest take w 1 (cells)",
        "itself full resolution",
        "  shapebench run hand --engine fastlsm --w 1\n",
        best,
        "  shapebench run hand --engine octree --w 1 --epsilon 0.5\n",
        "A deviation of 4%: 2 ms (w 1, epsilon 0.5); 8%: 1 ms (w 1, epsilon 0)."};
    char *text, command[256];
    size_t size;
    FILE *file = open_memstream(&text, &size);
    bench_recommend(file, &plan, point, 3, &any);
    fclose(file);
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        if (!strstr(text, wanted[i])) fail_msg("no \"%s\" in:\n%s", wanted[i], text);
    free(text);
    strcpy(plan.mesh, "my meshes/hand.obj");
    strcpy(plan.scene, "hand.obj"); /* alone it has its file's name */
    strcpy(plan.width, "cells");
    strcpy(plan.precision, "double");
    plan.cell = 0.25;
    bench_recommend_command(&plan, &point[2], sizeof command, command);
    assert_string_equal(command,
                        "shapebench run 'my meshes/hand.obj' --engine octree --w 1 --width "
                        "cells --epsilon 0.5 --cell 0.25 --precision double");
    strcpy(plan.scene, "hand");
    strcpy(plan.mesh, "it's a hand.obj"); /* in the place of the scene's, whatever it is called */
    bench_recommend_command(&plan, &point[0], sizeof command, command);
    assert_string_equal(command, "shapebench run hand --mesh 'hand=it'\\''s a hand.obj' "
                                 "--engine fastlsm --w 1 --precision double");
}
