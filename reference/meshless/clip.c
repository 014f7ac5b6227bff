#include "clip.h"

#include <gsl/gsl_integration.h>
#include <math.h>

#include "../../lib/vector.h"

typedef struct {
    const RefField *field;
    const RefOctantOptions *options;
    double at[4], weight[4]; /* Gauss, on -1/2..1/2, weights of sum 1 */
    RefOctants *tree;
    double volume;
} Clip;

/* Half the diagonal, with room for a field that grows faster than the distance. */
static double reach(double edge, const double gradient[3])
{
    double slope = sqrt(sm_dot(gradient, gradient));
    return 0.5 * sqrt(3) * edge * fmax(slope, 1);
}

int ref_clip_side(const RefField *field, const double centre[3], double edge)
{
    double gradient[3], value = ref_field_at(field, centre, gradient);
    if (fabs(value) < reach(edge, gradient)) return 0;
    return value < 0 ? -1 : 1;
}

static void append(Clip *clip, const double x[3], double weight)
{
    RefOctants *tree = clip->tree;
    if (tree->points == tree->point_room) {
        tree->point_room = 2 * tree->point_room + 64;
        tree->point = sm_realloc(tree->point, (size_t)tree->point_room, sizeof *tree->point);
    }
    tree->point[tree->points++] = (RefPoint){{x[0], x[1], x[2]}, weight};
    clip->volume += weight;
}

static void gauss(Clip *clip, const double centre[3], double edge)
{
    int order = clip->options->gauss;
    double volume = edge * edge * edge;
    for (int n = 0; n < order * order * order; n++) {
        int which[3] = {n % order, n / order % order, n / (order * order)};
        double x[3], weight = volume;
        for (int d = 0; d < 3; d++) {
            x[d] = centre[d] + edge * clip->at[which[d]];
            weight *= clip->weight[which[d]];
        }
        append(clip, x, weight);
    }
}

/* What of a cube lies where value + gradient . (x - centre) < 0: columns along the axis that the
 * gradient is closest to, each cut exactly. */
static void below_plane(Clip *clip, const double centre[3], double edge, double value,
                        const double gradient[3])
{
    enum { SIDE = 4 };
    double moment[3] = {0}, sum = 0, x[3];
    int up = 0;
    for (int d = 1; d < 3; d++)
        if (fabs(gradient[d]) > fabs(gradient[up])) up = d;
    for (int n = 0; n < SIDE * SIDE; n++) {
        double from[3] = {0}, low = -0.5 * edge, high = 0.5 * edge;
        from[(up + 1) % 3] = ((n % SIDE + 0.5) / SIDE - 0.5) * edge;
        from[(up + 2) % 3] = ((n / SIDE + 0.5) / SIDE - 0.5) * edge;
        double level = -(value + sm_dot(gradient, from)) / gradient[up];
        level = fmin(fmax(level, low), high);
        *(gradient[up] > 0 ? &high : &low) = level;
        from[up] = (low + high) / 2;
        sum += high - low;
        for (int d = 0; d < 3; d++) moment[d] += (high - low) * from[d];
    }
    if (!(sum > 1e-9 * edge)) return;
    for (int d = 0; d < 3; d++) x[d] = centre[d] + moment[d] / sum;
    append(clip, x, sum / (SIDE * SIDE) * edge * edge);
}

/* A part `depth` levels below the Gauss parts. It is cut if its tangent plane cuts it, so that a
 * face of the body that is a face of the part leaves the part whole. */
static void part(Clip *clip, const double centre[3], double edge, int depth)
{
    double gradient[3], value = ref_field_at(clip->field, centre, gradient);
    double corner = 0.5 * edge * (fabs(gradient[0]) + fabs(gradient[1]) + fabs(gradient[2]));
    bool last = depth == clip->options->clip;
    bool cut = fabs(value) < corner * (1 - 1e-9);
    if (!cut && value >= 0) return;
    if (!cut && depth == 0) {
        gauss(clip, centre, edge);
    } else if (!cut) {
        append(clip, centre, edge * edge * edge);
    } else if (last) {
        below_plane(clip, centre, edge, value, gradient);
    } else {
        for (int which = 0; which < 8; which++) {
            double x[3];
            for (int d = 0; d < 3; d++) x[d] = centre[d] + ((which >> d & 1) - 0.5) * 0.5 * edge;
            part(clip, x, edge / 2, depth + 1);
        }
    }
}

double ref_clip_cell(const RefField *field, const RefOctantOptions *options, const double centre[3],
                     double edge, RefOctants *tree)
{
    Clip clip = {.field = field, .options = options, .tree = tree};
    gsl_integration_glfixed_table *table =
        gsl_integration_glfixed_table_alloc((size_t)options->gauss);
    for (int n = 0; n < options->gauss; n++)
        gsl_integration_glfixed_point(-0.5, 0.5, (size_t)n, clip.at + n, clip.weight + n, table);
    gsl_integration_glfixed_table_free(table);
    int parts = 1 << options->split;
    for (int n = 0; n < parts * parts * parts; n++) {
        double x[3] = {n % parts, n / parts % parts, n / (parts * parts)};
        for (int d = 0; d < 3; d++) x[d] = centre[d] + ((x[d] + 0.5) / parts - 0.5) * edge;
        part(&clip, x, edge / parts, 0);
    }
    return clip.volume;
}
