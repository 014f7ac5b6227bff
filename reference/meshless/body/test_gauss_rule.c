/* Gauss points: of the orders that bodies are integrated by GSL's, bit for bit; of all they
 * integrate what they are to. */
#include "gauss_rule.h"

#include <gsl/gsl_integration.h>
#include <math.h>

#include "../../../lib/test_frame.h"

enum { USED = 4, MOST = 20 };

TEST(polynomials_are_integrated)
{
    for (int order = 1; order <= MOST; order++) {
        double at[MOST], weight[MOST];
        ref_gauss_rule(order, at, weight);
        for (int degree = 0; degree < 2 * order; degree++) {
            double sum = 0, exact = degree % 2 ? 0 : pow(0.5, degree) / (degree + 1);
            for (int n = 0; n < order; n++) sum += weight[n] * pow(at[n], degree);
            if (!(fabs(sum - exact) < 1e-15))
                fail_msg("%d of x^%d: %g", order, degree, sum - exact);
        }
        for (int n = 1; n < order; n++) assert_true(at[n] > at[n - 1]);
    }
}

TEST(it_is_the_one_of_tables)
{
    for (int order = 1; order <= USED; order++) {
        double at[USED], weight[USED], x, w;
        ref_gauss_rule(order, at, weight);
        gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc((size_t)order);
        for (int n = 0; n < order; n++) {
            gsl_integration_glfixed_point(-0.5, 0.5, (size_t)n, &x, &w, table);
            assert_true(x == at[n] && w == weight[n]);
        }
        gsl_integration_glfixed_table_free(table);
    }
}

TEST(the_rule_of_three_is_at_hand)
{
    double at[3], weight[3];
    ref_gauss_rule(3, at, weight);
    assert_memory_equal(at, ref_gauss_three_at, sizeof at);
    assert_memory_equal(weight, ref_gauss_three_weight, sizeof weight);
}
