/* cloud.h - points in a tree of boxes: the nearest ones, those in a ball, the winding number. */
#ifndef REF_CLOUD_H
#define REF_CLOUD_H

#include "points.h"

typedef struct {
    double low[3], high[3];              /* box of its points */
    long first, count;                   /* points in `order` */
    int child;                           /* the first of two that follow each other, or -1 */
    double middle[3], dipole[3], radius; /* of its area, for the winding number */
} RefCloudNode;

typedef struct {
    const RefPoints *points; /* the caller's, kept */
    long *order;
    double *area;    /* [count] that each point stands for */
    double *spacing; /* [count] distance to the eighth nearest */
    int nodes;
    RefCloudNode *node;
} RefCloud;

/* The points are the caller's and stay. O(n log n). */
void ref_cloud_create(const RefPoints *points, RefCloud *cloud);
void ref_cloud_free(RefCloud *cloud);

/* The k nearest points, nearest first, and their distances; returns how many, k or all there are.
 */
int ref_cloud_nearest(const RefCloud *cloud, const double x[3], int k, long *point,
                      double *distance);

/* How many points lie within `radius` of x; notes the first `room`. */
long ref_cloud_ball(const RefCloud *cloud, const double x[3], double radius, long room,
                    long *point);

/* How often the surface winds around x: about 1 inside, 0 outside, also with holes and noise
 * (Barill et al. 2018, dipoles). Means nothing within a spacing of the points. O(log n). */
double ref_cloud_winding(const RefCloud *cloud, const double x[3]);

#endif
