/* morton.h - the Morton curve through a lattice of cubes. */
#ifndef SM_MORTON_H
#define SM_MORTON_H

#include <stdint.h>

/* The lowest 21 bits of a coordinate, with two others' places between them. */
static inline uint64_t sm_morton_apart(uint64_t bits)
{
    bits &= 0x1fffff;
    bits = (bits | bits << 32) & 0x1f00000000ffff;
    bits = (bits | bits << 16) & 0x1f0000ff0000ff;
    bits = (bits | bits << 8) & 0x100f00f00f00f00f;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
    return (bits | bits << 2) & 0x1249249249249249;
}

/* The place of a cube along the curve: x, y, z in turn, x in the lowest bit. */
static inline uint64_t sm_morton(uint64_t x, uint64_t y, uint64_t z)
{
    return sm_morton_apart(x) | sm_morton_apart(y) << 1 | sm_morton_apart(z) << 2;
}

#endif
