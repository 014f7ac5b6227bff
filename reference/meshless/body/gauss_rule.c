#include "gauss_rule.h"

#include <math.h>

const double ref_gauss_three_at[3] = {-0.38729833462074169, 0, 0.38729833462074169};
const double ref_gauss_three_weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

/* Legendre's polynomial of this order at x, and its slope. */
static long double legendre(int order, long double x, long double *slope)
{
    long double before = 1, now = x;
    for (int k = 2; k <= order; k++) {
        long double next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
        before = now;
        now = next;
    }
    *slope = order * (x * now - before) / (x * x - 1);
    return now;
}

void ref_gauss_rule(int order, double *at, double *weight)
{
    for (int n = 0; n < order; n++) { /* Newton from Tricomi's guess, which doubles digits */
        long double x = -cos(M_PI * (n + 0.75) / (order + 0.5)), slope = 1;
        if (2 * n + 1 == order) x = 0;
        for (int step = 0; step < 6; step++) x -= legendre(order, x, &slope) / slope;
        at[n] = (double)(x / 2);
        weight[n] = (double)(1 / ((1 - x * x) * slope * slope));
    }
}
