#include "grip.h"

#include <float.h>
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/engine/boundary.h"
#include "../../../lib/vector.h"
#include "../solve/least_squares.h"
#include "rotation.h"

/* Functions that are to become modes, [unknowns] each, M-orthonormal so far. */
typedef struct {
    const RefBody *body;
    size_t unknowns;
    int count, room;
    double *u, *Mu;
} Space;

static double square_between(const double a[3], const double b[3])
{
    double way[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sm_dot(way, way);
}

/* Whether the points spread in two directions: whether the second largest moment about the middle
 * is more than a trace of the largest. */
static bool spreads(const RefGrip *grip)
{
    double far = 0, wide = 0, along[3] = {0}, across[3];
    for (int n = 0; n < grip->count; n++) {
        double way[3];
        for (int d = 0; d < 3; d++) way[d] = grip->x[n][d] - grip->middle[d];
        if (sm_dot(way, way) <= far) continue;
        far = sm_dot(way, way);
        memcpy(along, way, sizeof along);
    }
    for (int n = 0; n < grip->count; n++) {
        double way[3];
        for (int d = 0; d < 3; d++) way[d] = grip->x[n][d] - grip->middle[d];
        sm_cross(along, way, across);
        wide = fmax(wide, sm_dot(across, across));
    }
    return wide > 1e-3 * far * far;
}

RefGrip ref_grip_choose(long count, const double (*x)[3], double apart, int most)
{
    RefGrip grip = {.x = sm_alloc((size_t)most, sizeof *grip.x)};
    double *least = sm_alloc((size_t)count, sizeof *least), middle[3] = {0};
    for (long p = 0; p < count; p++)
        for (int d = 0; d < 3; d++) middle[d] += x[p][d] / (double)count;
    for (long p = 0; p < count; p++) least[p] = square_between(x[p], middle);
    while (grip.count < most) {
        long best = 0;
        for (long p = 1; p < count; p++)
            if (least[p] > least[best]) best = p;
        if (grip.count > 0 && least[best] < apart * apart) break;
        if (grip.count == 0)
            for (long p = 0; p < count; p++) least[p] = INFINITY;
        memcpy(grip.x[grip.count++], x[best], sizeof x[best]);
        for (long p = 0; p < count; p++) least[p] = fmin(least[p], square_between(x[p], x[best]));
    }
    free(least);
    for (int n = 0; n < grip.count; n++)
        for (int d = 0; d < 3; d++) grip.middle[d] += grip.x[n][d] / grip.count;
    grip.rigid = spreads(&grip);
    return grip;
}

void ref_grip_free(RefGrip *grip)
{
    free(grip->x);
    *grip = (RefGrip){0};
}

/* One of six: a displacement along an axis, or a small turn about it. */
static void rigid_at(int kind, const double x[3], const double middle[3], double u[3])
{
    double axis[3] = {kind % 3 == 0, kind % 3 == 1, kind % 3 == 2}, way[3];
    for (int d = 0; d < 3; d++) {
        u[d] = axis[d];
        way[d] = x[d] - middle[d];
    }
    if (kind >= 3) sm_cross(axis, way, u);
}

/* Adds u, or what is left of it beside the others, if that is more than rounding. */
static void add(Space *space, const double *u)
{
    double *own = space->u + (size_t)space->count * space->unknowns;
    double *mass = space->Mu + (size_t)space->count * space->unknowns, before = 0, norm = 0;
    if (space->count == space->room) return;
    memcpy(own, u, space->unknowns * sizeof *own);
    for (int round = 0; round < 3; round++) {
        ref_sparse_apply(&space->body->matrices.mass, 3, own, mass);
        norm = 0;
        for (size_t n = 0; n < space->unknowns; n++) norm += own[n] * mass[n];
        if (round == 0) before = norm;
        if (!(norm > 1e-12 * before) || round == 2) break;
        for (int k = 0; k < space->count; k++) {
            const double *other = space->u + (size_t)k * space->unknowns;
            const double *other_mass = space->Mu + (size_t)k * space->unknowns;
            double share = 0;
            for (size_t n = 0; n < space->unknowns; n++) share += own[n] * other_mass[n];
            for (size_t n = 0; n < space->unknowns; n++) own[n] -= share * other[n];
        }
    }
    if (!(norm > 1e-12 * before && norm > 0)) return;
    for (size_t n = 0; n < space->unknowns; n++) {
        own[n] /= sqrt(norm);
        mass[n] /= sqrt(norm);
    }
    space->count++;
}

static RefRows rows_of(const RefBody *body, int grips, const RefGrip *grip)
{
    RefRows rows = {0};
    RefShape shape = ref_shape_create(&body->nodes);
    for (int k = 0; k < grips; k++)
        for (int n = 0; n < grip[k].count; n++)
            if (ref_mls_at(&body->nodes, body->basis, grip[k].x[n], &shape))
                for (int d = 0; d < 3; d++) ref_rows_displacement(&rows, &shape, d);
    ref_shape_free(&shape);
    return rows;
}

/* What is left at rest, moves as a whole, or answers at once. */
static void add_static(const RefBody *body, RefSolver *solver, int grips, const RefGrip *grip,
                       long rows, Space *space)
{
    double *u = sm_alloc(space->unknowns, sizeof *u),
           *load = sm_alloc(space->unknowns, sizeof *load);
    double *target = sm_alloc((size_t)rows, sizeof *target);
    for (int kind = 0; kind < 6; kind++) {
        for (long n = 0; n < body->nodes.count; n++)
            rigid_at(kind, body->nodes.position[n], grip[0].middle, u + 3 * n);
        add(space, u);
    }
    for (int k = 1, row = 3 * grip[0].count; k < grips; row += 3 * grip[k++].count)
        for (int kind = 0; kind < 6; kind++) {
            memset(target, 0, (size_t)rows * sizeof *target);
            for (int n = 0; n < grip[k].count; n++)
                rigid_at(kind, grip[k].x[n], grip[k].middle, target + row + 3 * n);
            ref_solver_solve(solver, NULL, target, u);
            add(space, u);
        }
    for (int axis = 0; axis < 3; axis++) {
        for (size_t n = 0; n < space->unknowns; n++) u[n] = n % 3 == (size_t)axis;
        ref_sparse_apply(&body->matrices.mass, 3, u, load);
        ref_solver_solve(solver, load, NULL, u);
        add(space, u);
    }
    sm_free_all(u, load, target);
}

/* K is made diagonal over the space: its modes. */
static void rayleigh_ritz(const Space *space, RefModes *modes)
{
    size_t count = (size_t)space->count, unknowns = space->unknowns;
    double *Ku = sm_alloc(unknowns, sizeof *Ku);
    gsl_matrix *K = gsl_matrix_alloc(count, count), *turn = gsl_matrix_alloc(count, count);
    gsl_vector *value = gsl_vector_alloc(count);
    for (size_t a = 0; a < count; a++) {
        ref_sparse_apply(&space->body->matrices.stiffness, 1, space->u + a * unknowns, Ku);
        for (size_t b = 0; b < count; b++) {
            double sum = 0;
            for (size_t n = 0; n < unknowns; n++) sum += space->u[b * unknowns + n] * Ku[n];
            gsl_matrix_set(K, a, b, sum);
        }
    }
    gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(count);
    gsl_eigen_symmv(K, value, turn, work);
    gsl_eigen_symmv_sort(value, turn, GSL_EIGEN_SORT_VAL_ASC);
    *modes = (RefModes){.nodes = (long)(unknowns / 3), .count = (int)count};
    modes->lambda = sm_alloc(count, sizeof *modes->lambda);
    modes->shape = sm_alloc(unknowns * count, sizeof *modes->shape);
    for (size_t k = 0; k < count; k++) {
        modes->lambda[k] = gsl_vector_get(value, k);
        for (size_t a = 0; a < count; a++) {
            double share = gsl_matrix_get(turn, a, k);
            for (size_t n = 0; n < unknowns; n++)
                modes->shape[n * count + k] += share * space->u[a * unknowns + n];
        }
    }
    gsl_eigen_symmv_free(work);
    gsl_matrix_free(K);
    gsl_matrix_free(turn);
    gsl_vector_free(value);
    free(Ku);
}

static void add_modes(const RefModes *own, Space *space)
{
    double *u = sm_alloc(space->unknowns, sizeof *u);
    for (int k = 0; k < own->count; k++) {
        for (size_t n = 0; n < space->unknowns; n++)
            u[n] = own->shape[n * (size_t)own->count + (size_t)k];
        add(space, u);
    }
    free(u);
}

SmCode ref_grip_modes(const RefBody *body, int grips, const RefGrip *grip, int count,
                      RefModes *modes, SmError *error)
{
    Space space = {.body = body, .unknowns = 3 * (size_t)body->nodes.count};
    RefRows rows = rows_of(body, grips, grip);
    RefSolver *solver;
    RefModes own = {0};
    int answers = 6 * grips + 3,
        free_ones = count - answers > count / 2 ? count - answers : count / 2;
    *modes = (RefModes){0};
    double shift = ref_modes_shift(&body->matrices);
    SmCode code = ref_solver_create(&body->matrices, shift, &rows, &solver, error);
    if (code == SM_OK) {
        int left = ((int)space.unknowns - ref_solver_rank(solver)) / 2;
        if (free_ones > left) free_ones = left;
        if (free_ones > 0)
            code = ref_modes_of(&body->matrices, solver, shift, free_ones, &own, error);
        if (code == SM_OK) {
            space.room = answers + free_ones;
            size_t room = ((size_t)space.room + 1) * space.unknowns;
            space.u = sm_alloc(room, sizeof *space.u);
            space.Mu = sm_alloc(room, sizeof *space.Mu);
            add_static(body, solver, grips, grip, rows.count, &space);
            add_modes(&own, &space);
            rayleigh_ritz(&space, modes);
        }
        ref_solver_destroy(solver);
    }
    ref_modes_free(&own);
    ref_rows_free(&rows);
    free(space.u);
    free(space.Mu);
    return code;
}

/* The grip's six functions of z: the mean displacement of its points, and the turn about their
 * middle that fits best; [6][modes]. Weights of the mean are added to `anchor`, [nodes]. */
static double *frame_of(const RefBody *body, const RefGrip *grip, const RefMotion *motion,
                        double *anchor)
{
    size_t modes = (size_t)motion->modes;
    RefShape shape = ref_shape_create(&body->nodes);
    double *frame = sm_alloc(6 * modes, sizeof *frame), *moment = frame + 3 * modes,
           inertia[9] = {0};
    for (int p = 0; p < grip->count; p++) {
        double way[3];
        for (int d = 0; d < 3; d++) way[d] = grip->x[p][d] - grip->middle[d];
        for (int d = 0; d < 3; d++)
            for (int e = 0; e < 3; e++)
                inertia[3 * d + e] += (d == e ? sm_dot(way, way) : 0) - way[d] * way[e];
        ref_mls_at(&body->nodes, body->basis, grip->x[p], &shape);
        for (int n = 0; n < shape.count; n++) {
            const double *row = motion->row + (size_t)shape.node[n] * 6 * modes;
            anchor[shape.node[n]] += shape.value[n] / grip->count;
            for (size_t d = 0; d < 3; d++) {
                size_t e = (d + 1) % 3, f = (d + 2) % 3;
                for (size_t k = 0; k < modes; k++) {
                    frame[d * modes + k] += shape.value[n] / grip->count * row[d * modes + k];
                    moment[d * modes + k] += shape.value[n] * (way[e] * row[f * modes + k] -
                                                               way[f] * row[e * modes + k]);
                }
            }
        }
    }
    for (size_t k = 0; k < modes; k++) {
        double matrix[9], turn[3] = {moment[k], moment[modes + k], moment[2 * modes + k]};
        memcpy(matrix, inertia, sizeof matrix);
        ref_least_squares_solve(3, 0, matrix, turn);
        for (size_t d = 0; d < 3; d++) moment[d * modes + k] = turn[d];
    }
    ref_shape_free(&shape);
    return frame;
}

/* All nodes that cover the grip's points turn with it. */
static void turn_nodes(const RefBody *body, const RefGrip *grip, const double *frame,
                       RefMotion *motion)
{
    size_t modes = (size_t)motion->modes;
    RefShape shape = ref_shape_create(&body->nodes);
    for (int p = 0; p < grip->count; p++) {
        ref_mls_at(&body->nodes, body->basis, grip->x[p], &shape);
        for (int n = 0; n < shape.count; n++)
            memcpy(motion->row + ((size_t)shape.node[n] * 6 + 3) * modes, frame + 3 * modes,
                   3 * modes * sizeof *frame);
    }
    ref_shape_free(&shape);
}

void ref_grip_bind(const RefBody *body, int grips, RefGrip *grip, RefMotion *motion)
{
    bool anchored = false;
    for (int k = 0; k < grips; k++) {
        grip[k].hold = motion->holds;
        if (!grip[k].rigid) {
            for (int p = 0; p < grip[k].count; p++)
                ref_motion_hold(body, REF_HOLD_POSITION, grip[k].x[p], motion);
            continue;
        }
        double *anchor = sm_alloc((size_t)motion->nodes, sizeof *anchor);
        double *frame = frame_of(body, grip + k, motion, anchor);
        turn_nodes(body, grip + k, frame, motion);
        if (!anchored) ref_motion_anchor(anchor, motion);
        anchored = true;
        ref_motion_hold_rows(frame, motion);
        ref_motion_hold_rows(frame + 3 * motion->modes, motion);
        free(frame);
        free(anchor);
    }
}

static void displacement(const double x[3], const double shift[3], const double pose[3][4],
                         double way[3])
{
    double from[3], to[3];
    for (int d = 0; d < 3; d++) from[d] = x[d] + shift[d];
    sm_pose_apply(pose, from, to);
    for (int d = 0; d < 3; d++) way[d] = to[d] - from[d];
}

/* A grip's middle, beside the anchor's displacement t, is displaced by Rt (its local displacement -
 * t). */
void ref_grip_aim(int grips, const RefGrip *grip, const double shift[3], const double (*pose)[3][4],
                  RefMotion *motion)
{
    bool anchored = false;
    double t[3] = {0}, way[3];
    for (int k = 0; k < grips; k++) {
        RefHold *hold = motion->hold + grip[k].hold;
        for (int p = 0; !grip[k].rigid && p < grip[k].count; p++)
            displacement(grip[k].x[p], shift, pose[k], hold[p].target);
        if (!grip[k].rigid) continue;
        double R[9], *turn = hold[1].target;
        for (int n = 0; n < 9; n++) R[n] = pose[k][n / 3][n % 3];
        ref_rotation_vector(R, turn, turn);
        displacement(grip[k].middle, shift, pose[k], way);
        if (!anchored) memcpy(t, way, sizeof t);
        anchored = true;
        for (int d = 0; d < 3; d++) way[d] -= t[d];
        ref_rotation_unmean(turn, way, hold[0].target);
        for (int d = 0; d < 3; d++) hold[0].target[d] += t[d];
    }
}
