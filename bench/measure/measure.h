/* measure.h - one scene, one engine: checked against brute force, then timed, then checked again.
 *
 * How. The scene's disturbance is applied and its `settle` steps run; that state is the start of
 * every timed segment, so that all repeats do the same work on a body in motion. The check compares
 * the goal positions there, and again where the last segment ended. Between the two it is timed
 * (step_timer.h). A start that another process of this program has checked, `checked` being its
 * hash, is timed alone: the same program does the same from there. A shell that breaks cannot be
 * put back: it is played through its frames three times, with clocks, and checked at rest and in
 * the end (burst.h); `repeats`, `block_seconds` and `events` mean nothing of it. */
#ifndef BENCH_MEASURE_H
#define BENCH_MEASURE_H

#include "../scene/body.h"
#include "row.h"
#include "step_timer.h"

/* Measures the scene's body on the engine, with params->threads; what is not timed, the checks, has
 * OpenMP's number of the calling thread, but while a body breaks. A failed check is no error: the
 * row says why it is not valid. Errors are those of creating the engine and of burst.h, and
 * SM_INPUT where regions are too many to be checked. The caller frees the row. */
SmCode bench_measure(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                     const BenchMeasureParams *params, BenchRow *row, SmError *error);

/* Says why the row is not valid, unless it says so already. */
void bench_row_invalidate(BenchRow *row, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Names the row: its scene and paper, engine, and how rotations and sums are found. */
void bench_row_name(const BenchScene *scene, BenchRow *row);

/* Is a row, of which only the name need be known, a lattice beside which the other's speed may be
 * set? Of the same paper and rotations: code without low-level optimisation is compared with such
 * code, optimised code with optimised code. Naive sums are nobody's measure. */
bool bench_row_measures(const BenchRow *lattice, const BenchRow *row);

/* The first valid one of the table that is of the same mesh, or NULL. */
const BenchRow *bench_row_lattice(const BenchRow *rows, int count, const BenchRow *row);

void bench_row_free(BenchRow *row);
/* The array, too. */
void bench_rows_free(BenchRow *rows, int count);

#endif
