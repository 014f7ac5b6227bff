#include "motion.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/vector.h"
#include "rotation.h"

enum { MOST_CORRECTIONS = 8 };
static const double met = 1e-10; /* constraints that miss by less need no correction */

static void hold_free(RefHold *hold)
{
    free(hold->node);
    free(hold->value);
    free(hold->turn);
}

void ref_motion_release(RefMotion *motion)
{
    for (int k = 0; k < motion->holds; k++) hold_free(motion->hold + k);
    free(motion->hold);
    motion->hold = NULL;
    motion->holds = 0;
}

void ref_motion_free(RefMotion *motion)
{
    ref_motion_release(motion);
    free(motion->lambda);
    free(motion->row);
    free(motion->z);
    free(motion->speed);
    free(motion->load);
    free(motion->rotation);
    free(motion->local);
    free(motion->moved);
    free(motion->force);
    *motion = (RefMotion){0};
}

/* Half the modes' curl where the shape functions were taken, [3][modes]: added to `turn`. */
static void curl(const RefMotion *motion, const RefShape *shape, double *turn)
{
    size_t modes = (size_t)motion->modes;
    for (int n = 0; n < shape->count; n++) {
        const double *psi = motion->row + (size_t)shape->node[n] * 6 * modes;
        for (size_t a = 0; a < 3; a++) {
            size_t b = (a + 1) % 3, c = (a + 2) % 3;
            for (size_t k = 0; k < modes; k++)
                turn[a * modes + k] += 0.5 * (shape->gradient[n][b] * psi[c * modes + k] -
                                              shape->gradient[n][c] * psi[b * modes + k]);
        }
    }
}

/* Every node's rows, and how large the body is. */
static void fill_rows(const RefBody *body, const RefModes *modes, RefMotion *motion)
{
    size_t count = (size_t)modes->count;
    RefShape shape = ref_shape_create(&body->nodes);
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t n = 0; n < (size_t)modes->nodes; n++) {
        memcpy(motion->row + n * 6 * count, modes->shape + 3 * n * count,
               3 * count * sizeof(double));
        for (int d = 0; d < 3; d++) {
            low[d] = fmin(low[d], body->nodes.position[n][d]);
            high[d] = fmax(high[d], body->nodes.position[n][d]);
        }
    }
    for (int d = 0; d < 3; d++) motion->size = fmax(motion->size, high[d] - low[d]);
    for (size_t n = 0; n < (size_t)modes->nodes; n++)
        if (ref_mls_at(&body->nodes, body->basis, body->nodes.position[n], &shape))
            curl(motion, &shape, motion->row + (n * 6 + 3) * count);
    ref_shape_free(&shape);
}

void ref_motion_create(const RefBody *body, const RefModes *modes, const RefDamping *damping,
                       RefMotion *motion)
{
    size_t nodes = (size_t)modes->nodes, count = (size_t)modes->count;
    *motion = (RefMotion){.nodes = modes->nodes, .modes = modes->count, .damping = *damping};
    motion->lambda = sm_alloc(count, sizeof(double));
    motion->row = sm_alloc(nodes * 6 * count, sizeof(double));
    motion->z = sm_alloc(count, sizeof(double));
    motion->speed = sm_alloc(count, sizeof(double));
    motion->load = sm_alloc(count, sizeof(double));
    motion->rotation = sm_alloc(nodes, sizeof(double[3]));
    motion->local = sm_alloc(nodes, sizeof(double[3]));
    motion->moved = sm_alloc(nodes, sizeof(double[3]));
    motion->force = sm_alloc(nodes, sizeof(double[3]));
    for (size_t k = 0; k < count; k++) motion->lambda[k] = fmax(modes->lambda[k], 0);
    fill_rows(body, modes, motion);
}

void ref_motion_gravity(const RefBody *body, const double g[3], RefMotion *motion)
{
    size_t nodes = (size_t)motion->nodes;
    double *one = sm_alloc(nodes, sizeof *one), *mass = sm_alloc(nodes, sizeof *mass);
    for (size_t n = 0; n < nodes; n++) one[n] = 1;
    ref_sparse_apply(&body->matrices.mass, 1, one, mass);
    for (size_t n = 0; n < nodes; n++)
        for (int d = 0; d < 3; d++) motion->force[n][d] = mass[n] * g[d];
    free(one);
    free(mass);
}

int ref_motion_hold(const RefBody *body, RefHoldKind kind, const double x[3], RefMotion *motion)
{
    RefShape shape = ref_shape_create(&body->nodes);
    RefHold hold = {.kind = kind};
    if (ref_mls_at(&body->nodes, body->basis, x, &shape)) {
        size_t count = (size_t)shape.count, modes = (size_t)motion->modes;
        hold.count = shape.count;
        hold.node = sm_alloc(count, sizeof *hold.node);
        hold.value = sm_alloc(count, sizeof *hold.value);
        memcpy(hold.node, shape.node, count * sizeof *hold.node);
        memcpy(hold.value, shape.value, count * sizeof *hold.value);
        hold.turn = sm_alloc(3 * modes, sizeof *hold.turn);
        curl(motion, &shape, hold.turn);
    }
    ref_shape_free(&shape);
    if (!hold.count) return -1;
    motion->hold = sm_realloc(motion->hold, (size_t)motion->holds + 1, sizeof hold);
    motion->hold[motion->holds++] = hold;
    double off[3];
    ref_motion_off(motion, motion->holds - 1, off);
    memcpy(motion->hold[motion->holds - 1].target, off, sizeof off);
    return motion->holds - 1;
}

static double dot(int count, const double *a, const double *b)
{
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (int k = 0; k < count; k++) sum += a[k] * b[k];
    return sum;
}

/* One node: its part of the modal force while its rows are at hand. */
static void pose_node(RefMotion *motion, long n)
{
    int modes = motion->modes;
    const double *row = motion->row + (size_t)n * 6 * (size_t)modes;
    double R[9], f[3];
    for (int d = 0; d < 3; d++) {
        motion->local[n][d] = dot(modes, row + d * modes, motion->z);
        motion->rotation[n][d] = dot(modes, row + (3 + d) * modes, motion->z);
    }
    ref_rotation_mean(motion->rotation[n], motion->local[n], motion->moved[n]);
    const double *F = motion->force[n];
    if (F[0] == 0 && F[1] == 0 && F[2] == 0) return;
    ref_rotation(motion->rotation[n], R);
    for (int d = 0; d < 3; d++) f[d] = R[d] * F[0] + R[3 + d] * F[1] + R[6 + d] * F[2];
    for (int k = 0; k < modes; k++)
        motion->load[k] += f[0] * row[k] + f[1] * row[modes + k] + f[2] * row[2 * modes + k];
}

void ref_motion_pose(RefMotion *motion)
{
    memset(motion->load, 0, (size_t)motion->modes * sizeof *motion->load);
    for (long n = 0; n < motion->nodes; n++) pose_node(motion, n);
}

/* Rotation and local displacement of one node from z. */
static void node_at(const RefMotion *motion, int n, double w[3], double local[3])
{
    const double *row = motion->row + (size_t)n * 6 * (size_t)motion->modes;
    for (int d = 0; d < 3; d++) {
        local[d] = dot(motion->modes, row + d * motion->modes, motion->z);
        w[d] = dot(motion->modes, row + (3 + d) * motion->modes, motion->z);
    }
}

void ref_motion_off(const RefMotion *motion, int number, double off[3])
{
    const RefHold *hold = motion->hold + number;
    for (int d = 0; d < 3; d++) off[d] = -hold->target[d];
    if (hold->kind == REF_HOLD_ROTATION) {
        for (int d = 0; d < 3; d++)
            off[d] += dot(motion->modes, hold->turn + d * motion->modes, motion->z);
        return;
    }
    for (int n = 0; n < hold->count; n++) {
        double w[3], local[3], moved[3];
        node_at(motion, hold->node[n], w, local);
        ref_rotation_mean(w, local, moved);
        for (int d = 0; d < 3; d++) off[d] += hold->value[n] * moved[d];
    }
}

/* d C / d z of one constraint, [3][modes]. */
static void jacobian(const RefMotion *motion, const RefHold *hold, double *J)
{
    size_t modes = (size_t)motion->modes;
    if (hold->kind == REF_HOLD_ROTATION) {
        memcpy(J, hold->turn, 3 * modes * sizeof *J);
        return;
    }
    memset(J, 0, 3 * modes * sizeof *J);
    for (int n = 0; n < hold->count; n++) {
        const double *row = motion->row + (size_t)hold->node[n] * 6 * modes;
        double w[3], local[3], by_local[9], by_turn[9];
        node_at(motion, hold->node[n], w, local);
        ref_rotation_slope(w, local, by_turn);
        for (int e = 0; e < 3; e++) {
            double axis[3] = {e == 0, e == 1, e == 2}, column[3];
            ref_rotation_mean(w, axis, column);
            for (int d = 0; d < 3; d++) by_local[3 * d + e] = column[d];
        }
        for (size_t d = 0; d < 3; d++)
            for (size_t e = 0; e < 3; e++) {
                double a = hold->value[n] * by_local[3 * d + e];
                double b = hold->value[n] * by_turn[3 * d + e];
                for (size_t k = 0; k < modes; k++)
                    J[d * modes + k] += a * row[e * modes + k] + b * row[(3 + e) * modes + k];
            }
    }
}

/* change: A^-1 J^T y with J A^-1 J^T y = right, A diagonal; a trace of regularisation makes rows
 * that follow from others harmless. */
static void bordered(const RefMotion *motion, const double *A, const double *J, const double *right,
                     double *change)
{
    int modes = motion->modes;
    size_t rows = 3 * (size_t)motion->holds;
    double *S = sm_alloc(rows * rows, sizeof *S), *y = sm_alloc(rows, sizeof *y);
    double *scaled = sm_alloc((size_t)modes, sizeof *scaled), trace = 0;
    for (size_t r = 0; r < rows; r++) {
        for (int k = 0; k < modes; k++) scaled[k] = J[r * (size_t)modes + (size_t)k] / A[k];
        for (size_t c = 0; c <= r; c++)
            S[r * rows + c] = S[c * rows + r] = dot(modes, scaled, J + c * (size_t)modes);
        trace += S[r * rows + r];
    }
    for (size_t r = 0; r < rows; r++) S[r * rows + r] += 1e-12 * trace;
    memcpy(y, right, rows * sizeof *y);
    gsl_matrix_view matrix = gsl_matrix_view_array(S, rows, rows);
    gsl_vector_view vector = gsl_vector_view_array(y, rows);
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    bool solved = gsl_linalg_cholesky_decomp1(&matrix.matrix) == GSL_SUCCESS &&
                  gsl_linalg_cholesky_svx(&matrix.matrix, &vector.vector) == GSL_SUCCESS;
    gsl_set_error_handler(handler);
    memset(change, 0, (size_t)modes * sizeof *change);
    for (size_t r = 0; solved && r < rows; r++)
        for (int k = 0; k < modes; k++) change[k] += y[r] * J[r * (size_t)modes + (size_t)k] / A[k];
    free(S);
    free(y);
    free(scaled);
}

/* All constraints' misses; returns the largest, lengths as shares of the body's. */
static double misses(const RefMotion *motion, double *off)
{
    double most = 0;
    for (int k = 0; k < motion->holds; k++) {
        ref_motion_off(motion, k, off + 3 * k);
        double unit = motion->hold[k].kind == REF_HOLD_POSITION ? motion->size : 1;
        for (int d = 0; d < 3; d++) most = fmax(most, fabs(off[3 * k + d]) / unit);
    }
    return most;
}

static void jacobians(const RefMotion *motion, double *J)
{
    for (int k = 0; k < motion->holds; k++)
        jacobian(motion, motion->hold + k, J + 3 * (size_t)k * (size_t)motion->modes);
}

/* J (speed + change) = -C / h, by the least change in A's measure; then z along the new speed, and
 * Newton's steps onto C = 0. */
static void step_held(RefMotion *motion, double h, const double *A)
{
    size_t modes = (size_t)motion->modes, rows = 3 * (size_t)motion->holds;
    double *J = sm_alloc(rows * modes, sizeof *J), *off = sm_alloc(rows, sizeof *off);
    double *change = sm_alloc(modes, sizeof *change), before = INFINITY;
    jacobians(motion, J);
    misses(motion, off);
    for (size_t r = 0; r < rows; r++)
        off[r] = -off[r] / h - dot(motion->modes, J + r * modes, motion->speed);
    bordered(motion, A, J, off, change);
    for (size_t k = 0; k < modes; k++) {
        motion->speed[k] += change[k];
        motion->z[k] += h * motion->speed[k];
    }
    for (int n = 0; n < MOST_CORRECTIONS; n++) {
        double miss = misses(motion, off);
        if (miss < met || !(miss < 0.9 * before)) break;
        before = miss;
        for (size_t r = 0; r < rows; r++) off[r] = -off[r];
        jacobians(motion, J);
        bordered(motion, A, J, off, change);
        for (size_t k = 0; k < modes; k++) motion->z[k] += change[k];
    }
    free(J);
    free(off);
    free(change);
}

void ref_motion_step(RefMotion *motion, double h)
{
    double a = motion->damping.mass_damping, b = motion->damping.stiffness_damping;
    double *A = sm_alloc((size_t)motion->modes, sizeof *A);
    for (int k = 0; k < motion->modes; k++) {
        double lambda = motion->lambda[k], damping = a + b * lambda;
        A[k] = 1 + h * damping + h * h * lambda;
        motion->speed[k] +=
            h *
            (motion->load[k] - lambda * motion->z[k] - (damping + h * lambda) * motion->speed[k]) /
            A[k];
        if (!motion->holds) motion->z[k] += h * motion->speed[k];
    }
    if (motion->holds) step_held(motion, h, A);
    free(A);
    ref_motion_pose(motion);
}

double ref_motion_energy(const RefMotion *motion)
{
    double sum = 0;
    for (int k = 0; k < motion->modes; k++)
        sum += 0.5 * (motion->speed[k] * motion->speed[k] +
                      motion->lambda[k] * motion->z[k] * motion->z[k]);
    return sum;
}
