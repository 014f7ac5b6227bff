/* Cells, particles and their numbers. */
#include "voxel.h"

#include "../test_frame.h"
#include "../test_random.h"

static unsigned seed = 1;

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

TEST(random_cells_have_the_particles_of_a_plain_walk)
{
    const int widths[] = {1, 2, 63, 64, 65, 127, 128, 129};
    for (int trial = 0; trial < 160; trial++) {
        SmVoxels v;
        int nx = widths[trial % 8], ny = 1 + random_int(&seed, 5), nz = 1 + random_int(&seed, 5);
        sm_voxels_init(&v, nx, ny, nz, 0.5);
        int sparse = 1 + random_int(&seed, 8);
        for (int k = 0; k < nz; k++)
            for (int j = 0; j < ny; j++)
                for (int i = 0; i < nx; i++)
                    if (random_int(&seed, sparse) == 0) sm_voxel_set(&v, i, j, k);
        check_particles(&v);
        sm_voxels_free(&v);
        assert_null(v.bits);
    }
}

TEST(an_empty_lattice_has_no_particles)
{
    SmVoxels v;
    sm_voxels_init(&v, 64, 3, 2, 1);
    check_particles(&v);
    assert_int_equal(v.particle_count, 0);
    sm_voxels_free(&v);
}

static double square_to(const double q[3], const int cell[3])
{
    double sum = 0;
    for (int d = 0; d < 3; d++) sum += pow(fmax(fmax(cell[d] - q[d], q[d] - cell[d] - 1), 0), 2);
    return sum;
}

/* From anywhere within the lattice to a few cells that lie far apart. */
TEST(the_nearest_cell_is_that_of_all)
{
    for (int trial = 0; trial < 400; trial++) {
        SmVoxels v;
        int cell[6][3], found[3],
            size[3] = {1 + trial % 40, 1 + random_int(&seed, 40), 1 + trial % 3 * 15};
        double q[3], least = INFINITY;
        bool beside = false; /* a neighbour of q's cell */
        sm_voxels_init(&v, size[0], size[1], size[2], 1);
        for (int d = 0; d < 3; d++) q[d] = random_between(&seed, 0, size[d]);
        for (int n = 0; n < 6; n++) {
            int away = 0;
            for (int d = 0; d < 3; d++) {
                cell[n][d] = random_int(&seed, size[d]);
                away = (int)fmax(away, abs(cell[n][d] - (int)q[d]));
            }
            beside |= away <= 1;
            sm_voxel_set(&v, cell[n][0], cell[n][1], cell[n][2]);
            least = fmin(least, square_to(q, cell[n]));
        }
        sm_nearest_cell(&v, q, found);
        assert_true(sm_voxel_get(&v, found[0], found[1], found[2]));
        assert_true(beside || square_to(q, found) == least);
        sm_voxels_free(&v);
    }
}
