/* Segments against a cut surface: random ones against all its triangles, and the exact places:
 * along edges, through vertices, in the plane. */
#include "cut.h"

#include "../predicates.h"
#include "../test_frame.h"
#include "../test_random.h"

static unsigned seed = 1;

/* A sheet of side x side squares over the unit square, z = height(x, y). */
static void sheet(SmCut *cut, int side, double (*height)(double, double))
{
    sm_cut_init(cut, 0.1);
    for (int j = 0; j <= side; j++)
        for (int i = 0; i <= side; i++) {
            double x = (double)i / side, y = (double)j / side;
            sm_cut_vertex(cut, (double[3]){x, y, height(x, y)});
        }
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) {
            int a = j * (side + 1) + i, b = a + side + 1;
            sm_cut_triangle(cut, (int[3]){a, a + 1, b + 1});
            sm_cut_triangle(cut, (int[3]){a, b + 1, b});
        }
}

static double flat(double x, double y)
{
    (void)x, (void)y;
    return 0;
}

static double hill(double x, double y)
{
    return 0.3 * sin(3 * x) * cos(4 * y);
}

/* Against every triangle, by solving a + t (b - a) = p + u (q - p) + v (r - p). */
static bool crosses_any(const SmCut *cut, const double a[3], const double b[3])
{
    for (long t = 0; t < cut->triangles; t++) {
        const double *p[3];
        double m[3][3], s[3];
        for (int i = 0; i < 3; i++) p[i] = cut->vertex[cut->triangle[t][i]];
        for (int d = 0; d < 3; d++) {
            m[0][d] = a[d] - b[d];
            m[1][d] = p[1][d] - p[0][d];
            m[2][d] = p[2][d] - p[0][d];
            s[d] = a[d] - p[0][d];
        }
        double n[3], k[3], l[3], det;
        n[0] = m[1][1] * m[2][2] - m[1][2] * m[2][1];
        n[1] = m[1][2] * m[2][0] - m[1][0] * m[2][2];
        n[2] = m[1][0] * m[2][1] - m[1][1] * m[2][0];
        det = m[0][0] * n[0] + m[0][1] * n[1] + m[0][2] * n[2];
        for (int d = 0; d < 3; d++) { /* Cramer's rule */
            int e = (d + 1) % 3, f = (d + 2) % 3;
            k[d] = s[e] * m[2][f] - s[f] * m[2][e];
            l[d] = m[1][e] * s[f] - m[1][f] * s[e];
        }
        double w = (s[0] * n[0] + s[1] * n[1] + s[2] * n[2]) / det;
        double u = (m[0][0] * k[0] + m[0][1] * k[1] + m[0][2] * k[2]) / det;
        double v = (m[0][0] * l[0] + m[0][1] * l[1] + m[0][2] * l[2]) / det;
        if (w >= 0 && w <= 1 && u >= 0 && v >= 0 && u + v <= 1) return true;
    }
    return false;
}

TEST(random_segments_cross_what_they_cross)
{
    SmCut cut;
    long crossed = 0;
    sheet(&cut, 7, hill);
    for (int trial = 0; trial < 20000; trial++) {
        double a[3], b[3], length = trial % 3 ? 0.15 : 1;
        for (int d = 0; d < 3; d++) {
            a[d] = random_between(&seed, -0.1, 1.1) - (d == 2 ? 0.5 : 0);
            b[d] = a[d] + length * random_between(&seed, -0.5, 0.5);
        }
        bool expected = crosses_any(&cut, a, b);
        crossed += expected;
        assert_int_equal(sm_cut_crosses(&cut, 0, a, b), expected);
        assert_int_equal(sm_cut_crosses(&cut, 0, b, a), expected);
        long next = sm_cut_first_crossed(&cut, 0, a, b);
        for (long t = 0; t < cut.triangles; t++) {
            if (!sm_cut_crosses_one(&cut, t, a, b)) continue;
            assert_int_equal(next, t);
            next = sm_cut_first_crossed(&cut, t + 1, b, a);
        }
        assert_int_equal(next, -1);
    }
    assert_in_range(crossed, 1000, 19000);
    sm_cut_free(&cut);
}

/* Segments straight through vertices, edges and diagonals of a sheet, none of which gets through;
 * and segments that touch it from one side or lie in it, which cross nothing. */
TEST(nothing_slips_through_where_triangles_meet)
{
    SmCut cut;
    sheet(&cut, 4, flat);
    for (int j = 1; j < 16; j++)
        for (int i = 1; i < 16; i++) {
            double x = i / 16.0, y = j / 16.0;
            assert_true(sm_cut_crosses(&cut, 0, (double[3]){x, y, -0.1}, (double[3]){x, y, 0.1}));
            assert_true(sm_cut_crosses(&cut, 0, (double[3]){x, y, -0.1}, (double[3]){x, y, 0}));
            assert_false(sm_cut_crosses(&cut, 0, (double[3]){x, y, 0}, (double[3]){x, y, 0.1}));
            assert_false(
                sm_cut_crosses(&cut, 0, (double[3]){x, y, 0}, (double[3]){x + 0.1, y - 0.2, 0}));
        }
    sm_cut_free(&cut);
}

TEST(only_later_triangles_are_asked)
{
    SmCut cut;
    sheet(&cut, 1, flat);
    const double a[3] = {0.7, 0.2, -1}, b[3] = {0.7, 0.2, 1};
    assert_true(sm_cut_crosses(&cut, 0, a, b));
    assert_false(sm_cut_crosses(&cut, 1, a, b));
    int same[3] = {0, 0, 1};
    long degenerate = sm_cut_triangle(&cut, same);
    assert_int_equal(degenerate, 2);
    assert_false(sm_cut_crosses(&cut, 1, a, b));
    sm_cut_free(&cut);
}

/* Triangles and segments that lie in one plane but for rounding, apart from each other. */
TEST(what_lies_in_the_plane_of_a_far_triangle_is_not_cut)
{
    long apart = 0;
    for (int trial = 0; trial < 20000; trial++) {
        SmCut cut;
        double place[5][3], low = INFINITY, high = -INFINITY, least = INFINITY, most = -INFINITY;
        for (int i = 0; i < 5; i++) {
            double along = floor(random_between(&seed, 0, 6)),
                   up = floor(random_between(&seed, 0, 8));
            place[i][0] = -0.39788157 + 0.98360069 * 2 * along;
            place[i][1] = 3.68959300 - 0.98360069 * along;
            place[i][2] = 1.28073174 + 0.98360069 * up;
            if (i < 3) low = fmin(low, up), high = fmax(high, up);
            if (i >= 3) least = fmin(least, up), most = fmax(most, up);
        }
        if (most >= low && least <= high) continue;
        sm_cut_init(&cut, 4);
        for (int i = 0; i < 3; i++) sm_cut_vertex(&cut, place[i]);
        sm_cut_triangle(&cut, (int[3]){0, 1, 2});
        assert_false(sm_cut_crosses(&cut, 0, place[3], place[4]));
        sm_cut_free(&cut);
        apart++;
    }
    assert_true(apart > 1000);
}

/* Which side of the diagonal a place is on, however near. */
TEST(sides_are_exact)
{
    for (int n = 0; n < 32 * 32; n++) {
        int i = n % 32, j = n / 32, wanted = (i < j) - (i > j);
        const double x = 0.5 + i * 0x1p-53, y = 0.5 + j * 0x1p-53;
        assert_int_equal(
            sm_orient2((double[]){x, y}, (double[]){12.1, 12.1}, (double[]){24.3, 24.3}), wanted);
        assert_int_equal(sm_orient3((double[]){x, y, 0.1}, (double[]){12, 12, 0.3},
                                    (double[]){24, 24, 7}, (double[]){24, 24, 0.7}),
                         -wanted);
    }
}
