#include "ray_vote.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../bits.h"

/* Rays along one axis through the centres of the cells; u and v are the other two axes, and x is
 * u unless it is the axis, so that rays lie in words as rows do. */
typedef struct {
    const SmVoxels *lattice;
    int axis, u, v;
    int words;        /* of a row of rays along u */
    uint64_t *toggle; /* as lattice->bits: a crossing just before the centre of this cell */
    uint64_t *odd;    /* [size[v]][words]: rays that cross an odd number of times */
    uint64_t *hit;    /* [size[v]][words]: rays that cross */
} Rays;

typedef struct {
    double u, depth;
} Crossing;

/* First cell whose centre is beyond x. */
static inline int beyond(double x, int n)
{
    double cell = floor(x + 0.5);
    if (!(cell > 0)) return 0;
    return cell < n ? (int)cell : n;
}

static void cross(Rays *r, int iu, int iv, double depth)
{
    size_t ray = (size_t)iv * (size_t)r->words + (size_t)(iu >> 6);
    r->odd[ray] ^= (uint64_t)1 << (iu & 63);
    r->hit[ray] |= (uint64_t)1 << (iu & 63);
    int at[3];
    at[r->u] = iu;
    at[r->v] = iv;
    at[r->axis] = beyond(depth, r->lattice->size[r->axis]);
    if (at[r->axis] == r->lattice->size[r->axis]) return;
    size_t row = sm_voxels_row(r->lattice, at[1], at[2]);
    r->toggle[row + (size_t)(at[0] >> 6)] ^= (uint64_t)1 << (at[0] & 63);
}

/* Where the edge a-b meets the line v = c; the same bits whichever way round the edge is given, so
 * that no ray slips between two triangles. */
static Crossing meet(const Rays *r, const double *a, const double *b, double c)
{
    if (a[r->v] > b[r->v]) {
        const double *swap = a;
        a = b;
        b = swap;
    }
    double t = (c - a[r->v]) / (b[r->v] - a[r->v]);
    return (Crossing){a[r->u] + t * (b[r->u] - a[r->u]),
                      a[r->axis] + t * (b[r->axis] - a[r->axis])};
}

/* The rays of line iv that pass between the two edges where the triangle meets it. */
static void cross_line(Rays *r, const double *corner[3], int iv)
{
    double c = iv + 0.5;
    Crossing end[2];
    int ends = 0;
    for (int e = 0; e < 3; e++) {
        const double *a = corner[e], *b = corner[(e + 1) % 3];
        if ((a[r->v] <= c) != (b[r->v] <= c)) end[ends++] = meet(r, a, b, c);
    }
    if (ends < 2) return;
    if (end[0].u > end[1].u) {
        Crossing swap = end[0];
        end[0] = end[1];
        end[1] = swap;
    }
    int n = r->lattice->size[r->u], first = beyond(end[0].u, n), last = beyond(end[1].u, n);
    for (int iu = first; iu < last; iu++) {
        double t = (iu + 0.5 - end[0].u) / (end[1].u - end[0].u);
        cross(r, iu, iv, end[0].depth + t * (end[1].depth - end[0].depth));
    }
}

static void cast(Rays *r, const SmMesh *mesh, const double (*point)[3])
{
    for (long t = 0; t < mesh->triangle_count; t++) {
        const int *index = mesh->triangle[t];
        const double *corner[3] = {point[index[0]], point[index[1]], point[index[2]]};
        double low = corner[0][r->v], high = low;
        for (int c = 1; c < 3; c++) {
            low = corner[c][r->v] < low ? corner[c][r->v] : low;
            high = corner[c][r->v] > high ? corner[c][r->v] : high;
        }
        int last = beyond(high, r->lattice->size[r->v]);
        for (int iv = beyond(low, r->lattice->size[r->v]); iv < last; iv++)
            cross_line(r, corner, iv);
    }
}

static bool trusted(const Rays *r)
{
    long odd = 0, hit = 0;
    for (size_t w = 0; w < (size_t)r->lattice->size[r->v] * (size_t)r->words; w++) {
        odd += sm_count_bits(r->odd[w]);
        hit += sm_count_bits(r->hit[w]);
    }
    return hit > 0 && odd * 4 <= hit;
}

/* Bit i becomes the parity of bits 0..i and of the word before, whose last bit fills `carry`. */
static uint64_t parity(uint64_t word, uint64_t *carry)
{
    for (int step = 1; step < 64; step *= 2) word ^= word << step;
    word ^= *carry;
    *carry = (uint64_t)0 - (word >> 63);
    return word;
}

/* Turns the toggles of row (j, k) into what its rays say, given the row before along the axis. */
static void read_row(Rays *r, int j, int k)
{
    const int *size = r->lattice->size;
    size_t words = (size_t)r->lattice->words, row = sm_voxels_row(r->lattice, j, k);
    uint64_t *toggle = r->toggle + row, carry = 0;
    if (r->axis == 0) {
        for (size_t w = 0; w < words; w++) toggle[w] = parity(toggle[w], &carry);
        return;
    }
    if ((r->axis == 1 ? j : k) == 0) return;
    const uint64_t *before = toggle - (r->axis == 1 ? words : words * (size_t)size[1]);
    for (size_t w = 0; w < words; w++) toggle[w] ^= before[w];
}

/* Adds the axis's votes: `one` holds the cells with a vote, `two` those with two or more. */
static void count_votes(Rays *r, uint64_t *one, uint64_t *two)
{
    const int *size = r->lattice->size;
    size_t words = (size_t)r->lattice->words, row = 0;
    for (int k = 0; k < size[2]; k++)
        for (int j = 0; j < size[1]; j++) read_row(r, j, k);
    for (int k = 0; k < size[2]; k++)
        for (int j = 0; j < size[1]; j++, row += words) {
            const uint64_t *odd = r->odd + (size_t)(r->axis == 2 ? j : k) * (size_t)r->words;
            uint64_t whole = r->axis == 0 ? (uint64_t)0 - (odd[j >> 6] >> (j & 63) & 1) : 0;
            for (size_t w = 0; w < words; w++) {
                uint64_t abstain = r->axis == 0 ? whole : odd[w];
                uint64_t vote = r->toggle[row + w] & ~abstain;
                two[row + w] |= one[row + w] & vote;
                one[row + w] |= vote;
            }
        }
}

static bool poll_axis(const SmMesh *mesh, const double (*point)[3], Rays *r, uint64_t *one,
                      uint64_t *two)
{
    const int *size = r->lattice->size;
    r->u = r->axis == 0 ? 1 : 0;
    r->v = r->axis == 2 ? 1 : 2;
    r->words = (size[r->u] - 1) / 64 + 1;
    size_t rays = (size_t)size[r->v] * (size_t)r->words;
    r->odd = sm_alloc(rays, sizeof(uint64_t));
    r->hit = sm_alloc(rays, sizeof(uint64_t));
    memset(r->toggle, 0, sm_voxels_words(r->lattice) * sizeof *r->toggle);
    cast(r, mesh, point);
    bool counts = trusted(r);
    if (counts) count_votes(r, one, two);
    free(r->odd);
    free(r->hit);
    return counts;
}

int sm_ray_vote(const SmMesh *mesh, const double (*point)[3], SmVoxels *voxels)
{
    size_t words = sm_voxels_words(voxels);
    uint64_t *one = sm_alloc(words, sizeof(uint64_t)), *two = sm_alloc(words, sizeof(uint64_t));
    Rays rays = {.lattice = voxels, .toggle = sm_alloc(words, sizeof(uint64_t))};
    int axes = 0;
    for (rays.axis = 0; rays.axis < 3; rays.axis++) axes += poll_axis(mesh, point, &rays, one, two);
    for (size_t w = 0; w < words; w++) voxels->bits[w] |= two[w];
    sm_free_all(rays.toggle, one, two);
    return axes;
}
