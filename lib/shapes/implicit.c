#include "implicit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"
#include "../vector.h"
#include "sine.h"

static const double nowhere = 1e9; /* value of the empty solid */

SmPrimitive sm_primitive(SmPrimitiveKind kind, double blend, const double centre[3],
                         const double size[3])
{
    SmPrimitive made = {.kind = kind, .blend = blend, .axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    memcpy(made.centre, centre, sizeof made.centre);
    memcpy(made.size, size, sizeof made.size);
    return made;
}

void sm_primitive_turn(SmPrimitive *primitive, int axis, double angle)
{
    int u = (axis + 1) % 3, w = (axis + 2) % 3;
    double c = sm_cos(angle), s = sm_sin(angle);
    for (int row = 0; row < 3; row++) {
        double *v = primitive->axis[row], a = v[u], b = v[w];
        v[u] = c * a - s * b;
        v[w] = s * a + c * b;
    }
}

void sm_implicit_add(SmImplicit *implicit, const SmPrimitive *primitive)
{
    sm_make_room(implicit->primitive, implicit->room, implicit->count + 1);
    SmPrimitive *f = &implicit->primitive[implicit->count++];
    double ba[3];
    *f = *primitive;
    sm_subtract(f->tip, f->centre, ba);
    f->length = sqrt(sm_dot(ba, ba));
    f->sine = (f->size[0] - f->size[1]) / f->length;
    f->cosine = sqrt(1 - f->sine * f->sine);
}

void sm_implicit_free(SmImplicit *implicit)
{
    free(implicit->primitive);
    memset(implicit, 0, sizeof *implicit);
}

static double length2(double a, double b)
{
    return sqrt(a * a + b * b);
}

static double length3(double a, double b, double c)
{
    return sqrt(a * a + b * b + c * c);
}

/* Signed distance to an ellipse (n = 2) or ellipsoid (n = 3) with radii r: the nearest point is
 * r_i^2 q_i / (t + r_i^2) for the largest root t of sum (r_i q_i / (t + r_i^2))^2 = 1 (D. Eberly,
 * "Distance from a point to an ellipse"). That function is convex and falls, so Newton's method
 * from the left never passes the root. Planes of symmetry, where it may have no root, are kept off.
 */
static double ellipsoid(int n, const double *p, const double *r)
{
    double q[3], t = -HUGE_VAL, inside = -1, d2 = 0;
    for (int i = 0; i < n; i++) {
        q[i] = fabs(p[i]) + 1e-6 * r[i];
        t = fmax(t, r[i] * q[i] - r[i] * r[i]);
        inside += q[i] * q[i] / (r[i] * r[i]);
    }
    for (int round = 0; round < 20; round++) {
        double f = -1, slope = 0;
        for (int i = 0; i < n; i++) {
            double w = 1 / (t + r[i] * r[i]), term = r[i] * q[i] * w;
            f += term * term;
            slope += 2 * term * term * w;
        }
        t += f / slope;
        if (f < 1e-7) break;
    }
    for (int i = 0; i < n; i++) {
        double away = q[i] * t / (t + r[i] * r[i]);
        d2 += away * away;
    }
    return inside < 0 ? -sqrt(d2) : sqrt(d2);
}

/* Exact distance to a round cone (I. Quilez, "round cone"): in the plane of axis and point the side
 * is the line tangent to both circles. */
static double cone(const SmPrimitive *f, const double p[3])
{
    double ra = f->size[0], rb = f->size[1], l = f->length, pa[3], along = 0;
    for (int i = 0; i < 3; i++) {
        pa[i] = p[i] - f->centre[i];
        along += pa[i] * (f->tip[i] - f->centre[i]);
    }
    if (l <= fabs(ra - rb)) { /* one ball holds the other */
        const double *c = ra - rb > 0 ? f->centre : f->tip;
        return length3(p[0] - c[0], p[1] - c[1], p[2] - c[2]) - fmax(ra, rb);
    }
    double y = along / l, sine = f->sine, cosine = f->cosine;
    double x = sqrt(fmax(0, pa[0] * pa[0] + pa[1] * pa[1] + pa[2] * pa[2] - y * y));
    double foot = y * cosine - x * sine; /* scaled position along the side */
    if (foot < 0) return length2(x, y) - ra;
    if (foot > l * cosine) return length2(x, y - l) - rb;
    return x * cosine + y * sine - ra;
}

static double rounded(double a, double b, double rounding)
{
    return fmin(fmax(a, b), 0) + length2(fmax(a, 0), fmax(b, 0)) - rounding;
}

static double brick(const double q[3], const SmPrimitive *f)
{
    double d[3];
    for (int i = 0; i < 3; i++) d[i] = fabs(q[i]) - f->size[i] + f->rounding;
    return fmin(fmax(d[0], fmax(d[1], d[2])), 0) +
           length3(fmax(d[0], 0), fmax(d[1], 0), fmax(d[2], 0)) - f->rounding;
}

static double petal(const double q[3], const SmPrimitive *f)
{
    const double *r = f->size;
    double x = fmin(q[0] * q[0], r[0] * r[0]), z = fmin(q[2] * q[2], r[2] * r[2]);
    double y = q[1] - f->bend[0] * x - f->bend[1] * z;
    double outline = ellipsoid(2, (double[]){q[0], q[2]}, (double[]){r[0], r[2]});
    double steepest = length2(1, 2 * fmax(fabs(f->bend[0]) * r[0], fabs(f->bend[1]) * r[2]));
    return rounded(outline + r[1], fabs(y) / steepest, r[1]);
}

static double value(const SmPrimitive *f, const double p[3])
{
    if (f->kind == SM_CONE) return cone(f, p);
    double o[3] = {p[0] - f->centre[0], p[1] - f->centre[1], p[2] - f->centre[2]}, q[3];
    for (int i = 0; i < 3; i++)
        q[i] = f->axis[i][0] * o[0] + f->axis[i][1] * o[1] + f->axis[i][2] * o[2];
    switch (f->kind) {
    case SM_BRICK:
        return brick(q, f);
    case SM_DRUM:
        return rounded(length2(q[0], q[2]) - f->size[0] + f->rounding,
                       fabs(q[1]) - f->size[1] + f->rounding, f->rounding);
    case SM_RING:
        return length2(length2(q[0], q[2]) - f->size[0], q[1]) - f->size[1];
    case SM_PETAL:
        return petal(q, f);
    default:
        return ellipsoid(3, q, f->size);
    }
}

static double smooth_minimum(double a, double b, double k)
{
    double overlap = k - fabs(a - b), least = a < b ? a : b;
    return overlap > 0 ? least - overlap * overlap / (4 * k) : least;
}

static double fold(double d, double v, const SmPrimitive *f)
{
    return f->cut ? -smooth_minimum(-d, v, f->blend) : smooth_minimum(d, v, f->blend);
}

/* Whether b continues the chain that a is in. */
static int continues(const SmPrimitive *a, const SmPrimitive *b)
{
    return b->chain && a->chain == b->chain;
}

double sm_implicit_at(const SmImplicit *implicit, const int *active, int count, const double p[3])
{
    double d = nowhere;
    for (int i = 0; i < count;) {
        const SmPrimitive *f = &implicit->primitive[active[i]];
        double v = value(f, p);
        for (i++; i < count; i++) {
            const SmPrimitive *next = &implicit->primitive[active[i]];
            if (!continues(f, next)) break;
            v = fmin(v, value(next, p));
        }
        d = fold(d, v, f);
    }
    return d;
}

double sm_implicit_prune(const SmImplicit *implicit, const int *active, int count,
                         const double centre[3], double radius, int *kept, int *kept_count)
{
    double d = nowhere, change = 2 * SM_IMPLICIT_SLOPE * radius;
    int n = 0;
    for (int i = 0; i < count;) {
        const SmPrimitive *f = &implicit->primitive[active[i]];
        double least = nowhere, reach = change + f->blend;
        int first = n, start = i;
        for (; i < count; i++) {
            const SmPrimitive *part = &implicit->primitive[active[i]];
            if (i > start && !continues(f, part)) break;
            double v = value(part, centre);
            if (v <= least + change && (f->cut ? -v >= d - reach : v <= d + reach))
                kept[n++] = active[i];
            least = fmin(least, v);
        }
        if (n == first) continue;
        if (!f->cut && least < d - reach) { /* hides all that came before */
            memmove(kept, kept + first, (size_t)(n - first) * sizeof *kept);
            n -= first;
        }
        d = fold(d, least, f);
    }
    *kept_count = n;
    return d;
}

/* Half extents of a primitive's local box. */
static void local_extent(const SmPrimitive *f, double half[3])
{
    const double *r = f->size;
    double lift = fabs(f->bend[0]) * r[0] * r[0] + fabs(f->bend[1]) * r[2] * r[2];
    memcpy(half, r, 3 * sizeof *half);
    if (f->kind == SM_DRUM) half[2] = r[0];
    if (f->kind == SM_RING) half[0] = half[2] = r[0] + r[1];
    if (f->kind == SM_PETAL) half[1] = 1.5 * r[1] + lift;
}

SmBox sm_implicit_bounds(const SmImplicit *implicit)
{
    SmBox box = sm_no_box();
    for (int n = 0; n < implicit->count; n++) {
        const SmPrimitive *f = &implicit->primitive[n];
        SmBox own = {{0}, {0}};
        double half[3];
        if (f->cut) continue;
        local_extent(f, half);
        for (int i = 0; i < 3; i++) {
            double reach = 0, first = f->size[0], second = f->size[1];
            for (int j = 0; j < 3; j++) reach += fabs(f->axis[j][i]) * half[j];
            bool cone = f->kind == SM_CONE;
            own.low[i] =
                cone ? fmin(f->centre[i] - first, f->tip[i] - second) : f->centre[i] - reach;
            own.high[i] =
                cone ? fmax(f->centre[i] + first, f->tip[i] + second) : f->centre[i] + reach;
        }
        sm_box_join(&box, own.low, own.high);
    }
    return box;
}
