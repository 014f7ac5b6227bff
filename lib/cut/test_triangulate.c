/* Outlines filled with triangles: every side once, the area, three corners each. */
#include "triangulate.h"

#include "../error.h"
#include "../test_frame.h"
#include "../test_random.h"

static unsigned seed = 1;

enum { MOST = 200 };

typedef struct {
    int rings, first[MOST + 1];
    double at[MOST][2];
} Rings;

/* A star-shaped ring of `count` points around c, between `least` and `most` away from it, with its
 * points up to `shift` off. Holes go clockwise. */
static void add_ring(Rings *r, int count, const double c[2], double least, double most,
                     double shift)
{
    int from = r->first[r->rings];
    for (int i = 0; i < count; i++) {
        double turn = (r->rings ? -2 : 2) * acos(-1) * i / count,
               away = random_between(&seed, least, most);
        r->at[from + i][0] = c[0] + away * cos(turn) + random_between(&seed, -shift, shift);
        r->at[from + i][1] = c[1] + away * sin(turn) + random_between(&seed, -shift, shift);
    }
    r->first[++r->rings] = from + count;
}

static double turn_of(const double *p, const double *q, const double *r)
{
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

/* How often sides from p to q are more than those from q to p: 1 along the outline, else 0. */
static void assert_sides(const Rings *r, long count, const int (*triangle)[3])
{
    static int balance[MOST][MOST];
    memset(balance, 0, sizeof balance);
    for (long t = 0; t < count; t++)
        for (int i = 0; i < 3; i++) {
            balance[triangle[t][i]][triangle[t][(i + 1) % 3]]++;
            balance[triangle[t][(i + 1) % 3]][triangle[t][i]]--;
        }
    for (int n = 0; n < r->rings; n++)
        for (int i = r->first[n]; i < r->first[n + 1]; i++) {
            int after = i + 1 < r->first[n + 1] ? i + 1 : r->first[n];
            balance[i][after]--;
            balance[after][i]++;
        }
    for (int p = 0; p < r->first[r->rings]; p++)
        for (int q = 0; q < r->first[r->rings]; q++) assert_int_equal(balance[p][q], 0);
}

/* Fills it; checks what is filled. Returns the number of triangles, or -1. */
static long fill(const Rings *r, double slack)
{
    int points = r->first[r->rings];
    long most = sm_triangulate_most(points, r->rings);
    int(*triangle)[3] = sm_alloc((size_t)most, sizeof *triangle);
    const SmOutline outline = {r->rings, r->first, r->at};
    long count = sm_triangulate(&outline, slack, triangle);
    assert_in_range(count + 1, 0, most + 1);
    double area = 0, expected = 0;
    for (long t = 0; t < count; t++) {
        const int *k = triangle[t];
        for (int i = 0; i < 3; i++) {
            assert_in_range(k[i], 0, points - 1);
            assert_int_not_equal(k[i], k[(i + 1) % 3]);
        }
        double turn = turn_of(r->at[k[0]], r->at[k[1]], r->at[k[2]]);
        assert_true(turn >= -100 * slack);
        area += turn;
    }
    for (int n = 0; n < r->rings; n++)
        for (int i = r->first[n] + 1; i + 1 < r->first[n + 1]; i++)
            expected += turn_of(r->at[r->first[n]], r->at[i], r->at[i + 1]);
    if (count >= 0) {
        assert_sides(r, count, (const int(*)[3])triangle);
        assert_true(fabs(area - expected) <= 1e-12 + 100 * slack);
    }
    free(triangle);
    return count;
}

/* Rings well apart: every one of the triangles has an area. */
TEST(rings_with_holes_are_filled)
{
    for (int trial = 0; trial < 500; trial++) {
        Rings r = {0};
        add_ring(&r, 3 + random_int(&seed, 40), (double[2]){0, 0}, 4, 9, 0);
        if (r.first[1] >= 12)
            for (int h = 0; h < 4 && trial % 3; h++)
                add_ring(&r, 3 + random_int(&seed, 12), (double[2]){h % 2 - 0.5, h / 2 - 0.5}, 0.1,
                         0.4, 0);
        long count = fill(&r, 1e-10);
        assert_int_equal(count, sm_triangulate_most(r.first[r.rings], r.rings));
    }
}

/* Holes with hardly any width, rings that touch or nearly cross, points in one place, all in one
 * line: filled, or said not to be. */
TEST(outlines_as_thin_as_rounding_do_no_harm)
{
    long filled = 0;
    for (int trial = 0; trial < 20000; trial++) {
        Rings r = {0};
        double slack = trial % 2 ? 1e-10 : 1e-3, tiny = pow(10, random_between(&seed, -14, -2));
        int kind = random_int(&seed, 4);
        add_ring(&r, 3 + random_int(&seed, 8), (double[2]){0, 0}, 1, 1 + (kind == 1), tiny);
        for (int h = random_int(&seed, 4); h > 0; h--) {
            double c[2] = {random_between(&seed, -1, 1), random_between(&seed, -1, 1)};
            add_ring(&r, 1 + random_int(&seed, 5), c, kind == 2 ? 0 : tiny, kind == 2 ? 0.3 : tiny,
                     tiny);
        }
        if (kind == 3)
            for (int i = 0; i < r.first[r.rings]; i++) r.at[i][1] *= tiny;
        filled += fill(&r, slack) >= 0;
    }
    assert_true(filled > 1000);
}

/* A hole whose points lie in two places, but for rounding, beside the outside: filling it leaves a
 * spike to and fro between two points, which is no triangle. */
TEST(a_spike_is_no_triangle)
{
    const Rings r = {2,
                     {0, 4, 11},
                     {{1.6666666666615686, -4.697773456573486e-12},
                      {-2.7297019958496042e-13, 1.6666666666669843},
                      {-0.66666666666611907, 2.891579866409302e-12},
                      {9.6858370304107654e-12, -0.66666666666331809},
                      {-0.66666666667266283, 0.33333333333392096},
                      {-0.66666666665766239, 0.33333333332378784},
                      {-0.6666666666615837, 0.333333333338525},
                      {-0.66666666667031105, 0.33333333333883575},
                      {-0.6666666666701484, 0.33333333333086251},
                      {-0.66666666667170049, 0.33333333333664422},
                      {-0.33333333333322746, 0.33333333334260012}}};
    assert_int_equal(fill(&r, 1.5e-5), sm_triangulate_most(11, 2) - 2);
}
