/* test_random.h - numbers at random for the tests; the same seed gives the same numbers. */
#ifndef SM_TEST_RANDOM_H
#define SM_TEST_RANDOM_H

#include <stdlib.h>

static inline double random_unit(unsigned *seed) /* 0 to 1 */
{
    return rand_r(seed) / (double)RAND_MAX;
}

static inline double random_between(unsigned *seed, double low, double high)
{
    return low + (high - low) * random_unit(seed);
}

/* From 0 to below - 1. */
static inline int random_int(unsigned *seed, int below)
{
    return (int)(random_unit(seed) * below) % below;
}

#endif
