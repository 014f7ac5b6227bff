/* cell_functions.c - compiled as the kernels are, for each instruction set: compilers make vectors
 * of the loops over lanes. */
#include "cell_functions.h"

#include <math.h>
#include <string.h>

#include "../../../lib/simd/real.h"

enum { SIDE = REF_CELL_SIDE, ALL = REF_CELL_LANES, PARTS = REF_CELL_PARTS, LANES = 8, TERMS = 6 };

#define INLINE       static inline __attribute__((always_inline))
#define LANE_BY_LANE for (int l = 0; l < LANES; l++)

static void weigh(const double spline[2][3][SIDE], RefCellNode *node)
{
    static const int order[PARTS][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {0, 2}, {1, 1}};
    for (int k = 0; k < PARTS; k++) {
        const double *along = spline[0][order[k][0]], *across = spline[1][order[k][1]];
        for (int j = 0; j < SIDE; j++)
            for (int i = 0; i < SIDE; i++) node->weight[k][SIDE * j + i] = along[i] * across[j];
    }
}

/* Of a symmetric matrix's lower half. */
INLINE int at(int i, int j)
{
    return i > j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
}

/* The samples first to first + LANES - 1. */
typedef struct {
    double A[PARTS][TERMS * (TERMS + 1) / 2][LANES]; /* moments and their derivatives */
    double L[TERMS * (TERMS + 1) / 2][LANES], inverse[TERMS][LANES]; /* A = L D L^T; of D */
    double gamma[PARTS][TERMS][LANES];
} Work;

/* The basis at a node, as mls.c has it. */
INLINE void basis_at(int terms, int first, const RefCellNode *node, double p[TERMS][LANES])
{
    LANE_BY_LANE p[0][l] = 1;
    for (int d = 0; terms > 1 && d < 2; d++)
        memcpy(p[1 + d], node->way[d] + first, sizeof p[1 + d]);
    for (int i = 1, t = 3; terms > 3 && i <= 2; i++)
        for (int j = i; j <= 2; j++, t++) LANE_BY_LANE p[t][l] = p[i][l] * p[j][l];
}

INLINE void moments(int terms, int first, int count, const RefCellNode *node, Work *work)
{
    memset(work->A, 0, sizeof work->A);
    for (int n = 0; n < count; n++) {
        double p[TERMS][LANES];
        basis_at(terms, first, node + n, p);
        for (int i = 0; i < terms; i++)
            for (int j = 0; j <= i; j++) {
                double square[LANES];
                LANE_BY_LANE square[l] = p[i][l] * p[j][l];
                for (int k = 0; k < PARTS; k++) {
                    double *sum = work->A[k][at(i, j)];
                    const double *w = node[n].weight[k] + first;
                    LANE_BY_LANE sum[l] += w[l] * square[l];
                }
            }
    }
}

INLINE void factorise(int terms, Work *work, double *pivot)
{
    double D[TERMS][LANES];
    LANE_BY_LANE pivot[l] = 1;
    for (int i = 0; i < terms; i++)
        for (int j = 0; j <= i; j++) {
            double *of = work->L[at(i, j)];
            memcpy(of, work->A[0][at(i, j)], sizeof work->L[0]);
            for (int k = 0; k < j; k++) {
                const double *a = work->L[at(i, k)], *b = work->L[at(j, k)];
                LANE_BY_LANE of[l] -= a[l] * b[l] * D[k][l];
            }
            if (i > j) {
                LANE_BY_LANE of[l] *= work->inverse[j][l];
                continue;
            }
            const double *whole = work->A[0][at(i, i)];
            LANE_BY_LANE
            {
                double share = whole[l] > 0 ? of[l] / whole[l] : 0;
                pivot[l] = share >= pivot[l] ? pivot[l] : share; /* NaN, too */
                D[i][l] = of[l];
                work->inverse[i][l] = 1 / of[l];
            }
        }
}

INLINE void solve(int terms, const Work *work, double b[TERMS][LANES])
{
    for (int i = 0; i < terms; i++)
        for (int k = 0; k < i; k++) LANE_BY_LANE b[i][l] -= work->L[at(i, k)][l] * b[k][l];
    for (int i = 0; i < terms; i++) LANE_BY_LANE b[i][l] *= work->inverse[i][l];
    for (int i = terms - 1; i >= 0; i--)
        for (int k = i + 1; k < terms; k++) LANE_BY_LANE b[i][l] -= work->L[at(k, i)][l] * b[k][l];
}

INLINE void subtract_product(int terms, const double A[TERMS * (TERMS + 1) / 2][LANES],
                             const double x[TERMS][LANES], double y[TERMS][LANES])
{
    for (int i = 0; i < terms; i++)
        for (int j = 0; j < terms; j++) LANE_BY_LANE y[i][l] -= A[at(i, j)][l] * x[j][l];
}

/* Which slopes the second derivatives are of, as the numbers of parts. */
static const int second_of[3][2] = {{1, 1}, {2, 2}, {1, 2}};

/* gamma = A^-1 p and its derivatives, as in mls.c. */
INLINE void differentiate(int terms, double scale, Work *work)
{
    static const int square[3] = {3, 5, 4}; /* the terms 11, 22, 12 */
    memset(work->gamma, 0, sizeof work->gamma);
    LANE_BY_LANE work->gamma[0][0][l] = 1;
    solve(terms, work, work->gamma[0]);
    for (int k = 1; k <= 2; k++) {
        LANE_BY_LANE work->gamma[k][k][l] = terms > 1 ? 1 / scale : 0;
        subtract_product(terms, work->A[k], work->gamma[0], work->gamma[k]);
        solve(terms, work, work->gamma[k]);
    }
    for (int m = 0; m < 3; m++) {
        int k = second_of[m][0], o = second_of[m][1];
        if (terms > 3)
            LANE_BY_LANE work->gamma[3 + m][square[m]][l] = (k == o ? 2 : 1) / (scale * scale);
        subtract_product(terms, work->A[3 + m], work->gamma[0], work->gamma[3 + m]);
        subtract_product(terms, work->A[k], work->gamma[o], work->gamma[3 + m]);
        subtract_product(terms, work->A[o], work->gamma[k], work->gamma[3 + m]);
        solve(terms, work, work->gamma[3 + m]);
    }
}

INLINE void take_larger(const double *value, double *most)
{
    LANE_BY_LANE most[l] = fabs(value[l]) > most[l] ? fabs(value[l]) : most[l];
}

/* phi_I = w_I gamma . p_I and its derivatives. */
INLINE void write_functions(int terms, int first, int count, const Work *work, RefCellNode *node,
                            RefCellFound *found)
{
    for (int n = 0; n < count; n++) {
        double p[TERMS][LANES], dot[PARTS][LANES] = {{0}}, w[PARTS][LANES], *part[PARTS];
        basis_at(terms, first, node + n, p);
        for (int k = 0; k < PARTS; k++) {
            memcpy(w[k], node[n].weight[k] + first, sizeof w[k]);
            part[k] = node[n].part[k] + first;
            for (int i = 0; i < terms; i++)
                LANE_BY_LANE dot[k][l] += work->gamma[k][i][l] * p[i][l];
        }
        LANE_BY_LANE part[0][l] = w[0][l] * dot[0][l];
        for (int k = 1; k <= 2; k++) {
            LANE_BY_LANE part[k][l] = w[k][l] * dot[0][l] + w[0][l] * dot[k][l];
            take_larger(part[k], found->most[0] + first);
        }
        for (int m = 0; m < 3; m++) {
            int k = second_of[m][0], o = second_of[m][1];
            LANE_BY_LANE part[3 + m][l] = w[3 + m][l] * dot[0][l] + w[k][l] * dot[o][l] +
                                          w[o][l] * dot[k][l] + w[0][l] * dot[3 + m][l];
            take_larger(part[3 + m], found->most[1] + first);
        }
    }
}

INLINE void shape_all(int terms, int count, double scale, RefCellNode *node, RefCellFound *found)
{
    Work work;
    memset(found->most, 0, sizeof found->most);
    for (int first = 0; first < ALL; first += LANES) {
        moments(terms, first, count, node, &work);
        factorise(terms, &work, found->pivot + first);
        differentiate(terms, scale, &work);
        write_functions(terms, first, count, &work, node, found);
    }
}

static void shape(int terms, int count, double scale, RefCellNode *node, RefCellFound *found)
{
    if (terms == 6)
        shape_all(6, count, scale, node, found);
    else if (terms == 3)
        shape_all(3, count, scale, node, found);
    else
        shape_all(1, count, scale, node, found);
}

const RefCellFunctions SM_ISA_NAME(ref_cell_functions) = {weigh, shape};
