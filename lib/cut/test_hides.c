/* What a triangle hides is what sm_cut_crosses() says is beyond it. */
#include "cut.h"

#include "../test_frame.h"
#include "../test_random.h"

static void draw_point(unsigned *seed, double point[3])
{
    for (int d = 0; d < 3; d++) point[d] = random_between(seed, -1, 1);
}

TEST(every_segment_to_a_hidden_box_crosses)
{
    unsigned seed = 7;
    long hidden = 0;
    for (int round = 0; round < 20000; round++) {
        SmCut cut;
        double x[3], centre[3], half = 0.1 * (1 + random_between(&seed, -1, 1));
        int number[3];
        sm_cut_init(&cut, 0.5);
        for (int i = 0; i < 3; i++) {
            double corner[3];
            draw_point(&seed, corner);
            number[i] = (int)sm_cut_vertex(&cut, corner);
        }
        long triangle = sm_cut_triangle(&cut, number);
        draw_point(&seed, x);
        draw_point(&seed, centre);
        bool hides = sm_cut_hides(&cut, triangle, x, centre, half);
        hidden += hides;
        for (int n = 0; n < 16 && hides; n++) {
            double to[3];
            for (int d = 0; d < 3; d++)
                to[d] = centre[d] +
                        half * (n < 8 ? (n >> d & 1 ? 1 : -1) : random_between(&seed, -1, 1));
            assert_true(sm_cut_crosses(&cut, 0, x, to));
            assert_true(sm_cut_crosses_one(&cut, triangle, x, to));
            assert_int_equal(sm_cut_crossed(&cut, 0, x, to), triangle);
        }
        sm_cut_free(&cut);
    }
    assert_true(hidden > 100);
}

TEST(a_box_in_full_view_is_not_hidden)
{
    SmCut cut;
    const double corner[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, x[3] = {0.25, 0.25, -0.01};
    int number[3];
    sm_cut_init(&cut, 1);
    for (int i = 0; i < 3; i++) number[i] = (int)sm_cut_vertex(&cut, corner[i]);
    long triangle = sm_cut_triangle(&cut, number);
    assert_true(sm_cut_hides(&cut, triangle, x, (double[3]){0.25, 0.25, 1}, 0.5));
    assert_false(sm_cut_hides(&cut, triangle, x, (double[3]){0.25, 0.25, 0.2}, 0.5)); /* both */
    assert_false(sm_cut_hides(&cut, triangle, x, (double[3]){0.25, 0.25, -1}, 0.5));  /* behind */
    assert_false(sm_cut_hides(&cut, triangle, x, (double[3]){90, 0.25, 1}, 0.5));     /* aside */
    sm_cut_free(&cut);
}
