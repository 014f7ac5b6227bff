#include "fields.h"

#include <math.h>
#include <stdlib.h>

#include "../engines.h"

const char *const bench_field_names[] = {"displacement", "speed", "strain", "piece", "level", NULL};
const int bench_field_components[] = {3, 1, 1, 1, 1};

static bool has_levels(const BenchEngine *engine)
{
    return engine->carrier->levels;
}

SmCode bench_fields_check(const BenchPlayback *play, BenchFields fields, SmError *error)
{
    const BenchGroup *group = play->group;
    char names[BENCH_ENGINES_TEXT];
    if ((fields & 1u << BENCH_LEVEL) && !group->carrier->levels)
        return sm_fail(error, SM_USAGE,
                       "--fields level is of an octree's leaves: leave it out, or give --engine %s",
                       bench_engines_that(has_levels, names));
    if ((fields & ~(1u << BENCH_DISPLACEMENT)) && !group->skin.surface.triangle_count)
        return sm_fail(error, SM_USAGE,
                       "--fields: points without triangles have only a displacement");
    return SM_OK;
}

/* Squares of edges of a triangle, and their product. */
static void metric(const double (*x)[3], const int corner[3], double G[3])
{
    G[0] = G[1] = G[2] = 0;
    for (int d = 0; d < 3; d++) {
        double a = x[corner[1]][d] - x[corner[0]][d], b = x[corner[2]][d] - x[corner[0]][d];
        G[0] += a * a, G[1] += a * b, G[2] += b * b;
    }
}

/* The stretches are roots of the eigenvalues of A^-1 B, for the metrics A at rest and B now. */
static double triangle_strain(const double A[3], double det, const double B[3])
{
    double half = (A[2] * B[0] - 2 * A[1] * B[1] + A[0] * B[2]) / (2 * det);
    double product = fmax(0, (B[0] * B[2] - B[1] * B[1]) / det);
    double most = half + sqrt(fmax(0, half * half - product));
    double least = most > 0 ? product / most : 0;
    return fmax(sqrt(most) - 1, 1 - sqrt(least));
}

void bench_strain(const SmMesh *rest, const double (*point)[3], float *strain)
{
    double *area = sm_alloc((size_t)rest->vertex_count, sizeof *area);
    double *sum = sm_alloc((size_t)rest->vertex_count, sizeof *sum);
    for (long t = 0; t < rest->triangle_count; t++) {
        const int *corner = rest->triangle[t];
        double A[3], B[3];
        metric((const double(*)[3])rest->position, corner, A);
        metric(point, corner, B);
        double det = A[0] * A[2] - A[1] * A[1];
        if (!(det > 1e-20 * A[0] * A[2])) continue; /* a needle, of no area */
        for (int c = 0; c < 3; c++) {
            area[corner[c]] += sqrt(det);
            sum[corner[c]] += sqrt(det) * triangle_strain(A, det, B);
        }
    }
    for (long v = 0; v < rest->vertex_count; v++)
        strain[v] = area[v] > 0 ? (float)(sum[v] / area[v]) : 0;
    free(area);
    free(sum);
}

/* The last step took the points here from x - h v of what carries them. */
static void find_speed(BenchPlayback *play, const SmMesh *rest, const double (*point)[3],
                       float *speed)
{
    double h = play->scene->params.h;
    double(*before)[3] = sm_alloc((size_t)rest->vertex_count, sizeof *before), (*at)[3] = before;
    for (int i = 0; i < play->count; i++) {
        BenchGroup *group = &play->group[i];
        bench_group_surface(group, h, at);
        at += group->body.instances * group->skin.surface.vertex_count;
    }
    for (long v = 0; v < rest->vertex_count; v++) {
        double square = 0;
        for (int d = 0; d < 3; d++) square += pow((point[v][d] - before[v][d]) / h, 2);
        speed[v] = (float)sqrt(square);
    }
    free(before);
}

/* Levels or pieces of what carries the points. */
static void find_carriers(BenchPlayback *play, BenchPointField field, float *value)
{
    long pieces = 0;
    for (int i = 0; i < play->count; i++) {
        BenchGroup *group = &play->group[i];
        long vertices = group->skin.surface.vertex_count;
        int *of = sm_alloc((size_t)vertices, sizeof *of);
        long count = 0;
        if (field == BENCH_PIECE)
            count = bench_group_pieces(group, of);
        else
            group->carrier->levels(group, of);
        for (long k = 0; k < group->body.instances; k++, pieces += count)
            for (long v = 0; v < vertices; v++) *value++ = (float)(pieces + of[v]);
        free(of);
    }
}

void bench_fields_find(BenchPlayback *play, BenchFields fields, const SmMesh *rest,
                       const double (*point)[3], float *const value[BENCH_POINT_FIELDS])
{
    float *displacement = value[BENCH_DISPLACEMENT];
    if (fields & 1u << BENCH_DISPLACEMENT)
        for (long v = 0; v < rest->vertex_count; v++)
            for (int d = 0; d < 3; d++)
                displacement[3 * v + d] = (float)(point[v][d] - rest->position[v][d]);
    if (fields & 1u << BENCH_SPEED) find_speed(play, rest, point, value[BENCH_SPEED]);
    if (fields & 1u << BENCH_STRAIN) bench_strain(rest, point, value[BENCH_STRAIN]);
    for (int f = BENCH_PIECE; f <= BENCH_LEVEL; f++)
        if (fields & 1u << f) find_carriers(play, (BenchPointField)f, value[f]);
}
