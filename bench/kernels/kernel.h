/* kernel.h - a kernel: a line of the list in kernels.c, with its name, its kind, what of the kind
 * it is, and the figure wanted; and a kind, which says how such kernels are prepared, checked
 * against their twins, run and counted. */
#ifndef BENCH_KERNEL_H
#define BENCH_KERNEL_H

#include "../../lib/engine/engine.h"
#include "../../octree/region/weights.h"
#include "../system/progress.h"
#include "machine_peak.h"
#include "trial.h"

/* A timed kernel. NaN: not given. */
typedef struct {
    char kernel[32], group[16], item[20]; /* "sum-fast-w3", "sum", "particle" */
    char precision[12], isa[12];          /* isa: instruction set */
    int w, threads;
    long items; /* in a sample's unit of work: particles, matrices, ... */
    bool valid;
    bool busy;        /* others took the processors (disturbance.h): its times are not to be told */
    char reason[192]; /* why not valid, or busy */
    double ns, low, high; /* an item (and step): median and quartiles over the repeats */
    double bound_ns;      /* no implementation is faster on this machine; machine_peak.h */
    char bound[8];        /* what sets it */
    double at_most;       /* ns wanted */
    double ratio, wanted; /* to another row, and the ratio wanted */
    bool wanted_least;    /* `wanted` is a lower bound, else an upper one */
    bool own_time;        /* the ratio is of processor time, which others hardly touch: it is told
                           * and judged of a busy row, too */
    char ratio_to[32];    /* "1 thread", "single" */
    char note[128];
} BenchKernelRow;

typedef struct {
    const char *const *only; /* names of kernels or groups; NULL-terminated, empty: all */
    BenchPrecision precision;
    SmLayout layout;
    int threads, repeats;
    bool scaling; /* also the largest bodies */
    unsigned long seed;
    BenchProgress *progress;
} BenchKernelParams;

typedef struct BenchKernelKind BenchKernelKind;

typedef struct {
    const char *name, *group;
    const BenchKernelKind *kind;
    int set;        /* neighbours of equal `set` share a body, and are timed in turn */
    int side;       /* of the body, if that is a cube (tree_body.h names others) */
    int w, part;    /* half width of regions (0: the scene's); which of the kind's parts */
    double at_most; /* ns an item wanted on one core in single precision, of integers or by AVX-512;
                       0: no limit */
    double avx2_share; /* the share of the floor that is wanted by AVX2; 0: no limit */
    SmSummation summation;
    SmPolarMethod polar;
    double damping;
    int threads;       /* 0: as asked for */
    bool doubled;      /* in double precision, beside single */
    bool large;        /* only by name or with `scaling` */
    const char *base;  /* the kernel that it is compared with, */
    double wanted;     /* how many times its time or, on more threads, its speed */
    const char *paper; /* what the paper says */
    const char *scene; /* of the body; NULL: named like the kernel */
} BenchKernel;

/* A kernel that is being timed. */
typedef struct {
    const BenchKernel *kernel;
    const BenchKernelParams *params;
    const BenchPeak *peak;
    void *body;  /* what its set shares, */
    bool shares; /* made for the job before */
    /* set by prepare(); precision, threads, w, arithmetic are given as asked for */
    BenchPrecision precision;
    int threads, w;
    const char *arithmetic; /* "single", "double", "integer" */
    void *subject;          /* the kind's own, freed with its trial; NULL: the body's */
    BenchTrial *trial;      /* of several kernels where they are parts of one step */
    const char *item;       /* what times are of, and how many a body has, */
    long items;
    double per_run; /* and how many a run of the trial */
    /* set by report() */
    SmOperations least; /* of an item */
    double footprint;   /* bytes of all items' state */
    double own_ns;      /* an item's processor time, as the kind names it */
} BenchJob;

struct BenchKernelKind {
    /* Makes and frees what a set shares, also where it could not be made; NULL: nothing. */
    SmCode (*open)(const BenchKernel *kernel, const BenchKernelParams *params, void **body,
                   SmError *error);
    void (*close)(void *body);
    /* Makes what is timed and checks it: one that is wrong has a trial that is not valid. */
    SmCode (*prepare)(BenchJob *job, SmError *error);
    /* Seconds a run in a sample; NULL: those of the trial. */
    double (*seconds)(const BenchJob *job, int r);
    /* What is counted, and a note, of a valid job whose times are in the row; where the trial has
     * no samples these, too. */
    void (*report)(BenchJob *job, BenchKernelRow *row);
    void (*release)(void *subject); /* what else it holds; NULL: nothing */
    bool apart; /* prepared and timed one after the other: a run changes the body, or is long */
    const char *own; /* what the ratio to the base, of another set, is of: "user time" */
};

/* The kernel as the parameters ask for it, which are kept. `peak` is for report(): NULL without. */
BenchJob bench_job(const BenchKernel *kernel, const BenchKernelParams *params,
                   const BenchPeak *peak);

/* Makes the bodies, one for neighbours of equal `set`; prepares jobs and times in turn all trials
 * that are valid. The caller closes, also after an error. */
SmCode bench_jobs_open(BenchJob *jobs, int count, SmError *error);
SmCode bench_jobs_time(BenchJob *jobs, int count, SmError *error);
void bench_jobs_close(BenchJob *jobs, int count);

/* A change of an octree while it runs: leaves split and merged again, edges of the graph cut. */
enum { BENCH_REFINE, BENCH_CUT };

extern const BenchKernelKind bench_cube_kernels, bench_polar_kernels, bench_scene_kernels,
    bench_tree_step_kernels, bench_change_kernels;

#endif
