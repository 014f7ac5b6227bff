#include "cloud.h"

#include <math.h>

#include "../../../lib/test_frame.h"
#include "../../../lib/test_random.h"

enum { MOST = 400, NEAR = 3 };

/* The nearest points are as near as the nearest of all, nearest first, and a ball has those in it.
 */
TEST(agrees_with_looking_at_all)
{
    static double point[MOST][3], normal[MOST][3];
    unsigned seed = 7;
    for (long count = 1; count <= MOST; count += count < 20 ? 1 : 95) {
        int grid = count % 2 ? 5 : 1000; /* a coarse grid has many equal coordinates */
        for (long i = 0; i < count; i++)
            for (int d = 0; d < 3; d++) point[i][d] = random_int(&seed, grid);
        const RefPoints points = {.count = count, .position = point, .normal = normal};
        RefCloud cloud;
        ref_cloud_create(&points, &cloud);
        for (int trial = 0; trial < 100; trial++) {
            double place[3], distance[NEAR];
            long near[NEAR], within[MOST];
            for (int d = 0; d < 3; d++) place[d] = random_int(&seed, 2 * grid) - grid / 2;
            int found = ref_cloud_nearest(&cloud, place, NEAR, near, distance);
            assert_int_equal(found, count < NEAR ? count : NEAR);
            for (int k = 0; k < found; k++) {
                long nearer = 0;
                for (long i = 0; i < count; i++)
                    nearer += sqrt(sm_square_between(point[i], place)) < distance[k];
                assert_true(nearer <= k && (k == 0 || distance[k] >= distance[k - 1]));
                assert_true(distance[k] == sqrt(sm_square_between(point[near[k]], place)));
            }
            const double radius = 0.25 * grid;
            long inside = 0;
            for (long i = 0; i < count; i++)
                inside += sm_square_between(point[i], place) <= radius * radius;
            assert_int_equal(ref_cloud_ball(&cloud, place, radius, MOST, within), inside);
            for (long i = 0; i < inside; i++)
                assert_true(sm_square_between(point[within[i]], place) <= radius * radius);
        }
        ref_cloud_free(&cloud);
    }
}

TEST_GROUP(NULL, NULL)
