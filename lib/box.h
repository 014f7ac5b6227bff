/* box.h - boxes along the axes. */
#ifndef SM_AXIS_BOX_H
#define SM_AXIS_BOX_H

#include <math.h>
#include <stdbool.h>

typedef struct {
    double low[3], high[3];
} SmBox;

/* A box of nothing: INFINITY to -INFINITY. */
static inline SmBox sm_no_box(void)
{
    return (SmBox){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

/* Makes a box hold another one; coordinates that are NaN are left out. */
static inline void sm_box_join(SmBox *box, const double low[3], const double high[3])
{
    for (int d = 0; d < 3; d++) {
        box->low[d] = low[d] < box->low[d] ? low[d] : box->low[d];
        box->high[d] = high[d] > box->high[d] ? high[d] : box->high[d];
    }
}

static inline void sm_box_add(SmBox *box, const double point[3])
{
    sm_box_join(box, point, point);
}

static inline SmBox sm_box_around(long count, const double (*point)[3])
{
    SmBox box = sm_no_box();
    for (long i = 0; i < count; i++) sm_box_add(&box, point[i]);
    return box;
}

static inline void sm_box_widen(SmBox *box, double margin)
{
    for (int d = 0; d < 3; d++) {
        box->low[d] -= margin;
        box->high[d] += margin;
    }
}

/* The length of its longest side. */
static inline double sm_box_longest(const SmBox *box)
{
    return fmax(box->high[0] - box->low[0],
                fmax(box->high[1] - box->low[1], box->high[2] - box->low[2]));
}

static inline bool sm_box_holds(const SmBox *box, const double p[3])
{
    return p[0] >= box->low[0] && p[0] <= box->high[0] && p[1] >= box->low[1] &&
           p[1] <= box->high[1] && p[2] >= box->low[2] && p[2] <= box->high[2];
}

static inline bool sm_boxes_meet(const SmBox *a, const SmBox *b)
{
    return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] &&
           b->low[1] <= a->high[1] && a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
}

#endif
