/* test_random.h - numbers at random for the tests; the same seed gives the same numbers. */
#ifndef SM_TEST_RANDOM_H
#define SM_TEST_RANDOM_H

/* So many bits of the next number. */
static inline unsigned random_bits(unsigned *seed, int bits)
{
    *seed = *seed * 1103515245u + 12345u;
    return *seed >> 16 & ((1u << bits) - 1);
}

/* 0 to 1; the numbers of glibc's rand_r(), with any library. */
static inline double random_unit(unsigned *seed)
{
    unsigned high = random_bits(seed, 11), middle = random_bits(seed, 10);
    return (high << 20 ^ middle << 10 ^ random_bits(seed, 10)) / 2147483647.0;
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
