#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../fastlsm/fastlsm.h"
#include "../../reference/shape_matching.h"
#include "../beam/clamped_beam.h"
#include "../calibrate/elastic_cantilever.h"
#include "../check/solid_block.h"
#include "../engines.h"
#include "experiments.h"

static double length(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* ---- smoothing */

/* The mean displacement of each cross-section at distance d from the middle one, by that of all
 * together; returns the mean distance. */
static double profile_of(const BenchBlock *block, int half, double *share)
{
    double all = 0, mean = 0;
    memset(share, 0, ((size_t)half + 1) * sizeof *share);
    for (long p = 0; p < block->particles; p++) {
        int k = (int)(p / ((long)block->size[0] * block->size[1]));
        double moved = length(block->x[p], block->body.x0[p]);
        share[abs(k - half)] += moved;
        all += moved;
    }
    for (int d = 0; d <= half; d++) {
        share[d] /= all;
        mean += d * share[d];
    }
    return mean;
}

/* Two steps of smoothing: particles go to their goals. */
static void smooth(BenchBlock *block, int half, BenchCurve *curve)
{
    char reason[160];
    long section = (long)block->size[0] * block->size[1];
    for (long p = half * section; p < (half + 1) * section; p++) block->x[p][1] += 1;
    for (int s = 0; s < 2 && curve->valid; s++) {
        if (!bench_block_goals(block, sizeof reason, reason))
            bench_curve_fail(curve, "w = %d: %s", block->w, reason);
        block->type->get(block->engine, SM_GOAL, block->x);
    }
}

static void keep_profile(BenchLab *lab, int w, const double *share, int half)
{
    BenchCurve profile;
    bench_curve_begin(&profile, "distance, cells", "share of the displacement");
    snprintf(profile.name, sizeof profile.name, "smoothing.w%d.profile", w);
    for (int d = 0; d <= half; d++) bench_curve_exact(&profile, d, share[d]);
    for (int c = 0; c < lab->curves; c++)
        if (!strcmp(lab->curve[c].name, profile.name)) return;
    bench_lab_keep(lab, &profile);
}

_Static_assert(4 * BENCH_MOST_W + 2 < BENCH_CURVE_POINTS, "a profile is longer than a curve");

SmCode bench_deform_smoothing(const BenchExperiment *of, SmError *error)
{
    int w[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->w, w);
    int half = 4 * w[count - 1] + 2; /* a step reaches 2 w; there are cells that nothing reaches */
    int side = of->lab->quick ? 5 : 9;
    const int size[3] = {side, side, 2 * half + 1};
    double share[BENCH_CURVE_POINTS];
    for (int c = 0; c < count && of->curve->valid; c++) {
        BenchBlock block;
        const SmEngineParams params = {.w = w[c], .h = 0.01, .threads = 1};
        SmCode code = bench_block_create(size, &fastlsm_engine_f64, &params, &block, error);
        if (code) return code;
        smooth(&block, half, of->curve);
        bench_curve_exact(of->curve, w[c], profile_of(&block, half, share));
        if (of->curve->valid) keep_profile(of->lab, w[c], share, half);
        bench_block_free(&block);
    }
    return SM_OK;
}

/* ---- blending */

enum { BAR = 9, BAR_LENGTH = 41, BAR_W = 2 };

void bench_deform_place(const double rest[3], double along, double place[3])
{
    double turn = M_PI * rest[2] / along, radius = along / M_PI;
    double a = cos(turn) * rest[0] - sin(turn) * rest[1];
    double b = sin(turn) * rest[0] + cos(turn) * rest[1];
    place[0] = (radius + a) * cos(turn) - radius;
    place[1] = b;
    place[2] = (radius + a) * sin(turn);
}

double bench_deform_jump(const int size[3], const double (*g)[3])
{
    const long step[3] = {1, size[0], (long)size[0] * size[1]};
    long count = step[2] * size[2];
    double most = 0;
    for (long p = 0; p < count; p++)
        for (int d = 0; d < 3; d++) {
            long place = p / step[d] % size[d];
            if (place == 0 || place == size[d] - 1) continue;
            double jump[3], none[3] = {0};
            for (int i = 0; i < 3; i++)
                jump[i] = g[p + step[d]][i] - 2 * g[p][i] + g[p - step[d]][i];
            most = fmax(most, length(jump, none));
        }
    return most;
}

static void cluster_goals(const BenchBlock *block, BenchMatcher matching, int parts, double (*g)[3])
{
    static const RefShapeFit fits[] = {[BENCH_BY_RIGID] = {REF_RIGID, 1, false},
                                       [BENCH_BY_LINEAR] = {REF_LINEAR, 1, true},
                                       [BENCH_BY_QUADRATIC] = {REF_QUADRATIC, 1, false}};
    const double(*x0)[3] = (const double(*)[3])block->body.x0;
    RefRegions clusters;
    double *mass = sm_alloc((size_t)block->particles, sizeof *mass);
    block->type->masses(block->engine, mass);
    ref_shape_slabs(block->particles, x0, 2, parts, 0.25, &clusters);
    ref_shape_goals(&clusters, &fits[matching], x0, mass, (const double(*)[3])block->x, g);
    ref_regions_free(&clusters);
    free(mass);
}

SmCode bench_deform_blending(const BenchExperiment *of, SmError *error)
{
    int parts[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->n, parts);
    const int size[3] = {BAR, BAR, BAR_LENGTH};
    const SmEngineParams params = {.w = BAR_W, .h = 0.01, .threads = 1};
    char reason[160];
    BenchBlock block;
    SmCode code = bench_block_create(size, &fastlsm_engine_f64, &params, &block, error);
    if (code) return code;
    for (long p = 0; p < block.particles; p++) {
        double rest[3];
        for (int d = 0; d < 3; d++) rest[d] = block.x[p][d] - (size[d] - 1) / 2.0;
        bench_deform_place(rest, BAR_LENGTH - 1, block.x[p]);
    }
    if (!bench_block_goals(&block, sizeof reason, reason))
        bench_curve_fail(of->curve, "%s", reason);
    double(*g)[3] = sm_alloc((size_t)block.particles, sizeof *g);
    block.type->get(block.engine, SM_GOAL, g);
    for (int c = 0; c < count; c++) {
        if (of->measure->matching != BENCH_BY_LATTICE)
            cluster_goals(&block, of->measure->matching, parts[c], g);
        bench_curve_exact(of->curve, parts[c], bench_deform_jump(size, (const double(*)[3])g));
    }
    free(g);
    bench_block_free(&block);
    return SM_OK;
}

/* ---- sag */

/* At rest under the scene's gravity: how far the tip is then along it. */
static SmCode hang(const BenchExperiment *of, const SmEngineType *type, SmError *error)
{
    BenchClampedBeam beam;
    BenchStiffness found;
    SmCode code = bench_clamped_beam_create(of->scene, of->body, type, &beam, error);
    if (!code) {
        bench_stiffness_measure(&beam, &(BenchBeamTrial){1, 2, beam.gravity}, &found);
        if (found.why[0]) bench_curve_fail(of->curve, "w = %d: %s", of->scene->params.w, found.why);
        bench_curve_check(of->curve, &beam.runner);
        bench_curve_exact(of->curve, of->scene->params.w, found.sag * beam.length);
    }
    bench_clamped_beam_free(&beam);
    return code;
}

SmCode bench_deform_sag(const BenchExperiment *of, SmError *error)
{
    int w[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->w, w);
    BenchScene *scene = of->scene;
    const SmEngineType *type;
    const double none[3] = {0};
    if (!(length(scene->params.gravity, none) > 0) || scene->handle_count == 0 ||
        scene->instances != 1)
        return sm_fail(error, SM_INPUT,
                       "%.100s: nothing sags: one body with a handle and gravity is wanted",
                       scene->file);
    scene->params.damping = 0; /* it does not change where the beam comes to rest */
    SmCode code = bench_engine_find(scene->engine, "double", &type, error);
    for (int c = 0; c < count && !code && of->curve->valid; c++) {
        scene->params.w = w[c];
        code = hang(of, type, error);
    }
    return code;
}

SmCode bench_deform_elastic_sag(const BenchExperiment *of, SmError *error)
{
    const double aspect = 5, poisson = 0.3;
    int across[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->n, across);
    bool quadratic = !strcmp(of->measure->field, "quadratic");
    BenchElasticCantilever theory;
    SmCode code = bench_elastic_cantilever(BENCH_TIMOSHENKO, aspect, poisson, &theory, error);
    for (int c = 0; c < count && !code; c++) {
        long nodes;
        double sag;
        code =
            bench_elastic_sag(aspect, poisson, across[c],
                              quadratic ? REF_MLS_QUADRATIC : REF_MLS_LINEAR, &nodes, &sag, error);
        if (!code) bench_curve_exact(of->curve, (double)nodes, sag / theory.sag);
    }
    return code;
}
