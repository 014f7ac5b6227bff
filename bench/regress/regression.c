#include "regression.h"

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"
#include "../../lib/printable.h"
#include "../store/export.h"
#include "../system/statistic.h"
#include "../table/grid.h"

const char *const bench_regression_formats[] = {"text", "markdown", "json", NULL};

void bench_regression_remark(BenchRegression *found, const char *format, ...)
{
    if (found->remarks == BENCH_REMARKS) return;
    va_list values;
    va_start(values, format);
    vsnprintf(found->remark[found->remarks++], BENCH_REMARK, format, values);
    va_end(values);
}

/* Appends the words of `flags` that `other` has not, but -Werror, which changes no program. */
static void list_flags(const char *flags, const char *other, size_t size, char *list)
{
    char copy[512], padded[520], word[520], *rest = copy;
    list[0] = '\0';
    snprintf(copy, sizeof copy, "%s", flags);
    snprintf(padded, sizeof padded, " %s ", other);
    for (char *flag; (flag = strtok_r(rest, " ", &rest));) {
        snprintf(word, sizeof word, " %s ", flag);
        if (strcmp(flag, "-Werror") != 0 && !strstr(padded, word))
            sm_append(list, size, " %s", flag);
    }
}

static void compare_flags(BenchRegression *found)
{
    const char *old = found->machine[BENCH_OLD].flags, *new = found->machine[BENCH_NEW].flags;
    char only_old[128], only_new[128];
    if (!bench_machine_known(old) || !bench_machine_known(new)) return;
    list_flags(old, new, sizeof only_old, only_old);
    list_flags(new, old, sizeof only_new, only_new);
    if (only_old[0] || only_new[0])
        bench_regression_remark(found, "flags differ: only the baseline has%s; only this build%s",
                                only_old[0] ? only_old : " none", only_new[0] ? only_new : " none");
}

static void remark_difference(void *found, const char *what, const char *old, const char *new)
{
    bench_regression_remark(found, "%s differs: %.120s, now %.120s", what, old, new);
}

void bench_regression_environment(BenchRegression *found)
{
    const BenchMachine *old = &found->machine[BENCH_OLD], *new = &found->machine[BENCH_NEW];
    bench_machine_differences(old, new, remark_difference, found);
    compare_flags(found);
    if (old->cores && old->cores != new->cores)
        bench_regression_remark(found, "cores differ: %d, now %d", old->cores, new->cores);
    if (old->git_dirty)
        bench_regression_remark(found, "the baseline was built from changed sources of %.12s",
                                old->git_commit);
}

/* The one to name: the first that is INVALID, else the slowest of those that are slower, of totals
 * (`stages`: of a scene's stages); NULL: none. */
static const BenchComparison *find_worst(const BenchRegression *found, bool stages)
{
    const BenchComparison *slowest = NULL;
    for (int i = 0; i < found->count; i++) {
        const BenchComparison *one = &found->list[i];
        if (one->verdict == BENCH_INCORRECT) return one;
        bool stage = one->value > 0 && one->value < BENCH_TIMES;
        if (one->verdict == BENCH_SLOWER && stage == stages &&
            (!slowest || one->ratio > slowest->ratio))
            slowest = one;
    }
    return slowest;
}

/* The step first: what is slower in a stage alone may be nothing of it. */
static void name_slowest(const BenchRegression *found, size_t size, char *line)
{
    const BenchComparison *stage = find_worst(found, true), *total = find_worst(found, false);
    for (int i = 0; stage && !total && i < found->count; i++)
        if (found->list[i].samples == stage->samples && !found->list[i].value)
            total = &found->list[i];
    if (total)
        sm_append(line, size, ", most in %s %s: %.3f times (%.3f to %.3f)", total->samples->scene,
                  bench_value_name(total->samples, total->value), total->ratio, total->low,
                  total->high);
    if (stage)
        sm_append(line, size, "%s %s %s: %.3f times", total ? ", of stages" : ", most in",
                  stage->samples->scene, bench_value_name(stage->samples, stage->value),
                  stage->ratio);
}

void bench_regression_summary(const BenchRegression *found, size_t size, char *line)
{
    int had[BENCH_COMPARISONS] = {0};
    for (int i = 0; i < found->count; i++) had[found->list[i].verdict]++;
    const char *of = found->params->by_cycles ? "scenes" : "times";
    if (had[BENCH_INCORRECT]) {
        const BenchComparison *worst = find_worst(found, false);
        snprintf(line, size, "INVALID: %s: %s", worst->samples->scene, worst->reason);
    } else if (had[BENCH_SLOWER]) {
        snprintf(line, size, "SLOWER in %d of %d %s", had[BENCH_SLOWER], found->count, of);
        name_slowest(found, size, line);
    } else if (found->count == had[BENCH_NO_BASELINE])
        snprintf(line, size, "no baseline: nothing could be compared");
    else if (had[BENCH_SAME] + had[BENCH_FASTER] == 0)
        snprintf(line, size, "no verdict on any of %d %s", found->count, of);
    else
        snprintf(line, size, "not slower in %d of %d %s", had[BENCH_SAME] + had[BENCH_FASTER],
                 found->count, of);
    int unsure = had[BENCH_TOO_NOISY] + had[BENCH_TOO_FEW];
    if (!unsure) return;
    char remedy[64] = "more --rounds";
    if (found->stored[0])
        strcpy(remedy, "files with more repeats");
    else if (had[BENCH_TOO_FEW])
        snprintf(remedy, sizeof remedy, "at least --rounds %d",
                 bench_comparisons_rounds(found->list, found->count, found->params));
    if (unsure < found->count) sm_append(line, size, "; no verdict on %d", unsure);
    sm_append(line, size, " (%d too noisy, %d with too few samples): take %s%s",
              had[BENCH_TOO_NOISY], had[BENCH_TOO_FEW], remedy,
              had[BENCH_TOO_NOISY] ? ", or a quieter machine" : "");
}

/* ---- for people */

static void percent_text(double share, char text[BENCH_GRID_TEXT])
{
    if (isfinite(share))
        snprintf(text, BENCH_GRID_TEXT, "%.1f%%", 100 * share);
    else
        strcpy(text, "-");
}

/* Of a scene's first line: new over old of what was counted; NaN: not known. */
static double counter_ratio(const BenchComparison *one, BenchCounter counter)
{
    const BenchSide *side = one->samples->side;
    if (one->value && one->value < BENCH_TIMES) return NAN;
    return bench_side_counter(&side[BENCH_NEW], counter) /
           bench_side_counter(&side[BENCH_OLD], counter);
}

static bool has_counter(const BenchRegression *found, BenchCounter counter)
{
    for (int i = 0; i < found->count && found->counters; i++)
        if (isfinite(counter_ratio(&found->list[i], counter))) return true;
    return false;
}

static void add_line(BenchGrid *grid, const BenchComparison *one, const BenchRegression *found)
{
    BenchGridLine *line = bench_grid_add(grid);
    int c = 0;
    bool compared = one->verdict != BENCH_INCORRECT && one->verdict != BENCH_NO_BASELINE;
    snprintf((*line)[c++], BENCH_GRID_TEXT, "%s", one->samples->scene);
    snprintf((*line)[c++], BENCH_GRID_TEXT, "%s",
             compared ? bench_value_name(one->samples, one->value) : "-");
    for (int b = 0; b < BENCH_BUILDS; b++) bench_grid_number(one->amount[b], (*line)[c++]);
    char(*text)[BENCH_GRID_TEXT] = &(*line)[c];
    for (int i = 0; i < 4; i++) strcpy(text[i], "-");
    if (compared) {
        snprintf(text[0], BENCH_GRID_TEXT, "%.3f", one->ratio);
        snprintf(text[1], BENCH_GRID_TEXT, "%.3f..%.3f", one->low, one->high);
        snprintf(text[2], BENCH_GRID_TEXT, one->adjusted < 0.001 ? "<0.001" : "%.3f",
                 one->adjusted);
        percent_text(one->threshold, text[3]);
    }
    strcpy(text[4], bench_comparison_name(one->verdict));
    for (int k = 0, column = 5; k < BENCH_COUNTERS; k++) {
        if (!has_counter(found, (BenchCounter)k)) continue;
        double counted = counter_ratio(one, (BenchCounter)k);
        if (isfinite(counted)) snprintf(text[column], BENCH_GRID_TEXT, "%.4f", counted);
        column++;
    }
}

static void fill_grid(const BenchRegression *found, BenchGrid *grid)
{
    bool cycles = found->params->by_cycles;
    const char *const headings[] = {"scene",
                                    cycles ? "counter" : "time",
                                    cycles ? "old" : "old ms",
                                    cycles ? "new" : "new ms",
                                    "new/old",
                                    "95%",
                                    "p",
                                    "threshold",
                                    "verdict"};
    *grid = (BenchGrid){0};
    for (int i = 0; i < 9; i++) bench_grid_column(grid, headings[i], i < 2 || i == 8);
    for (int c = 0; c < BENCH_COUNTERS; c++)
        if (has_counter(found, (BenchCounter)c))
            bench_grid_column(grid, bench_counter_names[c], false);
    for (int i = 0; i < found->count; i++) add_line(grid, &found->list[i], found);
}

static void write_start(FILE *file, const BenchRegression *found)
{
    if (found->params->interleaved)
        fprintf(file,
                "Against %s, interleaved: %d round%s of two processes of each build and scene",
                found->baseline, found->params->rounds, found->params->rounds > 1 ? "s" : "");
    else if (found->stored[0])
        fprintf(file, "%s against %s, as stored: repeats are the samples", found->stored,
                found->baseline);
    else
        fprintf(file, "Against %s, as stored: %d processes of this build and scene",
                found->baseline, 2 * found->params->rounds);
    fprintf(file, "; %.0f s.\n\n", found->seconds);
}

/* A line on the outliers of a scene, if it has any; `first` is its first comparison. */
static void write_outliers(FILE *file, const BenchRegression *found, int first, const char *bullet)
{
    const BenchAbScene *samples = found->list[first].samples;
    bool any = false;
    for (int i = first; i < found->count && found->list[i].samples == samples; i++) {
        const BenchComparison *one = &found->list[i];
        int old = one->outliers[BENCH_OLD], new = one->outliers[BENCH_NEW];
        if (!old && !new) continue;
        if (!any)
            fprintf(file, "%s%s: outliers, kept, old+new of %d+%d:", bullet, samples->scene,
                    samples->side[BENCH_OLD].count, samples->side[BENCH_NEW].count);
        fprintf(file, "%s %s %d+%d", any ? "," : "", bench_value_name(one->samples, one->value),
                old, new);
        any = true;
    }
    if (any) fputc('\n', file);
}

/* What is other by its interval, and is not called so: it is little, or by chance. */
static void write_small(FILE *file, const BenchRegression *found, const BenchComparison *one,
                        const char *bullet)
{
    bool total = !one->value || one->value >= BENCH_TIMES;
    if (!total || one->verdict != BENCH_SAME || (one->low <= 1 && one->high >= 1)) return;
    bool small = fabs(log(one->ratio)) <= log1p(one->threshold);
    fprintf(file, "%s%s: %s %.1f%% %s, %s the threshold of %.1f%%%s\n", bullet, one->samples->scene,
            bench_value_name(one->samples, one->value), 100 * fabs(one->ratio - 1),
            one->ratio > 1 ? "slower" : "faster", small ? "below" : "beyond", 100 * one->threshold,
            small                        ? ""
            : found->params->interleaved ? ", but not surely: take more --rounds"
                                         : ", but not surely");
}

static void write_remarks(FILE *file, const BenchRegression *found, const char *bullet)
{
    for (int i = 0; i < found->count; i++) {
        const BenchComparison *one = &found->list[i];
        if (one->reason[0]) fprintf(file, "%s%s: %s\n", bullet, one->samples->scene, one->reason);
        write_small(file, found, one, bullet);
        if (i == 0 || found->list[i - 1].samples != one->samples)
            write_outliers(file, found, i, bullet);
    }
    for (int i = 0; i < found->remarks; i++) fprintf(file, "%s%s\n", bullet, found->remark[i]);
}

static void write_text(FILE *file, const BenchRegression *found, bool markdown)
{
    BenchGrid grid;
    char line[512];
    fill_grid(found, &grid);
    write_start(file, found);
    bench_grid_whole(file, &grid, markdown ? BENCH_GRID_MARKDOWN : BENCH_GRID_PLAIN);
    bench_grid_free(&grid);
    fputc('\n', file);
    write_remarks(file, found, markdown ? "- " : "  ");
    bench_regression_summary(found, sizeof line, line);
    fprintf(file, markdown ? "\n**%s**\n" : "%s\n", line);
}

/* ---- JSON */

/* One build's part of a comparison. */
static json_t *side_json(const BenchComparison *one, BenchBuild build)
{
    const BenchSide *side = &one->samples->side[build];
    json_t *samples = json_array(), *rounds = json_array(), *outliers = json_array();
    for (int i = 0; i < side->count; i++) {
        json_array_append_new(samples, bench_json_number(side->value[one->value][i]));
        json_array_append_new(rounds, json_integer(side->round[i]));
        if (one->outlier[build] && one->outlier[build][i])
            json_array_append_new(outliers, json_integer(i));
    }
    bool timed = one->value < BENCH_TIMES;
    json_t *object = json_pack("{s:o, s:o, s:o, s:o, s:o}", "ms",
                               bench_json_number(timed ? one->amount[build] : NAN), "samples",
                               samples, "rounds", rounds, "outliers", outliers, "self_difference",
                               bench_json_number(one->self[build]));
    for (int c = 0; c < BENCH_COUNTERS; c++)
        json_object_set_new(object, bench_counter_names[c],
                            bench_json_number(one->value && timed
                                                  ? NAN
                                                  : bench_side_counter(side, (BenchCounter)c)));
    return object;
}

static json_t *comparison_json(const BenchComparison *one)
{
    json_t *reason = one->reason[0] ? bench_json_text(one->reason) : json_null();
    return json_pack(
        "{s:o, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "scene",
        bench_json_text(one->samples->scene), "time", bench_value_name(one->samples, one->value),
        "verdict", bench_comparison_name(one->verdict), "reason", reason, "ratio",
        bench_json_number(one->ratio), "low", bench_json_number(one->low), "high",
        bench_json_number(one->high), "p", bench_json_number(one->p), "p_adjusted",
        bench_json_number(one->adjusted), "threshold", bench_json_number(one->threshold), "old",
        side_json(one, BENCH_OLD), "new", side_json(one, BENCH_NEW));
}

static void write_json(FILE *file, const BenchRegression *found)
{
    char line[512];
    json_t *list = json_array(), *remarks = json_array();
    bench_regression_summary(found, sizeof line, line);
    for (int i = 0; i < found->count; i++)
        json_array_append_new(list, comparison_json(&found->list[i]));
    for (int i = 0; i < found->remarks; i++)
        json_array_append_new(remarks, bench_json_text(found->remark[i]));
    bench_json_write(file,
                     json_pack("{s:i, s:o, s:i, s:o, s:o, s:b, s:i, s:o, s:o, s:o, s:{s:o, s:o}}",
                               "schema", 1, "verdict", bench_json_text(line), "exit_code",
                               bench_comparisons_exit(found->list, found->count), "baseline",
                               bench_json_text(found->baseline), "stored",
                               found->stored[0] ? bench_json_text(found->stored) : json_null(),
                               "interleaved", (int)found->params->interleaved, "rounds",
                               found->params->rounds, "seconds", bench_json_number(found->seconds),
                               "comparisons", list, "remarks", remarks, "environments", "old",
                               bench_json_machine(&found->machine[BENCH_OLD]), "new",
                               bench_json_machine(&found->machine[BENCH_NEW])));
}

void bench_regression_write(FILE *file, BenchRegressionFormat format, const BenchRegression *found)
{
    switch (format) {
    case BENCH_REGRESSION_TEXT:
    case BENCH_REGRESSION_MARKDOWN:
        write_text(file, found, format == BENCH_REGRESSION_MARKDOWN);
        break;
    case BENCH_REGRESSION_JSON:
        write_json(file, found);
        break;
    }
}
