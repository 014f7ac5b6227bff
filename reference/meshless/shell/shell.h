/* shell.h - a meshless thin shell: quadtree, nodes, covers, middle surface and matrices of a chart
 * (meshless sections 4.2 and 5.2). */
#ifndef REF_SHELL_H
#define REF_SHELL_H

#include "thin.h"

typedef struct {
    int across;     /* cells along the chart's shorter side before any is split; 0: as many as make
                       them nearly squares */
    long nodes;     /* wanted; 0: one in each of those cells, of which there are some then */
    RefBasis basis; /* of a plane */
    double eta;     /* covers' edges in those of their cells; 0: 4, of the quadratic basis 6 */
    double thickness;
    RefMaterial material;
} RefShellOptions;

/* Where functions are kept at samples (cracked.h): at() writes those at a place, and returns the
 * basis, or 0 where there are none; cell() are those of a terminal cell, with frames, and areas
 * before any crack. */
typedef struct {
    int (*at)(const void *kept, const double theta[3], RefShape *shape);
    const RefSamples *(*cell)(const void *kept, long cell);
    const void *kept;
} RefShellFunctions;

typedef struct {
    RefChart chart;
    RefQuadtree tree;
    RefNodes nodes;
    RefBasis basis;
    double (*X)[3];  /* [nodes] the parameters of the middle surface, as displacements have them */
    double (*up)[3]; /* [nodes] the normals that the surface has there without cracks, or 0 where it
                        has none; NULL: it has no cracks */
    RefMatrices matrices;
    long soft;                   /* samples without stiffness, before any crack (thin.h) */
    RefShellFunctions functions; /* at is NULL: computed where they are wanted */
} RefShell;

/* Builds a shell. The paper's covers are three edges wide, which leaves rims with too few nodes.
 * With 4 and 6 the weights' second derivatives jump where parts of uniform cells meet, which keeps
 * integration good: a supported plate is 0.05% off with 4 and linear functions, 14% with 4.2. But
 * linear functions of 4 add up to zero with alternating signs where uniform cells go around in even
 * numbers; there 6 serves. `shell` must not move in memory: nodes and tree know its chart. The
 * caller frees. Errors: those of quadtree.h, samples.h, middle.h and thin.h. */
SmCode ref_shell_build(const RefChart *chart, const RefShellOptions *options, RefShell *shell,
                       SmError *error);
void ref_shell_free(RefShell *shell);

/* The shape functions, and the middle surface, at a point of the rectangle, between cracks as
 * samples have them; 0 and false where functions are not defined. */
int ref_shell_shape(const RefShell *shell, const double theta[3], RefShape *shape);
bool ref_shell_at(const RefShell *shell, const double theta[3], RefShape *shape, RefFrame *frame);

#endif
