/* test_piece_sums.h - sums over the members of pieces. */
#ifndef SM_TEST_PIECE_SUMS_H
#define SM_TEST_PIECE_SUMS_H

#include "pieces.h"

/* Sums `value` of all members of every piece into sum[count]: with masses, the pieces' masses. */
static inline void sum_pieces(const SmPieces *pieces, long members, const double *value,
                              double *sum)
{
    for (long n = 0; n < pieces->count; n++) sum[n] = 0;
    for (long p = 0; p < members; p++)
        if (pieces->piece[p] >= 0) sum[pieces->piece[p]] += value[p];
}

#endif
