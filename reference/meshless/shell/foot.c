#include "foot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/isa.h"
#include "../../../lib/vector.h"
#include "foot_search.h"

SM_ISA_TABLE(RefFootSearch, ref_foot_search)

/* A node's place at rest and its normal, and nothing. */
enum { FIELDS = REF_FRAME_SLOPES, PLACE = 0, NORMAL = 3 };

/* Of the plane of parameters. */
typedef struct {
    double low[2], high[2];
} Box;

/* A sample of a cracked shell that points see. */
typedef struct {
    long cell; /* terminal; -1: none */
    Box box;
    double middle[2], edge[2];
    bool whole;                /* no crack touches it */
    const RefSamples *samples; /* its own */
    int sample;                /* -1: none */
    Box near, own;             /* of all to which it is nearest; to which surely none is as near */
    bool open;                 /* no crack touches what is near the sample */
    bool bears;                /* which has functions that bear points */
} Sight;

typedef struct {
    const RefShell *shell;
    const RefWarp *warp;
    const double (*theta)[2];
    const double (*x)[3];
    const RefCracked *cracked;
    double (*field)[FIELDS]; /* [nodes] */
    Sight *sight;
    RefFootPoints *points; /* of a block, whose parameters are */
    double (*at)[2];       /* [REF_SKIN_BLOCK] */
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

/* How far o leads out of the reach, and 1 within it. */
static double beyond(const double o[3], const double reach[3])
{
    double far = REF_FOOT_WITHIN;
    for (int k = 0; k < 3; k++) far = fmax(far, fabs(o[k]) / reach[k]);
    return far / REF_FOOT_WITHIN;
}

/* Of a cell's edges along the parameters and of `height` up; and no offset leads farther than twice
 * as far as the point is from the place, which is `off`. */
static void find_reach(const double place[3][3], const double normal[3], const double off[3],
                       const double edge[2], double height, double reach[3])
{
    double most = 2 * sqrt(sm_dot(off, off)) + REF_FOOT_NEAR * height;
    for (int k = 0; k < 2; k++)
        reach[k] = fmin(edge[k], most / sqrt(sm_dot(place[1 + k], place[1 + k])));
    reach[2] = fmin(height, most / sqrt(sm_dot(normal, normal)));
}

/* Offsets that lead out of the reach become shorter, and the farther they lead, the more of the
 * offset along the normal alone they become. */
static void shorten(const double normal[3], const double off[3], const double reach[3], double o[3])
{
    double up = sm_dot(normal, normal), far = beyond(o, reach), share = 1 / far;
    double lift = up > 0 ? fmax(-reach[2], fmin(sm_dot(off, normal) / up, reach[2])) : 0;
    if (far == 1) return;
    for (int k = 0; k < 3; k++) o[k] = share * share * o[k] + (k == 2 ? (1 - share) * lift : 0);
}

/* The offsets, or where Newton's steps do not find them within reach, those in the frame at the
 * place: the first step's, shortened. */
static void find_foot(const double place[3][3], const double normal[3][3], const double x[3],
                      const double edge[2], double height, double o[3])
{
    double first[3] = {0}, off[3], left = INFINITY, near = REF_FOOT_NEAR * height, reach[3];
    sm_subtract(x, place[0], off);
    find_reach(place, normal[0], off, edge, height, reach);
    step(place, normal, x, first);
    shorten(normal[0], off, reach, first);
    memcpy(o, first, sizeof first);
    for (int n = 0; n < REF_FOOT_MOST_STEPS && left > near && beyond(o, reach) == 1; n++)
        left = step(place, normal, x, o); /* the last one squares it */
    if (!(left < 10 * near && beyond(o, reach) == 1)) memcpy(o, first, sizeof first);
}

bool ref_foot_offsets(const double place[3][3], const double normal[3][3], const double x[3],
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
    if (!ref_foot_offsets((const double(*)[3])place, (const double(*)[3])normal, x, edge, o))
        return;
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

static bool is_inside(const double theta[2], const Box *box)
{
    return theta[0] > box->low[0] && theta[0] < box->high[0] && theta[1] > box->low[1] &&
           theta[1] < box->high[1];
}

/* The cell at a place: points go on in the same one mostly. */
static void look_at_cell(const RefCracked *cracked, const double theta[2], Sight *sight)
{
    const RefQuadtree *tree = &cracked->shell->tree;
    if (sight->cell >= 0 && is_inside(theta, &sight->box)) return;
    const long cell = ref_quadtree_at(tree, theta);
    if (cell == sight->cell) return;
    sight->cell = cell;
    sight->sample = -1;
    sight->samples = &cracked->cell[cell].samples;
    ref_quadtree_cell(tree, tree->cell + cell, sight->middle, sight->edge);
    for (int d = 0; d < 2; d++) {
        sight->box.low[d] = sight->middle[d] - sight->edge[d] / 2;
        sight->box.high[d] = sight->middle[d] + sight->edge[d] / 2;
    }
    sight->whole = !ref_cracks_look(&cracked->cracks, sight->box.low, sight->box.high);
}

/* Shares of an edge: from a sample, beyond the first along an axis another one is nearer, and
 * within the second along both, in the same quarter of the cell, none is. */
static const double NEAR = 0.1, NEAREST = 0.096;

/* The sample that is nearest to a place. */
static void look_at(const RefCracked *cracked, const double theta[2], Sight *sight)
{
    look_at_cell(cracked, theta, sight);
    const int s = ref_samples_nearest(sight->middle, sight->edge, theta);
    if (s == sight->sample) return;
    sight->sample = s;
    for (int d = 0; d < 2; d++) {
        const double from = sight->samples->theta[s][d], middle = sight->middle[d];
        const double low = from - NEAREST * sight->edge[d], high = from + NEAREST * sight->edge[d];
        const double begin = from > middle ? middle : sight->box.low[d];
        const double end = from > middle ? sight->box.high[d] : middle;
        sight->near.low[d] = from - NEAR * sight->edge[d];
        sight->near.high[d] = from + NEAR * sight->edge[d];
        sight->own.low[d] = low > begin ? low : begin;
        sight->own.high[d] = high < end ? high : end;
    }
    sight->bears = ref_cracked_bears(cracked, sight->cell, s);
    sight->open =
        sight->whole || !ref_cracks_look(&cracked->cracks, sight->near.low, sight->near.high);
}

/* The sample whose functions move point p of the block, as ref_cracked_sample() has it. */
static int sample_of(const Feet *feet, int p)
{
    const RefCracks *cracks = &feet->cracked->cracks;
    const double *theta = feet->at[p];
    Sight *sight = feet->sight;
    if (!is_inside(theta, &sight->own)) look_at(feet->cracked, theta, sight);
    if (sight->bears && is_inside(theta, &sight->near) &&
        (sight->open || !ref_cracks_part(cracks, theta, sight->samples->theta[sight->sample])))
        return sight->sample;
    return ref_cracked_sample(feet->cracked, sight->cell, theta);
}

static void note_point(const Feet *feet, int p, int sample)
{
    const Sight *sight = feet->sight;
    for (int d = 0; d < 2; d++) {
        feet->points->from[d][p] = feet->at[p][d] - sight->samples->theta[sample][d];
        feet->points->edge[d][p] = sight->edge[d];
    }
}

/* The points of a block from `first` on that see the same sample; returns where others begin. */
static int take_share(const Feet *feet, int first, int count, RefSkinShares *shares)
{
    const Sight *sight = feet->sight;
    const int s = sample_of(feet, first);
    int end = first + 1;
    if (s < 0) return end;
    note_point(feet, first, s);
    while (end < count && is_inside(feet->at[end], &sight->box) && sample_of(feet, end) == s)
        note_point(feet, end++, s);
    const RefSamples *samples = sight->samples;
    const long start = samples->start[s];
    RefSkinShare share = {.first = first,
                          .points = end - first,
                          .nodes = (int)(samples->start[s + 1] - start),
                          .node = samples->node + start,
                          .part = (const double(*)[6])(samples->part + start)};
    for (int n = 0; n < share.nodes; n++) __builtin_prefetch(share.part + n);
    shares->share[shares->count++] = share;
    return end;
}

/* Whether there are functions, of which ref_samples_expand() takes none back: Taylor's series are
 * of 1, x, y, x^2 / 2, y^2 / 2 and x y. */
static bool is_tame(const RefSkinShare *share, const RefFootPoints *points)
{
    double far[2] = {0}, largest = 0;
    for (int d = 0; d < 2; d++)
        for (int p = share->first; p < share->first + share->points; p++)
            far[d] = fmax(far[d], fabs(points->from[d][p]));
    const double x = far[0], y = far[1], most[6] = {1, x, y, x * x / 2, y * y / 2, x * y};
    for (int n = 0; n < share->nodes; n++) {
        double value[2] = {0}; /* as a vector may be */
        for (int m = 0; m < 6; m++) value[m % 2] += fabs(share->part[n][m]) * most[m];
        largest = value[0] + value[1] > largest ? value[0] + value[1] : largest;
    }
    return largest > 0 && largest < REF_SAMPLES_MOST_VALUE;
}

/* What weigh() finds, of points of a shell that cracks which the same sample moves: from sums over
 * its functions. */
static void share(const void *data, int count, const long *point, const double (*x)[3],
                  RefSkinShares *shares)
{
    const Feet *feet = data;
    RefFootPoints *points = feet->points;
    int tame = 0;
    for (int p = 0; p < count; p++) __builtin_prefetch(feet->theta[point[p]]);
    for (int p = 0; p < count; p++)
        for (int d = 0; d < 3; d++) points->x[d][p] = x[p][d];
    for (int p = 0; p < count; p++) memcpy(feet->at[p], feet->theta[point[p]], sizeof feet->at[p]);
    shares->count = 0;
    for (int p = 0; p < count;) p = take_share(feet, p, count, shares);
    for (int s = 0; s < shares->count; s++) {
        const RefSkinShare share = shares->share[s];
        double sum[6][FIELDS];
        if (!is_tame(&share, points)) continue;
        ref_frame_sums.parts(share.nodes, share.node, share.part,
                             (const double(*)[FIELDS])feet->field, sum);
        ref_foot_search.expand((const double(*)[FIELDS])sum, share.first, share.points, points);
        shares->share[tame++] = share;
    }
    shares->count = tame;
    ref_foot_search.find(count, points);
    ref_foot_search.series(count, points, shares->times);
    memcpy(shares->lift, points->offset[2], sizeof shares->lift);
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

void ref_foot_renew(const RefCracked *cracked, const RefWarp *warp, const double (*theta)[2],
                    const double (*x)[3], RefSkin *skin, long *loose)
{
    Sight sight = {.cell = -1};
    double at[REF_SKIN_BLOCK][2], (*field)[FIELDS] = sm_alloc((size_t)warp->nodes, sizeof *field);
    RefFootPoints *points = sm_alloc(1, sizeof *points);
    Feet feet = {cracked->shell, warp, theta, x, cracked, field, &sight, points, at};
    for (long n = 0; n < warp->nodes; n++) {
        memcpy(field[n] + PLACE, warp->X[n], sizeof warp->X[n]);
        memcpy(field[n] + NORMAL, warp->rest_normal[n], sizeof warp->rest_normal[n]);
    }
    RefSkinCarrier carrier = {&feet, &cracked->shell->nodes, cell_of, weigh, nearest, place_of,
                              share};
    ref_skin_renew(&carrier, skin, loose);
    sm_free_all(field, points);
}

void ref_foot_skin(const RefShell *shell, const RefWarp *warp, long count, const double (*theta)[2],
                   const double (*x)[3], RefSkin *skin, long *loose)
{
    Feet feet = {.shell = shell, .warp = warp, .theta = theta, .x = x};
    RefSkinCarrier carrier = {&feet, &shell->nodes, cell_of, weigh, nearest, place_of, NULL};
    ref_skin_build(&carrier, true, count, x, skin, loose);
}
