#include "specimen.h"

#include <math.h>

#define FIELD(kind, member) BENCH_FIELD(BenchSpecimen, kind, member)

const BenchField *bench_specimen_fields(int *count)
{
    static const BenchField fields[] = {
        FIELD(BENCH_INT, index),
        FIELD(BENCH_TEXT, engine),
        FIELD(BENCH_INT, w),
        FIELD(BENCH_DOUBLE, epsilon),
        FIELD(BENCH_INT, across),
        FIELD(BENCH_INT, aspect),
        FIELD(BENCH_DOUBLE, spacing),
        FIELD(BENCH_DOUBLE, h),
        FIELD(BENCH_TEXT, set),
        FIELD(BENCH_BOOL, wide),
        FIELD(BENCH_BOOL, valid),
        FIELD(BENCH_TEXT, reason),
        FIELD(BENCH_LONG, particles),
        FIELD(BENCH_DOUBLE, frequency),
        FIELD(BENCH_DOUBLE, loss),
        FIELD(BENCH_DOUBLE, load),
        FIELD(BENCH_DOUBLE, sag),
        FIELD(BENCH_DOUBLE, unrest),
        FIELD(BENCH_DOUBLE, linear_to),
        FIELD(BENCH_DOUBLE, young),
        FIELD(BENCH_DOUBLE, spread),
        FIELD(BENCH_DOUBLE, young_euler),
        FIELD(BENCH_DOUBLE, young_timoshenko),
        FIELD(BENCH_DOUBLE, young_meshless),
        FIELD(BENCH_DOUBLE, wall),
    };
    *count = (int)(sizeof fields / sizeof fields[0]);
    return fields;
}

static void forget(double young[BENCH_YOUNGS])
{
    for (int i = 0; i < BENCH_YOUNGS; i++) young[i] = NAN;
}

BenchSpecimen bench_specimen_none(void)
{
    BenchSpecimen none = {.load = NAN,
                          .sag = NAN,
                          .unrest = NAN,
                          .linear_to = NAN,
                          .young = NAN,
                          .spread = NAN,
                          .wall = NAN};
    for (int k = 0; k < BENCH_TONES; k++) none.frequency[k] = none.loss[k] = NAN;
    forget(none.young_euler);
    forget(none.young_timoshenko);
    forget(none.young_meshless);
    return none;
}

void bench_specimen_judge(const BenchIdeal ideal[BENCH_MODELS], double thickness, double density,
                          BenchSpecimen *specimen)
{
    double *const young[BENCH_MODELS] = {specimen->young_euler, specimen->young_timoshenko,
                                         specimen->young_meshless};
    double length = specimen->aspect * thickness, unit = density * thickness * thickness;
    for (int m = 0; m < BENCH_MODELS; m++) {
        forget(young[m]);
        if (!ideal[m].there || !specimen->valid) continue;
        young[m][0] = unit * ideal[m].sag * specimen->load / (specimen->sag * length);
        for (int k = 0; k < BENCH_TONES; k++) {
            double omega = 6.283185307179586 * specimen->frequency[k];
            young[m][1 + k] = unit * omega * omega / ideal[m].square[k];
        }
    }
    const double *by = young[ideal[BENCH_MESHLESS].there ? BENCH_MESHLESS : BENCH_TIMOSHENKO];
    double low = INFINITY, high = 0;
    for (int i = 0; i < BENCH_YOUNGS; i++) {
        low = fmin(low, by[i]);
        high = fmax(high, by[i]);
    }
    specimen->young = sqrt(by[0] * by[1]);
    specimen->spread = specimen->valid ? high / low - 1 : NAN;
}
