/* change_point.h - where a series of times changes: E-divisive of Matteson and James (A
 * nonparametric approach for multiple change point analysis of multivariate data, JASA 109, 2014),
 * which supposes nothing of how times are distributed. */
#ifndef BENCH_CHANGE_POINT_H
#define BENCH_CHANGE_POINT_H

enum {
    BENCH_CHANGE_APART = 3,   /* values there are at least before, between and after changes */
    BENCH_CHANGE_DRAWS = 499, /* permutations of a test */
    BENCH_CHANGE_LEAST = 10,  /* values: of fewer no permutation test at this level finds any */
};
#define BENCH_CHANGE_LEVEL 0.01

typedef struct {
    int first; /* the first value that is of the time after it */
    double p;  /* of the permutation test that found it, at most BENCH_CHANGE_LEVEL */
} BenchChange;

/* Finds the changes among `count` positive values in the order of time, by the energy distance of
 * their logarithms (exponent 1): again and again the place that parts a segment best, as long as
 * less than a hundredth of permutations within the segments part one as well. So a series that does
 * not change has a change in one of a hundred cases. `change` has room for count /
 * BENCH_CHANGE_APART; returns how many, in their order. The same seed finds the same. Time and
 * memory grow with count^2. */
int bench_changes_find(const double *value, int count, unsigned long seed, BenchChange *change);

#endif
