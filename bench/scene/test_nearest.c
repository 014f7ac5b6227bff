

#include "nearest.h"

#include "../../lib/test_frame.h"
#include "../../lib/test_random.h"

static double square(const double a[3], const double b[3])
{
    double sum = 0;
    for (int d = 0; d < 3; d++) sum += (a[d] - b[d]) * (a[d] - b[d]);
    return sum;
}

/* The tree's answer is as near as the nearest of all, ties to the lower number. */
TEST(agrees_with_looking_at_all)
{
    static double point[400][3];
    unsigned seed = 7;
    for (long count = 1; count <= 400; count += count < 20 ? 1 : 95) {
        int grid = count % 2 ? 5 : 1000; /* a coarse grid has many equal coordinates */
        for (long i = 0; i < count; i++)
            for (int d = 0; d < 3; d++) point[i][d] = random_int(&seed, grid);
        BenchNearest nearest;
        bench_nearest_create((const double(*)[3])point, count, &nearest);
        for (int trial = 0; trial < 200; trial++) {
            double place[3];
            for (int d = 0; d < 3; d++) place[d] = random_int(&seed, 2 * grid) - grid / 2;
            long best = 0;
            for (long i = 1; i < count; i++)
                if (square(point[i], place) < square(point[best], place)) best = i;
            assert_int_equal(bench_nearest_find(&nearest, place), best);
        }
        bench_nearest_free(&nearest);
    }
}
