/* samples.h - the shape functions at a shell's integration points, Gauss points in the terminal
 * cells of its quadtree (meshless sections 4.1.2 and 4.2). */
#ifndef REF_SAMPLES_H
#define REF_SAMPLES_H

#include "../body/mls.h"
#include "../body/pairs.h"
#include "cell_functions.h"
#include "crack.h"
#include "quadtree.h"

/* Three by three in each of four parts of a cell. */
enum { REF_SAMPLES_PER_CELL = 36 };

/* That of them in the middle of a cell's quarter: 0 to 3, along the first axis first. */
static inline int ref_samples_quarter(int quarter)
{
    return 7 + 3 * (quarter & 1) + 18 * (quarter >> 1);
}

/* The middle surface at a point. Pairs of indices are in the order 11, 22, 12. Where it is a line,
 * area, normal and what follows from them are 0. */
typedef struct {
    double x[3];
    double tangent[2][3]; /* a_k = x,k */
    double second[3][3];  /* x,kl */
    double normal[3];     /* a3, of unit length */
    double area;          /* |a1 x a2| */
    double inverse[3];    /* g^kl of the metric g_kl = a_k . a_l */
    double symbol[3][2];  /* Christoffel's C^n_kl, of n = 1 and 2 */
} RefFrame;

typedef struct {
    long count;         /* terminal cell by terminal cell */
    double (*theta)[3]; /* [count], with a third coordinate of 0 */
    double *weight;     /* [count] area in the plane, */
    double *area;       /* [count] and on the middle surface (ref_middle_areas()), */
    double *trace; /* [count] of whose inverse metric this is the trace; both before any crack */
    long *start;   /* [count + 1] */
    int *node;     /* [start[count]] as in RefShape */
    double (*part)[6]; /* [start[count]] phi, phi,1, phi,2, phi,11, phi,22, phi,12 */
    RefFrame *frame;   /* [count] by ref_middle_frames(), or NULL */
} RefSamples;

/* What ref_samples_of() takes samples of, and works in. */
typedef struct {
    const RefNodes *nodes;
    RefBasis basis;
    const RefCracks *cracks; /* which cut covers */
    RefShape shape;
    RefCellNode *node; /* [room] those that touch a cell, and */
    int *member;       /* their numbers, of images their owners' */
    int room;
} RefSamplesWork;

/* All are the caller's, and the nodes' `cut` says the same of the cracks. The caller frees. */
RefSamplesWork ref_samples_work(const RefNodes *nodes, RefBasis basis, const RefCracks *cracks);
void ref_samples_work_free(RefSamplesWork *work);

/* Takes the shape functions after covers were enlarged where they are not defined at a sample. The
 * caller frees. Errors: SM_INPUT, samples that stay uncovered. */
SmCode ref_samples_take(const RefQuadtree *tree, RefNodes *nodes, RefBasis basis,
                        RefSamples *samples, SmError *error);
void ref_samples_free(RefSamples *samples);

/* Prefetches the functions of a cell's quarters, while the cell before is worked on: a shell's are
 * more than a cache has. */
void ref_samples_fetch_quarters(const RefSamples *samples);

/* The same of one terminal cell, with covers as they are, which cracks cut. Where they leave a
 * sample too few nodes, or functions that vary faster than a cell of this edge can bear, it has
 * those of a lower basis, and where they leave it no node, none. The caller frees. */
void ref_samples_of(const RefQuadtree *tree, long cell, double edge, RefSamplesWork *work,
                    RefSamples *samples);

/* The samples' coordinates along both axes of a cell. */
void ref_samples_grid(const RefQuadtree *tree, long cell, double at[2][REF_GRID_SIDE]);

/* The shape functions at a place of a cell whose edge is `edge`; between cracks of the first of a
 * quadratic, linear and constant basis that is defined there and varies no faster than the cell can
 * bear, or the last without derivatives; at a place on a crack as one beside it sees them. Returns
 * the basis, or 0 where no node is seen. */
int ref_samples_shape(const RefNodes *nodes, RefBasis basis, double edge, const double x[3],
                      RefShape *shape);

/* Functions' values beyond this carry a place away with nodes far from it. */
#define REF_SAMPLES_MOST_VALUE 2.0

/* The functions at a place from those at the sample `near` beside it: Taylor's to second order,
 * which reproduce all that the basis does; where one of them leaves -2..2, as between cracks, the
 * sample's own without derivatives. */
void ref_samples_expand(const RefSamples *samples, long near, const double theta[2],
                        RefShape *shape);

/* Of a cell's samples the one that is nearest to a place, which may be out of the cell. */
int ref_samples_nearest(const double middle[2], const double edge[2], const double theta[2]);

/* A sample's six parts of function n. */
void ref_samples_part(const RefShape *shape, int n, double part[6]);

/* The nodes that a cell's samples know, rising, into `node`; returns how many. `number` is -1 of
 * all nodes before, and of these their place in `node` afterwards. `cell` counts terminal ones. */
int ref_samples_nodes(const RefSamples *samples, long cell, int *node, int *number);

/* Pairs of the nodes that a cell knows together, all sums zero. */
RefPairs ref_samples_pairs(const RefSamples *samples, long nodes);

#endif
