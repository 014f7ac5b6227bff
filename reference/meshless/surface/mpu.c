#include "mpu.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"
#include "../solve/least_squares.h"

/* ---- local shapes of points in a ball (Ohtake et al. 2003, section 4) */

enum { HEIGHT = 6, QUADRIC = 10, CORNERS = 9, ASKED = 6 };

/* Weight of a point at `distance` from a ball's centre: the quadratic B-spline of 3 distance / 2
 * radius; its slope by distance. */
static double weight_at(double distance, double radius, double *slope)
{
    double t = 1.5 * distance / radius, per = 1.5 / radius;
    if (t >= 1.5) {
        *slope = 0;
        return 0;
    }
    *slope = (t < 0.5 ? -2 * t : t - 1.5) * per;
    return t < 0.5 ? 0.75 - t * t : 0.5 * (1.5 - t) * (1.5 - t);
}

/* Value of the cell's shape at x; writes its gradient. */
static double shape_at(const RefMpuCell *cell, const double x[3], double gradient[3])
{
    double s[3];
    const double *q = cell->shape;
    for (int d = 0; d < 3; d++) s[d] = (x[d] - cell->centre[d]) / cell->radius;
    gradient[0] = 2 * q[0] * s[0] + q[1] * s[1] + q[2] * s[2] + q[6];
    gradient[1] = q[1] * s[0] + 2 * q[3] * s[1] + q[4] * s[2] + q[7];
    gradient[2] = q[2] * s[0] + q[4] * s[1] + 2 * q[5] * s[2] + q[8];
    /* Q is half of s . (its gradient's quadratic part) and the rest */
    double linear = q[6] * s[0] + q[7] * s[1] + q[8] * s[2];
    return cell->radius * (0.5 * (sm_dot(gradient, s) + linear) + q[9]);
}

/* A point in the cell's coordinates, and its weight in a ball of `reach`. */
static double local(const RefCloud *cloud, long point, double reach, const RefMpuCell *cell,
                    double s[3])
{
    double slope;
    for (int d = 0; d < 3; d++)
        s[d] = (cloud->points->position[point][d] - cell->centre[d]) / cell->radius;
    return weight_at(sqrt(sm_dot(s, s)) * cell->radius, reach, &slope) + 1e-6;
}

/* w = a uu + b uv + c vv + d u + e v + f along axes t1, t2 and the mean normal n. */
static void fit_height(const RefCloud *cloud, long count, const long *point, double reach,
                       const double n[3], RefMpuCell *cell)
{
    double N[HEIGHT * HEIGHT] = {0}, a[HEIGHT] = {0}, t[2][3], axis[3] = {0}, s[3];
    int least = 0;
    for (int d = 1; d < 3; d++)
        if (fabs(n[d]) < fabs(n[least])) least = d;
    axis[least] = 1;
    sm_cross(n, axis, t[0]);
    sm_normalize(t[0]);
    sm_cross(n, t[0], t[1]);
    for (long p = 0; p < count; p++) {
        double weight = local(cloud, point[p], reach, cell, s);
        double u = sm_dot(s, t[0]), v = sm_dot(s, t[1]);
        const double row[HEIGHT] = {u * u, u * v, v * v, u, v, 1};
        ref_least_squares_add(HEIGHT, row, sm_dot(s, n), weight, N, a);
    }
    ref_least_squares_solve(HEIGHT, 3, N, a);
    int at = 0;
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++, at++) {
            double twice = i == j ? 1 : 2;
            cell->shape[at] = -twice * (a[0] * t[0][i] * t[0][j] + a[2] * t[1][i] * t[1][j] +
                                        a[1] * 0.5 * (t[0][i] * t[1][j] + t[0][j] * t[1][i]));
        }
    for (int d = 0; d < 3; d++) cell->shape[6 + d] = n[d] - a[3] * t[0][d] - a[4] * t[1][d];
    cell->shape[9] = -a[5];
}

static void terms_at(const double s[3], double row[QUADRIC])
{
    const double all[QUADRIC] = {s[0] * s[0], s[0] * s[1], s[0] * s[2], s[1] * s[1], s[1] * s[2],
                                 s[2] * s[2], s[0],        s[1],        s[2],        1};
    memcpy(row, all, sizeof all);
}

/* The distance of x by its nearest points' tangent planes; false if they do not agree on the side.
 */
static bool ask(const RefCloud *cloud, const double x[3], double *distance)
{
    long near[ASKED];
    double far[ASKED];
    int found = ref_cloud_nearest(cloud, x, ASKED, near, far), outside = 0;
    *distance = 0;
    for (int k = 0; k < found; k++) {
        double height = 0;
        for (int d = 0; d < 3; d++)
            height +=
                cloud->points->normal[near[k]][d] * (x[d] - cloud->points->position[near[k]][d]);
        outside += height > 0;
        *distance += height / found;
    }
    return outside == 0 || outside == found;
}

static bool fit_quadric(const RefCloud *cloud, long count, const long *point, double reach,
                        RefMpuCell *cell)
{
    double N[QUADRIC * QUADRIC] = {0}, row[QUADRIC], s[3], sum = 0, distance[CORNERS];
    double corner[CORNERS][3];
    bool asked[CORNERS];
    int agreed = 0;
    memset(cell->shape, 0, sizeof cell->shape);
    for (int k = 0; k < CORNERS; k++) {
        for (int d = 0; d < 3; d++)
            corner[k][d] = k == 8 ? 0 : ((k >> d & 1) - 0.5) * cell->edge / cell->radius;
        double x[3];
        for (int d = 0; d < 3; d++) x[d] = cell->centre[d] + corner[k][d] * cell->radius;
        asked[k] = ask(cloud, x, distance + k);
        agreed += asked[k];
    }
    if (agreed == 0) return false;
    for (long p = 0; p < count; p++) sum += local(cloud, point[p], reach, cell, s);
    for (long p = 0; p < count; p++) {
        double weight = local(cloud, point[p], reach, cell, s) / sum;
        terms_at(s, row);
        ref_least_squares_add(QUADRIC, row, 0, weight, N, cell->shape);
    }
    for (int k = 0; k < CORNERS; k++) {
        if (!asked[k]) continue;
        terms_at(corner[k], row);
        ref_least_squares_add(QUADRIC, row, distance[k] / cell->radius, 1.0 / agreed, N,
                              cell->shape);
    }
    ref_least_squares_solve(QUADRIC, 0, N, cell->shape);
    return true;
}

/* Fits the cell's shape to `count` points, weighed in a ball of `reach`: a height over their mean
 * tangent plane, or a general quadric where normals are more than 90 degrees off the mean. False
 * where a quadric is called for but the nearest points do not say on which side the cell's corners
 * are. */
static bool fit_shape(const RefCloud *cloud, long count, const long *point, double reach,
                      RefMpuCell *cell)
{
    double mean[3] = {0}, s[3];
    for (long p = 0; p < count; p++) {
        double weight = local(cloud, point[p], reach, cell, s);
        for (int d = 0; d < 3; d++) mean[d] += weight * cloud->points->normal[point[p]][d];
    }
    bool one_sided = sm_normalize(mean);
    for (long p = 0; one_sided && p < count; p++)
        one_sided = sm_dot(mean, cloud->points->normal[point[p]]) > 0;
    if (!one_sided) return fit_quadric(cloud, count, point, reach, cell);
    fit_height(cloud, count, point, reach, mean, cell);
    return true;
}

/* The plane through the point nearest to the cell's centre, across the line to it: exact at the
 * centre; its side by the winding number. */
static void fit_distance(const RefCloud *cloud, RefMpuCell *cell)
{
    long near;
    double far, normal[3];
    bool inside = ref_cloud_winding(cloud, cell->centre) > 0.5;
    ref_cloud_nearest(cloud, cell->centre, 1, &near, &far);
    for (int d = 0; d < 3; d++) normal[d] = cell->centre[d] - cloud->points->position[near][d];
    if (!sm_normalize(normal)) memcpy(normal, cloud->points->normal[near], sizeof normal);
    memset(cell->shape, 0, sizeof cell->shape);
    for (int d = 0; d < 3; d++) cell->shape[6 + d] = inside ? -normal[d] : normal[d];
    cell->shape[9] = (inside ? -far : far) / cell->radius;
}

/* Whether x is so near to the points that the winding number means nothing there. */
static bool among_points(const RefCloud *cloud, const double x[3])
{
    long near;
    double distance;
    ref_cloud_nearest(cloud, x, 1, &near, &distance);
    return distance < cloud->spacing[near];
}

/* Whether the shape's sign at the cell's corners and centre is that of the winding number, where
 * that is more than `doubt` from a half and the points are not too near. Shapes fitted to points
 * outside their cell may not be, nor distances where a hole's edge runs through the cell. */
static bool is_sane(const RefCloud *cloud, const RefMpuCell *cell, double doubt)
{
    for (int k = 0; k < CORNERS; k++) {
        double x[3], gradient[3];
        for (int d = 0; d < 3; d++)
            x[d] = cell->centre[d] + (k == 8 ? 0 : ((k >> d & 1) - 0.5) * cell->edge);
        double winds = ref_cloud_winding(cloud, x), value = shape_at(cell, x, gradient);
        if (fabs(winds - 0.5) > doubt && (value < 0) != (winds > 0.5) && !among_points(cloud, x))
            return false;
    }
    return true;
}

/* ---- the function */

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
        double value = shape_at(cell, cloud->points->position[point[p]], gradient);
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
        fit_distance(cloud, cell);
        return level >= COARSE || last || is_sane(cloud, cell, 0);
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
    bool good = fit_shape(cloud, count, near, reach, cell);
    if (!few && !last) good = good && misfit(cloud, count, near, cell) <= mpu->tolerance;
    if (few || last || level < COARSE) good = good && is_sane(cloud, cell, 0.25);
    if (good) return true;
    if (!last && !(few && level >= COARSE)) return false;
    fit_distance(cloud, cell);
    return true;
}

static void split(RefMpu *mpu, int at)
{
    sm_make_room(mpu->cell, mpu->room, mpu->count + 8);
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
    assert(cloud->points);
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
    double weight = weight_at(distance, cell->radius, &slope);
    if (!(weight > 0)) return;
    double value = shape_at(cell, b->x, gradient);
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
