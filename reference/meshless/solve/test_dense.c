/* Small systems: what GSL finds and what the page's own code finds are the same, and right. */
#include <math.h>
#include <stdlib.h>

#include "../../../lib/test_frame.h"
#include "../../../lib/test_random.h"
#include "test_dense_plain.h"

enum { MOST = 40 };

/* A random matrix, or that times its transpose. */
static void fill(int n, bool definite, unsigned *seed, double *A)
{
    double B[MOST * MOST];
    for (int i = 0; i < n * n; i++) B[i] = A[i] = random_between(seed, -1, 1);
    for (int i = 0; i < n && definite; i++)
        for (int j = 0; j < n; j++) {
            A[n * i + j] = i == j ? 0.1 : 0;
            for (int k = 0; k < n; k++) A[n * i + j] += B[n * i + k] * B[n * j + k];
        }
}

TEST(both_find_what_was_put_in)
{
    unsigned seed = 7;
    for (int n = 1; n <= MOST; n++)
        for (int kind = 0; kind < 4; kind++) {
            bool definite = kind % 2, plain = kind / 2;
            double A[MOST * MOST], x[MOST], b[MOST] = {0}, most = 0;
            fill(n, definite, &seed, A);
            for (int i = 0; i < n; i++) x[i] = random_between(&seed, -1, 1);
            for (int i = 0; i < n; i++)
                for (int j = 0; j < n; j++) b[i] += A[n * i + j] * x[j];
            assert_true(definite ? (plain ? plain_definite : ref_dense_definite)(n, A, b)
                                 : (plain ? plain_any : ref_dense_any)(n, A, b));
            for (int i = 0; i < n; i++) most = fmax(most, fabs(b[i] - x[i]));
            if (!(most < 1e-9)) fail_msg("%d unknowns, %d: off by %g", n, kind, most);
        }
}

TEST(matrices_that_are_not_so_are_told)
{
    for (int plain = 0; plain < 2; plain++) {
        double bent[4] = {1, 2, 2, 1}, none[4] = {1, 2, 2, 4}, b[2] = {1, 1};
        assert_false((plain ? plain_definite : ref_dense_definite)(2, bent, b));
        assert_false((plain ? plain_any : ref_dense_any)(2, none, b));
    }
}
