/* Shells whose cracks grow: what is made step by step beside what is made at once. */
#include "test_cracked.h"
#include "cracked.h"
#include "steps.h"
#include "test_charts.h"

static unsigned seed = 1;

static const RefShellOptions thin = {.across = 5,
                                     .nodes = 170,
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

/* Of a random rectangle, of one that wraps, of a double torus or of a sheet with two holes. */
enum { SHEET_KINDS = 4 };
static void random_sheet(int kind, double least_share, Sheet *sheet)
{
    RefShellOptions options = thin;
    *sheet = (Sheet){.map = {.vertices = 0}};
    if (kind < 2) {
        sheet->chart = random_chart(&seed, 0.2, kind == 1, false, &sheet->waves);
        sheet->chart.place = place_sheet;
    } else {
        map_sheet(kind == 2 ? tori_mesh(&double_torus, 45, &seed)
                            : plate_mesh(&two_holes, 30, 0.05, &seed),
                  sheet);
        options.across = 1;
        options.nodes = kind == 2 ? 220 : 325; /* the sheet's on its rims, too */
    }
    if (random_int(&seed, 2)) {
        options.basis = REF_MLS_PLANE_QUADRATIC;
        options.eta = 6;
    }
    sheet_of(&sheet->chart, &options, least_share, sheet);
}

/* The same cracks, all at once or with an update after every piece: same nodes and same matrices,
 * in another order. */
static void crawl(Sheet *sheet, bool updates)
{
    double step = half_cell(sheet);
    for (int n = 0; n < 7; n++) {
        random_growth(&seed, &sheet->cracked.cracks, step);
        if (n % 3 == 0) random_start(&seed, &sheet->cracked.cracks, step);
        if (updates) ref_cracked_update(&sheet->cracked, NULL);
    }
    if (!updates) ref_cracked_update(&sheet->cracked, NULL);
}

TEST(a_crack_that_grew_is_one_that_was_made_at_once)
{
    needs_solver();
    int more = 0;
    for (int kind = 0; kind < SHEET_KINDS; kind++) {
        Sheet grown, made = {.map = {.vertices = 0}};
        random_sheet(kind, 0.7, &grown);
        made.chart = grown.chart;
        sheet_of(&made.chart, &grown.cracked.options, 0.7, &made);
        unsigned from = seed;
        crawl(&grown, true);
        seed = from;
        crawl(&made, false);
        assert_int_equal(grown.shell.nodes.count, made.shell.nodes.count);
        more += grown.shell.nodes.count > made.cracked.whole.count;
        int *number = numbers_in(&grown.shell.nodes, &made.shell.nodes);
        assert_near(&grown.shell.matrices.mass, &made.shell.matrices.mass, 1, number);
        assert_near(&grown.shell.matrices.stiffness, &made.shell.matrices.stiffness, 3, number);
        free(number);
        sheet_free(&grown);
        sheet_free(&made);
    }
    assert_true(more >= 3);
}

/* A straight crack of pieces of a length that is given. */
static void cut_straight(RefCracks *cracks, const double from[2], const double to[2], double piece)
{
    int arm = ref_cracks_start(cracks, from, -1);
    int count = (int)ceil(hypot(to[0] - from[0], to[1] - from[1]) / piece);
    for (int n = 1; n <= count && cracks->arm[arm].open; n++) {
        double share = (double)n / count;
        ref_cracks_grow(
            cracks, arm,
            (double[]){from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])});
    }
}

static const double strip_length = 4;

static RefChart strip_chart(void)
{
    return (RefChart){.high = {strip_length, 1}, .factor = factor_one, .place = place_flat};
}

/* The displacement at a place. */
static void displacement_at(const RefShell *shell, const double *u, double theta1, double theta2,
                            double moved[3])
{
    RefShape shape = ref_shape_create(&shell->nodes);
    memset(moved, 0, sizeof(double[3]));
    assert_true(ref_samples_shape(&shell->nodes, shell->basis, 0.1, (double[]){theta1, theta2, 0},
                                  &shape) > 0);
    for (int n = 0; n < shape.count; n++)
        for (int d = 0; d < 3; d++) moved[d] += shape.value[n] * u[3 * shape.node[n] + d];
    ref_shape_free(&shape);
}

/* A strip that is pulled at both ends by one a length, cut half through from a side: how wide the
 * crack's mouth is. Checks that it opens the same on both sides. */
static double mouth(int across, RefBasis basis, double young)
{
    RefChart chart = strip_chart();
    RefShellOptions options = {.across = across,
                               .basis = basis,
                               .eta = basis == REF_MLS_PLANE_LINEAR ? 5 : 6,
                               .thickness = 0.1,
                               .material = {young, 0.3, 1}};
    Sheet strip = {.map = {.vertices = 0}};
    RefSolver *solver;
    SmError error = {0};
    const double middle = strip_length / 2;
    sheet_of(&chart, &options, 0.7, &strip);
    cut_straight(&strip.cracked.cracks, (double[]){middle, -0.01}, (double[]){middle, 0.5},
                 0.5 / across);
    ref_cracked_update(&strip.cracked, NULL);
    double *load = sm_alloc(3 * (size_t)strip.shell.nodes.count, sizeof *load);
    double *u = sm_alloc(3 * (size_t)strip.shell.nodes.count, sizeof *u);
    for (int n = 0; n < 40; n++)
        for (int end = 0; end < 2; end++)
            push_at(&strip.shell, end * strip_length, (n + 0.5) / 40,
                    (double[]){(end ? 1 : -1) / 40.0, 0, 0}, load);
    if (ref_solver_create(&strip.shell.matrices, -1e-6 * young, NULL, &solver, &error) != SM_OK)
        fail_msg("%s", error.text);
    ref_solver_solve(solver, load, NULL, u);
    double left[3], right[3];
    displacement_at(&strip.shell, u, middle - 1e-4, 0, left);
    displacement_at(&strip.shell, u, middle + 1e-4, 0, right);
    double wide = right[0] - left[0];
    for (int n = 0; n < 50; n++) {
        double x = random_between(&seed, 1e-4, middle), y = random_between(&seed, 0, 1);
        displacement_at(&strip.shell, u, middle - x, y, left);
        displacement_at(&strip.shell, u, middle + x, y, right);
        assert_true(fabs(left[0] + right[0]) < 1e-6 * wide);
        assert_true(fabs(left[1] - right[1]) < 1e-6 * wide);
    }
    ref_solver_destroy(solver);
    sheet_free(&strip);
    free(load);
    free(u);
    return wide;
}

/* How wide an edge crack's mouth is by its share of the width, under a stress over E of 1: 4 a V
 * (Tada, Paris and Irwin 1973). */
static double mouth_of(double share)
{
    double c = cos(M_PI / 2 * share);
    return 4 * share * (1.46 + 3.42 * (1 - c)) / (c * c);
}

/* How long a crack has a mouth that is so wide. */
static double length_of_mouth(double wide)
{
    double low = 0, high = 0.9;
    for (int n = 0; n < 50; n++) {
        double middle = (low + high) / 2;
        *(mouth_of(middle) < wide ? &low : &high) = middle;
    }
    return low;
}

/* Under a stress far away a crack of half the width opens as one that is shorter by less than what
 * weights fade over before its tip, a quarter of a reach. It lies between nodes or on them. */
TEST(a_cracked_strip_opens_the_same_on_both_sides)
{
    needs_solver();
    const double young = 1e4, stress = 10;
    for (int across = 6; across <= 11; across += 5)
        for (int b = 0; b < 2; b++) {
            double wide = mouth(across, b ? REF_MLS_PLANE_QUADRATIC : REF_MLS_PLANE_LINEAR, young);
            double shorter = (0.5 - length_of_mouth(wide * young / stress)) * across;
            print_message("%d across: the crack is shorter by %.3f cells\n", across, shorter);
            assert_true(shorter > 0 && shorter < (b ? 6 : 5) / 8.0);
        }
}

/* The kinetic energy may differ a little, because samples of a split cell have other areas. */
TEST(new_functions_keep_momentum_and_add_no_energy)
{
    needs_solver();
    int kept = 0;
    for (int trial = 0; trial < 6; trial++) {
        Sheet sheet;
        random_sheet(trial % 3, trial < 3 ? 0 : 0.7, &sheet);
        double step = half_cell(&sheet), m = pow(10, random_between(&seed, 2, 5));
        double *u = wavy_field(&seed, &sheet.shell), *v = wavy_field(&seed, &sheet.shell);
        for (int n = 0; n < 5; n++) {
            double before[3], after[3], energy[2];
            momentum_of(&sheet.shell, v, before);
            energy[0] = energy_of(&sheet.shell, 1, 0, u);
            energy[1] = energy_of(&sheet.shell, 0, 1, v);
            random_growth(&seed, &sheet.cracked.cracks, step);
            if (n % 2 == 0) random_start(&seed, &sheet.cracked.cracks, step);
            update(&sheet, m, &u, &v);
            momentum_of(&sheet.shell, v, after);
            double kinetic = energy_of(&sheet.shell, 0, 1, v);
            bool blind = sheet.cracked.counts.blind > 0; /* whose mass is gone */
            kept += !blind;
            for (int d = 0; d < 3 && !blind; d++)
                assert_true(fabs(after[d] - before[d]) < 1e-9 * sqrt(kinetic));
            assert_true(energy_of(&sheet.shell, 1, 0, u) < energy[0] * (1 + 1e-6));
            assert_true(kinetic < energy[1] * (1 + 1e-3));
        }
        free(u);
        free(v);
        sheet_free(&sheet);
    }
    assert_true(kept > 10);
}

/* What flies without a turn goes on so, however it cracks, but for what no sample sees. */
TEST(new_functions_keep_a_constant)
{
    needs_solver();
    long split = 0;
    for (int kind = 0; kind < SHEET_KINDS; kind++) {
        Sheet sheet;
        random_sheet(kind, 0.7, &sheet);
        double step = half_cell(&sheet), *u = wavy_field(&seed, &sheet.shell);
        double *v = wavy_field(&seed, &sheet.shell), whole = 0;
        for (long n = 0; n < 3 * sheet.shell.nodes.count; n++) v[n] = 1 + 0.3 * (double)(n % 3);
        whole = energy_of(&sheet.shell, 0, 1, v);
        for (int n = 0; n < 2; n++) {
            random_growth(&seed, &sheet.cracked.cracks, step);
            random_start(&seed, &sheet.cracked.cracks, step);
            update(&sheet, 1e4, &u, &v);
            split += sheet.cracked.counts.split;
            long size = 3 * sheet.shell.nodes.count;
            double *off = sm_alloc((size_t)size, sizeof *off);
            for (long k = 0; k < size; k++) off[k] = v[k] - 1 - 0.3 * (double)(k % 3);
            for (long k = 0; k < size; k++)
                if (!ref_cracked_seen(&sheet.cracked, k / 3)) off[k] = 0;
            assert_true(energy_of(&sheet.shell, 0, 1, off) < 1e-6 * whole);
            free(off);
        }
        sm_free_all(u, v);
        sheet_free(&sheet);
    }
    assert_true(split > 0);
}

/* One implicit step of u and v without damping, in which energy does not grow; returns what it was
 * and, in `left`, what is left. */
static double swing(const RefShell *shell, double h, double *u, double *v, double *left)
{
    RefSteps steps;
    const RefDamping none = {0, 0};
    size_t size = 3 * (size_t)shell->nodes.count * sizeof *u;
    assert_int_equal(ref_steps_create(&shell->matrices, &none, h, NULL, NULL, &steps, NULL), SM_OK);
    memcpy(steps.u, u, size);
    memcpy(steps.v, v, size);
    double before = ref_steps_energy(&steps);
    ref_steps_go(&steps);
    *left = ref_steps_energy(&steps);
    assert_true(*left <= before * (1 + 1e-9));
    memcpy(u, steps.u, size);
    memcpy(v, steps.v, size);
    ref_steps_free(&steps);
    return before;
}

/* Momenta and energies of two pieces, of which each has a share, are together the whole's. */
static void check_sums(const RefShell *shell, const double *u, const double *v,
                       const double momentum[3], double tolerance)
{
    size_t size = 3 * (size_t)shell->nodes.count;
    double *one = sm_alloc(size, sizeof *one), *other = sm_alloc(size, sizeof *other);
    double sum[3] = {0}, after[3], share[2];
    double whole = energy_of(shell, 0, 1, v) + energy_of(shell, 1, 0, u);
    SmPieces pieces = pieces_of(shell);
    assert_int_equal(pieces.count, 2);
    for (int p = 0; p < 2; p++) {
        for (size_t n = 0; n < size; n++) {
            bool here = pieces.piece[n / 3] == p;
            one[n] = here ? v[n] : 0;
            other[n] = here ? u[n] : 0;
        }
        momentum_of(shell, one, after);
        for (int d = 0; d < 3; d++) sum[d] += after[d];
        share[p] = energy_of(shell, 0, 1, one) + energy_of(shell, 1, 0, other);
    }
    for (int d = 0; d < 3; d++) assert_true(fabs(sum[d] - momentum[d]) < tolerance);
    assert_true(share[0] > 0.1 * whole && share[1] > 0.1 * whole);
    assert_true(fabs(share[0] + share[1] - whole) < 1e-9 * whole);
    sm_pieces_free(&pieces);
    free(one);
    free(other);
}

/* A strip that flies, turns and swings is cut through, piece by piece, while it moves. */
TEST(what_comes_apart_adds_up)
{
    needs_solver();
    RefChart chart = strip_chart();
    RefShellOptions options = {.across = 5,
                               .basis = REF_MLS_PLANE_LINEAR,
                               .eta = 5,
                               .thickness = 0.05,
                               .material = {1e4, 0.3, 1}};
    Sheet strip = {.map = {.vertices = 0}};
    const double h = 0.01;
    double momentum[3], first = 0, last = INFINITY;
    sheet_of(&chart, &options, 0.7, &strip);
    long size = 3 * strip.shell.nodes.count;
    double *u = sm_alloc((size_t)size, sizeof *u), *v = sm_alloc((size_t)size, sizeof *v);
    for (long n = 0; n < size; n++) {
        const double *x = strip.shell.X[n / 3];
        const double speed[3] = {0.3 * (x[0] - 2), -0.3 * x[1] + 1, sin(3 * x[0])};
        v[n] = speed[n % 3];
    }
    momentum_of(&strip.shell, v, momentum);
    int arm = ref_cracks_start(&strip.cracked.cracks, (double[]){1.93, -0.01}, -1);
    for (int n = 0; n < 30; n++) {
        double left;
        if (strip.cracked.cracks.arm[arm].open) {
            const double *tip = strip.cracked.cracks.arm[arm].tip;
            ref_cracks_grow(&strip.cracked.cracks, arm, (double[]){tip[0] + 0.01, tip[1] + 0.1});
            update(&strip, 1 / (h * h), &u, &v);
        }
        double before = swing(&strip.shell, h, u, v, &left);
        first = n ? first : before;
        assert_true(left <= last);
        last = left;
    }
    check_sums(&strip.shell, u, v, momentum, 1e-8 * sqrt(first));
    sheet_free(&strip);
    free(u);
    free(v);
}

/* New nodes and samples lie on the chart's surface where the whole shell's functions are undefined:
 * here everywhere, as its covers are taken away. */
TEST(the_chart_serves_where_the_whole_shell_has_no_functions)
{
    needs_solver();
    Sheet sheet = {.map = {.vertices = 0}};
    RefChart flat = {.high = {1.5, 1}, .factor = factor_one, .place = place_flat};
    sheet_of(&flat, &thin, 0.9, &sheet);
    long nodes = sheet.shell.nodes.count;
    for (long n = 0; n < sheet.cracked.whole.count; n++) sheet.cracked.whole.reach[n] *= 1e-2;
    ref_nodes_bin(&sheet.cracked.whole);
    for (int n = 0; n < 3; n++) random_start(&seed, &sheet.cracked.cracks, 0.2);
    ref_cracked_update(&sheet.cracked, NULL);
    assert_true(sheet.cracked.counts.split > 0 && sheet.shell.nodes.count > nodes);
    for (long n = nodes; n < sheet.shell.nodes.count; n++)
        for (int d = 0; d < 3; d++)
            assert_true(fabs(sheet.shell.X[n][d] - sheet.shell.nodes.position[n][d]) < 0.02);
    for (long c = 0; c < sheet.shell.tree.count; c++) {
        const RefSamples *samples = &sheet.cracked.cell[c].samples;
        for (long p = 0; p < samples->count; p++)
            assert_true(fabs(samples->area[p] / samples->weight[p] - 1) < 0.02);
    }
    sheet_free(&sheet);
}

/* A sheet after some growth, which is updated or not. */
static void cracked_sheet(int kind, Sheet *sheet)
{
    random_sheet(kind, 0.7, sheet);
    double step = half_cell(sheet);
    for (int n = 0; n < 6; n++) {
        random_growth(&seed, &sheet->cracked.cracks, step);
        if (n % 2 == 0) random_start(&seed, &sheet->cracked.cracks, step);
        if (n < 5) ref_cracked_update(&sheet->cracked, NULL);
    }
}

/* A sample's functions, of all that a cell has at once, beside those of the place alone; returns by
 * how much they differ at most where both see the same nodes, and more than that where not. */
static double off_at(const Sheet *sheet, long c, long p, RefShape *shape)
{
    const RefShell *shell = &sheet->shell;
    const RefSamples *samples = &sheet->cracked.cell[c].samples;
    double edge = ref_quadtree_edge(&shell->tree, shell->tree.cell + c), most = 0;
    long start = samples->start[p];
    ref_samples_shape(&shell->nodes, shell->basis, edge, samples->theta[p], shape);
    if (samples->start[p + 1] - start != shape->count) return 1;
    for (int n = 0; n < shape->count; n++) {
        const double scale[6] = {1, edge, edge, edge * edge, edge * edge, edge * edge};
        double part[6];
        ref_samples_part(shape, n, part);
        if (samples->node[start + n] != shape->node[n]) return 1;
        for (int m = 0; m < 6; m++)
            most = fmax(most, scale[m] * fabs(samples->part[start + n][m] - part[m]));
    }
    return most;
}

TEST(functions_of_a_cell_are_those_of_its_samples)
{
    needs_solver();
    for (int trial = 0; trial < SHEET_KINDS + 2; trial++) {
        Sheet sheet;
        double most = 0;
        cracked_sheet(trial % SHEET_KINDS, &sheet);
        ref_cracked_update(&sheet.cracked, NULL);
        RefShape shape = ref_shape_create(&sheet.shell.nodes);
        for (long c = 0; c < sheet.shell.tree.count; c++)
            for (long p = 0; p < sheet.cracked.cell[c].samples.count; p++)
                most = fmax(most, off_at(&sheet, c, p, &shape));
        print_message("%g off\n", most);
        assert_true(most < 1e-8);
        ref_shape_free(&shape);
        sheet_free(&sheet);
    }
}

/* Some of the samples of a cell, and a place that they are seen from. */
static RefGrid random_grid(const Sheet *sheet, double step, double at[2][REF_GRID_SIDE],
                           double from[2])
{
    RefGrid grid;
    long c = 0;
    do c = random_int(&seed, (int)sheet->shell.tree.count);
    while (sheet->cracked.cell[c].samples.count == 0);
    ref_samples_grid(&sheet->shell.tree, c, at);
    for (int d = 0; d < 2; d++) {
        int first = random_int(&seed, REF_GRID_SIDE);
        from[d] = at[d][0] + random_between(&seed, -5, 5) * step;
        grid.count[d] = 1 + random_int(&seed, REF_GRID_SIDE - first);
        grid.at[d] = at[d] + first;
    }
    return grid;
}

/* Ways to a grid beside one way after the other, among pieces that were looked up for both. */
TEST(ways_to_a_grid_are_ways_to_its_places)
{
    needs_solver();
    enum { GRIDS = 3000 };
    long cut[3] = {0};
    for (int kind = 0; kind < SHEET_KINDS; kind++) {
        Sheet sheet;
        cracked_sheet(kind, &sheet);
        const RefCracks *cracks = &sheet.cracked.cracks;
        double step = half_cell(&sheet), reach = 5 * step;
        for (int n = 0; n < GRIDS; n++) {
            double at[2][REF_GRID_SIDE], from[3] = {0}, part[REF_GRID_SIDE * REF_GRID_SIDE][6];
            RefGrid grid = random_grid(&sheet, step, at, from);
            bool some = ref_cracks_fan(cracks, &grid, from, reach, part);
            for (int p = 0; p < grid.count[0] * grid.count[1]; p++) {
                const double x[3] = {grid.at[0][p % grid.count[0]], grid.at[1][p / grid.count[0]]};
                const double whole[6] = {1}, *got = some ? part[p] : whole;
                double alone[6] = {0};
                if (!ref_cracks_pass(cracks, x, from, reach, alone)) memset(alone, 0, sizeof alone);
                for (int m = 0; m < 6; m++) assert_true(got[m] == alone[m]);
                cut[alone[0] == 0 ? 0 : alone[0] < 1 ? 1 : 2]++;
            }
        }
        sheet_free(&sheet);
    }
    print_message("%ld ways cut, %ld in part, %ld not\n", cut[0], cut[1], cut[2]);
    assert_true(cut[0] > 1000 && cut[1] > 100 && cut[2] > 1000);
}

/* How far a place is from the nearest of a cell's samples that no crack parts from it, of all or of
 * those that bear it. */
static double distance_to_samples(const RefCracked *cracked, long c, bool all,
                                  const double theta[2])
{
    const RefSamples *samples = &cracked->cell[c].samples;
    double least = INFINITY;
    for (int n = 0; n < REF_SAMPLES_PER_CELL; n++) {
        const double *at = samples->theta[n];
        if ((all || ref_cracked_bears(cracked, c, n)) &&
            !ref_cracks_part(&cracked->cracks, theta, at))
            least = fmin(least, hypot(at[0] - theta[0], at[1] - theta[1]));
    }
    return least;
}

TEST(places_have_functions_of_samples_that_bear_them)
{
    int bore = 0, bare = 0, none = 0;
    for (int kind = 0; kind < SHEET_KINDS; kind++) {
        Sheet sheet;
        const RefCracked *cracked = &sheet.cracked;
        const RefQuadtree *tree = &sheet.shell.tree;
        random_sheet(kind, 0.7, &sheet);
        for (int n = 0; n < 8; n++) {
            random_growth(&seed, &sheet.cracked.cracks, half_cell(&sheet));
            random_start(&seed, &sheet.cracked.cracks, half_cell(&sheet));
            ref_cracked_update(&sheet.cracked, NULL);
        }
        for (int trial = 0; trial < 20000; trial++) {
            int c = random_int(&seed, (int)tree->count);
            double middle[2], edge[2], theta[2], least[2];
            if (tree->cell[c].child >= 0) continue;
            ref_quadtree_cell(tree, tree->cell + c, middle, edge);
            for (int d = 0; d < 2; d++)
                theta[d] = middle[d] + edge[d] * random_between(&seed, -0.5, 0.5);
            const RefSamples *samples = &cracked->cell[c].samples;
            int n = ref_cracked_sample(cracked, c, theta);
            for (int k = 0; k < 2; k++) least[k] = distance_to_samples(cracked, c, k, theta);
            double wanted = least[isinf(least[0])], near = 1e-3 * edge[0];
            assert_int_equal(n < 0, isinf(wanted));
            none += n < 0;
            if (n < 0) continue;
            const double *at = samples->theta[n];
            assert_true(fabs(hypot(at[0] - theta[0], at[1] - theta[1]) - wanted) < near);
            bore += !isinf(least[0]) && least[0] > least[1] + near;
            bare += isinf(least[0]);
        }
        sheet_free(&sheet);
    }
    print_message("%d places have farther samples, %d none that bears, %d none\n", bore, bare,
                  none);
    assert_true(bore > 0 && bare > 0);
}
