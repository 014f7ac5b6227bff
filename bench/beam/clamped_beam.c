#include "clamped_beam.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CONST(array) ((const double(*)[3])(array))

static const double near_end = 1e-6; /* of a cell */

static void find_extent(BenchClampedBeam *beam)
{
    const BenchRunner *runner = beam->runner;
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

void bench_clamped_beam_create(BenchRunner *runner, BenchClampedBeam *beam)
{
    size_t count = (size_t)runner->particles;
    *beam = (BenchClampedBeam){.runner = runner,
                               .mass = sm_alloc(count, sizeof *beam->mass),
                               .tip = sm_alloc(count, sizeof *beam->tip),
                               .number = sm_alloc(count, sizeof *beam->number),
                               .x = sm_alloc(count, sizeof *beam->x),
                               .v = sm_alloc(count, sizeof *beam->v),
                               .impulse = sm_alloc(count, sizeof *beam->impulse)};
    find_extent(beam);
    runner->type->masses(runner->engine, beam->mass);
    for (size_t p = 0; p < count; p++) beam->number[p] = (long)p;
    for (int n = 0; n < runner->bound_count; n++)
        for (long k = 0; k < runner->bound[n].count; k++)
            beam->mass[runner->bound[n].particle[k]] = 0;
}

void bench_clamped_beam_free(BenchClampedBeam *beam)
{
    free(beam->mass);
    free(beam->tip);
    free(beam->number);
    free(beam->x);
    free(beam->v);
    free(beam->impulse);
    *beam = (BenchClampedBeam){0};
}

double bench_clamped_beam_at(const BenchClampedBeam *beam, long particle)
{
    return (beam->runner->x0[particle][beam->axis] - beam->low) / beam->length;
}

double bench_clamped_beam_sag(double at)
{
    return at * at * (6 - 4 * at + at * at) / 3;
}

double bench_clamped_beam_tip(BenchClampedBeam *beam, const double way[3])
{
    const BenchRunner *runner = beam->runner;
    double sum = 0;
    runner->type->get(runner->engine, SM_POSITION, beam->x);
    for (long t = 0; t < beam->tips; t++) {
        long p = beam->tip[t];
        for (int d = 0; d < 3; d++) sum += (beam->x[p][d] - runner->x0[p][d]) * way[d];
    }
    return sum / (double)beam->tips;
}

double bench_clamped_beam_rise(BenchClampedBeam *beam, const double *share)
{
    const BenchRunner *runner = beam->runner;
    double sum = 0;
    runner->type->get(runner->engine, SM_POSITION, beam->x);
    for (long p = 0; p < runner->particles; p++)
        sum += share[p] * (beam->x[p][1] - runner->x0[p][1]);
    return sum;
}

void bench_clamped_beam_step(BenchClampedBeam *beam, double acceleration, double rate)
{
    BenchRunner *runner = beam->runner;
    double h = runner->scene->params.h;
    if (rate > 0) runner->type->get(runner->engine, SM_VELOCITY, beam->v);
    if (rate > 0 || acceleration != 0) {
        for (long p = 0; p < runner->particles; p++) {
            for (int d = 0; d < 3; d++)
                beam->impulse[p][d] = -h * beam->mass[p] * rate * beam->v[p][d];
            beam->impulse[p][1] += h * beam->mass[p] * acceleration;
        }
        runner->type->push(runner->engine, runner->particles, beam->number, CONST(beam->impulse));
    }
    bench_runner_step(runner, NULL);
}

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

void bench_cantilever_bend(BenchCantilever *cantilever, int mode, double up)
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

double bench_cantilever_sag(BenchCantilever *cantilever)
{
    static const double down[3] = {0, -1, 0};
    BenchClampedBeam *beam = &cantilever->beam;
    double at = bench_clamped_beam_at(beam, beam->tip[0]);
    return bench_clamped_beam_tip(beam, down) / bench_clamped_beam_sag(at) / beam->length;
}

double bench_cantilever_unrest(BenchCantilever *cantilever, double acceleration)
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
