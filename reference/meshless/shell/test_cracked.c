/* Shells whose cracks grow: what is made again step by step beside what is made at once. */
#include "cracked.h"
#include "test_charts.h"
#include "test_shell.h"

static unsigned seed = 1;

static const RefShellOptions thin = {.across = 5,
                                     .nodes = 150,
                                     .basis = REF_MLS_PLANE_LINEAR,
                                     .eta = 5,
                                     .thickness = 0.01,
                                     .material = {1e5, 0.3, 2}};

/* A sheet that is bent both ways and wraps or does not. */
static void place_sheet(const void *data, const double theta[2], double x[3])
{
    const Waves *waves = data;
    double angle = 2 * M_PI * (theta[0] - waves->low[0]) / waves->side[0];
    double r = waves->side[0] / (2 * M_PI) * (1 + 0.2 * sin(2 * theta[1]));
    x[0] = r * cos(angle);
    x[1] = r * sin(angle);
    x[2] = theta[1] + 0.05 * sin(angle);
}

typedef struct {
    Waves waves;
    RefChart chart;
    RefShell shell;
    RefCracked cracked;
} Sheet;

static void sheet_of(const RefChart *chart, const RefShellOptions *options, double least_share,
                     Sheet *sheet)
{
    RefCrackedOptions how = {.least_share = least_share, .most_splits = 2};
    shell_of(chart, options, &sheet->shell);
    ref_cracked_create(&sheet->shell, options, &how, &sheet->cracked);
}

static void random_sheet(bool wraps, double least_share, Sheet *sheet)
{
    sheet->chart = random_chart(&seed, 0.2, wraps, false, &sheet->waves);
    sheet->chart.place = place_sheet;
    RefShellOptions options = thin;
    if (random_int(&seed, 2)) {
        options.basis = REF_MLS_PLANE_QUADRATIC;
        options.eta = 6;
    }
    sheet_of(&sheet->chart, &options, least_share, sheet);
}

static void sheet_free(Sheet *sheet)
{
    ref_cracked_free(&sheet->cracked);
    ref_shell_free(&sheet->shell);
}

/* Half a cell of a shell of 150. */
static double half_cell(const RefChart *chart)
{
    return 0.5 * sqrt((chart->high[0] - chart->low[0]) * (chart->high[1] - chart->low[1]) / 150);
}

/* Crawls: arms that go on by half a cell with a turn, begin in pairs or branch. */
static void random_growth(RefCracks *cracks, double step)
{
    for (int a = 0, arms = (int)cracks->arms; a < arms; a++) {
        const RefCrackArm arm = cracks->arm[a];
        double angle = atan2(arm.way[1], arm.way[0]) + random_between(&seed, -0.5, 0.5);
        if (!arm.open) continue;
        if (random_int(&seed, 12) == 0) ref_cracks_end(cracks, a);
        if (random_int(&seed, 4) == 0) {
            int branch = ref_cracks_start(cracks, arm.tip, a);
            ref_cracks_grow(cracks, branch,
                            (double[]){arm.tip[0] + step * cos(angle + 0.9),
                                       arm.tip[1] + step * sin(angle + 0.9)});
        }
        if (cracks->arm[a].open)
            ref_cracks_grow(
                cracks, a,
                (double[]){arm.tip[0] + step * cos(angle), arm.tip[1] + step * sin(angle)});
    }
}

static void random_start(RefCracks *cracks, double step)
{
    double at[2], angle = random_between(&seed, 0, 2 * M_PI);
    for (int d = 0; d < 2; d++)
        at[d] = random_between(&seed, cracks->chart->low[d], cracks->chart->high[d]);
    for (int k = 0; k < 2; k++) {
        int arm = ref_cracks_start(cracks, at, -1);
        double sign = k ? -step : step;
        ref_cracks_grow(cracks, arm,
                        (double[]){at[0] + sign * cos(angle), at[1] + sign * sin(angle)});
    }
}

static RefSparse copy_sparse(const RefSparse *sparse)
{
    RefSparse copy = {.columns = sparse->columns};
    size_t entries = (size_t)sparse->start[sparse->columns];
    copy.start = sm_alloc((size_t)sparse->columns + 1, sizeof *copy.start);
    copy.row = sm_alloc(entries, sizeof *copy.row);
    copy.value = sm_alloc(entries, sizeof *copy.value);
    memcpy(copy.start, sparse->start, ((size_t)sparse->columns + 1) * sizeof *copy.start);
    memcpy(copy.row, sparse->row, entries * sizeof *copy.row);
    memcpy(copy.value, sparse->value, entries * sizeof *copy.value);
    return copy;
}

static void sparse_free(RefSparse *sparse)
{
    free(sparse->start);
    free(sparse->row);
    free(sparse->value);
}

static void assert_same_bits(const RefSparse *a, const RefSparse *b)
{
    int entries = a->start[a->columns];
    assert_int_equal(a->columns, b->columns);
    assert_memory_equal(a->start, b->start, ((size_t)a->columns + 1) * sizeof *a->start);
    assert_memory_equal(a->row, b->row, (size_t)entries * sizeof *a->row);
    assert_memory_equal(a->value, b->value, (size_t)entries * sizeof *a->value);
}

/* Cracks that start, crawl, branch, meet and end at random, across seams, too. */
TEST(what_is_made_again_is_what_would_be_made_anew)
{
    needs_solver();
    for (int trial = 0; trial < 6; trial++) {
        Sheet sheet;
        RefCrackedCounts sum = {0};
        random_sheet(trial % 2, trial < 2 ? 0 : 0.7, &sheet);
        double step = half_cell(&sheet.chart);
        for (int n = 0; n < 8; n++) {
            random_growth(&sheet.cracked.cracks, step);
            if (n % 3 == 0) random_start(&sheet.cracked.cracks, step);
            ref_cracked_update(&sheet.cracked, NULL);
            sum.cells_again += sheet.cracked.counts.cells_again;
            sum.cells += sheet.cracked.counts.cells;
            sum.split += sheet.cracked.counts.split;
        }
        print_message("%ld nodes, %ld splits, %ld of %ld cells again, %ld blind, %ld soft\n",
                      sheet.shell.nodes.count, sum.split, sum.cells_again, sum.cells,
                      sheet.cracked.counts.blind, sheet.cracked.counts.soft);
        assert_true(sum.cells_again > 0 && sum.cells_again < sum.cells);
        assert_true(trial < 2 ? sum.split == 0 : sum.split > 0);
        RefSparse mass = copy_sparse(&sheet.shell.matrices.mass);
        RefSparse stiffness = copy_sparse(&sheet.shell.matrices.stiffness);
        ref_cracked_remake(&sheet.cracked);
        assert_same_bits(&mass, &sheet.shell.matrices.mass);
        assert_same_bits(&stiffness, &sheet.shell.matrices.stiffness);
        sparse_free(&mass);
        sparse_free(&stiffness);
        sheet_free(&sheet);
    }
}
