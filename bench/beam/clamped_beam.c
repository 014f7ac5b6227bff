#include "clamped_beam.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CONST(array) ((const double(*)[3])(array))

enum {
    MOST_STEPS = 400000,  /* of a record, */
    MOST_QUARTER = 20000, /* and before a mode has passed through zero */
    PERIODS = 10,         /* recorded of modes above the first */
    MOST_PERIODS = 30,    /* of relaxing, */
    LOOKS = 20,           /* in each of which so often it may be at rest */
    LOADS = 4
};

static const double height = 1e-4, small_sag = 1e-3, proportional = 0.05; /* of the length */
static const double sags[LOADS] = {0.05, 0.1, 0.2, 0.4};
static const double weight_over_first = 12.362363 / 8; /* omega^2 sag / load in theory */
static const double two_pi = 6.283185307179586;

/* ---- the beam */

static void find_extent(BenchClampedBeam *beam)
{
    const BenchRunner *runner = &beam->runner;
    const SmVoxels *voxels = &runner->body->voxels;
    double high = -INFINITY;
    for (int d = 1; d < 3; d++)
        if (voxels->size[d] > voxels->size[beam->axis]) beam->axis = d;
    beam->low = INFINITY;
    for (long p = 0; p < runner->particles; p++) {
        beam->low = fmin(beam->low, runner->x0[p][beam->axis]);
        high = fmax(high, runner->x0[p][beam->axis]);
    }
    beam->length = high - beam->low;
    for (long p = 0; p < runner->particles; p++)
        if (runner->x0[p][beam->axis] >= high - 0.5 * voxels->cell) beam->tip[beam->tips++] = p;
}

static void find_down(const double g[3], BenchClampedBeam *beam)
{
    const BenchBody *body = beam->runner.body;
    beam->gravity = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    beam->down[1] = -1;
    for (int d = 0; d < 3; d++) {
        if (beam->gravity > 0) beam->down[d] = g[d] / beam->gravity;
        beam->middle += (body->low[d] + body->high[d]) / 2 * beam->down[d];
    }
}

SmCode bench_clamped_beam_create(const BenchScene *scene, const BenchBody *body,
                                 const SmEngineType *type, BenchClampedBeam *beam, SmError *error)
{
    *beam = (BenchClampedBeam){.scene = *scene};
    memset(beam->scene.params.gravity, 0, sizeof beam->scene.params.gravity);
    BenchRunner *runner = &beam->runner;
    SmCode code = bench_runner_create(&beam->scene, body, type, 1, runner, error);
    if (code) return code;
    size_t count = (size_t)runner->particles;
    beam->mass = sm_alloc(count, sizeof *beam->mass);
    beam->tip = sm_alloc(count, sizeof *beam->tip);
    beam->number = sm_alloc(count, sizeof *beam->number);
    beam->x = sm_alloc(count, sizeof *beam->x);
    beam->v = sm_alloc(count, sizeof *beam->v);
    beam->impulse = sm_alloc(count, sizeof *beam->impulse);
    find_extent(beam);
    find_down(scene->params.gravity, beam);
    type->masses(runner->engine, beam->mass);
    for (size_t p = 0; p < count; p++) beam->number[p] = (long)p;
    for (int n = 0; n < runner->bound_count; n++)
        for (long k = 0; k < runner->bound[n].count; k++)
            beam->mass[runner->bound[n].particle[k]] = 0;
    return SM_OK;
}

void bench_clamped_beam_free(BenchClampedBeam *beam)
{
    bench_runner_free(&beam->runner);
    sm_free_all(beam->mass, beam->tip, beam->number, beam->x, beam->v, beam->impulse);
    *beam = (BenchClampedBeam){0};
}

/* Where a particle is along the beam at rest: 0 at the clamp, 1 at the end. */
static double place(const BenchClampedBeam *beam, long particle)
{
    return (beam->runner.x0[particle][beam->axis] - beam->low) / beam->length;
}

/* How far an Euler and Bernoulli's beam is bent down under a constant load: 0 at the clamp, 1 at
 * the end. */
static double sagging(double at)
{
    return at * at * (6 - 4 * at + at * at) / 3;
}

/* Of all particles, or of those that are numbered: the sum of share[p], 1 without, times how far
 * they have moved up from where they are without load. */
static double rise(BenchClampedBeam *beam, long count, const long *number, const double *share)
{
    const BenchRunner *runner = &beam->runner;
    double sum = 0;
    runner->type->get(runner->engine, SM_POSITION, beam->x);
    for (long n = 0; n < count; n++) {
        long p = number[n];
        double up = 0;
        for (int d = 0; d < 3; d++) up -= (beam->x[p][d] - runner->x0[p][d]) * beam->down[d];
        sum += (share ? share[p] : 1) * up;
    }
    return sum;
}

/* A step under a load, and with a drag -rate v; rate h at most 1/2. */
static void step(BenchClampedBeam *beam, double load, double rate)
{
    BenchRunner *runner = &beam->runner;
    double h = beam->scene.params.h;
    if (rate > 0) runner->type->get(runner->engine, SM_VELOCITY, beam->v);
    if (rate > 0 || load != 0) {
        for (long p = 0; p < runner->particles; p++)
            for (int d = 0; d < 3; d++) {
                beam->impulse[p][d] = -h * beam->mass[p] * rate * beam->v[p][d];
                beam->impulse[p][d] += h * beam->mass[p] * (load * beam->down[d]);
            }
        runner->type->push(runner->engine, runner->particles, beam->number, CONST(beam->impulse));
    }
    bench_runner_step(runner);
}

/* Of a mode: mass times shape, over the sum of mass times shape squared. */
static double *find_share(const BenchClampedBeam *beam, int mode)
{
    long particles = beam->runner.particles;
    double *share = sm_alloc((size_t)particles, sizeof *share), all = 0, slope;
    for (long p = 0; p < particles; p++) {
        double shape = ref_beam_shape(mode, place(beam, p), &slope) / 2;
        share[p] = beam->mass[p] * shape;
        all += share[p] * shape;
    }
    for (long p = 0; p < particles; p++) share[p] /= all;
    return share;
}

/* Puts it at rest in the shape that theory gives a mode (reference/beam_theory.h), its tip `up`
 * high; cross-sections stay straight. */
static void bend(BenchClampedBeam *beam, int mode, double up)
{
    const BenchRunner *runner = &beam->runner;
    size_t count = (size_t)runner->particles;
    for (size_t p = 0; p < count; p++) {
        const double *from = runner->x0[p];
        memcpy(beam->x[p], from, sizeof beam->x[p]);
        if (beam->mass[p] == 0) continue;
        double slope, shape = ref_beam_shape(mode, place(beam, (long)p), &slope) / 2;
        double deep = -beam->middle;
        for (int d = 0; d < 3; d++) {
            deep += from[d] * beam->down[d];
            beam->x[p][d] -= up * (shape * beam->down[d]);
        }
        beam->x[p][beam->axis] += up * slope / (2 * beam->length) * deep;
    }
    memset(beam->v, 0, count * sizeof *beam->v);
    runner->type->set(runner->engine, SM_POSITION, CONST(beam->x));
    runner->type->set(runner->engine, SM_VELOCITY, CONST(beam->v));
}

/* How far its end hangs down, of its length: the tip carried on to the end as theory has a beam
 * sag, since an octree's nodes are in cells. */
static double find_sag(BenchClampedBeam *beam)
{
    double tip = -rise(beam, beam->tips, beam->tip, NULL) / (double)beam->tips;
    return tip / sagging(place(beam, beam->tip[0])) / beam->length;
}

/* How far from rest under the load: the rms acceleration of what is free, by mass, as a share of
 * it. The beam stops, and takes a step. */
static double find_unrest(BenchClampedBeam *beam, double load)
{
    const BenchRunner *runner = &beam->runner;
    double sum = 0, mass = 0, change = load * beam->scene.params.h;
    memset(beam->v, 0, (size_t)runner->particles * sizeof *beam->v);
    runner->type->set(runner->engine, SM_VELOCITY, CONST(beam->v));
    step(beam, load, 0);
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
    sm_make_room(record->value, record->room, record->count + 1);
    record->value[record->count++] = value;
}

/* Lets the mode go and records it until it has passed through zero often enough. */
static bool record_mode(BenchClampedBeam *beam, int mode, int periods, Record *record)
{
    double before = height * beam->length, first = 0, *share = find_share(beam, mode);
    int passed = 0, wanted = 2 * periods;
    bend(beam, mode, before);
    record->count = 0;
    while (record->count < (passed ? MOST_STEPS : MOST_QUARTER) && isfinite(before) &&
           passed <= wanted) {
        keep(record, before);
        step(beam, 0, 0);
        double now = rise(beam, beam->runner.particles, beam->number, share);
        if ((before > 0) != (now > 0)) {
            double at = (double)record->count - 1 + before / (before - now);
            if (passed == 0) first = at;
            record->turns = passed / (2 * (at - first));
            passed++;
        }
        before = now;
    }
    free(share);
    return passed > wanted;
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
static void analyse(const BenchClampedBeam *beam, const Record *record, int mode,
                    BenchStiffness *found)
{
    Part whole = {record->value, record->count};
    double turns = peak(&whole, record->turns);
    double *pure = sm_alloc((size_t)record->count, sizeof *pure);
    for (long n = 0; n < record->count; n++) pure[n] = cos(two_pi * turns * (double)n);
    double lost = fall(record->value, record->count, turns) - fall(pure, record->count, turns);
    free(pure);
    found->frequency[mode] = turns / beam->scene.params.h;
    found->loss[mode] = lost / (two_pi / 2 * turns * (double)(record->count / 2));
}

/* Until it is at rest under the load; `omega` is that of the first mode. */
static bool relax(BenchClampedBeam *beam, double load, double omega, double *unrest)
{
    double h = beam->scene.params.h, rate = fmin(2 * omega, 0.5 / h);
    long look = (long)ceil(two_pi / (omega * h) / LOOKS);
    for (int i = 0; i < MOST_PERIODS * LOOKS; i++) {
        for (long n = 0; n < look; n++) step(beam, load, rate);
        *unrest = find_unrest(beam, load);
        if (*unrest < BENCH_REST) return true;
    }
    return false;
}

static bool settle(BenchClampedBeam *beam, double load, BenchStiffness *found)
{
    double omega = two_pi * found->frequency[0];
    double small = omega * omega * small_sag * beam->length / weight_over_first;
    found->load = load > 0 ? load : small;
    bend(beam, 0, -small_sag * beam->length);
    if (!relax(beam, found->load, omega, &found->unrest)) return false;
    found->sag = find_sag(beam);
    return true;
}

void bench_stiffness_measure(BenchClampedBeam *beam, const BenchBeamTrial *trial,
                             BenchStiffness *found)
{
    *found = have_none();
    Record record = {0};
    for (int k = 0; k < trial->tones && !found->why[0]; k++) {
        int periods = k == 0 ? trial->periods : PERIODS;
        if (record_mode(beam, k, periods, &record))
            analyse(beam, &record, k, found);
        else
            snprintf(found->why, sizeof found->why,
                     "mode %d does not swing to and fro %d times in %ld steps", k + 1, periods,
                     record.count);
    }
    free(record.value);
    if (!found->why[0] && !settle(beam, trial->load, found))
        snprintf(found->why, sizeof found->why,
                 "it is not at rest after %d periods: %.2g of its weight is left over",
                 MOST_PERIODS, found->unrest);
    if (!found->why[0] && !(found->sag > 0))
        snprintf(found->why, sizeof found->why, "its high end along %c does not sag",
                 "xyz"[beam->axis]);
    if (found->why[0]) {
        BenchStiffness none = have_none();
        snprintf(none.why, sizeof none.why, "%s", found->why);
        *found = none;
    }
}

void bench_stiffness_range(BenchClampedBeam *beam, BenchStiffness *found)
{
    double omega = two_pi * found->frequency[0];
    for (int i = 0; i < LOADS && !found->why[0]; i++) {
        double load = found->load * sags[i] / found->sag, unrest;
        if (i == 0) found->linear_to = 0;
        if (!relax(beam, load, omega, &unrest)) return;
        double sag = find_sag(beam);
        if (!(fabs(sag / sags[i] - 1) <= proportional)) return;
        found->linear_to = sags[i];
    }
}
