/* Sums over modes, and over the nodes of points, beside themselves one after the other. */
#include "frame_sums.h"

#include "../../../lib/test_frame.h"
#include "../../../lib/test_random.h"

enum { MOST = 70, TRIALS = 40 };

TEST(rows_are_applied_and_added)
{
    unsigned seed = 1;
    static double row[6][MOST], z[MOST], modal[MOST];
    for (int trial = 0; trial < TRIALS; trial++) {
        int modes = 1 + random_int(&seed, MOST), rows = random_int(&seed, 7);
        double *at = row[0], f[3], sum[7], wanted[MOST];
        for (int i = 0; i < 6 * modes; i++) at[i] = random_between(&seed, -1, 1);
        for (int k = 0; k < modes; k++) z[k] = random_between(&seed, -1, 1);
        for (int k = 0; k < modes; k++) modal[k] = random_between(&seed, -1, 1);
        for (int d = 0; d < 3; d++) f[d] = random_between(&seed, -1, 1);
        sum[rows] = 7;
        ref_frame_sums.apply(modes, rows, at, z, sum);
        for (int r = 0; r < rows; r++) {
            double one = 0;
            for (int k = 0; k < modes; k++) one += at[r * modes + k] * z[k];
            assert_true(fabs(sum[r] - one) < 1e-13);
        }
        assert_true(sum[rows] == 7); /* no more than was asked for */
        for (int k = 0; k < modes; k++)
            wanted[k] = modal[k] + f[0] * at[k] + f[1] * at[modes + k] + f[2] * at[2 * modes + k];
        ref_frame_sums.add(modes, f, at, modal);
        for (int k = 0; k < modes; k++) assert_true(fabs(modal[k] - wanted[k]) < 1e-14);
    }
}

TEST(rows_are_squared)
{
    unsigned seed = 2;
    static double row[9][8 * REF_FRAME_TILE], sum[8 * REF_FRAME_TILE * 8 * REF_FRAME_TILE];
    for (int trial = 0; trial < TRIALS; trial++) {
        int rows = 1 + random_int(&seed, 9), columns = REF_FRAME_TILE * (1 + random_int(&seed, 8));
        double *at = row[0];
        for (int i = 0; i < rows * columns; i++) at[i] = random_between(&seed, -1, 1);
        ref_frame_sums.square(rows, columns, at, sum);
        for (int i = 0; i < columns; i++)
            for (int j = i; j < columns; j++) {
                double one = 0;
                for (int r = 0; r < rows; r++) one += at[r * columns + i] * at[r * columns + j];
                assert_true(fabs(sum[i * columns + j] - one) < 1e-13);
            }
    }
}

/* Functions' parts, of which some are one node's, and a field. */
enum { PARTED = 5, FUNCTIONS = 9 };

static int make_parts(unsigned *seed, int node[FUNCTIONS], double part[FUNCTIONS][6])
{
    int count = random_int(seed, FUNCTIONS + 1);
    for (int n = 0; n < count; n++) {
        node[n] = random_int(seed, PARTED);
        for (int m = 0; m < 6; m++) part[n][m] = random_between(seed, -1, 1);
    }
    return count;
}

TEST(parts_of_a_field_are_summed)
{
    unsigned seed = 4;
    for (int trial = 0; trial < TRIALS; trial++) {
        double part[FUNCTIONS][6], u[PARTED][3], sum[3][6];
        int node[FUNCTIONS], count = make_parts(&seed, node, part);
        for (int n = 0; n < 3 * PARTED; n++) u[n / 3][n % 3] = random_between(&seed, -1, 1);
        ref_frame_sums.derive(count, node, (const double(*)[6])part, (const double(*)[3])u, sum);
        for (int m = 0; m < 6; m++)
            for (int d = 0; d < 3; d++) {
                double one = 0;
                for (int n = 0; n < count; n++) one += part[n][m] * u[node[n]][d];
                assert_true(fabs(sum[d][m] - one) < 1e-13);
            }
    }
}

TEST(parts_pull_at_a_field)
{
    unsigned seed = 6;
    for (int trial = 0; trial < TRIALS; trial++) {
        double part[FUNCTIONS][6], times[6][3], force[PARTED][3], wanted[PARTED][3];
        int node[FUNCTIONS], count = make_parts(&seed, node, part);
        for (int k = 0; k < 18; k++) times[k / 3][k % 3] = random_between(&seed, -1, 1);
        for (int n = 0; n < 3 * PARTED; n++)
            force[n / 3][n % 3] = wanted[n / 3][n % 3] = random_between(&seed, -1, 1);
        ref_frame_sums.pull(count, node, (const double(*)[6])part, (const double(*)[3])times,
                            force);
        for (int n = 0; n < count; n++)
            for (int m = 0; m < 6; m++)
                for (int d = 0; d < 3; d++) wanted[node[n]][d] += part[n][m] * times[m][d];
        for (int n = 0; n < 3 * PARTED; n++)
            assert_true(fabs(force[n / 3][n % 3] - wanted[n / 3][n % 3]) < 1e-13);
    }
}

TEST(parts_make_rows_of_strains)
{
    enum { COLUMNS = 3 * REF_FRAME_TILE };
    unsigned seed = 5;
    for (int trial = 0; trial < TRIALS; trial++) {
        double part[FUNCTIONS][6], work[6][REF_FRAME_TILE], wanted[6][3][PARTED] = {{{0}}};
        double row[6 * COLUMNS + REF_FRAME_TILE];
        int node[FUNCTIONS], place[PARTED], count = make_parts(&seed, node, part);
        RefFrameRoot root;
        for (int n = 0; n < PARTED; n++) place[n] = PARTED - 1 - n;
        for (int k = 0; k < 18; k++)
            root.membrane[k / 6][k / 3 % 2][k % 3] = random_between(&seed, -1, 1);
        for (int k = 0; k < 15; k++) root.bending[k / 5][k % 5] = random_between(&seed, -1, 1);
        for (int d = 0; d < 3; d++) root.normal[d] = random_between(&seed, -1, 1);
        ref_frame_sums.root(count, node, place, (const double(*)[6])part, &root, PARTED, work[0],
                            row);
        for (int n = 0; n < count; n++)
            for (int d = 0; d < 3; d++)
                for (int i = 0; i < 3; i++) {
                    int at = place[node[n]];
                    for (int k = 0; k < 2; k++)
                        wanted[i][d][at] += root.membrane[i][k][d] * part[n][1 + k];
                    for (int m = 0; m < 5; m++)
                        wanted[3 + i][d][at] +=
                            root.bending[i][m] * part[n][1 + m] * root.normal[d];
                }
        for (int i = 0; i < 6; i++)
            for (int c = 0; c < 3 * PARTED; c++)
                assert_true(fabs(row[i * ref_frame_columns(3 * PARTED) + c] -
                                 wanted[i][c / PARTED][c % PARTED]) < 1e-13);
    }
}

/* Points of a solid and of a shell in a block of any size: each from its own weights, and none
 * beyond the last. */
TEST(points_are_placed)
{
    enum { NODES = 9, POINTS = 40, LANES = REF_SKIN_LANES, ROOM = (POINTS + LANES - 1) / LANES };
    unsigned seed = 3;
    for (int trial = 0; trial < TRIALS; trial++) {
        static float weight[ROOM * NODES * LANES], lift[POINTS + LANES], near[2 * NODES][3];
        static double u[NODES][3], turned[NODES][3], rest[POINTS][3], x[POINTS + 1][3];
        int node[NODES], points = 1 + random_int(&seed, POINTS),
                         nodes = 1 + random_int(&seed, NODES);
        bool lifted = trial % 2;
        for (int n = 0; n < nodes; n++) {
            node[n] = NODES - 1 - n;
            for (int d = 0; d < 3; d++) u[n + NODES - nodes][d] = random_between(&seed, -1, 1);
            for (int d = 0; d < 3; d++) turned[n + NODES - nodes][d] = random_between(&seed, -1, 1);
        }
        for (int p = 0; p < POINTS; p++) {
            lift[p] = (float)random_between(&seed, -1, 1);
            for (int d = 0; d < 3; d++) rest[p][d] = random_between(&seed, -1, 1);
        }
        for (int w = 0; w < ROOM * NODES * LANES; w++)
            weight[w] = (float)random_between(&seed, -1, 1);
        RefSkinBlock block = {.points = points, .nodes = nodes};
        RefSkin skin = {.count = points,
                        .rest = rest,
                        .node = node,
                        .weight = weight,
                        .lift = lift,
                        .near = near};
        x[points][0] = 7;
        ref_frame_sums.place(&skin, &block, (const double(*)[3])u,
                             lifted ? (const double(*)[3])turned : NULL, x);
        assert_true(x[points][0] == 7);
        for (int p = 0; p < points; p++)
            for (int d = 0; d < 3; d++) {
                double wanted = rest[p][d];
                for (int n = 0; n < nodes; n++)
                    wanted += (double)weight[(p / LANES * nodes + n) * LANES + p % LANES] *
                              (u[node[n]][d] + (lifted ? lift[p] * turned[node[n]][d] : 0));
                assert_true(fabs(x[p][d] - wanted) < 1e-5);
            }
    }
}

/* Of any number of points, from any of the block on; nothing is added to other points'. */
TEST(shared_weights_are_sums_of_parts)
{
    enum { NODES = 9, BLOCK = REF_SKIN_BLOCK };
    unsigned seed = 4;
    for (int trial = 0; trial < TRIALS; trial++) {
        static double part[NODES][6], times[6][REF_SKIN_ROOM];
        static float row[NODES + 1][BLOCK];
        int node[NODES], number[NODES], first = random_int(&seed, BLOCK);
        RefSkinShare share = {.first = first,
                              .points = 1 + random_int(&seed, BLOCK - first),
                              .nodes = 1 + random_int(&seed, NODES),
                              .node = node,
                              .part = (const double(*)[6])part};
        for (int m = 0; m < 6; m++) {
            for (int p = 0; p < BLOCK; p++) times[m][p] = random_between(&seed, -1, 1);
            for (int n = 0; n < NODES; n++) part[n][m] = random_between(&seed, -1, 1);
        }
        for (int n = 0; n <= NODES; n++)
            for (int p = 0; p < BLOCK; p++) row[n][p] = 1;
        for (int n = 0; n < NODES; n++) {
            node[n] = NODES - 1 - n;
            number[node[n]] = (n + trial) % NODES;
        }
        ref_frame_sums.weigh(&share, (const double(*)[REF_SKIN_ROOM])times, number, row[0]);
        for (int n = 0; n <= NODES; n++)
            for (int p = 0; p < BLOCK; p++) {
                double wanted = 1;
                bool in = p >= first && p < first + share.points;
                for (int of = 0; in && of < share.nodes; of++)
                    for (int m = 0; m < 6 && number[node[of]] == n; m++)
                        wanted += times[m][p] * part[of][m];
                assert_true(fabs(row[n][p] - wanted) < (in ? 1e-6 : 0) + 1e-300);
            }
    }
}

TEST(fields_are_summed_with_parts)
{
    enum { NODES = 12, FIELDS = REF_FRAME_SLOPES };
    unsigned seed = 5;
    for (int trial = 0; trial < TRIALS; trial++) {
        static double part[NODES][6], field[NODES][FIELDS], sum[6][FIELDS];
        int node[NODES], count = random_int(&seed, NODES + 1);
        for (int n = 0; n < NODES; n++) {
            node[n] = random_int(&seed, NODES);
            for (int m = 0; m < 6; m++) part[n][m] = random_between(&seed, -1, 1);
            for (int f = 0; f < FIELDS; f++) field[n][f] = random_between(&seed, -1, 1);
        }
        ref_frame_sums.parts(count, node, (const double(*)[6])part, (const double(*)[FIELDS])field,
                             sum);
        for (int m = 0; m < 6; m++)
            for (int f = 0; f < FIELDS; f++) {
                double wanted = 0;
                for (int n = 0; n < count; n++) wanted += part[n][m] * field[node[n]][f];
                assert_true(fabs(sum[m][f] - wanted) < 1e-13);
            }
    }
}
