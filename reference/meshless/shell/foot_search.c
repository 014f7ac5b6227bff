/* foot_search.c - compiled as the kernels are, for each instruction set. */
#include "foot_search.h"

#include <math.h>
#include <stdbool.h>

#include "../../../lib/simd/real.h"

#define INLINE static inline __attribute__((always_inline))

/* As many points as the processor works on at once; comparisons fill the bits of theirs. */
enum { LANES = SM_VECTOR_BYTES / sizeof(double) };
_Static_assert(REF_SKIN_SHARED % LANES == 0, "whole vectors");
typedef double Lanes __attribute__((vector_size(SM_VECTOR_BYTES)));
typedef Lanes Loose __attribute__((aligned(sizeof(double)))); /* anywhere where doubles may be */
typedef long long Bits __attribute__((vector_size(SM_VECTOR_BYTES)));

INLINE Lanes load(const double *from)
{
    return *(const Loose *)from;
}

INLINE void store(double *to, Lanes v)
{
    *(Loose *)to = v;
}

INLINE Lanes choose(Bits which, Lanes yes, Lanes no)
{
    return (Lanes)(((Bits)yes & which) | ((Bits)no & ~which));
}

INLINE Lanes larger(Lanes a, Lanes b)
{
    return choose((Bits)(a > b), a, b);
}

INLINE Lanes smaller(Lanes a, Lanes b)
{
    return choose((Bits)(a < b), a, b);
}

INLINE Lanes magnitude(Lanes v)
{
    return larger(v, -v);
}

INLINE Lanes dot(const Lanes a[3], const Lanes b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

INLINE void cross(const Lanes a[3], const Lanes b[3], Lanes to[3])
{
    to[0] = a[1] * b[2] - a[2] * b[1];
    to[1] = a[2] * b[0] - a[0] * b[2];
    to[2] = a[0] * b[1] - a[1] * b[0];
}

/* Taylor's series to second order, and its slopes. */
static void expand(const double sum[6][REF_FRAME_SLOPES], int first, int count,
                   RefFootPoints *points)
{
    for (int p = first; p < first + count; p += LANES) {
        const Lanes x = load(points->from[0] + p), y = load(points->from[1] + p);
        for (int f = 0; f < 6; f++) {
            double(*to)[3][REF_SKIN_ROOM] = f < 3 ? points->place : points->normal;
            const Lanes along = x * sum[3][f] + y * sum[5][f],
                        across = y * sum[4][f] + x * sum[5][f];
            store(to[0][f % 3] + p,
                  sum[0][f] + x * (sum[1][f] + 0.5 * along) + y * (sum[2][f] + 0.5 * across));
            store(to[1][f % 3] + p, sum[1][f] + along);
            store(to[2][f % 3] + p, sum[2][f] + across);
        }
    }
}

/* Some points, and offsets of theirs. */
typedef struct {
    Lanes x[3], place[3][3], normal[3][3];
    Lanes off[3], height, reach[3]; /* off: of the point from its place */
    Lanes o[3], square;             /* of how far offsets were off before the last step */
} Some;

/* One of Newton's steps as in foot.c, without its root, where `which` says so. */
INLINE void step(Some *at, Bits which)
{
    Lanes slope[3][3], off[3], across[3][3];
    for (int d = 0; d < 3; d++) {
        for (int k = 0; k < 2; k++)
            slope[k][d] = at->place[1 + k][d] + at->o[2] * at->normal[1 + k][d];
        slope[2][d] = at->normal[0][d] + at->o[0] * at->normal[1][d] + at->o[1] * at->normal[2][d];
        off[d] = at->x[d] - at->place[0][d] - at->o[0] * at->place[1][d] -
                 at->o[1] * at->place[2][d] - at->o[2] * slope[2][d];
    }
    for (int k = 0; k < 3; k++) cross(slope[(k + 1) % 3], slope[(k + 2) % 3], across[k]);
    const Lanes none = {0}, volume = dot(slope[0], across[0]), up = dot(slope[2], slope[2]);
    const Lanes sides = dot(slope[0], slope[0]) * dot(slope[1], slope[1]) * up;
    const Bits apart = (Bits)(volume * volume > 1e-18 * sides), upward = (Bits)(up > 0);
    const Lanes by = 1 / choose(apart, volume, choose(upward, up, none + 1));
    const Lanes rise = choose(upward, dot(off, slope[2]), none);
    for (int k = 0; k < 3; k++) {
        const Lanes more = by * choose(apart, dot(off, across[k]), k == 2 ? rise : none);
        at->o[k] += choose(which, more, none);
    }
    at->square = choose(which, dot(off, off), at->square);
}

INLINE Lanes beyond(const Some *at)
{
    Lanes far = (Lanes){0} + REF_FOOT_WITHIN;
    for (int k = 0; k < 3; k++) far = larger(magnitude(at->o[k]) / at->reach[k], far);
    return far / REF_FOOT_WITHIN;
}

INLINE Lanes root(Lanes v)
{
    for (int l = 0; l < LANES; l++) v[l] = sqrt(v[l]);
    return v;
}

/* As find_reach() and shorten() of foot.c. */
INLINE void find_reach(const Lanes edge[2], Some *at)
{
    const Lanes most = 2 * root(dot(at->off, at->off)) + REF_FOOT_NEAR * at->height;
    for (int k = 0; k < 2; k++)
        at->reach[k] = smaller(edge[k], most / root(dot(at->place[1 + k], at->place[1 + k])));
    at->reach[2] = smaller(at->height, most / root(dot(at->normal[0], at->normal[0])));
}

INLINE void shorten(Some *at)
{
    const Lanes none = {0}, up = dot(at->normal[0], at->normal[0]);
    const Bits upward = (Bits)(up > 0);
    const Lanes whole = dot(at->off, at->normal[0]) / choose(upward, up, none + 1);
    const Lanes lift = larger(-at->reach[2], smaller(choose(upward, whole, none), at->reach[2]));
    const Lanes share = 1 / beyond(at);
    for (int k = 0; k < 3; k++)
        at->o[k] = share * share * at->o[k] + (k == 2 ? (1 - share) * lift : none);
}

INLINE Some some_at(const RefFootPoints *points, int p)
{
    Some at = {.o = {{0}}};
    for (int d = 0; d < 3; d++) {
        at.x[d] = load(points->x[d] + p);
        for (int k = 0; k < 3; k++) at.place[k][d] = load(points->place[k][d] + p);
        for (int k = 0; k < 3; k++) at.normal[k][d] = load(points->normal[k][d] + p);
        at.off[d] = at.x[d] - at.place[0][d];
    }
    const Lanes edge[2] = {load(points->edge[0] + p), load(points->edge[1] + p)};
    at.height = 2 * root(root(dot(at.place[1], at.place[1]) * dot(at.place[2], at.place[2]))) *
                larger(edge[0], edge[1]);
    find_reach(edge, &at);
    return at;
}

INLINE bool any(Bits which)
{
    long long all = 0;
    for (int l = 0; l < LANES; l++) all |= which[l];
    return all != 0;
}

static void find(int count, RefFootPoints *points)
{
    for (int p = 0; p < count; p += LANES) {
        Some at = some_at(points, p);
        const Lanes none = {0}, near = REF_FOOT_NEAR * at.height;
        const Bits varies = (Bits)(at.height > 0); /* functions do */
        Lanes first[3];
        step(&at, varies);
        shorten(&at);
        for (int k = 0; k < 3; k++) at.o[k] = first[k] = choose(varies, at.o[k], none);
        Bits going = varies;
        for (int n = 0; n < REF_FOOT_MOST_STEPS && any(going); n++) {
            step(&at, going);
            going &= (Bits)(at.square > near * near) & (Bits)(beyond(&at) == 1);
        }
        const Bits found = (Bits)(at.square < 100 * near * near) & (Bits)(beyond(&at) == 1);
        for (int k = 0; k < 3; k++) store(points->offset[k] + p, choose(found, at.o[k], first[k]));
    }
}

static void series(int count, const RefFootPoints *points, double times[6][REF_SKIN_ROOM])
{
    for (int p = 0; p < count; p += LANES) {
        const Lanes x = load(points->from[0] + p), y = load(points->from[1] + p);
        const Lanes along = load(points->offset[0] + p), across = load(points->offset[1] + p);
        store(times[0] + p, 1 - (Lanes){0});
        store(times[1] + p, x + along);
        store(times[2] + p, y + across);
        store(times[3] + p, x * (0.5 * x + along));
        store(times[4] + p, y * (0.5 * y + across));
        store(times[5] + p, x * y + along * y + across * x);
    }
}

const RefFootSearch SM_ISA_NAME(ref_foot_search) = {expand, find, series};
