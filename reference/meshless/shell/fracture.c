#include "fracture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"
#include "field_place.h"

/* A tip sees stresses up to this many cells away; a crack begins as many cells from others; arms
 * branch when they are as long; and arms of a branch turn by this angle. */
static const double TIP_CELLS = 1, START_CELLS = 3, BRANCH_CELLS = 2, BRANCH_ANGLE = 0.6;
/* The cosine of the sharpest turn. */
static const double SHARPEST = 0.5;

/* The larger principal stress and the direction across it, from sigma and the metric: an eigenvalue
 * of sigma^km g_ml. */
static void find_principal(RefFaceStress *stress)
{
    const double *s = stress->sigma, *g = stress->metric;
    double mixed[2][2] = {{s[0] * g[0] + s[2] * g[2], s[0] * g[2] + s[2] * g[1]},
                          {s[2] * g[0] + s[1] * g[2], s[2] * g[2] + s[1] * g[1]}};
    double principal = ref_thin_principal((const double(*)[2])mixed);
    double v[2] = {mixed[0][1], principal - mixed[0][0]};
    double w[2] = {principal - mixed[1][1], mixed[1][0]};
    if (w[0] * w[0] + w[1] * w[1] > v[0] * v[0] + v[1] * v[1]) memcpy(v, w, sizeof v);
    stress->principal = principal;
    stress->along[0] = -(g[2] * v[0] + g[1] * v[1]);
    stress->along[1] = g[0] * v[0] + g[2] * v[1];
    double x = stress->along[0], y = stress->along[1], length = sqrt(x * x + y * y);
    for (int d = 0; d < 2; d++) stress->along[d] = length > 0 ? stress->along[d] / length : d == 0;
}

/* The stress at one sample; none, and no metric, where it has no stiffness. */
static RefFaceStress stress_at(const RefCracked *cracked, const RefSamples *samples, long p,
                               const double (*u)[3])
{
    const RefShellOptions *options = &cracked->options;
    RefFieldPlace place = ref_field_sample(samples, p, u);
    const RefFrame *frame = samples->frame + p;
    double strain[6], H[3][3], nu = options->material.poisson;
    RefFaceStress face[2] = {{.theta = {samples->theta[p][0], samples->theta[p][1]}}};
    if (!ref_thin_is_stiff(frame, samples->area[p] / samples->weight[p], samples->trace[p]))
        return face[0];
    ref_field_strains(&place, frame, strain);
    ref_thin_law(frame->inverse, nu, H);
    face[0].metric[0] = sm_dot(frame->tangent[0], frame->tangent[0]);
    face[0].metric[1] = sm_dot(frame->tangent[1], frame->tangent[1]);
    face[0].metric[2] = sm_dot(frame->tangent[0], frame->tangent[1]);
    face[1] = face[0];
    for (int side = 0; side < 2; side++) {
        double far = (side ? -0.5 : 0.5) * options->thickness;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                face[side].sigma[i] += options->material.young / (1 - nu * nu) * H[i][j] *
                                       (strain[j] + far * strain[3 + j]);
        find_principal(face + side);
    }
    return face[face[1].principal > face[0].principal];
}

RefFaceStress *ref_fracture_stresses(const RefCracked *cracked, const double (*u)[3], long *count)
{
    RefFaceStress *stress = sm_alloc(4 * (size_t)cracked->shell->tree.leaves, sizeof *stress);
    *count = 0;
    for (long c = 0; c < cracked->shell->tree.count; c++) {
        if (c + 1 < cracked->shell->tree.count)
            ref_samples_fetch_quarters(&cracked->cell[c + 1].samples);
        for (int q = 0; cracked->cell[c].samples.count && q < 4; q++)
            stress[(*count)++] =
                stress_at(cracked, &cracked->cell[c].samples, ref_samples_quarter(q), u);
    }
    return stress;
}

/* The shorter edge of the terminal cell at a place. */
static double edge_at(const RefCracked *cracked, const double at[2])
{
    const RefQuadtree *tree = &cracked->shell->tree;
    double middle[2], edge[2];
    ref_quadtree_cell(tree, tree->cell + ref_quadtree_at(tree, at), middle, edge);
    return fmin(edge[0], edge[1]);
}

/* The mean of the stresses before a tip, also behind seams and joints, where tensors stay what they
 * are. */
static RefFaceStress mean_before(const RefCracked *cracked, const RefCrackArm *arm, double far,
                                 const RefFaceStress *stress, long count)
{
    const RefChart *chart = cracked->cracks.chart;
    const double tip[2][2] = {{arm->tip[0], arm->tip[1]}, {arm->tip[0], arm->tip[1]}};
    RefChartImages images = {.count = 0};
    RefFaceStress mean = {.theta = {arm->tip[0], arm->tip[1]}};
    double sum = 0;
    ref_chart_images(chart, tip, far, &images);
    for (long s = 0; s < images.count; s++)
        for (long n = 0; n < count; n++) {
            const RefChartImage *image = images.image + s;
            const double *place = image->end[0], *at = stress[n].theta;
            double way[2] = {at[0] - place[0], at[1] - place[1]};
            double weight = 1 - (way[0] * way[0] + way[1] * way[1]) / (far * far);
            double ahead = way[0] * arm->way[0] + way[1] * arm->way[1];
            if (!(weight > 0) || !(stress[n].metric[0] > 0) ||
                (image->turned ? ahead > 0 : ahead < 0) ||
                image->plane != ref_chart_plane(chart, at) ||
                !ref_chart_leads(chart, image, at, place))
                continue;
            sum += weight;
            for (int i = 0; i < 3; i++) {
                mean.sigma[i] += weight * stress[n].sigma[i];
                mean.metric[i] += weight * stress[n].metric[i];
            }
        }
    ref_chart_images_free(&images);
    if (!(sum > 0)) return mean;
    for (int i = 0; i < 3; i++) {
        mean.sigma[i] /= sum;
        mean.metric[i] /= sum;
    }
    find_principal(&mean);
    return mean;
}

/* Grows an arm by half a cell that is turned by an angle. */
static int advance(RefCracked *cracked, int arm, const double way[2], double angle)
{
    const double *tip = cracked->cracks.arm[arm].tip;
    double step = 0.5 * edge_at(cracked, tip);
    double to[2] = {tip[0] + step * (cos(angle) * way[0] - sin(angle) * way[1]),
                    tip[1] + step * (sin(angle) * way[0] + cos(angle) * way[1])};
    ref_cracks_grow(&cracked->cracks, arm, to);
    return 1;
}

/* The way a tip goes: `along`, or as close to it as a turn may be. */
static void steer(const double way[2], const double along[2], double to[2])
{
    double ahead = way[0] * along[0] + way[1] * along[1], sign = ahead < 0 ? -1 : 1;
    double side = sign * (way[0] * along[1] - way[1] * along[0]);
    memcpy(to, along, 2 * sizeof *to);
    if (fabs(ahead) < SHARPEST) {
        double across = copysign(sqrt(1 - SHARPEST * SHARPEST), side);
        to[0] = SHARPEST * way[0] - across * way[1];
        to[1] = SHARPEST * way[1] + across * way[0];
        return;
    }
    for (int d = 0; d < 2; d++) to[d] *= sign;
}

static int grow_tips(RefCracked *cracked, const RefFractureOptions *options,
                     const RefFaceStress *stress, long count)
{
    RefCracks *cracks = &cracked->cracks;
    int made = 0;
    for (int a = 0, arms = (int)cracks->arms; a < arms; a++) {
        const RefCrackArm arm = cracks->arm[a];
        double edge = edge_at(cracked, arm.tip), way[2];
        if (!arm.open || arm.last < 0) continue;
        if (ref_cracks_end_ahead(cracks, a, edge)) {
            made += advance(cracked, a, arm.way, 0);
            continue;
        }
        RefFaceStress mean = mean_before(cracked, &arm, TIP_CELLS * edge, stress, count);
        if (!(mean.principal > options->strength)) continue;
        steer(arm.way, mean.along, way);
        bool branches = options->branching > 0 &&
                        mean.principal > options->branching * options->strength &&
                        arm.length > BRANCH_CELLS * edge;
        if (branches) {
            int branch = ref_cracks_start(cracks, arm.tip, a);
            made += advance(cracked, branch, way, -BRANCH_ANGLE);
        }
        made += advance(cracked, a, way, branches ? BRANCH_ANGLE : 0);
    }
    return made;
}

static int by_principal(const void *a, const void *b)
{
    const RefFaceStress *p = a, *q = b;
    if (p->principal != q->principal) return p->principal > q->principal ? -1 : 1;
    if (p->theta[0] != q->theta[0]) return p->theta[0] < q->theta[0] ? -1 : 1;
    return (p->theta[1] > q->theta[1]) - (p->theta[1] < q->theta[1]);
}

/* Those that are above the strength come first, the largest of them leading; returns how many. */
static long sort_large(double strength, RefFaceStress *stress, long count)
{
    long large = 0;
    for (long n = 0; n < count; n++) {
        if (!(stress[n].principal > strength)) continue;
        RefFaceStress other = stress[large];
        stress[large++] = stress[n];
        stress[n] = other;
    }
    qsort(stress, (size_t)large, sizeof *stress, by_principal);
    return large;
}

static int start_cracks(RefCracked *cracked, const RefFractureOptions *options,
                        RefFaceStress *stress, long count)
{
    RefCracks *cracks = &cracked->cracks;
    int starts = 0;
    long large = options->most_starts > 0 ? sort_large(options->strength, stress, count) : 0;
    for (long n = 0; n < large && starts < options->most_starts; n++) {
        const RefFaceStress *at = stress + n;
        double far = START_CELLS * edge_at(cracked, at->theta);
        if (ref_cracks_distance(cracks, at->theta, far) < far) continue;
        for (int side = -1; side <= 1; side += 2) {
            double way[2] = {side * at->along[0], side * at->along[1]};
            advance(cracked, ref_cracks_start(cracks, at->theta, -1), way, 0);
        }
        starts++;
    }
    return 2 * starts;
}

int ref_fracture_grow(RefCracked *cracked, const RefFractureOptions *options, const double (*u)[3])
{
    long count;
    RefFaceStress *stress = ref_fracture_stresses(cracked, u, &count);
    int made = grow_tips(cracked, options, stress, count);
    made += start_cracks(cracked, options, stress, count);
    free(stress);
    return made;
}
