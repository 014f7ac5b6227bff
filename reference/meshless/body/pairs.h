/* pairs.h - what pairs of shape functions sum up to, on the way to matrices: lists of partners
 * whose covers meet, and for each pair a number and a block of three by three. */
#ifndef REF_PAIRS_H
#define REF_PAIRS_H

#include "matrices.h"

typedef struct {
    long count;         /* nodes */
    long *start;        /* [count + 1] of the partners of every node I, J >= I */
    int *partner;       /* [start[count]] rising */
    double *mass;       /* [start[count]] */
    double (*block)[9]; /* [start[count]] of I along a, J along b at 3 a + b */
    int **met;          /* [count] partners while they are being found, */
    long *held;         /* [count] and how many */
} RefPairs;

/* Pairs are found first: nodes that some cell knows together. The caller frees. */
RefPairs ref_pairs_begin(long nodes);
/* `count` nodes, rising, meet. O(their partners). */
void ref_pairs_meet(RefPairs *pairs, int count, const int *node);
/* `count` nodes J >= I, rising, are partners of I. O(its partners). */
void ref_pairs_add(RefPairs *pairs, int i, int count, const int *partner);
/* All sums are there then, and zero. */
void ref_pairs_end(RefPairs *pairs);
void ref_pairs_free(RefPairs *pairs);

/* Where the sums of a pair are, I <= J, which have met. O(log partners). */
long ref_pairs_at(const RefPairs *pairs, int i, int j);

/* SM_INPUT where matrices would have more than 2^31 entries. */
SmCode ref_pairs_check(const RefPairs *pairs, SmError *error);

/* The matrices of the sums: the masses times `density`, and the blocks as the stiffness, in which
 * column 3 I + a has the rows 3 J + b: those of I itself from b = a on. The caller frees. */
void ref_pairs_matrices(const RefPairs *pairs, double density, RefMatrices *matrices);

#endif
