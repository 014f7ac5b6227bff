/* lattice.h - particles at the vertices of material cells, and their one-ring links (fastlsm
 * section 2, "Lattice construction").
 *
 * The material of the lattice is a bitmap over its bounding box with a rank for every word, so a
 * particle's number is found from its coordinates in constant time and the box costs 1.5 bits a
 * site. Particles are numbered canonically (voxel.h). */
#ifndef LSM_LATTICE_H
#define LSM_LATTICE_H

#include <stdint.h>

#include "../../lib/bits.h"
#include "../../lib/voxel/voxel.h"

enum {
    LSM_RING = 27,           /* offsets of a one-ring, itself included */
    LSM_SELF = 13,           /* bit of offset (0,0,0) */
    LSM_FULL = (1 << 27) - 1 /* a particle linked to all of its ring */
};

/* A row of a window: bit a + w for what is at x + a, a from -w to w. */
__extension__ typedef unsigned __int128 LsmRow;

static inline int lsm_row_count(LsmRow row)
{
    return sm_count_bits((uint64_t)row) + sm_count_bits((uint64_t)(row >> 64));
}

/* The first bit of a row that has one. */
static inline int lsm_row_first(LsmRow row)
{
    return (uint64_t)row ? __builtin_ctzll((uint64_t)row)
                         : 64 + __builtin_ctzll((uint64_t)(row >> 64));
}

static inline LsmRow lsm_row_full(int w)
{
    return ((LsmRow)1 << (2 * w + 1)) - 1;
}

typedef struct {
    long count;      /* particles */
    int size[3];     /* lattice vertices along x, y, z */
    int words;       /* words in a row along x */
    uint64_t *bits;  /* [size[2]][size[1]][words], bit set: there is a particle */
    uint32_t *rank;  /* particles before each word */
    int (*coord)[3]; /* [count] lattice coordinates */
    uint32_t *link;  /* [count] bit (dz+1)*9 + (dy+1)*3 + (dx+1): linked to that neighbour */
    double origin[3], cell;
} LsmLattice;

/* Two particles are linked when they share a material cell. The voxels must have been counted.
 * O(words + particles). */
void lsm_lattice_build(const SmVoxels *voxels, LsmLattice *lattice);

/* Only the bitmap and its ranks: enough to find numbers. */
void lsm_lattice_sites(const SmVoxels *voxels, LsmLattice *lattice);
void lsm_lattice_free(LsmLattice *lattice);

/* Unbroken links: pairs of one-ring neighbours. */
long lsm_lattice_links(const LsmLattice *lattice);

/* Breaks the link between particle p and its neighbour at ring offset `bit`, both ways. */
void lsm_lattice_break(LsmLattice *lattice, long p, int bit);

/* Word-parallel access: is there a particle at (x, y, z)? Its number, or -1. */
static inline long lsm_lattice_find(const LsmLattice *l, int x, int y, int z)
{
    if (x < 0 || y < 0 || z < 0 || x >= l->size[0] || y >= l->size[1] || z >= l->size[2]) return -1;
    size_t word =
        ((size_t)z * (size_t)l->size[1] + (size_t)y) * (size_t)l->words + (size_t)(x >> 6);
    uint64_t bits = l->bits[word], bit = (uint64_t)1 << (x & 63);
    if (!(bits & bit)) return -1;
    return (long)l->rank[word] + sm_count_bits(bits & (bit - 1));
}

/* The first particle of plane z, or of the first plane behind it that has one. */
static inline long lsm_lattice_plane(const LsmLattice *l, int z)
{
    return z < l->size[2] ? (long)l->rank[(size_t)z * (size_t)l->size[1] * (size_t)l->words]
                          : l->count;
}

/* Places x - w .. x + w of a bitmap's row (y, z); zero outside the box. */
static inline LsmRow lsm_window(const LsmLattice *l, const uint64_t *bitmap, int x, int y, int z,
                                int w)
{
    if (y < 0 || z < 0 || y >= l->size[1] || z >= l->size[2]) return 0;
    const uint64_t *row = bitmap + ((size_t)z * (size_t)l->size[1] + (size_t)y) * (size_t)l->words;
    int low = x - w, word = low >> 6, shift = low & 63; /* low may be negative: word -1 */
    LsmRow bits = word >= 0 && word < l->words ? row[word] : 0;
    if (word + 1 < l->words) bits |= (LsmRow)row[word + 1] << 64;
    return bits >> shift & lsm_row_full(w);
}

#endif
