#include "mpu.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"
#include "mpu_fit.h"

enum { LEAST_FITTED = 15, SURELY_SPLIT = 8192, PROBES = 400 };
enum { MOST_CELLS = 1 << 22, MOST_LEVELS = 12, COARSE = 6 };
static const double ball = 0.75; /* radius in diagonals */

void ref_mpu_free(RefMpu *mpu)
{
    ref_cloud_free(&mpu->cloud);
    ref_points_free(&mpu->points);
    free(mpu->cell);
    *mpu = (RefMpu){0};
}

/* The largest |Q| / |grad Q| over points. */
static double misfit(const RefCloud *cloud, long count, const long *point, const RefMpuCell *cell)
{
    double most = 0, gradient[3];
    for (long p = 0; p < count; p++) {
        double value = ref_mpu_shape(cell, cloud->points->position[point[p]], gradient);
        double slope = sqrt(sm_dot(gradient, gradient));
        most = fmax(most, slope > 0 ? fabs(value) / slope : INFINITY);
    }
    return most;
}

/* Gives the cell its shape; false if it is to be split instead. */
static bool settle(const RefMpu *mpu, int level, long *near, RefMpuCell *cell)
{
    const RefCloud *cloud = &mpu->cloud;
    bool last = level >= MOST_LEVELS || mpu->count + 8 > MOST_CELLS;
    double reach = cell->radius = ball * sqrt(3) * cell->edge;
    long count = ref_cloud_ball(cloud, cell->centre, cell->radius, SURELY_SPLIT, near);
    if (count == 0) {
        ref_mpu_distance(cloud, cell);
        return level >= COARSE || last || ref_mpu_sane(cloud, cell, 0);
    }
    if (count > SURELY_SPLIT && !last) return false;
    if (count > SURELY_SPLIT) count = SURELY_SPLIT;
    bool few = count < LEAST_FITTED;
    if (few) {
        double distance[LEAST_FITTED];
        count = ref_cloud_nearest(cloud, cell->centre, LEAST_FITTED, near, distance);
        reach = fmax(reach, 1.0001 * distance[count - 1]);
        /* its ball only grazes the surface: a fit would reach far beyond its points */
        if (!last && cell->edge > cloud->spacing[near[0]]) return false;
    }
    bool good = ref_mpu_fit(cloud, count, near, reach, cell);
    if (!few && !last) good = good && misfit(cloud, count, near, cell) <= mpu->tolerance;
    if (few || last || level < COARSE) good = good && ref_mpu_sane(cloud, cell, 0.25);
    if (good) return true;
    if (!last && !(few && level >= COARSE)) return false;
    ref_mpu_distance(cloud, cell);
    return true;
}

static void split(RefMpu *mpu, int at)
{
    if (mpu->count + 8 > mpu->room) {
        mpu->room = 2 * mpu->room + 64;
        mpu->cell = sm_realloc(mpu->cell, (size_t)mpu->room, sizeof *mpu->cell);
    }
    RefMpuCell *parent = mpu->cell + at;
    parent->child = mpu->count;
    for (int which = 0; which < 8; which++) {
        RefMpuCell *child = mpu->cell + mpu->count++;
        *child = (RefMpuCell){.edge = parent->edge / 2, .child = -1};
        for (int d = 0; d < 3; d++)
            child->centre[d] = parent->centre[d] + ((which >> d & 1) - 0.5) * child->edge;
    }
}

/* Boxes of the leaves' balls, from the last cell up: children come behind their parent. */
static void bound(RefMpu *mpu)
{
    for (int at = mpu->count - 1; at >= 0; at--) {
        RefMpuCell *cell = mpu->cell + at;
        for (int d = 0; d < 3; d++) {
            cell->low[d] = cell->child < 0 ? cell->centre[d] - cell->radius : INFINITY;
            cell->high[d] = cell->child < 0 ? cell->centre[d] + cell->radius : -INFINITY;
            for (int which = 0; cell->child >= 0 && which < 8; which++) {
                cell->low[d] = fmin(cell->low[d], mpu->cell[cell->child + which].low[d]);
                cell->high[d] = fmax(cell->high[d], mpu->cell[cell->child + which].high[d]);
            }
        }
    }
}

static void divide(RefMpu *mpu)
{
    long *near = sm_alloc(SURELY_SPLIT, sizeof *near);
    double edge = mpu->cell[0].edge;
    for (int at = 0; at < mpu->count; at++) {
        RefMpuCell cell = mpu->cell[at];
        int level = (int)rint(log2(edge / cell.edge));
        if (settle(mpu, level, near, &cell))
            mpu->cell[at] = cell;
        else
            split(mpu, at);
    }
    free(near);
    bound(mpu);
}

/* Whether the surface closes: the vector area of a closed one is zero. */
static SmCode check_closed(const RefCloud *cloud, SmError *error)
{
    double area = 0, sum[3] = {0};
    for (long p = 0; p < cloud->points->count; p++) {
        area += cloud->area[p];
        for (int d = 0; d < 3; d++) sum[d] += cloud->area[p] * cloud->points->normal[p][d];
    }
    double open = sqrt(sm_dot(sum, sum)) / area;
    if (open <= 1.0 / 6) return SM_OK;
    return sm_fail(
        error, SM_INPUT,
        "the points leave the surface open: %.0f%% of it face one way without an opposite; a "
        "solid needs points all around, and none far away",
        100 * open);
}

/* Just inside points the surface winds around once, just outside not at all: at how many of the
 * probes that holds, and at how many the opposite does, as it would with all normals turned. */
static void probe(const RefCloud *cloud, int *right, int *wrong, int *probes)
{
    const RefPoints *points = cloud->points;
    long step = points->count / PROBES + 1;
    *right = *wrong = *probes = 0;
    for (long p = 0; p < points->count; p += step, (*probes)++) {
        double in[3], out[3];
        for (int d = 0; d < 3; d++) {
            in[d] = points->position[p][d] - cloud->spacing[p] * points->normal[p][d];
            out[d] = points->position[p][d] + cloud->spacing[p] * points->normal[p][d];
        }
        double inside = ref_cloud_winding(cloud, in), outside = ref_cloud_winding(cloud, out);
        *right += inside > 0.5 && outside < 0.5;
        *wrong += outside < -0.5 && inside > -0.5;
    }
}

static SmCode orient(RefMpu *mpu, SmError *error)
{
    int right, wrong, probes;
    probe(&mpu->cloud, &right, &wrong, &probes);
    if (10 * right >= 7 * probes) return SM_OK;
    if (10 * wrong < 7 * probes)
        return sm_fail(
            error, SM_INPUT,
            "the points' normals disagree about what is inside: only %d%% of them separate "
            "it from outside; orient them, or give more (of a mesh --points) where the body is "
            "thinner than they are apart",
            100 * (right > wrong ? right : wrong) / probes);
    for (long p = 0; p < mpu->points.count; p++)
        for (int d = 0; d < 3; d++) mpu->points.normal[p][d] *= -1;
    ref_cloud_free(&mpu->cloud);
    ref_cloud_create(&mpu->points, &mpu->cloud);
    mpu->flipped = true;
    return SM_OK;
}

bool ref_mpu_dense(const RefPoints *points)
{
    RefCloud cloud;
    int right, wrong, probes;
    ref_cloud_create(points, &cloud);
    probe(&cloud, &right, &wrong, &probes);
    bool dense =
        10 * right >= 7 * probes || 10 * wrong >= 7 * probes || check_closed(&cloud, NULL) != SM_OK;
    ref_cloud_free(&cloud);
    return dense;
}

SmCode ref_mpu_build(RefPoints *points, const RefMpuOptions *options, RefMpu *mpu, SmError *error)
{
    double low[3], high[3], diagonal = 0, edge = 0;
    *mpu = (RefMpu){.points = *points, .count = 1, .room = 1};
    *points = (RefPoints){0};
    ref_cloud_create(&mpu->points, &mpu->cloud);
    SmCode code = check_closed(&mpu->cloud, error);
    if (code == SM_OK) code = orient(mpu, error);
    if (code != SM_OK) {
        ref_mpu_free(mpu);
        return code;
    }
    memcpy(low, mpu->cloud.node[0].low, sizeof low);
    memcpy(high, mpu->cloud.node[0].high, sizeof high);
    for (int d = 0; d < 3; d++) {
        diagonal += (high[d] - low[d]) * (high[d] - low[d]);
        edge = fmax(edge, high[d] - low[d]);
    }
    mpu->tolerance =
        sqrt(diagonal) * (options && options->tolerance > 0 ? options->tolerance : 1e-3);
    mpu->cell = sm_alloc(1, sizeof *mpu->cell);
    mpu->cell[0] = (RefMpuCell){.edge = 1.1 * edge, .child = -1};
    for (int d = 0; d < 3; d++) mpu->cell[0].centre[d] = (low[d] + high[d]) / 2;
    divide(mpu);
    return SM_OK;
}

typedef struct {
    const double *x;
    double weight, value;                   /* sums of w and w Q */
    double weight_slope[3], value_slope[3]; /* and their gradients */
} Blend;

static void blend(const RefMpu *mpu, int at, Blend *b)
{
    const RefMpuCell *cell = mpu->cell + at;
    for (int d = 0; d < 3; d++)
        if (b->x[d] < cell->low[d] || b->x[d] > cell->high[d]) return;
    if (cell->child >= 0) {
        for (int which = 0; which < 8; which++) blend(mpu, cell->child + which, b);
        return;
    }
    double from[3] = {b->x[0] - cell->centre[0], b->x[1] - cell->centre[1],
                      b->x[2] - cell->centre[2]};
    double distance = sqrt(sm_dot(from, from)), slope, gradient[3];
    double weight = ref_mpu_weight(distance, cell->radius, &slope);
    if (!(weight > 0)) return;
    double value = ref_mpu_shape(cell, b->x, gradient);
    b->weight += weight;
    b->value += weight * value;
    for (int d = 0; d < 3; d++) {
        double weight_slope = distance > 0 ? slope * from[d] / distance : 0;
        b->weight_slope[d] += weight_slope;
        b->value_slope[d] += weight_slope * value + weight * gradient[d];
    }
}

/* Inside the root cell the blend; outside it the nearest place's value and the way there. */
static double mpu_at(const void *body, const double x[3], double gradient[3])
{
    const RefMpu *mpu = body;
    double in[3], way[3];
    for (int d = 0; d < 3; d++) {
        double half = mpu->cell[0].edge / 2, centre = mpu->cell[0].centre[d];
        in[d] = fmin(fmax(x[d], centre - half), centre + half);
        way[d] = x[d] - in[d];
    }
    Blend b = {.x = in};
    blend(mpu, 0, &b);
    double value = b.value / b.weight, far = sqrt(sm_dot(way, way));
    for (int d = 0; gradient && d < 3; d++)
        gradient[d] =
            far > 0 ? way[d] / far : (b.value_slope[d] - value * b.weight_slope[d]) / b.weight;
    return far > 0 ? fmax(value, 0) + far : value;
}

RefField ref_mpu_field(const RefMpu *mpu)
{
    RefField field = {.at = mpu_at, .body = mpu};
    const RefCloudNode *all = mpu->cloud.node;
    for (int d = 0; d < 3; d++) { /* surfaces bulge a little beyond their points */
        double slack = 2 * mpu->tolerance;
        field.low[d] = all->low[d] - slack;
        field.high[d] = all->high[d] + slack;
    }
    return field;
}
