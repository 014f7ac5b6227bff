/* hash.h - FNV-1a, 64 bits: a short name for bytes. No protection against intent. */
#ifndef SM_HASH_H
#define SM_HASH_H

#include <stddef.h>

#define SM_HASH_START 0xcbf29ce484222325ULL

/* `hash` of what came before, and then these bytes. */
static inline unsigned long long sm_hash_bytes(unsigned long long hash, const void *data,
                                               size_t size)
{
    const unsigned char *byte = data;
    for (size_t i = 0; i < size; i++) hash = (hash ^ byte[i]) * 0x100000001b3ULL;
    return hash;
}

#endif
