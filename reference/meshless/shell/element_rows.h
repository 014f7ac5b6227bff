/* element_rows.h - sums of pairs of nodes over elements that are kept, row by row, so that those of
 * some nodes can be added up again when some cells have changed. */
#ifndef REF_ELEMENT_ROWS_H
#define REF_ELEMENT_ROWS_H

#include "thin.h"

/* A node's sums with its partners J >= I, as RefElement has them: nodes that some sample sees both.
 */
typedef struct {
    int count, room;
    int *partner; /* [count] rising; the node itself is the first */
    double (*sum)[10];
} RefElementRow;

typedef struct {
    long count;         /* nodes */
    RefElementRow *row; /* [count] */
} RefElementRows;

void ref_element_rows_free(RefElementRows *rows);

/* Adds up the rows of the nodes that `touched` marks ([nodes]), over the `count` elements, of which
 * NULL are none, in their order: the same bits whichever rows are added up at once. Nodes may have
 * become more. O(nodes of all elements + nodes / 64 for each row + what is added up).
 */
void ref_element_rows_sum(RefElementRows *rows, long nodes, const unsigned char *touched,
                          long count, const RefElement *const *element);

/* The matrices of all rows. A node without mass gets means of the others' mass and stiffness, so
 * that it is no singularity. The caller frees. O(entries). */
void ref_element_rows_matrices(const RefElementRows *rows, double density, RefMatrices *matrices);

#endif
