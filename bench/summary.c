#include "summary.h"

#include <stdio.h>
#include <string.h>

#include "../octree/structure.h"
#include "check.h"

/* Prints the last state's deviation from brute force; false: beyond the tolerance. */
static bool print_deviation(const BenchRunner *runner, const SmCounts *counts)
{
    static const double most_members = 1e8;
    const BenchScene *scene = runner->scene;
    if (counts->broken) {
        printf("deviation: not checked: %ld links are broken\n", counts->broken);
        return true;
    }
    if (scene->octree.creep > 0 && !strcmp(runner->type->name, "octree")) {
        printf("deviation: not checked: a plastic body's rest shapes change\n");
        return true;
    }
    if (bench_check_room(scene, runner->body, runner->type, runner->engine) > most_members) {
        printf("deviation: not checked: brute force would take too much memory\n");
        return true;
    }
    BenchCheck check;
    bench_check_begin(scene, runner->body, runner->type, runner->engine, &check);
    BenchDeviation found = bench_check_state(&check, runner->type, runner->engine);
    bench_check_free(&check);
    double allowed = bench_check_tolerance(runner->type->precision);
    printf("deviation: goals within %.3g cells of brute force, momentum kept to %.2g\n",
           found.goal_error, found.momentum_error);
    if (found.goal_error <= allowed) return true;
    printf("deviation: beyond the %g cells that 'tables' allows: does the body fly off?\n",
           allowed);
    return false;
}

/* What the octree is: nodes beside those wanted, regions. */
static void print_octree(const BenchRunner *runner)
{
    const OctStructure *s = oct_engine_structure(runner->engine);
    const OctSampleReport *report = &s->report;
    printf("%s: octree, %s precision: %ld nodes", runner->scene->name, runner->type->precision,
           report->nodes);
    if (report->wanted_nodes && report->wanted_nodes != report->nodes)
        printf(" (nearest to the %ld wanted)", report->wanted_nodes);
    printf(" from %ld base cells, %ld finest cells of %.6g\n", report->bases,
           runner->body->voxels.cell_count, s->cell);
    char width[BENCH_WIDTH_TEXT];
    bench_width_text(&s->width, width);
    printf("regions: w = %s, epsilon %g: %.3g summation nodes on average, %ld at most\n", width,
           runner->scene->octree.epsilon, s->regions.mean, s->regions.most);
}

static void print_lattice(const BenchRunner *runner, const SmCounts *counts)
{
    printf("%s: %s, %s precision: %ld particles, %ld unique regions, w %d, cell %.6g\n",
           runner->scene->name, runner->type->name, runner->type->precision, counts->particles,
           counts->regions, runner->scene->params.w, runner->body->voxels.cell);
}

bool bench_summary_print(const BenchRunner *runner, const BenchOutcome *outcome)
{
    SmCounts counts;
    runner->type->count(runner->engine, &counts);
    double steps = (double)(outcome->steps > 0 ? outcome->steps : 1);
    if (!strcmp(runner->type->name, "octree"))
        print_octree(runner);
    else
        print_lattice(runner, &counts);
    bool valid = outcome->finite && print_deviation(runner, &counts);
    printf("%ld steps of %g s: ", outcome->steps, runner->scene->params.h);
    if (valid)
        printf("%.4g ms a step, %.4g ns per particle and step\n", 1e3 * outcome->seconds / steps,
               1e9 * outcome->seconds / steps / (double)counts.particles);
    else
        printf("INVALID\n");
    return valid;
}
