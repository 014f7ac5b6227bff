#include "walls.h"

#include <math.h>
#include <string.h>

#include "clip.h"

typedef struct {
    const RefField *field;
    const RefOctantOptions *options;
    int order[2];                  /* Gauss points a direction: inside, in the surface */
    double at[2][4], weight[2][4]; /* on -1/2..1/2, weights of sum 1 */
    int axis, out;                 /* the face's normal is `out`, 1 or -1, along the axis */
    bool surface;                  /* whether the present part lies in the body's surface */
    RefOctants *tree;
} Face;

void ref_walls_append(RefOctants *tree, const RefWall *wall)
{
    if (tree->walls == tree->wall_room) {
        tree->wall_room = 2 * tree->wall_room + 64;
        tree->wall = sm_realloc(tree->wall, (size_t)tree->wall_room, sizeof *tree->wall);
    }
    tree->wall[tree->walls++] = *wall;
}

/* `across` and `along` are measured from the centre along the face's two axes. */
static void append(const Face *face, const double centre[3], double across, double along,
                   double size)
{
    RefWall wall = {.x = {centre[0], centre[1], centre[2]}, .surface = face->surface};
    wall.x[(face->axis + 1) % 3] += across;
    wall.x[(face->axis + 2) % 3] += along;
    wall.area[face->axis] = face->out * size;
    ref_walls_append(face->tree, &wall);
}

static void gauss(const Face *face, const double centre[3], double edge)
{
    int order = face->order[face->surface];
    const double *at = face->at[face->surface], *weight = face->weight[face->surface];
    for (int n = 0; n < order * order; n++)
        append(face, centre, edge * at[n % order], edge * at[n / order],
               edge * edge * weight[n % order] * weight[n / order]);
}

/* What of a square lies on the inner side of a line, and the line's ends; from the square's centre.
 */
typedef struct {
    double area, middle[2];
    int ends;
    double end[2][2];
} Share;

/* Where value + slope . (x - centre) < 0: strips along the axis that the slope is closest to, each
 * cut exactly. */
static Share below_line(double edge, double value, const double slope[2])
{
    enum { STRIPS = 4 };
    Share share = {0};
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

static void part(Face *face, const double centre[3], double edge, int depth);

static void split_part(Face *face, const double centre[3], double edge, int depth)
{
    for (int which = 0; which < 4; which++) {
        double x[3] = {centre[0], centre[1], centre[2]};
        x[(face->axis + 1) % 3] += ((which & 1) - 0.5) * 0.5 * edge;
        x[(face->axis + 2) % 3] += ((which >> 1) - 0.5) * 0.5 * edge;
        part(face, x, edge / 2, depth + 1);
    }
}

static void cut_part(Face *face, const double centre[3], double edge, int depth, double value,
                     const double gradient[3])
{
    double slope[2] = {gradient[(face->axis + 1) % 3], gradient[(face->axis + 2) % 3]};
    Share share = below_line(edge, value, slope);
    double end[2][3];
    for (int n = 0; n < share.ends; n++) {
        memcpy(end[n], centre, sizeof end[n]);
        end[n][(face->axis + 1) % 3] += share.end[n][0];
        end[n][(face->axis + 2) % 3] += share.end[n][1];
    }
    int clip = face->options->clip;
    if (depth < clip ||
        (depth < clip + REF_CLIP_SHARP &&
         ref_clip_sharp(face->field, share.ends, (const double(*)[3])end, gradient)))
        split_part(face, centre, edge, depth);
    else if (share.area > 1e-9 * edge * edge)
        append(face, centre, share.middle[0], share.middle[1], share.area);
}

/* A square `depth` levels below the Gauss parts, as clip.c cuts a cube. One that lies in the
 * surface is inside. */
static void part(Face *face, const double centre[3], double edge, int depth)
{
    double gradient[3], value = ref_field_at(face->field, centre, gradient);
    double corner =
        0.5 * edge * (fabs(gradient[(face->axis + 1) % 3]) + fabs(gradient[(face->axis + 2) % 3]));
    bool cut = fabs(value) < corner * (1 - 1e-9);
    if (!cut && value > 1e-9 * edge) return;
    face->surface = !cut && value > -1e-9 * edge;
    if (cut)
        cut_part(face, centre, edge, depth, value, gradient);
    else if (depth == 0)
        gauss(face, centre, edge);
    else
        append(face, centre, 0, 0, edge * edge);
}

/* A face that is whole an octant's: its parts, or all Gauss points where the surface is far. */
static void whole(Face *face, const double centre[3], double edge)
{
    int parts = 1 << face->options->split, side = ref_clip_side(face->field, centre, edge);
    for (int n = 0; side <= 0 && n < parts * parts; n++) {
        double x[3] = {centre[0], centre[1], centre[2]};
        x[(face->axis + 1) % 3] += ((n % parts + 0.5) / parts - 0.5) * edge;
        x[(face->axis + 2) % 3] += ((n / parts + 0.5) / parts - 0.5) * edge;
        face->surface = false;
        if (side < 0)
            gauss(face, x, edge / parts);
        else
            part(face, x, edge / parts, 0);
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
        whole(face, centre, size * tree->cell / pieces);
    }
}

void ref_walls_of_faces(const RefField *field, const RefOctantOptions *options, long o,
                        RefOctants *tree)
{
    Face face = {.field = field, .options = options, .tree = tree};
    for (int n = 0; n < 2; n++) {
        face.order[n] = options->gauss + 1 + n < 4 ? options->gauss + 1 + n : 4;
        ref_clip_gauss(face.order[n], face.at[n], face.weight[n]);
    }
    for (int side = 0; side < 6; side++) {
        face.axis = side / 2;
        face.out = side % 2 ? 1 : -1;
        split_face(&face, tree->octant + o);
    }
}
