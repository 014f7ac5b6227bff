#include "positions.h"

#include <math.h>
#include <string.h>

#include "../lib/simd/momentum.h"
#include "body_arrays.h"

/* Sums and counts of a body's coordinates by frame, from its origin, or of `x` from 0. */
static void sum_frames(const Oct *oct, const OctState *b, const double (*x)[3], double (*sum)[4])
{
    memset(sum, 0, (size_t)oct->frames * sizeof *sum);
    for (long leaf = 0; leaf < oct->leaves; leaf++) {
        if (!oct_alive(oct, leaf)) continue;
        double *to = sum[oct->frame ? oct->frame[leaf] : 0];
        for (int d = 0; d < 3; d++) to[d] += x ? x[leaf][d] : (double)b->x[oct_index(leaf, d)];
        to[3]++;
    }
}

void oct_set_positions(Oct *oct, long body, const double (*x)[3])
{
    OctState *b = &oct->body[body];
    sum_frames(oct, b, x, oct->middle);
    for (long f = 0; f < oct->frames; f++)
        for (int d = 0; d < 3; d++) b->origin[f][d] = rint(oct->middle[f][d] / oct->middle[f][3]);
    for (long leaf = 0; leaf < oct->leaves; leaf++)
        for (int d = 0; d < 3 && oct_alive(oct, leaf); d++)
            b->x[oct_index(leaf, d)] = (real)(x[leaf][d] - oct_origin(oct, b, leaf)[d]);
}

/* Slots without a leaf go back to the origin. */
static void shift_leaves(const Oct *oct, OctState *b, const double (*shift)[4])
{
    for (long leaf = 0; leaf < oct->blocks * SM_LANES; leaf++)
        for (int d = 0; d < 3; d++) {
            real *x = &b->x[oct_index(leaf, d)], *v = &b->v[oct_index(leaf, d)];
            if (oct_alive(oct, leaf))
                *x -= (real)shift[oct->frame ? oct->frame[leaf] : 0][d];
            else
                *x = *v = 0;
        }
}

void oct_recentre(Oct *oct)
{
    double farthest = 0;
    for (OctState *b = oct->body; b < oct->body + oct->instances; b++) {
        bool moves = false;
        sum_frames(oct, b, NULL, oct->middle);
        for (long f = 0; f < oct->frames; f++)
            for (int d = 0; d < 3; d++) {
                double middle = rint(oct->middle[f][d] / oct->middle[f][3]);
                middle = fabs(middle) > 4 ? middle : 0; /* a NaN gives 0, too */
                oct->middle[f][d] = middle;
                b->origin[f][d] += middle;
                moves |= middle != 0;
                farthest = fmax(farthest, fabs(middle));
            }
        if (moves) shift_leaves(oct, b, (const double(*)[4])oct->middle);
    }
    long since = oct->steps - oct->recentred;
    oct->recentred = oct->steps;
    oct->recentre = oct->steps + sm_recentre_after(since, farthest);
}
