/* Bodies that handles grip at many points: their modes, and where moved handles take the points. */
#include "../../../lib/test_fields.h"
#include "../../../lib/test_frame.h"
#include "../../../lib/vector.h"
#include "../test_beam.h"
#include "grip_modes.h"

static const double size[3] = {4, 1, 1};
enum { SIDE = 5, LAYERS = 3, HELD = SIDE * SIDE * LAYERS, MODES = 48 };

/* A lattice of points in the last half of the beam's one end or the other. */
static void end_points(bool far, double (*x)[3])
{
    for (int n = 0; n < HELD; n++) {
        x[n][0] = (far ? size[0] - 0.5 : 0) + 0.25 * (n / (SIDE * SIDE));
        x[n][1] = 0.25 * (n % SIDE);
        x[n][2] = 0.25 * (n / SIDE % SIDE);
    }
}

typedef struct {
    RefBody body;
    RefGrip grip[2];
    RefModes modes;
    RefMotion motion;
} Held;

static Held held_create(int grips, int points)
{
    static const RefDamping some = {2, 1e-2};
    Held held = {0};
    double x[2 * HELD][3];
    RefBodyOptions options = {.cell = 0.25, .basis = REF_MLS_LINEAR, .material = steel};
    end_points(false, x);
    end_points(true, x + HELD);
    held.body = brick_body_showing(size, &options, 2 * HELD, (const double(*)[3])x);
    for (int k = 0; k < grips; k++)
        held.grip[k] = ref_grip_choose(HELD, (const double(*)[3])(x + (k ? HELD : 0)), 0.2, points);
    assert_int_equal(ref_grip_modes(&held.body, grips, held.grip, MODES, &held.modes, NULL), SM_OK);
    ref_motion_create(&held.body, &held.modes, &some, &held.motion);
    ref_grip_bind(&held.body, grips, held.grip, &held.motion);
    return held;
}

static void held_free(Held *held)
{
    for (int k = 0; k < 2; k++) ref_grip_free(held->grip + k);
    ref_motion_free(&held->motion);
    ref_modes_free(&held->modes);
    ref_body_free(&held->body);
}

/* M-orthonormal, rising, six of them rigid. */
TEST(modes_of_a_held_body)
{
    needs_solver();
    Held held = held_create(2, 24);
    const RefModes *modes = &held.modes;
    size_t unknowns = 3 * (size_t)modes->nodes, count = (size_t)modes->count;
    double *Mu = sm_alloc(unknowns * count, sizeof *Mu);
    assert_int_equal(modes->count, MODES);
    ref_sparse_apply(&held.body.matrices.mass, 3 * modes->count, modes->shape, Mu);
    for (size_t a = 0; a < count; a++) {
        assert_true(a == 0 || modes->lambda[a] >= modes->lambda[a - 1]);
        for (size_t b = 0; b < count; b++) {
            double product = 0;
            for (size_t n = 0; n < unknowns; n++)
                product += modes->shape[n * count + a] * Mu[n * count + b];
            assert_true(fabs(product - (a == b)) < 1e-9);
        }
    }
    for (int k = 0; k < 6; k++) assert_true(fabs(modes->lambda[k]) < 1e-6 * modes->lambda[6]);
    free(Mu);
    held_free(&held);
}

/* How far the grips' points are from where the poses have them. */
static double miss(const Held *held, int grips, const double (*pose)[3][4])
{
    RefShape shape = ref_shape_create(&held->body.nodes);
    double most = 0;
    for (int k = 0; k < grips; k++)
        for (int p = 0; p < held->grip[k].count; p++) {
            const double *x = held->grip[k].x[p];
            assert_true(ref_mls_at(&held->body.nodes, REF_MLS_LINEAR, x, &shape));
            for (int d = 0; d < 3; d++) {
                double off = x[d] - sm_dot(pose[k][d], x) - pose[k][d][3];
                for (int n = 0; n < shape.count; n++)
                    off += shape.value[n] * held->motion.moved[shape.node[n]][d];
                most = at_worst(most, fabs(off));
            }
        }
    ref_shape_free(&shape);
    return most;
}

/* One end goes up and is turned about the beam by half a circle and more, the other is turned a
 * little and led away: under gravity all points are where they should be, at every step. */
TEST(moved_handles_are_met)
{
    needs_solver();
    Held held = held_create(2, 24);
    static const double g[3] = {0, -9.81, 0}, nowhere[3] = {0};
    double most = 0;
    ref_motion_gravity(&held.body, g, &held.motion);
    for (int step = 1; step <= 200; step++) {
        double share = fmin(step / 150.0, 1), a = 3.8 * share, b = 0.4 * share;
        const double pose[2][3][4] = {
            {{1, 0, 0, 0}, {0, cos(a), -sin(a), 0.5 * share}, {0, sin(a), cos(a), 0}},
            {{cos(b), -sin(b), 0, share}, {sin(b), cos(b), 0, 0}, {0, 0, 1, 0.3 * share}}};
        ref_grip_aim(2, held.grip, nowhere, pose, &held.motion);
        ref_motion_step(&held.motion, 0.01);
        most = fmax(most, miss(&held, 2, pose));
    }
    print_message("points off by %.1e at most\n", most);
    assert_true(most < 1e-6);
    held_free(&held);
}

/* Points of a handle that do not say how it is turned are bound one by one; the body hangs. */
TEST(a_handle_of_one_point)
{
    needs_solver();
    static const double g[3] = {0, -1, 0}, nowhere[3] = {0};
    static const double still[1][3][4] = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    Held held = held_create(1, 1);
    double lowest = 0;
    assert_false(held.grip[0].rigid);
    ref_motion_gravity(&held.body, g, &held.motion);
    for (int step = 0; step < 100; step++) {
        ref_grip_aim(1, held.grip, nowhere, still, &held.motion);
        ref_motion_step(&held.motion, 0.01);
        assert_true(miss(&held, 1, still) < 1e-6);
    }
    for (long n = 0; n < held.motion.nodes; n++) lowest = fmin(lowest, held.motion.moved[n][1]);
    assert_true(lowest < -0.1);
    held_free(&held);
}

/* A motion taken over by other modes is where it was, and as fast. */
TEST(taken_over)
{
    needs_solver();
    static const double nowhere[3] = {0}, h = 0.01;
    Held held = held_create(1, 24);
    RefModes modes;
    RefMotion after;
    double off = 0, fast = 0;
    for (int step = 1; step <= 100; step++) {
        double a = 0.01 * step;
        const double pose[1][3][4] = {
            {{cos(a), -sin(a), 0, 0.02 * step}, {sin(a), cos(a), 0, 0}, {0, 0, 1, 0}}};
        ref_grip_aim(1, held.grip, nowhere, pose, &held.motion);
        ref_motion_step(&held.motion, h);
    }
    assert_int_equal(ref_modes_find(&held.body.matrices, NULL, MODES, &modes, NULL), SM_OK);
    ref_motion_create(&held.body, &modes, &held.motion.damping, &after);
    ref_motion_take(&held.body, &held.motion, h, &after);
    for (long n = 0; n < after.nodes; n++)
        for (int d = 0; d < 3; d++) {
            off = at_worst(off, fabs(after.moved[n][d] - held.motion.moved[n][d]));
            fast = fmax(fast, fabs(after.moved[n][d]));
        }
    print_message("off by %.1e of %.1f\n", off, fast);
    assert_true(off < 0.02 * fast);
    ref_motion_free(&after);
    ref_modes_free(&modes);
    held_free(&held);
}
