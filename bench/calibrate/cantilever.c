#include "cantilever.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CONST(array) ((const double(*)[3])(array))

static const double near_end = 1e-6; /* of a cell */

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

static void find_particles(const BenchCantileverOptions *options, BenchCantilever *beam)
{
    const BenchRunner *runner = &beam->runner;
    size_t count = (size_t)runner->particles;
    beam->weight = sm_alloc(count, sizeof *beam->weight);
    beam->tip = sm_alloc(count, sizeof *beam->tip);
    beam->number = sm_alloc(count, sizeof *beam->number);
    beam->x = sm_alloc(count, sizeof *beam->x);
    beam->v = sm_alloc(count, sizeof *beam->v);
    beam->impulse = sm_alloc(count, sizeof *beam->impulse);
    runner->type->masses(runner->engine, beam->weight);
    double end = 0;
    for (size_t p = 0; p < count; p++) end = fmax(end, runner->x0[p][0]);
    for (size_t p = 0; p < count; p++) {
        beam->number[p] = (long)p;
        beam->tip[p] = runner->x0[p][0] > end - near_end * options->cell;
        beam->tips += beam->tip[p];
    }
    double s = end / beam->length;
    beam->short_of = s * s * (6 - 4 * s + s * s) / 3;
    for (int n = 0; n < runner->bound_count; n++)
        for (long k = 0; k < runner->bound[n].count; k++)
            beam->weight[runner->bound[n].particle[k]] = 0;
    for (size_t p = 0; p < count; p++) beam->mass += beam->weight[p];
}

/* Of a mode: weight times shape, over the sum of weight times shape squared. */
static void find_share(BenchCantilever *beam, int mode)
{
    const BenchRunner *runner = &beam->runner;
    double *share = beam->share[mode] = sm_alloc((size_t)runner->particles, sizeof *share);
    double all = 0, slope;
    for (long p = 0; p < runner->particles; p++) {
        double shape = ref_beam_shape(mode, runner->x0[p][0] / beam->length, &slope) / 2;
        share[p] = beam->weight[p] * shape;
        all += share[p] * shape;
    }
    for (long p = 0; p < runner->particles; p++) share[p] /= all;
}

SmCode bench_cantilever_create(const BenchCantileverOptions *options, const SmEngineType *type,
                               BenchCantilever *beam, SmError *error)
{
    memset(beam, 0, sizeof *beam);
    make_scene(options, &beam->scene);
    double a = options->cell, half = a * options->across / 2;
    beam->length = a * options->along;
    SmMesh mesh = make_box((double[]){-a * options->root, -half, -half},
                           (double[]){beam->length, half, half});
    SmCode code = bench_body_create(&beam->scene, &mesh, &beam->body, error);
    if (!code) code = bench_runner_create(&beam->scene, &beam->body, type, 1, &beam->runner, error);
    if (code) return code;
    find_particles(options, beam);
    for (int k = 0; k < REF_BEAM_MODES; k++) find_share(beam, k);
    return SM_OK;
}

void bench_cantilever_free(BenchCantilever *beam)
{
    bench_runner_free(&beam->runner);
    bench_body_free(&beam->body);
    for (int k = 0; k < REF_BEAM_MODES; k++) free(beam->share[k]);
    free(beam->weight);
    free(beam->tip);
    free(beam->number);
    free(beam->x);
    free(beam->v);
    free(beam->impulse);
    memset(beam, 0, sizeof *beam);
}

void bench_cantilever_bend(BenchCantilever *beam, int mode, double up)
{
    const BenchRunner *runner = &beam->runner;
    size_t count = (size_t)runner->particles;
    for (size_t p = 0; p < count; p++) {
        const double *from = runner->x0[p];
        double slope, shape = ref_beam_shape(mode, from[0] / beam->length, &slope) / 2;
        bool free = beam->weight[p] > 0;
        beam->x[p][0] = from[0] - (free ? up * slope / (2 * beam->length) * from[1] : 0);
        beam->x[p][1] = from[1] + (free ? up * shape : 0);
        beam->x[p][2] = from[2];
    }
    memset(beam->v, 0, count * sizeof *beam->v);
    runner->type->set(runner->engine, SM_POSITION, CONST(beam->x));
    runner->type->set(runner->engine, SM_VELOCITY, CONST(beam->v));
}

void bench_cantilever_step(BenchCantilever *beam, double acceleration, double rate)
{
    BenchRunner *runner = &beam->runner;
    double h = beam->scene.params.h;
    if (rate > 0) runner->type->get(runner->engine, SM_VELOCITY, beam->v);
    if (rate > 0 || acceleration != 0) {
        for (long p = 0; p < runner->particles; p++) {
            for (int d = 0; d < 3; d++)
                beam->impulse[p][d] = -h * beam->weight[p] * rate * beam->v[p][d];
            beam->impulse[p][1] += h * beam->weight[p] * acceleration;
        }
        runner->type->push(runner->engine, runner->particles, beam->number, CONST(beam->impulse));
    }
    bench_runner_step(runner, NULL);
}

double bench_cantilever_mode(BenchCantilever *beam, int mode)
{
    const BenchRunner *runner = &beam->runner;
    double height = 0;
    runner->type->get(runner->engine, SM_POSITION, beam->x);
    for (long p = 0; p < runner->particles; p++)
        height += beam->share[mode][p] * (beam->x[p][1] - runner->x0[p][1]);
    return height;
}

double bench_cantilever_tip(BenchCantilever *beam)
{
    const BenchRunner *runner = &beam->runner;
    double sum = 0;
    runner->type->get(runner->engine, SM_POSITION, beam->x);
    for (long p = 0; p < runner->particles; p++)
        if (beam->tip[p]) sum += beam->x[p][1] - runner->x0[p][1];
    return sum / (double)beam->tips / beam->short_of;
}

double bench_cantilever_unrest(BenchCantilever *beam, double acceleration)
{
    BenchRunner *runner = &beam->runner;
    double sum = 0, change = acceleration * beam->scene.params.h;
    memset(beam->v, 0, (size_t)runner->particles * sizeof *beam->v);
    runner->type->set(runner->engine, SM_VELOCITY, CONST(beam->v));
    bench_cantilever_step(beam, acceleration, 0);
    runner->type->get(runner->engine, SM_VELOCITY, beam->v);
    for (long p = 0; p < runner->particles; p++)
        for (int d = 0; d < 3; d++) sum += beam->weight[p] * beam->v[p][d] * beam->v[p][d];
    return sqrt(sum / beam->mass) / fabs(change);
}
