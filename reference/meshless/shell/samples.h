/* samples.h - the shape functions at a shell's integration points, Gauss points in the terminal
 * cells of its quadtree (meshless sections 4.1.2 and 4.2). */
#ifndef REF_SAMPLES_H
#define REF_SAMPLES_H

#include "../body/mls.h"
#include "../body/pairs.h"
#include "quadtree.h"

/* Three by three in each of four parts of a cell. */
enum { REF_SAMPLES_PER_CELL = 36 };

typedef struct {
    long count;         /* terminal cell by terminal cell */
    double (*theta)[3]; /* [count], with a third coordinate of 0 */
    double *weight;     /* [count] area in the plane */
    long *start;        /* [count + 1] */
    int *node;          /* [start[count]] as in RefShape */
    double (*part)[6];  /* [start[count]] phi, phi,1, phi,2, phi,11, phi,22, phi,12 */
} RefSamples;

/* Takes the shape functions after covers were enlarged where they are not defined at a sample. The
 * caller frees. Errors: SM_INPUT, samples that stay uncovered. */
SmCode ref_samples_take(const RefQuadtree *tree, RefNodes *nodes, RefBasis basis,
                        RefSamples *samples, SmError *error);
void ref_samples_free(RefSamples *samples);

/* The nodes that a cell's samples know, rising, into `node`; returns how many. `number` is -1 of
 * all nodes before, and of these their place in `node` afterwards. `cell` counts terminal ones. */
int ref_samples_nodes(const RefSamples *samples, long cell, int *node, int *number);

/* Pairs of the nodes that a cell knows together, all sums zero. */
RefPairs ref_samples_pairs(const RefSamples *samples, long nodes);

#endif
