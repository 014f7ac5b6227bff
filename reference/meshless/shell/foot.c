#include "foot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"

enum { MOST_STEPS = 12 };

/* A node's place at rest and its normal, and nothing. */
enum { FIELDS = REF_FRAME_SLOPES, PLACE = 0, NORMAL = 3 };

/* What a sample of a cracked shell says of all that is nearest to it: the sums of places and of
 * normals with its functions' parts. */
typedef struct {
    long cell; /* terminal; -1: none */
    double low[2], edge[2];
    bool whole; /* no crack touches it */
    int sample; /* of the cell; -1: none */
    bool tame;  /* ref_samples_expand() takes nothing back there */
    double sum[6][FIELDS];
} Sight;

typedef struct {
    const RefShell *shell;
    const RefWarp *warp;
    const double (*theta)[2];
    const double (*x)[3];
    const RefCracked *cracked;
    const bool *leant;
    Sight *sight;
    double (*field)[FIELDS]; /* [nodes] */
} Feet;

static long cell_of(const void *data, long point)
{
    const Feet *feet = data;
    return ref_quadtree_at(&feet->shell->tree, feet->theta[point]);
}

static int nearest(const void *data, long point)
{
    const Feet *feet = data;
    int best = 0;
    double least = INFINITY;
    for (long n = 0; n < feet->warp->nodes; n++) {
        double square = sm_square_between(feet->warp->X[n], feet->x[point]);
        if (square < least) {
            least = square;
            best = (int)n;
        }
    }
    return best;
}

/* Place and normal there, and their slopes: sums of parts 0 to 2 of the functions. */
static void sum_parts(const RefWarp *warp, const RefShape *shape, double place[3][3],
                      double normal[3][3])
{
    memset(place, 0, sizeof(double[3][3]));
    memset(normal, 0, sizeof(double[3][3]));
    for (int n = 0; n < shape->count; n++) {
        double part[3] = {shape->value[n], shape->gradient[n][0], shape->gradient[n][1]};
        for (int k = 0; k < 3; k++)
            for (int d = 0; d < 3; d++) {
                place[k][d] += part[k] * warp->X[shape->node[n]][d];
                normal[k][d] += part[k] * warp->rest_normal[shape->node[n]][d];
            }
    }
}

/* One of Newton's steps for offsets o along the two parameters and up the normal; returns how far
 * they were off. */
static double step(const double place[3][3], const double normal[3][3], const double x[3],
                   double o[3])
{
    double slope[3][3], off[3], across[3][3];
    for (int d = 0; d < 3; d++) {
        for (int k = 0; k < 2; k++) slope[k][d] = place[1 + k][d] + o[2] * normal[1 + k][d];
        slope[2][d] = normal[0][d] + o[0] * normal[1][d] + o[1] * normal[2][d];
        off[d] = x[d] - place[0][d] - o[0] * place[1][d] - o[1] * place[2][d] - o[2] * slope[2][d];
    }
    for (int k = 0; k < 3; k++) sm_cross(slope[(k + 1) % 3], slope[(k + 2) % 3], across[k]);
    double volume = sm_dot(slope[0], across[0]), up = sm_dot(slope[2], slope[2]);
    double sides = sqrt(sm_dot(slope[0], slope[0]) * sm_dot(slope[1], slope[1]) * up);
    if (fabs(volume) > 1e-9 * sides) /* Cramer's rule */
        for (int k = 0; k < 3; k++) o[k] += sm_dot(off, across[k]) / volume;
    else if (up > 0) /* tangents in a line or a normal in their plane: along it alone */
        o[2] += sm_dot(off, slope[2]) / up;
    return sqrt(sm_dot(off, off));
}

/* How far o leads out of the reach: of a cell's edges along the parameters, and of `height` up.
 * What was shortened to 1 is within, however that was rounded. */
static const double WITHIN = 1 + 1e-9;
static double beyond(const double o[3], const double edge[2], double height)
{
    return fmax(fmax(fabs(o[0]) / edge[0], fabs(o[1]) / edge[1]), fabs(o[2]) / height);
}

/* The offsets, or where Newton's steps do not find them within reach, those in the frame at the
 * place: the first step's, so much of them as is. */
static void find_foot(const double place[3][3], const double normal[3][3], const double x[3],
                      const double edge[2], double height, double o[3])
{
    double first[3] = {0}, off = INFINITY;
    step(place, normal, x, first);
    double far = beyond(first, edge, height);
    for (int k = 0; k < 3 && far > 1; k++) first[k] /= far;
    memcpy(o, first, sizeof first);
    for (int n = 0; n < MOST_STEPS && off > 1e-7 * height && beyond(o, edge, height) <= WITHIN; n++)
        off = step(place, normal, x, o); /* the last one squares it */
    if (!(off < 1e-6 * height && beyond(o, edge, height) <= WITHIN)) memcpy(o, first, sizeof first);
}

/* The offsets of x in a cell, from place and normal there; false where functions are constant. */
static bool offsets(const double place[3][3], const double normal[3][3], const double x[3],
                    const double edge[2], double o[3])
{
    double length = sqrt(sqrt(sm_dot(place[1], place[1]) * sm_dot(place[2], place[2])));
    if (length == 0) return false;
    find_foot(place, normal, x, edge, 2 * length * fmax(edge[0], edge[1]), o);
    return true;
}

void ref_foot_of(const RefShell *shell, const RefWarp *warp, const double theta[2],
                 const double x[3], RefShape *shape, double *lift)
{
    const RefQuadtree *tree = &shell->tree;
    double place[3][3], normal[3][3], o[3], middle[2], edge[2];
    *lift = 0;
    sum_parts(warp, shape, place, normal);
    ref_quadtree_cell(tree, tree->cell + ref_quadtree_at(tree, theta), middle, edge);
    if (!offsets((const double(*)[3])place, (const double(*)[3])normal, x, edge, o)) return;
    *lift = o[2];
    for (int n = 0; n < shape->count; n++)
        shape->value[n] += o[0] * shape->gradient[n][0] + o[1] * shape->gradient[n][1];
}

bool ref_foot_at(const RefShell *shell, const RefWarp *warp, const double theta[2],
                 const double x[3], RefShape *shape, double *lift)
{
    const double at[3] = {theta[0], theta[1]};
    *lift = 0;
    if (!ref_shell_shape(shell, at, shape)) return false;
    ref_foot_of(shell, warp, theta, x, shape, lift);
    return true;
}

static bool weigh(const void *data, long point, RefShape *shape, double *lift)
{
    const Feet *feet = data;
    return ref_foot_at(feet->shell, feet->warp, feet->theta[point], feet->x[point], shape, lift);
}

/* The terminal cell at a place: points go on in the same one mostly. */
static void look_at(const RefCracked *cracked, const double theta[2], Sight *sight)
{
    const RefQuadtree *tree = &cracked->shell->tree;
    bool inside = sight->cell >= 0;
    for (int d = 0; d < 2; d++)
        inside = inside && theta[d] > sight->low[d] && theta[d] < sight->low[d] + sight->edge[d];
    long cell = inside ? sight->cell : ref_quadtree_at(tree, theta);
    if (cell == sight->cell) return;
    double middle[2], high[2];
    sight->cell = cell;
    sight->sample = -1;
    ref_quadtree_cell(tree, tree->cell + cell, middle, sight->edge);
    for (int d = 0; d < 2; d++) {
        sight->low[d] = middle[d] - sight->edge[d] / 2;
        high[d] = middle[d] + sight->edge[d] / 2;
    }
    sight->whole = !ref_cracks_look(&cracked->cracks, sight->low, high);
}

/* A tenth of an edge, beyond which another sample is nearer. */
static const double NEAR = 0.1;

/* Taylor's series from a sample, of functions or of their sums, are of 1, x, y, x^2 / 2, y^2 / 2
 * and x y; along offsets o from there they go on by their slopes. */
static void series(double x, double y, const double o[2], double times[6])
{
    times[0] = 1;
    times[1] = x + o[0];
    times[2] = y + o[1];
    times[3] = x * (x / 2 + o[0]);
    times[4] = y * (y / 2 + o[1]);
    times[5] = x * y + o[0] * y + o[1] * x;
}

static void sum_sight(const Feet *feet, const RefSamples *samples, int s, Sight *sight)
{
    const double none[2] = {0};
    const long start = samples->start[s], end = samples->start[s + 1];
    double most[6];
    sight->sample = s;
    sight->tame = true;
    series(NEAR * sight->edge[0], NEAR * sight->edge[1], none, most);
    for (long e = start; e < end; e++) {
        double value = 0;
        for (int m = 0; m < 6; m++) value += fabs(samples->part[e][m]) * most[m];
        sight->tame = sight->tame && value < REF_SAMPLES_MOST_VALUE;
    }
    ref_frame_sums.parts((int)(end - start), samples->node + start,
                         (const double(*)[6])(samples->part + start),
                         (const double(*)[FIELDS])feet->field, sight->sum);
}

/* A field at x, y from the sample, and its slopes there. */
static void expand(const double sum[6][FIELDS], int field, double x, double y, double at[3][3])
{
    const double none[2] = {0};
    double times[6];
    series(x, y, none, times);
    for (int d = 0; d < 3; d++) {
        int f = field + d;
        at[0][d] = 0;
        for (int m = 0; m < 6; m++) at[0][d] += times[m] * sum[m][f];
        at[1][d] = sum[1][f] + x * sum[3][f] + y * sum[5][f];
        at[2][d] = sum[2][f] + y * sum[4][f] + x * sum[5][f];
    }
}

/* The sample whose functions are those of a place, or -1. */
static int sample_at(const RefCracked *cracked, const double theta[2], Sight *sight)
{
    double middle[2];
    look_at(cracked, theta, sight);
    for (int d = 0; d < 2; d++) middle[d] = sight->low[d] + sight->edge[d] / 2;
    return sight->whole ? ref_samples_nearest(middle, sight->edge, theta)
                        : ref_cracked_sample(cracked, sight->cell, theta);
}

/* What weigh() finds, of the first points that are nearest to the same sample of a shell that
 * cracks: from sums over its functions. */
static void share(const void *data, int count, const long *point, RefSkinShare *share)
{
    const Feet *feet = data;
    Sight *sight = feet->sight;
    int first = sample_at(feet->cracked, feet->theta[*point], sight);
    long cell = sight->cell;
    const RefSamples *samples = &feet->cracked->cell[cell].samples;
    share->points = 0;
    if (first < 0 || samples->start[first] == samples->start[first + 1]) return;
    if (sight->sample != first) sum_sight(feet, samples, first, sight);
    if (!sight->tame) return;
    share->nodes = (int)(samples->start[first + 1] - samples->start[first]);
    share->node = samples->node + samples->start[first];
    share->part = (const double(*)[6])(samples->part + samples->start[first]);
    for (int p = 0; p < count; p++) {
        const double *theta = feet->theta[point[p]];
        double at[2][3][3], o[3] = {0}, times[6];
        if (p > 0 && (sample_at(feet->cracked, theta, sight) != first || sight->cell != cell))
            return;
        double x = theta[0] - samples->theta[first][0], y = theta[1] - samples->theta[first][1];
        if (!(fabs(x) < NEAR * sight->edge[0] && fabs(y) < NEAR * sight->edge[1])) return;
        expand((const double(*)[FIELDS])sight->sum, PLACE, x, y, at[0]);
        expand((const double(*)[FIELDS])sight->sum, NORMAL, x, y, at[1]);
        offsets((const double(*)[3])at[0], (const double(*)[3])at[1], feet->x[point[p]],
                sight->edge, o);
        series(x, y, o, times);
        for (int m = 0; m < 6; m++) share->times[m][p] = times[m];
        share->lift[p] = o[2];
        share->points++;
    }
}

/* The sample that is nearest. */
static int place_of(const void *data, long point)
{
    const Feet *feet = data;
    const RefQuadtree *tree = &feet->shell->tree;
    double middle[2], edge[2];
    ref_quadtree_cell(tree, tree->cell + ref_quadtree_at(tree, feet->theta[point]), middle, edge);
    return ref_samples_nearest(middle, edge, feet->theta[point]);
}

static bool is_stale(const void *data, long cell, int nodes, const int *node)
{
    const Feet *feet = data;
    if (ref_cracked_again(feet->cracked, cell)) return true;
    for (int n = 0; n < nodes; n++)
        if (feet->leant[node[n]]) return true;
    return false;
}

void ref_foot_renew(const RefCracked *cracked, const RefWarp *warp, const bool *leant,
                    const double (*theta)[2], const double (*x)[3], RefSkin *skin, long *loose)
{
    Sight sight = {.cell = -1};
    double(*field)[FIELDS] = sm_alloc((size_t)warp->nodes, sizeof *field);
    Feet feet = {cracked->shell, warp, theta, x, cracked, leant, &sight, field};
    for (long n = 0; n < warp->nodes; n++) {
        memcpy(field[n] + PLACE, warp->X[n], sizeof warp->X[n]);
        memcpy(field[n] + NORMAL, warp->rest_normal[n], sizeof warp->rest_normal[n]);
    }
    RefSkinCarrier carrier = {&feet, &cracked->shell->nodes, cell_of, weigh, nearest, place_of,
                              share};
    ref_skin_renew(&carrier, is_stale, skin, loose);
    free(field);
}

void ref_foot_skin(const RefShell *shell, const RefWarp *warp, long count, const double (*theta)[2],
                   const double (*x)[3], RefSkin *skin, long *loose)
{
    Feet feet = {.shell = shell, .warp = warp, .theta = theta, .x = x};
    RefSkinCarrier carrier = {&feet, &shell->nodes, cell_of, weigh, nearest, place_of, NULL};
    ref_skin_build(&carrier, true, count, x, skin, loose);
}
