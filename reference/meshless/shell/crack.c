#include "crack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/csr.h"
#include "../body/mls.h"

/* Where b is this share of a node's reach, half a cell of covers four cells wide. */
static const double TIP_REACH = 0.25;
/* Pieces that meet others end this share of their length beyond them. */
static const double OVERSHOOT = 1e-6;
/* This share of the rectangle's sides is looked at beyond what is asked for. */
static const double LOOK_BEYOND = 1.0 / 64;

static double cross(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

static void way_from(const double a[2], const double b[2], double way[2])
{
    for (int d = 0; d < 2; d++) way[d] = b[d] - a[d];
}

static double length_of(const double a[2])
{
    return sqrt(a[0] * a[0] + a[1] * a[1]);
}

void ref_cracks_create(const RefChart *chart, double margin, RefCracks *cracks)
{
    *cracks = (RefCracks){.chart = chart, .margin = margin, .low = {INFINITY}};
}

void ref_cracks_free(RefCracks *cracks)
{
    ref_chart_images_free(&cracks->images);
    sm_free_all(cracks->near.piece, cracks->near.box, cracks->piece, cracks->arm);
    *cracks = (RefCracks){.chart = NULL};
}

RefCracks ref_cracks_copy(const RefCracks *cracks)
{
    size_t pieces = (size_t)cracks->pieces, arms = (size_t)cracks->arms;
    RefCracks copy;
    ref_cracks_create(cracks->chart, cracks->margin, &copy);
    copy.pieces = copy.piece_room = cracks->pieces;
    copy.arms = copy.arm_room = cracks->arms;
    copy.piece = sm_copy(cracks->piece, pieces, sizeof *copy.piece);
    copy.arm = sm_copy(cracks->arm, arms, sizeof *copy.arm);
    return copy;
}

int ref_cracks_start(RefCracks *cracks, const double at[2], int parent)
{
    sm_make_room(cracks->arm, cracks->arm_room, cracks->arms + 1);
    cracks->arm[cracks->arms] =
        (RefCrackArm){.tip = {at[0], at[1]}, .last = -1, .parent = parent, .open = true};
    return (int)cracks->arms++;
}

static void box_of(const RefCrackPiece *piece, double low[2], double high[2])
{
    const double *a = piece->at.end[0], *b = piece->at.end[1];
    for (int d = 0; d < 2; d++) {
        low[d] = a[d] < b[d] ? a[d] : b[d];
        high[d] = a[d] < b[d] ? b[d] : a[d];
    }
}

static void add_piece(RefCracks *cracks, int arm, const RefChartImage *at)
{
    RefCrackArm *of = cracks->arm + arm;
    RefCrackPiece piece = {.at = *at, .arm = arm, .previous = of->last};
    of->last = (int)cracks->pieces;
    cracks->low[0] = INFINITY; /* nothing is in the box that was looked at */
    sm_make_room(cracks->piece, cracks->piece_room, cracks->pieces + 1);
    cracks->piece[cracks->pieces++] = piece;
}

/* A piece and its images. */
static void add_pieces(RefCracks *cracks, int arm, const double end[2][2])
{
    ref_chart_images(cracks->chart, end, cracks->margin, &cracks->images);
    for (long n = 0; n < cracks->images.count; n++)
        add_piece(cracks, arm, cracks->images.image + n);
}

static bool meet(const double box[2][2], const double low[2], const double high[2])
{
    return (box[0][0] <= high[0]) & (box[1][0] >= low[0]) & (box[0][1] <= high[1]) &
           (box[1][1] >= low[1]);
}

/* Appends a piece if its box touches another. */
static void note(const RefCracks *cracks, int p, const double low[2], const double high[2],
                 RefCracksNear *near)
{
    if (near->count == near->room) {
        near->room = sm_room_for(near->count);
        near->piece = sm_realloc(near->piece, (size_t)near->room, sizeof *near->piece);
        near->box = sm_realloc(near->box, (size_t)near->room, sizeof *near->box);
    }
    double(*own)[2] = near->box[near->count];
    box_of(cracks->piece + p, own[0], own[1]);
    if (meet((const double(*)[2])own, low, high)) near->piece[near->count++] = p;
}

bool ref_cracks_look(const RefCracks *cracks, const double low[2], const double high[2])
{
    RefCracks *look = (RefCracks *)cracks;
    memcpy(look->low, low, sizeof look->low);
    memcpy(look->high, high, sizeof look->high);
    look->near.count = 0;
    for (long p = 0; p < cracks->pieces; p++) note(cracks, (int)p, low, high, &look->near);
    return look->near.count > 0;
}

/* The pieces whose boxes touch that of two places, and others near it, rising: of the box that was
 * looked at last, or one about them that is three times as wide. */
static const RefCracksNear *near_to(const RefCracks *cracks, const double a[2], const double b[2])
{
    bool inside = true;
    double low[2], high[2];
    for (int d = 0; d < 2; d++) {
        low[d] = a[d] < b[d] ? a[d] : b[d];
        high[d] = a[d] < b[d] ? b[d] : a[d];
        inside = inside && low[d] >= cracks->low[d] && high[d] <= cracks->high[d];
    }
    for (int d = 0; !inside && d < 2; d++) {
        double side = cracks->chart->high[d] - cracks->chart->low[d];
        double wide = high[d] - low[d] + LOOK_BEYOND * side;
        low[d] -= wide;
        high[d] += wide;
    }
    if (!inside) ref_cracks_look(cracks, low, high);
    return &cracks->near;
}

/* Moves the tip on: what is ahead of the arm's pieces grows by `more`. */
static void lengthen(RefCracks *cracks, int arm, double more)
{
    for (int p = cracks->arm[arm].last; p >= 0; p = cracks->piece[p].previous)
        cracks->piece[p].ahead += more;
}

void ref_cracks_end(RefCracks *cracks, int arm)
{
    if (!cracks->arm[arm].open) return;
    lengthen(cracks, arm, INFINITY);
    cracks->arm[arm].open = false;
}

/* The share of the way a..b at which it meets a piece, if it does beyond its beginning. */
static bool meets(const RefCrackPiece *piece, const double a[2], const double b[2], double *share)
{
    double way[2], along[2], to[2];
    way_from(a, b, way);
    way_from(piece->at.end[0], piece->at.end[1], along);
    way_from(a, piece->at.end[0], to);
    double turn = cross(way, along);
    if (turn == 0) return false;
    double t = cross(to, way) / turn;
    *share = cross(to, along) / turn;
    return t >= -OVERSHOOT && t <= 1 + OVERSHOOT && *share > 1e-9 && *share <= 1;
}

/* Whether the way from x to a piece at that share of it leads there. */
static bool leads(const RefCracks *cracks, const RefCrackPiece *piece, const double x[2],
                  const double to[2], double share)
{
    double place[2];
    for (int d = 0; d < 2; d++) place[d] = x[d] + share * (to[d] - x[d]);
    return ref_chart_leads(cracks->chart, &piece->at, x, place);
}

/* Whether a piece begins or ends at a place, but for a trace. */
static bool begins_at(const RefCrackPiece *piece, const double at[2], double trace)
{
    for (int e = 0; e < 2; e++) {
        double way[2];
        way_from(piece->at.end[e], at, way);
        if (length_of(way) <= trace) return true;
    }
    return false;
}

/* Whether the way from a tip meets another crack, and the first such share of it. */
static bool first_meeting(const RefCracks *cracks, const double tip[2], const double to[2],
                          double *share)
{
    int plane = ref_chart_plane(cracks->chart, tip);
    double way[2];
    bool any = false;
    const RefCracksNear *near = near_to(cracks, tip, to);
    way_from(tip, to, way);
    double trace = OVERSHOOT * length_of(way);
    for (long n = 0; n < near->count; n++) {
        const RefCrackPiece *piece = cracks->piece + near->piece[n];
        double there;
        if (piece->at.plane != plane || begins_at(piece, tip, trace) ||
            !meets(piece, tip, to, &there) || there >= *share ||
            !leads(cracks, piece, tip, to, there))
            continue;
        *share = there;
        any = true;
    }
    return any;
}

void ref_cracks_grow(RefCracks *cracks, int arm, const double to[2])
{
    RefCrackArm *of = cracks->arm + arm;
    double tip[2] = {of->tip[0], of->tip[1]}, end[2] = {to[0], to[1]}, way[2], leg[2][2], share = 1;
    way_from(tip, to, way);
    double whole = length_of(way);
    bool ends = first_meeting(cracks, tip, to, &share), turned = false;
    for (int d = 0; ends && d < 2; d++) end[d] = tip[d] + (share + OVERSHOOT) * way[d];
    double left = whole * fmin(share, 1), beyond = ends ? OVERSHOOT * whole : 0;
    if (!(left > 0)) return;
    RefChartLeg kind = REF_LEG_GOES_ON;
    while (kind == REF_LEG_GOES_ON && left > OVERSHOOT * whole) {
        kind = ref_chart_leg(cracks->chart, tip, end, leg, &turned);
        double rest[2], after = 0;
        way_from(tip, end, rest);
        if (kind == REF_LEG_GOES_ON) after = fmax(length_of(rest) - beyond, 0);
        lengthen(cracks, arm, left - after);
        add_pieces(cracks, arm, (const double(*)[2])leg);
        left = after;
    }
    memcpy(of->tip, tip, sizeof of->tip);
    for (int d = 0; d < 2; d++) of->way[d] = (turned ? -1 : 1) * way[d] / whole;
    of->length += whole * fmin(share, 1);
    if (ends || kind == REF_LEG_RIM) ref_cracks_end(cracks, arm);
}

/* Whether both ends of one are beyond the other's along an axis. */
static bool boxes_apart(const RefCrackPiece *piece, const double x[2], const double from[2])
{
    const double(*end)[2] = piece->at.end;
    bool apart = false;
    for (int d = 0; d < 2; d++) {
        double low = x[d] < from[d] ? x[d] : from[d], high = x[d] < from[d] ? from[d] : x[d];
        apart |= (end[0][d] < low) & (end[1][d] < low);
        apart |= (end[0][d] > high) & (end[1][d] > high);
    }
    return apart;
}

/* Whether the way from `from` to x, which is in that plane, meets a piece, ends counted in. */
static bool crosses(const RefCracks *cracks, const RefCrackPiece *piece, int plane,
                    const double x[2], const double from[2])
{
    double along[2], way[2], a[2], b[2], to[2];
    if (piece->at.plane != plane || boxes_apart(piece, x, from)) return false;
    way_from(piece->at.end[0], piece->at.end[1], along);
    way_from(from, x, way);
    way_from(piece->at.end[0], from, a);
    way_from(piece->at.end[0], x, b);
    double sides[2] = {cross(along, a), cross(along, b)};
    if ((sides[0] > 0 && sides[1] > 0) || (sides[0] < 0 && sides[1] < 0)) return false;
    way_from(piece->at.end[1], from, to);
    double ends[2] = {cross(way, a), cross(way, to)};
    if ((ends[0] > 0 && ends[1] > 0) || (ends[0] < 0 && ends[1] < 0)) return false;
    double turn = cross(along, way);
    return turn != 0 && leads(cracks, piece, x, from, sides[1] / turn);
}

/* What gets past a piece, which the way crosses; false: nothing. The crossing is at the share
 * t = N / D of the piece, N and D linear in x. */
static bool pass_piece(const RefCrackPiece *piece, const double x[2], const double from[2],
                       double width, double part[6])
{
    double along[2], way[2], start[2], slope[2], t_k[2];
    way_from(piece->at.end[0], piece->at.end[1], along);
    way_from(from, x, way);
    way_from(piece->at.end[0], from, start);
    double length = length_of(along), D = cross(along, way);
    double t = fmin(fmax(cross(start, way) / D, 0), 1);
    double s = (length * (1 - t) + piece->ahead) / width, scale = -length / width;
    if (!(s < 1)) return false;
    const double N_k[2] = {-start[1], start[0]}, D_k[2] = {-along[1], along[0]};
    for (int k = 0; k < 2; k++) t_k[k] = (N_k[k] - t * D_k[k]) / D;
    part[0] = ref_mls_spline(s, slope);
    for (int k = 0; k < 2; k++) part[1 + k] = slope[0] * scale * t_k[k];
    for (int m = 0; m < 3; m++) {
        int k = m == 1, l = m != 0;
        double t_kl = -(t_k[k] * D_k[l] + t_k[l] * D_k[k]) / D;
        part[3 + m] = slope[1] * scale * scale * t_k[k] * t_k[l] + slope[0] * scale * t_kl;
    }
    return true;
}

static const double whole[6] = {1};

bool ref_cracks_pass(const void *data, const double x[3], const double from[3], double reach,
                     double part[6])
{
    const RefCracks *cracks = data;
    const RefCracksNear *near = near_to(cracks, x, from);
    int plane = ref_chart_plane(cracks->chart, x);
    memcpy(part, whole, sizeof whole);
    for (long n = 0; n < near->count; n++) {
        const RefCrackPiece *piece = cracks->piece + near->piece[n];
        double f[6];
        if (!crosses(cracks, piece, plane, x, from)) continue;
        if (!pass_piece(piece, x, from, TIP_REACH * reach, f)) return false;
        ref_mls_multiply(f, part);
    }
    return true;
}

/* The box of a grid and the place that it is seen from. */
static void box_of_ways(const RefGrid *grid, const double from[2], double low[2], double high[2])
{
    for (int d = 0; d < 2; d++) {
        double first = grid->at[d][0], last = grid->at[d][grid->count[d] - 1];
        low[d] = from[d] < first ? from[d] : first;
        high[d] = from[d] > last ? from[d] : last;
    }
}

/* Whether the places of a grid and that from which they are seen are not all on one side of a
 * piece. */
static bool may_cross(const RefCrackPiece *piece, const RefGrid *grid, const double from[2])
{
    double along[2], way[2];
    way_from(piece->at.end[0], piece->at.end[1], along);
    way_from(piece->at.end[0], from, way);
    double side = cross(along, way);
    bool all = side != 0;
    for (int c = 0; c < 4; c++) {
        const double corner[2] = {grid->at[0][c % 2 ? grid->count[0] - 1 : 0],
                                  grid->at[1][c / 2 ? grid->count[1] - 1 : 0]};
        way_from(piece->at.end[0], corner, way);
        double there = cross(along, way);
        all = all && (side > 0 ? there > 0 : there < 0);
    }
    return !all;
}

/* Whether straight ways to places of a grid lead to where they meet a piece; asks about those that
 * `crossing` marks, and leaves those that do. */
static bool all_lead(const RefCracks *cracks, const RefCrackPiece *piece, const RefGrid *grid,
                     const double from[2], unsigned char *crossing)
{
    double along[2];
    bool any = false;
    way_from(piece->at.end[0], piece->at.end[1], along);
    for (int p = 0; p < grid->count[0] * grid->count[1]; p++) {
        if (!crossing[p]) continue;
        const double x[2] = {grid->at[0][p % grid->count[0]], grid->at[1][p / grid->count[0]]};
        double way[2], b[2];
        way_from(from, x, way);
        way_from(piece->at.end[0], x, b);
        crossing[p] = leads(cracks, piece, x, from, cross(along, b) / cross(along, way));
        any |= crossing[p];
    }
    return any;
}

/* crosses() for all places of a grid, of which products of one coordinate each are made once. */
static bool cross_grid(const RefCracks *cracks, const RefCrackPiece *piece, const RefGrid *grid,
                       const double from[2], unsigned char crossing[REF_GRID_SIDE * REF_GRID_SIDE])
{
    enum { PRODUCTS = 4 };
    const double *e = piece->at.end[0];
    double along[2], a[2], to[2], product[2][PRODUCTS][REF_GRID_SIDE];
    way_from(piece->at.end[0], piece->at.end[1], along);
    way_from(piece->at.end[0], from, a);
    way_from(piece->at.end[1], from, to);
    for (int d = 0; d < 2; d++)
        for (int i = 0; i < grid->count[d]; i++) {
            double x = grid->at[d][i], way = x - from[d];
            product[d][0][i] = along[!d] * (x - e[d]);
            product[d][1][i] = way * a[!d];
            product[d][2][i] = way * to[!d];
            product[d][3][i] = along[!d] * way;
        }
    double side = cross(along, a);
    bool any = false;
    for (int j = 0; j < grid->count[1]; j++)
        for (int i = 0; i < grid->count[0]; i++) {
            double there = product[1][0][j] - product[0][0][i];
            double first = product[0][1][i] - product[1][1][j];
            double second = product[0][2][i] - product[1][2][j];
            bool apart = ((side > 0) & (there > 0)) | ((side < 0) & (there < 0)) |
                         ((first > 0) & (second > 0)) | ((first < 0) & (second < 0)) |
                         (product[1][3][j] == product[0][3][i]);
            crossing[grid->count[0] * j + i] = !apart;
            any |= !apart;
        }
    return any && (!cracks->chart->cylinders || all_lead(cracks, piece, grid, from, crossing));
}

/* The ways from a place to those of a grid. */
typedef struct {
    const RefCracks *cracks;
    const RefGrid *grid;
    const double *from;
    double low[2], high[2]; /* a box of all ways */
    int plane;
    unsigned char crossing[REF_GRID_SIDE * REF_GRID_SIDE]; /* those that a piece is in */
} Fan;

static Fan fan_of(const RefCracks *cracks, const RefGrid *grid, const double from[2])
{
    Fan fan = {.cracks = cracks, .grid = grid, .from = from};
    const double first[2] = {grid->at[0][0], grid->at[1][0]};
    box_of_ways(grid, from, fan.low, fan.high);
    fan.plane = ref_chart_plane(cracks->chart, first);
    return fan;
}

/* The first of some pieces, from number *n of them, whose box meets that of the ways, and *n goes
 * beyond it; NULL: none. */
static const RefCrackPiece *next_piece(const Fan *fan, const RefCracksNear *near, long *n)
{
    while (*n < near->count) {
        const RefCrackPiece *piece = fan->cracks->piece + near->piece[*n];
        bool meets = meet((const double(*)[2])near->box[(*n)++], fan->low, fan->high);
        if (meets && piece->at.plane == fan->plane) return piece;
    }
    return NULL;
}

static bool in_the_way(Fan *fan, const RefCrackPiece *piece)
{
    return may_cross(piece, fan->grid, fan->from) &&
           cross_grid(fan->cracks, piece, fan->grid, fan->from, fan->crossing);
}

/* What is left of the parts at places of a grid that a piece takes from; false: nothing. */
static bool take_from(const Fan *fan, const RefCrackPiece *piece, double width, double (*part)[6])
{
    const RefGrid *grid = fan->grid;
    const unsigned char *crossing = fan->crossing;
    bool left = false;
    for (int j = 0; j < grid->count[1]; j++)
        for (int i = 0; i < grid->count[0]; i++, part++, crossing++) {
            const double x[2] = {grid->at[0][i], grid->at[1][j]};
            double f[6];
            if (*crossing && part[0][0] != 0) {
                if (piece->ahead < width && pass_piece(piece, x, fan->from, width, f))
                    ref_mls_multiply(f, *part);
                else
                    memset(*part, 0, sizeof *part);
            }
            left |= part[0][0] != 0;
        }
    return left;
}

bool ref_cracks_fan(const RefCracks *cracks, const RefGrid *grid, const double from[2],
                    double reach, double (*part)[6])
{
    Fan fan = fan_of(cracks, grid, from);
    int places = grid->count[0] * grid->count[1];
    bool any = false, left = true;
    const RefCracksNear *near = near_to(cracks, fan.low, fan.high);
    const RefCrackPiece *piece;
    for (long n = 0; left && (piece = next_piece(&fan, near, &n));) {
        if (!in_the_way(&fan, piece)) continue;
        for (int p = 0; !any && p < places; p++) memcpy(part[p], whole, sizeof whole);
        any = true;
        left = take_from(&fan, piece, TIP_REACH * reach, part);
    }
    return any;
}

bool ref_cracks_part(const RefCracks *cracks, const double x[2], const double from[2])
{
    const RefCracksNear *near = near_to(cracks, x, from);
    int plane = ref_chart_plane(cracks->chart, x);
    for (long n = 0; n < near->count; n++)
        if (crosses(cracks, cracks->piece + near->piece[n], plane, x, from)) return true;
    return false;
}

bool ref_cracks_end_ahead(const RefCracks *cracks, int arm, double far)
{
    const RefCrackArm *of = cracks->arm + arm;
    double end[2] = {of->tip[0], of->tip[1]}, way[2] = {far * of->way[0], far * of->way[1]};
    double to[2] = {of->tip[0] + way[0], of->tip[1] + way[1]}, share = 1;
    if (first_meeting(cracks, of->tip, to, &share)) return true;
    return !ref_chart_walk(cracks->chart, end, way);
}

double ref_cracks_distance(const RefCracks *cracks, const double x[2], double far)
{
    double least = far;
    int plane = ref_chart_plane(cracks->chart, x);
    for (long p = 0; p < cracks->pieces; p++) {
        const RefCrackPiece *piece = cracks->piece + p;
        double along[2], to[2];
        if (piece->at.plane != plane) continue;
        way_from(piece->at.end[0], piece->at.end[1], along);
        way_from(piece->at.end[0], x, to);
        double square = along[0] * along[0] + along[1] * along[1];
        double t = fmin(fmax((along[0] * to[0] + along[1] * to[1]) / square, 0), 1);
        for (int d = 0; d < 2; d++) to[d] -= t * along[d];
        least = fmin(least, length_of(to));
    }
    return least;
}
