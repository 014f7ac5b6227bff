/* test_draw.h - numbers drawn at random, the same in every run of a test. */
#ifndef SM_TEST_DRAW_H
#define SM_TEST_DRAW_H

#include <stdint.h>

static uint32_t seed = 1;

static inline uint32_t draw(void)
{
    seed = seed * 1664525u + 1013904223u;
    return seed >> 8;
}

static inline double uniform(double low, double high)
{
    return low + (high - low) * draw() / 16777216.0;
}

#endif
