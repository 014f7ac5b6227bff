#include "middle.h"

#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"
#include "../motion/frame_sums.h"
#include "../solve/solver.h"

/* Sums of L^2 phi_I phi_J, of whole pairs alone: functions of one node meet in its diagonal. */
static void add_squares(const RefSamples *samples, long p, double weight, RefPairs *pairs)
{
    for (long e = samples->start[p]; e < samples->start[p + 1]; e++)
        for (long f = samples->start[p]; f < samples->start[p + 1]; f++) {
            int i = samples->node[e], j = samples->node[f];
            if (i > j) continue;
            pairs->mass[ref_pairs_at(pairs, i, j)] +=
                weight * samples->part[e][0] * samples->part[f][0];
        }
}

SmCode ref_middle_fit(const RefChart *chart, const RefSamples *samples, long nodes, double (**X)[3],
                      SmError *error)
{
    RefPairs pairs = ref_samples_pairs(samples, nodes);
    double *right = sm_alloc(3 * (size_t)nodes, sizeof *right);
    double *left = sm_alloc((size_t)nodes, sizeof *left);
    RefMatrices sums;
    RefSolver *solver;
    for (long p = 0; p < samples->count; p++) {
        double x[3], L = chart->factor(chart->data, samples->theta[p]);
        double weight = L * L * samples->weight[p];
        chart->place(chart->data, samples->theta[p], x);
        add_squares(samples, p, weight, &pairs);
        for (long e = samples->start[p]; e < samples->start[p + 1]; e++)
            for (int d = 0; d < 3; d++)
                right[d * nodes + samples->node[e]] += weight * samples->part[e][0] * x[d];
    }
    ref_pairs_matrices(&pairs, 1, &sums);
    SmCode code =
        ref_solver_create(&(RefMatrices){.stiffness = sums.mass}, 0, NULL, &solver, error);
    if (code == SM_INPUT)
        code = sm_fail(error, code,
                       "the functions of the shell's %ld nodes depend on one another: take wider "
                       "covers, 6 cells, or quadratic functions",
                       nodes);
    if (code == SM_OK) {
        *X = sm_alloc((size_t)nodes, sizeof **X);
        for (int d = 0; d < 3; d++) {
            ref_solver_solve(solver, right + d * nodes, NULL, left);
            for (long n = 0; n < nodes; n++) (*X)[n][d] = left[n];
        }
        ref_solver_destroy(solver);
    }
    ref_matrices_free(&sums);
    ref_pairs_free(&pairs);
    sm_free_all(right, left);
    return code;
}

/* Where functions of nodes in a row meet alone, as in a stem, the surface is a line, and what is
 * above 0 of its area, in squares of its tangents, is rounding. */
static const double LEAST_AREA = 1e-10;

/* What follows from x's derivatives: of a line, nothing. */
static void complete(RefFrame *frame)
{
    double(*a)[3] = frame->tangent, up[2][3];
    double metric[3] = {sm_dot(a[0], a[0]), sm_dot(a[1], a[1]), sm_dot(a[0], a[1])};
    sm_cross(a[0], a[1], frame->normal);
    frame->area = sqrt(sm_dot(frame->normal, frame->normal));
    if (frame->area <= LEAST_AREA * (metric[0] + metric[1])) {
        memset(frame->normal, 0, sizeof frame->normal);
        frame->area = 0;
        return;
    }
    sm_normalize(frame->normal);
    double squared = frame->area * frame->area;
    frame->inverse[0] = metric[1] / squared;
    frame->inverse[1] = metric[0] / squared;
    frame->inverse[2] = -metric[2] / squared;
    for (int d = 0; d < 3; d++) {
        up[0][d] = frame->inverse[0] * a[0][d] + frame->inverse[2] * a[1][d];
        up[1][d] = frame->inverse[2] * a[0][d] + frame->inverse[1] * a[1][d];
    }
    for (int m = 0; m < 3; m++)
        for (int n = 0; n < 2; n++) frame->symbol[m][n] = sm_dot(up[n], frame->second[m]);
}

RefFrame ref_middle_at(const double (*X)[3], int count, const int *node, const double (*part)[6])
{
    RefFrame frame = {.area = 0};
    double sum[3][6];
    ref_frame_sums.derive(count, node, part, X, sum);
    for (int d = 0; d < 3; d++) {
        frame.x[d] = sum[d][0];
        for (int k = 0; k < 2; k++) frame.tangent[k][d] = sum[d][1 + k];
        for (int m = 0; m < 3; m++) frame.second[m][d] = sum[d][3 + m];
    }
    complete(&frame);
    return frame;
}

/* One function's share of x and its derivatives. */
static void add(const double X[3], const double part[6], RefFrame *frame)
{
    for (int d = 0; d < 3; d++) {
        frame->x[d] += part[0] * X[d];
        for (int k = 0; k < 2; k++) frame->tangent[k][d] += part[1 + k] * X[d];
        for (int m = 0; m < 3; m++) frame->second[m][d] += part[3 + m] * X[d];
    }
}

RefFrame ref_middle_of(const double (*X)[3], const RefShape *shape)
{
    RefFrame frame = {.area = 0};
    for (int n = 0; n < shape->count; n++) {
        double part[6];
        ref_samples_part(shape, n, part);
        add(X[shape->node[n]], part, &frame);
    }
    complete(&frame);
    return frame;
}

void ref_middle_press(const RefSamples *samples, double pressure, double (*force)[3])
{
    for (long p = 0; p < samples->count; p++) {
        const double *normal = samples->frame[p].normal;
        double push[3];
        for (int d = 0; d < 3; d++) push[d] = pressure * samples->area[p] * normal[d];
        for (long e = samples->start[p]; e < samples->start[p + 1]; e++)
            for (int d = 0; d < 3; d++) force[samples->node[e]][d] += samples->part[e][0] * push[d];
    }
}

void ref_middle_frames(const double (*X)[3], RefSamples *samples)
{
    if (!samples->frame)
        samples->frame = sm_realloc(NULL, (size_t)samples->count, sizeof(RefFrame));
    for (long p = 0; p < samples->count; p++) {
        long from = samples->start[p];
        samples->frame[p] =
            ref_middle_at(X, (int)(samples->start[p + 1] - from), samples->node + from,
                          (const double(*)[6])(samples->part + from));
    }
}

double ref_middle_areas(const double (*X)[3], RefSamples *samples)
{
    double sum = 0;
    ref_middle_frames(X, samples);
    for (long p = 0; p < samples->count; p++) {
        const RefFrame *frame = samples->frame + p;
        samples->area[p] = frame->area * samples->weight[p];
        samples->trace[p] = frame->inverse[0] + frame->inverse[1];
        sum += samples->area[p];
    }
    return sum;
}
