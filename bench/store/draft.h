/* draft.h - a file that appears whole or not at all.
 *
 * The writer fills a draft beside the target and commits it: synced to disk, then renamed over the
 * target. A program that dies leaves at most the draft, whose name ends in .tmp. A path that is a
 * symbolic link stays one: its target is written, and keeps its mode and owner. */
#ifndef BENCH_DRAFT_H
#define BENCH_DRAFT_H

#include <stdbool.h>
#include <stdio.h>

#include "../../lib/error.h"

enum { BENCH_DRAFT_PATH = 4096 };

typedef struct {
    char path[BENCH_DRAFT_PATH];   /* the file to be, as it was named */
    char target[BENCH_DRAFT_PATH]; /* the same, links followed */
    char tmp[BENCH_DRAFT_PATH]; /* what to write to: TARGET.PID.tmp, there and empty after begin */
    int slot;                   /* in the list that bench_drafts_remove() goes through */
} BenchDraft;

/* Creates the empty draft, a new file. SM_OUTPUT, with cause and remedy: no permission, folder
 * missing, disk full, or a target that is there and write-protected or not a regular file (a
 * folder, a device, a link to one). */
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

/* Before what takes minutes and whose result the file is to hold: can it be written, and does no
 * other program write it? Until this one ends the lock TARGET.lock keeps others away. Without
 * `overwrite` (the option of every command that writes) a file that is there is refused. NULL: none
 * is wanted, and with `overwrite` SM_USAGE. SM_OUTPUT, also with the process and host that hold the
 * lock. */
SmCode bench_draft_reserve(const char *path, bool overwrite, SmError *error);

/* Syncs the draft and renames it. On SM_OUTPUT the draft is gone and the target untouched. */
SmCode bench_draft_commit(BenchDraft *draft, SmError *error);

/* Removes the draft. Twice does no harm. */
void bench_draft_discard(BenchDraft *draft);

/* The line for a write that failed with errno `number`; with number 0, `detail` is the cause.
 * Returns SM_OUTPUT. */
SmCode bench_draft_fail(const char *path, int number, const char *detail, SmError *error);

/* Removes the locks, and every draft now begun and neither committed nor discarded.
 * Async-signal-safe: for handlers of signals that end the program (interrupt.h); at exit() it
 * happens by itself. */
void bench_drafts_remove(void);

#endif
