/* collinear_regions.h - regions whose nodes lie on a line, or that have but one node.
 *
 * Around the line every rotation is as good as another, so each step would be a tie for the
 * polar decomposition to mend one by one. What they are is known beforehand: their rotation is the
 * last one, turned the shortest way so that it takes the line where A takes it. */
#ifndef OCT_COLLINEAR_REGIONS_H
#define OCT_COLLINEAR_REGIONS_H

#include "../lib/simd/rotate_lanes.h"
#include "state.h"

SM_INLINE void lanes_cross(const vec a[3], const vec b[3], vec c[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        c[i] = a[j] * b[k] - a[k] * b[j];
    }
}

/* Puts that rotation in the place of A; but for lines turned round in one step, which stay ties. */
static __attribute__((noinline, unused)) void collinear_rotations(const OctCollinear *collinear,
                                                                  const short *last, vec A[9])
{
    vec R[9], from[3], to[3], turn[3];
    last_load(last, R);
    for (int i = 0; i < 3; i++) {
        from[i] = to[i] = lanes_set(0);
        for (int d = 0; d < 3; d++) {
            from[i] += R[i * 3 + d] * collinear->axis[d];
            to[i] += A[i * 3 + d] * collinear->axis[d];
        }
    }
    vec square = lanes_dot(to, to);
    ivec turns = square > (real)1e-30;
    vec inverse = 1 / lanes_sqrt(lanes_select(turns, square, lanes_set(1)));
    for (int i = 0; i < 3; i++) to[i] = lanes_select(turns, to[i] * inverse, from[i]);
    lanes_cross(from, to, turn);
    vec cosine = lanes_dot(from, to);
    ivec good = collinear->lanes & (cosine > (real)-0.999);
    vec share = 1 / lanes_select(good, 1 + cosine, lanes_set(1));
    for (int d = 0; d < 3; d++) {
        vec column[3] = {R[d], R[3 + d], R[6 + d]}, once[3], twice[3];
        lanes_cross(turn, column, once);
        lanes_cross(turn, once, twice);
        for (int i = 0; i < 3; i++)
            A[i * 3 + d] = lanes_select(good, column[i] + once[i] + share * twice[i], A[i * 3 + d]);
    }
}

#endif
