#include "history.h"

#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"
#include "../measure/measure.h"
#include "../regress/comparison.h"
#include "../table/row_store.h"

static SmCode read_files(const char *const *path, int files, BenchHistory *history, SmError *error)
{
    history->file = sm_alloc((size_t)files, sizeof *history->file);
    for (int f = 0; f < files; f++) {
        BenchHistoryFile file = {.path = path[f]};
        SmCode code = bench_store_load(path[f], &file.row, &file.rows, &file.machine, error);
        if (code) return code;
        int place =
            history->files++; /* the time, and of one time the order in which they are named */
        for (; place && strcmp(history->file[place - 1].machine.utc, file.machine.utc) > 0; place--)
            history->file[place] = history->file[place - 1];
        history->file[place] = file;
    }
    return SM_OK;
}

/* The row's median and quartiles; false: it has none. */
static bool set_point(const BenchHistory *history, int file, const BenchRow *row,
                      BenchHistoryPoint *point)
{
    *point = (BenchHistoryPoint){file, row, 0, 0, 0};
    if (!bench_row_timed(row)) return false;
    if (!history->by_cycles) {
        bool told = row->total_ms > 0; /* files of older schemas */
        BenchQuartiles of = bench_quartiles(row->total, row->repeats);
        point->value = told ? row->total_ms : 1e3 * of.median;
        point->low = told ? row->total_low_ms : 1e3 * of.low;
        point->high = told ? row->total_high_ms : 1e3 * of.high;
    } else if (bench_row_counted(row) && row->counter) {
        double *cycles = sm_alloc((size_t)row->repeats, sizeof *cycles);
        for (int r = 0; r < row->repeats; r++) cycles[r] = row->counter[r][BENCH_CYCLES];
        BenchQuartiles of = bench_quartiles(cycles, row->repeats);
        free(cycles);
        point->value = of.median, point->low = of.low, point->high = of.high;
    }
    return isfinite(point->value) && point->value > 0;
}

/* The series whose newest row is of the same scene and work; a new one where there is none. Of
 * another instruction set a mark tells. */
static BenchSeries *find_series(BenchHistory *history, const BenchHistoryPoint *point)
{
    char reason[224];
    for (int s = 0; s < history->count; s++) {
        const BenchHistoryPoint *last = &history->series[s].point[history->series[s].points - 1];
        if (last->file != point->file && !strcmp(last->row->scene, point->row->scene) &&
            bench_same_work(last->row, point->row, true, sizeof reason, reason))
            return &history->series[s];
    }
    history->series =
        sm_realloc(history->series, (size_t)history->count + 1, sizeof *history->series);
    history->series[history->count] = (BenchSeries){0};
    return &history->series[history->count++];
}

static void add_points(BenchHistory *history)
{
    for (int f = 0; f < history->files; f++)
        for (int r = 0; r < history->file[f].rows; r++) {
            BenchHistoryPoint point;
            if (!set_point(history, f, &history->file[f].row[r], &point)) continue;
            BenchSeries *series = find_series(history, &point);
            series->point =
                sm_realloc(series->point, (size_t)series->points + 1, sizeof *series->point);
            series->point[series->points++] = point;
        }
}

static void find_changes(BenchSeries *series, unsigned long seed)
{
    size_t count = (size_t)series->points;
    double *value = sm_alloc(count, sizeof *value);
    BenchChange *change = sm_alloc(count / BENCH_CHANGE_APART + 1, sizeof *change);
    for (int i = 0; i < series->points; i++) value[i] = series->point[i].value;
    series->changes = bench_changes_find(value, series->points, seed, change);
    series->change = sm_alloc((size_t)series->changes + 1, sizeof *series->change);
    for (int c = 0; c < series->changes; c++) {
        int before = c ? change[c - 1].first : 0, here = change[c].first;
        int after = c + 1 < series->changes ? change[c + 1].first : series->points;
        series->change[c] = (BenchHistoryChange){
            change[c], bench_ratio_apart(&(BenchTimes){value + before, NULL, here - before},
                                         &(BenchTimes){value + here, NULL, after - here}, seed)};
    }
    free(change);
    free(value);
}

static void add_mark(void *context, const char *what, const char *old, const char *new)
{
    BenchHistory *history = context;
    history->mark = sm_realloc(history->mark, (size_t)history->marks + 1, sizeof *history->mark);
    BenchHistoryMark *mark = &history->mark[history->marks++];
    snprintf(mark->what, sizeof mark->what, "%s", what);
    snprintf(mark->old, sizeof mark->old, "%.120s", old);
    snprintf(mark->new, sizeof mark->new, "%.120s", new);
}

static void add_marks(BenchHistory *history)
{
    for (int f = 1; f < history->files; f++) {
        int before = history->marks;
        bench_machine_differences(&history->file[f - 1].machine, &history->file[f].machine,
                                  add_mark, history);
        for (int m = before; m < history->marks; m++) history->mark[m].file = f;
    }
}

SmCode bench_history_read(const char *const *path, int files, bool by_cycles, unsigned long seed,
                          BenchHistory *history, SmError *error)
{
    *history = (BenchHistory){.by_cycles = by_cycles};
    SmCode code = read_files(path, files, history, error);
    if (code) return code;
    add_points(history);
    for (int s = 0; s < history->count; s++) find_changes(&history->series[s], seed);
    add_marks(history);
    return SM_OK;
}

void bench_history_free(BenchHistory *history)
{
    for (int f = 0; f < history->files; f++)
        bench_rows_free(history->file[f].row, history->file[f].rows);
    for (int s = 0; s < history->count; s++) {
        free(history->series[s].point);
        free(history->series[s].change);
    }
    free(history->file);
    free(history->series);
    free(history->mark);
}
