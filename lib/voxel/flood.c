#include "flood.h"

#include <stdlib.h>

typedef struct {
    const SmVoxels *solid;
    uint64_t *outside;  /* as solid->bits */
    uint64_t *beyond;   /* a row outside the lattice */
    uint64_t *stale;    /* a bit per row: a neighbour has grown */
    uint64_t last_mask; /* cells of the last word of a row */
} Flood;

/* Cells of the runs of ones in `open` that reach up from a seed; a sum carries through a run. */
static inline uint64_t flood_up(uint64_t open, uint64_t seed, unsigned *carry)
{
    uint64_t sum = open + seed;
    unsigned over = sum < open;
    sum += *carry;
    over |= sum < *carry;
    *carry = over;
    return open & (~sum | seed);
}

/* The same downwards, by doubling steps. */
static inline uint64_t flood_down(uint64_t open, uint64_t seed)
{
    for (int step = 1; step < 64; step *= 2) {
        seed |= open & seed >> step;
        open &= open >> step;
    }
    return seed;
}

/* Takes over what the four neighbouring rows know and spreads it along the row. */
static bool grow(const Flood *f, int j, int k)
{
    const int *size = f->solid->size, words = f->solid->words;
    size_t row = sm_voxels_row(f->solid, j, k);
    size_t layer = (size_t)size[1] * (size_t)words;
    const uint64_t *solid = f->solid->bits + row, *beyond = f->beyond;
    uint64_t *out = f->outside + row;
    const uint64_t *side[4] = {j > 0 ? out - words : beyond, j + 1 < size[1] ? out + words : beyond,
                               k > 0 ? out - layer : beyond,
                               k + 1 < size[2] ? out + layer : beyond};
    uint64_t changed = 0;
    unsigned carry = 1;
    for (int w = 0; w < words; w++) {
        uint64_t open = ~solid[w] & (w == words - 1 ? f->last_mask : ~(uint64_t)0);
        uint64_t seed = out[w] | side[0][w] | side[1][w] | side[2][w] | side[3][w];
        uint64_t grown = flood_up(open, seed & open, &carry);
        changed |= grown ^ out[w];
        out[w] = grown;
    }
    uint64_t entry = (f->last_mask >> 1) + 1;
    for (int w = words - 1; w >= 0; w--) {
        uint64_t open = ~solid[w] & (w == words - 1 ? f->last_mask : ~(uint64_t)0);
        uint64_t grown = flood_down(open, out[w] | (open & entry));
        changed |= grown ^ out[w];
        out[w] = grown;
        entry = grown << 63;
    }
    return changed != 0;
}

static void grow_row(Flood *f, size_t row)
{
    size_t rows_in_layer = (size_t)f->solid->size[1];
    int j = (int)(row % rows_in_layer), k = (int)(row / rows_in_layer);
    f->stale[row / 64] &= ~((uint64_t)1 << row % 64);
    if (!grow(f, j, k)) return;
    if (j > 0) f->stale[(row - 1) / 64] |= (uint64_t)1 << (row - 1) % 64;
    if (j + 1 < f->solid->size[1]) f->stale[(row + 1) / 64] |= (uint64_t)1 << (row + 1) % 64;
    size_t below = row - rows_in_layer, above = row + rows_in_layer;
    if (k > 0) f->stale[below / 64] |= (uint64_t)1 << below % 64;
    if (k + 1 < f->solid->size[2]) f->stale[above / 64] |= (uint64_t)1 << above % 64;
}

/* Stale rows forwards, then backwards. Returns whether there was one. */
static bool sweep(Flood *f, size_t words)
{
    bool any = false;
    for (size_t w = 0; w < words; w++)
        while (f->stale[w]) {
            grow_row(f, w * 64 + (size_t)__builtin_ctzll(f->stale[w]));
            any = true;
        }
    for (size_t w = words; w-- > 0;)
        while (f->stale[w]) grow_row(f, w * 64 + 63 - (size_t)__builtin_clzll(f->stale[w]));
    return any;
}

void sm_flood_inside(SmVoxels *voxels)
{
    size_t rows = (size_t)voxels->size[1] * (size_t)voxels->size[2];
    size_t words = (size_t)voxels->words, stale_words = (rows + 63) / 64;
    Flood flood = {.solid = voxels,
                   .outside = sm_alloc(rows * words, sizeof(uint64_t)),
                   .beyond = sm_alloc(words, sizeof(uint64_t)),
                   .stale = sm_alloc(stale_words, sizeof(uint64_t)),
                   .last_mask = ~(uint64_t)0 >> (63 - ((voxels->size[0] - 1) & 63))};
    for (size_t w = 0; w < words; w++) flood.beyond[w] = ~(uint64_t)0;
    for (size_t r = 0; r < rows; r++) flood.stale[r / 64] |= (uint64_t)1 << r % 64;
    while (sweep(&flood, stale_words)) continue;
    for (size_t r = 0; r < rows; r++)
        for (size_t w = 0; w < words; w++) {
            uint64_t cells = w == words - 1 ? flood.last_mask : ~(uint64_t)0;
            voxels->bits[r * words + w] = ~flood.outside[r * words + w] & cells;
        }
    sm_free_all(flood.outside, flood.beyond, flood.stale);
}
