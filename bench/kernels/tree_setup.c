#include "tree_setup.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <sys/resource.h>

#include "../../lib/stage.h"
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
        setup->work = oct_reach_operations(edges, reached);
        return;
    case BENCH_SETUP_GRAPH:
        setup->work = graph_work(body);
        return;
    case BENCH_SETUP_REGIONS:
        setup->work = regions_work(body);
        break;
    case BENCH_SETUP_STRUCTURE:
        setup->work = sm_operations_add(graph_work(body), 1, regions_work(body));
        break;
    case BENCH_SETUP_SAMPLING:
        setup->work = sampling;
        return;
    case BENCH_SETUP_WHOLE:
        setup->work = sm_operations_add(sampling, 1, graph_work(body));
        setup->work = sm_operations_add(setup->work, 1, regions_work(body));
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

/* Seconds of one sample: of one source, or of the whole body. Where all of it is wanted freeing
 * counts too. */
static double sample(const BenchSampled *body, BenchSetupKind kind, BenchPrecision precision,
                     BenchSetup *setup, OctReach *reach)
{
    OctTree tree = {0};
    OctGraph graph = {0};
    OctRegions regions = {0};
    long engine = 0;
    bench_watch_start(&setup->watch);
    if (kind == BENCH_SETUP_DISTANCES) search(reach, setup->sources);
    if (kind == BENCH_SETUP_SAMPLING) make_tree(body, &tree);
    if (kind == BENCH_SETUP_GRAPH || kind == BENCH_SETUP_STRUCTURE)
        oct_graph_build(&body->tree, &body->voxels, &graph);
    if (kind == BENCH_SETUP_REGIONS || kind == BENCH_SETUP_STRUCTURE)
        make_regions(&body->tree, &body->graph, body->w, body->epsilon, &regions);
    if (kind == BENCH_SETUP_WHOLE) engine = set_up(body, precision);
    double seconds = bench_watch_stop(&setup->watch);
    setup->engine_bytes = (double)engine;
    oct_tree_free(&tree);
    oct_graph_free(&graph);
    oct_regions_free(&regions);
    return kind == BENCH_SETUP_DISTANCES ? seconds / (double)setup->sources : seconds;
}

/* Seconds of this process. */
static double user_seconds(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_utime.tv_sec + 1e-6 * (double)usage.ru_utime.tv_usec;
}

void bench_setup_time(const BenchSampled *body, BenchSetupKind kind, BenchPrecision precision,
                      int repeats, BenchSetup *setup)
{
    OctReach reach;
    long leaves = body->tree.leaves, sources = LEAVES_SEARCHED / leaves;
    *setup = (BenchSetup){.sources = sources < 1 ? 1 : sources > leaves ? leaves : sources};
    setup->valid = check(body, kind, setup->reason);
    if (!setup->valid) return;
    set_work(body, kind, setup);
    setup->ns = sm_alloc((size_t)repeats, sizeof *setup->ns);
    oct_reach_init(&reach, &body->graph);
    if (leaves <= LEAVES_WARMED) sample(body, kind, precision, setup, &reach);
    double start = sm_now(), user = user_seconds();
    setup->watch = bench_watch(sm_team(0));
    while (setup->samples < repeats && (setup->samples == 0 || sm_now() - start < most_seconds)) {
        setup->ns[setup->samples++] = 1e9 * sample(body, kind, precision, setup, &reach);
        bench_watch_count(&setup->watch);
    }
    double parts = kind == BENCH_SETUP_DISTANCES ? (double)setup->sources : 1;
    setup->user_ns = 1e9 * (user_seconds() - user) / (parts * (double)setup->samples);
    setup->bytes += setup->engine_bytes;
    oct_reach_free(&reach);
}
