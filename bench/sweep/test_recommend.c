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
        make_point(8, 7, 0, 1.05),    /* dearer than 0, and as stiff within 10% */
        make_point(9, 8, 0.03, 1.2),  /* on it: the only one so stiff */
    };
    static const bool expected[] = {true, false, true,  false, true,
                                    true, false, false, false, true};
    bench_front_mark(point, 10);
    for (int i = 0; i < 10; i++) assert_int_equal(point[i].front, expected[i]);
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
        {{20, NAN, NAN}, 1},  {{20, 1, NAN}, 2}, {{30, NAN, NAN}, 3}, {{20, NAN, 1.7}, 1},
        {{20, 0.5, NAN}, -1}, {{40, 1, NAN}, 2}, {{40, NAN, 1.2}, 1}, {{20, 0.5, 3}, -1},
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        assert_int_equal(bench_recommend_point(point, 6, "octree", &cases[c].wish),
                         cases[c].expected);
        bool costly = cases[c].wish.budget < 4; /* the lattice deviates by nothing */
        assert_int_equal(bench_recommend_point(point, 6, "fastlsm", &cases[c].wish),
                         costly ? -1 : 0);
    }
    assert_int_equal(bench_recommend_point(point + 4, 2, "octree", &cases[0].wish), -1);
    point[1].parts = 4; /* falls apart, and the others do not */
    assert_int_equal(bench_recommend_point(point, 6, "octree", &cases[0].wish), 2);
}

/* What costs the same within its quartiles is chosen by what it does, in every run alike. */
TEST(noise_does_not_choose)
{
    const BenchWish stiff = {20, NAN, NAN};
    for (int run = 0; run < 2; run++) {
        BenchPoint lattice[] = {make_point(0, run ? 4.1 : 4, 0, 19),
                                make_point(0, run ? 4 : 4.1, 0, 20)};
        lattice[1].w = 2;
        assert_int_equal(bench_recommend_point(lattice, 2, "fastlsm", &stiff), 0);
        BenchPoint tree[] = {make_point(1, run ? 2.05 : 2, 0.012, 20),
                             make_point(2, run ? 2 : 2.05, 0.010, 20),
                             make_point(3, 1.7, 0.03, 10)};
        assert_int_equal(bench_recommend_point(tree, 3, "octree", &stiff), 1);
    }
}

/* What is said of the points to a wish. The caller frees it. */
static char *say(BenchPlan *plan, BenchPoint *point, long count, const BenchWish *wish)
{
    char *text;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    bench_recommend(file, &(BenchCampaign){.plan = plan, .point = point, .count = count}, wish);
    fclose(file);
    return text;
}

/* The softest lattice is the cheapest, and none deviates: which of them is best only the user can
 * say. The octree has nothing as stiff as the stiffest lattice, the lattice nothing as soft. */
TEST(without_a_stiffness_there_is_no_best)
{
    BenchPlan plan = {.engines = "both", .scene = "hand", .width = "edges"};
    BenchPoint point[] = {make_point(0, 1, 0, 0.52),   make_point(1, 0.1, 0.03, 0.4),
                          make_point(3, 0.2, 0.04, 1), make_point(4, 2, 0, 1.01),
                          make_point(7, 0.3, 0.05, 2), make_point(8, 4, 0, 3)};
    BenchWish wish = {NAN, NAN, NAN};
    char *all = say(&plan, point, 6, &wish);
    assert_null(strstr(all, "take"));
    static const char *const choices[] = {"  soft: --stiffness 0.52\n    fastlsm w 1: 1.00 ms",
                                          "  middle: --stiffness 1\n    fastlsm w 2: 2.00 ms",
                                          "  stiff: --stiffness 2\n    fastlsm w 3: 4.00 ms"};
    const char *at = all;
    for (int k = 0; k < 3; k++) {
        at = strstr(at, choices[k]);
        if (!at) fail_msg("no \"%s\" in:\n%s", choices[k], all);
        wish.stiffness = strtod(strstr(at, "ness ") + 5, NULL); /* picks what is shown */
        for (int e = 0; e < 2; e++) {
            const char *engine = e ? "octree" : "fastlsm";
            char shown[64];
            const BenchPoint *p = &point[bench_recommend_point(point, 6, engine, &wish)];
            snprintf(shown, sizeof shown, e ? "%s w %g and epsilon %g" : "%s w %g", engine, p->w,
                     p->epsilon);
            assert_non_null(strstr(at, shown));
        }
    }
    free(all);
    wish = (BenchWish){NAN, 3.5, NAN}; /* leaves the octree one */
    char *few = say(&plan, point, 6, &wish);
    assert_non_null(strstr(few, "--stiffness 0.4\n"));
    assert_null(strstr(few, "epsilon 1"));
    free(few);
    wish = (BenchWish){NAN, 1, 0.5};
    char *none = say(&plan, point, 6, &wish);
    assert_memory_equal(none, "fastlsm: no recommendation: no point is within the budget", 56);
    free(none);
}

TEST(what_is_recommended_can_be_run)
{
    BenchPlan plan = {.engines = "both", .scene = "hand", .width = "edges"};
    BenchPoint point[] = {make_point(0, 4, 0, 10), make_point(1, 1, 0.08, 20),
                          make_point(2, 2, 0.04, 21), make_point(3, 0.5, 0.09, 30)};
    const BenchWish wish = {20, 5, NAN};
    static const char *const wanted[] = {
        "For a beam of 20 Hz (nothing is within 10% of it) and a deviation of at most 5% take "
        "fastlsm w 1: 4.00 ms",
        "itself full resolution",
        "  shapebench run hand --engine fastlsm --w 1\n",
        "For a beam of 20 Hz and a deviation of at most 5% take octree w 1 and epsilon 0.5: 2.00 "
        "ms a step of 295 nodes, a beam of 21 Hz that sags 10% of its length, the surface 4%",
        "  shapebench run hand --engine octree --w 1 --epsilon 0.5\n",
        "A deviation of 4%: 2 ms (w 1, epsilon 0.5); 8%: 1 ms (w 1, epsilon 0).\n"};
    char *text = say(&plan, point, 4, &wish), command[256];
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
