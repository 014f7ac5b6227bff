#include "grip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/engine/boundary.h"
#include "../../../lib/vector.h"
#include "../solve/least_squares.h"
#include "rotation.h"

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
    RefGrip grip = {.x = sm_alloc((size_t)most, sizeof *grip.x),
                    .point = sm_alloc((size_t)most, sizeof *grip.point)};
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
        grip.point[grip.count] = best;
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
    sm_free_all(grip->x, grip->point);
    *grip = (RefGrip){0};
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

/* The piece of the body that most of a grip's points are of, by the weights of their mean; and what
 * share of them is of another one. */
static int piece_of(const RefMotion *motion, const double *weight, double *share)
{
    int most = 0;
    memset(share, 0, (size_t)motion->pieces * sizeof *share);
    for (long n = 0; n < motion->nodes; n++) share[motion->piece[n]] += weight[n];
    for (int p = 1; p < motion->pieces; p++)
        if (share[p] > share[most]) most = p;
    return most;
}

/* Anchors the pieces that a grip holds and that have no anchor, [pieces], yet. */
static void anchor_pieces(int grip, double *weight, const double *share, int *anchor,
                          RefMotion *motion)
{
    for (int p = 0; p < motion->pieces; p++) {
        if (anchor[p] >= 0 || share[p] < 1e-3) continue;
        for (long n = 0; n < motion->nodes && motion->pieces > 1; n++)
            if (motion->piece[n] == p) weight[n] /= share[p];
        ref_motion_anchor(weight, p, motion);
        motion->held[p] = true;
        anchor[p] = grip;
    }
}

void ref_grip_bind(const RefBody *body, int grips, RefGrip *grip, RefMotion *motion)
{
    double *share = sm_alloc((size_t)motion->pieces, sizeof *share);
    int *anchor = sm_alloc((size_t)motion->pieces, sizeof *anchor);
    for (int p = 0; p < motion->pieces; p++) anchor[p] = -1;
    for (int k = 0; k < grips; k++) {
        grip[k].hold = motion->holds;
        if (!grip[k].rigid) {
            for (int p = 0; p < grip[k].count; p++)
                ref_motion_hold(body, REF_HOLD_POSITION, grip[k].x[p], motion);
            continue;
        }
        double *weight = sm_alloc((size_t)motion->nodes, sizeof *weight);
        double *frame = frame_of(body, grip + k, motion, weight);
        turn_nodes(body, grip + k, frame, motion);
        int piece = piece_of(motion, weight, share);
        anchor_pieces(k, weight, share, anchor, motion);
        grip[k].anchor = anchor[piece];
        ref_motion_hold_rows(frame, piece, motion);
        ref_motion_hold_rows(frame + 3 * motion->modes, piece, motion);
        free(frame);
        free(weight);
    }
    free(share);
    free(anchor);
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
    for (int k = 0; k < grips; k++) {
        RefHold *hold = motion->hold + grip[k].hold;
        for (int p = 0; !grip[k].rigid && p < grip[k].count; p++)
            displacement(grip[k].x[p], shift, pose[k], hold[p].target);
        if (!grip[k].rigid) continue;
        double R[9], *turn = hold[1].target, t[3], way[3];
        for (int n = 0; n < 9; n++) R[n] = pose[k][n / 3][n % 3];
        ref_rotation_vector(R, turn, turn);
        displacement(grip[grip[k].anchor].middle, shift, pose[grip[k].anchor], t);
        displacement(grip[k].middle, shift, pose[k], way);
        for (int d = 0; d < 3; d++) way[d] -= t[d];
        ref_rotation_unmean(turn, way, hold[0].target);
        for (int d = 0; d < 3; d++) hold[0].target[d] += t[d];
    }
}
