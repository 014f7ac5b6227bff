/* thin.h - mass and stiffness of thin shells: Kirchhoff and Love's theory (meshless section 5.2;
 * Cirak, Ortiz and Schroeder 2000).
 *
 * Of a displacement u, with bars for rest left out, the strains are
 *     eps_kl = (a_k . u,l + u,k . a_l) / 2     kap_kl = -(u,kl - C^1_kl u,1 - C^2_kl u,2) . a3
 * and the energy is half the integral over the surface of
 *     E t / (1 - nu^2) eps : H eps + E t^3 / (12 (1 - nu^2)) kap : H kap
 * (eq. 23 as printed lacks the half). All lengths are of the fitted middle surface, so that rigid
 * motions cost nothing. */
#ifndef REF_THIN_H
#define REF_THIN_H

#include "middle.h"

/* What the samples of one cell add to the matrices. */
typedef struct {
    int count, room;   /* room: nodes that there is memory for */
    int *node;         /* [count] rising */
    double (*sum)[10]; /* [count (count + 1) / 2] of nodes I <= J, row by row: mass without the
                          density, then the block of I along a, J along b at 1 + 3 a + b */
} RefElement;

/* The sums of nodes number a and b >= a of an element. */
static inline const double *ref_element_sum(const RefElement *element, long a, long b)
{
    return element->sum[a * (2 * element->count - a + 1) / 2 + b - a];
}

/* What ref_thin_element() works in; the caller frees. */
typedef struct {
    int *node, *number; /* [nodes] */
    int stiff;          /* samples that have rows of the stiffness, */
    double *strain;     /* [6 samples][columns] its roots: weighted strains */
    double *shape;      /* [samples][columns] and of the mass */
    double *part;       /* [6][columns] of a sample */
    double *square;     /* [columns][columns] */
    long columns;       /* that there is room for */
} RefThinWork;

RefThinWork ref_thin_work(long nodes);
void ref_thin_work_free(RefThinWork *work);

/* Sums over the samples of one cell, which is counted among the terminal ones that `samples` has,
 * with their frames, of a shell of this thickness. Samples whose functions leave the surface there
 * without an area have mass alone, and those without functions nothing; returns how many both are.
 * O(samples * covers^2). What the element held before makes room: it is zeroed before it is used
 * first; the caller frees. */
int ref_thin_element(const RefSamples *samples, long cell, double thickness,
                     const RefMaterial *material, RefThinWork *work, RefElement *element);
void ref_element_free(RefElement *element);

/* Nodes that some sample sees both meet; and the sums of nodes that have met. */
void ref_element_meet(const RefElement *element, RefPairs *pairs);
void ref_element_add(const RefElement *element, RefPairs *pairs);

/* Whether functions leave the surface at a sample enough of what it was before any crack, by its
 * area over that in the plane and the trace of its inverse metric, for it to be stiff there; and
 * that was not drawn out by the map a thousandfold, as where a thin tip has nearly no area in the
 * plane. */
bool ref_thin_is_stiff(const RefFrame *frame, double area, double trace);

/* The larger eigenvalue of a tensor by its mixed parts, T^k_l. */
double ref_thin_principal(const double mixed[2][2]);

/* The strains, three of membrane (11, 22, twice 12) and three of bending, of a displacement whose
 * value and derivatives along axis d are sum[d], as functions' parts. */
void ref_thin_strains(const RefFrame *frame, const double sum[3][6], double strain[6]);

/* The transpose: the slopes by these of the product of strains and stresses. */
void ref_thin_pull(const RefFrame *frame, const double stress[6], double pull[6][3]);

/* What strains are multiplied by under the integral, H as rows of (11, 22, 12). */
void ref_thin_law(const double inverse[3], double poisson, double H[3][3]);

/* Roots of the membrane's and the bending stiffness of an area. */
void ref_thin_weights(double area, double thickness, const RefMaterial *material, double weight[2]);

/* G of H = G^T G, upper triangular: the squares of G times strains are the energy. */
void ref_thin_factor(const double inverse[3], double poisson, double G[3][3]);

/* Of a shell of this thickness, over the samples, whose areas it fills in. Neither rotary inertia
 * nor drilling stiffness. The caller frees. Errors: matrices.h's of a material; SM_USAGE, a
 * thickness that is not above 0; SM_INPUT, a surface without area at a sample. `soft` receives how
 * many samples have no stiffness. */
SmCode ref_thin_build(const double (*X)[3], RefSamples *samples, long nodes, double thickness,
                      const RefMaterial *material, RefMatrices *matrices, long *soft,
                      SmError *error);

#endif
