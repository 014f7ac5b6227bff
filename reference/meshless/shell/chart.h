/* chart.h - conformal parameters of a shell's middle surface (meshless section 4.2). */
#ifndef REF_CHART_H
#define REF_CHART_H

#include "../body/nodes.h"

enum { REF_MOST_SEAMS = 8 };

/* A rectangle of the plane of parameters (theta1, theta2) and the surface over it. Its sides are
 * rims of the surface, or seams, behind which the parameters go on in the rectangle but for a
 * constant, or but for a constant and half a turn. A closed surface of genus 2 and more, as
 * a sheet with two holes and more, has several rectangles, joined along intervals of their sides
 * (body/cylinders.h). */
typedef struct {
    double low[2], high[2];
    int seams;
    RefSeam seam[REF_MOST_SEAMS];
    /* L: lengths on the surface are L times those in the plane. */
    double (*factor)(const void *data, const double theta[2]);
    void (*place)(const void *data, const double theta[2], double x[3]);
    /* The root of the mean of L^2 over a part of the rectangle: what there is of surface over it.
     * NULL: the largest of a grid of places there is taken instead. */
    double (*mean)(const void *data, const double low[2], const double high[2]);
    const void *data; /* for all */
    /* Several rectangles, of which low..high is the box, and what they are joined by; without
     * seams then. The caller's; NULL: one rectangle. */
    const RefCylinders *cylinders;
} RefChart;

/* Joins the rectangle's opposite sides along the axes that are given: the chart of a cylinder has
 * one, that of a torus two. */
void ref_chart_wrap(RefChart *chart, bool first, bool second);

/* Joins the first axis' sides, and the upper side to the lower one `shift` farther along: what is
 * at (theta1, high) goes on at (theta1 - shift, low). That is every torus but for its size, with
 * |shift| up to half the side. */
void ref_chart_skew(RefChart *chart, double shift);

/* Joins the first axis' sides, and folds the lower or the upper side or both, each onto itself by
 * half a turn about the place (*lower, low[1]) or (*upper, high[1]); NULL: a rim. One fold closes
 * an end of a tube, which so is a sheet with one rim; two make a closed surface of genus 0, as a
 * pillowcase is made. Each ends at two branch points, half a side apart, about which the surface
 * has half a turn of the plane. A function that is smooth on the surface is even about them, f(w) =
 * f(-w), and so are all that nodes and their images make: linear terms cancel there, and L falls to
 * 0 as the distance does. Covers may reach around such a point, as no value is there twice unless
 * it is the same; they could not around a point with more than a whole turn. Here and on skewed
 * tori, covers may reach half a side. */
void ref_chart_fold(RefChart *chart, const double *lower, const double *upper);

/* Moves a place that is beyond a seam into the rectangle; false where there is no seam. */
bool ref_chart_enter(const RefChart *chart, double theta[2]);

/* The rectangle in whose plane a place is. */
int ref_chart_plane(const RefChart *chart, const double theta[2]);

/* Goes straight from a place of a rectangle: theta becomes where that ends, in its rectangle.
 * False, and theta there or beyond, where it meets a rim. */
bool ref_chart_walk(const RefChart *chart, double theta[2], const double way[2]);

/* What is behind a piece of a way: nothing more, another rectangle's plane, or a rim. */
typedef enum { REF_LEG_LAST, REF_LEG_GOES_ON, REF_LEG_RIM } RefChartLeg;

/* The same in pieces that lie in one rectangle's plane each. `leg` receives the first one of the
 * way to `to`, in the plane of where it begins, a trace longer than it is where another plane is
 * behind. theta and `to` become where the next one begins and where the way ends in the plane
 * there, which `turned` says is turned by half a turn; or theta where the way ends, beyond the rim
 * if there is one. */
RefChartLeg ref_chart_leg(const RefChart *chart, double theta[2], double to[2], double leg[2][2],
                          bool *turned);

/* A straight piece of a rectangle as straight ways see it that lead there, from the rectangle
 * itself or across seams or joints: in the plane that goes on from where they begin. */
typedef struct {
    double end[2][2];
    int plane, home; /* the rectangles of where ways begin, and of the piece */
    double shift[2]; /* what the piece's places have got, but for half a turn */
    bool turned;
} RefChartImage;

typedef struct {
    long count, room;
    RefChartImage *image;      /* [count] */
    RefCylinderImages scratch; /* private */
} RefChartImages;

/* The images of a piece, or of a place where both its ends are one, for ways that reach `margin` at
 * most along both axes, the piece itself first; those of an earlier call are overwritten. Behind
 * zeros there may be some that no way leads to. The caller frees. */
void ref_chart_images(const RefChart *chart, const double end[2][2], double margin,
                      RefChartImages *images);
void ref_chart_images_free(RefChartImages *images);

/* Whether the way from x, in the image's plane, leads to a place of the image: there may be a zero
 * between. O(joints passed). */
bool ref_chart_leads(const RefChart *chart, const RefChartImage *image, const double x[2],
                     const double place[2]);

/* Of a place and its images the one to which the shortest straight way leads from `near`, a place
 * of a rectangle. False, and `near` itself, where none does: behind a zero. */
bool ref_chart_image(const RefChart *chart, const double theta[2], const double near[2],
                     double image[2]);

#endif
