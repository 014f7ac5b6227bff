/* quantity.h - the quantities of a measured row, each described once, in a line of
 * bench/measure/row_quantities.inc: from these come the members of BenchRow, what is stored in HDF5
 * (row_store.h), CSV and JSON (row_table.h), the tables for people (row_grid.h), the report page
 * and the list of columns in results/README.md. */
#ifndef BENCH_QUANTITY_H
#define BENCH_QUANTITY_H

#include "../../reference/paper.h"
#include "../measure/row.h"
#include "../store/field.h"
#include "grid.h"

/* Tables for people. */
typedef enum {
    BENCH_TABLE_LATTICES, /* steps of lattices alone; */
    BENCH_TABLE_STEPS,    /* with rows of octrees, or of that paper */
    BENCH_TABLE_FRAMES,   /* of solid meshless bodies */
    BENCH_TABLE_SHELLS,   /* and of shells */
    BENCH_TABLE_CHANGES,  /* of scenes that change while they run */
    BENCH_TABLE_COUNTERS, /* what the processor counted, of any row */
    BENCH_TABLES
} BenchTableKind;

typedef struct {
    BenchField field;  /* of BenchRow */
    bool later;        /* files from before it was added lack it */
    bool elastic;      /* stored in the row's group "elastic", of meshless bodies */
    const char *stage; /* it is the time of this (bench_quantity_stage()); NULL: of none */
    bool samples;      /* in CSV and JSON all of `total`, in ms; in files a dataset */
    const char *of;    /* "octree": what alone has it; NULL: every row */
    const char *alias; /* in claims files, where papers.cfg calls it something else */
    const char *terse; /* heading as text, where it is another than the field's title */
    unsigned char shown[BENCH_TABLES]; /* forms in which the table has it: bits 1 << form */
    bool dash;                         /* as text "-" in a row without times */
    size_t paper; /* the RefValue in RefPaperRow that stands below, as `below` writes it; NULL: of
                   * a stage that, of others nothing */
    void (*below)(const RefPaperRow *paper, const RefValue *value, char *text);
} BenchQuantity;

/* All, in the order of columns, and how many; made at the first call. In the place of stages there
 * is one for each that an engine of the registry has, by its name. */
const BenchQuantity *bench_quantities(int *count);

/* The time of a stage in a row, ms; NULL if its engine has none of that name. */
const double *bench_quantity_stage(const BenchQuantity *quantity, const BenchRow *row);

/* The field of this name that is a number: as it is stored, without "change."; as CSV has it; or
 * its alias. NULL: there is none. */
const BenchField *bench_quantity_number(const char *name);

/* What stands behind the paper's value: "~" if it is ours, "?" damaged or misprinted, "*"
 * from another source. */
const char *bench_quantity_mark(RefStatus status);

/* The Markdown table of all that are stored or columns, as results/README.md has it. */
void bench_quantities_document(FILE *file);

#endif
