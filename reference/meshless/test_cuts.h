/* test_cuts.h - plane cuts, for tests of cracks in solids. */
#ifndef REF_TEST_CUTS_H
#define REF_TEST_CUTS_H

#include "../../lib/vector.h"
#include "body/crack_surface.h"

/* Adds strips of the plane where coordinate `up` is `level` to a cut: along the next axis from
 * `from` to `to`, along the one after it from -0.5 to 1.5 each in one piece. `on`: the first strip
 * begins at the last two vertices that there are. */
static inline void cut_strips(SmCut *cut, int up, double level, double from, double to, int strips,
                              bool on)
{
    int a = (up + 1) % 3, b = (up + 2) % 3, before[2] = {0, 0};
    for (int n = 0; n <= strips; n++) {
        int now[2];
        for (int k = 0; k < 2; k++) {
            double x[3];
            x[up] = level;
            x[a] = from + (to - from) * n / strips;
            x[b] = k ? 1.5 : -0.5;
            now[k] = n == 0 && on ? (int)cut->vertices - 2 + k : (int)sm_cut_vertex(cut, x);
        }
        if (n > 0) {
            sm_cut_triangle(cut, (int[]){before[0], before[1], now[0]});
            sm_cut_triangle(cut, (int[]){before[1], now[1], now[0]});
        }
        memcpy(before, now, sizeof before);
    }
}

static inline void cut_across(SmCut *cut, int up, double level, double from, double to, int strips)
{
    cut_strips(cut, up, level, from, to, strips, false);
}

static inline void cut_on(SmCut *cut, int up, double level, double from, double to, int strips)
{
    cut_strips(cut, up, level, from, to, strips, true);
}

/* A disk of so many sectors. */
static inline void cut_disk(SmCut *cut, const double centre[3], const double normal[3],
                            double radius, int sectors)
{
    double up[3] = {normal[0], normal[1], normal[2]}, u[3], v[3], aside[3] = {1, 0, 0};
    sm_normalize(up);
    sm_cross(up, aside, u);
    sm_normalize(u);
    sm_cross(up, u, v);
    int middle = (int)sm_cut_vertex(cut, centre), first = (int)cut->vertices;
    for (int n = 0; n < sectors; n++) {
        double x[3], angle = 2 * M_PI * n / sectors;
        for (int d = 0; d < 3; d++)
            x[d] = centre[d] + radius * (cos(angle) * u[d] + sin(angle) * v[d]);
        sm_cut_vertex(cut, x);
    }
    for (int n = 0; n < sectors; n++)
        sm_cut_triangle(cut, (int[]){middle, first + n, first + (n + 1) % sectors});
}

#endif
