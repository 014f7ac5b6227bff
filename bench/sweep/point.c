#include "point.h"

#include <math.h>

#define FIELD(kind, member) BENCH_FIELD(BenchPoint, kind, member)

const BenchField *bench_point_fields(int *count)
{
    static const BenchField fields[] = {
        FIELD(BENCH_INT, index),
        FIELD(BENCH_TEXT, engine),
        FIELD(BENCH_DOUBLE, w),
        FIELD(BENCH_DOUBLE, epsilon),
        FIELD(BENCH_BOOL, valid),
        FIELD(BENCH_TEXT, reason),
        FIELD(BENCH_LONG, particles),
        FIELD(BENCH_LONG, regions),
        FIELD(BENCH_DOUBLE, width_cells),
        FIELD(BENCH_DOUBLE, total_ms),
        FIELD(BENCH_DOUBLE, total_low_ms),
        FIELD(BENCH_DOUBLE, total_high_ms),
        {BENCH_FIELD_AS(BenchPoint, BENCH_DOUBLE, stage_ms, "stage_ms"), .stages = true},
        FIELD(BENCH_DOUBLE, build_seconds),
        FIELD(BENCH_LONG, bytes),
        FIELD(BENCH_DOUBLE, summation_nodes),
        FIELD(BENCH_LONG, most_summation),
        FIELD(BENCH_LONG, parts),
        FIELD(BENCH_DOUBLE, goal_error),
        FIELD(BENCH_DOUBLE, goal_rms),
        FIELD(BENCH_DOUBLE, goal_most),
        FIELD(BENCH_TEXT, goal_why),
        FIELD(BENCH_DOUBLE, relaxation),
        FIELD(BENCH_DOUBLE, sag),
        FIELD(BENCH_DOUBLE, frequency),
        FIELD(BENCH_TEXT, beam_why),
        FIELD(BENCH_INT, full_w),
        FIELD(BENCH_DOUBLE, path_rms),
        FIELD(BENCH_DOUBLE, path_most),
        FIELD(BENCH_TEXT, path_why),
        FIELD(BENCH_BOOL, front),
        FIELD(BENCH_DOUBLE, wall),
        FIELD(BENCH_INT, rank),
        FIELD(BENCH_TEXT, host),
        FIELD(BENCH_TEXT, utc),
        FIELD(BENCH_INT, samples),
    };
    *count = (int)(sizeof fields / sizeof fields[0]);
    return fields;
}

BenchPoint bench_point_none(void)
{
    BenchPoint point = {.width_cells = NAN,
                        .total_ms = NAN,
                        .total_low_ms = NAN,
                        .total_high_ms = NAN,
                        .build_seconds = NAN,
                        .summation_nodes = NAN,
                        .goal_error = NAN,
                        .goal_rms = NAN,
                        .goal_most = NAN,
                        .relaxation = NAN,
                        .sag = NAN,
                        .frequency = NAN,
                        .path_rms = NAN,
                        .path_most = NAN};
    for (int s = 0; s < SM_STAGES; s++) point.stage_ms[s] = NAN;
    for (int i = 0; i < BENCH_POINT_SAMPLES; i++) point.sample[i] = NAN;
    return point;
}
