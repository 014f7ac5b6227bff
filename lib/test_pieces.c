/* What hangs together, against a search from every member. */
#include "pieces.h"

#include "test_frame.h"
#include "test_piece_sums.h"
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
