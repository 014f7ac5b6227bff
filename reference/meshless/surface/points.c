#include "points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "../../../lib/mesh/import.h"
#include "../../../lib/vector.h"

void ref_points_free(RefPoints *points)
{
    sm_free_all(points->position, points->normal, points->as_given);
    *points = (RefPoints){0};
}

typedef struct {
    double x[3], n[3];
} Oriented;

static int by_position(const void *a, const void *b)
{
    const Oriented *p = a, *q = b;
    for (int d = 0; d < 3; d++)
        if (p->x[d] != q->x[d]) return p->x[d] < q->x[d] ? -1 : 1;
    return 0;
}

#define BARE "'run --engine shell' takes points without"

static SmCode check(long count, const double (*position)[3], const double (*normal)[3],
                    const char *name, SmError *error)
{
    for (long p = 0; p < count; p++) {
        double length = sqrt(sm_dot(normal[p], normal[p])), size = 0;
        for (int d = 0; d < 3; d++) size = fmax(size, fabs(position[p][d]));
        if (!(isfinite(position[p][0] + position[p][1] + position[p][2]) && size < 1e30))
            return sm_fail(error, SM_INPUT,
                           "%s: point %ld has a coordinate that is no number, or beyond 1e30", name,
                           p + 1);
        if (!isfinite(length))
            return sm_fail(error, SM_INPUT, "%s: point %ld has a normal that is no number", name,
                           p + 1);
        if (length > 0 && !(length > 0.5 && length < 1.5))
            return sm_fail(error, SM_INPUT,
                           "%s: point %ld has a normal of length %g, not 1 (text: columns 4 to 6; "
                           "PLY: nx ny nz); " BARE,
                           name, p + 1, length);
    }
    return SM_OK;
}

/* Runs of equal positions become one point each. */
static void merge(const Oriented *sorted, long count, RefPoints *points)
{
    for (long p = 0, end; p < count; p = end) {
        double sum[3] = {0};
        for (end = p; end < count && by_position(sorted + p, sorted + end) == 0; end++)
            for (int d = 0; d < 3; d++) sum[d] += sorted[end].n[d];
        if (!(sm_dot(sum, sum) > 1e-6) || !sm_normalize(sum)) continue;
        points->merged += end - p - 1;
        memcpy(points->position[points->count], sorted[p].x, sizeof sum);
        memcpy(points->normal[points->count++], sum, sizeof sum);
    }
}

/* Squares of lengths, and areas, must hold what the points span. */
static SmCode check_span(const RefPoints *points, const char *name, SmError *error)
{
    double span = 0;
    for (int d = 0; d < 3; d++) {
        double low = INFINITY, high = -INFINITY;
        for (long p = 0; p < points->count; p++) {
            low = fmin(low, points->position[p][d]);
            high = fmax(high, points->position[p][d]);
        }
        span = fmax(span, high - low);
    }
    if (span >= 1e-30) return SM_OK;
    return sm_fail(error, SM_INPUT, "%s: the points span %g: give them in a unit that is smaller",
                   name, span);
}

SmCode ref_points_create(long count, const double (*position)[3], const double (*normal)[3],
                         const char *name, RefPoints *points, SmError *error)
{
    *points = (RefPoints){0};
    SmCode code = check(count, position, normal, name, error);
    if (code != SM_OK) return code;
    Oriented *sorted = sm_alloc((size_t)count, sizeof *sorted);
    for (long p = 0; p < count; p++)
        for (int d = 0; d < 3; d++) {
            sorted[p].x[d] = position[p][d] + 0.0; /* no -0 */
            sorted[p].n[d] = normal[p][d];
        }
    qsort(sorted, (size_t)count, sizeof *sorted, by_position);
    points->position = sm_alloc((size_t)count, sizeof *points->position);
    points->normal = sm_alloc((size_t)count, sizeof *points->normal);
    points->given = count;
    points->as_given = sm_alloc((size_t)count, sizeof *points->as_given);
    memcpy(points->as_given, position, (size_t)count * sizeof *position);
    merge(sorted, count, points);
    free(sorted);
    if (points->count >= REF_LEAST_POINTS)
        code = check_span(points, name, error);
    else
        code = sm_fail(error, SM_INPUT,
                       "%s: %ld different points with normals are too few for a surface: %d or "
                       "more",
                       name, points->count, REF_LEAST_POINTS);
    if (code) ref_points_free(points);
    return code;
}

bool ref_points_text(const char *path)
{
    static const char *const suffix[] = {".xyz", ".pts", ".pwn", ".asc", ".txt"};
    size_t length = strlen(path),
           packed = length > 3 && !strcasecmp(path + length - 3, ".gz") ? 3 : 0;
    for (int i = 0; i < 5 && length > packed + 4; i++)
        if (!strncasecmp(path + length - packed - 4, suffix[i], 4)) return true;
    return false;
}

static bool all_bare(long count, const double (*normal)[3])
{
    for (long p = 0; p < count; p++)
        if (sm_dot(normal[p], normal[p]) > 0) return false;
    return true;
}

SmCode ref_points_rows(const char *path, bool bare, long *count, double (**position)[3],
                       double (**normal)[3], SmError *error)
{
    SmCode code = sm_import_points(path, count, position, normal, error);
    if (code != SM_OK) return code;
    code =
        check(*count, (const double(*)[3]) * position, (const double(*)[3]) * normal, path, error);
    if (code == SM_OK && !bare && all_bare(*count, (const double(*)[3]) * normal))
        code =
            sm_fail(error, SM_INPUT,
                    "%s: the points have no normals; give each one's nx, ny and nz; " BARE, path);
    if (code != SM_OK) sm_free_all(*position, *normal);
    return code;
}

SmCode ref_points_read(const char *path, RefPoints *points, SmError *error)
{
    long count;
    double(*position)[3], (*normal)[3];
    *points = (RefPoints){0};
    SmCode code = ref_points_rows(path, false, &count, &position, &normal, error);
    if (code != SM_OK) return code;
    code = ref_points_create(count, (const double(*)[3])position, (const double(*)[3])normal, path,
                             points, error);
    sm_free_all(position, normal);
    return code;
}

/* Twice the area's normal. */
static void across(const SmMesh *mesh, long t, double normal[3])
{
    double edge[2][3];
    for (int d = 0; d < 3; d++)
        for (int e = 0; e < 2; e++)
            edge[e][d] = mesh->position[mesh->triangle[t][e + 1]][d] -
                         mesh->position[mesh->triangle[t][0]][d];
    sm_cross(edge[0], edge[1], normal);
}

SmCode ref_points_of_mesh(const SmMesh *mesh, long count, RefPoints *points, SmError *error)
{
    double total = 0, due = 0, normal[3];
    for (long t = 0; t < mesh->triangle_count; t++) {
        across(mesh, t, normal);
        total += sqrt(sm_dot(normal, normal));
    }
    double(*x)[3] = sm_alloc((size_t)count + 1, sizeof *x);
    double(*n)[3] = sm_alloc((size_t)count + 1, sizeof *n);
    long made = 0;
    for (long t = 0; t < mesh->triangle_count; t++) {
        across(mesh, t, normal);
        due += sqrt(sm_dot(normal, normal)) / total * (double)count;
        if (!sm_normalize(normal)) continue;
        for (; made < (long)(due + 0.5) && made < count; made++) {
            /* a sequence of low discrepancy (plastic number) in the triangle */
            double u = fmod(0.5 + 0.7548776662466927 * (double)made, 1);
            double v = fmod(0.5 + 0.5698402909980532 * (double)made, 1);
            if (u + v > 1) {
                u = 1 - u;
                v = 1 - v;
            }
            const int *corner = mesh->triangle[t];
            for (int d = 0; d < 3; d++)
                x[made][d] = (1 - u - v) * mesh->position[corner[0]][d] +
                             u * mesh->position[corner[1]][d] + v * mesh->position[corner[2]][d];
            memcpy(n[made], normal, sizeof normal);
        }
    }
    SmCode code = ref_points_create(made, (const double(*)[3])x, (const double(*)[3])n, "the mesh",
                                    points, error);
    free(x);
    free(n);
    return code;
}
