/* What comes before the octree's first step: checked, then timed. */
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../lib/system/team.h"
#include "../../octree/region/one_sided_regions.h"
#include "../check/tree_check.h"
#include "tree_body.h"

static const double most_seconds = 2;
enum { SOURCES_CHECKED = 16, LEAVES_SEARCHED = 1 << 18, LEAVES_WARMED = 1 << 17 };

/* What a run does. */
static const struct {
    bool search, tree, graph, regions, engine;
} parts[] = {
    [BENCH_SETUP_DISTANCES] = {.search = true},
    [BENCH_SETUP_GRAPH] = {.graph = true},
    [BENCH_SETUP_REGIONS] = {.regions = true},
    [BENCH_SETUP_STRUCTURE] = {.graph = true, .regions = true},
    [BENCH_SETUP_SAMPLING] = {.tree = true},
    [BENCH_SETUP_WHOLE] = {.tree = true, .graph = true, .regions = true, .engine = true},
};

typedef struct {
    BenchTrial trial; /* as many samples as asked for, or as take about two seconds */
    const BenchJob *job;
    const OctStructure *body;
    long sources;        /* that a run searches from, of distances */
    double engine_bytes; /* of the engine that is built */
    /* the run's own */
    OctReach reach;
    OctStructure made; /* of it what is timed */
} Setup;

/* Edges and leaves that searches for regions, or as far as can be, look at. */
static void count_searches(const OctStructure *body, bool far, long sources, double *edges,
                           double *reached)
{
    const OctGraph *graph = &body->graph;
    OctReach reach;
    oct_reach_init(&reach, graph);
    *edges = *reached = 0;
    for (long s = 0; s < sources; s++) {
        long source = s * graph->edges.rows / sources;
        int limit = far ? OCT_FAR / 2 : oct_one_sided_reach(body->w[source], body->options.epsilon);
        oct_reach_from(&reach, (int)source, limit);
        for (long n = 0; n < reach.count; n++) {
            int leaf = reach.reached[n];
            if (reach.nearest[leaf] <= limit - reach.distance[leaf])
                *edges += (double)(graph->edges.end[leaf] - graph->edges.first[leaf]);
        }
        *reached += (double)reach.count;
    }
    *edges /= (double)sources;
    *reached /= (double)sources;
    oct_reach_free(&reach);
}

static SmOperations regions_work(const OctStructure *body)
{
    enum { SEARCHES = 4096 };
    double edges, reached;
    long leaves = body->tree.leaves;
    count_searches(body, false, leaves < SEARCHES ? leaves : SEARCHES, &edges, &reached);
    return oct_regions_operations(edges, reached, body->regions.mean);
}

/* Of a source, or a node; and the bytes of what is read and written. */
static SmOperations work_of(const OctStructure *body, BenchSetupKind kind, long sources,
                            double *bytes)
{
    double edges, reached, leaves = (double)body->tree.leaves;
    double tree = (double)oct_tree_bytes(&body->tree);
    SmOperations least = {0};
    *bytes = tree + (double)oct_graph_bytes(&body->graph);
    if (parts[kind].search) {
        count_searches(body, true, sources, &edges, &reached);
        least = oct_reach_operations(edges, reached);
    }
    if (parts[kind].tree) least.far_bytes += tree / leaves;
    edges = (double)body->graph.edges.live / leaves;
    if (parts[kind].graph)
        least = sm_operations_add(least, 1, oct_graph_operations(&body->tree, edges));
    if (parts[kind].regions) {
        least = sm_operations_add(least, 1, regions_work(body));
        *bytes += (double)oct_regions_bytes(&body->regions);
    }
    return least;
}

static bool check_distances(const OctStructure *body, char *reason)
{
    bool right = true;
    OctReach reach;
    oct_reach_init(&reach, &body->graph);
    for (long s = 0; s < SOURCES_CHECKED && right; s++) {
        int source = (int)(s * body->tree.leaves / SOURCES_CHECKED);
        oct_reach_from(&reach, source, OCT_FAR / 2);
        right = bench_tree_check_distances(&reach, source, reason);
    }
    oct_reach_free(&reach);
    return right;
}

/* A tree is right where its graph is: that is held to the voxels. */
static bool check(const OctStructure *body, BenchSetupKind kind, char *reason)
{
    if (parts[kind].search) return check_distances(body, reason);
    return bench_tree_check_graph(body, reason) &&
           (!parts[kind].regions || bench_tree_check_regions(body, reason));
}

/* Searches from sources spread over the body. */
static void search(OctReach *reach, long sources)
{
    for (long s = 0; s < sources; s++)
        oct_reach_from(reach, (int)(s * reach->graph->edges.rows / sources), OCT_FAR / 2);
}

/* What the last run has made. */
static void forget(void *subject)
{
    oct_structure_free(&((Setup *)subject)->made);
}

/* Each of the body's, or of what the run has made before. Where all of it is wanted freeing counts
 * too. */
static void run(void *subject, SmLaps *laps)
{
    Setup *setup = subject;
    const OctStructure *body = setup->body;
    OctStructure *made = &setup->made;
    int kind = setup->job->kernel->part;
    const OctTree *tree = parts[kind].tree ? &made->tree : &body->tree;
    const OctGraph *graph = parts[kind].graph ? &made->graph : &body->graph;
    SmCode code = SM_OK;
    (void)laps;
    if (parts[kind].search) search(&setup->reach, setup->sources);
    if (parts[kind].tree)
        code = oct_sampling_tree(&body->options.sampling, &body->voxels, &made->tree, NULL, NULL);
    if (parts[kind].graph) oct_graph_build(tree, &body->voxels, &made->graph);
    if (!code && parts[kind].regions)
        code = oct_regions_build(tree, graph, body->w, body->options.epsilon, OCT_UNION,
                                 &made->regions, NULL);
    assert(!code); /* all of it was built before */
    if (!parts[kind].engine) return;
    setup->engine_bytes =
        (double)bench_tree_steps(setup->job->precision)->build(tree, &made->regions, body->mass);
    forget(setup);
}

/* Three or four digits, without an exponent. */
static int decimals(double ms)
{
    return ms < 10 ? 2 : ms < 100 ? 1 : 0;
}

static void write_note(BenchSetupKind kind, const OctStructure *body, double user_ns,
                       BenchKernelRow *row)
{
    double nodes = (double)body->tree.leaves, edges = (double)body->graph.edges.live;
    double leaves = 0; /* of all regions */
    char *note = row->note;
    size_t room = sizeof row->note;
    double ms = row->ns * (row->items == body->tree.leaves ? nodes : 1) / 1e6;
    switch (kind) {
    case BENCH_SETUP_DISTANCES:
        snprintf(note, room, "Bucket-Moore; %.1f ns a node", row->ns / nodes);
        break;
    case BENCH_SETUP_GRAPH:
        snprintf(note, room, "%.*f ms; %.1f edges a node", decimals(ms), ms, edges / nodes);
        break;
    case BENCH_SETUP_REGIONS:
        for (long i = 0; i < body->regions.members.rows; i++) leaves += body->regions.size[i];
        snprintf(note, room, "%.*f ms, distances included; %.1f leaves a region", decimals(ms), ms,
                 leaves / nodes);
        break;
    case BENCH_SETUP_STRUCTURE:
        snprintf(note, room, "%.*f ms: graph, distances, regions of %ld nodes", decimals(ms), ms,
                 body->tree.leaves);
        break;
    case BENCH_SETUP_SAMPLING:
        snprintf(note, room, "%.*f ms: %ld nodes, %ld base cells from %ld cells, lattice placed",
                 decimals(ms), ms, body->tree.leaves, body->tree.roots, body->voxels.cell_count);
        break;
    case BENCH_SETUP_WHOLE:
        snprintf(note, room,
                 "%.*f ms: tree, graph, regions, engine of %ld nodes; %.0f ns of user time",
                 decimals(ms), ms, body->tree.leaves, user_ns);
        break;
    }
}

static SmCode prepare(BenchJob *job, SmError *error)
{
    const OctStructure *body = &((const BenchTreeBody *)job->body)->structure;
    Setup *setup = job->subject = sm_alloc(1, sizeof *setup);
    BenchSetupKind kind = (BenchSetupKind)job->kernel->part;
    long leaves = body->tree.leaves, sources = LEAVES_SEARCHED / leaves;
    char reason[BENCH_TREE_REASON];
    (void)error;
    setup->job = job;
    setup->body = body;
    setup->sources = sources < 1 ? 1 : sources > leaves ? leaves : sources;
    setup->trial = (BenchTrial){.timed = {setup, forget, run},
                                .threads = sm_team(0),
                                .runs = 1,
                                .warm_up = leaves <= LEAVES_WARMED,
                                .once = true,
                                .most_seconds = most_seconds,
                                .valid = true};
    if (check(body, kind, reason))
        oct_reach_init(&setup->reach, &body->graph);
    else
        bench_trial_fail(&setup->trial, "%s", reason);
    if (kind != BENCH_SETUP_WHOLE) job->arithmetic = "integer";
    job->trial = &setup->trial;
    job->item = "node";
    job->items = leaves;
    if (kind == BENCH_SETUP_DISTANCES) job->item = "source", job->items = setup->sources;
    if (kind == BENCH_SETUP_STRUCTURE) job->item = "body", job->items = 1;
    job->per_run = (double)job->items;
    return SM_OK;
}

static void report(BenchJob *job, BenchKernelRow *row)
{
    const Setup *setup = job->subject;
    BenchSetupKind kind = (BenchSetupKind)job->kernel->part;
    double user = 0;
    for (int r = 0; r < setup->trial.samples; r++) user += setup->trial.user[r];
    job->own_ns = 1e9 * user / (setup->trial.samples * job->per_run);
    job->least = work_of(setup->body, kind, setup->sources, &job->footprint);
    if (kind == BENCH_SETUP_STRUCTURE)
        job->least = bench_tree_body_operations(job->body, job->least);
    job->footprint += setup->engine_bytes;
    write_note(kind, setup->body, job->own_ns, row);
}

static void release(void *subject)
{
    forget(subject);
    oct_reach_free(&((Setup *)subject)->reach);
}

const BenchKernelKind bench_tree_setup_kernels = {.open = bench_tree_body_open,
                                                  .close = bench_tree_body_close,
                                                  .prepare = prepare,
                                                  .report = report,
                                                  .release = release,
                                                  .apart = true,
                                                  .own = "user time"};
