#include "chart.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void add_seam(RefChart *chart, double first, double second, bool turned)
{
    RefSeam *seam = chart->seam + chart->seams++;
    *seam = (RefSeam){.shift = {first, second}, .turned = turned};
    memcpy(seam->low, chart->low, sizeof seam->low);
    memcpy(seam->high, chart->high, sizeof seam->high);
}

void ref_chart_wrap(RefChart *chart, bool first, bool second)
{
    chart->seams = 0;
    for (int i = first ? -1 : 0; i <= (first ? 1 : 0); i++)
        for (int j = second ? -1 : 0; j <= (second ? 1 : 0); j++)
            if (i != 0 || j != 0)
                add_seam(chart, i * (chart->high[0] - chart->low[0]),
                         j * (chart->high[1] - chart->low[1]), false);
}

void ref_chart_skew(RefChart *chart, double shift)
{
    double side[2] = {chart->high[0] - chart->low[0], chart->high[1] - chart->low[1]};
    ref_chart_wrap(chart, true, false);
    shift -= side[0] * rint(shift / side[0]);
    for (int j = -1; j <= 1; j += 2)
        for (int i = -1; i <= 1; i++) add_seam(chart, i * side[0] + j * shift, j * side[1], false);
}

/* Of the branch points of a fold, half a side apart, the one that is nearest to the side's middle.
 */
static void fold_side(RefChart *chart, double branch, double side)
{
    double length = chart->high[0] - chart->low[0], middle = chart->low[0] + length / 2;
    branch -= length / 2 * rint((branch - middle) / (length / 2));
    for (int i = -1; i <= 1; i++) add_seam(chart, 2 * branch + i * length, 2 * side, true);
}

void ref_chart_fold(RefChart *chart, const double *lower, const double *upper)
{
    ref_chart_wrap(chart, true, false);
    if (lower) fold_side(chart, *lower, chart->low[1]);
    if (upper) fold_side(chart, *upper, chart->high[1]);
}

static bool holds(const double low[2], const double high[2], const double theta[2])
{
    return theta[0] >= low[0] && theta[0] <= high[0] && theta[1] >= low[1] && theta[1] <= high[1];
}

/* `turned` receives whether the plane goes on turned there by half a turn. */
static bool go_on(const RefChart *chart, double theta[2], bool *turned)
{
    *turned = false;
    if (holds(chart->low, chart->high, theta)) return true;
    for (int s = 0; s < chart->seams; s++) {
        const RefSeam *seam = chart->seam + s;
        double there[2];
        ref_seam_cross(seam, theta, there);
        if (!holds(seam->low, seam->high, there)) continue;
        memcpy(theta, there, sizeof there);
        *turned = seam->turned;
        return true;
    }
    return false;
}

bool ref_chart_enter(const RefChart *chart, double theta[2])
{
    bool turned;
    double way[2];
    if (!chart->cylinders) return go_on(chart, theta, &turned);
    const RefCylinder *in = chart->cylinders->cylinder + ref_cylinders_at(chart->cylinders, theta);
    for (int d = 0; d < 2; d++) {
        double inside = fmin(fmax(theta[d], in->low[d]), in->high[d]);
        way[d] = theta[d] - inside;
        theta[d] = inside;
    }
    return ref_cylinders_walk(chart->cylinders, theta, way);
}

int ref_chart_plane(const RefChart *chart, const double theta[2])
{
    return chart->cylinders ? ref_cylinders_at(chart->cylinders, theta) : 0;
}

bool ref_chart_walk(const RefChart *chart, double theta[2], const double way[2])
{
    bool turned;
    if (chart->cylinders) return ref_cylinders_walk(chart->cylinders, theta, way);
    for (int d = 0; d < 2; d++) theta[d] += way[d];
    return go_on(chart, theta, &turned);
}

/* Of a leg, by which it is longer where others follow: gaps of rounding are less. */
static const double TRACE = 1e-9;

RefChartLeg ref_chart_leg(const RefChart *chart, double theta[2], double to[2], double leg[2][2],
                          bool *turned)
{
    double way[2] = {to[0] - theta[0], to[1] - theta[1]}, moved[2];
    double trace = TRACE * hypot(way[0], way[1]);
    memcpy(leg[0], theta, sizeof leg[0]);
    memcpy(leg[1], to, sizeof leg[1]);
    *turned = false;
    if (!chart->cylinders) {
        memcpy(theta, to, sizeof leg[1]);
        return go_on(chart, theta, turned) ? REF_LEG_LAST : REF_LEG_RIM;
    }
    bool goes_on = ref_cylinders_hop(chart->cylinders, theta, way, moved);
    if (!goes_on && (way[0] != 0 || way[1] != 0)) {
        memcpy(theta, to, sizeof leg[1]);
        return REF_LEG_RIM;
    }
    bool on_here = !goes_on && hypot(moved[0], moved[1]) < trace;
    for (int d = 0; d < 2; d++) {
        leg[1][d] = theta[d] - (on_here ? 0 : moved[d] - TRACE * (to[d] - leg[0][d]));
        to[d] += moved[d];
    }
    return goes_on ? REF_LEG_GOES_ON : REF_LEG_LAST;
}

void ref_chart_images_free(RefChartImages *images)
{
    ref_cylinder_images_free(&images->scratch);
    free(images->image);
    *images = (RefChartImages){.count = 0};
}

static RefChartImage *add_image(RefChartImages *images, const RefChartImage *image)
{
    sm_make_room(images->image, images->room, images->count + 1);
    images->image[images->count] = *image;
    return images->image + images->count++;
}

/* Whether a piece comes within the margin of the chart's rectangle. */
static bool matters(const RefChart *chart, const double end[2][2], double margin)
{
    for (int d = 0; d < 2; d++)
        if (fmax(end[0][d], end[1][d]) < chart->low[d] - margin ||
            fmin(end[0][d], end[1][d]) > chart->high[d] + margin)
            return false;
    return true;
}

static void add_seam_images(const RefChart *chart, const RefChartImage *whole, double margin,
                            RefChartImages *images)
{
    add_image(images, whole);
    for (int s = 0; s < chart->seams; s++) {
        const RefSeam *seam = chart->seam + s;
        RefChartImage one = {.turned = seam->turned, .shift = {seam->shift[0], seam->shift[1]}};
        for (int e = 0; e < 2; e++) ref_seam_cross(seam, whole->end[e], one.end[e]);
        if (matters(chart, (const double(*)[2])one.end, margin)) add_image(images, &one);
    }
}

static void add_cylinder_images(const RefChart *chart, const RefChartImage *whole, double margin,
                                RefChartImages *images)
{
    double low[2], high[2];
    for (int d = 0; d < 2; d++) {
        double way = whole->end[1][d] - whole->end[0][d];
        low[d] = fmin(way, 0) - margin;
        high[d] = fmax(way, 0) + margin;
    }
    const RefCylinderImages *found = &images->scratch;
    ref_cylinders_images(chart->cylinders, whole->end[0], low, high, 0, &images->scratch);
    for (int k = 0; k < found->count; k++) {
        RefChartImage *one = add_image(images, whole);
        one->plane = found->to[k];
        for (int d = 0; d < 2; d++) {
            one->shift[d] = found->shift[k][d];
            for (int e = 0; e < 2; e++) one->end[e][d] += one->shift[d];
        }
    }
}

void ref_chart_images(const RefChart *chart, const double end[2][2], double margin,
                      RefChartImages *images)
{
    int home = ref_chart_plane(chart, end[0]);
    RefChartImage whole = {.home = home, .plane = home};
    memcpy(whole.end, end, sizeof whole.end);
    images->count = 0;
    if (chart->cylinders)
        add_cylinder_images(chart, &whole, margin, images);
    else
        add_seam_images(chart, &whole, margin, images);
}

bool ref_chart_leads(const RefChart *chart, const RefChartImage *image, const double x[2],
                     const double place[2])
{
    double way[2], there[2];
    if (!chart->cylinders || image->shift[1] == 0) return true; /* no joint is between */
    for (int d = 0; d < 2; d++) {
        way[d] = place[d] - x[d];
        there[d] = place[d] - image->shift[d];
    }
    return ref_cylinders_lead(chart->cylinders, x, way, image->home, there);
}

/* The same of images that ways of `far` lead to. */
static bool find_image(const RefChart *chart, const double theta[2], const double near[2],
                       double far, RefChartImages *images, double nearest[2])
{
    const double place[2][2] = {{theta[0], theta[1]}, {theta[0], theta[1]}};
    int plane = ref_chart_plane(chart, near);
    double least = INFINITY;
    ref_chart_images(chart, place, far, images);
    for (long n = 0; n < images->count; n++) {
        const RefChartImage *image = images->image + n;
        double off = hypot(image->end[0][0] - near[0], image->end[0][1] - near[1]);
        if (image->plane != plane || off >= least ||
            !ref_chart_leads(chart, image, near, image->end[0]))
            continue;
        least = off;
        memcpy(nearest, image->end[0], sizeof image->end[0]);
    }
    return least < INFINITY && (!chart->cylinders || least <= far);
}

/* Among several rectangles one way after the other is as far as is looked, from short ones on. */
bool ref_chart_image(const RefChart *chart, const double theta[2], const double near[2],
                     double image[2])
{
    RefChartImages images = {.count = 0};
    double whole = fmax(chart->high[0] - chart->low[0], chart->high[1] - chart->low[1]);
    bool found = false;
    for (double far = whole / 256; !found && far <= whole / 4; far *= 4)
        found = find_image(chart, theta, near, chart->cylinders ? far : INFINITY, &images, image);
    ref_chart_images_free(&images);
    if (!found) memcpy(image, near, 2 * sizeof *image);
    return found;
}
