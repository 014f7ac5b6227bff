#include "clip.h"

#include <gsl/gsl_integration.h>
#include <math.h>

#include "../../../lib/vector.h"
#include "walls.h"

typedef struct {
    const RefField *field;
    const RefOctantOptions *options;
    double at[4], weight[4]; /* Gauss, on -1/2..1/2, weights of sum 1 */
    RefOctants *tree;
    double volume;
} Clip;

void ref_clip_gauss(int order, double *at, double *weight)
{
    gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc((size_t)order);
    for (int n = 0; n < order; n++)
        gsl_integration_glfixed_point(-0.5, 0.5, (size_t)n, at + n, weight + n, table);
    gsl_integration_glfixed_table_free(table);
}

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

/* What of a cube lies on the inner side of a plane: its volume and the plane's part in it. */
typedef struct {
    double volume, middle[3];
    RefWall wall;
    int ends; /* the plane's points in the outermost columns that it cuts */
    double end[4][3];
} Share;

/* Where value + gradient . (x - centre) < 0: columns along the axis that the gradient is closest
 * to, each cut exactly. */
static Share below_plane(const double centre[3], double edge, double value,
                         const double gradient[3])
{
    enum { SIDE = 4 };
    Share share = {.wall.surface = true};
    double moment[3] = {0}, surface[3] = {0}, sum = 0;
    int up = 0, cut = 0;
    for (int d = 1; d < 3; d++)
        if (fabs(gradient[d]) > fabs(gradient[up])) up = d;
    for (int n = 0; n < SIDE * SIDE; n++) {
        double from[3] = {0}, low = -0.5 * edge, high = 0.5 * edge;
        from[(up + 1) % 3] = ((n % SIDE + 0.5) / SIDE - 0.5) * edge;
        from[(up + 2) % 3] = ((n / SIDE + 0.5) / SIDE - 0.5) * edge;
        double level = -(value + sm_dot(gradient, from)) / gradient[up];
        if (level > low && level < high) {
            from[up] = level;
            for (int d = 0; d < 3; d++) surface[d] += from[d];
            cut++;
            bool outermost =
                (n % SIDE == 0 || n % SIDE == SIDE - 1) && (n / SIDE == 0 || n / SIDE == SIDE - 1);
            for (int d = 0; outermost && d < 3; d++) share.end[share.ends][d] = centre[d] + from[d];
            share.ends += outermost;
        }
        *(gradient[up] > 0 ? &high : &low) = fmin(fmax(level, low), high);
        from[up] = (low + high) / 2;
        sum += high - low;
        for (int d = 0; d < 3; d++) moment[d] += (high - low) * from[d];
    }
    share.volume = sum / (SIDE * SIDE) * edge * edge;
    for (int d = 0; d < 3; d++) {
        share.middle[d] = centre[d] + (sum > 0 ? moment[d] / sum : 0);
        share.wall.x[d] = centre[d] + (cut ? surface[d] / cut : 0);
        share.wall.area[d] = cut * edge * edge / (SIDE * SIDE) * gradient[d] / fabs(gradient[up]);
    }
    return share;
}

static void part(Clip *clip, const double centre[3], double edge, int depth);

static void split_part(Clip *clip, const double centre[3], double edge, int depth)
{
    for (int which = 0; which < 8; which++) {
        double x[3];
        for (int d = 0; d < 3; d++) x[d] = centre[d] + ((which >> d & 1) - 0.5) * 0.5 * edge;
        part(clip, x, edge / 2, depth + 1);
    }
}

bool ref_clip_sharp(const RefField *field, int count, const double (*x)[3],
                    const double gradient[3])
{
    for (int n = 0; n < count; n++) {
        double there[3];
        ref_field_at(field, x[n], there);
        double lengths = sqrt(sm_dot(gradient, gradient) * sm_dot(there, there));
        if (sm_dot(gradient, there) < 0.8 * lengths) return true;
    }
    return false;
}

/* A part `depth` levels below the Gauss parts. It is cut if its tangent plane cuts it, so that a
 * face of the body that is a face of the part leaves the part whole. */
static void part(Clip *clip, const double centre[3], double edge, int depth)
{
    double gradient[3], value = ref_field_at(clip->field, centre, gradient);
    double corner = 0.5 * edge * (fabs(gradient[0]) + fabs(gradient[1]) + fabs(gradient[2]));
    bool cut = fabs(value) < corner * (1 - 1e-9);
    if (!cut && value >= 0) return;
    if (!cut && depth == 0) {
        gauss(clip, centre, edge);
    } else if (!cut) {
        append(clip, centre, edge * edge * edge);
    } else if (depth < clip->options->clip) {
        split_part(clip, centre, edge, depth);
    } else {
        Share share = below_plane(centre, edge, value, gradient);
        if (!clip->options->rough && depth < clip->options->clip + REF_CLIP_SHARP &&
            ref_clip_sharp(clip->field, share.ends, (const double(*)[3])share.end, gradient)) {
            split_part(clip, centre, edge, depth);
            return;
        }
        if (share.volume > 1e-9 * edge * edge * edge) append(clip, share.middle, share.volume);
        if (!clip->options->rough) ref_walls_append(clip->tree, &share.wall);
    }
}

double ref_clip_cell(const RefField *field, const RefOctantOptions *options, const double centre[3],
                     double edge, RefOctants *tree)
{
    Clip clip = {.field = field, .options = options, .tree = tree};
    ref_clip_gauss(options->gauss, clip.at, clip.weight);
    int parts = 1 << options->split;
    for (int n = 0; n < parts * parts * parts; n++) {
        double x[3] = {n % parts, n / parts % parts, n / (parts * parts)};
        for (int d = 0; d < 3; d++) x[d] = centre[d] + ((x[d] + 0.5) / parts - 0.5) * edge;
        part(&clip, x, edge / parts, 0);
    }
    return clip.volume;
}
