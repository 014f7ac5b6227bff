#include "base_grid.h"

#include <stdlib.h>
#include <string.h>

/* Base cells along an axis that begin `shift` before the first finest cell. */
static int bases(int cells, int shift, int levels)
{
    return ((cells + shift - 1) >> levels) + 1;
}

/* ORs the rows of every slab of base cells along z: from [z][y][words] to [slab][y][words]. */
static void merge(const uint64_t *from, long count, long row, int shift, int levels, uint64_t *to)
{
    for (long z = 0; z < count; z++) {
        uint64_t *slab = to + ((z + shift) >> levels) * row;
        for (long w = 0; w < row; w++) slab[w] |= from[z * row + w];
    }
}

/* Base cells along x that hold a set bit. */
static long count_row(const uint64_t *row, int words, int shift, int levels)
{
    long count = 0, last = -1;
    for (int w = 0; w < words; w++) {
        uint64_t bits = row[w];
        while (bits) {
            long i = w * 64L + __builtin_ctzll(bits), cell = (i + shift) >> levels;
            count += cell != last;
            last = cell;
            long end = ((cell + 1) << levels) - shift - w * 64L; /* first bit of the next one */
            bits &= end < 64 ? ~0ULL << end : 0;
        }
    }
    return count;
}

typedef struct {
    int levels, step;
    long wanted, off; /* off: distance of the best count from the wanted */
    int count, most;
    int (*corner)[3];
} Search;

static void try_rows(Search *s, const uint64_t *rows, long count, int words, int y, int z)
{
    for (int x = 0; x < 1 << s->levels; x += s->step) {
        long found = 0;
        for (long r = 0; r < count; r++) found += count_row(rows + r * words, words, x, s->levels);
        long off = labs(found - s->wanted);
        if (s->count && off < s->off) s->count = 0;
        if (s->count == s->most || (s->count && off > s->off)) continue;
        s->off = off;
        memcpy(s->corner[s->count++], (int[3]){-x, -y, -z}, sizeof *s->corner);
    }
}

int oct_base_grid_find(const SmVoxels *voxels, int levels, long wanted, int most, int (*corner)[3])
{
    int wide = 1 << levels;
    Search s = {.levels = levels,
                .step = wide > 16 ? wide / 16 : 1,
                .wanted = wanted,
                .most = most,
                .corner = corner};
    size_t words = (size_t)voxels->words, row = words * (size_t)voxels->size[1];
    for (int z = 0; z < wide; z += s.step) {
        long deep = bases(voxels->size[2], z, levels);
        uint64_t *slabs = sm_alloc((size_t)deep * row, sizeof *slabs);
        merge(voxels->bits, voxels->size[2], (long)row, z, levels, slabs);
        for (int y = 0; y < wide; y += s.step) {
            long high = bases(voxels->size[1], y, levels);
            uint64_t *rows = sm_alloc((size_t)(deep * high) * words, sizeof *rows);
            for (long d = 0; d < deep; d++)
                merge(slabs + (size_t)d * row, voxels->size[1], voxels->words, y, levels,
                      rows + (size_t)(d * high) * words);
            try_rows(&s, rows, deep * high, voxels->words, y, z);
            free(rows);
        }
        free(slabs);
    }
    return s.count;
}
