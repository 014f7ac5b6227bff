#include "cylinders.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/error.h"
#include "mls.h"

/* How near to a zero lines are that it dims, in the node's reach. */
static const double ZERO_REACH = 0.25;
/* Of a reach, or a width, within which a line's end is the place that it is to lead to. */
static const double SAME = 1e-6;
enum { MOST_JOINTS_PASSED = 1000, MOST_ZEROS = 16 };

void ref_cylinders_free(RefCylinders *cylinders)
{
    sm_free_all(cylinders->cylinder, cylinders->joint);
    *cylinders = (RefCylinders){.count = 0};
}

void ref_cylinder_images_free(RefCylinderImages *images)
{
    sm_free_all(images->to, images->shift);
    *images = (RefCylinderImages){.count = 0};
}

static double width_of(const RefCylinder *cylinder)
{
    return cylinder->high[0] - cylinder->low[0];
}

int ref_cylinders_at(const RefCylinders *cylinders, const double theta[2])
{
    int at = 0;
    while (at + 1 < cylinders->count &&
           theta[0] > (cylinders->cylinder[at].high[0] + cylinders->cylinder[at + 1].low[0]) / 2)
        at++;
    return at;
}

bool ref_cylinders_zero(const RefCylinders *cylinders, const double low[2], const double high[2])
{
    const double middle[2] = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2};
    int at = ref_cylinders_at(cylinders, middle);
    const RefCylinder *cylinder = cylinders->cylinder + at;
    double width = width_of(cylinder), tiny = 1e-9 * width;
    for (int j = 0; j < cylinders->joints; j++) {
        const RefJoint *joint = cylinders->joint + j;
        double side = joint->up ? cylinder->high[1] : cylinder->low[1];
        if (joint->from != at || side < low[1] - tiny || side > high[1] + tiny) continue;
        for (int k = -1; k <= 1; k++) /* it goes on where it is cut open */
            if (joint->begin + k * width >= low[0] - tiny &&
                joint->begin + k * width <= high[0] + tiny)
                return true;
    }
    return false;
}

/* Moves a place along the first axis into a rectangle. */
static void wrap(const RefCylinder *cylinder, double theta[2])
{
    double width = width_of(cylinder);
    theta[0] -= width * floor((theta[0] - cylinder->low[0]) / width);
    if (theta[0] >= cylinder->high[0]) theta[0] = cylinder->low[0];
}

/* The joint of a cylinder's side at a place along it. */
static const RefJoint *joint_at(const RefCylinders *cylinders, int at, bool up, double place)
{
    const RefJoint *nearest = NULL;
    double width = width_of(cylinders->cylinder + at), least = INFINITY;
    for (int j = 0; j < cylinders->joints; j++) {
        const RefJoint *joint = cylinders->joint + j;
        if (joint->from != at || joint->up != up) continue;
        double on = place - joint->begin;
        on -= width * floor(on / width);
        if (on <= joint->end - joint->begin) return joint;
        double off = fmin(on - (joint->end - joint->begin), width - on);
        if (off >= least) continue;
        least = off;
        nearest = joint;
    }
    return nearest;
}

/* Goes on to the next cylinder's side, and shortens the way by that; -1 where the way ends before:
 * theta is moved to there. `moved` gets what was added beside the way. */
static int hop(const RefCylinders *cylinders, int at, double theta[2], double way[2],
               double moved[2])
{
    const RefCylinder *cylinder = cylinders->cylinder + at;
    double before[2] = {theta[0], theta[1]}, end = theta[1] + way[1], share = 1;
    const RefJoint *joint = NULL;
    if (end > cylinder->high[1] || end < cylinder->low[1]) {
        bool up = end > cylinder->high[1];
        double side = up ? cylinder->high[1] : cylinder->low[1];
        share = fmin(fmax((side - theta[1]) / way[1], 0), 1);
        joint = joint_at(cylinders, at, up, theta[0] + share * way[0]);
    }
    for (int d = 0; d < 2; d++) theta[d] += share * way[d];
    if (joint && joint->to >= 0) {
        const RefCylinder *next = cylinders->cylinder + joint->to;
        double on = theta[0] - joint->begin, width = width_of(cylinder);
        on -= width * floor(on / width);
        if (on > joint->end - joint->begin) /* by rounding */
            on = on < width - (on - (joint->end - joint->begin)) ? joint->end - joint->begin : 0;
        theta[0] = joint->begin + on + joint->shift[0];
        theta[1] = joint->up ? next->low[1] : next->high[1];
        wrap(next, theta);
    } else {
        wrap(cylinder, theta);
    }
    for (int d = 0; d < 2; d++) {
        moved[d] = theta[d] - before[d] - share * way[d];
        way[d] *= 1 - share;
    }
    return joint ? joint->to : -1;
}

bool ref_cylinders_walk(const RefCylinders *cylinders, double theta[2], const double way[2])
{
    double left[2] = {way[0], way[1]}, moved[2];
    int at = ref_cylinders_at(cylinders, theta);
    for (int n = 0; n < MOST_JOINTS_PASSED && at >= 0; n++)
        at = hop(cylinders, at, theta, left, moved);
    return left[1] == 0;
}

bool ref_cylinders_hop(const RefCylinders *cylinders, double theta[2], double way[2],
                       double moved[2])
{
    return hop(cylinders, ref_cylinders_at(cylinders, theta), theta, way, moved) >= 0;
}

/* Whether a place is another one, of a rectangle or some widths beside. */
static bool is_same(const RefCylinders *cylinders, const double theta[2], int in,
                    const double other[2], double off)
{
    double along = theta[0] - other[0], width = width_of(cylinders->cylinder + in);
    along -= width * rint(along / width);
    return ref_cylinders_at(cylinders, theta) == in && fabs(along) < off &&
           fabs(theta[1] - other[1]) < off;
}

bool ref_cylinders_lead(const RefCylinders *cylinders, const double theta[2], const double way[2],
                        int in, const double to[2])
{
    double end[2] = {theta[0], theta[1]};
    return ref_cylinders_walk(cylinders, end, way) &&
           is_same(cylinders, end, in, to, SAME * width_of(cylinders->cylinder + in));
}

/* ---- images */

/* A cylinder's rectangle that lines from a place's box reach, in the plane that goes on straight
 * from there: the place is at `from` in the cylinder's own plane. */
typedef struct {
    int at, way; /* 1: it was reached upwards, -1: downwards, 0: it is the place's own */
    double from[2];
} Sight;

typedef struct {
    const RefCylinders *cylinders;
    double low[2], high[2], enlarged; /* of the box, from the place */
    long count, room;
    Sight *sight; /* what is looked at, one after the other */
} Look;

static bool is_seen(const Look *look, int at, const double from[2])
{
    double tiny = 1e-9 * width_of(look->cylinders->cylinder + at);
    for (long n = 0; n < look->count; n++)
        if (look->sight[n].at == at && fabs(look->sight[n].from[0] - from[0]) < tiny &&
            fabs(look->sight[n].from[1] - from[1]) < tiny)
            return true;
    return false;
}

/* Goes on from a rectangle across a piece of its side along axis `axis`, if that is in the box, to
 * where the place is at `there` in the plane of `to`. */
static void look_through(Look *look, const Sight *sight, int axis, double side, double begin,
                         double end, int to, int way, const double there[2])
{
    double away = side - sight->from[!axis];
    begin = fmax(begin - sight->from[axis], look->low[axis]);
    end = fmin(end - sight->from[axis], look->high[axis]);
    double tiny = 1e-9 * (look->high[axis] - look->low[axis]);
    if (end - begin <= tiny || away <= look->low[!axis] || away >= look->high[!axis]) return;
    if (is_seen(look, to, there)) return;
    sm_make_room(look->sight, look->room, look->count + 1);
    look->sight[look->count++] = (Sight){.at = to, .way = way, .from = {there[0], there[1]}};
}

/* Across an interval of a side, of which the piece that is in the rectangle begins `around`
 * farther; the side beyond may be in several widths. */
static void look_across(Look *look, const Sight *sight, const RefJoint *joint, double around)
{
    const RefCylinder *from = look->cylinders->cylinder + joint->from;
    const RefCylinder *next = look->cylinders->cylinder + joint->to;
    double begin = fmax(joint->begin + around, from->low[0]);
    double end = fmin(joint->end + around, from->high[0]);
    double width = width_of(next), on = joint->shift[0] - around;
    double side = joint->up ? from->high[1] : from->low[1];
    int way = joint->up ? 1 : -1;
    if (sight->way == -way || end <= begin) return;
    for (double k = floor((begin + on - next->low[0]) / width); next->low[0] + k * width < end + on;
         k++) {
        double first = next->low[0] + k * width - on; /* of the width, seen from here */
        const double there[2] = {sight->from[0] + on - k * width, sight->from[1] + joint->shift[1]};
        look_through(look, sight, 0, side, fmax(begin, first), fmin(end, first + width), joint->to,
                     way, there);
    }
}

/* Goes on from a rectangle to those beside, and returns whether a zero of it is near. */
static bool look_around(Look *look, const Sight *sight)
{
    const RefCylinder *cylinder = look->cylinders->cylinder + sight->at;
    double width = width_of(cylinder), by = look->enlarged;
    bool near = false;
    for (int k = -1; k <= 1; k += 2) {
        const double there[2] = {sight->from[0] - k * width, sight->from[1]};
        look_through(look, sight, 1, k > 0 ? cylinder->high[0] : cylinder->low[0], cylinder->low[1],
                     cylinder->high[1], sight->at, sight->way, there);
    }
    for (int j = 0; j < look->cylinders->joints; j++) {
        const RefJoint *joint = look->cylinders->joint + j;
        if (joint->from != sight->at) continue;
        double up = (joint->up ? cylinder->high[1] : cylinder->low[1]) - sight->from[1];
        for (int k = -1; k <= 1; k++) {
            double on = joint->begin + k * width - sight->from[0];
            near |= up > look->low[1] - by && up < look->high[1] + by && on > look->low[0] - by &&
                    on < look->high[0] + by;
        }
        for (int k = -1; k <= 0 && joint->to >= 0; k++) look_across(look, sight, joint, k * width);
    }
    return near;
}

void ref_cylinders_images(const RefCylinders *cylinders, const double theta[2], const double low[2],
                          const double high[2], double enlarged, RefCylinderImages *images)
{
    Look look = {.cylinders = cylinders, .enlarged = enlarged, .count = 1};
    memcpy(look.low, low, sizeof look.low);
    memcpy(look.high, high, sizeof look.high);
    sm_make_room(look.sight, look.room, 1);
    look.sight[0] = (Sight){.at = ref_cylinders_at(cylinders, theta), .from = {theta[0], theta[1]}};
    images->zero = false;
    for (long n = 0; n < look.count; n++) {
        const Sight sight = look.sight[n]; /* as these move */
        images->zero |= look_around(&look, &sight);
    }
    images->count = (int)look.count;
    if (images->count > images->room) {
        images->room = 2 * images->count;
        images->to = sm_realloc(images->to, (size_t)images->room, sizeof *images->to);
        images->shift = sm_realloc(images->shift, (size_t)images->room, sizeof *images->shift);
    }
    for (long n = 0; n < look.count; n++) {
        images->to[n] = look.sight[n].at;
        for (int d = 0; d < 2; d++) images->shift[n][d] = look.sight[n].from[d] - theta[d];
    }
    free(look.sight);
}

/* ---- what passes zeros */

/* A line in the plane of a cylinder, and the zeros that it has passed, as seen from x. */
typedef struct {
    double x[2], from[2]; /* now: both move as the line goes on */
    double away[2];       /* by which they have moved */
    int count;
    double zero[MOST_ZEROS][2]; /* less what they have moved */
} Line;

/* 1 - c(distance / b) of a zero, with its derivatives by x. The square of the distance is that to
 * the line where the foot is on it, else to one of its ends. */
static void dim(const double x[2], const double from[2], const double zero[2], double b,
                double part[6])
{
    double v[2], u[2], slope[2], square_k[2] = {0}, square_kl[3] = {0}, square;
    for (int d = 0; d < 2; d++) {
        v[d] = x[d] - from[d];
        u[d] = zero[d] - from[d];
    }
    double A = u[0] * v[0] + u[1] * v[1], B = v[0] * v[0] + v[1] * v[1];
    square = u[0] * u[0] + u[1] * u[1];
    if (A >= B) { /* nearest to x */
        square += B - 2 * A;
        for (int k = 0; k < 2; k++) square_k[k] = 2 * (v[k] - u[k]);
        square_kl[0] = square_kl[1] = 2;
    } else if (A > 0) {
        double t = A / B;
        square -= A * t;
        for (int k = 0; k < 2; k++) square_k[k] = 2 * t * (t * v[k] - u[k]);
        for (int m = 0; m < 3; m++) {
            int k = m == 1, l = m != 0;
            square_kl[m] =
                (-2 * u[k] * u[l] + 4 * t * (u[k] * v[l] + u[l] * v[k]) - 8 * t * t * v[k] * v[l]) /
                    B +
                (k == l ? 2 * t * t : 0);
        }
    }
    memset(part, 0, 6 * sizeof *part);
    part[0] = 1;
    double s = sqrt(fmax(square, 0)) / b;
    if (!(s < 1)) return;
    part[0] = 1 - ref_mls_spline(s, slope);
    /* by S = s^2: half the slope over s, and its own slope; in s < 1/2 these are 2 and 0 */
    double f_S = s < 0.5 ? 2 : -slope[0] / (2 * s);
    double f_SS = s < 0.5 ? 0 : (-slope[1] - 2 * f_S) / (4 * s * s);
    for (int k = 0; k < 2; k++) part[1 + k] = f_S * square_k[k] / (b * b);
    for (int m = 0; m < 3; m++) {
        int k = m == 1, l = m != 0;
        part[3 + m] =
            f_S * square_kl[m] / (b * b) + f_SS * square_k[k] * square_k[l] / (b * b * b * b);
    }
}

/* Whether a zero was not passed before. */
static bool is_new(Line *line, const double zero[2], double tiny)
{
    double place[2] = {zero[0] - line->away[0], zero[1] - line->away[1]};
    for (int n = 0; n < line->count; n++)
        if (fabs(line->zero[n][0] - place[0]) < tiny && fabs(line->zero[n][1] - place[1]) < tiny)
            return false;
    if (line->count == MOST_ZEROS) return false; /* one that is passed twice would count twice */
    memcpy(line->zero[line->count++], place, sizeof place);
    return true;
}

/* The zeros on a cylinder's sides. */
static void pass_cylinder(const RefCylinders *cylinders, int at, double b, Line *line,
                          double part[6])
{
    const RefCylinder *cylinder = cylinders->cylinder + at;
    double width = width_of(cylinder), low[2], high[2];
    for (int d = 0; d < 2; d++) {
        low[d] = fmin(line->x[d], line->from[d]) - b;
        high[d] = fmax(line->x[d], line->from[d]) + b;
    }
    for (int j = 0; j < cylinders->joints; j++) {
        const RefJoint *joint = cylinders->joint + j;
        double side = joint->up ? cylinder->high[1] : cylinder->low[1];
        if (joint->from != at || side <= low[1] || side >= high[1]) continue;
        double first = ceil((low[0] - joint->begin) / width);
        for (double k = first; joint->begin + k * width < high[0]; k++) {
            const double zero[2] = {joint->begin + k * width, side};
            double f[6];
            if (!is_new(line, zero, SAME * b)) continue;
            dim(line->x, line->from, zero, b, f);
            ref_mls_multiply(f, part);
        }
    }
}

bool ref_cylinders_pass(const RefCylinders *cylinders, const double x[2], const double from[2],
                        const double node[2], double reach, double part[6])
{
    static const double whole[6] = {1};
    Line line = {.x = {x[0], x[1]}, .from = {from[0], from[1]}};
    double theta[2] = {x[0], x[1]}, way[2] = {from[0] - x[0], from[1] - x[1]}, moved[2];
    memcpy(part, whole, sizeof whole);
    int at = ref_cylinders_at(cylinders, x);
    for (int n = 0; n < MOST_JOINTS_PASSED && at >= 0; n++) {
        pass_cylinder(cylinders, at, ZERO_REACH * reach, &line, part);
        at = hop(cylinders, at, theta, way, moved);
        for (int d = 0; d < 2; d++) {
            line.x[d] += moved[d];
            line.from[d] += moved[d];
            line.away[d] += moved[d];
        }
    }
    return part[0] > 0 &&
           is_same(cylinders, theta, ref_cylinders_at(cylinders, node), node, SAME * reach);
}
