/* cell_functions.h - moving least squares shape functions at all samples of a shell's cell at once
 * (mls.h, in a plane), of the instruction set in use (lib/isa.h): samples are what vectors hold. */
#ifndef REF_CELL_FUNCTIONS_H
#define REF_CELL_FUNCTIONS_H

enum {
    REF_CELL_SIDE = 6,   /* samples are a grid of so many squared, row by row, */
    REF_CELL_LANES = 40, /* in whole vectors; the last four are none */
    REF_CELL_PARTS = 6   /* of a function: value, two slopes, second derivatives 11, 22, 12 */
};

/* A node whose cover touches the cell. */
typedef struct {
    double weight[REF_CELL_PARTS][REF_CELL_LANES]; /* zero where it does not cover */
    double way[2][REF_CELL_LANES];                 /* from the samples to the node, over `scale` */
    double part[REF_CELL_PARTS][REF_CELL_LANES];   /* the shape function */
} RefCellNode;

/* What is to be known of all functions at a sample. */
typedef struct {
    double pivot[REF_CELL_LANES];   /* the least of A, scaled to ones on its diagonal */
    double most[2][REF_CELL_LANES]; /* the largest slope and second derivative */
} RefCellFound;

typedef struct {
    /* Weights from their splines along both axes, value and two derivatives each. */
    void (*weigh)(const double spline[2][3][REF_CELL_SIDE], RefCellNode *node);

    /* The functions of a basis of `terms`, 1, 3 or 6, from weights and ways. What they are where
     * the pivot is not above zero is undefined. */
    void (*shape)(int terms, int count, double scale, RefCellNode *node, RefCellFound *found);
} RefCellFunctions;
extern RefCellFunctions ref_cell_functions;

#endif
