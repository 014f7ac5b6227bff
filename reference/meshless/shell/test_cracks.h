/* test_cracks.h - cracks that crawl at random, for the tests. */
#ifndef REF_TEST_CRACKS_H
#define REF_TEST_CRACKS_H

#include "../../../lib/test_random.h"
#include "crack.h"

/* Grows an arm straight from its tip by a step at an angle. */
static inline void grow_by(RefCracks *cracks, int arm, double step, double angle)
{
    const double *tip = cracks->arm[arm].tip;
    const double to[2] = {tip[0] + step * cos(angle), tip[1] + step * sin(angle)};
    ref_cracks_grow(cracks, arm, to);
}

/* Crawls: arms that go on by half a cell with a turn, or branch. */
static inline void random_growth(unsigned *seed, RefCracks *cracks, double step)
{
    for (int a = 0, arms = (int)cracks->arms; a < arms; a++) {
        const RefCrackArm arm = cracks->arm[a];
        double angle = atan2(arm.way[1], arm.way[0]) + random_between(seed, -0.5, 0.5);
        if (!arm.open) continue;
        if (random_int(seed, 12) == 0) ref_cracks_end(cracks, a);
        if (random_int(seed, 4) == 0)
            grow_by(cracks, ref_cracks_start(cracks, arm.tip, a), step, angle + 0.9);
        if (cracks->arm[a].open) grow_by(cracks, a, step, angle);
    }
}

/* Two arms that go opposite ways from a place of the chart's rectangle, or of one of them. */
static inline void random_start(unsigned *seed, RefCracks *cracks, double step)
{
    const RefChart *chart = cracks->chart;
    const double *low = chart->low, *high = chart->high;
    double at[2], angle = random_between(seed, 0, 2 * M_PI);
    if (chart->cylinders) {
        const RefCylinder *in =
            chart->cylinders->cylinder + random_int(seed, chart->cylinders->count);
        low = in->low;
        high = in->high;
    }
    for (int d = 0; d < 2; d++) at[d] = random_between(seed, low[d], high[d]);
    for (int k = 0; k < 2; k++)
        grow_by(cracks, ref_cracks_start(cracks, at, -1), step, angle + k * M_PI);
}

#endif
