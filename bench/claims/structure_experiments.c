#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../fastlsm/lattice/running_lists.h"
#include "../../octree/change/structure.h"
#include "../../octree/graph/distance.h"
#include "../engines.h"
#include "experiments.h"

/* ---- a lattice and all its regions */

typedef struct {
    LsmLattice lattice;
    LsmInterior interior;
    int w, side; /* side = 2w + 1 */
    LsmRow rows[LSM_MAX_SIDE * LSM_MAX_SIDE];
} Regions;

static void open_regions(const SmVoxels *voxels, int w, Regions *of)
{
    of->w = w;
    of->side = 2 * w + 1;
    lsm_lattice_build(voxels, &of->lattice);
    lsm_interior_build(&of->lattice, w, &of->interior);
}

static void close_regions(Regions *of)
{
    lsm_interior_free(&of->interior);
    lsm_lattice_free(&of->lattice);
}

/* ---- additions */

static double listed(const int *row, long rows, int side)
{
    long count = 0;
    for (long n = 0; n < rows * side; n++) count += row[n] != 0;
    return (double)count;
}

/* Additions for the sums over all regions through bars and plates, or each made of a neighbour's:
 * the members of the lists that the engine would have. */
static double list_additions(Regions *of, bool running)
{
    const LsmLattice *lattice = &of->lattice;
    const int layer_plane[] = {0, lattice->size[2]};
    int *slot = sm_alloc((size_t)lattice->count, sizeof *slot);
    for (int p = 0; p < lattice->count; p++) slot[p] = p;
    LsmListsBuilder *builder = lsm_lists_open(lattice, slot, of->w);
    for (long r = 0; r < lattice->count; r++) {
        lsm_region_rows(lattice, &of->interior, r, of->rows);
        lsm_lists_add(builder, r, of->rows);
    }
    LsmLists lists;
    LsmRunningLists runs;
    lsm_lists_close(builder, &lists);
    double sum = listed(lists.bar, lists.bar_count, of->side) +
                 listed(lists.plate, lists.plate_count, of->side) +
                 listed(lists.region, lists.region_count, of->side);
    if (running) {
        lsm_running_lists_build(lattice, slot, &lists, 1, layer_plane, &runs);
        sum = (double)(lsm_running_additions(&runs.bar) + lsm_running_additions(&runs.plate) +
                       lsm_running_additions(&runs.region));
        lsm_running_lists_free(&runs);
    }
    lsm_lists_free(&lists);
    free(slot);
    return sum;
}

static double naive_additions(Regions *of)
{
    double sum = 0;
    for (long r = 0; r < of->lattice.count; r++)
        sum += lsm_region_rows(&of->lattice, &of->interior, r, of->rows);
    return sum;
}

/* A particle of the lattice. */
static double additions(Regions *of, SmSummation summation)
{
    double sum = summation == SM_SUM_NAIVE ? naive_additions(of)
                                           : list_additions(of, summation == SM_SUM_FAST);
    return sum / (double)of->lattice.count;
}

double bench_structure_side(const SmVoxels *voxels, int w)
{
    Regions *regions = sm_alloc(1, sizeof *regions);
    open_regions(voxels, w, regions);
    double members = additions(regions, SM_SUM_NAIVE);
    close_regions(regions);
    free(regions);
    return cbrt(members);
}

SmCode bench_structure_additions(const BenchExperiment *of, SmError *error)
{
    enum { CELLS = 63 };
    int w[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->w, w);
    SmSummation summation = of->measure->summation;
    SmVoxels voxels;
    Regions *regions = sm_alloc(1, sizeof *regions);
    (void)error;
    sm_voxels_block(&voxels, CELLS, CELLS, CELLS, 1);
    for (int c = 0; c < count; c++) {
        open_regions(&voxels, w[c], regions);
        double
            side = regions->side,
            printed[] = {
                [SM_SUM_NAIVE] = side * side * side, [SM_SUM_BARS] = 3 * side, [SM_SUM_FAST] = 6};
        bench_curve_exact(of->curve, w[c], additions(regions, summation) / printed[summation]);
        close_regions(regions);
    }
    sm_voxels_free(&voxels);
    free(regions);
    return SM_OK;
}

SmCode bench_structure_body_additions(const BenchExperiment *of, SmError *error)
{
    int w[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->w, w);
    Regions *regions = sm_alloc(1, sizeof *regions);
    (void)error;
    for (int c = 0; c < count; c++) {
        open_regions(&of->body->voxels, w[c], regions);
        bench_curve_exact(of->curve, cbrt(additions(regions, SM_SUM_NAIVE)),
                          additions(regions, of->measure->summation));
        close_regions(regions);
    }
    free(regions);
    return SM_OK;
}

/* ---- subsums */

/* A bar or plate around a lattice index, and what it holds. */
typedef struct {
    uint64_t index;
    LsmRow members; /* of a plate a hash */
} Subsum;

static int by_index(const void *a, const void *b)
{
    const Subsum *s = a, *t = b;
    if (s->index != t->index) return s->index < t->index ? -1 : 1;
    return (s->members > t->members) - (s->members < t->members);
}

/* Rows mixed into one number, by FNV-1a: 0 only where all of them are. */
static uint64_t mixed(const LsmRow *row, int count)
{
    _Static_assert(2 * BENCH_MOST_W < 64, "a row is a word");
    uint64_t hash = 14695981039346656037U;
    LsmRow any = 0;
    for (int i = 0; i < count; i++) {
        any |= row[i];
        for (int byte = 0; byte < 8; byte++)
            hash = (hash ^ ((uint64_t)row[i] >> (8 * byte) & 255)) * 1099511628211U;
    }
    return any ? hash : 0;
}

/* The bars, or the plates, of region r; returns how many. */
static int subsums_of(const Regions *of, long r, bool plates, Subsum *found)
{
    const int *at = of->lattice.coord[r], *size = of->lattice.size;
    int side = of->side, count = 0, each = plates ? side : 1;
    for (int row = 0; row < side * side; row += each) {
        LsmRow members = plates ? mixed(of->rows + row, side) : of->rows[row];
        if (!members) continue;
        long z = at[2] + row / side - of->w, y = plates ? at[1] : at[1] + row % side - of->w;
        found[count++] = (Subsum){(uint64_t)((z * size[1] + y) * size[0] + at[0]), members};
    }
    return count;
}

/* Percent of the lattice's indices that own one of them alone, of those that own any. */
static double alone_percent(Regions *of, bool plates)
{
    const LsmLattice *lattice = &of->lattice;
    size_t most = (size_t)of->side * (plates ? 1 : (size_t)of->side), count = 0;
    Subsum *all = sm_alloc((size_t)lattice->count * most, sizeof *all);
    for (long r = 0; r < lattice->count; r++) {
        lsm_region_rows(lattice, &of->interior, r, of->rows);
        count += (size_t)subsums_of(of, r, plates, all + count);
    }
    qsort(all, count, sizeof *all, by_index);
    double owners = 0, alone = 0;
    for (size_t from = 0, to; from < count; from = to) {
        bool one = true;
        for (to = from + 1; to < count && all[to].index == all[from].index; to++)
            one = one && all[to].members == all[from].members;
        owners++;
        alone += one;
    }
    free(all);
    return 100 * alone / owners;
}

SmCode bench_structure_subsums(const BenchExperiment *of, SmError *error)
{
    int w[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->w, w);
    Regions *regions = sm_alloc(1, sizeof *regions);
    (void)error;
    for (int c = 0; c < count; c++) {
        open_regions(&of->body->voxels, w[c], regions);
        bench_curve_exact(of->curve, w[c],
                          alone_percent(regions, !strcmp(of->measure->field, "one-plate")));
        close_regions(regions);
    }
    free(regions);
    return SM_OK;
}

/* ---- distances */

enum { SOURCES = 512 }; /* searches a sample, from leaves spread over the body */

/* Seconds that they take; `reached` receives how many leaves a search reaches, on average. */
static double search(OctReach *reach, long leaves, int most, double *reached)
{
    double sum = 0, start = sm_now();
    for (long s = 0; s < SOURCES; s++) {
        oct_reach_from(reach, (int)(s * leaves / SOURCES), most);
        sum += (double)reach->count;
    }
    *reached = sum / SOURCES;
    return sm_now() - start;
}

static void add_distances(const BenchExperiment *of, const OctStructure *s, int cells, int points)
{
    int repeats = bench_lab_repeats(of->lab);
    double *us = sm_alloc((size_t)repeats, sizeof *us), reached = 0;
    OctReach reach;
    oct_reach_init(&reach, &s->graph);
    search(&reach, s->tree.leaves, 2 * cells, &reached); /* warms up */
    for (int r = 0; r < repeats; r++)
        us[r] = 1e6 * search(&reach, s->tree.leaves, 2 * cells, &reached) / SOURCES;
    bench_curve_sample(of->curve, reached, us, repeats, BENCH_LOW, points);
    oct_reach_free(&reach);
    free(us);
}

SmCode bench_structure_distances(const BenchExperiment *of, SmError *error)
{
    int cells[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->n, cells);
    const BenchScene *scene = of->scene;
    OctStructure s;
    if (!bench_engine(scene->engine)->sampled)
        return sm_fail(error, SM_INPUT, "'%.60s' is no octree: it has no such distances",
                       scene->name);
    SmCode code = oct_structure_build(&of->body->voxels, &scene->octree, of->body->mass, &s, error);
    if (code) return code;
    for (int c = 0; c < count; c++) add_distances(of, &s, cells[c], count);
    oct_structure_free(&s);
    return SM_OK;
}

/* ---- breaking */

/* Links along x in the middle of rows spread over a cube of n^3 particles, one after the other. */
static SmCode add_breaking(const BenchExperiment *of, int n, int points, SmError *error)
{
    const SmEngineType *type;
    const SmEngineParams params = {.w = 2, .h = 0.01, .strain_limit = INFINITY, .threads = 1};
    int repeats = bench_lab_repeats(of->lab);
    double *us = sm_alloc((size_t)repeats, sizeof *us);
    SmEngine *engine = NULL;
    SmVoxels cube;
    sm_voxels_block(&cube, n - 1, n - 1, n - 1, 1);
    SmCode code = bench_engine_find("fastlsm", "single", &type, error);
    if (!code) code = type->create(&cube, &params, &engine, error);
    for (int r = 0; r < repeats && !code; r++) {
        int row = (int)((r + 0.5) / repeats * n * n), p = row * n + n / 2;
        double start = sm_now();
        code = type->break_links(engine, 1, (const int[][2]){{p, p + 1}}, error);
        us[r] = 1e6 * (sm_now() - start);
    }
    if (!code) bench_curve_sample(of->curve, (double)n * n * n, us, repeats, BENCH_LOW, points);
    if (engine) type->destroy(engine);
    sm_voxels_free(&cube);
    free(us);
    return code;
}

SmCode bench_structure_breaking(const BenchExperiment *of, SmError *error)
{
    int n[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->n, n);
    SmCode code = SM_OK;
    for (int c = 0; c < count && !code; c++) code = add_breaking(of, n[c], count, error);
    return code;
}
