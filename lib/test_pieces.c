/* What hangs together, against a search from every member. */
#include "pieces.h"

#include "cut/cut_surface.h"
#include "mesh/test_piece_sums.h"
#include "test_frame.h"
#include "test_random.h"

static unsigned seed = 1;

enum { NODES = 60 };

/* Reach of all pairs over random links, some nodes absent. */
TEST(random_links_make_the_pieces_that_they_should)
{
    for (int trial = 0; trial < 200; trial++) {
        static bool reach[NODES][NODES];
        unsigned char absent[NODES];
        SmPieces pieces;
        memset(reach, 0, sizeof reach);
        for (int p = 0; p < NODES; p++) absent[p] = random_int(&seed, 5) == 0;
        sm_pieces_init(NODES, &pieces);
        for (int p = 0; p < NODES; p++) reach[p][p] = true;
        for (int n = 0; n < trial % 60; n++) {
            int p = random_int(&seed, NODES), q = random_int(&seed, NODES);
            if (absent[p] || absent[q]) continue;
            reach[p][q] = reach[q][p] = true;
            sm_pieces_link(&pieces, p, q);
        }
        for (int k = 0; k < NODES; k++)
            for (int p = 0; p < NODES; p++)
                for (int q = 0; q < NODES; q++) reach[p][q] |= reach[p][k] && reach[k][q];
        sm_pieces_finish(&pieces, absent, NODES);
        int seen = 0;
        for (int p = 0; p < NODES; p++) {
            assert_int_equal(pieces.piece[p] < 0, absent[p]);
            if (pieces.piece[p] == seen) seen++;
            assert_true(pieces.piece[p] < seen);
            for (int q = 0; q < NODES; q++)
                if (!absent[p] && !absent[q])
                    assert_int_equal(pieces.piece[p] == pieces.piece[q], reach[p][q]);
        }
        assert_int_equal(seen, pieces.count);
        double value[NODES], sum[NODES], all = 0;
        for (int p = 0; p < NODES; p++) value[p] = 1;
        sum_pieces(&pieces, NODES, value, sum);
        for (int n = 0; n < seen; n++) all += sum[n];
        for (int p = 0; p < NODES; p++) all -= !absent[p];
        assert_true(all == 0);
        sm_pieces_free(&pieces);
    }
}

/* A box of 2 x 1 x 1 cut at x = 0.5. */
TEST(a_box_cut_through_has_two_pieces)
{
    static const int face[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                   {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    SmMesh mesh = sm_mesh_new(8, 12);
    for (int i = 0; i < 24; i++)
        mesh.position[i / 3][i % 3] = (i % 3 ? 1 : 2) * (i / 3 >> i % 3 & 1);
    for (int t = 0; t < 12; t++)
        for (int i = 0; i < 3; i++) mesh.triangle[t][i] = face[t / 2][i == 0 ? 0 : t % 2 + i];
    SmCut cut;
    sm_cut_init(&cut, 1);
    for (int n = 0; n < 4; n++)
        sm_cut_vertex(&cut, (double[3]){0.5, n % 2 ? 3 : -1, n / 2 ? 3 : -1});
    sm_cut_triangle(&cut, (int[3]){0, 1, 3});
    sm_cut_triangle(&cut, (int[3]){0, 3, 2});
    assert_int_equal(sm_cut_surface(&mesh, &cut, 0, 0.1), SM_CUT_CLOSED);
    SmPieces pieces;
    sm_mesh_pieces(&mesh, &pieces);
    assert_int_equal(pieces.count, 2);
    double volume[2];
    sum_volumes(&mesh, &pieces, volume);
    assert_true(fabs(fmin(volume[0], volume[1]) - 0.5) < 1e-4);
    assert_true(fabs(fmax(volume[0], volume[1]) - 1.5) < 1e-4);
    sm_pieces_free(&pieces);
    sm_cut_free(&cut);
    sm_mesh_free(&mesh);
}
