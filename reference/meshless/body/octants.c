#include "octants.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"
#include "gauss_rule.h"

void ref_octants_free(RefOctants *tree)
{
    sm_free_all(tree->octant, tree->point, tree->wall);
    *tree = (RefOctants){0};
}

void ref_octants_centre(const RefOctants *tree, const RefOctant *octant, double centre[3])
{
    for (int d = 0; d < 3; d++)
        centre[d] = tree->origin[d] + tree->cell * (octant->corner[d] + 0.5 * octant->size);
}

int ref_octants_at(const RefOctants *tree, const int place[3])
{
    int at = 0, size = tree->octant[0].size;
    for (int d = 0; d < 3; d++)
        if (place[d] < 0 || place[d] >= size) return -1;
    while (tree->octant[at].child >= 0) {
        int half = tree->octant[at].size / 2, which = 0;
        for (int d = 0; d < 3; d++)
            if (place[d] >= tree->octant[at].corner[d] + half) which |= 1 << d;
        at = tree->octant[at].child + which;
    }
    return at;
}

double ref_octants_volume(const RefOctants *tree)
{
    double volume = 0;
    for (long p = 0; p < tree->points; p++) volume += tree->point[p].weight;
    return volume;
}

/* ---- integration points in what of an octant lies inside a body (meshless section 4.1.2) */

enum { SHARP = 3 }; /* how often a smallest part is split for an edge of the body */

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

/* -1: a cube is surely inside, 1: surely outside, 0: it may be cut. */
static int side_of(const RefField *field, const double centre[3], double edge)
{
    double gradient[3], value = ref_field_at(field, centre, gradient);
    if (fabs(value) < reach(edge, gradient)) return 0;
    return value < 0 ? -1 : 1;
}

static void append_point(Clip *clip, const double x[3], double weight)
{
    RefOctants *tree = clip->tree;
    sm_make_room(tree->point, tree->point_room, tree->points + 1);
    tree->point[tree->points++] = (RefPoint){{x[0], x[1], x[2]}, weight};
    clip->volume += weight;
}

static void gauss_cube(Clip *clip, const double centre[3], double edge)
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
        append_point(clip, x, weight);
    }
}

static void append_wall(RefOctants *tree, const RefWall *wall)
{
    sm_make_room(tree->wall, tree->wall_room, tree->walls + 1);
    tree->wall[tree->walls++] = *wall;
}

/* What of a cube lies on the inner side of a plane: its volume and the plane's part in it. */
typedef struct {
    double volume, middle[3];
    RefWall wall;
    int ends; /* the plane's points in the outermost columns that it cuts */
    double end[4][3];
} CubeShare;

/* Where value + gradient . (x - centre) < 0: columns along the axis that the gradient is closest
 * to, each cut exactly. */
static CubeShare below_plane(const double centre[3], double edge, double value,
                             const double gradient[3])
{
    enum { SIDE = 4 };
    CubeShare share = {.wall.surface = true};
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

static void clip_cube(Clip *clip, const double centre[3], double edge, int depth);

static void split_cube(Clip *clip, const double centre[3], double edge, int depth)
{
    for (int which = 0; which < 8; which++) {
        double x[3];
        for (int d = 0; d < 3; d++) x[d] = centre[d] + ((which >> d & 1) - 0.5) * 0.5 * edge;
        clip_cube(clip, x, edge / 2, depth + 1);
    }
}

/* Whether a smallest part is to be split all the same, up to SHARP times: the surface runs
 * otherwise at the points x, which are the outermost on the part's tangent plane, so that an edge
 * of the body is near. */
static bool is_sharp(const RefField *field, int count, const double (*x)[3],
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
static void clip_cube(Clip *clip, const double centre[3], double edge, int depth)
{
    double gradient[3], value = ref_field_at(clip->field, centre, gradient);
    double corner = 0.5 * edge * (fabs(gradient[0]) + fabs(gradient[1]) + fabs(gradient[2]));
    bool cut = fabs(value) < corner * (1 - 1e-9);
    if (!cut && value >= 0) return;
    if (!cut && depth == 0) {
        gauss_cube(clip, centre, edge);
    } else if (!cut) {
        append_point(clip, centre, edge * edge * edge);
    } else if (depth < clip->options->clip) {
        split_cube(clip, centre, edge, depth);
    } else {
        CubeShare share = below_plane(centre, edge, value, gradient);
        if (!clip->options->rough && depth < clip->options->clip + SHARP &&
            is_sharp(clip->field, share.ends, (const double(*)[3])share.end, gradient)) {
            split_cube(clip, centre, edge, depth);
            return;
        }
        if (share.volume > 1e-9 * edge * edge * edge)
            append_point(clip, share.middle, share.volume);
        if (!clip->options->rough) append_wall(clip->tree, &share.wall);
    }
}

/* Appends an octant's points to the tree's, and the walls of the surface in it, and returns their
 * volume. The octant is split `options->split` times into parts of gauss^3 points each; a part that
 * is cut is split up to `options->clip` times more and then has one point a piece: its middle, or,
 * of one that is cut, the middle of what lies below the field's tangent plane, whose part in it is
 * a wall. */
static double clip_octant(const RefField *field, const RefOctantOptions *options,
                          const double centre[3], double edge, RefOctants *tree)
{
    Clip clip = {.field = field, .options = options, .tree = tree};
    ref_gauss_rule(options->gauss, clip.at, clip.weight);
    int parts = 1 << options->split;
    for (int n = 0; n < parts * parts * parts; n++) {
        double x[3] = {n % parts, n / parts % parts, n / (parts * parts)};
        for (int d = 0; d < 3; d++) x[d] = centre[d] + ((x[d] + 0.5) / parts - 0.5) * edge;
        clip_cube(&clip, x, edge / parts, 0);
    }
    return clip.volume;
}

/* ---- what bounds an octant's share of a body: points on its faces and on the surface in it.
 *
 * By the divergence theorem they give the mean gradient of a function over the share from its
 * values alone. Two octants that touch have the same points on the face between them, so that sums
 * of such means over the body leave nothing but its surface: integration by parts holds in the sums
 * as it does in integrals (matrices.h). */

typedef struct {
    const RefField *field;
    const RefOctantOptions *options;
    int order[2];                  /* Gauss points a direction: inside, in the surface */
    double at[2][4], weight[2][4]; /* on -1/2..1/2, weights of sum 1 */
    int axis, out;                 /* the face's normal is `out`, 1 or -1, along the axis */
    bool surface;                  /* whether the present part lies in the body's surface */
    RefOctants *tree;
} Face;

/* `across` and `along` are measured from the centre along the face's two axes. */
static void append_face(const Face *face, const double centre[3], double across, double along,
                        double size)
{
    RefWall wall = {.x = {centre[0], centre[1], centre[2]}, .surface = face->surface};
    wall.x[(face->axis + 1) % 3] += across;
    wall.x[(face->axis + 2) % 3] += along;
    wall.area[face->axis] = face->out * size;
    append_wall(face->tree, &wall);
}

static void gauss_square(const Face *face, const double centre[3], double edge)
{
    int order = face->order[face->surface];
    const double *at = face->at[face->surface], *weight = face->weight[face->surface];
    for (int n = 0; n < order * order; n++)
        append_face(face, centre, edge * at[n % order], edge * at[n / order],
                    edge * edge * weight[n % order] * weight[n / order]);
}

/* What of a square lies on the inner side of a line, and the line's ends; from the square's centre.
 */
typedef struct {
    double area, middle[2];
    int ends;
    double end[2][2];
} SquareShare;

/* Where value + slope . (x - centre) < 0: strips along the axis that the slope is closest to, each
 * cut exactly. */
static SquareShare below_line(double edge, double value, const double slope[2])
{
    enum { STRIPS = 4 };
    SquareShare share = {0};
    int up = fabs(slope[1]) > fabs(slope[0]);
    double sum = 0;
    for (int n = 0; n < STRIPS; n++) {
        double from = ((n + 0.5) / STRIPS - 0.5) * edge, low = -0.5 * edge, high = 0.5 * edge;
        double level = -(value + slope[!up] * from) / slope[up];
        if (level > low && level < high && (n == 0 || n == STRIPS - 1)) {
            share.end[share.ends][up] = level;
            share.end[share.ends++][!up] = from;
        }
        *(slope[up] > 0 ? &high : &low) = fmin(fmax(level, low), high);
        sum += high - low;
        share.middle[up] += (high - low) * (low + high) / 2;
        share.middle[!up] += (high - low) * from;
    }
    for (int d = 0; d < 2 && sum > 0; d++) share.middle[d] /= sum;
    share.area = sum / STRIPS * edge;
    return share;
}

static void clip_square(Face *face, const double centre[3], double edge, int depth);

static void split_square(Face *face, const double centre[3], double edge, int depth)
{
    for (int which = 0; which < 4; which++) {
        double x[3] = {centre[0], centre[1], centre[2]};
        x[(face->axis + 1) % 3] += ((which & 1) - 0.5) * 0.5 * edge;
        x[(face->axis + 2) % 3] += ((which >> 1) - 0.5) * 0.5 * edge;
        clip_square(face, x, edge / 2, depth + 1);
    }
}

static void cut_square(Face *face, const double centre[3], double edge, int depth, double value,
                       const double gradient[3])
{
    double slope[2] = {gradient[(face->axis + 1) % 3], gradient[(face->axis + 2) % 3]};
    SquareShare share = below_line(edge, value, slope);
    double end[2][3];
    for (int n = 0; n < share.ends; n++) {
        memcpy(end[n], centre, sizeof end[n]);
        end[n][(face->axis + 1) % 3] += share.end[n][0];
        end[n][(face->axis + 2) % 3] += share.end[n][1];
    }
    int clip = face->options->clip;
    if (depth < clip || (depth < clip + SHARP &&
                         is_sharp(face->field, share.ends, (const double(*)[3])end, gradient)))
        split_square(face, centre, edge, depth);
    else if (share.area > 1e-9 * edge * edge)
        append_face(face, centre, share.middle[0], share.middle[1], share.area);
}

/* A square `depth` levels below the Gauss parts, as clip_cube() cuts a cube. One that lies in the
 * surface is inside. */
static void clip_square(Face *face, const double centre[3], double edge, int depth)
{
    double gradient[3], value = ref_field_at(face->field, centre, gradient);
    double corner =
        0.5 * edge * (fabs(gradient[(face->axis + 1) % 3]) + fabs(gradient[(face->axis + 2) % 3]));
    bool cut = fabs(value) < corner * (1 - 1e-9);
    if (!cut && value > 1e-9 * edge) return;
    face->surface = !cut && value > -1e-9 * edge;
    if (cut)
        cut_square(face, centre, edge, depth, value, gradient);
    else if (depth == 0)
        gauss_square(face, centre, edge);
    else
        append_face(face, centre, 0, 0, edge * edge);
}

/* A face that is whole an octant's: its parts, or all Gauss points where the surface is far. */
static void whole_face(Face *face, const double centre[3], double edge)
{
    int parts = 1 << face->options->split, side = side_of(face->field, centre, edge);
    for (int n = 0; side <= 0 && n < parts * parts; n++) {
        double x[3] = {centre[0], centre[1], centre[2]};
        x[(face->axis + 1) % 3] += ((n % parts + 0.5) / parts - 0.5) * edge;
        x[(face->axis + 2) % 3] += ((n / parts + 0.5) / parts - 0.5) * edge;
        face->surface = false;
        if (side < 0)
            gauss_square(face, x, edge / parts);
        else
            clip_square(face, x, edge / parts, 0);
    }
}

/* One face of an octant: whole, or in quarters where it touches smaller octants. */
static void split_face(Face *face, const RefOctant *octant)
{
    const RefOctants *tree = face->tree;
    int a = (face->axis + 1) % 3, b = (face->axis + 2) % 3, place[3], size = octant->size;
    for (int d = 0; d < 3; d++) place[d] = octant->corner[d];
    place[face->axis] += face->out > 0 ? size : -1;
    int other = ref_octants_at(tree, place);
    int pieces = other >= 0 && tree->octant[other].size < size ? 2 : 1;
    for (int n = 0; n < pieces * pieces; n++) {
        double centre[3];
        ref_octants_centre(tree, octant, centre);
        centre[face->axis] += face->out * 0.5 * size * tree->cell;
        centre[a] += ((n % pieces + 0.5) / pieces - 0.5) * size * tree->cell;
        centre[b] += ((n / pieces + 0.5) / pieces - 0.5) * size * tree->cell;
        whole_face(face, centre, size * tree->cell / pieces);
    }
}

/* Appends the six faces of terminal octant `o` to the tree's walls, as far as they are inside:
 * Gauss points on the faces of the parts of above, one a direction more than these have, and two
 * more in the body's surface, four at most; those of the finer octant where it touches smaller
 * ones; what the field's tangent plane cuts is split and then cut along a line. */
static void wall_faces(const RefField *field, const RefOctantOptions *options, long o,
                       RefOctants *tree)
{
    Face face = {.field = field, .options = options, .tree = tree};
    for (int n = 0; n < 2; n++) {
        face.order[n] = options->gauss + 1 + n < 4 ? options->gauss + 1 + n : 4;
        ref_gauss_rule(face.order[n], face.at[n], face.weight[n]);
    }
    for (int side = 0; side < 6; side++) {
        face.axis = side / 2;
        face.out = side % 2 ? 1 : -1;
        split_face(&face, tree->octant + o);
    }
}

/* ---- the tree */

static void split(RefOctants *tree, long at)
{
    sm_make_room(tree->octant, tree->room, tree->count + 8);
    RefOctant *parent = tree->octant + at;
    parent->child = (int)tree->count;
    int half = parent->size / 2;
    for (int which = 0; which < 8; which++) {
        RefOctant *child = tree->octant + tree->count++;
        *child = (RefOctant){.size = half, .child = -1};
        for (int d = 0; d < 3; d++) child->corner[d] = parent->corner[d] + (which >> d & 1) * half;
    }
}

/* Whether the octant lies outside the field's box. */
static bool outside_box(const RefField *field, const RefOctants *tree, const RefOctant *octant)
{
    for (int d = 0; d < 3; d++) {
        double low = tree->origin[d] + tree->cell * octant->corner[d];
        double high = low + tree->cell * octant->size, slack = 1e-9 * tree->cell;
        if (high <= field->low[d] + slack || low >= field->high[d] - slack) return true;
    }
    return false;
}

/* The root, and splits until octants that may be cut are finest ones and the others small enough.
 */
static bool refine(const RefField *field, const RefOctantOptions *options, RefOctants *tree)
{
    for (long at = 0; at < tree->count; at++) {
        RefOctant octant = tree->octant[at];
        double centre[3];
        if (octant.size == 1 || outside_box(field, tree, &octant)) continue;
        ref_octants_centre(tree, &octant, centre);
        double edge = tree->cell * octant.size;
        bool cut = side_of(field, centre, edge) == 0;
        bool inside = ref_field_at(field, centre, NULL) < 0;
        if (!cut && (!inside || octant.size <= 1 << options->coarser)) continue;
        if (tree->count + 8 > REF_MOST_OCTANTS) return false;
        split(tree, at);
    }
    return true;
}

/* Splits the octant across the face or edge `step` of one that is two levels finer. */
static bool relieve(RefOctants *tree, const RefOctant *fine, const int step[3])
{
    int place[3];
    for (int d = 0; d < 3; d++)
        place[d] = fine->corner[d] + (step[d] > 0 ? fine->size : step[d] < 0 ? -1 : 0);
    int size = fine->size, at = ref_octants_at(tree, place);
    if (at < 0 || tree->octant[at].size <= 2 * size) return false;
    split(tree, at);
    return true;
}

/* One-level adjustment across faces and edges; splitting may call for more splitting. */
static void balance(RefOctants *tree)
{
    bool changed = true;
    while (changed) {
        changed = false;
        for (long at = 0; at < tree->count; at++)
            for (int n = 0; n < 27 && tree->octant[at].child < 0; n++) {
                int step[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
                int axes = abs(step[0]) + abs(step[1]) + abs(step[2]);
                RefOctant fine = tree->octant[at];
                if (axes == 1 || axes == 2) changed |= relieve(tree, &fine, step);
            }
    }
}

static void classify(const RefField *field, const RefOctantOptions *options, RefOctants *tree)
{
    for (long at = 0; at < tree->count; at++) {
        RefOctant *octant = tree->octant + at;
        double centre[3], edge = tree->cell * octant->size;
        octant->first = tree->points;
        octant->first_wall = tree->walls;
        octant->kind = REF_EXTERIOR;
        if (octant->child >= 0 || outside_box(field, tree, octant)) continue;
        ref_octants_centre(tree, octant, centre);
        double volume = clip_octant(field, options, centre, edge, tree);
        octant->share = volume / (edge * edge * edge);
        if (!options->rough && tree->points > octant->first) wall_faces(field, options, at, tree);
        if (octant->share > 1 - 1e-9)
            octant->kind = REF_INTERIOR;
        else if (octant->share > 0)
            octant->kind =
                ref_field_at(field, centre, NULL) < 0 ? REF_BOUNDARY_IN : REF_BOUNDARY_OUT;
    }
}

SmCode ref_octants_build(const RefField *field, const RefOctantOptions *options, RefOctants *tree,
                         SmError *error)
{
    int most = 1;
    *tree = (RefOctants){.cell = options->cell, .count = 1, .room = 1};
    for (int d = 0; d < 3; d++) {
        double cells = (field->high[d] - field->low[d]) / options->cell;
        if (!(cells < 1 << 20))
            return sm_fail(error, SM_INPUT,
                           "a body %g long in octants of %g is too fine to simulate: give it fewer "
                           "nodes",
                           field->high[d] - field->low[d], options->cell);
        int whole = (int)ceil(cells - 1e-6);
        tree->origin[d] = (field->low[d] + field->high[d] - whole * options->cell) / 2;
        while (most < whole) most *= 2;
    }
    tree->octant = sm_alloc(1, sizeof *tree->octant);
    tree->octant[0] = (RefOctant){.size = most, .child = -1};
    if (!refine(field, options, tree)) {
        ref_octants_free(tree);
        return sm_fail(error, SM_INPUT, "the body needs more than %d octants: give it fewer nodes",
                       REF_MOST_OCTANTS);
    }
    balance(tree);
    classify(field, options, tree);
    if (tree->points > 0) return SM_OK;
    ref_octants_free(tree);
    return sm_fail(error, SM_INPUT,
                   "nothing is inside the body's surface: its normals must point outwards");
}
