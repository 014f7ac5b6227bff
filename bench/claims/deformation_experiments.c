#include "deformation_experiments.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../fastlsm/fastlsm.h"
#include "../../reference/shape_matching.h"
#include "../beam/clamped_beam.h"
#include "../engines.h"
#include "../play/playback.h"
#include "checked_block.h"

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
        double moved = length(block->x[p], block->x0[p]);
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
static void smooth(BenchBlock *block, int w, int half, BenchCurve *curve)
{
    char reason[160];
    long section = (long)block->size[0] * block->size[1];
    for (long p = half * section; p < (half + 1) * section; p++) block->x[p][1] += 1;
    for (int s = 0; s < 2 && curve->valid; s++) {
        if (!bench_block_goals(block, sizeof reason, reason))
            bench_curve_fail(curve, "w = %d: %s", w, reason);
        memcpy(block->x, block->g, (size_t)block->particles * sizeof *block->x);
    }
}

static void keep_profile(BenchLab *lab, int w, const double *share, int half)
{
    BenchCurve profile;
    bench_curve_begin(&profile, "distance, cells", "share of the displacement");
    snprintf(profile.name, sizeof profile.name, "smoothing.w%d.profile", w);
    for (int d = 0; d <= half; d++) bench_curve_add(&profile, d, share[d], share[d], share[d]);
    for (int c = 0; c < lab->curves; c++)
        if (!strcmp(lab->curve[c].name, profile.name)) return;
    bench_lab_keep(lab, &profile);
}

_Static_assert(4 * BENCH_MOST_W + 2 < BENCH_CURVE_POINTS, "a profile is longer than a curve");

void bench_deform_smoothing(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve)
{
    int w[BENCH_RANGE_POINTS], count = bench_range_numbers(&measure->w, w);
    int half = 4 * w[count - 1] + 2; /* a step reaches 2 w; there are cells that nothing reaches */
    int side = lab->quick ? 5 : 9;
    const int size[3] = {side, side, 2 * half + 1};
    double share[BENCH_CURVE_POINTS];
    bench_curve_begin(curve, "w", "mean distance of the displacement, cells");
    for (int c = 0; c < count && curve->valid; c++) {
        BenchBlock block;
        SmError error;
        if (bench_block_create(size, &fastlsm_engine_f64, w[c], &block, &error)) {
            bench_curve_fail(curve, "%.180s", error.text);
            return;
        }
        smooth(&block, w[c], half, curve);
        double mean = profile_of(&block, half, share);
        bench_curve_add(curve, w[c], mean, mean, mean);
        if (curve->valid) keep_profile(lab, w[c], share, half);
        bench_block_free(&block);
    }
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

static void cluster_goals(BenchBlock *block, BenchMatcher matching, int parts)
{
    static const RefShapeFit fits[] = {[BENCH_BY_RIGID] = {REF_RIGID, 1, false},
                                       [BENCH_BY_LINEAR] = {REF_LINEAR, 1, true},
                                       [BENCH_BY_QUADRATIC] = {REF_QUADRATIC, 1, false}};
    RefRegions clusters;
    double *mass = sm_alloc((size_t)block->particles, sizeof *mass);
    for (long p = 0; p < block->particles; p++) mass[p] = 1;
    ref_shape_slabs(block->particles, (const double(*)[3])block->x0, 2, parts, 0.25, &clusters);
    ref_shape_goals(&clusters, &fits[matching], (const double(*)[3])block->x0, mass,
                    (const double(*)[3])block->x, block->g);
    ref_regions_free(&clusters);
    free(mass);
}

void bench_deform_blending(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve)
{
    (void)lab;
    int parts[BENCH_RANGE_POINTS], count = bench_range_numbers(&measure->n, parts);
    const int size[3] = {BAR, BAR, BAR_LENGTH};
    char reason[160];
    BenchBlock block;
    SmError error;
    bench_curve_begin(curve, "clusters", "largest jump of the displacement gradient");
    if (bench_block_create(size, &fastlsm_engine_f64, BAR_W, &block, &error)) {
        bench_curve_fail(curve, "%.180s", error.text);
        return;
    }
    for (long p = 0; p < block.particles; p++) {
        double rest[3];
        for (int d = 0; d < 3; d++) rest[d] = block.x0[p][d] - (size[d] - 1) / 2.0;
        bench_deform_place(rest, BAR_LENGTH - 1, block.x[p]);
    }
    if (!bench_block_goals(&block, sizeof reason, reason)) bench_curve_fail(curve, "%s", reason);
    for (int c = 0; c < count; c++) {
        if (measure->matching != BENCH_BY_LATTICE)
            cluster_goals(&block, measure->matching, parts[c]);
        double jump = bench_deform_jump(size, (const double(*)[3])block.g);
        bench_curve_add(curve, parts[c], jump, jump, jump);
    }
    bench_block_free(&block);
}

/* ---- sag */

/* A scene whose body hangs. */
typedef struct {
    BenchScene scene;
    BenchBody body;
    const SmEngineType *type;
    double down[3]; /* unit vector along gravity */
} Hanging;

static SmCode prepare(const char *name, Hanging *hanging, SmError *error)
{
    BenchScene *scene = &hanging->scene;
    SmCode code = bench_scene_find(name, scene, error);
    if (code) return code;
    const double none[3] = {0}, *gravity = scene->params.gravity;
    double pull = length(gravity, none);
    if (!(pull > 0) || scene->handle_count == 0 || scene->instances != 1)
        return sm_fail(error, SM_INPUT,
                       "%.100s: nothing sags: one body with a handle and gravity is wanted",
                       scene->file);
    for (int d = 0; d < 3; d++) hanging->down[d] = gravity[d] / pull;
    code = bench_engine_find(scene->engine, NULL, &hanging->type, error);
    return code ? code : bench_body_of_scene(scene, NULL, &hanging->body, error);
}

/* Plays the scene to its end; the depth is the middle of its last quarter's. */
static void hang(BenchLab *lab, const Hanging *hanging, BenchCurve *curve)
{
    const BenchScene *scene = &hanging->scene;
    int frames = scene->frames, last = frames < 8 ? 1 : frames / 4;
    BenchPlayback play;
    SmError error;
    if (bench_playback_create(scene, &hanging->body, hanging->type, lab->threads, lab->seed, &play,
                              &error)) {
        bench_curve_fail(curve, "%.180s", error.text);
        return;
    }
    BenchClampedBeam beam;
    bench_clamped_beam_create(bench_playback_runner(&play), &beam);
    double *depth = sm_alloc((size_t)last, sizeof *depth);
    for (int f = 0; f < frames; f++) {
        for (int s = 0; s < scene->steps_per_frame; s++) {
            bench_playback_prepare(&play);
            bench_playback_advance(&play, NULL);
        }
        if (f >= frames - last)
            depth[f - (frames - last)] = bench_clamped_beam_tip(&beam, hanging->down);
    }
    bench_curve_check(curve, beam.runner);
    bench_curve_add(curve, scene->params.w, bench_quantile(depth, last, 0.5),
                    bench_quantile(depth, last, 0), bench_quantile(depth, last, 1));
    free(depth);
    bench_clamped_beam_free(&beam);
    bench_playback_free(&play);
}

void bench_deform_sag(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve)
{
    int w[BENCH_RANGE_POINTS], count = bench_range_numbers(&measure->w, w);
    Hanging *hanging = sm_alloc(1, sizeof *hanging);
    SmError error;
    bench_curve_begin(curve, "w", "tip's sag, mesh units");
    if (prepare(measure->scene, hanging, &error))
        bench_curve_fail(curve, "%.180s", error.text);
    else {
        for (int c = 0; c < count && curve->valid; c++) {
            hanging->scene.params.w = w[c];
            hang(lab, hanging, curve);
        }
        bench_body_free(&hanging->body);
    }
    free(hanging);
}
