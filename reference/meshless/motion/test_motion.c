/* Warping, energy, sag and constraints of beams that move. */
#include "../../../lib/test_fields.h"
#include "../../../lib/test_frame.h"
#include "../../../lib/vector.h"
#include "../test_beam.h"
#include "motion.h"
#include "rotation.h"

static const double size[3] = {8, 1, 1}, cell = 0.25;
enum { MODES = 40, HELD = 16 };

typedef struct {
    RefBody body;
    RefModes modes;
    RefMotion motion;
} Beam;

/* A beam that is free, or clamped at x = 0, whose ends' middles are covered. */
static Beam beam_create(bool clamped, const RefDamping *damping)
{
    Beam beam;
    double shown[HELD + 2][3] = {{0, 0.5, 0.5}, {8, 0.5, 0.5}};
    RefBodyOptions options = {.cell = cell, .basis = REF_MLS_LINEAR, .material = steel};
    RefRows rows = {0};
    for (int n = 0; n < HELD; n++) {
        shown[2 + n][0] = 0;
        shown[2 + n][1] = (n % 4 + 0.5) / 4;
        shown[2 + n][2] = (n / 4 + 0.5) / 4;
    }
    beam.body = brick_body_showing(size, &options, HELD + 2, (const double(*)[3])shown);
    RefShape shape = ref_shape_create(&beam.body.nodes);
    for (int n = 0; clamped && n < HELD; n++) {
        assert_true(ref_mls_at(&beam.body.nodes, REF_MLS_LINEAR, shown[2 + n], &shape));
        for (int d = 0; d < 3; d++) ref_rows_displacement(&rows, &shape, d);
    }
    ref_shape_free(&shape);
    assert_int_equal(
        ref_modes_find(&beam.body.matrices, clamped ? &rows : NULL, MODES, &beam.modes, NULL),
        SM_OK);
    ref_motion_create(&beam.body, &beam.modes, damping, &beam.motion);
    ref_rows_free(&rows);
    return beam;
}

static void beam_free(Beam *beam)
{
    ref_motion_free(&beam->motion);
    ref_modes_free(&beam->modes);
    ref_body_free(&beam->body);
}

/* Where the rest state's x is. */
static void place(const Beam *beam, const double x[3], double now[3])
{
    RefShape shape = ref_shape_create(&beam->body.nodes);
    assert_true(ref_mls_at(&beam->body.nodes, REF_MLS_LINEAR, x, &shape));
    for (int d = 0; d < 3; d++) {
        now[d] = x[d];
        for (int n = 0; n < shape.count; n++)
            now[d] += shape.value[n] * beam->motion.moved[shape.node[n]][d];
    }
    ref_shape_free(&shape);
}

static double middle_line(const Beam *beam)
{
    double length = 0, before[3], now[3];
    for (int n = 0; n <= 64; n++) {
        double x[3] = {0.05 + 7.9 * n / 64, 0.5, 0.5}, square = 0;
        memcpy(before, now, sizeof before);
        place(beam, x, now);
        for (int d = 0; n && d < 3; d++) square += (now[d] - before[d]) * (now[d] - before[d]);
        length += sqrt(square);
    }
    return length;
}

/* Rt is the mean of exp([s w]x) over s; its slope that of finite differences; R turns by |w|. */
TEST(rotations)
{
    static const double scale[] = {0, 1e-9, 0.05, 0.19, 0.21, 1, 3, 6};
    for (size_t n = 0; n < sizeof scale / sizeof *scale; n++) {
        double w[3] = {0.36 * scale[n], -0.48 * scale[n], 0.8 * scale[n]}, v[3] = {0.7, -1.1, 0.4};
        double mean[3], sum[3] = {0}, J[9], R[9], ahead[3], behind[3];
        enum { STEPS = 2000 };
        for (int s = 0; s < STEPS; s++) {
            double part[3];
            for (int d = 0; d < 3; d++) part[d] = w[d] * (s + 0.5) / STEPS;
            ref_rotation(part, R);
            for (int d = 0; d < 3; d++) sum[d] += sm_dot(R + 3 * d, v) / STEPS;
        }
        ref_rotation_mean(w, v, mean);
        for (int d = 0; d < 3; d++) assert_true(fabs(mean[d] - sum[d]) < 3e-6);
        ref_rotation_slope(w, v, J);
        for (int e = 0; e < 3; e++) {
            double w2[3] = {w[0], w[1], w[2]}, step = 1e-5;
            w2[e] += step;
            ref_rotation_mean(w2, v, ahead);
            w2[e] -= 2 * step;
            ref_rotation_mean(w2, v, behind);
            for (int d = 0; d < 3; d++)
                assert_true(fabs((ahead[d] - behind[d]) / (2 * step) - J[3 * d + e]) < 1e-8);
        }
        ref_rotation(w, R);
        assert_true(fabs(R[0] + R[4] + R[8] - 1 - 2 * cos(scale[n])) < 1e-12);
    }
}

/* Modes that turn a beam by 90 degrees: warping keeps its length, where linear modes stretch it by
 * 86%. */
TEST(a_turned_beam_keeps_its_length)
{
    needs_solver();
    static const RefDamping none = {0};
    Beam beam = beam_create(false, &none);
    size_t unknowns = 3 * (size_t)beam.body.nodes.count;
    double *u = sm_alloc(unknowns, sizeof *u), *Mu = sm_alloc(unknowns, sizeof *Mu);
    double rest = middle_line(&beam), now[3];
    for (long n = 0; n < beam.body.nodes.count; n++) { /* half pi times z x (x - (0, 1/2, 1/2)) */
        u[3 * n] = -acos(0) * (beam.body.nodes.position[n][1] - 0.5);
        u[3 * n + 1] = acos(0) * beam.body.nodes.position[n][0];
    }
    ref_sparse_apply(&beam.body.matrices.mass, 3, u, Mu);
    for (int k = 0; k < MODES; k++)
        for (size_t n = 0; n < unknowns; n++)
            beam.motion.z[k] += beam.modes.shape[n * MODES + (size_t)k] * Mu[n];
    ref_motion_pose(&beam.motion);
    assert_true(fabs(middle_line(&beam) / rest - 1) < 1e-8);
    place(&beam, (double[]){7.5, 0.5, 0.5}, now); /* its middle went by half pi times 4 */
    double wanted[3] = {4, 0.5 + 4 * acos(0) + 3.5, 0.5};
    for (int d = 0; d < 3; d++) assert_true(fabs(now[d] - wanted[d]) < 1e-6);
    free(u);
    free(Mu);
    beam_free(&beam);
}

/* A clamped beam in its first mode, its end turned by 45 and by 90 degrees: it gets shorter by 3%
 * and by 12%, which is beyond the 5% that a turn of the whole keeps. Linear modes make it longer,
 * by a sixth and by more than a half. */
TEST(a_bent_beam)
{
    needs_solver();
    static const RefDamping none = {0};
    static const double most[2] = {0.05, 0.13}, linear[2] = {0.15, 0.5};
    Beam beam = beam_create(true, &none);
    RefMotion *motion = &beam.motion;
    double rest = middle_line(&beam);
    for (int n = 0; n < 2; n++) {
        motion->z[0] = 1;
        ref_motion_pose(motion);
        const double *w = motion->rotation[motion->nodes - 1];
        motion->z[0] = (n + 1) * acos(-1) / 4 / sqrt(sm_dot(w, w));
        ref_motion_pose(motion);
        double change = middle_line(&beam) / rest - 1;
        print_message("bent by %d degrees: length %+.1f%%\n", 45 * (n + 1), 100 * change);
        assert_true(fabs(change) < most[n]);
        memcpy(motion->moved, motion->local, (size_t)motion->nodes * sizeof *motion->moved);
        assert_true(middle_line(&beam) / rest - 1 > linear[n]);
    }
    beam_free(&beam);
}

/* Held by one orientation alone, which turns by 90 degrees, a free beam turns with it and keeps its
 * length. */
TEST(an_orientation_turns_a_beam)
{
    needs_solver();
    static const RefDamping some = {0.5, 1e-2};
    Beam beam = beam_create(false, &some);
    double rest = middle_line(&beam), first[3], last[3];
    int hold =
        ref_motion_hold(&beam.body, REF_HOLD_ROTATION, (double[]){4, 0.5, 0.5}, &beam.motion);
    for (int step = 0; step < 1200; step++) {
        beam.motion.hold[hold].target[2] = acos(0) * fmin(step / 300.0, 1);
        ref_motion_step(&beam.motion, 0.02);
    }
    place(&beam, (double[]){1, 0.5, 0.5}, first);
    place(&beam, (double[]){7, 0.5, 0.5}, last);
    assert_true(fabs(middle_line(&beam) / rest - 1) < 1e-6);
    assert_true(fabs(last[0] - first[0]) < 1e-4 && fabs(last[1] - first[1] - 6) < 1e-4);
    beam_free(&beam);
}

/* Where eq. 28 has the point s of an arc of curvature k that is clamped at its root. */
static void arc_point(double k, double s, double x[3])
{
    x[0] = s * cos(k * s / 2) * cos(k * s / 2);
    x[1] = s * cos(k * s / 2) * sin(k * s / 2);
    x[2] = 0;
}

/* Such an arc, alone as a mode, is where motion.h says, and that line is shorter than s. Nodes
 * above and below the middle line have it between them. */
TEST(an_arc_is_shorter)
{
    static const RefDamping none = {0};
    static const double shorter[2] = {0.050, 0.172}; /* its end turned by 45 and 90 degrees */
    RefBodyOptions options = {.cell = cell, .basis = REF_MLS_LINEAR, .material = steel};
    RefBody body = brick_body(size, &options);
    double *shape = sm_alloc(3 * (size_t)body.nodes.count, sizeof *shape), lambda = 1;
    RefModes modes = {body.nodes.count, 1, &lambda, shape};
    RefMotion motion;
    for (long n = 0; n < body.nodes.count; n++) {
        const double *x = body.nodes.position[n];
        shape[3 * n] = -x[0] * (x[1] - 0.5);
        shape[3 * n + 1] = 0.5 * x[0] * x[0];
    }
    ref_motion_create(&body, &modes, &none, &motion);
    for (int n = 0; n < 2; n++) {
        double k = motion.z[0] = (n + 1) * acos(-1) / 4 / size[0], middle[32][4] = {{0}},
               length = 0;
        ref_motion_pose(&motion);
        for (long i = 0; i < body.nodes.count; i++) {
            const double *x = body.nodes.position[i], *moved = motion.moved[i];
            double *column = middle[(int)(x[0] / cell)];
            if (fabs(x[1] - 0.5) > cell) continue;
            column[0] += x[0] + moved[0];
            column[1] += x[1] + moved[1] - 0.5;
            column[3]++;
        }
        for (int c = 4; c < 28; c++) { /* the ends' curl is that of few nodes */
            double wanted[3];
            arc_point(k, (c + 0.5) * cell, wanted);
            for (int d = 0; d < 2; d++)
                assert_true(fabs(middle[c][d] / middle[c][3] - wanted[d]) < 1e-9);
        }
        for (int p = 0; p < 1000; p++) {
            double from[3], to[3];
            arc_point(k, size[0] * p / 1000, from);
            arc_point(k, size[0] * (p + 1) / 1000, to);
            length += hypot(to[0] - from[0], to[1] - from[1]);
        }
        assert_true(fabs(1 - length / size[0] - shorter[n]) < 5e-4);
    }
    ref_motion_free(&motion);
    free(shape);
    ref_body_free(&body);
}

/* Thrown while it spins and swings, a free body's centre of mass follows its parabola. */
TEST(a_thrown_body_follows_its_parabola)
{
    needs_solver();
    static const RefDamping some = {0, 1e-3};
    static const double g[3] = {0, -9.81, 0}, h = 0.01;
    Beam beam = beam_create(false, &some);
    RefMotion *motion = &beam.motion;
    size_t nodes = (size_t)beam.body.nodes.count;
    double(*push)[3] = sm_alloc(nodes, sizeof *push), mass = 0, speed[3] = {0}, off = 0, turned = 0;
    for (size_t n = 0; n < nodes; n++) { /* upwards at one end, where nodes are: it swings, too */
        push[n][0] = 20;
        push[n][1] = 60 * beam.body.nodes.position[n][0] - 100;
        push[n][2] = n % 7;
    }
    ref_motion_gravity(&beam.body, g, motion);
    for (size_t n = 0; n < nodes; n++) mass += motion->force[n][1] / g[1];
    for (size_t n = 0; n < nodes; n++)
        for (int d = 0; d < 3; d++) speed[d] += push[n][d] / mass;
    ref_motion_pose(motion);
    ref_motion_push((const double(*)[3])push, motion);
    for (int step = 1; step <= 200; step++) {
        double centre[3] = {0};
        ref_motion_step(motion, h);
        for (size_t n = 0; n < nodes; n++)
            for (int d = 0; d < 3; d++)
                centre[d] += motion->force[n][1] / g[1] / mass * motion->moved[n][d];
        for (int d = 0; d < 3; d++)
            off = fmax(
                off, fabs(centre[d] - step * h * speed[d] - g[d] * h * h * step * (step + 1) / 2));
        turned = fmax(turned, sqrt(sm_dot(motion->rotation[0], motion->rotation[0])));
    }
    print_message("off its parabola by %.1e, turned by %.1f rad\n", off, turned);
    assert_true(off < 1e-6 && turned > 3);
    free(push);
    beam_free(&beam);
}

TEST(energy_never_grows)
{
    needs_solver();
    static const RefDamping dampings[2] = {{0, 0}, {0.5, 1e-3}};
    for (int n = 0; n < 2; n++) {
        Beam beam = beam_create(true, dampings + n);
        for (int k = 0; k < MODES; k++) beam.motion.speed[k] = k % 3 - 0.7;
        double before = ref_motion_energy(&beam.motion), first = before;
        for (int step = 0; step < 300; step++) {
            ref_motion_step(&beam.motion, step % 2 ? 1e-3 : 0.03);
            double now = ref_motion_energy(&beam.motion);
            assert_true(now <= before);
            before = now;
        }
        assert_true(before < first);
        beam_free(&beam);
    }
}

/* A little gravity bends it as the static solve of all nodes does. */
TEST(sag)
{
    needs_solver();
    static const RefDamping strong = {2, 0};
    static const double g[3] = {0, -0.01, 0}, end[3] = {7.9, 0.5, 0.5};
    Beam beam = beam_create(true, &strong);
    double now[3];
    ref_motion_gravity(&beam.body, g, &beam.motion);
    ref_motion_pose(&beam.motion);
    for (int step = 0; step < 2000; step++) ref_motion_step(&beam.motion, 0.01);
    place(&beam, end, now);
    double wanted = 1000 * 0.01 * pow(8, 4) / (8 * 1e7 / 12.0); /* q L^4 / 8 E I */
    print_message("sag %g of %g\n", 0.5 - now[1], wanted);
    assert_true(fabs((0.5 - now[1]) / wanted - 1) < 0.02);
    beam_free(&beam);
}

/* One end stays, the other is led away and turned by 90 degrees, then back in one step: both
 * constraints hold at every step. */
TEST(constraints_hold)
{
    needs_solver();
    static const RefDamping some = {1, 1e-3};
    static const double ends[2][3] = {{0, 0.5, 0.5}, {8, 0.5, 0.5}};
    Beam beam = beam_create(false, &some);
    int hold[4];
    for (int n = 0; n < 4; n++)
        hold[n] = ref_motion_hold(&beam.body, n % 2 ? REF_HOLD_ROTATION : REF_HOLD_POSITION,
                                  ends[n / 2], &beam.motion);
    assert_int_equal(hold[3], 3);
    assert_int_equal(
        ref_motion_hold(&beam.body, REF_HOLD_POSITION, (double[]){99, 0, 0}, &beam.motion), -1);
    double most = 0;
    for (int step = 0; step < 400; step++) {
        double share = step < 399 ? fmin(step / 300.0, 1) : 0, now[3], off[3];
        beam.motion.hold[2].target[0] = -2 * share;
        beam.motion.hold[2].target[1] = 2.5 * share;
        beam.motion.hold[3].target[2] = acos(0) * share;
        ref_motion_step(&beam.motion, 0.01);
        assert_true(step == 399 || ref_motion_energy(&beam.motion) < 1e7);
        for (int k = 0; k < 4; k++) {
            ref_motion_off(&beam.motion, k, off);
            for (int d = 0; d < 3; d++) most = at_worst(most, fabs(off[d]));
        }
        place(&beam, ends[1], now);
        for (int d = 0; d < 3; d++)
            most = at_worst(most, fabs(now[d] - ends[1][d] - beam.motion.hold[2].target[d]));
    }
    print_message("constraints off by %.1e at most\n", most);
    assert_true(most < 1e-9);
    beam_free(&beam);
}

/* One point in two places, and more constraints than modes: nothing blows up. */
TEST(constraints_that_cannot_hold)
{
    needs_solver();
    static const RefDamping some = {1, 1e-3};
    Beam beam = beam_create(false, &some);
    for (int n = 0; n < 20; n++) {
        double x[3] = {0.4 * n + 0.1, 0.5, 0.5};
        assert_true(ref_motion_hold(&beam.body, n % 2 ? REF_HOLD_ROTATION : REF_HOLD_POSITION, x,
                                    &beam.motion) >= 0);
    }
    int again =
        ref_motion_hold(&beam.body, REF_HOLD_POSITION, (double[]){0.1, 0.5, 0.5}, &beam.motion);
    beam.motion.hold[again].target[1] = 0.1;
    for (int step = 0; step < 100; step++) {
        ref_motion_step(&beam.motion, 0.01);
        for (int k = 0; k < MODES; k++) assert_true(fabs(beam.motion.z[k]) < 1e4);
    }
    beam_free(&beam);
}

/* Amplitudes that turn nodes too far are taken back by one share; what is not finite, to none. */
TEST(turned_too_far)
{
    needs_solver();
    static const RefDamping some = {1, 1e-3};
    Beam beam = beam_create(true, &some);
    RefMotion *motion = &beam.motion;
    double before[MODES], turn = 0;
    for (int k = 0; k < MODES; k++) motion->z[k] = before[k] = 300 + k;
    motion->speed[2] = 7;
    ref_motion_pose(motion);
    for (long n = 0; n < motion->nodes; n++)
        turn = fmax(turn, sqrt(sm_dot(motion->rotation[n], motion->rotation[n])));
    ref_motion_confine(motion, 1.1 * turn);
    assert_memory_equal(motion->z, before, sizeof before);
    ref_motion_confine(motion, 0.9 * turn);
    for (int k = 0; k < MODES; k++) assert_true(fabs(motion->z[k] / before[k] - 0.9) < 1e-12);
    assert_true(fabs(motion->speed[2] / 7 - 0.9) < 1e-12);
    motion->z[3] = NAN;
    ref_motion_pose(motion);
    ref_motion_confine(motion, turn);
    for (int k = 0; k < MODES; k++) assert_true(motion->z[k] == 0 && motion->speed[k] == 0);
    assert_true(isfinite(motion->moved[0][0]));
    beam_free(&beam);
}
