#include "chart.h"

#include <math.h>
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

bool ref_chart_enter(const RefChart *chart, double theta[2])
{
    bool turned;
    return ref_chart_go_on(chart, theta, &turned);
}

bool ref_chart_go_on(const RefChart *chart, double theta[2], bool *turned)
{
    *turned = false;
    if (chart->cylinders) {
        const RefCylinder *in =
            chart->cylinders->cylinder + ref_cylinders_at(chart->cylinders, theta);
        double way[2];
        for (int d = 0; d < 2; d++) {
            double inside = fmin(fmax(theta[d], in->low[d]), in->high[d]);
            way[d] = theta[d] - inside;
            theta[d] = inside;
        }
        return ref_cylinders_walk(chart->cylinders, theta, way);
    }
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

void ref_chart_image(const RefChart *chart, const double theta[2], const double near[2],
                     double image[2])
{
    double least = hypot(theta[0] - near[0], theta[1] - near[1]);
    memcpy(image, theta, 2 * sizeof *image);
    for (int s = 0; s < chart->seams; s++) {
        double there[2];
        ref_seam_cross(chart->seam + s, theta, there);
        double far = hypot(there[0] - near[0], there[1] - near[1]);
        if (far >= least) continue;
        least = far;
        memcpy(image, there, sizeof there);
    }
}
