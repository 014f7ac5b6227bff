#include "images.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static void middle_of(const RefPlaced *placed, double middle[2])
{
    for (int d = 0; d < 2; d++)
        middle[d] = (placed->corner[0][d] + placed->corner[1][d] + placed->corner[2][d]) / 3;
}

/* The part of a triangle that is in a rectangle, a polygon: its corners' mean; false where there is
 * none. */
static bool part_in(const RefCylinder *in, const RefPlaced *placed, double mean[2])
{
    double corner[8][2], kept[8][2];
    int count = 3;
    memcpy(corner, placed->corner, sizeof placed->corner);
    for (int side = 0; side < 4; side++) { /* Sutherland and Hodgman 1974 */
        int d = side / 2, left = 0;
        double at = side % 2 ? in->high[d] : in->low[d], sign = side % 2 ? -1 : 1;
        for (int n = 0; n < count; n++) {
            const double *a = corner[n], *b = corner[(n + 1) % count];
            double off[2] = {sign * (a[d] - at), sign * (b[d] - at)};
            if (off[0] > 0) memcpy(kept[left++], a, sizeof *kept);
            if ((off[0] > 0) == (off[1] > 0)) continue;
            for (int e = 0; e < 2; e++)
                kept[left][e] = a[e] + off[0] / (off[0] - off[1]) * (b[e] - a[e]);
            left++;
        }
        count = left;
        memcpy(corner, kept, sizeof corner);
    }
    mean[0] = mean[1] = 0;
    for (int n = 0; n < count; n++)
        for (int d = 0; d < 2; d++) mean[d] += corner[n][d] / count;
    return count > 0;
}

/* Images in cylinders: those that a line within the triangle leads to. */
static long add_cylinder_images(const RefCylinders *cylinders, const RefPlaced *placed,
                                RefCylinderImages *images, RefPlaced *image)
{
    double middle[2], low[2], high[2], size = 0;
    long count = 0;
    middle_of(placed, middle);
    for (int d = 0; d < 2; d++) {
        const double way[3] = {placed->corner[0][d] - middle[d], placed->corner[1][d] - middle[d],
                               placed->corner[2][d] - middle[d]};
        low[d] = fmin(way[0], fmin(way[1], way[2]));
        high[d] = fmax(way[0], fmax(way[1], way[2]));
        size = fmax(size, high[d] - low[d]);
    }
    ref_cylinders_images(cylinders, middle, low, high, 0, images);
    for (int k = 0; k < images->count && count < REF_MOST_IMAGES; k++) {
        RefPlaced one = *placed;
        double mean[2], way[2], end[2] = {middle[0], middle[1]};
        for (int i = 0; i < 3; i++)
            for (int d = 0; d < 2; d++) one.corner[i][d] += images->shift[k][d];
        if (!part_in(cylinders->cylinder + images->to[k], &one, mean)) continue;
        for (int d = 0; d < 2; d++) way[d] = mean[d] - images->shift[k][d] - middle[d];
        ref_cylinders_walk(cylinders, end, way);
        if (k == 0 || hypot(end[0] - mean[0], end[1] - mean[1]) < 1e-3 * size) image[count++] = one;
    }
    return count;
}

/* The same by seams, those that reach into the rectangle. */
static long add_seam_images(const RefChart *chart, const RefPlaced *placed, RefPlaced *image)
{
    long count = 0;
    for (int s = -1; s < chart->seams; s++) {
        RefPlaced one = *placed;
        bool reaches = true;
        for (int i = 0; i < 3 && s >= 0; i++)
            ref_seam_cross(chart->seam + s, placed->corner[i], one.corner[i]);
        for (int d = 0; d < 2; d++) {
            double low = fmin(one.corner[0][d], fmin(one.corner[1][d], one.corner[2][d]));
            double high = fmax(one.corner[0][d], fmax(one.corner[1][d], one.corner[2][d]));
            reaches = reaches && low <= chart->high[d] && high >= chart->low[d];
        }
        if (reaches) image[count++] = one;
    }
    return count;
}

long ref_images_of(const RefChart *chart, const RefPlaced *placed, RefCylinderImages *scratch,
                   RefPlaced *image)
{
    return chart->cylinders ? add_cylinder_images(chart->cylinders, placed, scratch, image)
                            : add_seam_images(chart, placed, image);
}

void ref_images_enter(const RefChart *chart, const RefPlaced *in, double theta[2])
{
    if (chart->cylinders) {
        double middle[2], way[2];
        middle_of(in, middle);
        for (int d = 0; d < 2; d++) way[d] = theta[d] - middle[d];
        ref_cylinders_walk(chart->cylinders, middle, way);
        memcpy(theta, middle, sizeof middle);
        return;
    }
    ref_chart_enter(chart, theta);
    for (int d = 0; d < 2; d++) theta[d] = fmin(fmax(theta[d], chart->low[d]), chart->high[d]);
}
