/* locate.h - finds the triangle of a plane that holds a place, by a tree of boxes. */
#ifndef REF_LOCATE_H
#define REF_LOCATE_H

typedef struct {
    double corner[3][2]; /* counter-clockwise */
    int triangle;        /* the caller's number */
    double value;        /* and what ref_locator_sum() adds up */
} RefPlaced;

typedef struct {
    double low[2], high[2], sum;
    int first, count; /* triangles */
    int child;        /* the first of two, or -1 */
} RefLocatorNode;

typedef struct {
    RefPlaced *placed;
    int nodes;
    RefLocatorNode *node;
} RefLocator;

/* Takes `placed` over, from malloc(), and puts it in another order; at least one. O(n log n). */
void ref_locator_create(int count, RefPlaced *placed, RefLocator *locator);
void ref_locator_free(RefLocator *locator);

/* The triangle that holds a place, and the weights of its corners, which are not negative and have
 * the sum 1; of a place beyond all triangles, one close by. O(log n). */
const RefPlaced *ref_locator_at(const RefLocator *locator, const double theta[2], double weight[3]);

/* The sum of the values of triangles whose middles are in a box. O(log n + those around the box's
 * sides). */
double ref_locator_sum(const RefLocator *locator, const double low[2], const double high[2]);

#endif
