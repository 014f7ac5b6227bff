#include "chart.h"

#include <string.h>

void ref_chart_wrap(RefChart *chart, bool first, bool second)
{
    chart->seams = 0;
    for (int i = first ? -1 : 0; i <= (first ? 1 : 0); i++)
        for (int j = second ? -1 : 0; j <= (second ? 1 : 0); j++) {
            if (i == 0 && j == 0) continue;
            RefSeam *seam = chart->seam + chart->seams++;
            memcpy(seam->low, chart->low, sizeof seam->low);
            memcpy(seam->high, chart->high, sizeof seam->high);
            seam->shift[0] = i * (chart->high[0] - chart->low[0]);
            seam->shift[1] = j * (chart->high[1] - chart->low[1]);
        }
}

static bool holds(const double low[2], const double high[2], const double theta[2])
{
    return theta[0] >= low[0] && theta[0] <= high[0] && theta[1] >= low[1] && theta[1] <= high[1];
}

bool ref_chart_enter(const RefChart *chart, double theta[2])
{
    if (holds(chart->low, chart->high, theta)) return true;
    for (int s = 0; s < chart->seams; s++) {
        const RefSeam *seam = chart->seam + s;
        double there[2] = {theta[0] + seam->shift[0], theta[1] + seam->shift[1]};
        if (!holds(seam->low, seam->high, there)) continue;
        memcpy(theta, there, sizeof there);
        return true;
    }
    return false;
}
