#include "change_kernels.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "../../lib/stage.h"
#include "../../octree/engine.h"
#include "../measure/spread.h"

enum {
    SPLIT = 20,     /* leaves of a refinement, 5 x 2 x 2 */
    BORN = 7,       /* more of them for each that is split */
    PARTED = 16,    /* links of a cut: all between two by two leaves and those above */
    PLACES = 8,     /* where cuts do not meet each other */
    REBUILT = 20000 /* nodes of bodies that are held to those built from scratch */
};

typedef enum { REFINE, CUT, KINDS } Kind;

typedef struct {
    const char *name;
    int side; /* leaves along an edge of the cube */
    Kind kind;
    bool large; /* only by name or with --scaling */
} Spec;

static const char group_name[] = "resampling";
static const double most_growth = 2;

static const Spec specs[] = {
    {"oct-refine-1e3", 10, REFINE, false}, {"oct-cut-1e3", 10, CUT, false},
    {"oct-refine-1e4", 22, REFINE, false}, {"oct-cut-1e4", 22, CUT, false},
    {"oct-refine-1e5", 46, REFINE, false}, {"oct-cut-1e5", 46, CUT, false},
    {"oct-refine-1e6", 100, REFINE, true}, {"oct-cut-1e6", 100, CUT, true},
};
enum { SPECS = sizeof specs / sizeof specs[0] };

typedef struct {
    const SmEngineType *type;
    SmEngine *engine;
    const OctStructure *structure;
    int side;
    int node[SPLIT]; /* of the leaves to be refined */
    SmCounts before;
    long regions;     /* made anew by the last change */
    BenchWatch watch; /* of the samples */
} Cube;

const char *bench_change_kernel_name(int index, const char **group)
{
    if (index < 0 || index >= SPECS) return NULL;
    if (group) *group = group_name;
    return specs[index].name;
}

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

static SmCode make_cube(int side, const BenchKernelParams *params, Cube *cube, SmError *error)
{
    SmVoxels voxels;
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

/* Seconds of one change; cuts are made at a place of their own each. */
static double change(Cube *cube, Kind kind, int place)
{
    cube->regions = 0;
    bench_watch_start(&cube->watch);
    if (kind == CUT) {
        add_square(cube, place, &begin(cube)->cut);
        cube->regions = oct_engine_end(cube->engine)->region_count;
    } else {
        split_or_merge(cube, true);
        split_or_merge(cube, false);
    }
    return bench_watch_stop(&cube->watch);
}

/* The structure against one that is built from scratch. */
static bool same_as_rebuilt(const Cube *cube, char *reason, size_t size)
{
    const OctStructure *s = cube->structure;
    OctStructure fresh;
    SmError error;
    int *leaf;
    long wrong = 0;
    if (oct_structure_rebuild(s, NULL, &fresh, &leaf, &error)) {
        snprintf(reason, size, "cannot be rebuilt: %.100s", error.text);
        return false;
    }
    for (long i = 0; i < fresh.tree.leaves; i++) {
        int at = leaf[i];
        long edges = oct_graph_end(&fresh.graph, i) - fresh.graph.first[i];
        wrong += edges != oct_graph_end(&s->graph, at) - s->graph.first[at] ||
                 fresh.regions.size[i] != s->regions.size[at] || fresh.w[i] != s->w[at] ||
                 fabs(fresh.mass[i] - s->mass[at]) > 1e-12 * fresh.mass[i];
    }
    if (wrong) snprintf(reason, size, "%ld leaves are not those of a build from scratch", wrong);
    oct_structure_free(&fresh);
    free(leaf);
    return wrong == 0;
}

static bool counts_are(const Cube *cube, long nodes, long parted, char *reason, size_t size)
{
    SmCounts now;
    cube->type->count(cube->engine, &now);
    bool right = now.particles == nodes && (parted < 0 || cube->before.links - now.links == parted);
    if (!right)
        snprintf(reason, size, "%ld nodes and %ld links have become %ld and %ld",
                 cube->before.particles, cube->before.links, now.particles, now.links);
    bool small = nodes <= REBUILT;
    return right && (!small || same_as_rebuilt(cube, reason, size));
}

/* Makes the first change, not timed, and checks what has become of the body. */
static bool check(Cube *cube, Kind kind, char *reason, size_t size)
{
    long nodes = cube->before.particles;
    if (kind == CUT) {
        change(cube, CUT, 0);
        return counts_are(cube, nodes, PARTED, reason, size);
    }
    split_or_merge(cube, true);
    bool right = counts_are(cube, nodes + BORN * SPLIT, -1, reason, size);
    split_or_merge(cube, false);
    return right && counts_are(cube, nodes, 0, reason, size);
}

/* Of this process, ns: what other work there is does not count. */
static double processor_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e9 * (double)now.tv_sec + (double)now.tv_nsec;
}

static void note(const BenchKernelRun *run, const Spec *spec, const Cube *cube, double own,
                 BenchKernel *row)
{
    SmCounts counts;
    cube->type->count(cube->engine, &counts);
    SmOperations work = oct_regions_operations(0, 0, counts.summation_nodes); /* lists written */
    work.far_bytes *= (double)cube->regions;
    bench_kernel_floor(run, row, work, (double)counts.bytes);
    snprintf(row->note, sizeof row->note,
             "%.3g ms of CPU time: %d %s, in %ld nodes; %ld regions anew", own / 1e6,
             spec->kind == CUT ? PARTED : SPLIT,
             spec->kind == CUT ? "edges cut" : "leaves split, then merged", cube->before.particles,
             cube->regions);
}

/* Adds the row; returns the processor time of a change, 0 where it is not valid. */
static double run_kind(BenchKernelRun *run, const Spec *spec, Cube *cube, double least_ns)
{
    int wanted = run->params->repeats;
    int samples = spec->kind == CUT && wanted > PLACES - 1 ? PLACES - 1 : wanted;
    double *ns = sm_alloc((size_t)samples, sizeof *ns),
           *own = sm_alloc((size_t)samples, sizeof *own);
    BenchKernel *row = bench_kernel_add(run, spec->name, group_name, "change", 1);
    double typical = 0;
    row->threads = 1;
    if (check(cube, spec->kind, row->reason, sizeof row->reason)) {
        cube->watch = bench_watch(1);
        for (int i = 0; i < samples; i++) {
            own[i] = -processor_ns();
            ns[i] = 1e9 * change(cube, spec->kind, i + 1);
            own[i] += processor_ns();
            bench_watch_count(&cube->watch);
        }
        bench_kernel_times(row, ns, samples, &cube->watch);
        typical = bench_spread(own, samples).median;
        note(run, spec, cube, typical, row);
        if (least_ns > 0) {
            row->ratio = typical / least_ns;
            row->own_time = true;
            row->wanted = most_growth;
            snprintf(row->ratio_to, sizeof row->ratio_to, "%s's CPU time", specs[spec->kind].name);
        }
    }
    free(ns);
    free(own);
    return typical;
}

static bool chosen(const BenchKernelRun *run, const Spec *spec)
{
    return bench_kernel_chosen(run->params, spec->name, group_name, spec->large);
}

/* Chosen, or what a chosen one is compared with. */
static bool needed(const BenchKernelRun *run, int index)
{
    bool any = chosen(run, &specs[index]);
    for (int i = KINDS; i < SPECS && index < KINDS; i++)
        any |= specs[i].kind == specs[index].kind && chosen(run, &specs[i]);
    return any;
}

SmCode bench_change_kernels_run(BenchKernelRun *run, SmError *error)
{
    double least_ns[KINDS] = {0};
    for (int first = 0; first < SPECS; first += KINDS) { /* one body each */
        Cube cube;
        bool any = false;
        for (int i = first; i < first + KINDS; i++) any |= needed(run, i);
        if (!any) continue;
        if (run->params->progress)
            bench_progress_show(run->params->progress, specs[first].name, (double)first / SPECS);
        SmCode code = make_cube(specs[first].side, run->params, &cube, error);
        if (code) return code;
        for (int i = first; i < first + KINDS; i++) {
            if (!needed(run, i)) continue;
            double ns = run_kind(run, &specs[i], &cube, least_ns[specs[i].kind]);
            if (first == 0) least_ns[specs[i].kind] = ns;
            if (!chosen(run, &specs[i])) --*run->count; /* only to compare with */
        }
        cube.type->destroy(cube.engine);
    }
    return SM_OK;
}
