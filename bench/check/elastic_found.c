#include "elastic_found.h"

#include <math.h>
#include <stdio.h>

static const struct {
    const char *name;
    double tolerance;
} checks[BENCH_ELASTIC_CHECKS] = {
    {"shape functions", 1e-9},
    {"their gradients", 1e-8},
    {"mass", 1e-9},
    {"rigid motions", 1e-8},
    {"constant strains", 1e-8},
    {"orthogonality", 1e-8},
    {"modes' residuals", 1e-7},
    {"rigid modes", 1e-6},
    {"modes missed", 1e-6},
    {"small displacements", 1e-5},
    {"step", 1e-5},
    {"constraints", 1e-6},
    {"points", 1e-5},
    {"energy's growth", 1e-10},
};

void bench_elastic_note(BenchElasticFound *found, BenchElasticCheck check, double value)
{
    double *most = &found->found[check];
    if (!(value <= *most)) *most = isnan(*most) ? NAN : value;
    if (!isfinite(*most)) *most = NAN;
}

bool bench_elastic_verdict(const BenchElasticFound *found, size_t size, char *reason)
{
    for (int c = 0; c < BENCH_ELASTIC_CHECKS; c++) {
        if (found->found[c] <= checks[c].tolerance) continue;
        if (isnan(found->found[c]))
            snprintf(reason, size, "%s: not finite", checks[c].name);
        else
            snprintf(reason, size, "%s: %.3g off; at most %g allowed", checks[c].name,
                     found->found[c], checks[c].tolerance);
        return false;
    }
    return true;
}

void bench_elastic_text(const BenchElasticFound *found, size_t size, char *text)
{
    size_t used = 0;
    for (int c = 0; c < BENCH_ELASTIC_CHECKS && used < size; c++)
        used += (size_t)snprintf(text + used, size - used, "%s%s %.1e",
                                 c ? ", " : "off by: ", checks[c].name, found->found[c]);
}
