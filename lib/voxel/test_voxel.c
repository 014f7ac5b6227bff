/* Cells, particles and their numbers. */
#include "voxel.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "../test_draw.h"

static bool is_vertex(const SmVoxels *v, int i, int j, int k)
{
    for (int c = 0; c < 8; c++)
        if (sm_voxel_get(v, i - (c & 1), j - (c >> 1 & 1), k - (c >> 2))) return true;
    return false;
}

/* Every particle in canonical order, against a walk over all vertices. */
static void check_particles(SmVoxels *v)
{
    sm_voxels_count(v);
    int(*coordinate)[3] = sm_alloc((size_t)v->particle_count, sizeof *coordinate);
    sm_voxels_particles(v, coordinate);
    long cells = 0, p = 0;
    for (int k = 0; k <= v->size[2]; k++)
        for (int j = 0; j <= v->size[1]; j++)
            for (int i = 0; i <= v->size[0]; i++) {
                cells += sm_voxel_get(v, i, j, k);
                if (!is_vertex(v, i, j, k)) continue;
                assert_true(p < v->particle_count);
                assert_int_equal(coordinate[p][0], i);
                assert_int_equal(coordinate[p][1], j);
                assert_int_equal(coordinate[p][2], k);
                p++;
            }
    assert_int_equal(cells, v->cell_count);
    assert_int_equal(p, v->particle_count);
    free(coordinate);
}

static void random_cells_have_the_particles_of_a_plain_walk(void **state)
{
    (void)state;
    const int widths[] = {1, 2, 63, 64, 65, 127, 128, 129};
    for (int trial = 0; trial < 160; trial++) {
        SmVoxels v;
        int nx = widths[trial % 8], ny = 1 + (int)(draw() % 5), nz = 1 + (int)(draw() % 5);
        sm_voxels_init(&v, nx, ny, nz, 0.5);
        uint32_t sparse = 1 + draw() % 8;
        for (int k = 0; k < nz; k++)
            for (int j = 0; j < ny; j++)
                for (int i = 0; i < nx; i++)
                    if (draw() % sparse == 0) sm_voxel_set(&v, i, j, k);
        check_particles(&v);
        sm_voxels_free(&v);
        assert_null(v.bits);
    }
}

static void an_empty_lattice_has_no_particles(void **state)
{
    (void)state;
    SmVoxels v;
    sm_voxels_init(&v, 64, 3, 2, 1);
    check_particles(&v);
    assert_int_equal(v.particle_count, 0);
    sm_voxels_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_cells_have_the_particles_of_a_plain_walk),
        cmocka_unit_test(an_empty_lattice_has_no_particles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
