/* hash.h - short names for bytes (FNV-1a, 64 bits) and for numbers. Whoever means to can find two
 * that are alike. */
#ifndef SM_HASH_H
#define SM_HASH_H

#include <stddef.h>
#include <stdint.h>

#define SM_HASH_START 0xcbf29ce484222325ULL

/* Different numbers get different names, and numbers that are near each other names that are not.
 * Of the multiples of SM_MIX_STEP they are the random numbers of splitmix64 (Steele et al.
 * 2014). */
#define SM_MIX_STEP 0x9e3779b97f4a7c15u
static inline uint64_t sm_mix(uint64_t number)
{
    uint64_t z = number + SM_MIX_STEP;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

/* `hash` of what came before, and then these bytes. */
static inline unsigned long long sm_hash_bytes(unsigned long long hash, const void *data,
                                               size_t size)
{
    const unsigned char *byte = data;
    for (size_t i = 0; i < size; i++) hash = (hash ^ byte[i]) * 0x100000001b3ULL;
    return hash;
}

#endif
