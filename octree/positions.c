#include "positions.h"

#include <math.h>
#include <string.h>

#include "../lib/simd/momentum.h"
#include "body_arrays.h"

/* The whole cells next to the middle of a body's coordinates, from its origin, or of `x` from 0. */
static void find_middle(const Oct *oct, const OctState *b, const double (*x)[3], double middle[3])
{
    double sum[3] = {0}, count = 0;
    for (long leaf = 0; leaf < oct->leaves; leaf++) {
        if (!oct_alive(oct, leaf)) continue;
        for (int d = 0; d < 3; d++) sum[d] += x ? x[leaf][d] : (double)b->x[oct_index(leaf, d)];
        count++;
    }
    for (int d = 0; d < 3; d++) middle[d] = rint(sum[d] / count);
}

void oct_set_positions(Oct *oct, long body, const double (*x)[3])
{
    OctState *b = &oct->body[body];
    find_middle(oct, b, x, b->origin);
    for (long leaf = 0; leaf < oct->leaves; leaf++)
        for (int d = 0; d < 3 && oct_alive(oct, leaf); d++)
            b->x[oct_index(leaf, d)] = (real)(x[leaf][d] - b->origin[d]);
}

/* Slots without a leaf go back to the origin. */
static void shift_leaves(const Oct *oct, OctState *b, const double shift[3])
{
    for (long leaf = 0; leaf < oct->blocks * SM_LANES; leaf++)
        for (int d = 0; d < 3; d++) {
            real *x = &b->x[oct_index(leaf, d)], *v = &b->v[oct_index(leaf, d)];
            if (oct_alive(oct, leaf))
                *x -= (real)shift[d];
            else
                *x = *v = 0;
        }
}

void oct_recentre(Oct *oct)
{
    double farthest = 0;
    for (OctState *b = oct->body; b < oct->body + oct->instances; b++) {
        double middle[3], most = 0;
        find_middle(oct, b, NULL, middle);
        for (int d = 0; d < 3; d++) {
            middle[d] = fabs(middle[d]) > 4 ? middle[d] : 0; /* a NaN gives 0, too */
            b->origin[d] += middle[d];
            most = fmax(most, fabs(middle[d]));
        }
        if (most > 0) shift_leaves(oct, b, middle);
        farthest = fmax(farthest, most);
    }
    long since = oct->steps - oct->recentred;
    oct->recentred = oct->steps;
    oct->recentre = oct->steps + sm_recentre_after(since, farthest);
}
