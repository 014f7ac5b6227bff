/* history.h - stored files of `tables` in the order of time: what a step of every scene took in
 * each, where that changed (change_point.h), and where the machine that measured it did. */
#ifndef BENCH_HISTORY_H
#define BENCH_HISTORY_H

#include "../measure/row.h"
#include "../system/machine.h"
#include "../system/statistic.h"
#include "change_point.h"

typedef struct {
    const char *path; /* the caller's */
    BenchMachine machine;
    BenchRow *row; /* [rows] */
    int rows;
} BenchHistoryFile;

/* A step of a scene on one of the files: median and quartiles, in ms, or cycles. */
typedef struct {
    int file;
    const BenchRow *row;
    double value, low, high;
} BenchHistoryPoint;

/* The times before and after a change, up to the changes next to it. */
typedef struct {
    BenchChange change; /* .first: a point of the series */
    BenchRatio ratio;   /* of the medians: after / before, with its 95% interval */
} BenchHistoryChange;

/* A scene of the same work (comparison.h) in several files. */
typedef struct {
    BenchHistoryPoint *point; /* [points] */
    int points;
    BenchHistoryChange *change; /* [changes] */
    int changes;
} BenchSeries;

/* From the file before to this one, the machine differs. */
typedef struct {
    int file;
    char what[24], old[128], new[128];
} BenchHistoryMark;

typedef struct {
    BenchHistoryFile *file; /* [files] oldest first */
    int files;
    bool by_cycles;
    BenchSeries *series; /* [count] in the order in which they first appear */
    int count;
    BenchHistoryMark *mark; /* [marks] by file */
    int marks;
} BenchHistory;

/* Reads the files, orders them by the time at which they were measured, and finds all of it. Rows
 * that are INVALID or BUSY, or have no cycles where these are wanted, are left out. SM_INPUT names
 * the file that cannot be used. The caller frees the history in any case. */
SmCode bench_history_read(const char *const *path, int files, bool by_cycles, unsigned long seed,
                          BenchHistory *history, SmError *error);
void bench_history_free(BenchHistory *history);

typedef enum { BENCH_HISTORY_TEXT, BENCH_HISTORY_MARKDOWN, BENCH_HISTORY_JSON } BenchHistoryFormat;

/* "text", "markdown", "json", NULL. */
extern const char *const bench_history_formats[];

/* Writes it.
 * json: {"schema": 1, "by", "files": [{"file", "utc", "commit", "dirty"}], "series": [{"scene",
 *   "engine", "precision", "threads", "points": [{"file": its place, "value", "low", "high"}],
 *   "changes": [{"point": the first after it, "p", "ratio", "low", "high"}]}], "marks": [{"file",
 *   "what", "old", "new"}]} */
void bench_history_write(FILE *file, BenchHistoryFormat format, const BenchHistory *history);

#endif
