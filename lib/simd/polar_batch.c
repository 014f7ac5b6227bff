#include "polar_lanes.h"

/* Values of a tile's matrices [SM_LANES][9], and how far rows of 16 reach beyond the last. */
enum { TILE = 9 * SM_LANES, BEYOND = 16 - 9 };

/* Matrices [SM_LANES][9], and BEYOND values that do not matter, to lanes. */
static inline void read_tile(const real *from, vec A[9])
{
    const real *row[SM_LANES];
    vec field[16];
    for (int i = 0; i < SM_LANES; i++) row[i] = from + 9 * i;
    lanes_from_rows(row, field);
    lanes_copy(9, field, A);
}

/* The later parts of rows first: what they leave in the row behind is then written over. */
static inline void write_tile(vec R[9], real *to)
{
    real padded[TILE + BEYOND];
    vec field[16];
    for (int i = 9; i < 16; i++) field[i] = lanes_set(0);
    lanes_copy(9, R, field);
    for (int part = 8 / SM_LANES * SM_LANES; part >= 0; part -= SM_LANES) {
        lanes_interleave(field + part, SM_LANES);
        for (int i = 0; i < SM_LANES; i++) lanes_store(padded + 9 * i + part, field[part + i]);
    }
    memcpy(to, padded, TILE * sizeof *to);
}

/* Ties are rare. */
static __attribute__((noinline)) void mend(const vec *A, unsigned tie, const real *last, vec *R)
{
    vec before[9];
    for (int i = 0; i < 9; i++) before[i] = lanes_set(i % 4 == 0);
    for (int i = 0; last && i < TILE; i++) before[i % 9][i / 9] = last[i];
    polar_mend(A, tie, before, R);
}

/* Up to POLAR_TILES tiles; behind the last matrix are BEYOND values that may be read. */
SM_INLINE void decompose(int tiles, const real *from, const real *last, real *to)
{
    vec A[POLAR_TILES][9], trace[POLAR_TILES];
    PolarInvariants of[POLAR_TILES];
    unsigned live[POLAR_TILES];
    for (int t = 0; t < tiles; t++) {
        live[t] = LANES_ALL;
        read_tile(from + t * TILE, A[t]);
        polar_invariants(A[t], &of[t]);
    }
    polar_trace(tiles, of, live, trace);
    for (int t = 0; t < tiles; t++) {
        vec R[9];
        unsigned tie = polar_rotation(A[t], &of[t], trace[t], LANES_ALL, POLAR_NARROW, R);
        if (__builtin_expect(tie != 0, 0)) {
            vec copy[9]; /* R stays in registers */
            lanes_copy(9, R, copy);
            mend(A[t], tie, last ? last + t * TILE : NULL, copy);
            lanes_copy(9, copy, R);
        }
        write_tile(R, to + t * TILE);
    }
}

/* The matrices behind the last whole tile of which BEYOND values may be read, made up to a tile
 * by identities. */
static void decompose_rest(long count, const real *from, const real *last, real *to)
{
    real A[TILE + BEYOND] = {0}, R[TILE], before[TILE];
    for (int i = 0; i < TILE; i++) A[i] = before[i] = i % 9 % 4 == 0;
    memcpy(A, from, (size_t)count * 9 * sizeof *A);
    if (last) memcpy(before, last, (size_t)count * 9 * sizeof *before);
    decompose(1, A, before, R);
    memcpy(to, R, (size_t)count * 9 * sizeof *R);
}

static void batch(long count, const real *A, const real *last, real *R)
{
    enum { GROUP = POLAR_TILES * SM_LANES };
    long m = 0;
    for (; m + GROUP < count; m += GROUP)
        decompose(POLAR_TILES, A + m * 9, last ? last + m * 9 : NULL, R + m * 9);
    for (; m < count; m += SM_LANES)
        decompose_rest(count - m < SM_LANES ? count - m : SM_LANES, A + m * 9,
                       last ? last + m * 9 : NULL, R + m * 9);
}

void (*const SM_NAME(sm_polar_batch))(long, const real *, const real *, real *) = batch;
