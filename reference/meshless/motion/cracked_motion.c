#include "cracked_motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../body/cracked_body.h"
#include "../solve/dense.h"
#include "rotation.h"

/* The old field, turned back: at a node of the old body turn (moved - T) of a piece is what it is
 * displaced by beside the drift. */
typedef struct {
    double (*turn)[9];  /* [nodes] by rows */
    double (*moved)[3]; /* [nodes] turn moved */
    double (*t)[3];     /* [pieces] the drift, and */
    double (*T)[3];     /* [pieces] where sums of anchors are zero */
    double *load;       /* [new nodes][3] */
} End;

typedef struct {
    const RefBody *body, *before;
    const RefMotion *motion;
    double density;
    RefShape now, then; /* at a point, of the new functions and the old ones */
    double *weight;     /* [pieces][nodes of the old body] sums of 1: the pieces' anchors */
    End end[2];         /* a step ago, and now */
} HandOver;

/* The piece that a point is of now, and the functions there; -1: too few nodes cover it. */
static int look_at(HandOver *over, const double x[3])
{
    const RefBody *body = over->body, *before = over->before;
    if (!ref_mls_at(&body->nodes, body->basis, x, &over->now)) return -1;
    ref_mls_at(&before->nodes, before->basis, x, &over->then);
    return ref_body_piece(body, over->now.node[0]);
}

/* A free piece's anchor is its mass, as the old functions share it out. */
static void share_masses(HandOver *over)
{
    size_t nodes = (size_t)over->before->nodes.count;
    for (long p = 0; p < over->body->octants.points; p++) {
        const RefPoint *point = over->body->octants.point + p;
        int piece = point->weight > 0 ? look_at(over, point->x) : -1;
        if (piece < 0 || over->motion->held[piece]) continue;
        for (int n = 0; n < over->then.count; n++)
            over->weight[(size_t)piece * nodes + (size_t)over->then.node[n]] +=
                point->weight * over->then.value[n];
    }
}

/* A held piece's anchor is that of its grip: of nodes that there were, or of the old functions
 * where a node is new. */
static void share_anchors(HandOver *over)
{
    const RefNodes *nodes = &over->body->nodes;
    const RefBodyCracks *cracks = over->body->cracks, *earlier = over->before->cracks;
    size_t count = (size_t)over->before->nodes.count;
    int *number = sm_alloc((size_t)cracks->whole.count, sizeof *number);
    for (long w = 0; w < cracks->whole.count; w++) number[w] = earlier ? -1 : (int)w;
    for (size_t n = 0; earlier && n < count; n++)
        if (earlier->origin[n] >= 0) number[earlier->origin[n]] = (int)n;
    for (long n = 0; n < nodes->count; n++) {
        int piece = over->motion->piece[n], origin = cracks->origin[n];
        double anchor = over->motion->anchor[n];
        double *weight = over->weight + (size_t)piece * count;
        if (!over->motion->held[piece] || anchor == 0) continue;
        if (origin >= 0 && number[origin] >= 0) {
            weight[number[origin]] += anchor;
            continue;
        }
        bool then =
            ref_mls_at(&over->before->nodes, over->before->basis, nodes->position[n], &over->then);
        for (int k = 0; then && k < over->then.count; k++)
            weight[over->then.node[k]] += anchor * over->then.value[k];
    }
    free(number);
}

static void normalise(HandOver *over)
{
    size_t nodes = (size_t)over->before->nodes.count;
    for (int p = 0; p < over->motion->pieces; p++) {
        double sum = 0, *weight = over->weight + (size_t)p * nodes;
        for (size_t n = 0; n < nodes; n++) sum += weight[n];
        for (size_t n = 0; n < nodes && sum > 0; n++) weight[n] /= sum;
    }
}

/* Drift and T of a piece: sum anchor turn (moved - T) = 0; a free piece's drift is the mean of what
 * it was moved by. */
static void find_drift(const HandOver *over, const RefMotion *from, int piece, End *end)
{
    size_t nodes = (size_t)over->before->nodes.count;
    const double *weight = over->weight + (size_t)piece * nodes;
    double sum[9] = {0}, right[3] = {0}, mean[3] = {0};
    for (size_t n = 0; n < nodes; n++) {
        for (int k = 0; k < 9; k++) sum[k] += weight[n] * end->turn[n][k];
        for (int d = 0; d < 3; d++) {
            right[d] += weight[n] * end->moved[n][d];
            mean[d] += weight[n] * from->moved[n][d];
        }
    }
    memcpy(end->T[piece], right, sizeof right);
    if (!ref_dense_any(3, sum, end->T[piece])) memcpy(end->T[piece], mean, sizeof mean);
    memcpy(end->t[piece], over->motion->held[piece] ? end->T[piece] : mean, sizeof mean);
}

/* Takes the old field as it is now. */
static void take_end(const HandOver *over, const RefMotion *from, End *end)
{
    for (long n = 0; n < from->nodes; n++) {
        for (int e = 0; e < 3; e++) {
            double axis[3] = {e == 0, e == 1, e == 2}, column[3];
            ref_rotation_unmean(from->rotation[n], axis, column);
            for (int d = 0; d < 3; d++) end->turn[n][3 * d + e] = column[d];
        }
        ref_rotation_unmean(from->rotation[n], from->moved[n], end->moved[n]);
    }
    for (int p = 0; p < over->motion->pieces; p++) find_drift(over, from, p, end);
}

static void add_loads(HandOver *over)
{
    for (long p = 0; p < over->body->octants.points; p++) {
        const RefPoint *point = over->body->octants.point + p;
        int piece = point->weight > 0 ? look_at(over, point->x) : -1;
        for (int e = 0; e < 2 && piece >= 0; e++) {
            End *end = over->end + e;
            double u[3];
            memcpy(u, end->t[piece], sizeof u);
            for (int n = 0; n < over->then.count; n++) {
                const double *turn = end->turn[over->then.node[n]], *T = end->T[piece];
                const double *moved = end->moved[over->then.node[n]];
                for (int d = 0; d < 3; d++)
                    u[d] += over->then.value[n] * (moved[d] - turn[3 * d] * T[0] -
                                                   turn[3 * d + 1] * T[1] - turn[3 * d + 2] * T[2]);
            }
            for (int n = 0; n < over->now.count; n++)
                for (int d = 0; d < 3; d++)
                    end->load[3 * over->now.node[n] + d] +=
                        over->density * point->weight * over->now.value[n] * u[d];
        }
    }
}

static void amplitudes(const RefMotion *motion, const double *load, double *z)
{
    size_t modes = (size_t)motion->modes;
    memset(z, 0, modes * sizeof *z);
    for (size_t n = 0; n < (size_t)motion->nodes; n++)
        for (size_t d = 0; d < 3; d++)
            for (size_t k = 0; k < modes; k++)
                z[k] += load[3 * n + d] * motion->row[(6 * n + d) * modes + k];
}

static double elastic_energy(const RefMotion *motion, double beta)
{
    double sum = 0;
    for (int k = 0; k < motion->modes; k++) {
        double z = motion->z[k] / (1 + beta * motion->lambda[k]);
        sum += 0.5 * motion->lambda[k] * z * z;
    }
    return sum;
}

/* What comes nearest in the kinetic energy's norm of all that is no more strained than before:
 * z / (1 + beta lambda), beta a Lagrange multiplier. Velocities are made less likewise. */
static void relax(const RefMotion *from, RefMotion *motion)
{
    double most = elastic_energy(from, 0), low = 0, high = 1e-6, stiffest = 0;
    for (int k = 0; k < motion->modes; k++) stiffest = fmax(stiffest, motion->lambda[k]);
    if (elastic_energy(motion, 0) <= most || !(stiffest > 0)) return;
    for (high /= stiffest; elastic_energy(motion, high) > most && isfinite(high);) high *= 2;
    for (int n = 0; n < 60; n++) {
        double middle = (low + high) / 2;
        *(elastic_energy(motion, middle) > most ? &low : &high) = middle;
    }
    for (int k = 0; k < motion->modes; k++) {
        double less = motion->lambda[k] > 0 ? 1 / (1 + high * motion->lambda[k]) : 1;
        motion->z[k] *= less;
        motion->speed[k] *= less;
    }
}

static End end_create(long nodes, int pieces, long now)
{
    return (End){.turn = sm_alloc((size_t)nodes, sizeof(double[9])),
                 .moved = sm_alloc((size_t)nodes, sizeof(double[3])),
                 .t = sm_alloc((size_t)pieces, sizeof(double[3])),
                 .T = sm_alloc((size_t)pieces, sizeof(double[3])),
                 .load = sm_alloc(3 * (size_t)now, sizeof(double))};
}

void ref_motion_take_cracked(const RefBody *body, const RefBody *before, double density,
                             RefMotion *from, double h, RefMotion *motion)
{
    size_t size = (size_t)motion->pieces * (size_t)before->nodes.count;
    HandOver over = {.body = body,
                     .before = before,
                     .motion = motion,
                     .density = density,
                     .now = ref_shape_create(&body->nodes),
                     .then = ref_shape_create(&before->nodes),
                     .weight = sm_alloc(size, sizeof(double))};
    share_masses(&over);
    share_anchors(&over);
    normalise(&over);
    for (int e = 0; e < 2; e++) {
        over.end[e] = end_create(before->nodes.count, motion->pieces, body->nodes.count);
        for (int k = 0; k < from->modes; k++) from->z[k] += (e ? h : -h) * from->speed[k];
        ref_motion_pose(from);
        take_end(&over, from, over.end + e);
    }
    add_loads(&over);
    amplitudes(motion, over.end[0].load, motion->speed);
    amplitudes(motion, over.end[1].load, motion->z);
    for (int k = 0; k < motion->modes; k++)
        motion->speed[k] = (motion->z[k] - motion->speed[k]) / h;
    relax(from, motion);
    for (int e = 0; e < 2; e++) {
        End *end = over.end + e;
        sm_free_all(end->turn, end->moved, end->t, end->T, end->load);
    }
    free(over.weight);
    ref_shape_free(&over.now);
    ref_shape_free(&over.then);
    ref_motion_pose(motion);
}
