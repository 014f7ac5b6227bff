/* process.h - other programs, started and waited for, and stopped when the user interrupts.
 *
 * A program runs in a process group of its own with all that it starts, so nothing of it outlives
 * this one: a signal that ends (interrupt.h) stops the group, and the caller tidies up and ends. */
#ifndef BENCH_PROCESS_H
#define BENCH_PROCESS_H

#include <limits.h>
#include <stdbool.h>

#include "../../lib/error.h"

/* From now on a signal is noted instead of ending the program; bench_process_caught() says which
 * one came first, 0 for none. */
void bench_process_catch(void);
int bench_process_caught(void);

/* What is called a few times a second while a program runs, or NULL. */
typedef void (*BenchProcessTick)(void *context);

typedef struct {
    const char *const *word; /* NULL-terminated; word[0] is looked for in PATH */
    const char *output;      /* file for standard output and error together, or NULL: nowhere */
    BenchProcessTick tick;   /* with `context` */
    void *context;
} BenchProcess;

typedef struct {
    int status; /* exit status, or 128 + signal */
} BenchProcessEnd;

/* Runs it to its end. SM_INPUT: cannot be started, with the reason (not found); or interrupted, see
 * bench_process_caught(). How it ended is no error. */
SmCode bench_process_run(const BenchProcess *process, BenchProcessEnd *end, SmError *error);

/* The last line of a file that holds these words, or, where they are NULL, is neither empty nor
 * blank; cut to `size`. Returns whether there is one; `line` is empty if not. */
bool bench_process_last_line(const char *path, const char *words, size_t size, char *line);

/* A new folder for files of this run, where TMPDIR says or in /tmp. SM_OUTPUT. The caller removes
 * it with the files that are in it. */
SmCode bench_scratch_make(char folder[PATH_MAX], SmError *error);
void bench_scratch_remove(const char *folder);

/* The running program; false, and "": it is not known. Leaves room as the next does. */
bool bench_program_path(char path[PATH_MAX]);

/* The folder that the running program is in, which leaves room for a name behind it. */
void bench_program_folder(char path[PATH_MAX]);

/* Where this script is: beside the installed program, or in the sources it was built from.
 * SM_INPUT: in neither. */
SmCode bench_script_find(const char *name, char path[PATH_MAX], SmError *error);

#endif
