/* Pivoted factors: LAPACK's and the page's own are the same, and the matrix again. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/test_frame.h"
#include "../../../lib/test_random.h"
#include "test_dense_plain.h"

enum { MOST = 60 };

/* B B^T of a random B, [n][rank]. */
static void fill(int n, int rank, unsigned *seed, double *A)
{
    double B[MOST * MOST];
    for (int i = 0; i < n * rank; i++) B[i] = random_between(seed, -1, 1);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            A[n * i + j] = 0;
            for (int k = 0; k < rank; k++) A[n * i + j] += B[rank * i + k] * B[rank * j + k];
        }
}

TEST(both_have_the_same_factor_which_is_the_matrix)
{
    unsigned seed = 11;
    for (int n = 1; n <= MOST; n++)
        for (int rank = 1; rank <= n; rank += 1 + n / 7) {
            double A[MOST * MOST], factor[2][MOST * MOST], most = 0, apart = 0;
            int order[2][MOST];
            fill(n, rank, &seed, A);
            for (int plain = 0; plain < 2; plain++) {
                memcpy(factor[plain], A, sizeof A);
                int found = (plain ? plain_semidefinite : ref_semidefinite)(n, factor[plain], 1e-10,
                                                                            order[plain]);
                assert_int_equal(found, rank);
            }
            assert_memory_equal(order[0], order[1], (size_t)rank * sizeof(int));
            for (int i = 0; i < n; i++) /* those past the rank may be in any order */
                for (int j = i; j < n && (rank == n || j < rank); j++) {
                    double again = 0;
                    for (int k = 0; k < rank && k <= i; k++) {
                        apart = fmax(apart, fabs(factor[0][n * k + j] - factor[1][n * k + j]));
                        again += factor[1][n * k + i] * factor[1][n * k + j];
                    }
                    most = fmax(most, fabs(again - A[n * order[1][i] + order[1][j]]));
                }
            if (!(most < 1e-12 * n)) fail_msg("%d of rank %d: off by %g", n, rank, most);
            if (!(apart < 1e-6)) fail_msg("%d of rank %d: %g apart", n, rank, apart);
        }
}

TEST(what_is_nothing_has_no_rank)
{
    double none[4] = {0};
    int order[2];
    assert_int_equal(ref_semidefinite(2, none, 0, order), 0);
    assert_int_equal(plain_semidefinite(2, none, 0, order), 0);
}
