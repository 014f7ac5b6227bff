/* quantity.h - the quantities of a measured row, each described once, in a line of
 * bench/measure/row_quantities.inc: from these come the members of BenchRow, what is stored in HDF5
 * (row_store.h), CSV and JSON (table.h), the tables for people (row_grid.h), the report page and
 * the list of columns in results/README.md. */
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
    BENCH_TABLE_FRAMES,   /* of meshless bodies */
    BENCH_TABLE_CHANGES,  /* of scenes that change while they run */
    BENCH_TABLES
} BenchTableKind;

typedef struct {
    BenchField field;  /* of BenchRow */
    bool elastic;      /* stored in the row's group "elastic", of meshless bodies */
    bool samples;      /* in CSV and JSON all of `total`, in ms; in files a dataset */
    const char *of;    /* "octree": what alone has it; NULL: every row */
    const char *title; /* heading in tables for people, */
    const char *terse; /* and as text, where that is another */
    unsigned char shown[BENCH_TABLES]; /* forms in which the table has it: bits 1 << form */
    bool left;                         /* aligned left */
    bool dash;                         /* as text "-" in a row without times */
    void (*cell)(const BenchRow *row, BenchGridForm form, char *text); /* NULL: its plain value */
    size_t paper; /* the RefValue in RefPaperRow that stands below, as `below` writes it */
    void (*below)(const RefPaperRow *paper, const RefValue *value, BenchGridForm form, char *text);
} BenchQuantity;

/* All, in the order of columns. */
extern const BenchQuantity bench_quantities[];
extern const int bench_quantity_count;

/* The Markdown table of all that are stored or columns, as results/README.md has it. */
void bench_quantities_document(FILE *file);

#endif
