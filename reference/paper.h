/* paper.h - what the papers print, from the data file reference/papers.cfg. */
#ifndef REF_PAPER_H
#define REF_PAPER_H

#include "../lib/stage.h"

typedef enum { REF_QUOTED, REF_DERIVED, REF_DAMAGED, REF_SECOND_HAND } RefStatus;

typedef struct {
    double value;     /* NaN: not given */
    RefStatus status; /* printed; computed from printed; damaged or misprinted; from elsewhere */
} RefValue;

/* A row of a paper's table. */
typedef struct {
    char paper[24], scene[24];
    RefValue triangles, particles, regions, w;
    RefValue stage_ms[SM_STAGES], stage_percent[SM_STAGES], total_ms;
    char note[200];
} RefPaperRow;

/* Rows in the paper's order; `count` receives how many. Read once from the data compiled in. */
const RefPaperRow *ref_paper_rows(int *count);

/* The row of `paper` ("fastlsm") for `scene` ("penguin"), or NULL. */
const RefPaperRow *ref_paper_find(const char *paper, const char *scene);

#endif
