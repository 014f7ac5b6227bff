/* paper.h - what the papers print, from the data file reference/papers.cfg.
 *
 * The file is compiled in; it says which status means what. */
#ifndef REF_PAPER_H
#define REF_PAPER_H

#include "../lib/engine/stage.h"

typedef enum { REF_QUOTED, REF_DERIVED, REF_OURS, REF_DAMAGED, REF_SECOND_HAND } RefStatus;

typedef struct {
    double value;     /* NaN: not given */
    RefStatus status; /* printed; computed from printed; this project's, for the paper's words;
                       * damaged or misprinted; from elsewhere */
} RefValue;

/* A row of a paper's table. */
typedef struct {
    char paper[24], scene[24]; /* "fastlsm", "statue-solid" */
    char title[40];            /* as the paper calls it: "Buddha (solid)" */
    RefValue triangles, particles, regions, w;
    RefValue stage_ms[SM_STAGES], stage_percent[SM_STAGES], total_ms;
    RefValue nodes, modes;      /* meshless's, whose particles are points on the surface */
    RefValue matrix_s, mode_s;  /* meshless's, upper bounds: set-up, seconds */
    RefValue map_s, last_nodes; /* of its shells: set-up of parameters; nodes in the end */
    RefValue fps, speedup, bases, summation_nodes; /* octree's; summation nodes per region, mean */
    /* of a scene that changes while it runs; total_ms is its first frame's */
    RefValue last_particles, added;                 /* in the end; at once, at most */
    RefValue last_ms;                               /* of its last frame */
    RefValue change_ms, change_most_ms, surface_ms; /* resampling, least and most; a surface */
    char note[200];
} RefPaperRow;

/* A number that a paper states outside its tables. */
typedef struct {
    char paper[24], name[24]; /* "fastlsm", "warm-polar" */
    RefValue value;
    char unit[32], place[32]; /* "ns/decomposition", "section 4" */
    char note[200];
} RefPaperClaim;

/* Rows in the paper's order; `count` receives how many. Read once from the data compiled in. */
const RefPaperRow *ref_paper_rows(int *count);

/* The row of `paper` ("fastlsm") for `scene` ("penguin"), or NULL. */
const RefPaperRow *ref_paper_find(const char *paper, const char *scene);

/* All claims, in the file's order; one of them by name, or NULL. */
const RefPaperClaim *ref_paper_claims(int *count);
const RefPaperClaim *ref_paper_claim(const char *paper, const char *name);

/* Text of reference/claims.cfg, which bench/claims/claim.h reads. */
extern const char ref_claims_text[];

/* The values in a column of the row, named as in papers.cfg ("particles"; of a change "added"; one
 * stage's time "polar_ms"), into `value`: of "stage_ms" and "stage_percent" SM_STAGES of them, else
 * one. Returns how many, 0
 * for an unknown column. What the paper does not give is NaN. */
int ref_paper_column(const RefPaperRow *row, const char *column, RefValue value[SM_STAGES]);

/* How the row's time of a step, and its rate, came to us: either follows from the other, and a
 * derived one is as sound as that. */
RefStatus ref_paper_step_status(const RefPaperRow *row);

/* "quoted", "derived", "ours", "damaged", "second-hand". */
const char *ref_status_name(RefStatus status);

#endif
