#include "region.h"

#include <stdlib.h>
#include <string.h>

#include "../../lib/system/team.h"

/* Bit set in `out` where the bits at and beside it along x are set in `in`. */
static void erode_x(const uint64_t *in, uint64_t *out, int words)
{
    for (int i = 0; i < words; i++) {
        uint64_t left = in[i] << 1 | (i ? in[i - 1] >> 63 : 0);
        uint64_t right = in[i] >> 1 | (i + 1 < words ? in[i + 1] << 63 : 0);
        out[i] = in[i] & left & right;
    }
}

/* One erosion by the 3x3x3 box: along x into `scratch`, then the nine rows around each row. */
static void erode(const LsmLattice *l, uint64_t *bitmap, uint64_t *scratch)
{
    int ny = l->size[1], nz = l->size[2], words = l->words;
#pragma omp parallel for schedule(static) num_threads(sm_team_for((long)ny *nz *words))
    for (long row = 0; row < (long)ny * nz; row++)
        erode_x(bitmap + row * words, scratch + row * words, words);
#pragma omp parallel for schedule(static) num_threads(sm_team_for((long)ny *nz *words))
    for (int z = 0; z < nz; z++)
        for (int y = 0; y < ny; y++) {
            uint64_t *out = bitmap + ((long)z * ny + y) * words;
            bool inside = y > 0 && z > 0 && y + 1 < ny && z + 1 < nz;
            memset(out, inside ? 255 : 0, (size_t)words * sizeof *out);
            for (int dz = -1; inside && dz <= 1; dz++)
                for (int dy = -1; dy <= 1; dy++) {
                    const uint64_t *in = scratch + ((long)(z + dz) * ny + y + dy) * words;
                    for (int i = 0; i < words; i++) out[i] &= in[i];
                }
        }
}

/* Particles there are in the ring around `c`, itself included. */
static int ring_count(const LsmLattice *l, const int c[3])
{
    int count = 0;
    for (int row = 0; row < 9; row++)
        count +=
            lsm_row_count(lsm_window(l, l->bits, c[0], c[1] + row % 3 - 1, c[2] + row / 3 - 1, 1));
    return count;
}

/* Which particles of a word are linked to all of their ring, and which of these have a whole one.
 */
static void find_complete(const LsmLattice *l, size_t word, uint64_t *complete, uint64_t *whole)
{
    long p = l->rank[word];
    for (uint64_t rest = l->bits[word]; rest; rest &= rest - 1, p++) {
        uint64_t bit = rest & -rest;
        bool full = l->link[p] == LSM_FULL;
        if (full) *whole |= bit;
        if (full || sm_count_bits(l->link[p]) == ring_count(l, l->coord[p])) *complete |= bit;
    }
}

void lsm_interior_build(const LsmLattice *l, int w, LsmInterior *interior)
{
    size_t words = (size_t)l->size[1] * (size_t)l->size[2] * (size_t)l->words;
    interior->w = w;
    interior->complete = sm_alloc(words, sizeof(uint64_t));
    interior->interior = sm_alloc(words, sizeof(uint64_t));
#pragma omp parallel for schedule(static) num_threads(sm_team_for(l->count))
    for (size_t word = 0; word < words; word++)
        find_complete(l, word, &interior->complete[word], &interior->interior[word]);
    if (w == 1) return;
    uint64_t *scratch = sm_alloc(words, sizeof(uint64_t));
    for (int step = 1; step < w; step++) erode(l, interior->interior, scratch);
    free(scratch);
}

void lsm_interior_free(LsmInterior *interior)
{
    free(interior->complete);
    free(interior->interior);
    memset(interior, 0, sizeof *interior);
}

/* Windows up to 63 wide have rows of one word: with two the search takes half as long again. */
#define Row         uint64_t
#define SIDE        63
#define NAMED(name) name##_narrow
#include "region_search.h"
#undef Row
#undef SIDE
#undef NAMED
#define Row         LsmRow
#define SIDE        LSM_MAX_SIDE
#define NAMED(name) name##_wide
#include "region_search.h"

int lsm_region_find(const LsmLattice *l, const LsmInterior *interior, long r, LsmRow *rows,
                    bool *simple)
{
    int w = interior->w, area = (2 * w + 1) * (2 * w + 1);
    if (!lsm_bit(l, interior->interior, l->coord[r]))
        return (2 * w + 1 > 63 ? find_wide : find_narrow)(l, interior, r, rows, simple);
    *simple = true;
    for (int row = 0; row < area; row++) rows[row] = lsm_row_full(w);
    return (2 * w + 1) * area;
}

int lsm_region_rows(const LsmLattice *l, const LsmInterior *interior, long r, LsmRow *rows)
{
    bool simple;
    return lsm_region_find(l, interior, r, rows, &simple);
}

static uint64_t mix(uint64_t h) /* the finaliser of MurmurHash3 */
{
    h ^= h >> 33;
    h *= 0xff51afd7ed558ccdull;
    h ^= h >> 33;
    h *= 0xc4ceb9fe1a85ec53ull;
    return h ^ h >> 33;
}

LsmKey lsm_region_key(const LsmLattice *l, int w, long r, const LsmRow *rows)
{
    const int *c = l->coord[r];
    int side = 2 * w + 1;
    LsmKey key = {0, 0};
    for (int row = 0, next; row < side * side; row = next) {
        next = row + 1;
        if (!rows[row]) continue;
        while (next % side && rows[next] == rows[row]) next++; /* equal rows along y go together */
        int low = lsm_row_first(rows[row]);
        uint64_t place = ((uint64_t)(c[2] + row / side) << 42) ^
                         ((uint64_t)(c[1] + row % side) << 21) ^ (uint64_t)(c[0] + low);
        LsmRow bits = rows[row] >> low;
        uint64_t h = mix(mix(place) ^ (uint64_t)bits);
        h = mix(h + (uint64_t)(next - row) + ((uint64_t)(bits >> 64) << 32));
        key.low += h;
        key.high += mix(h ^ 0x9e3779b97f4a7c15ull);
    }
    return key;
}
