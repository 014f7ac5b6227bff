#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../octree/change/structure.h"
#include "../../octree/graph/distance.h"
#include "../beam/bending_wave.h"
#include "../engines.h"
#include "experiments.h"

static void choose(const BenchMeasure *measure, OctOptions *options)
{
    options->masses = measure->masses;
    options->symmetry = measure->symmetry;
    options->weighting = measure->weighting;
    if (options->symmetry == OCT_ASYMMETRIC) options->form = OCT_ADJOINT;
}

/* The scene by its choices; `lattices`: a lattice will do where none is made. */
static SmCode prepare(const BenchExperiment *of, bool lattices, SmError *error)
{
    BenchScene *scene = of->scene;
    const BenchMeasure *measure = of->measure;
    bool chosen = measure->masses || measure->symmetry || measure->weighting;
    bool sampled = bench_engine(scene->engine)->sampled;
    if (scene->instances != 1 || !(sampled || (lattices && !chosen)))
        return sm_fail(error, SM_INPUT, "%.100s: one body in the octree is wanted", scene->file);
    choose(measure, &scene->octree);
    return SM_OK;
}

/* ---- regions */

/* Percent of all memberships of leaves in regions that are farther than (1 + epsilon) w from the
 * region's own leaf. */
static double beyond_percent(const OctStructure *s)
{
    const OctRegions *regions = &s->regions;
    double members = 0, beyond = 0;
    OctReach reach;
    int *leaf = sm_alloc((size_t)s->tree.leaves, sizeof *leaf);
    oct_reach_init(&reach, &s->graph);
    for (int i = 0; i < s->tree.leaves; i++) {
        double most = (1 + s->options.epsilon) * s->w[i];
        members += regions->size[i];
        if (regions->width[i] <= most) continue;
        oct_reach_from(&reach, i, regions->width[i]);
        oct_regions_leaves(&s->tree, regions, i, leaf);
        for (int n = 0; n < regions->size[i]; n++) beyond += reach.distance[leaf[n]] > most;
    }
    oct_reach_free(&reach);
    free(leaf);
    return 100 * beyond / members;
}

static double region_field(const OctStructure *s, const char *field)
{
    if (!strcmp(field, "summation_nodes")) return s->regions.mean;
    if (!strcmp(field, "most_summation")) return (double)s->regions.most;
    if (!strcmp(field, "parts")) return (double)oct_structure_parts(s);
    return beyond_percent(s);
}

SmCode bench_choices_regions(const BenchExperiment *of, SmError *error)
{
    int quarters[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->n, quarters);
    OctOptions *options = &of->scene->octree;
    SmCode code = prepare(of, false, error);
    for (int c = 0; c < count && !code; c++) {
        OctStructure s;
        options->epsilon = 0.25 * quarters[c];
        code = oct_structure_build(&of->body->voxels, options, of->body->mass, &s, error);
        if (code) break;
        bench_curve_exact(of->curve, options->epsilon, region_field(&s, of->measure->field));
        oct_structure_free(&s);
    }
    return code;
}

/* ---- growth */

/* Nothing gives the body energy; it starts bent, and trembles by so many hundredths of a cell. */
static void set_free(BenchScene *scene, const BenchMeasure *measure, int kick)
{
    scene->handle_count = scene->force_count = scene->obstacle_count = 0;
    scene->cut_count = scene->touch_count = scene->view.level = 0;
    scene->params.damping = measure->damping / 100.0;
    if (measure->width) scene->octree.width.edges = scene->params.w = measure->width;
    scene->params.collide = (SmCollideParams){0};
    memset(scene->params.gravity, 0, sizeof scene->params.gravity);
    scene->bend = 0.7;
    scene->kick = kick / 100.0;
}

/* Of sum m v^2, its mean over so many steps. */
static double mean_motion(BenchRunner *runner, const double *mass, long steps, double (*v)[3])
{
    double sum = 0;
    for (long s = 0; s < steps; s++) {
        bench_runner_step(runner);
        runner->type->get(runner->engine, SM_VELOCITY, v);
        for (long p = 0; p < runner->particles; p++)
            for (int d = 0; d < 3; d++) sum += mass[p] * v[p][d] * v[p][d];
    }
    return sum / (double)steps;
}

static double growth_of(BenchRunner *runner, long steps)
{
    double *mass = sm_alloc((size_t)runner->particles, sizeof *mass);
    double(*v)[3] = sm_alloc((size_t)runner->particles, sizeof *v);
    runner->type->masses(runner->engine, mass);
    double first = mean_motion(runner, mass, steps / 10, v);
    for (long s = 0; s < steps - 2 * (steps / 10); s++) bench_runner_step(runner);
    double last = mean_motion(runner, mass, steps / 10, v);
    free(mass);
    free(v);
    return last / first;
}

SmCode bench_choices_growth(const BenchExperiment *of, SmError *error)
{
    int kick[BENCH_RANGE_POINTS], count = bench_range_numbers(&of->measure->n, kick);
    SmCode code = prepare(of, true, error);
    for (int k = 0; k < count && !code && of->curve->valid; k++) {
        BenchRunner runner;
        set_free(of->scene, of->measure, kick[k]);
        code = bench_runner_exact(of->scene, of->body, &runner, error);
        if (code) break;
        bench_runner_disturb(&runner, of->lab->seed);
        bench_curve_exact(of->curve, kick[k] / 100.0,
                          growth_of(&runner, of->lab->quick ? 2000 : 20000));
        bench_curve_check(of->curve, &runner);
        bench_runner_free(&runner);
    }
    return code;
}

/* ---- placement */

enum { ACROSS = 16, NODE = 4 }; /* finest cells: the beam's thickness, a node's edge */

/* The scene `beam`, free, in nodes of NODE finest cells whose lattice begins `shift` of them off
 * the beam's sides: those at the surface are then full only in part. */
static void place_beam(const BenchMeasure *measure, int shift, BenchScene *scene)
{
    SmError error;
    if (bench_scene_find("beam", scene, &error)) abort(); /* it is built in */
    strcpy(scene->engine, "octree");
    scene->handle_count = 0;
    scene->voxel = (SmVoxelParams){.fill = SM_SOLID, .cell = 0.1 / ACROSS};
    scene->octree.epsilon = 0.5;
    scene->octree.width.edges = 1;
    scene->octree.sampling = (OctSampling){
        .levels = 3, .corner = {0, shift, shift}, .criteria = {{OCT_UNIFORM, .level = 1}}};
    scene->octree.sampling.criteria_count = 1;
    choose(measure, &scene->octree);
}

static SmCode find_stiffness(const BenchExperiment *of, const BenchScene *scene,
                             const BenchBody *body, double *stiffness, SmError *error)
{
    BenchRunner runner;
    SmCode code = bench_runner_exact(scene, body, &runner, error);
    if (!code) {
        *stiffness = bench_bending_wave(&runner);
        bench_curve_check(of->curve, &runner);
    }
    bench_runner_free(&runner);
    return code;
}

SmCode bench_choices_placement(const BenchExperiment *of, SmError *error)
{
    double least = INFINITY, most = 0;
    BenchScene *scene = sm_alloc(1, sizeof *scene);
    SmCode code = SM_OK;
    for (int shift = 0; shift < NODE && !code && of->curve->valid; shift++) {
        BenchBody body;
        double stiffness = NAN;
        place_beam(of->measure, shift, scene);
        code = bench_body_of_scene(scene, NULL, &body, error);
        if (!code) code = find_stiffness(of, scene, &body, &stiffness, error);
        bench_body_free(&body);
        least = fmin(least, stiffness);
        most = fmax(most, stiffness);
    }
    if (!code) bench_curve_exact(of->curve, 0, most / least);
    free(scene);
    return code;
}
