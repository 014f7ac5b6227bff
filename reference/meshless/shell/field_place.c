#include "field_place.h"

#include <string.h>

#include "../motion/frame_sums.h"

RefFieldPlace ref_field_sample(const RefSamples *samples, long p, const double (*u)[3])
{
    long at = samples->start[p];
    return (RefFieldPlace){(int)(samples->start[p + 1] - at), samples->node + at,
                           (const double(*)[6])samples->part + at, u};
}

void ref_field_value(const RefFieldPlace *place, double value[3])
{
    memset(value, 0, sizeof(double[3]));
    for (int n = 0; n < place->count; n++)
        for (int d = 0; d < 3; d++) value[d] += place->part[n][0] * place->u[place->node[n]][d];
}

/* Strains are linear in the field's derivatives: of the sums of these once, not of each node's. */
void ref_field_strains(const RefFieldPlace *place, const RefFrame *frame, double strain[6])
{
    double sum[3][6];
    ref_frame_sums.derive(place->count, place->node, place->part, place->u, sum);
    ref_thin_strains(frame, (const double(*)[6])sum, strain);
}

void ref_field_root(const RefFieldPlace *place, const RefFrame *frame, double thickness,
                    const RefMaterial *material, double root[6])
{
    double strain[6], G[3][3], weight[2];
    ref_field_strains(place, frame, strain);
    ref_thin_factor(frame->inverse, material->poisson, G);
    ref_thin_weights(1, thickness, material, weight);
    for (int i = 0; i < 6; i++) {
        double sum = 0;
        for (int j = i % 3; j < 3; j++) sum += G[i % 3][j] * strain[i / 3 * 3 + j];
        root[i] = weight[i / 3] * sum;
    }
}

void ref_field_pull(const RefFieldPlace *place, const RefFrame *frame, double thickness,
                    const RefMaterial *material, const double root[6], double area,
                    double (*force)[3])
{
    double stress[6] = {0}, G[3][3], weight[2], pull[6][3];
    ref_thin_factor(frame->inverse, material->poisson, G);
    ref_thin_weights(1, thickness, material, weight);
    for (int i = 0; i < 6; i++)
        for (int j = i % 3; j < 3; j++)
            stress[i / 3 * 3 + j] += area * weight[i / 3] * G[i % 3][j] * root[i];
    ref_thin_pull(frame, stress, pull);
    ref_frame_sums.pull(place->count, place->node, place->part, (const double(*)[3])pull, force);
}
