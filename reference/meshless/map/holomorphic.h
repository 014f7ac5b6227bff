/* holomorphic.h - holomorphic one-forms of a surface with handles or rims (Gu and Yau 2003). */
#ifndef REF_HOLOMORPHIC_H
#define REF_HOLOMORPHIC_H

#include "triangulation.h"

/* Harmonic one-forms that do not change along rims, of which those with whole-numbered periods are
 * sums, and the Hodge star in them. Those of loops come first, and nothing flows through a rim of
 * them: whole multiples make up the periods. The others are differences of functions that are 1 on
 * one rim and 0 on the others; any multiples will do. Stars are made up of forms without a part
 * across rims. */
typedef struct {
    int count;      /* loops and rims but for the longest one */
    int loops;      /* 2 genus */
    double **form;  /* [count][3 * triangles] of low energies */
    double **dual;  /* [count][3 * triangles] of a closed surface the same */
    double *energy; /* [count][count] products of the forms */
    double *star;   /* [count][count] star form j is the sum of star[i][j] dual i */
} RefHolomorphic;

/* Of a surface that is neither a sphere nor a disk; the weights are harmonic.h's. One factorisation
 * of [vertices], or two. The caller frees. Errors: solver.h's; SM_INPUT, forms that depend on one
 * another. */
SmCode ref_holomorphic_create(const RefTriangulation *surface, const double *weight,
                              const char *name, RefHolomorphic *basis, SmError *error);
void ref_holomorphic_free(RefHolomorphic *basis);

/* step[0] + i step[1], holomorphic, of which step[1] is the sum of number[k] form k: leaves along
 * which it does not change are closed. Both are [3 * triangles], the caller's. */
void ref_holomorphic_form(const RefTriangulation *surface, const RefHolomorphic *basis,
                          const double *number, double *const step[2]);

/* The `wanted` best choices of numbers for that form, best first, into [wanted][count]; returns how
 * many. Those are best whose log L varies little over the area and whose energy is low; their
 * variance and a share of that make up `score`, [wanted]. None is another one's multiple. Without
 * handles the energy does not count, which multiples change, and the greatest difference between
 * rims is 1. O(triangles) for each of some hundreds. */
int ref_holomorphic_choose(const RefTriangulation *surface, const RefHolomorphic *basis, int wanted,
                           double *number, double *score);

#endif
