/* holomorphic.h - holomorphic one-forms of a surface with handles or rims (Gu and Yau 2003). */
#ifndef REF_HOLOMORPHIC_H
#define REF_HOLOMORPHIC_H

#include "triangulation.h"

/* Harmonic one-forms of whole-numbered periods, which make up all harmonic ones, and the Hodge star
 * in them. Of a surface with rims they are differences of functions that are 1 on one rim and 0 on
 * the others, and their stars are made up of forms without a part across rims. */
typedef struct {
    int count;     /* 2 genus, or rims but for the longest one */
    double **form; /* [count][3 * triangles] of low energies */
    double **dual; /* [count][3 * triangles] of a closed surface the same */
    double *star;  /* [count][count] star form j is the sum of star[i][j] dual i */
} RefHolomorphic;

/* Of a closed surface, or of one of genus 0 with two rims or more; the weights are harmonic.h's.
 * One factorisation of [vertices], or two. The caller frees. Errors: solver.h's; SM_INPUT, forms
 * that depend on one another. */
SmCode ref_holomorphic_create(const RefTriangulation *surface, const double *weight,
                              const char *name, RefHolomorphic *basis, SmError *error);
void ref_holomorphic_free(RefHolomorphic *basis);

/* step[0] + i step[1], holomorphic, of which step[1] is the sum of number[k] form k: leaves along
 * which it does not change are closed. Both are [3 * triangles], the caller's. */
void ref_holomorphic_form(const RefTriangulation *surface, const RefHolomorphic *basis,
                          const int *number, double *const step[2]);

/* The `wanted` best choices of whole numbers for that form, best first, into [wanted][count];
 * returns how many. Those are best whose log L varies little over the area and whose energy is low;
 * their variance and a share of that make up `score`, [wanted]. None has a common divisor. Between
 * rims the energy does not count, and the function is least on the longest rim and falls from all
 * others everywhere. O(triangles) for each of some hundreds. */
int ref_holomorphic_choose(const RefTriangulation *surface, const RefHolomorphic *basis, int wanted,
                           int *number, double *score);

#endif
