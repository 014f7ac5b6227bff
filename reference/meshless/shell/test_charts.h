/* test_charts.h - charts that are formulas, for the tests. */
#ifndef REF_TEST_CHARTS_H
#define REF_TEST_CHARTS_H

#include "../../../lib/test_frame.h"
#include "../../../lib/test_random.h"
#include "quadtree.h"

/* A factor that varies along waves, of whole numbers in a lattice of the periods (side[0], 0) and
 * (skew, side[1]). */
typedef struct {
    double low[2], side[2], skew, depth, phase[3];
    int wave[3][2];
} Waves;

static inline double wavy_factor(const void *data, const double theta[2])
{
    const Waves *waves = data;
    double sum = 0, up = (theta[1] - waves->low[1]) / waves->side[1];
    double share[2] = {(theta[0] - waves->low[0] - up * waves->skew) / waves->side[0], up};
    for (int k = 0; k < 3; k++) {
        double angle = waves->phase[k];
        for (int d = 0; d < 2; d++) angle += 2 * M_PI * waves->wave[k][d] * share[d];
        sum += sin(angle);
    }
    return exp(waves->depth * sum);
}

/* A rectangle of random sides, L between exp(-3 depth) and exp(3 depth). */
static inline RefChart random_chart(unsigned *seed, double depth, bool first, bool second,
                                    Waves *waves)
{
    RefChart chart = {.factor = wavy_factor, .data = waves};
    *waves = (Waves){.depth = depth};
    for (int d = 0; d < 2; d++) {
        waves->low[d] = chart.low[d] = random_between(seed, -1, 1);
        waves->side[d] = random_between(seed, 0.7, 2);
        chart.high[d] = chart.low[d] + waves->side[d];
    }
    for (int k = 0; k < 3; k++) {
        waves->phase[k] = random_between(seed, 0, 6);
        for (int d = 0; d < 2; d++) waves->wave[k][d] = random_int(seed, 3);
    }
    ref_chart_wrap(&chart, first, second);
    return chart;
}

/* A random chart of four rims (0), one or two wraps (1, 2, 3), a skewed torus (4) or two folds (5).
 * What is skewed is so by whole numbers of `across` steps in a side. */
enum { CHART_KINDS = 6 };
static inline RefChart chart_of_kind(unsigned *seed, int kind, int across, double depth,
                                     Waves *waves)
{
    RefChart chart = random_chart(seed, depth, kind & 1, kind & 2, waves);
    double skew = (1 + random_int(seed, across - 1)) * waves->side[0] / across;
    if (kind == 4) {
        waves->skew = skew;
        ref_chart_skew(&chart, skew);
    } else if (kind == 5) { /* even about the first branch point */
        waves->side[1] *= 2;
        waves->skew = 2 * skew;
        for (int k = 0; k < 3; k++) waves->phase[k] = M_PI / 2;
        ref_chart_fold(&chart, waves->low, (double[]){chart.low[0] + skew});
    }
    return chart;
}

static inline RefQuadtree quadtree_of(const RefChart *chart, int across, long wanted)
{
    RefQuadtree tree;
    SmError error = {0};
    if (ref_quadtree_of(chart, across, wanted, &tree, &error) != SM_OK) fail_msg("%s", error.text);
    return tree;
}

#endif
