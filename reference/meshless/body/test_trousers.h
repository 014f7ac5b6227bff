/* test_trousers.h - a plane of cylinders that is known, for the tests. */
#ifndef REF_TEST_TROUSERS_H
#define REF_TEST_TROUSERS_H

#include "../../../lib/test_frame.h"
#include "../../../lib/test_random.h"
#include "../shell/chart.h"

/* Genus 2: two narrow cylinders stand side by side on a wide one, which stands on them, turned by
 * `twist`. What the third is cut open along is moved by `cut` of the widths. */
typedef struct {
    RefCylinder cylinder[3];
    RefJoint joint[8];
    RefCylinders all;
} Trousers;

static const double widths[3] = {5, 2, 3}, heights[3] = {2, 1, 1.5};

static inline double wrapped(double at, double width)
{
    return at - width * floor(at / width);
}

/* Both sides of an interval, of which the upper side of `under` has the beginning at `from`, and
 * the lower side of `over` at `to`, as places of cylinders that are not cut elsewhere. */
static inline void join(Trousers *t, int under, double from, int over, double to, double length,
                        const double cut[3])
{
    const RefCylinder *low = t->cylinder + under, *high = t->cylinder + over;
    double begin = low->low[0] + wrapped(from - cut[under], widths[under]);
    double there = high->low[0] + wrapped(to - cut[over], widths[over]);
    double up = high->low[1] - low->high[1];
    t->joint[t->all.joints++] =
        (RefJoint){under, over, true, begin, begin + length, {there - begin, up}};
    t->joint[t->all.joints++] =
        (RefJoint){over, under, false, there, there + length, {begin - there, -up}};
}

static inline void make_trousers(double twist, const double cut[3], Trousers *t)
{
    double at = 0;
    *t = (Trousers){.all = {.count = 3}};
    t->all.cylinder = t->cylinder;
    t->all.joint = t->joint;
    for (int c = 0; c < 3; c++) {
        t->cylinder[c] = (RefCylinder){{at, 0}, {at + widths[c], heights[c]}};
        at += widths[c] + 1;
    }
    join(t, 0, 0.5, 1, 0, 2, cut);
    join(t, 0, 2.5, 2, 0, 3, cut);
    join(t, 1, 0.75, 0, twist, 2, cut);
    join(t, 2, 1.25, 0, twist + 2, 3, cut);
}

static inline void random_place(unsigned *seed, const Trousers *t, double theta[2])
{
    const RefCylinder *in = t->cylinder + random_int(seed, 3);
    for (int d = 0; d < 2; d++) theta[d] = random_between(seed, in->low[d], in->high[d]);
}

static inline double factor_even(const void *data, const double theta[2])
{
    (void)data, (void)theta;
    return 1;
}

/* L grows towards a zero as it does on surfaces: 1 / sqrt(distance), here of all of them. */
static inline double factor_of_zeros(const void *data, const double theta[2])
{
    const Trousers *t = data;
    double least = 1;
    int at = ref_cylinders_at(&t->all, theta);
    for (int j = 0; j < t->all.joints; j++) {
        const RefJoint *joint = t->joint + j;
        double side = joint->up ? t->cylinder[at].high[1] : 0;
        if (joint->from != at) continue;
        for (int k = -1; k <= 1; k++)
            least = fmin(least, hypot(theta[0] - joint->begin - k * widths[at], theta[1] - side));
    }
    return 1 / sqrt(fmax(least, 1e-3));
}

static inline RefChart chart_of_trousers(const Trousers *t, bool grows)
{
    return (RefChart){.high = {t->cylinder[2].high[0], heights[0]},
                      .factor = grows ? factor_of_zeros : factor_even,
                      .data = t,
                      .cylinders = &t->all};
}

/* Where a place is when cylinders are cut open elsewhere. */
static inline void move_place(const Trousers *t, const double cut[3], const double from[2],
                              double to[3])
{
    int c = ref_cylinders_at(&t->all, from);
    double low = t->cylinder[c].low[0];
    to[0] = low + wrapped(from[0] - low - cut[c], widths[c]);
    to[1] = from[1];
    to[2] = 0;
}

#endif
