/* bits.h - how many bits of a word are set, where the compiler's own count is a call. */
#ifndef SM_BITS_H
#define SM_BITS_H

#include <stdint.h>

static inline int sm_count_bits(uint64_t word)
{
#if defined(__x86_64__) && !defined(__POPCNT__)
    word -= word >> 1 & 0x5555555555555555u;
    word = (word & 0x3333333333333333u) + (word >> 2 & 0x3333333333333333u);
    word = (word + (word >> 4)) & 0x0f0f0f0f0f0f0f0fu;
    return (int)(word * 0x0101010101010101u >> 56);
#else
    return __builtin_popcountll(word);
#endif
}

#endif
