#include "foot.h"

#include <math.h>
#include <string.h>

#include "../../../lib/vector.h"

enum { MOST_STEPS = 12 };

/* What a sample of a cracked shell says of all that is nearest to it: the sums of places and of
 * normals with its functions' parts. */
typedef struct {
    bool summed, tame; /* tame: ref_samples_expand() takes nothing back there */
    double X[6][3], normal[6][3];
} Sight;

/* The samples of the terminal cell that points were in last. */
typedef struct {
    long cell; /* -1: none */
    double low[2], high[2];
    bool whole; /* no crack touches it */
    Sight sight[REF_SAMPLES_PER_CELL];
} Glass;

typedef struct {
    const RefShell *shell;
    const RefWarp *warp;
    const double (*theta)[2];
    const double (*x)[3];
    const RefCracked *cracked;
    const bool *leant;
    Glass *glass;
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

/* How far o leads out of the reach: of a cell's edges along the parameters, and of `height` up. */
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
    for (int n = 0; n < MOST_STEPS && off > 1e-12 * height && beyond(o, edge, height) <= 1; n++)
        off = step(place, normal, x, o);
    if (!(off < 1e-6 * height && beyond(o, edge, height) <= 1)) memcpy(o, first, sizeof first);
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

/* Points go on in the same cell mostly. */
static void look_at(const RefCracked *cracked, const double theta[2], Glass *glass)
{
    const RefQuadtree *tree = &cracked->shell->tree;
    bool inside = glass->cell >= 0;
    for (int d = 0; d < 2; d++)
        inside = inside && theta[d] > glass->low[d] && theta[d] < glass->high[d];
    long cell = inside ? glass->cell : ref_quadtree_at(tree, theta);
    if (cell == glass->cell) return;
    double middle[2], edge[2];
    glass->cell = cell;
    ref_quadtree_cell(tree, tree->cell + cell, middle, edge);
    for (int d = 0; d < 2; d++) {
        glass->low[d] = middle[d] - edge[d] / 2;
        glass->high[d] = middle[d] + edge[d] / 2;
    }
    glass->whole = !ref_cracks_look(&cracked->cracks, glass->low, glass->high);
    for (int s = 0; s < REF_SAMPLES_PER_CELL; s++) glass->sight[s].summed = false;
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

static void sum_sight(const RefWarp *warp, const RefSamples *samples, int s, const double edge[2],
                      Sight *sight)
{
    const double none[2] = {0};
    double most[6];
    *sight = (Sight){.summed = true, .tame = true};
    series(NEAR * edge[0], NEAR * edge[1], none, most);
    for (long e = samples->start[s]; e < samples->start[s + 1]; e++) {
        const double *part = samples->part[e], *X = warp->X[samples->node[e]];
        const double *normal = warp->rest_normal[samples->node[e]];
        double value = 0;
        for (int m = 0; m < 6; m++) {
            value += fabs(part[m]) * most[m];
            for (int d = 0; d < 3; d++) {
                sight->X[m][d] += part[m] * X[d];
                sight->normal[m][d] += part[m] * normal[d];
            }
        }
        sight->tame = sight->tame && value < REF_SAMPLES_MOST_VALUE;
    }
}

/* A sum at x, y from the sample, and its slopes there. */
static void expand(const double sum[6][3], double x, double y, double at[3][3])
{
    const double none[2] = {0};
    double times[6];
    series(x, y, none, times);
    for (int d = 0; d < 3; d++) {
        at[0][d] = at[1][d] = at[2][d] = 0;
        for (int m = 0; m < 6; m++) at[0][d] += times[m] * sum[m][d];
        at[1][d] = sum[1][d] + x * sum[3][d] + y * sum[5][d];
        at[2][d] = sum[2][d] + y * sum[4][d] + x * sum[5][d];
    }
}

/* What weigh() finds, of a shell that has cracks: from sums over functions that all points share
 * which are nearest to a sample. */
static bool weigh_cracked(const void *data, long point, RefShape *shape, double *lift)
{
    const Feet *feet = data;
    const double *theta = feet->theta[point];
    Glass *glass = feet->glass;
    look_at(feet->cracked, theta, glass);
    const RefSamples *samples = &feet->cracked->cell[glass->cell].samples;
    double edge[2], middle[2], at[2][3][3], o[3] = {0}, times[6];
    for (int d = 0; d < 2; d++) {
        edge[d] = glass->high[d] - glass->low[d];
        middle[d] = (glass->low[d] + glass->high[d]) / 2;
    }
    int s = glass->whole ? ref_samples_nearest(middle, edge, theta)
                         : ref_cracked_sample(feet->cracked, glass->cell, theta);
    if (s < 0) return weigh(data, point, shape, lift);
    double x = theta[0] - samples->theta[s][0], y = theta[1] - samples->theta[s][1];
    Sight *sight = glass->sight + s;
    if (!sight->summed) sum_sight(feet->warp, samples, s, edge, sight);
    if (!sight->tame || !(fabs(x) < NEAR * edge[0] && fabs(y) < NEAR * edge[1]))
        return weigh(data, point, shape, lift);
    expand((const double(*)[3])sight->X, x, y, at[0]);
    expand((const double(*)[3])sight->normal, x, y, at[1]);
    offsets((const double(*)[3])at[0], (const double(*)[3])at[1], feet->x[point], edge, o);
    *lift = o[2];
    series(x, y, o, times);
    long start = samples->start[s];
    shape->count = (int)(samples->start[s + 1] - start);
    for (int n = 0; n < shape->count; n++) {
        const double *part = samples->part[start + n];
        shape->node[n] = samples->node[start + n];
        shape->value[n] = 0;
        for (int m = 0; m < 6; m++) shape->value[n] += times[m] * part[m];
    }
    return shape->count > 0;
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
    Glass glass = {.cell = -1};
    Feet feet = {cracked->shell, warp, theta, x, cracked, leant, &glass};
    RefSkinCarrier carrier = {&feet, &cracked->shell->nodes, cell_of, weigh_cracked, nearest};
    ref_skin_renew(&carrier, is_stale, skin, loose);
}

void ref_foot_skin(const RefShell *shell, const RefWarp *warp, long count, const double (*theta)[2],
                   const double (*x)[3], RefSkin *skin, long *loose)
{
    Feet feet = {.shell = shell, .warp = warp, .theta = theta, .x = x};
    RefSkinCarrier carrier = {&feet, &shell->nodes, cell_of, weigh, nearest};
    ref_skin_build(&carrier, true, count, x, skin, loose);
}
