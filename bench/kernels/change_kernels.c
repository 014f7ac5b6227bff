/* What changing an octree while it runs costs, against the body's size.
 *
 * Cubes of 10^3 to 10^6 nodes, regular, each of eight finest cells, with regions of one edge. A
 * refinement splits 20 leaves in the middle into 160, and merges them again; a cut parts 16 edges
 * of the graph, each time elsewhere near the middle. Both are done to an engine
 * (oct_engine_begin(), _end()), so that what moves nodes is brought up to date too. Links and nodes
 * have to be as many as they should, and in bodies of up to 20,000 nodes the structure that of a
 * build from scratch, leaf by leaf. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../octree/engine.h"
#include "../system/statistic.h"
#include "kernel.h"

enum {
    SPLIT = 20,     /* leaves of a refinement, 5 x 2 x 2 */
    BORN = 7,       /* more of them for each that is split */
    PARTED = 16,    /* links of a cut: all between two by two leaves and those above */
    PLACES = 8,     /* where cuts do not meet each other */
    REBUILT = 20000 /* nodes of bodies that are held to those built from scratch */
};

typedef struct {
    const SmEngineType *type;
    SmEngine *engine;
    const OctStructure *structure;
    int side;        /* leaves along an edge of the cube */
    int node[SPLIT]; /* of the leaves to be refined */
    SmCounts before;
    long regions; /* made anew by the last change */
} Cube;

typedef struct {
    BenchTrial trial;
    Cube *cube;
    int place; /* of the next cut */
} Change;

static OctStructure *begin(Cube *cube)
{
    OctStructure *s;
    SmCode code = oct_engine_begin(cube->engine, &s, NULL);
    assert(!code); /* one body, of the form that can be changed */
    (void)code;
    return s;
}

static void find_leaves(Cube *cube)
{
    int low = cube->side / 2 - 1;
    for (int i = 0; i < SPLIT; i++)
        cube->node[i] = oct_tree_find(&cube->structure->tree, 2 * (low - 1 + i % 5),
                                      2 * (low + i / 5 % 2), 2 * (low + i / 10));
}

static void free_cube(void *body)
{
    Cube *cube = body;
    if (cube->engine) cube->type->destroy(cube->engine);
    free(cube);
}

static SmCode make_cube(const BenchKernel *kernel, const BenchKernelParams *params, void **body,
                        SmError *error)
{
    SmVoxels voxels;
    int side = kernel->side;
    Cube *cube = *body = sm_alloc(1, sizeof *cube);
    OctOptions options = {.sampling = {.levels = 4,
                                       .criteria = {{.kind = OCT_UNIFORM, .level = 3}},
                                       .criteria_count = 1},
                          .epsilon = 0.5,
                          .width = {.edges = 1}};
    SmEngineParams own = {.h = 0.01, .threads = 1, .octree = &options};
    *cube = (Cube){.type = params->precision == BENCH_F64 ? &octree_engine_f64 : &octree_engine_f32,
                   .side = side};
    sm_voxels_block(&voxels, 2 * side, 2 * side, 2 * side, 1);
    SmCode code = cube->type->create(&voxels, &own, &cube->engine, error);
    sm_voxels_free(&voxels);
    if (code) return code;
    cube->structure = oct_engine_structure(cube->engine);
    find_leaves(cube);
    begin(cube); /* what is made ready once is not a change's */
    oct_engine_end(cube->engine);
    cube->type->count(cube->engine, &cube->before);
    return SM_OK;
}

/* A square in a plane between two layers of leaves, around the middles of two by two of them. */
static void add_square(const Cube *cube, int place, SmCut *cut)
{
    int vertex[4], low[3];
    for (int d = 0; d < 3; d++) low[d] = cube->side / 2 - 3 + 4 * (place >> d & 1);
    for (int i = 0; i < 4; i++) {
        double at[3] = {2 * low[0] + (i == 1 || i == 2 ? 3.5 : 0.5),
                        2 * low[1] + (i >= 2 ? 3.5 : 0.5), 2 * (low[2] + 1)};
        vertex[i] = (int)sm_cut_vertex(cut, at);
    }
    sm_cut_triangle(cut, (int[3]){vertex[0], vertex[1], vertex[2]});
    sm_cut_triangle(cut, (int[3]){vertex[2], vertex[3], vertex[0]});
}

static void split_or_merge(Cube *cube, bool split)
{
    OctStructure *s = begin(cube);
    for (int i = 0; i < SPLIT; i++) {
        SmCode code = (split ? oct_resample_split : oct_resample_merge)(s, cube->node[i], NULL);
        assert(!code);
        (void)code;
    }
    cube->regions += oct_engine_end(cube->engine)->region_count;
}

static void refine(void *subject, SmLaps *laps)
{
    Cube *cube = ((Change *)subject)->cube;
    (void)laps;
    cube->regions = 0;
    split_or_merge(cube, true);
    split_or_merge(cube, false);
}

/* Cuts are made at a place of their own each. */
static void cut(void *subject, SmLaps *laps)
{
    Change *change = subject;
    Cube *cube = change->cube;
    (void)laps;
    add_square(cube, change->place++, &begin(cube)->cut);
    cube->regions = oct_engine_end(cube->engine)->region_count;
}

/* The structure against one that is built from scratch. */
static void compare_rebuilt(const Cube *cube, BenchTrial *trial)
{
    const OctStructure *s = cube->structure;
    OctStructure fresh;
    SmError error;
    int *leaf;
    long wrong = 0;
    if (oct_structure_rebuild(s, NULL, &fresh, &leaf, &error)) {
        bench_trial_fail(trial, "cannot be rebuilt: %.100s", error.text);
        return;
    }
    for (long i = 0; i < fresh.tree.leaves; i++) {
        int at = leaf[i];
        long edges = fresh.graph.edges.end[i] - fresh.graph.edges.first[i];
        wrong += edges != s->graph.edges.end[at] - s->graph.edges.first[at] ||
                 fresh.regions.size[i] != s->regions.size[at] || fresh.w[i] != s->w[at] ||
                 fabs(fresh.mass[i] - s->mass[at]) > 1e-12 * fresh.mass[i];
    }
    if (wrong) bench_trial_fail(trial, "%ld leaves are not those of a build from scratch", wrong);
    oct_structure_free(&fresh);
    free(leaf);
}

/* So many nodes, so many links fewer (negative: any), and in small bodies all as rebuilt. */
static void require(Change *change, long nodes, long parted)
{
    const Cube *cube = change->cube;
    SmCounts now;
    cube->type->count(cube->engine, &now);
    if (now.particles != nodes || (parted >= 0 && cube->before.links - now.links != parted))
        bench_trial_fail(&change->trial, "%ld nodes and %ld links have become %ld and %ld",
                         cube->before.particles, cube->before.links, now.particles, now.links);
    else if (nodes <= REBUILT)
        compare_rebuilt(cube, &change->trial);
}

/* Makes the first change, not timed, and checks what has become of the body. */
static SmCode prepare(BenchJob *job, SmError *error)
{
    Change *change = job->subject = sm_alloc(1, sizeof *change);
    Cube *cube = change->cube = job->body;
    bool cuts = job->kernel->part == BENCH_CUT;
    long nodes = cube->before.particles;
    (void)error;
    change->trial = (BenchTrial){.timed = {change, NULL, cuts ? cut : refine},
                                 .threads = 1,
                                 .runs = 1,
                                 .once = true,
                                 .most = cuts ? PLACES - 1 : 0,
                                 .valid = true};
    if (cuts) {
        cut(change, NULL);
        require(change, nodes, PARTED);
    } else {
        split_or_merge(cube, true);
        require(change, nodes + BORN * SPLIT, -1);
        split_or_merge(cube, false);
        require(change, nodes, 0);
    }
    job->threads = 1;
    job->trial = &change->trial;
    job->item = "change";
    job->items = 1;
    job->per_run = 1;
    return SM_OK;
}

static void report(BenchJob *job, BenchKernelRow *row)
{
    const Change *change = job->subject;
    const Cube *cube = change->cube;
    bool cuts = job->kernel->part == BENCH_CUT;
    SmCounts counts;
    cube->type->count(cube->engine, &counts);
    job->own_ns = 1e9 * bench_quartiles(change->trial.cpu, change->trial.samples).median;
    job->least.far_bytes = (4 * counts.summation_nodes + 16) * (double)cube->regions; /* lists */
    job->footprint = (4 * counts.summation_nodes + 200) * (double)counts.particles;
    snprintf(row->note, sizeof row->note,
             "%.3g ms of CPU time: %d %s, in %ld nodes; %ld regions anew", job->own_ns / 1e6,
             cuts ? PARTED : SPLIT, cuts ? "edges cut" : "leaves split, then merged",
             cube->before.particles, cube->regions);
}

const BenchKernelKind bench_change_kernels = {.open = make_cube,
                                              .close = free_cube,
                                              .prepare = prepare,
                                              .report = report,
                                              .apart = true,
                                              .own = "CPU time"};
