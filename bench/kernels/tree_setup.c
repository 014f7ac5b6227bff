#include "tree_setup.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "../../lib/system/team.h"
#include "tree_steps.h"

static const double most_seconds = 2;
enum { SOURCES_CHECKED = 16, LEAVES_SEARCHED = 1 << 18, LEAVES_WARMED = 1 << 17 };

/* Edges and leaves that searches up to `most` (by leaf, or NULL: as far as can be) look at. */
static void count_searches(const BenchSampled *body, const int *most, long sources, double *edges,
                           double *reached)
{
    const OctGraph *graph = &body->graph;
    OctReach reach;
    oct_reach_init(&reach, graph);
    *edges = *reached = 0;
    for (long s = 0; s < sources; s++) {
        long source = s * graph->leaves / sources;
        int limit = most ? most[source] : OCT_FAR / 2;
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

static SmOperations regions_work(const BenchSampled *body)
{
    enum { SEARCHES = 4096 };
    double edges, reached;
    long leaves = body->tree.leaves;
    int *most = sm_alloc((size_t)leaves, sizeof *most);
    for (long i = 0; i < leaves; i++)
        most[i] = (int)(body->w[i] + floor(body->epsilon * body->w[i]));
    count_searches(body, most, leaves < SEARCHES ? leaves : SEARCHES, &edges, &reached);
    free(most);
    return oct_regions_operations(edges, reached, body->regions.mean);
}

static SmOperations graph_work(const BenchSampled *body)
{
    return oct_graph_operations(&body->tree, (double)body->graph.first[body->tree.leaves] /
                                                 (double)body->tree.leaves);
}

static void set_work(const BenchSampled *body, BenchSetupKind kind, BenchSetup *setup)
{
    double edges, reached, leaves = (double)body->tree.leaves;
    double tree = (double)oct_tree_bytes(&body->tree);
    double graph = (double)oct_graph_bytes(&body->graph);
    SmOperations sampling = {.far_bytes = tree / leaves};
    setup->bytes = tree + graph;
    switch (kind) {
    case BENCH_SETUP_DISTANCES:
        count_searches(body, NULL, setup->sources, &edges, &reached);
        setup->least = oct_reach_operations(edges, reached);
        return;
    case BENCH_SETUP_GRAPH:
        setup->least = graph_work(body);
        return;
    case BENCH_SETUP_REGIONS:
        setup->least = regions_work(body);
        break;
    case BENCH_SETUP_STRUCTURE:
        setup->least = sm_operations_add(graph_work(body), 1, regions_work(body));
        break;
    case BENCH_SETUP_SAMPLING:
        setup->least = sampling;
        return;
    case BENCH_SETUP_WHOLE:
        setup->least = sm_operations_add(sampling, 1, graph_work(body));
        setup->least = sm_operations_add(setup->least, 1, regions_work(body));
        break;
    }
    setup->bytes += (double)oct_regions_bytes(&body->regions);
}

static bool check_distances(const BenchSampled *body, char *reason)
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
static bool check(const BenchSampled *body, BenchSetupKind kind, char *reason)
{
    switch (kind) {
    case BENCH_SETUP_DISTANCES:
        return check_distances(body, reason);
    case BENCH_SETUP_GRAPH:
    case BENCH_SETUP_SAMPLING:
        return bench_tree_check_graph(body, reason);
    case BENCH_SETUP_REGIONS:
    case BENCH_SETUP_STRUCTURE:
    case BENCH_SETUP_WHOLE:
        break;
    }
    return bench_tree_check_graph(body, reason) && bench_tree_check_regions(body, reason);
}

/* Searches from sources spread over the body. */
static void search(OctReach *reach, long sources)
{
    for (long s = 0; s < sources; s++)
        oct_reach_from(reach, (int)(s * reach->graph->leaves / sources), OCT_FAR / 2);
}

static void make_regions(const OctTree *tree, const OctGraph *graph, const int *w, double epsilon,
                         OctRegions *regions)
{
    SmCode code = oct_regions_build(tree, graph, w, epsilon, OCT_UNION, regions, NULL);
    assert(!code); /* they were built before */
}

static void make_tree(const BenchSampled *body, OctTree *tree)
{
    SmCode code = oct_sampling_tree(&body->sampling, &body->voxels, tree, NULL, NULL);
    assert(!code);
}

/* From voxels on, all that a body needs; returns the engine's memory. */
static long set_up(const BenchSampled *body, BenchPrecision precision)
{
    OctTree tree;
    OctGraph graph;
    OctRegions regions;
    int *w;
    double *mass;
    make_tree(body, &tree);
    bench_sampled_widths(&tree, body->edges, &w, &mass);
    oct_graph_build(&tree, &body->voxels, &graph);
    make_regions(&tree, &graph, w, body->epsilon, &regions);
    long bytes = (precision == BENCH_F64 ? bench_tree_build_f64
                                         : bench_tree_build_f32)(&tree, &regions, mass);
    oct_graph_free(&graph);
    oct_regions_free(&regions);
    oct_tree_free(&tree);
    free(w);
    free(mass);
    return bytes;
}

/* What the last run has made. */
static void forget(void *subject)
{
    BenchSetup *setup = subject;
    oct_tree_free(&setup->tree);
    oct_graph_free(&setup->graph);
    oct_regions_free(&setup->regions);
    setup->tree = (OctTree){0};
    setup->graph = (OctGraph){0};
    setup->regions = (OctRegions){0};
}

/* Where all of it is wanted freeing counts too. */
static void run(void *subject, SmLaps *laps)
{
    BenchSetup *setup = subject;
    const BenchSampled *body = setup->body;
    BenchSetupKind kind = setup->kind;
    (void)laps;
    if (kind == BENCH_SETUP_DISTANCES) search(&setup->reach, setup->sources);
    if (kind == BENCH_SETUP_SAMPLING) make_tree(body, &setup->tree);
    if (kind == BENCH_SETUP_GRAPH || kind == BENCH_SETUP_STRUCTURE)
        oct_graph_build(&body->tree, &body->voxels, &setup->graph);
    if (kind == BENCH_SETUP_REGIONS || kind == BENCH_SETUP_STRUCTURE)
        make_regions(&body->tree, &body->graph, body->w, body->epsilon, &setup->regions);
    if (kind == BENCH_SETUP_WHOLE) setup->engine_bytes = (double)set_up(body, setup->precision);
}

void bench_setup_create(const BenchSampled *body, BenchSetupKind kind, BenchPrecision precision,
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
        set_work(body, kind, setup);
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
