#include "gauss_rule.h"

#include <gsl/gsl_integration.h>

void ref_gauss_rule(int order, double *at, double *weight)
{
    gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc((size_t)order);
    for (int n = 0; n < order; n++)
        gsl_integration_glfixed_point(-0.5, 0.5, (size_t)n, at + n, weight + n, table);
    gsl_integration_glfixed_table_free(table);
}
