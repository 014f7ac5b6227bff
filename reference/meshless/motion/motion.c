#include "motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/isa.h"
#include "../../../lib/vector.h"
#include "../solve/dense.h"
#include "../solve/least_squares.h"
#include "frame_sums.h"
#include "rotation.h"

enum { MOST_CORRECTIONS = 8 };
static const double met = 1e-10; /* constraints that miss by less need no correction */

static void hold_free(RefHold *hold)
{
    sm_free_all(hold->node, hold->value, hold->row);
}

void ref_motion_free(RefMotion *motion)
{
    for (int k = 0; k < motion->holds; k++) hold_free(motion->hold + k);
    sm_free_all(motion->hold, motion->lambda, motion->row, motion->anchor, motion->drift, motion->z,
                motion->speed, motion->load, motion->rotation, motion->local, motion->moved,
                motion->force, motion->piece, motion->held, motion->sums);
    *motion = (RefMotion){0};
}

SM_ISA_TABLE(RefFrameSums, ref_frame_sums)

static double dot(int count, const double *a, const double *b)
{
    double sum;
    ref_frame_sums.apply(count, 1, a, b, &sum);
    return sum;
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

/* [nodes] the body's mass, shared out by the shape functions. */
static double *node_masses(const RefBody *body)
{
    double *mass = sm_alloc((size_t)body->nodes.count, sizeof *mass);
    ref_sparse_sums(&body->matrices.mass, mass);
    return mass;
}

void ref_motion_anchor(const double *weight, int piece, RefMotion *motion)
{
    size_t modes = (size_t)motion->modes;
    double *drift = motion->drift + 3 * (size_t)piece * modes;
    memset(drift, 0, 3 * modes * sizeof *drift);
    for (size_t n = 0; n < (size_t)motion->nodes; n++) {
        if (motion->piece[n] != piece) continue;
        motion->anchor[n] = weight[n];
        for (size_t k = 0; k < 3 * modes; k++)
            drift[k] += weight[n] * motion->row[n * 6 * modes + k];
    }
}

/* The modes' shares of a translation are masses that make up the piece's if it is one of them. */
static void anchor_at_centre(const RefBody *body, int piece, RefMotion *motion)
{
    double *mass = node_masses(body), sum = 0, least = INFINITY;
    for (long n = 0; n < motion->nodes; n++)
        if (motion->piece[n] == piece) sum += mass[n];
    for (long n = 0; n < motion->nodes; n++) mass[n] /= sum;
    ref_motion_anchor(mass, piece, motion);
    for (int d = 0; d < 3; d++) {
        const double *drift = motion->drift + (3 * piece + d) * motion->modes;
        least = fmin(least, sum * dot(motion->modes, drift, drift));
    }
    memset(mass, 0, (size_t)motion->nodes * sizeof *mass);
    if (!(least > 1 - 1e-6)) ref_motion_anchor(mass, piece, motion);
    free(mass);
}

void ref_motion_create(const RefBody *body, const RefModes *modes, const RefDamping *damping,
                       RefMotion *motion)
{
    size_t nodes = (size_t)modes->nodes, count = (size_t)modes->count;
    *motion = (RefMotion){.nodes = modes->nodes,
                          .modes = modes->count,
                          .damping = *damping,
                          .pieces = ref_body_pieces(body)};
    motion->piece = sm_alloc(nodes, sizeof(int));
    motion->held = sm_alloc((size_t)motion->pieces, sizeof(bool));
    motion->sums = sm_alloc(4 * (size_t)motion->pieces, sizeof(double[3]));
    motion->lambda = sm_alloc(count, sizeof(double));
    motion->row = sm_alloc(nodes * 6 * count, sizeof(double));
    motion->z = sm_alloc(count, sizeof(double));
    motion->speed = sm_alloc(count, sizeof(double));
    motion->load = sm_alloc(count, sizeof(double));
    motion->rotation = sm_alloc(nodes, sizeof(double[3]));
    motion->local = sm_alloc(nodes, sizeof(double[3]));
    motion->moved = sm_alloc(nodes, sizeof(double[3]));
    motion->force = sm_alloc(nodes, sizeof(double[3]));
    motion->anchor = sm_alloc(nodes, sizeof(double));
    motion->drift = sm_alloc(3 * (size_t)motion->pieces * count, sizeof(double));
    for (long n = 0; n < modes->nodes; n++) motion->piece[n] = ref_body_piece(body, n);
    for (size_t k = 0; k < count; k++) motion->lambda[k] = fmax(modes->lambda[k], 0);
    fill_rows(body, modes, motion);
    for (int p = 0; p < motion->pieces; p++) anchor_at_centre(body, p, motion);
}

void ref_motion_gravity(const RefBody *body, const double g[3], RefMotion *motion)
{
    double *mass = node_masses(body);
    for (long n = 0; n < motion->nodes; n++)
        for (int d = 0; d < 3; d++) motion->force[n][d] = mass[n] * g[d];
    free(mass);
}

/* One more constraint, met where the body is. */
static int append(RefMotion *motion, const RefHold *hold)
{
    double off[3];
    motion->hold = sm_realloc(motion->hold, (size_t)motion->holds + 1, sizeof *hold);
    motion->hold[motion->holds++] = *hold;
    motion->held[hold->piece] = true;
    ref_motion_off(motion, motion->holds - 1, off);
    memcpy(motion->hold[motion->holds - 1].target, off, sizeof off);
    return motion->holds - 1;
}

int ref_motion_hold(const RefBody *body, RefHoldKind kind, const double x[3], RefMotion *motion)
{
    RefShape shape = ref_shape_create(&body->nodes);
    RefHold hold = {.kind = kind};
    if (ref_mls_at(&body->nodes, body->basis, x, &shape)) {
        size_t count = (size_t)shape.count, modes = (size_t)motion->modes;
        hold.count = shape.count;
        hold.piece = motion->piece[shape.node[0]];
        hold.node = sm_alloc(count, sizeof *hold.node);
        hold.value = sm_alloc(count, sizeof *hold.value);
        memcpy(hold.node, shape.node, count * sizeof *hold.node);
        memcpy(hold.value, shape.value, count * sizeof *hold.value);
        if (kind == REF_HOLD_ROTATION) {
            hold.row = sm_alloc(3 * modes, sizeof *hold.row);
            curl(motion, &shape, hold.row);
        }
    }
    ref_shape_free(&shape);
    return hold.count ? append(motion, &hold) : -1;
}

int ref_motion_hold_rows(const double *rows, int piece, RefMotion *motion)
{
    size_t size = 3 * (size_t)motion->modes;
    RefHold hold = {.kind = REF_HOLD_ROWS, .piece = piece, .row = sm_alloc(size, sizeof *hold.row)};
    memcpy(hold.row, rows, size * sizeof *rows);
    return append(motion, &hold);
}

static void drift_of(const RefMotion *motion, int piece, double t[3])
{
    ref_frame_sums.apply(motion->modes, 3, motion->drift + 3 * piece * motion->modes, motion->z, t);
}

/* A force on all nodes, as it acts on the modes: turned back at each node, but for what displaces
 * the anchor of a piece that nothing holds: that is the sum, which is not turned. */
typedef struct {
    double (*all)[3];    /* [pieces] sums */
    double (*turned)[3]; /* [pieces] sums of what was turned back */
    double *modal;       /* [modes] added to */
} Pull;

static Pull pull_of(const RefMotion *motion, const double (*force)[3], double *modal)
{
    Pull pull = {motion->sums, motion->sums + motion->pieces, modal};
    memset(pull.all, 0, 2 * (size_t)motion->pieces * sizeof *pull.all);
    for (long n = 0; n < motion->nodes; n++)
        for (int d = 0; d < 3; d++) pull.all[motion->piece[n]][d] += force[n][d];
    return pull;
}

static void pull_node(const RefMotion *motion, long n, const double force[3], const Pull *pull)
{
    int modes = motion->modes, piece = motion->piece[n];
    const double *row = motion->row + (size_t)n * 6 * (size_t)modes;
    double R[9], F[3], f[3], share = motion->held[piece] ? 0 : motion->anchor[n];
    for (int d = 0; d < 3; d++) F[d] = force[d] - share * pull->all[piece][d];
    if (F[0] == 0 && F[1] == 0 && F[2] == 0) return;
    ref_rotation(motion->rotation[n], R);
    for (int d = 0; d < 3; d++) {
        f[d] = R[d] * F[0] + R[3 + d] * F[1] + R[6 + d] * F[2];
        pull->turned[piece][d] += f[d];
    }
    ref_frame_sums.add(modes, f, row, pull->modal);
}

static void pull_drift(const RefMotion *motion, const Pull *pull)
{
    for (int p = 0; p < motion->pieces; p++) {
        double rest[3];
        for (int d = 0; d < 3; d++) rest[d] = pull->all[p][d] - pull->turned[p][d];
        ref_frame_sums.add(motion->modes, rest, motion->drift + 3 * p * motion->modes, pull->modal);
    }
}

/* Rotation and local displacement of one node from z. */
static void node_at(const RefMotion *motion, long n, double w[3], double local[3])
{
    const double *row = motion->row + (size_t)n * 6 * (size_t)motion->modes;
    double sum[6];
    ref_frame_sums.apply(motion->modes, 6, row, motion->z, sum);
    memcpy(local, sum, 3 * sizeof *sum);
    memcpy(w, sum + 3, 3 * sizeof *sum);
}

/* What a node of this rotation and local displacement moves beside the drift. */
static void warp(const double w[3], const double local[3], const double t[3], double moved[3])
{
    double beside[3] = {local[0] - t[0], local[1] - t[1], local[2] - t[2]};
    ref_rotation_mean(w, beside, moved);
}

/* A node's part of the modal force is found while its rows are at hand. */
void ref_motion_pose(RefMotion *motion)
{
    double(*t)[3] = motion->sums + 2 * motion->pieces, (*shift)[3] = t + motion->pieces;
    memset(motion->load, 0, (size_t)motion->modes * sizeof *motion->load);
    Pull pull = pull_of(motion, (const double(*)[3])motion->force, motion->load);
    for (int p = 0; p < motion->pieces; p++) {
        drift_of(motion, p, t[p]);
        memcpy(shift[p], t[p], sizeof *shift);
    }
    for (long n = 0; n < motion->nodes; n++) {
        int p = motion->piece[n];
        node_at(motion, n, motion->rotation[n], motion->local[n]);
        warp(motion->rotation[n], motion->local[n], t[p], motion->moved[n]);
        for (int d = 0; d < 3 && !motion->held[p]; d++)
            shift[p][d] -= motion->anchor[n] * motion->moved[n][d];
        pull_node(motion, n, motion->force[n], &pull);
    }
    pull_drift(motion, &pull);
    for (long n = 0; n < motion->nodes; n++)
        for (int d = 0; d < 3; d++) motion->moved[n][d] += shift[motion->piece[n]][d];
}

void ref_motion_push(const double (*impulse)[3], RefMotion *motion)
{
    Pull pull = pull_of(motion, impulse, motion->speed);
    for (long n = 0; n < motion->nodes; n++) pull_node(motion, n, impulse[n], &pull);
    pull_drift(motion, &pull);
}

void ref_motion_off(const RefMotion *motion, int number, double off[3])
{
    const RefHold *hold = motion->hold + number;
    double t[3];
    for (int d = 0; d < 3; d++) off[d] = -hold->target[d];
    if (hold->row) {
        for (int d = 0; d < 3; d++)
            off[d] += dot(motion->modes, hold->row + d * motion->modes, motion->z);
        return;
    }
    drift_of(motion, hold->piece, t);
    for (int d = 0; d < 3; d++) off[d] += t[d];
    for (int n = 0; n < hold->count; n++) {
        double w[3], local[3], moved[3];
        node_at(motion, hold->node[n], w, local);
        warp(w, local, t, moved);
        for (int d = 0; d < 3; d++) off[d] += hold->value[n] * moved[d];
    }
}

/* d C / d z of one constraint, [3][modes]. */
static void jacobian(const RefMotion *motion, const RefHold *hold, double *J)
{
    size_t modes = (size_t)motion->modes;
    double t[3];
    if (hold->row) {
        memcpy(J, hold->row, 3 * modes * sizeof *J);
        return;
    }
    const double *drift = motion->drift + 3 * (size_t)hold->piece * modes;
    drift_of(motion, hold->piece, t);
    memcpy(J, drift, 3 * modes * sizeof *J);
    for (int n = 0; n < hold->count; n++) {
        const double *row = motion->row + (size_t)hold->node[n] * 6 * modes;
        double w[3], local[3], by_local[9], by_turn[9];
        node_at(motion, hold->node[n], w, local);
        for (int d = 0; d < 3; d++) local[d] -= t[d];
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
                    J[d * modes + k] += a * (row[e * modes + k] - drift[e * modes + k]) +
                                        b * row[(3 + e) * modes + k];
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
    bool solved = ref_dense_definite((int)rows, S, y);
    memset(change, 0, (size_t)modes * sizeof *change);
    for (size_t r = 0; solved && r < rows; r++)
        for (int k = 0; k < modes; k++) change[k] += y[r] * J[r * (size_t)modes + (size_t)k] / A[k];
    sm_free_all(S, y, scaled);
}

/* All constraints' misses; returns the largest, lengths as shares of the body's. */
static double misses(const RefMotion *motion, double *off)
{
    double most = 0;
    for (int k = 0; k < motion->holds; k++) {
        ref_motion_off(motion, k, off + 3 * k);
        double unit = motion->hold[k].kind == REF_HOLD_ROTATION ? 1 : motion->size;
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
    sm_free_all(J, off, change);
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

void ref_motion_confine(RefMotion *motion, double most)
{
    double turn = 0;
    bool finite = true;
    for (int k = 0; k < motion->modes; k++)
        finite &= isfinite(motion->z[k]) && isfinite(motion->speed[k]);
    for (long n = 0; n < motion->nodes && finite; n++)
        turn = fmax(turn, sm_dot(motion->rotation[n], motion->rotation[n]));
    finite &= isfinite(turn);
    if (finite && turn <= most * most) return;
    double share = most / sqrt(turn);
    for (int k = 0; k < motion->modes; k++) {
        motion->z[k] = finite ? share * motion->z[k] : 0;
        motion->speed[k] = finite ? share * motion->speed[k] : 0;
    }
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

/* The local displacements of a piece that warp into where `from` is now, by its rotations, about an
 * anchor of this motion's: with Rt turned back, sum anchor Rt^-1 (moved - t) = 0 says what its
 * drift t is. */
static void unwarp(const RefMotion *from, const RefMotion *motion, int piece, double *local)
{
    double sum[9] = {0}, right[3] = {0}, t[3];
    for (long n = 0; n < from->nodes; n++)
        for (int e = 0; e < 4 && motion->piece[n] == piece; e++) {
            double axis[3] = {e == 0, e == 1, e == 2}, back[3];
            ref_rotation_unmean(from->rotation[n], e < 3 ? axis : from->moved[n], back);
            for (int d = 0; d < 3; d++)
                *(e < 3 ? sum + 3 * d + e : right + d) += motion->anchor[n] * back[d];
        }
    memcpy(t, right, sizeof t);
    if (!ref_dense_any(3, sum, t)) memcpy(t, right, sizeof t);
    for (long n = 0; n < from->nodes; n++) {
        double beside[3], back[3];
        if (motion->piece[n] != piece) continue;
        for (int d = 0; d < 3; d++) beside[d] = from->moved[n][d] - t[d];
        ref_rotation_unmean(from->rotation[n], beside, back);
        for (int d = 0; d < 3; d++) local[3 * n + d] = t[d] + back[d];
    }
}

/* Modes that are not orthonormal by this mass: amplitudes of their products with what is moved. */
static void undo_products(const RefBody *body, const RefMotion *motion, double *const ends[2])
{
    size_t modes = (size_t)motion->modes;
    double *products = sm_alloc(modes * modes, sizeof *products), *mass = node_masses(body);
    double *N = sm_alloc(modes * modes, sizeof *N), *none = sm_alloc(modes, sizeof *none);
    for (size_t n = 0; n < (size_t)motion->nodes; n++)
        for (size_t d = 0; d < 3; d++)
            ref_least_squares_add((int)modes, motion->row + (6 * n + d) * modes, 0, mass[n],
                                  products, none);
    for (int end = 0; end < 2; end++) {
        memcpy(N, products, modes * modes * sizeof *N);
        ref_least_squares_solve((int)modes, 0, N, ends[end]);
    }
    sm_free_all(products, mass, N, none);
}

void ref_motion_take(const RefBody *body, RefMotion *from, double h, RefMotion *motion)
{
    size_t modes = (size_t)motion->modes, unknowns = 3 * (size_t)motion->nodes;
    double *local = sm_alloc(unknowns, sizeof *local), *Mu = sm_alloc(unknowns, sizeof *Mu);
    double *ends[2] = {motion->speed, motion->z}; /* a step ago, and now */
    for (int end = 0; end < 2; end++) {
        double step = end ? h : -h;
        for (int k = 0; k < from->modes; k++) from->z[k] += step * from->speed[k];
        ref_motion_pose(from);
        for (int p = 0; p < motion->pieces; p++) unwarp(from, motion, p, local);
        ref_sparse_apply(&body->matrices.mass, 3, local, Mu);
        memset(ends[end], 0, modes * sizeof(double));
        for (size_t n = 0; n < (size_t)motion->nodes; n++)
            for (size_t d = 0; d < 3; d++)
                for (size_t k = 0; k < modes; k++)
                    ends[end][k] += Mu[3 * n + d] * motion->row[(6 * n + d) * modes + k];
    }
    if (body->matrices.lumped) undo_products(body, motion, ends);
    for (size_t k = 0; k < modes; k++) motion->speed[k] = (motion->z[k] - motion->speed[k]) / h;
    free(local);
    free(Mu);
    ref_motion_pose(motion);
}
