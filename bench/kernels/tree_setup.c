#include "tree_setup.h"

#include <assert.h>
#include <stdlib.h>

#include "../../lib/system/team.h"
#include "../../octree/region/one_sided_regions.h"
#include "../check/tree_check.h"
#include "tree_steps.h"

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

/* Edges and leaves that searches for regions, or as far as can be, look at. */
static void count_searches(const OctStructure *body, bool far, long sources, double *edges,
                           double *reached)
{
    const OctGraph *graph = &body->graph;
    OctReach reach;
    oct_reach_init(&reach, graph);
    *edges = *reached = 0;
    for (long s = 0; s < sources; s++) {
        long source = s * graph->leaves / sources;
        int limit = far ? OCT_FAR / 2 : oct_one_sided_reach(body->w[source], body->options.epsilon);
        oct_reach_from(&reach, (int)source, limit);
        for (long n = 0; n < reach.count; n++) {
            int leaf = reach.reached[n];
            if (reach.nearest[leaf] <= limit - reach.distance[leaf])
                *edges += (double)(graph->first[leaf + 1] - graph->first[leaf]);
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

static void set_work(BenchSetup *setup)
{
    const OctStructure *body = setup->body;
    double edges, reached, leaves = (double)body->tree.leaves;
    double tree = (double)oct_tree_bytes(&body->tree);
    SmOperations least = {0};
    setup->bytes = tree + (double)oct_graph_bytes(&body->graph);
    if (parts[setup->kind].search) {
        count_searches(body, true, setup->sources, &edges, &reached);
        least = oct_reach_operations(edges, reached);
    }
    if (parts[setup->kind].tree) least.far_bytes += tree / leaves;
    if (parts[setup->kind].graph)
        least = sm_operations_add(
            least, 1,
            oct_graph_operations(&body->tree,
                                 (double)body->graph.first[body->tree.leaves] / leaves));
    if (parts[setup->kind].regions) {
        least = sm_operations_add(least, 1, regions_work(body));
        setup->bytes += (double)oct_regions_bytes(&body->regions);
    }
    setup->least = least;
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
        oct_reach_from(reach, (int)(s * reach->graph->leaves / sources), OCT_FAR / 2);
}

/* What the last run has made. */
static void forget(void *subject)
{
    oct_structure_free(&((BenchSetup *)subject)->made);
}

/* Each of the body's, or of what the run has made before. Where all of it is wanted freeing counts
 * too. */
static void run(void *subject, SmLaps *laps)
{
    BenchSetup *setup = subject;
    const OctStructure *body = setup->body;
    OctStructure *made = &setup->made;
    BenchSetupKind kind = setup->kind;
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
    setup->engine_bytes = (double)(setup->precision == BENCH_F64
                                       ? bench_tree_build_f64
                                       : bench_tree_build_f32)(tree, &made->regions, body->mass);
    forget(setup);
}

void bench_setup_create(const OctStructure *body, BenchSetupKind kind, BenchPrecision precision,
                        BenchSetup *setup)
{
    long leaves = body->tree.leaves, sources = LEAVES_SEARCHED / leaves;
    char reason[BENCH_TREE_REASON];
    *setup = (BenchSetup){.body = body, .kind = kind, .precision = precision};
    setup->sources = sources < 1 ? 1 : sources > leaves ? leaves : sources;
    setup->trial = (BenchTrial){.timed = {setup, forget, run},
                                .threads = sm_team(0),
                                .runs = 1,
                                .warm_up = leaves <= LEAVES_WARMED,
                                .once = true,
                                .most_seconds = most_seconds,
                                .valid = true};
    if (check(body, kind, reason)) {
        set_work(setup);
        oct_reach_init(&setup->reach, &body->graph);
    } else
        bench_trial_fail(&setup->trial, "%s", reason);
}

void bench_setup_free(BenchSetup *setup)
{
    forget(setup);
    oct_reach_free(&setup->reach);
    bench_trial_free(&setup->trial);
}
