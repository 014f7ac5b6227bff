#include "sine.h"

#include <math.h>

/* A quarter turn in three parts, of which the first two have 33 bits each: their products with
 * a whole number below 2^20 are exact (Cody and Waite 1980, as in fdlibm's e_rem_pio2.c). */
static const double quarter[3] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};

/* The angle less `*turns` quarter turns, within an eighth of a turn. */
static double reduce(double angle, int *turns)
{
    double count = rint(angle / M_PI_2);
    *turns = (int)count & 3;
    return angle - count * quarter[0] - count * quarter[1] - count * quarter[2];
}

/* Taylor's series less its first term, as a share of that, by Horner from the term x^`last` on. */
static double series(double x, int last)
{
    double sum = 0;
    for (int n = last; n > 1; n -= 2) sum = -x * x / (n * (n - 1)) * (1 + sum);
    return sum;
}

/* The sine of `x` and so many quarter turns. */
static double turned(double x, int turns)
{
    double value = turns % 2 ? 1 + series(x, 18) : x + x * series(x, 17); /* to 1e-17 */
    return turns & 2 ? -value : value;
}

double sm_sin(double angle)
{
    int turns;
    double x = reduce(angle, &turns);
    return turned(x, turns);
}

double sm_cos(double angle)
{
    int turns;
    double x = reduce(angle, &turns);
    return turned(x, turns + 1);
}
