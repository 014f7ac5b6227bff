/* chart.h - conformal parameters of a shell's middle surface (meshless section 4.2). */
#ifndef REF_CHART_H
#define REF_CHART_H

#include "../body/nodes.h"

enum { REF_MOST_SEAMS = 8 };

/* A rectangle of the plane of parameters (theta1, theta2) and the surface over it. Its sides are
 * rims of the surface, or seams, behind which the parameters go on in the rectangle but for a
 * constant. */
typedef struct {
    double low[2], high[2];
    int seams;
    RefSeam seam[REF_MOST_SEAMS];
    /* L: lengths on the surface are L times those in the plane. */
    double (*factor)(const void *data, const double theta[2]);
    void (*place)(const void *data, const double theta[2], double x[3]);
    const void *data; /* for both */
} RefChart;

/* Joins the rectangle's opposite sides along the axes that are given: the chart of a cylinder has
 * one, that of a torus two. */
void ref_chart_wrap(RefChart *chart, bool first, bool second);

/* Moves a place that is beyond a seam into the rectangle; false where there is no seam. */
bool ref_chart_enter(const RefChart *chart, double theta[2]);

#endif
