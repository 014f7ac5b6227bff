/* draft.h - a file that appears whole or not at all.
 *
 * The writer fills a draft beside the target and commits it: synced to disk, then renamed over the
 * target. A program that dies leaves at most the draft, whose name ends in .tmp. */
#ifndef BENCH_DRAFT_H
#define BENCH_DRAFT_H

#include <stdio.h>

#include "../lib/error.h"

enum { BENCH_DRAFT_PATH = 4096 };

typedef struct {
    char path[BENCH_DRAFT_PATH]; /* the file to be */
    char tmp[BENCH_DRAFT_PATH];  /* what to write to: PATH.PID.tmp, there and empty after begin */
    int slot;                    /* in the list that bench_drafts_remove() goes through */
} BenchDraft;

/* Creates the empty draft. SM_OUTPUT, with cause and remedy: no permission, folder missing, disk
 * full, or a target that is there and not a regular file (a folder, a device). */
SmCode bench_draft_begin(const char *path, BenchDraft *draft, SmError *error);

/* Prints a text file, from `what`. */
typedef void BenchDraftPrint(FILE *file, const void *what);

/* Fills a draft that has begun with what `print` prints; the caller commits or discards it.
 * SM_OUTPUT. */
SmCode bench_draft_fill(const BenchDraft *draft, BenchDraftPrint *print, const void *what,
                        SmError *error);

/* All of it: a text file at `path`, whole or not at all. */
SmCode bench_draft_write(const char *path, BenchDraftPrint *print, const void *what,
                         SmError *error);

/* Can the file be written? Asked before what takes minutes, whose result it is to hold. NULL: none
 * is wanted. Leaves nothing behind. */
SmCode bench_draft_try(const char *path, SmError *error);

/* Syncs the draft and renames it. On SM_OUTPUT the draft is gone and the target untouched. */
SmCode bench_draft_commit(BenchDraft *draft, SmError *error);

/* Removes the draft. Twice does no harm. */
void bench_draft_discard(BenchDraft *draft);

/* The line for a write that failed with errno `number`; with number 0, `detail` is the cause.
 * Returns SM_OUTPUT. */
SmCode bench_draft_fail(const char *path, int number, const char *detail, SmError *error);

/* Removes every draft now begun and neither committed nor discarded. Async-signal-safe: for a
 * handler of SIGINT and SIGTERM that ends the program afterwards. */
void bench_drafts_remove(void);

#endif
