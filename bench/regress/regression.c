#include "regression.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"
#include "../table/grid.h"

const char *const bench_regression_formats[] = {"text",  "markdown", "json",
                                                "junit", "gbench",   NULL};

void bench_regression_remark(BenchRegression *found, const char *format, ...)
{
    if (found->remarks == BENCH_REMARKS) return;
    va_list values;
    va_start(values, format);
    vsnprintf(found->remark[found->remarks++], BENCH_REMARK, format, values);
    va_end(values);
}

static bool known(const char *text)
{
    return text[0] && strcmp(text, "unknown") != 0;
}

/* Appends the words of `flags` that `other` has not, but -Werror, which changes no program. */
static void list_flags(const char *flags, const char *other, size_t size, char *list)
{
    char copy[512], padded[520], word[520], *rest = copy;
    size_t used = 0;
    list[0] = '\0';
    snprintf(copy, sizeof copy, "%s", flags);
    snprintf(padded, sizeof padded, " %s ", other);
    for (char *flag; (flag = strtok_r(rest, " ", &rest)) && used < size;) {
        snprintf(word, sizeof word, " %s ", flag);
        if (strcmp(flag, "-Werror") != 0 && !strstr(padded, word))
            used += (size_t)snprintf(list + used, size - used, " %s", flag);
    }
}

static void compare_flags(BenchRegression *found)
{
    const char *old = found->machine[BENCH_OLD].flags, *new = found->machine[BENCH_NEW].flags;
    char only_old[128], only_new[128];
    if (!known(old) || !known(new)) return;
    list_flags(old, new, sizeof only_old, only_old);
    list_flags(new, old, sizeof only_new, only_new);
    if (only_old[0] || only_new[0])
        bench_regression_remark(found, "flags differ: only the baseline has%s; only this build%s",
                                only_old[0] ? only_old : " none", only_new[0] ? only_new : " none");
}

void bench_regression_environment(BenchRegression *found)
{
    const BenchMachine *old = &found->machine[BENCH_OLD], *new = &found->machine[BENCH_NEW];
    const struct {
        const char *what, *old, *new;
    } text[] = {
        {"processor", old->cpu, new->cpu},          {"processor", old->cpu_model, new->cpu_model},
        {"compiler", old->compiler, new->compiler}, {"libraries", old->libraries, new->libraries},
        {"kernel", old->kernel, new->kernel},       {"governor", old->governor, new->governor},
        {"host", old->hostname, new->hostname},
    };
    for (size_t i = 0; i < sizeof text / sizeof *text; i++)
        if (known(text[i].old) && known(text[i].new) && strcmp(text[i].old, text[i].new) != 0)
            bench_regression_remark(found, "%s differs: %.120s, now %.120s", text[i].what,
                                    text[i].old, text[i].new);
    compare_flags(found);
    if (old->cores && old->cores != new->cores)
        bench_regression_remark(found, "cores differ: %d, now %d", old->cores, new->cores);
    if (old->git_dirty)
        bench_regression_remark(found, "the baseline was built from changed sources of %.12s",
                                old->git_commit);
}

/* The one to name: the first that is INVALID, else the one that is slowest; NULL: neither. */
static const BenchComparison *find_worst(const BenchRegression *found)
{
    const BenchComparison *slowest = NULL;
    for (int i = 0; i < found->count; i++) {
        const BenchComparison *one = &found->list[i];
        if (one->verdict == BENCH_INCORRECT) return one;
        if (one->verdict == BENCH_SLOWER && (!slowest || one->ratio > slowest->ratio))
            slowest = one;
    }
    return slowest;
}

void bench_regression_summary(const BenchRegression *found, size_t size, char *line)
{
    int had[BENCH_COMPARISONS] = {0}, used;
    for (int i = 0; i < found->count; i++) had[found->list[i].verdict]++;
    const BenchComparison *worst = find_worst(found);
    if (worst && worst->verdict == BENCH_INCORRECT)
        used = snprintf(line, size, "INVALID: %s: %s", worst->contest->scene, worst->reason);
    else if (worst)
        used = snprintf(line, size,
                        "SLOWER in %d of %d times, most in %s %s: %.3f times (%.3f to %.3f)",
                        had[BENCH_SLOWER], found->count, worst->contest->scene,
                        bench_time_name(worst->time), worst->ratio, worst->low, worst->high);
    else if (found->count == had[BENCH_NO_BASELINE])
        used = snprintf(line, size, "no baseline: nothing could be compared");
    else if (had[BENCH_SAME] + had[BENCH_FASTER] == 0)
        used = snprintf(line, size, "nothing could be judged, of %d times", found->count);
    else
        used = snprintf(line, size, "not slower in %d of %d times",
                        had[BENCH_SAME] + had[BENCH_FASTER], found->count);
    int unsure = had[BENCH_TOO_NOISY] + had[BENCH_TOO_FEW];
    if (!unsure || used < 0 || (size_t)used >= size) return;
    char remedy[64] = "more --rounds";
    if (had[BENCH_TOO_FEW])
        snprintf(remedy, sizeof remedy, "at least --rounds %d",
                 bench_comparisons_rounds(found->list, found->count, found->params));
    snprintf(line + used, size - (size_t)used,
             "; %d could not be judged (%d too noisy, %d too few samples): %s%s", unsure,
             had[BENCH_TOO_NOISY], had[BENCH_TOO_FEW], remedy,
             had[BENCH_TOO_NOISY] ? ", or a quieter machine" : "");
}

static void percent_text(double share, char text[BENCH_GRID_TEXT])
{
    if (isfinite(share))
        snprintf(text, BENCH_GRID_TEXT, "%.1f%%", 100 * share);
    else
        strcpy(text, "-");
}

static void instructions_text(const BenchComparison *one, char text[BENCH_GRID_TEXT])
{
    const BenchSide *side = one->contest->side;
    double old = side[BENCH_OLD].instructions, new = side[BENCH_NEW].instructions;
    if (one->time == 0 && isfinite(old) && isfinite(new) && old > 0)
        snprintf(text, BENCH_GRID_TEXT, "%.4f", new / old);
}

static void add_line(BenchGrid *grid, const BenchComparison *one, bool counted)
{
    BenchGridLine *line = bench_grid_add(grid);
    int c = 0;
    bool compared = one->verdict != BENCH_INCORRECT && one->verdict != BENCH_NO_BASELINE;
    snprintf((*line)[c++], BENCH_GRID_TEXT, "%s", one->contest->scene);
    snprintf((*line)[c++], BENCH_GRID_TEXT, "%s", compared ? bench_time_name(one->time) : "-");
    for (int b = 0; b < BENCH_BUILDS; b++) bench_grid_number(one->ms[b], (*line)[c++]);
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
    if (counted) instructions_text(one, text[5]);
}

static void fill_grid(const BenchRegression *found, BenchGrid *grid)
{
    static const char *const headings[] = {"scene", "time", "old ms",    "new ms", "new/old",
                                           "95%",   "p",    "threshold", "verdict"};
    *grid = (BenchGrid){0};
    for (int i = 0; i < 9; i++) bench_grid_column(grid, headings[i], i < 2 || i == 8);
    if (found->counter) bench_grid_column(grid, "instructions", false);
    for (int i = 0; i < found->count; i++) add_line(grid, &found->list[i], found->counter);
}

static void write_start(FILE *file, const BenchRegression *found)
{
    if (found->params->interleaved)
        fprintf(file,
                "Against %s, interleaved: %d round%s of two processes of each build and scene",
                found->baseline, found->params->rounds, found->params->rounds > 1 ? "s" : "");
    else
        fprintf(file, "Against %s, as stored: %d processes of this build and scene",
                found->baseline, 2 * found->params->rounds);
    fprintf(file, "; %.0f s.\n\n", found->seconds);
}

/* A line on the outliers of a scene, if it has any; `first` is its first comparison. */
static void write_outliers(FILE *file, const BenchRegression *found, int first, const char *bullet)
{
    const BenchContest *contest = found->list[first].contest;
    bool any = false;
    for (int i = first; i < found->count && found->list[i].contest == contest; i++) {
        const BenchComparison *one = &found->list[i];
        int old = one->outliers[BENCH_OLD], new = one->outliers[BENCH_NEW];
        if (!old && !new) continue;
        if (!any)
            fprintf(file, "%s%s: outliers, kept, old+new of %d+%d:", bullet, contest->scene,
                    contest->side[BENCH_OLD].count, contest->side[BENCH_NEW].count);
        fprintf(file, "%s %s %d+%d", any ? "," : "", bench_time_name(one->time), old, new);
        any = true;
    }
    if (any) fputc('\n', file);
}

static void write_remarks(FILE *file, const BenchRegression *found, const char *bullet)
{
    for (int i = 0; i < found->count; i++) {
        const BenchComparison *one = &found->list[i];
        if (one->reason[0]) fprintf(file, "%s%s: %s\n", bullet, one->contest->scene, one->reason);
        if (i == 0 || found->list[i - 1].contest != one->contest)
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

void bench_regression_write(FILE *file, BenchRegressionFormat format, const BenchRegression *found)
{
    switch (format) {
    case BENCH_REGRESSION_TEXT:
    case BENCH_REGRESSION_MARKDOWN:
        write_text(file, found, format == BENCH_REGRESSION_MARKDOWN);
        break;
    case BENCH_REGRESSION_JSON:
        bench_regression_json(file, found);
        break;
    case BENCH_REGRESSION_JUNIT:
        bench_regression_junit(file, found);
        break;
    case BENCH_REGRESSION_GBENCH:
        bench_regression_gbench(file, found);
        break;
    }
}
