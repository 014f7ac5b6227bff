#include "field_transfer.h"

#include <string.h>

void ref_field_value(const RefFieldPlace *place, double value[3])
{
    memset(value, 0, sizeof(double[3]));
    for (int n = 0; n < place->count; n++)
        for (int d = 0; d < 3; d++) value[d] += place->part[n][0] * place->u[place->node[n]][d];
}

void ref_field_strains(const RefFieldPlace *place, const RefFrame *frame, double strain[6])
{
    double B[6][3];
    memset(strain, 0, sizeof(double[6]));
    for (int n = 0; n < place->count; n++) {
        const double *u = place->u[place->node[n]];
        ref_thin_strains(frame, place->part[n], B);
        for (int i = 0; i < 6; i++)
            for (int d = 0; d < 3; d++) strain[i] += B[i][d] * u[d];
    }
}

RefFrame ref_field_frame(const RefFieldPlace *place)
{
    return ref_middle_at(place->X, place->count, place->node, place->part);
}

/* Forces that belong to strains, times the area. */
static void stress_of(const RefFrame *frame, const double strain[6], double area,
                      const RefFieldNorm *norm, double stress[6])
{
    double H[3][3], nu = norm->material.poisson, t = norm->thickness;
    double membrane = area * norm->material.young * t / (1 - nu * nu);
    ref_thin_law(frame->inverse, nu, H);
    for (int i = 0; i < 6; i++) {
        double sum = 0;
        for (int j = 0; j < 3; j++) sum += H[i % 3][j] * strain[i / 3 * 3 + j];
        stress[i] = (i < 3 ? membrane : membrane * t * t / 12) * sum;
    }
}

void ref_field_residual(const RefFieldPlace *old, const RefFieldPlace *new, const RefFrame frame[2],
                        const RefFieldSample *sample, const RefFieldNorm *norm,
                        double (*residual)[3])
{
    double value[2][3], strain[2][6], stress[6] = {0}, B[6][3];
    double area = sample->area, whole = area / sample->weight;
    bool stiff = ref_thin_is_stiff(frame + 1, whole, sample->trace);
    if (old->count == 0 || new->count == 0) return;
    ref_field_value(old, value[0]);
    ref_field_value(new, value[1]);
    ref_field_strains(old, frame, strain[0]);
    ref_field_strains(new, frame + 1, strain[1]);
    bool was_stiff = ref_thin_is_stiff(frame, whole, sample->trace);
    double scale = frame[1].area / frame[0].area; /* strains count by the metric they are of */
    for (int i = 0; i < 6; i++)
        strain[0][i] = (was_stiff ? scale * strain[0][i] : 0) - strain[1][i];
    if (stiff) stress_of(frame + 1, strain[0], area, norm, stress);
    double mass = norm->mass_share * norm->material.density * norm->thickness * area;
    for (int n = 0; n < new->count; n++) {
        double *sum = residual[new->node[n]];
        if (stiff) ref_thin_strains(frame + 1, new->part[n], B);
        for (int d = 0; d < 3; d++) {
            sum[d] += mass * new->part[n][0] * (value[0][d] - value[1][d]);
            for (int i = 0; stiff && i < 6; i++) sum[d] += B[i][d] * stress[i];
        }
    }
}
