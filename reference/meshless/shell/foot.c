#include "foot.h"

#include <math.h>
#include <string.h>

#include "../../../lib/vector.h"

enum { MOST_STEPS = 12 };

typedef struct {
    const RefShell *shell;
    const RefWarp *warp;
    const double (*theta)[2];
    const double (*x)[3];
    const RefCracked *cracked;
    const bool *leant;
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

void ref_foot_of(const RefShell *shell, const RefWarp *warp, const double theta[2],
                 const double x[3], RefShape *shape, double *lift)
{
    const RefQuadtree *tree = &shell->tree;
    double place[3][3], normal[3][3], o[3], middle[2], edge[2];
    *lift = 0;
    sum_parts(warp, shape, place, normal);
    ref_quadtree_cell(tree, tree->cell + ref_quadtree_at(tree, theta), middle, edge);
    double length = sqrt(sqrt(sm_dot(place[1], place[1]) * sm_dot(place[2], place[2])));
    if (length == 0) return; /* functions that are constant there */
    find_foot((const double(*)[3])place, (const double(*)[3])normal, x, edge,
              2 * length * fmax(edge[0], edge[1]), o);
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
    Feet feet = {cracked->shell, warp, theta, x, cracked, leant};
    RefSkinCarrier carrier = {&feet, &cracked->shell->nodes, cell_of, weigh, nearest};
    ref_skin_renew(&carrier, is_stale, skin, loose);
}

void ref_foot_skin(const RefShell *shell, const RefWarp *warp, long count, const double (*theta)[2],
                   const double (*x)[3], RefSkin *skin, long *loose)
{
    Feet feet = {.shell = shell, .warp = warp, .theta = theta, .x = x};
    RefSkinCarrier carrier = {&feet, &shell->nodes, cell_of, weigh, nearest};
    ref_skin_build(&carrier, true, count, x, skin, loose);
}
