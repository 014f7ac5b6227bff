/* Shells that turn far, and are held. */
#include "../motion/rotation.h"
#include "foot.h"
#include "sheet.h"
#include "tension.h"
#include "test_charts.h"
#include "test_shell.h"

static unsigned seed = 1;

#define CONST(array)  ((const double(*)[3])(array))
#define CONST2(array) ((const double(*)[2])(array))

/* A strip of length 1 along x, held at x = 0. */
static RefChart strip_chart(void)
{
    return (RefChart){.high = {1, 0.2}, .factor = factor_one, .place = place_flat};
}

static const RefSheetOptions strip = {.shell = {.across = 2,
                                                .basis = REF_MLS_PLANE_QUADRATIC,
                                                .thickness = 0.005,
                                                .material = {1e6, 0.3, 1000}},
                                      .damping = {2, 0.01},
                                      .h = 0.01};

static void sheet_of(const RefChart *chart, const RefSheetOptions *options, RefSheet *sheet)
{
    SmError error = {0};
    if (ref_sheet_create(chart, options, sheet, &error) != SM_OK) fail_msg("%s", error.text);
}

/* Points of a grip: the first in the middle of a side's edge, two others beside it. */
static RefSheetGrip grip_at(double theta1, double in)
{
    RefSheetGrip grip = {.count = 4, .theta = sm_alloc(4, sizeof *grip.theta)};
    double point[4][2] = {{theta1, 0.1}, {theta1, 0.02}, {theta1, 0.18}, {theta1 + in, 0.1}};
    for (int p = 0; p < 4; p++) memcpy(grip.theta[p], point[p], sizeof point[p]);
    return grip;
}

/* The surface now. */
static void surface_at(const RefSheet *sheet, double theta1, double theta2, double x[3])
{
    RefShape shape = ref_shape_create(&sheet->shell.nodes);
    assert_true(
        ref_mls_at(&sheet->shell.nodes, sheet->shell.basis, (double[]){theta1, theta2, 0}, &shape));
    memset(x, 0, 3 * sizeof *x);
    for (int n = 0; n < shape.count; n++)
        for (int d = 0; d < 3; d++)
            x[d] += shape.value[n] *
                    (sheet->shell.X[shape.node[n]][d] + sheet->warp.moved[shape.node[n]][d]);
    ref_shape_free(&shape);
}

static double length_along(const RefSheet *sheet)
{
    double sum = 0, from[3], to[3];
    enum { PARTS = 400 };
    surface_at(sheet, 0, 0.1, from);
    for (int n = 1; n <= PARTS; n++) {
        surface_at(sheet, (double)n / PARTS, 0.1, to);
        double way[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
        sum += sqrt(sm_dot(way, way));
        memcpy(from, to, sizeof from);
    }
    return sum;
}

/* Both ends held; the far one is turned about y and led along the arc that the strip is then. */
TEST(a_strip_bent_by_right_angles_keeps_its_length)
{
    needs_solver();
    RefChart chart = strip_chart();
    RefSheet sheet;
    SmError error = {0};
    sheet_of(&chart, &strip, &sheet);
    RefSheetGrip grip[2] = {grip_at(0, 0.1), grip_at(1, -0.1)};
    assert_int_equal(ref_sheet_hold(&sheet, 2, grip, &error), SM_OK);
    for (int step = 1; step <= 400; step++) {
        double angle = fmin(step / 200.0, 1) * M_PI / 2, c = cos(angle), s = sin(angle);
        double pose[3][4] = {{c, 0, s, 0}, {0, 1, 0, 0}, {-s, 0, c, 0}};
        pose[0][3] = s / angle - c;
        pose[2][3] = -(1 - c) / angle + s;
        ref_sheet_aim(&sheet, 1, (const double(*)[4])pose);
        ref_sheet_step(&sheet);
        for (int k = 0; k < 2; k++) {
            double place, turn;
            ref_sheet_off(&sheet, k, &place, &turn);
            assert_true(place < 1e-6 && turn < 1e-6);
        }
    }
    assert_true(fabs(length_along(&sheet) - 1) < 0.005);
    for (int k = 0; k < 2; k++) free(grip[k].theta);
    ref_sheet_free(&sheet);
}

/* A point out of all covers, and a damping that no step can be made with: what held goes on to. */
TEST(a_hold_that_fails_changes_nothing)
{
    needs_solver();
    RefChart chart = strip_chart();
    static double end[2][3];
    double beyond[1][3] = {{9, 9}}, pose[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0.02}, {0, 0, 1, 0.1}};
    RefSheetGrip grip[2] = {grip_at(0, 0.1), grip_at(1, -0.1)}, uncovered = {1, beyond, true};
    for (int fails = 0; fails < 2; fails++) {
        RefSheet sheet;
        SmError error = {0};
        sheet_of(&chart, &strip, &sheet);
        assert_int_equal(ref_sheet_hold(&sheet, 2, grip, &error), SM_OK);
        for (int step = 0; step < 10; step++) {
            if (step == 5 && fails) {
                assert_int_equal(ref_sheet_hold(&sheet, 1, &uncovered, &error), SM_INPUT);
                sheet.options.damping.mass_damping = -1;
                assert_int_equal(ref_sheet_hold(&sheet, 1, grip, &error), SM_USAGE);
                assert_int_equal(ref_sheet_hold(&sheet, 1, grip, NULL), SM_USAGE);
                sheet.options.damping.mass_damping = strip.damping.mass_damping;
            }
            ref_sheet_aim(&sheet, 1, (const double(*)[4])pose);
            ref_sheet_step(&sheet);
        }
        assert_int_equal(sheet.holds, 2);
        surface_at(&sheet, 0.5, 0.1, end[fails]);
        ref_sheet_free(&sheet);
    }
    assert_memory_equal(end[0], end[1], sizeof end[0]);
    for (int k = 0; k < 2; k++) free(grip[k].theta);
}

/* A bowl: part of a sphere, around z all the way. */
static const double R = 0.7;

static void bowl(RefSheet *sheet)
{
    RefChart chart = {.low = {0, -0.6},
                      .high = {2 * M_PI, 1.3},
                      .factor = factor_of_mercator,
                      .place = place_mercator,
                      .data = &R};
    RefSheetOptions options = strip;
    options.shell.across = 4;
    options.shell.nodes = 150;
    ref_chart_wrap(&chart, true, false);
    sheet_of(&chart, &options, sheet);
}

/* Forces of random signs at the nodes; and displacements, smooth ones of the surface's place. */
static void random_field(const RefSheet *sheet, double size, bool smooth, double (*field)[3])
{
    double A[3][3], b[3];
    for (int d = 0; d < 3; d++) {
        b[d] = random_between(&seed, -3, 3);
        for (int e = 0; e < 3; e++) A[d][e] = random_between(&seed, -1, 1);
    }
    for (long n = 0; n < sheet->warp.nodes; n++)
        for (int d = 0; d < 3; d++)
            field[n][d] = size * (smooth ? sin(b[d] + 2 * sm_dot(A[d], sheet->warp.X[n]))
                                         : random_between(&seed, -1, 1));
}

/* In the limit of small displacements the surface moves by u. */
TEST(small_displacements_are_exact)
{
    needs_solver();
    RefSheet sheet;
    bowl(&sheet);
    double(*u)[3] = (double(*)[3])sheet.steps.u, size = 1e-6;
    random_field(&sheet, size, false, u);
    ref_sheet_pose(&sheet);
    for (long n = 0; n < sheet.warp.nodes; n++)
        for (int d = 0; d < 3; d++)
            assert_true(fabs(sheet.warp.moved[n][d] - u[n][d]) < 1e-4 * size);
    ref_sheet_free(&sheet);
}

/* u = w x X + t, of any size, turns and moves the whole. */
TEST(rigid_motions_are_exact)
{
    needs_solver();
    RefSheet sheet;
    bowl(&sheet);
    for (int trial = 0; trial < 5; trial++) {
        double w[3], t[3], Rw[9], mean[3] = {0}, middle[3] = {0};
        for (int d = 0; d < 3; d++) w[d] = random_between(&seed, -2, 2);
        for (int d = 0; d < 3; d++) t[d] = random_between(&seed, -2, 2);
        ref_rotation(w, Rw);
        for (long n = 0; n < sheet.warp.nodes; n++) {
            double u[3];
            sm_cross(w, sheet.warp.X[n], u);
            for (int d = 0; d < 3; d++) {
                sheet.steps.u[3 * n + d] = u[d] + t[d];
                mean[d] += sheet.warp.mass[n] * (u[d] + t[d]);
                middle[d] += sheet.warp.mass[n] * sheet.warp.X[n][d];
            }
        }
        ref_sheet_pose(&sheet);
        for (long n = 0; n < sheet.warp.nodes; n++)
            for (int d = 0; d < 3; d++) {
                double wanted = middle[d] + mean[d], normal = 0;
                for (int e = 0; e < 3; e++) {
                    wanted += Rw[3 * d + e] * (sheet.warp.X[n][e] - middle[e]);
                    normal += Rw[3 * d + e] * sheet.warp.rest_normal[n][e];
                }
                assert_true(fabs(sheet.warp.X[n][d] + sheet.warp.moved[n][d] - wanted) < 1e-9);
                assert_true(fabs(sheet.warp.rest_normal[n][d] + sheet.warp.turned[n][d] - normal) <
                            1e-9);
            }
        assert_true(ref_steps_energy(&sheet.steps) < 1e-9);
    }
    ref_sheet_free(&sheet);
}

/* What forces do to the parameters is the slope of their work, free or held, however the surface
 * has turned. */
TEST(forces_are_slopes_of_their_work)
{
    needs_solver();
    RefSheet sheet;
    bowl(&sheet);
    size_t nodes = (size_t)sheet.warp.nodes;
    double(*force)[3] = sm_alloc(nodes, sizeof *force), (*way)[3] = sm_alloc(nodes, sizeof *way);
    double(*at)[3] = sm_alloc(nodes, sizeof *at);
    double point[2][3] = {{1, 0}, {4, 0.3}};
    RefSheetGrip grip[2] = {{1, point, false}, {1, point + 1, true}};
    for (int held = 0; held < 2; held++) {
        SmError error = {0};
        assert_int_equal(ref_sheet_hold(&sheet, 2 * held, grip, &error), SM_OK);
        double(*u)[3] = (double(*)[3])sheet.steps.u;
        random_field(&sheet, 1, false, force);
        random_field(&sheet, 1, true, way);
        random_field(&sheet, 0.4, true, at);
        ref_warp_pull(&sheet.warp, CONST(force));
        double work[2] = {0}, slope = 0, step = 1e-5;
        for (int side = 0; side < 2; side++) {
            for (size_t n = 0; n < nodes; n++)
                for (int d = 0; d < 3; d++) u[n][d] = at[n][d] + (side ? step : -step) * way[n][d];
            ref_warp_pose(&sheet.warp, CONST(u));
            for (size_t n = 0; n < nodes; n++) work[side] += sm_dot(force[n], sheet.warp.moved[n]);
        }
        ref_warp_pose(&sheet.warp, CONST(at));
        for (size_t n = 0; n < nodes; n++) slope += sm_dot(sheet.warp.pulled[n], way[n]);
        assert_true(fabs((work[1] - work[0]) / (2 * step) - slope) < 1e-6 * fabs(slope));
    }
    sm_free_all(force, way, at);
    ref_sheet_free(&sheet);
}

/* A free bowl that is pushed off its middle goes on as its momentum says, spinning or not. */
static void check_momentum(double push)
{
    RefSheet sheet;
    bowl(&sheet);
    double all[3] = {0}, before[3] = {0}, mass = 0;
    for (long n = 0; n < sheet.warp.nodes; n += 7)
        for (int d = 0; d < 3; d++) {
            sheet.impulse[n][d] = random_between(&seed, -push, push);
            all[d] += sheet.impulse[n][d];
        }
    sheet.pushed = true;
    double *M = sm_alloc((size_t)sheet.warp.nodes, sizeof *M);
    ref_sparse_sums(&sheet.shell.matrices.mass, M);
    for (long n = 0; n < sheet.warp.nodes; n++) mass += M[n];
    double share = 1 + sheet.options.h * sheet.options.damping.mass_damping;
    for (int step = 1; step <= 20; step++) {
        ref_sheet_step(&sheet);
        for (int d = 0; d < 3; d++) {
            double place = 0;
            for (long n = 0; n < sheet.warp.nodes; n++)
                place += sheet.warp.mass[n] * sheet.warp.moved[n][d];
            double wanted = all[d] / mass * sheet.options.h / pow(share, step);
            assert_true(fabs(place - before[d] - wanted) < 1e-9 * fabs(all[d] / mass));
            before[d] = place;
        }
    }
    free(M);
    ref_sheet_free(&sheet);
}

TEST(pushes_become_momentum)
{
    needs_solver();
    for (int power = -2; power <= 3; power++) check_momentum(pow(10, power));
}

/* Of all the steps, so many weights along a way, spread evenly over the strip's last quarter. */
static double (*load_of(const RefSheet *sheet, double weights, const double way[3]))[3]
{
    enum { ACROSS = 20 };
    double force[3], each = weights * 9.81 * 1000 * 0.005 * 0.2 / (ACROSS * ACROSS);
    double(*load)[3] = sm_alloc((size_t)sheet->warp.nodes, sizeof *load);
    for (int d = 0; d < 3; d++) force[d] = each * way[d];
    for (int n = 0; n < ACROSS * ACROSS; n++)
        push_at(&sheet->shell, 1 - 0.25 * (n / ACROSS + 0.5) / ACROSS,
                0.2 * (n % ACROSS + 0.5) / ACROSS, force, *load);
    return load;
}

/* One step under it; what work it does. */
static double step_under(RefSheet *sheet, const double (*load)[3])
{
    double work = 0;
    for (long n = 0; n < sheet->warp.nodes; n++)
        for (int d = 0; d < 3; d++) {
            work -= load[n][d] * sheet->warp.moved[n][d];
            sheet->impulse[n][d] += load[n][d] * sheet->options.h;
        }
    sheet->pushed = true;
    ref_sheet_step(sheet);
    for (long n = 0; n < sheet->warp.nodes; n++) work += sm_dot(load[n], sheet->warp.moved[n]);
    return work;
}

/* A strip without damping, held or free, a little out of its plane. */
static void trembling_strip(bool held, RefSheet *sheet)
{
    RefChart chart = strip_chart();
    RefSheetOptions options = strip;
    RefSheetGrip grip = grip_at(0, 0.1);
    SmError error = {0};
    options.damping = (RefDamping){0, 0};
    sheet_of(&chart, &options, sheet);
    assert_int_equal(ref_sheet_hold(sheet, held, &grip, &error), SM_OK);
    for (long n = 0; n < sheet->warp.nodes; n++)
        sheet->steps.v[3 * n + 2] = random_between(&seed, -1e-6, 1e-6);
    free(grip.theta);
}

/* Far beyond what a step bears that takes forces as they are where it begins. */
TEST(energy_gains_no_more_than_the_work_of_any_force)
{
    needs_solver();
    const double way[][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0.5, 0.7, 0.5}};
    for (int trial = 0; trial < 24; trial++) {
        RefSheet sheet;
        trembling_strip(trial % 2, &sheet);
        double(*load)[3] = load_of(&sheet, pow(10, 1 + trial / 2 % 3), way[trial / 6]);
        double before = ref_steps_energy(&sheet.steps), all = 0;
        for (int step = 0; step < 150; step++) {
            double work = step_under(&sheet, CONST(load)), place, turn;
            double energy = ref_steps_energy(&sheet.steps);
            all += fabs(work);
            assert_true(energy - before <= work + 1e-9 * all);
            before = energy;
            if (trial % 2 == 0) continue;
            ref_sheet_off(&sheet, 0, &place, &turn);
            assert_true(place < 1e-6 && turn < 1e-6);
        }
        free(load);
        ref_sheet_free(&sheet);
    }
}

static void assert_plane(const RefSheet *sheet, double off)
{
    for (long n = 0; n < sheet->warp.nodes; n++) assert_true(fabs(sheet->warp.moved[n][2]) < off);
}

/* It is stretched as if it had been pulled slowly, and comes to rest in its plane; under less than
 * makes waves grow steps are as they were. */
TEST(a_strip_that_is_pulled_hard_stays_plane)
{
    needs_solver();
    const double weights[] = {3, 9, 20};
    for (int trial = 0; trial < 3; trial++) {
        RefSheet sheet;
        trembling_strip(true, &sheet);
        double(*load)[3] = load_of(&sheet, weights[trial], (const double[]){1, 0, 0}), work = 0;
        for (int step = 0; step < 300; step++) work += step_under(&sheet, CONST(load));
        assert_plane(&sheet, 1e-3);
        assert_true(fabs(ref_steps_energy(&sheet.steps) / work - 0.5) < 0.005);
        assert_int_equal(sheet.steps.taut != NULL, trial > 0);
        free(load);
        ref_sheet_free(&sheet);
    }
}

/* Both ends held, which are led apart by so much. */
static void part_ends(RefSheet *sheet, double way)
{
    RefSheetGrip grip[2] = {grip_at(0, 0.1), grip_at(1, -0.1)};
    SmError error = {0};
    assert_int_equal(ref_sheet_hold(sheet, 2, grip, &error), SM_OK);
    for (int step = 1; step <= 100; step++) {
        const double pose[3][4] = {{1, 0, 0, way * step / 100}, {0, 1, 0, 0}, {0, 0, 1, 0}};
        ref_sheet_aim(sheet, 1, pose);
        ref_sheet_step(sheet);
    }
    for (int k = 0; k < 2; k++) free(grip[k].theta);
}

/* What a second hold needs pulls at the surface, too, and is a force like others: where nothing
 * pushes, the surface stays plane and the energy is what the hold has worked; under forces it comes
 * to rest; and energy gains no more than the work. */
TEST(holds_are_forces)
{
    needs_solver();
    const double way[] = {0.01, 0.02, 0.05, 0.5}, weights[] = {0, 30, 100};
    for (int trial = 0; trial < 12; trial++) {
        RefSheet sheet;
        double weight = weights[trial / 4], before, energy, all = 0, place, turn, work;
        trembling_strip(false, &sheet);
        part_ends(&sheet, way[trial % 4]);
        double(*load)[3] = load_of(&sheet, weight, (const double[]){0, 1, 1});
        energy = ref_steps_energy(&sheet.steps);
        for (int step = 0; step < 300; step++) {
            before = energy;
            work = step_under(&sheet, CONST(load));
            all += fabs(work);
            energy = ref_steps_energy(&sheet.steps);
            if (step > 9) assert_true(energy - before <= work + 1e-9 * (energy + all));
            ref_sheet_off(&sheet, 1, &place, &turn);
            assert_true(place < 1e-6 && turn < 1e-6);
        }
        assert_true(fabs(energy - before) < 1e-4 * energy);
        if (weight == 0) assert_plane(&sheet, 1e-6);
        if (weight == 0)
            assert_true(fabs(energy / (sheet.need[0] * way[trial % 4] / 2) - 1) < 0.02);
        free(load);
        ref_sheet_free(&sheet);
    }
}

/* One of two or three holds is turned to and fro about the first one by up to 0.9 rad a step: far
 * beyond what the shell bears, and it comes back. */
TEST(holds_that_turn_fast_leave_no_energy)
{
    needs_solver();
    const double angle[] = {1.2, 2.4, 1.2, 0.6}, period[] = {8, 30, 40, 12};
    for (int trial = 0; trial < 4; trial++) {
        RefSheet sheet;
        SmError error = {0};
        RefSheetGrip grip[3] = {grip_at(0, 0.1), grip_at(1, -0.1), grip_at(0.5, 0.1)};
        trembling_strip(false, &sheet);
        assert_int_equal(ref_sheet_hold(&sheet, 2 + trial / 2, grip, &error), SM_OK);
        double first = 0;
        for (int step = 1; step <= 300; step++) {
            double w = step <= 200 ? angle[trial] * sin(2 * M_PI * step / period[trial]) : 0;
            const double pose[3][4] = {
                {cos(w), 0, sin(w), 0}, {0, 1, 0, 0}, {-sin(w), 0, cos(w), 0}};
            ref_sheet_aim(&sheet, 1, pose);
            ref_sheet_step(&sheet);
            double energy = ref_steps_energy(&sheet.steps);
            assert_true(energy < 2e5);
            if (step == 210) first = energy;
            if (step == 300) assert_true(energy < first);
            for (long n = 0; n < sheet.warp.nodes; n++)
                assert_true(sm_dot(sheet.warp.moved[n], sheet.warp.moved[n]) < 60 * 60);
        }
        for (int k = 0; k < 3; k++) free(grip[k].theta);
        ref_sheet_free(&sheet);
    }
}

/* The same steps after the same state, whatever tension was borne in between. */
TEST(what_steps_bear_is_part_of_a_state)
{
    needs_solver();
    RefSheet sheet;
    trembling_strip(false, &sheet);
    part_ends(&sheet, 0.05);
    size_t size = 3 * (size_t)sheet.warp.nodes, places = REF_WARP_PLACES * (size_t)sheet.warp.cells;
    assert_non_null(sheet.tension.borne);
    double *u = sm_copy(sheet.steps.u, size, sizeof *u),
           *v = sm_copy(sheet.steps.v, size, sizeof *v);
    double *borne = sm_copy(sheet.tension.borne, places, sizeof *borne), *end = NULL;
    for (int round = 0; round < 3; round++) {
        memcpy(sheet.steps.u, u, size * sizeof *u);
        memcpy(sheet.steps.v, v, size * sizeof *v);
        ref_tension_set(&sheet.tension, borne, &sheet.warp, &sheet.steps);
        ref_sheet_pose(&sheet);
        assert_non_null(sheet.steps.taut);
        for (int step = 0; step < 5; step++) ref_sheet_step(&sheet);
        if (round == 0) end = sm_copy(sheet.steps.u, size, sizeof *end);
        assert_memory_equal(sheet.steps.u, end, size * sizeof *end);
        if (round == 1) ref_tension_drop(&sheet.tension, &sheet.steps);
        assert_int_equal(sheet.steps.taut != NULL, round != 1);
    }
    sm_free_all(u, v, borne, end);
    ref_sheet_free(&sheet);
}

/* Points beside the surface go with it in rigid motions; in others as their feet and normals do. */
TEST(points_are_carried)
{
    needs_solver();
    enum { POINTS = 500 };
    static double theta[POINTS][2], x[POINTS][3], now[POINTS][3];
    RefSheet sheet;
    RefSkin skin;
    long loose;
    double w[3] = {0.5, -1.2, 0.4}, Rw[9];
    bowl(&sheet);
    for (int p = 0; p < POINTS; p++) {
        double off = random_between(&seed, -0.05, 0.05);
        for (int d = 0; d < 2; d++)
            theta[p][d] =
                random_between(&seed, sheet.shell.chart.low[d], sheet.shell.chart.high[d]);
        place_mercator(&R, theta[p], x[p]);
        for (int d = 0; d < 3; d++) x[p][d] += off * x[p][d] + random_between(&seed, -0.01, 0.01);
    }
    ref_foot_skin(&sheet.shell, &sheet.warp, POINTS, CONST2(theta), CONST(x), &skin, &loose);
    assert_int_equal(loose, 0);
    for (long n = 0; n < sheet.warp.nodes; n++) {
        double u[3];
        sm_cross(w, sheet.warp.X[n], u);
        memcpy(sheet.steps.u + 3 * n, u, sizeof u);
    }
    ref_sheet_pose(&sheet);
    ref_skin_place(&skin, CONST(sheet.warp.moved), CONST(sheet.warp.turned), now);
    ref_rotation(w, Rw);
    double shift[3];
    for (int d = 0; d < 3; d++)
        shift[d] =
            sheet.warp.X[0][d] + sheet.warp.moved[0][d] - sm_dot(Rw + 3 * d, sheet.warp.X[0]);
    for (int s = 0; s < POINTS; s++)
        for (int d = 0; d < 3; d++)
            assert_true(fabs(now[s][d] - sm_dot(Rw + 3 * d, skin.rest[s]) - shift[d]) < 1e-5);
    for (int s = 0; s < POINTS; s++) assert_true(fabsf(skin.lift[s]) < 0.08);
    ref_skin_free(&skin);
    ref_sheet_free(&sheet);
}
