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
            sm_count_bits(lsm_window(l, l->bits, c[0], c[1] + row % 3 - 1, c[2] + row / 3 - 1, 1));
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

/* Adds the ring of one particle at window place (a, b, c) to `next`. */
static void add_ring(uint32_t link, int a, long row, int side, uint64_t *next)
{
    for (int ring = 0; ring < 9; ring++) {
        uint64_t three = link >> (3 * ring) & 7;
        next[row + (ring / 3 - 1) * side + ring % 3 - 1] |= three << (a - 1);
    }
}

/* One breadth-first step from `front`, whose members lie within `reach` of the centre. Particles
 * linked to all of their ring spread word-parallel, also to where there is no particle; the others
 * link by link. */
static void spread(const LsmLattice *l, const uint64_t *complete, const int centre[3], int w,
                   int reach, const uint64_t *front, uint64_t *next)
{
    int side = 2 * w + 1;
    for (int c = -reach; c <= reach; c++)
        for (int b = -reach; b <= reach; b++) {
            long row = (long)(c + w) * side + b + w;
            if (!front[row]) continue;
            uint64_t whole =
                front[row] & lsm_window(l, complete, centre[0], centre[1] + b, centre[2] + c, w);
            if (whole)
                for (int ring = 0; ring < 9; ring++)
                    next[row + (ring / 3 - 1) * side + ring % 3 - 1] |=
                        whole << 1 | whole | whole >> 1;
            for (uint64_t rest = front[row] & ~whole; rest; rest &= rest - 1) {
                int a = __builtin_ctzll(rest);
                long p = lsm_lattice_find(l, centre[0] + a - w, centre[1] + b, centre[2] + c);
                add_ring(l->link[p], a, row, side, next);
            }
        }
}

/* Is the material of the window one box without a broken or missing link? Then all of it is within
 * reach: this is the usual case at the faces, edges and corners of a solid. */
static bool one_box(const LsmLattice *l, const LsmInterior *interior, const int centre[3],
                    const uint64_t *material)
{
    int w = interior->w, side = 2 * w + 1, low[2] = {side, side}, high[2] = {-1, -1}, filled = 0;
    uint64_t run = material[w * side + w], ends = run & -run;
    if (run & (run + ends)) return false; /* more than one run */
    for (int row = 0; row < side * side; row++) {
        if (!material[row]) continue;
        int at[2] = {row % side, row / side};
        if (material[row] != run) return false;
        if (lsm_window(l, interior->complete, centre[0], centre[1] + at[0] - w,
                       centre[2] + at[1] - w, w) != run)
            return false;
        for (int d = 0; d < 2; d++) {
            low[d] = at[d] < low[d] ? at[d] : low[d];
            high[d] = at[d] > high[d] ? at[d] : high[d];
        }
        filled++;
    }
    return filled == (high[0] - low[0] + 1) * (high[1] - low[1] + 1);
}

static void search(const LsmLattice *l, const LsmInterior *interior, const int centre[3],
                   const uint64_t *material, uint64_t *rows)
{
    int w = interior->w, side = 2 * w + 1, area = side * side;
    uint64_t front[LSM_MAX_SIDE * LSM_MAX_SIDE], next[LSM_MAX_SIDE * LSM_MAX_SIDE];
    memset(rows, 0, (size_t)area * sizeof *rows);
    memset(front, 0, (size_t)area * sizeof *front);
    front[w * side + w] = rows[w * side + w] = (uint64_t)1 << w;
    for (int step = 0; step < w; step++) {
        memset(next, 0, (size_t)area * sizeof *next);
        spread(l, interior->complete, centre, w, step, front, next);
        for (int row = 0; row < area; row++) {
            front[row] = next[row] & material[row] & ~rows[row];
            rows[row] |= front[row];
        }
    }
}

int lsm_region_find(const LsmLattice *l, const LsmInterior *interior, long r, uint64_t *rows,
                    bool *simple)
{
    int w = interior->w, side = 2 * w + 1, area = side * side, count = 0;
    const int *centre = l->coord[r];
    *simple = true;
    if (lsm_bit(l, interior->interior, centre)) {
        for (int row = 0; row < area; row++) rows[row] = ((uint64_t)1 << side) - 1;
        return side * area;
    }
    uint64_t material[LSM_MAX_SIDE * LSM_MAX_SIDE];
    memset(material, 0, (size_t)area * sizeof *material);
    for (int row = 0; row < area; row++)
        material[row] = lsm_window(l, l->bits, centre[0], centre[1] + row % side - w,
                                   centre[2] + row / side - w, w);
    *simple = one_box(l, interior, centre, material);
    if (*simple)
        memcpy(rows, material, (size_t)area * sizeof *rows);
    else
        search(l, interior, centre, material, rows);
    for (int row = 0; row < area; row++) count += sm_count_bits(rows[row]);
    return count;
}

int lsm_region_rows(const LsmLattice *l, const LsmInterior *interior, long r, uint64_t *rows)
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

LsmKey lsm_region_key(const LsmLattice *l, int w, long r, const uint64_t *rows)
{
    const int *c = l->coord[r];
    int side = 2 * w + 1;
    LsmKey key = {0, 0};
    for (int row = 0, next; row < side * side; row = next) {
        next = row + 1;
        if (!rows[row]) continue;
        while (next % side && rows[next] == rows[row]) next++; /* equal rows along y go together */
        int low = __builtin_ctzll(rows[row]);
        uint64_t place = ((uint64_t)(c[2] + row / side) << 42) ^
                         ((uint64_t)(c[1] + row % side) << 21) ^ (uint64_t)(c[0] + low);
        uint64_t h = mix(mix(place) ^ rows[row] >> low);
        h = mix(h + (uint64_t)(next - row));
        key.low += h;
        key.high += mix(h ^ 0x9e3779b97f4a7c15ull);
    }
    return key;
}
