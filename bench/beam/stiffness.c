#include "stiffness.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CONST(array) ((const double(*)[3])(array))

enum { MOST_STEPS = 400000, LOADS = 4, MOST_PERIODS = 30, LOOKS = 20 };

static const int periods[BENCH_TONES] = {5, 10, 10};
static const double height = 1e-4, small_sag = 1e-3, proportional = 0.05; /* of the length */
static const double sags[LOADS] = {0.05, 0.1, 0.2, 0.4};
static const double weight_over_first = 12.362363 / 8; /* omega^2 sag / load in theory */
static const double two_pi = 6.283185307179586;
static const double near_end = 1e-6; /* of a cell */

/* ---- a cantilever */

/* The whole as a box of twelve triangles. */
static SmMesh make_box(const double low[3], const double high[3])
{
    static const int side[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                    {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                    {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    SmMesh mesh = sm_mesh_new(8, 12);
    for (int c = 0; c < 8; c++)
        for (int d = 0; d < 3; d++) mesh.position[c][d] = c >> d & 1 ? high[d] : low[d];
    memcpy(mesh.triangle, side, sizeof side);
    return mesh;
}

static void make_scene(const BenchCantileverOptions *options, BenchScene *scene)
{
    bench_scene_init(scene);
    snprintf(scene->name, sizeof scene->name, "cantilever");
    snprintf(scene->file, sizeof scene->file, "cantilever");
    snprintf(scene->mesh, sizeof scene->mesh, "cantilever");
    snprintf(scene->engine, sizeof scene->engine, "%s", options->engine);
    scene->voxel = (SmVoxelParams){.fill = SM_SOLID, .cell = options->cell};
    scene->density = options->density;
    scene->params.h = options->h;
    scene->params.damping = options->damping;
    scene->params.w = (int)options->w;
    memset(scene->params.gravity, 0, sizeof scene->params.gravity);
    scene->octree.width = (OctWidth){.edges = options->w};
    scene->octree.epsilon = options->epsilon;
    scene->octree.sampling.criteria[0] = (OctCriterion){.kind = OCT_UNIFORM};
    scene->octree.sampling.criteria_count = 1;
    double held = options->root + near_end, all = options->root + options->along;
    scene->handle_count = 1;
    scene->handle[0] = (BenchHandle){.select = {.high = {held / all, 1, 1}}};
}

/* Of a mode: mass times shape, over the sum of mass times shape squared. */
static double *find_share(const BenchClampedBeam *beam, int mode)
{
    long particles = beam->runner->particles;
    double *share = sm_alloc((size_t)particles, sizeof *share), all = 0, slope;
    for (long p = 0; p < particles; p++) {
        double shape = ref_beam_shape(mode, bench_clamped_beam_at(beam, p), &slope) / 2;
        share[p] = beam->mass[p] * shape;
        all += share[p] * shape;
    }
    for (long p = 0; p < particles; p++) share[p] /= all;
    return share;
}

SmCode bench_cantilever_create(const BenchCantileverOptions *options, const SmEngineType *type,
                               BenchCantilever *cantilever, SmError *error)
{
    memset(cantilever, 0, sizeof *cantilever);
    BenchScene *scene = &cantilever->scene;
    BenchClampedBeam *beam = &cantilever->beam;
    make_scene(options, scene);
    double a = options->cell, half = a * options->across / 2, length = a * options->along;
    SmMesh mesh =
        make_box((double[]){-a * options->root, -half, -half}, (double[]){length, half, half});
    SmCode code = bench_body_create(scene, &mesh, &cantilever->body, error);
    if (!code)
        code = bench_runner_create(scene, &cantilever->body, type, 1, &cantilever->runner, error);
    if (code) return code;
    bench_clamped_beam_create(&cantilever->runner, beam);
    beam->low = 0;
    beam->length = length;
    for (int k = 0; k < REF_BEAM_MODES; k++) cantilever->share[k] = find_share(beam, k);
    return SM_OK;
}

void bench_cantilever_free(BenchCantilever *cantilever)
{
    bench_clamped_beam_free(&cantilever->beam);
    bench_runner_free(&cantilever->runner);
    bench_body_free(&cantilever->body);
    for (int k = 0; k < REF_BEAM_MODES; k++) free(cantilever->share[k]);
    memset(cantilever, 0, sizeof *cantilever);
}

/* Puts it at rest in the shape that theory gives a mode (reference/beam_theory.h), its tip `up`
 * high; cross-sections stay straight. */
static void bend(BenchCantilever *cantilever, int mode, double up)
{
    BenchClampedBeam *beam = &cantilever->beam;
    const BenchRunner *runner = beam->runner;
    size_t count = (size_t)runner->particles;
    for (size_t p = 0; p < count; p++) {
        const double *from = runner->x0[p];
        double slope, at = bench_clamped_beam_at(beam, (long)p);
        double shape = ref_beam_shape(mode, at, &slope) / 2;
        bool free = beam->mass[p] > 0;
        beam->x[p][0] = from[0] - (free ? up * slope / (2 * beam->length) * from[1] : 0);
        beam->x[p][1] = from[1] + (free ? up * shape : 0);
        beam->x[p][2] = from[2];
    }
    memset(beam->v, 0, count * sizeof *beam->v);
    runner->type->set(runner->engine, SM_POSITION, CONST(beam->x));
    runner->type->set(runner->engine, SM_VELOCITY, CONST(beam->v));
}

/* How far its end hangs down, of its length: the tip carried on to the end as theory has a beam
 * sag, since an octree's nodes are in cells. */
static double find_sag(BenchCantilever *cantilever)
{
    static const double down[3] = {0, -1, 0};
    BenchClampedBeam *beam = &cantilever->beam;
    double at = bench_clamped_beam_at(beam, beam->tip[0]);
    return bench_clamped_beam_tip(beam, down) / bench_clamped_beam_sag(at) / beam->length;
}

/* How far from rest under the acceleration: the rms acceleration of what is free, by mass, as a
 * share of it. The beam stops, and takes a step. */
static double find_unrest(BenchCantilever *cantilever, double acceleration)
{
    BenchClampedBeam *beam = &cantilever->beam;
    const BenchRunner *runner = beam->runner;
    double sum = 0, mass = 0, change = acceleration * runner->scene->params.h;
    memset(beam->v, 0, (size_t)runner->particles * sizeof *beam->v);
    runner->type->set(runner->engine, SM_VELOCITY, CONST(beam->v));
    bench_clamped_beam_step(beam, acceleration, 0);
    runner->type->get(runner->engine, SM_VELOCITY, beam->v);
    for (long p = 0; p < runner->particles; p++) {
        mass += beam->mass[p];
        for (int d = 0; d < 3; d++) sum += beam->mass[p] * beam->v[p][d] * beam->v[p][d];
    }
    return sqrt(sum / mass) / fabs(change);
}

/* ---- what it does */

/* A mode's height, step by step. */
typedef struct {
    long count, room;
    double *value;
    double turns; /* a step: its frequency by passages through zero */
} Record;

/* None of it had: NaN everywhere. */
static BenchStiffness have_none(void)
{
    BenchStiffness none = {.load = NAN, .sag = NAN, .unrest = NAN, .linear_to = NAN};
    for (int k = 0; k < BENCH_TONES; k++) none.frequency[k] = none.loss[k] = NAN;
    return none;
}

static void keep(Record *record, double value)
{
    if (record->count == record->room) {
        record->room = 2 * record->room + 1024;
        record->value = sm_realloc(record->value, (size_t)record->room, sizeof *record->value);
    }
    record->value[record->count++] = value;
}

/* Lets the mode go and records it until it has passed through zero often enough. */
static bool record_mode(BenchCantilever *cantilever, int mode, Record *record)
{
    BenchClampedBeam *beam = &cantilever->beam;
    double before = height * beam->length, first = 0;
    int passed = 0;
    bend(cantilever, mode, before);
    record->count = 0;
    while (record->count < MOST_STEPS && isfinite(before)) {
        keep(record, before);
        bench_clamped_beam_step(beam, 0, 0);
        double now = bench_clamped_beam_rise(beam, cantilever->share[mode]);
        if ((before > 0) != (now > 0)) {
            double at = (double)record->count - 1 + before / (before - now);
            if (passed == 0) first = at;
            record->turns = passed / (2 * (at - first));
            if (passed++ == 2 * periods[mode]) return true;
        }
        before = now;
    }
    return false;
}

typedef struct {
    const double *value;
    long count;
} Part;

/* |Fourier transform| at so many turns a step, under Hann's window, negative: to be minimised. */
static double spectrum(double turns, void *part)
{
    const Part *p = part;
    double even = 0, odd = 0;
    for (long n = 0; n < p->count; n++) {
        double hann = 1 - cos(two_pi * ((double)n + 0.5) / (double)p->count);
        even += hann * p->value[n] * cos(two_pi * turns * (double)n);
        odd += hann * p->value[n] * sin(two_pi * turns * (double)n);
    }
    return -hypot(even, odd);
}

/* The highest place of the spectrum near `turns`; its lobe is two periods of the record wide. */
static double peak(Part *part, double turns)
{
    gsl_function function = {spectrum, part};
    gsl_min_fminimizer *search = gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent);
    double lobe = 0.8 / (double)part->count, found = turns;
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    if (!gsl_min_fminimizer_set(search, &function, turns, turns - lobe, turns + lobe)) {
        for (int i = 0; i < 40; i++) {
            if (gsl_min_fminimizer_iterate(search)) break;
            double low = gsl_min_fminimizer_x_lower(search),
                   high = gsl_min_fminimizer_x_upper(search);
            if (gsl_min_test_interval(low, high, 0, 1e-9) == GSL_SUCCESS) break;
        }
        found = gsl_min_fminimizer_x_minimum(search);
    }
    gsl_set_error_handler(handler);
    gsl_min_fminimizer_free(search);
    return found;
}

/* How much lower, in logarithms, the second half is than the first. */
static double fall(const double *value, long count, double turns)
{
    Part first = {value, count / 2}, second = {value + count / 2, count / 2};
    return log(spectrum(turns, &first) / spectrum(turns, &second));
}

/* A tone that loses nothing falls, too, by the window's leakage: that is taken off. */
static void analyse(const BenchCantilever *cantilever, const Record *record, int mode,
                    BenchStiffness *found)
{
    Part whole = {record->value, record->count};
    double turns = peak(&whole, record->turns);
    double *pure = sm_alloc((size_t)record->count, sizeof *pure);
    for (long n = 0; n < record->count; n++) pure[n] = cos(two_pi * turns * (double)n);
    double lost = fall(record->value, record->count, turns) - fall(pure, record->count, turns);
    free(pure);
    found->frequency[mode] = turns / cantilever->scene.params.h;
    found->loss[mode] = lost / (two_pi / 2 * turns * (double)(record->count / 2));
}

/* Until it is at rest under the load; `omega` is that of the first mode. */
static bool relax(BenchCantilever *cantilever, double load, double omega, double *unrest)
{
    double h = cantilever->scene.params.h, rate = fmin(2 * omega, 0.5 / h);
    long look = (long)ceil(two_pi / (omega * h) / LOOKS);
    for (int i = 0; i < MOST_PERIODS * LOOKS; i++) {
        for (long step = 0; step < look; step++)
            bench_clamped_beam_step(&cantilever->beam, -load, rate);
        *unrest = find_unrest(cantilever, -load);
        if (*unrest < BENCH_REST) return true;
    }
    return false;
}

static bool settle(BenchCantilever *cantilever, BenchStiffness *found)
{
    double omega = two_pi * found->frequency[0];
    found->load = omega * omega * small_sag * cantilever->beam.length / weight_over_first;
    bend(cantilever, 0, -small_sag * cantilever->beam.length);
    if (!relax(cantilever, found->load, omega, &found->unrest)) return false;
    found->sag = find_sag(cantilever);
    return found->sag > 0;
}

void bench_stiffness_measure(BenchCantilever *cantilever, BenchStiffness *found)
{
    *found = have_none();
    Record record = {0};
    for (int k = 0; k < BENCH_TONES && !found->why[0]; k++) {
        if (record_mode(cantilever, k, &record))
            analyse(cantilever, &record, k, found);
        else
            snprintf(found->why, sizeof found->why,
                     "mode %d does not swing to and fro %d times in %d steps", k + 1, periods[k],
                     MOST_STEPS);
    }
    free(record.value);
    if (!found->why[0] && !settle(cantilever, found))
        snprintf(found->why, sizeof found->why,
                 "it is not at rest after %d periods: %.2g of its weight is left over",
                 MOST_PERIODS, found->unrest);
    if (found->why[0]) {
        BenchStiffness none = have_none();
        snprintf(none.why, sizeof none.why, "%s", found->why);
        *found = none;
    }
}

void bench_stiffness_range(BenchCantilever *cantilever, BenchStiffness *found)
{
    double omega = two_pi * found->frequency[0];
    for (int i = 0; i < LOADS && !found->why[0]; i++) {
        double load = found->load * sags[i] / found->sag, unrest;
        if (i == 0) found->linear_to = 0;
        if (!relax(cantilever, load, omega, &unrest)) return;
        double sag = find_sag(cantilever);
        if (!(fabs(sag / sags[i] - 1) <= proportional)) return;
        found->linear_to = sags[i];
    }
}
