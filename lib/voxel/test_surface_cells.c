/* The cells that triangles touch, against the separating axis test of every cell. */
#include "surface_cells.h"

#include "../system/team.h"
#include "../test_frame.h"
#include "../test_random.h"
#include "voxelise.h"

static unsigned seed = 1;

/* Separating axes: whether the triangle meets the cube at `low` of edge `edge`. */
static bool meets(double p[3][3], const double low[3], double edge)
{
    double corner[3][3], axis[13][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int c = 0; c < 3; c++)
        for (int d = 0; d < 3; d++) corner[c][d] = p[c][d] - low[d] - edge / 2;
    double side[3][3];
    for (int c = 0; c < 3; c++)
        for (int d = 0; d < 3; d++) side[c][d] = corner[(c + 1) % 3][d] - corner[c][d];
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        axis[3][d] = side[0][e] * side[1][f] - side[0][f] * side[1][e];
        for (int c = 0; c < 3; c++) {
            axis[4 + 3 * c + d][e] = -side[c][f];
            axis[4 + 3 * c + d][f] = side[c][e];
        }
    }
    for (int a = 0; a < 13; a++) {
        double low_dot = INFINITY, high_dot = -INFINITY, reach = 0;
        for (int d = 0; d < 3; d++) reach += fabs(axis[a][d]) * edge / 2;
        for (int c = 0; c < 3; c++) {
            double dot = 0;
            for (int d = 0; d < 3; d++) dot += axis[a][d] * corner[c][d];
            low_dot = fmin(low_dot, dot);
            high_dot = fmax(high_dot, dot);
        }
        if (low_dot > reach || high_dot < -reach) return false;
    }
    return true;
}

/* Every cell met with a margin to spare is set; every cell missed by a margin is not. */
static void check_surface(const SmMesh *m, const SmVoxels *v)
{
    const double margin = 4e-6;
    for (int k = 0; k < v->size[2]; k++)
        for (int j = 0; j < v->size[1]; j++)
            for (int i = 0; i < v->size[0]; i++) {
                bool surely = false, perhaps = false;
                double inner[3] = {i + margin, j + margin, k + margin};
                double outer[3] = {i - margin, j - margin, k - margin};
                for (long t = 0; t < m->triangle_count; t++) {
                    double p[3][3];
                    for (int c = 0; c < 3; c++)
                        for (int d = 0; d < 3; d++)
                            p[c][d] = (m->position[m->triangle[t][c]][d] - v->origin[d]) / v->cell;
                    surely |= meets(p, inner, 1 - 2 * margin);
                    perhaps |= meets(p, outer, 1 + 2 * margin);
                }
                bool set = sm_voxel_get(v, i, j, k);
                if (surely) assert_true(set);
                if (!perhaps) assert_false(set);
            }
}

TEST(random_triangles_mark_what_separating_axes_say)
{
    for (int trial = 0; trial < 600; trial++) {
        int triangles = 1 + random_int(&seed, 4);
        SmMesh m = sm_mesh_new(3L * triangles, triangles);
        double scale = trial % 3 == 0 ? 1.5 : 9, far = trial % 5 == 0 ? 5e6 : 0;
        for (int i = 0; i < 3 * triangles; i++) {
            for (int d = 0; d < 3; d++) {
                m.position[i][d] =
                    far + random_between(&seed, 0, d == trial % 4 ? scale / 3 : scale);
                if (trial % 4 == 0) m.position[i][d] = round(m.position[i][d]);
            }
            m.triangle[i / 3][i % 3] = i;
        }
        if (trial % 11 == 0) memcpy(m.position[1], m.position[0], sizeof m.position[0]);
        m.position[2][0] += 1;
        SmVoxelParams params = {.fill = SM_SHELL, .cell = trial % 2 ? 0.37 : 1};
        SmVoxels v;
        assert_int_equal(sm_voxelise(&m, &params, "test", &v, NULL), SM_OK);
        check_surface(&m, &v);
        sm_voxels_free(&v);
        sm_mesh_free(&m);
    }
}

/* Corners mostly in one cell or two, in lattices of a few: where rows and planes follow each other.
 */
TEST(small_triangles_mark_what_separating_axes_say)
{
    for (int trial = 0; trial < 150; trial++) {
        int triangles = 1 + random_int(&seed, 30);
        SmMesh m = sm_mesh_new(3L * triangles, triangles);
        double size[3], low = trial % 2 ? 0.05 : 0.4;
        for (int d = 0; d < 3; d++) size[d] = 1 + random_int(&seed, 3);
        for (int t = 0; t < triangles; t++) {
            double middle[3], edge = random_between(&seed, low, 1.5);
            for (int d = 0; d < 3; d++) middle[d] = random_between(&seed, 0, size[d]);
            for (int c = 0; c < 3; c++) {
                for (int d = 0; d < 3; d++) {
                    double x = middle[d] + random_between(&seed, -edge, edge);
                    m.position[3 * t + c][d] = fmin(fmax(x, 0), size[d]);
                }
                m.triangle[t][c] = 3 * t + c;
            }
        }
        SmVoxels v;
        sm_voxels_init(&v, (int)size[0], (int)size[1], (int)size[2], 1);
        sm_surface_cells(&m, (const double(*)[3])m.position, &v);
        check_surface(&m, &v);
        sm_voxels_free(&v);
        sm_mesh_free(&m);
    }
}

TEST(threads_mark_the_same_cells)
{
    enum { TRIANGLES = 50000, SIZE = 70 };
    SmMesh m = sm_mesh_new(3L * TRIANGLES, TRIANGLES);
    for (long i = 0; i < 3L * TRIANGLES; i++) {
        for (int d = 0; d < 3; d++)
            m.position[i][d] = i % 3 ? m.position[i / 3 * 3][d] + random_between(&seed, -2, 2)
                                     : random_between(&seed, 2, SIZE - 2);
        m.triangle[i / 3][i % 3] = (int)i;
    }
    SmVoxels v[2];
    for (int k = 0; k < 2; k++) {
        int team = sm_team_enter(k ? 3 : 1);
        sm_voxels_init(&v[k], SIZE, SIZE, SIZE, 1);
        sm_surface_cells(&m, (const double(*)[3])m.position, &v[k]);
        sm_voxels_count(&v[k]);
        sm_team_leave(team);
    }
    assert_int_equal(v[0].particle_count, v[1].particle_count);
    assert_memory_equal(v[0].bits, v[1].bits, sm_voxels_words(&v[0]) * sizeof *v->bits);
    for (int k = 0; k < 2; k++) sm_voxels_free(&v[k]);
    sm_mesh_free(&m);
}
