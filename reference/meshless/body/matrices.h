/* matrices.h - mass and stiffness of a meshless body (meshless sections 4.1.2 and 5.1). */
#ifndef REF_MESHLESS_MATRICES_H
#define REF_MESHLESS_MATRICES_H

#include "mls.h"

typedef struct {
    double young;   /* E, Pa where lengths are m; above 0 */
    double poisson; /* above -1, below 0.5 */
    double density; /* above 0 */
} RefMaterial;

/* The lower half of a symmetric matrix, column by column, rows rising. */
typedef struct {
    int columns;
    int *start; /* [columns + 1] */
    int *row;   /* [start[columns]] */
    double *value;
} RefSparse;

typedef struct {
    RefSparse mass;      /* of the nodes: int rho phi_I phi_J; the same along every axis */
    RefSparse stiffness; /* of the parameters 3 I + d: int B^T D B */
    bool lumped; /* of a stored body: mass is diagonal, and modes are not orthonormal by it */
} RefMatrices;

/* Linear elasticity, isotropic, over the tree's integration points. Eq. 18 as printed lacks the
 * half of Green's strain; this is the usual one. Shape functions are no polynomials, so that Gauss
 * points alone miss the patch test by 3% (eight in each eighth of an octant); here their gradients
 * have in every octant the mean that the octant's walls say (octants.h), which passes it to
 * rounding where octants' faces are the body's, and elsewhere as well as its surface is cut.
 * O(points * covers^2). The caller frees. Errors: SM_USAGE, a material out of range; SM_INPUT, a
 * point that too few nodes cover (ref_mls_cover() corrects that), or a stiffness of more than 2^31
 * entries. */
SmCode ref_matrices_build(const RefOctants *tree, const RefNodes *nodes, RefBasis basis,
                          const RefMaterial *material, RefMatrices *matrices, SmError *error);
void ref_matrices_free(RefMatrices *matrices);
void ref_sparse_free(RefSparse *sparse);

/* SM_USAGE, and a line that says which number is out of range. */
SmCode ref_material_check(const RefMaterial *material, SmError *error);

/* y = S x for `width` columns side by side: x and y are [columns][width]. */
void ref_sparse_apply(const RefSparse *sparse, int width, const double *x, double *y);

/* The sums of its rows, [columns]: of a mass matrix what belongs to each node. */
void ref_sparse_sums(const RefSparse *sparse, double *sum);

#endif
