/* The flood fill by words, against one of single cells. */
#include "flood.h"

#include "../test_frame.h"
#include "../test_random.h"

static unsigned seed = 1;

/* One cell at a time: what a flood fill is. */
static void plain_flood(const SmVoxels *v, SmVoxels *result)
{
    int nx = v->size[0] + 2, ny = v->size[1] + 2, nz = v->size[2] + 2, count = 0;
    bool *seen = sm_alloc((size_t)nx * (size_t)ny * (size_t)nz, sizeof *seen);
    int *stack = sm_alloc((size_t)nx * (size_t)ny * (size_t)nz, sizeof *stack);
    seen[0] = true;
    stack[count++] = 0;
    while (count) {
        int at = stack[--count], x = at % nx, y = at / nx % ny, z = at / nx / ny;
        for (int s = 0; s < 6; s++) {
            int step = s % 2 ? 1 : -1, i = x + (s / 2 == 0) * step, j = y + (s / 2 == 1) * step;
            int k = z + (s / 2 == 2) * step, to = (k * ny + j) * nx + i;
            if (i < 0 || j < 0 || k < 0 || i >= nx || j >= ny || k >= nz || seen[to]) continue;
            if (sm_voxel_get(v, i - 1, j - 1, k - 1)) continue;
            seen[to] = true;
            stack[count++] = to;
        }
    }
    for (int k = 0; k < v->size[2]; k++)
        for (int j = 0; j < v->size[1]; j++)
            for (int i = 0; i < v->size[0]; i++)
                if (!seen[((k + 1) * ny + j + 1) * nx + i + 1]) sm_voxel_set(result, i, j, k);
    free(seen);
    free(stack);
}

TEST(flood_fills_like_a_flood_of_single_cells)
{
    const int widths[] = {1, 3, 20, 63, 64, 65, 128, 130};
    for (int trial = 0; trial < 240; trial++) {
        int nx = widths[trial % 8], ny = 1 + random_int(&seed, 14), nz = 1 + random_int(&seed, 14);
        SmVoxels v, plain;
        sm_voxels_init(&v, nx, ny, nz, 1);
        sm_voxels_init(&plain, nx, ny, nz, 1);
        int percent = 20 + random_int(&seed, 60);
        for (int k = 0; k < nz; k++)
            for (int j = 0; j < ny; j++)
                for (int i = 0; i < nx; i++)
                    if (random_int(&seed, 100) < percent) sm_voxel_set(&v, i, j, k);
        plain_flood(&v, &plain);
        sm_flood_inside(&v);
        size_t words = (size_t)v.words * (size_t)ny * (size_t)nz;
        assert_memory_equal(v.bits, plain.bits, words * sizeof *v.bits);
        sm_voxels_free(&v);
        sm_voxels_free(&plain);
    }
}
