#include "summary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../check/runner_check.h"
#include "../check/step_check.h"
#include "../engines.h"
#include "../table/explain.h"

/* Prints the last state's deviation from brute force; false: beyond the tolerance. */
static bool print_deviation(const BenchRunner *runner)
{
    const BenchScene *scene = runner->scene;
    SmCounts counts;
    runner->type->count(runner->engine, &counts);
    const BenchEngine *engine = bench_engine(runner->type->name);
    if (!engine->twin) {
        printf("deviation: not checked: the %s body %s\n", runner->type->name,
               engine->reference ? "is a reference itself" : "has no goals of shape matching");
        return true;
    }
    if (counts.broken && runner->body->instances > 1) {
        printf("deviation: not checked: the bodies have broken, each in its own way\n");
        return true;
    }
    if (bench_twin_members(runner) > BENCH_MOST_SAMPLED) {
        printf("deviation: not checked: brute force would take too long\n");
        return true;
    }
    BenchCheck check;
    char text[640], reason[160];
    bench_check_begin(scene, runner->body, runner->type, runner->engine, &check);
    BenchDeviation found = bench_check_find(&check, runner);
    if (found.finite) found.drift = bench_drift(runner);
    bench_check_text(&found, sizeof text, text);
    printf("deviation: %s\n", text);
    if (check.hierarchical && check.octree.creep > 0)
        printf("deviation: of the rest shapes as they are; how they flowed is checked by 'tables', "
               "and the flow by scripts/brute_force.py after --record nodes\n");
    bench_check_free(&check);
    if (bench_check_verdict(&found, sizeof reason, reason) &&
        (found.plain ||
         bench_drift_verdict(&found.drift, runner->type->precision, sizeof reason, reason)))
        return true;
    printf("deviation: %s\n", reason);
    return false;
}

static void print_lattice(const BenchRunner *runner, const SmCounts *counts)
{
    printf("%s: %s, %s precision: %ld particle%s", runner->scene->name, runner->type->name,
           runner->type->precision, counts->particles, counts->particles == 1 ? "" : "s");
    if (counts->regions)
        printf(", %ld unique region%s", counts->regions, counts->regions == 1 ? "" : "s");
    if (runner->type->by_cells) printf(", w %d", runner->scene->params.w);
    printf(", cell %.6g\n", runner->body->voxels.cell);
    if (!counts->broken || !runner->type->pieces) return;
    SmPieces pieces;
    runner->type->pieces(runner->engine, &pieces);
    printf("the body is in %ld piece%s, with %ld of %ld links broken\n", pieces.count,
           pieces.count == 1 ? "" : "s", counts->broken, counts->links + counts->broken);
    sm_pieces_free(&pieces);
}

/* What the engine's particles are called. */
static const char *particles_of(const BenchRunner *runner)
{
    if (bench_engine(runner->type->name)->sampled) return "nodes";
    return runner->type->vertices ? "points" : "particles";
}

/* Particles and surface at the end of a scene that can change them. */
static void print_changes(BenchPlayback *play, const BenchOutcome *outcome)
{
    char each[32] = "BUSY";
    if (!outcome->changes) {
        printf("changes: none\n");
        return;
    }
    if (!bench_watch_busy(&outcome->change.watch))
        snprintf(each, sizeof each, "%.4g ms each",
                 1e3 * outcome->change.seconds / fmax((double)outcome->change.count, 1));
    long open = 0, pieces = 0, triangles = 0, left = 0;
    for (int p = 0; p < play->count; p++) {
        SmMeshInfo info = sm_mesh_info(&play->group[p].skin.surface);
        long bodies = play->group[p].body.instances;
        open += bodies * (info.open_edges + info.nonmanifold_edges);
        pieces += bodies * info.components;
        triangles += bodies * info.triangles;
        left += bodies * play->group[p].skin.incomplete;
    }
    printf("changes: %ld frame%s, %s with the surface; in the end %ld %s, and surfaces "
           "of %ld triangles in %ld piece%s, ",
           outcome->changes, outcome->changes == 1 ? "" : "s", each, bench_playback_particles(play),
           particles_of(bench_playback_runner(play)), triangles, pieces, pieces == 1 ? "" : "s");
    if (open)
        printf("with %ld open or non-manifold edges\n", open);
    else
        printf("watertight\n");
    bench_change_left(stdout, "changes: ", left);
}

bool bench_summary_print(BenchPlayback *play, const BenchOutcome *outcome)
{
    const BenchRunner *runner = bench_playback_runner(play);
    long particles = bench_playback_particles(play);
    SmCounts counts;
    runner->type->count(runner->engine, &counts);
    if (play->count > 1)
        printf("%s: %ld bodies, %ld %s in all; the last that is touched:\n", runner->scene->name,
               play->body->instances, particles, particles_of(runner));
    const BenchEngine *engine = bench_engine(runner->type->name);
    (engine->describe ? engine->describe : print_lattice)(runner, &counts);
    if (bench_playback_changes(play)) print_changes(play, outcome);
    bool valid = outcome->finite && !counts.stopped;
    for (int p = 0; p < play->count && outcome->finite; p++) {
        const BenchGroup *group = &play->group[p];
        if (play->count > 1)
            printf(group->touched ? "instance %ld: " : "%ld that share a structure: ",
                   group->touched ? group->instance[0] + 1 : group->body.instances);
        valid &= print_deviation(&group->runner);
    }
    printf("%ld step%s of %g s: ", outcome->steps, outcome->steps == 1 ? "" : "s",
           runner->scene->params.h);
    const BenchMean *step = &outcome->step;
    double seconds = step->seconds / (double)step->count;
    char cause[BENCH_CAUSE_TEXT];
    if (!valid)
        printf("INVALID\n");
    else if (!outcome->steps)
        printf("nothing timed\n");
    else if (bench_watch_busy(&step->watch))
        printf("BUSY: %s\n", bench_watch_cause(&step->watch, cause));
    else
        printf("%.4g ms a step, %.4g ns per particle and step\n", 1e3 * seconds,
               1e9 * seconds / (double)particles);
    return valid;
}
