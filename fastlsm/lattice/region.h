/* region.h - which particles a region holds (fastlsm section 2, "Shape matching regions").
 *
 * Region r is every particle that at most w one-ring steps reach from r: never across a gap, a
 * broken link, or round a corner too far. It is kept as bit rows in the window of half-width w
 * around r: row (c + w) * (2w+1) + b + w holds bit a + w for member r + (a, b, c). */
#ifndef LSM_REGION_H
#define LSM_REGION_H

#include "../../lib/engine/engine.h"
#include "lattice.h"

enum { LSM_MAX_W = SM_MOST_W, LSM_MAX_SIDE = 2 * LSM_MAX_W + 1 };

/* Bitmaps in the lattice's layout, rebuilt when links break. */
typedef struct {
    int w;
    uint64_t *complete; /* particles linked to every particle of their ring */
    uint64_t *interior; /* particles whose region is the whole cube of side 2w+1 */
} LsmInterior;

/* O(w words). */
void lsm_interior_build(const LsmLattice *lattice, int w, LsmInterior *interior);
void lsm_interior_free(LsmInterior *interior);

static inline bool lsm_bit(const LsmLattice *l, const uint64_t *bitmap, const int c[3])
{
    size_t word =
        ((size_t)c[2] * (size_t)l->size[1] + (size_t)c[1]) * (size_t)l->words + (size_t)(c[0] >> 6);
    return bitmap[word] >> (c[0] & 63) & 1;
}

/* Rows of particle r's region, by breadth-first search. `rows` is [(2w+1)^2]. Returns how many
 * members it has. O(w^2) for an interior particle, O(w^3) else. */
int lsm_region_rows(const LsmLattice *lattice, const LsmInterior *interior, long r, LsmRow *rows);

/* The same. `simple`: all material of the window is in reach and fills a box. */
int lsm_region_find(const LsmLattice *lattice, const LsmInterior *interior, long r, LsmRow *rows,
                    bool *simple);

/* 128 bits that two regions share exactly when they hold the same particles (but for a chance of
 * about 1e-20): the key to collapse unique regions. */
typedef struct {
    uint64_t low, high;
} LsmKey;
LsmKey lsm_region_key(const LsmLattice *lattice, int w, long r, const LsmRow *rows);

#endif
