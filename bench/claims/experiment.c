#include "experiment.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "../check/runner_check.h"
#include "../measure/measure.h"

const char *const bench_without_names[] = {
    "nothing", "nodes", "bases", "summation_nodes", "reach", "collide", "creep", "widths", NULL};

/* ---- curves */

void bench_curve_begin(BenchCurve *curve, const char *x_name, const char *y_name)
{
    *curve = (BenchCurve){.valid = true, .row = -1, .experiment = -1};
    snprintf(curve->x_name, sizeof curve->x_name, "%s", x_name);
    snprintf(curve->y_name, sizeof curve->y_name, "%s", y_name);
}

void bench_curve_add(BenchCurve *curve, double x, double y, double low, double high)
{
    if (curve->points == BENCH_CURVE_POINTS) return;
    curve->x[curve->points] = x;
    curve->y[curve->points] = y;
    curve->low[curve->points] = low;
    curve->high[curve->points++] = high;
}

void bench_curve_exact(BenchCurve *curve, double x, double y)
{
    bench_curve_add(curve, x, y, y, y);
}

BenchInterval bench_curve_interval(const double *value, int count, double share, int points)
{
    return bench_quantile_interval(value, count, share, 1 - 0.05 / points);
}

void bench_curve_sample(BenchCurve *curve, double x, const double *value, int count, double share,
                        int points)
{
    BenchInterval found = bench_curve_interval(value, count, share, points);
    bench_curve_add(curve, x, found.value, found.low, found.high);
}

void bench_curve_fail(BenchCurve *curve, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    if (curve->valid) vsnprintf(curve->reason, sizeof curve->reason, format, values);
    va_end(values);
    curve->valid = false;
}

void bench_curve_check(BenchCurve *curve, const BenchRunner *runner)
{
    char reason[160];
    if (!bench_check_runner(runner, sizeof reason, reason))
        bench_curve_fail(curve, "w = %d: %s", runner->scene->params.w, reason);
}

int bench_range_numbers(const BenchRange *range, int *number)
{
    int count = 0;
    for (int p = 0; p < range->points; p++) {
        double share = range->points > 1 ? p / (range->points - 1.0) : 0;
        int next = (int)lround(range->from * pow((double)range->to / range->from, share));
        if (count == 0 || next > number[count - 1]) number[count++] = next;
    }
    return count;
}

/* ---- the lab */

void bench_lab_keep(BenchLab *lab, const BenchCurve *curve)
{
    lab->curve = sm_realloc(lab->curve, (size_t)lab->curves + 1, sizeof *lab->curve);
    lab->curve[lab->curves++] = *curve;
}

int bench_lab_row(BenchLab *lab, const BenchRow *row, const char *name, int steps_per_frame)
{
    size_t rows = (size_t)lab->rows + 1;
    lab->row = sm_realloc(lab->row, rows, sizeof *lab->row);
    lab->origin = sm_realloc(lab->origin, rows, sizeof *lab->origin);
    lab->row[lab->rows] = *row;
    snprintf(lab->origin[lab->rows].name, sizeof lab->origin->name, "%s", name);
    lab->origin[lab->rows].steps_per_frame = steps_per_frame;
    return lab->rows++;
}

void bench_lab_fail(BenchLab *lab, const char *name, const char *reason)
{
    lab->failure = sm_realloc(lab->failure, (size_t)lab->failures + 1, sizeof *lab->failure);
    snprintf(lab->failure[lab->failures].name, sizeof lab->failure->name, "%s", name);
    snprintf(lab->failure[lab->failures++].reason, sizeof lab->failure->reason, "%s", reason);
}

int bench_lab_repeats(const BenchLab *lab)
{
    return lab->quick ? 9 : 31;
}

void bench_lab_free(BenchLab *lab)
{
    bench_rows_free(lab->row, lab->rows);
    free(lab->origin);
    free(lab->curve);
    free(lab->failure);
    *lab = (BenchLab){.quick = lab->quick, .threads = lab->threads, .seed = lab->seed};
}
