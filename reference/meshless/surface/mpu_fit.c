#include "mpu_fit.h"

#include <math.h>
#include <string.h>

#include "../../../lib/vector.h"
#include "normal.h"

enum { HEIGHT = 6, QUADRIC = 10, CORNERS = 9, ASKED = 6 };

double ref_mpu_weight(double distance, double radius, double *slope)
{
    double t = 1.5 * distance / radius, per = 1.5 / radius;
    if (t >= 1.5) {
        *slope = 0;
        return 0;
    }
    *slope = (t < 0.5 ? -2 * t : t - 1.5) * per;
    return t < 0.5 ? 0.75 - t * t : 0.5 * (1.5 - t) * (1.5 - t);
}

double ref_mpu_shape(const RefMpuCell *cell, const double x[3], double gradient[3])
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
    return ref_mpu_weight(sqrt(sm_dot(s, s)) * cell->radius, reach, &slope) + 1e-6;
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
        ref_normal_add(HEIGHT, row, sm_dot(s, n), weight, N, a);
    }
    ref_normal_solve(HEIGHT, 3, N, a);
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
        ref_normal_add(QUADRIC, row, 0, weight, N, cell->shape);
    }
    for (int k = 0; k < CORNERS; k++) {
        if (!asked[k]) continue;
        terms_at(corner[k], row);
        ref_normal_add(QUADRIC, row, distance[k] / cell->radius, 1.0 / agreed, N, cell->shape);
    }
    ref_normal_solve(QUADRIC, 0, N, cell->shape);
    return true;
}

bool ref_mpu_fit(const RefCloud *cloud, long count, const long *point, double reach,
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

void ref_mpu_distance(const RefCloud *cloud, RefMpuCell *cell)
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

bool ref_mpu_sane(const RefCloud *cloud, const RefMpuCell *cell, double doubt)
{
    for (int k = 0; k < CORNERS; k++) {
        double x[3], gradient[3];
        for (int d = 0; d < 3; d++)
            x[d] = cell->centre[d] + (k == 8 ? 0 : ((k >> d & 1) - 0.5) * cell->edge);
        double winds = ref_cloud_winding(cloud, x), value = ref_mpu_shape(cell, x, gradient);
        if (fabs(winds - 0.5) > doubt && (value < 0) != (winds > 0.5) && !among_points(cloud, x))
            return false;
    }
    return true;
}
