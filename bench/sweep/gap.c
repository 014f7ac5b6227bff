#include "gap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../octree/engine.h"
#include "../check/runner_check.h"
#include "../play/playback.h"

/* Goal positions of the deformed body; the caller frees them, and the runner. */
static SmCode find_goals(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                         BenchRunner *runner, double (**goal)[3], SmError *error)
{
    SmCode code = bench_runner_create(scene, body, type, 1, runner, error);
    if (code) return code;
    *goal = sm_alloc((size_t)runner->particles, sizeof **goal);
    bench_runner_disturb(runner, 1);
    runner->type->goals(runner->engine);
    runner->type->get(runner->engine, SM_GOAL, *goal);
    return SM_OK;
}

/* The scene's body alone, deformed. */
static void set_free(BenchScene *scene)
{
    scene->handle_count = scene->force_count = scene->obstacle_count = 0;
    scene->kick = 0;
    if (scene->bend == 0 && scene->twist == 0 && scene->squash == 0) scene->bend = 0.7;
}

/* Root mean square, by mass where there is one, and largest distance of points, of `unit`. */
static void compare(const double (*a)[3], const double (*b)[3], size_t count, const double *mass,
                    double unit, BenchGap *gap)
{
    double sum = 0, all = 0, most = 0;
    for (size_t i = 0; i < count; i++) {
        double square = 0, m = mass ? mass[i] : 1;
        for (int d = 0; d < 3; d++) square += (a[i][d] - b[i][d]) * (a[i][d] - b[i][d]);
        sum += m * square;
        all += m;
        most = fmax(most, square);
    }
    gap->rms = sqrt(sum / all) / unit;
    gap->most = sqrt(most) / unit;
}

static void compare_goals(const BenchRunner *runner, double cell, const double (*goal)[3],
                          const double (*exact)[3], BenchGap *gap)
{
    double *mass = sm_alloc((size_t)runner->particles, sizeof *mass);
    runner->type->masses(runner->engine, mass);
    for (long i = runner->count; i < runner->particles; i++) mass[i] = mass[i % runner->count];
    compare(goal, exact, (size_t)runner->particles, mass, cell, gap);
    if (!isfinite(gap->rms)) {
        gap->rms = gap->most = NAN;
        snprintf(gap->why, sizeof gap->why, "goals are not finite");
    }
    free(mass);
}

/* Says why where the check fails. */
static bool right(const BenchRunner *runner, const char *what, char why[BENCH_WHY])
{
    char reason[160];
    if (bench_check_runner(runner, sizeof reason, reason)) return true;
    snprintf(why, BENCH_WHY, "INVALID%s: %.*s", what, BENCH_WHY - 32, reason);
    return false;
}

void bench_gap_goals(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                     BenchGap *gap)
{
    *gap = (BenchGap){.rms = NAN, .most = NAN};
    BenchScene alone = *scene, exact = *scene;
    set_free(&alone);
    set_free(&exact);
    exact.octree.epsilon = 0;
    BenchRunner runner = {0}, twin = {0};
    double(*goal)[3] = NULL, (*wanted)[3] = NULL;
    SmError error;
    SmCode code = find_goals(&alone, body, type, &runner, &goal, &error);
    if (!code) code = find_goals(&exact, body, type, &twin, &wanted, &error);
    if (code)
        snprintf(gap->why, sizeof gap->why, "%.*s", BENCH_WHY - 1, error.text);
    else if (right(&runner, "", gap->why) && right(&twin, " at epsilon 0", gap->why))
        compare_goals(&runner, body->voxels.cell, (const double(*)[3])goal,
                      (const double(*)[3])wanted, gap);
    else
        gap->invalid = true;
    free(goal);
    free(wanted);
    bench_runner_free(&runner);
    bench_runner_free(&twin);
}

/* Mass of what force k pushes. */
static double pushed_mass(const BenchRunner *runner, int k)
{
    double *mass = sm_alloc((size_t)runner->count, sizeof *mass), sum = 0;
    runner->type->masses(runner->engine, mass);
    for (long n = 0; n < runner->push_count[k]; n++)
        sum += mass[runner->push_particle[k][n] % runner->count];
    free(mass);
    return sum;
}

SmCode bench_push_find(const BenchScene *scene, const BenchBody *body, BenchPush *push,
                       SmError *error)
{
    *push = (BenchPush){.count = scene->force_count};
    BenchRunner runner;
    SmCode code = bench_runner_exact(scene, body, &runner, error);
    if (code) return code;
    for (int k = 0; k < push->count; k++) {
        double share = (double)runner.push_count[k] / pushed_mass(&runner, k);
        for (int d = 0; d < 3; d++) push->acceleration[k][d] = scene->force[k].force[d] * share;
    }
    bench_runner_free(&runner);
    return SM_OK;
}

static void use_push(const BenchPush *push, BenchRunner *runner)
{
    double *mass = sm_alloc((size_t)runner->count, sizeof *mass);
    runner->type->masses(runner->engine, mass);
    for (int k = 0; k < push->count; k++)
        for (long n = 0; n < runner->push_count[k]; n++)
            for (int d = 0; d < 3; d++)
                runner->push_impulse[k][n][d] = push->acceleration[k][d] * runner->scene->params.h *
                                                mass[runner->push_particle[k][n] % runner->count];
    free(mass);
}

/* Appends the frame's points; false if one is not finite. */
static bool keep_frame(BenchPlayback *play, long vertices, double (*all)[3], int frame,
                       BenchPath *path)
{
    double(*to)[3] = path->point + (size_t)frame * (size_t)path->points, sum = 0;
    bench_playback_points(play, all);
    for (long i = 0; i < path->points; i++) {
        memcpy(to[i], all[i * vertices / path->points], sizeof *to);
        sum += 0 * (to[i][0] + to[i][1] + to[i][2]);
    }
    return sum == 0;
}

static void play_frames(BenchPlayback *play, BenchPath *path)
{
    const BenchGroup *group = &play->group[0];
    long vertices = group->body.instances * group->skin.surface.vertex_count;
    path->points = vertices < BENCH_PATH_POINTS ? vertices : BENCH_PATH_POINTS;
    path->point = sm_alloc((size_t)path->frames * (size_t)path->points, sizeof *path->point);
    double(*all)[3] = sm_alloc((size_t)vertices, sizeof *all);
    bool finite = true;
    int frame = 0;
    for (; frame < path->frames && finite; frame++) {
        for (int s = 0; s < play->scene->steps_per_frame; s++) {
            bench_playback_prepare(play);
            bench_playback_advance(play, NULL);
        }
        finite = keep_frame(play, vertices, all, frame, path);
    }
    free(all);
    if (finite) return;
    snprintf(path->why, sizeof path->why, "the motion is not finite from frame %d on", frame);
    path->points = 0;
}

void bench_path_record(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                       const BenchPush *push, int frames, unsigned long seed, BenchPath *path)
{
    *path = (BenchPath){.frames = frames};
    SmError error;
    BenchPlayback play;
    if (bench_playback_create(scene, body, type, 1, seed, &play, &error)) {
        snprintf(path->why, sizeof path->why, "%.*s", BENCH_WHY - 1, error.text);
        return;
    }
    use_push(push, &play.group[0].runner);
    play_frames(&play, path);
    if (path->points && !right(&play.group[0].runner, "", path->why)) {
        path->points = 0;
        path->invalid = true;
    }
    bench_playback_free(&play);
}

void bench_path_free(BenchPath *path)
{
    free(path->point);
    *path = (BenchPath){0};
}

void bench_gap_path(const BenchPath *path, const BenchPath *full, double size, BenchGap *gap)
{
    *gap = (BenchGap){.rms = NAN, .most = NAN};
    if (!path->points || !full->points) {
        snprintf(gap->why, sizeof gap->why, "%s", path->points ? full->why : path->why);
        gap->invalid = path->invalid || full->invalid;
        return;
    }
    compare((const double(*)[3])path->point, (const double(*)[3])full->point,
            (size_t)path->frames * (size_t)path->points, NULL, size, gap);
}

SmCode bench_width_mean(const BenchScene *scene, const BenchBody *body, double *cells,
                        SmError *error)
{
    BenchRunner runner;
    SmCode code = bench_runner_exact(scene, body, &runner, error);
    if (code) return code;
    const OctStructure *s = oct_engine_structure(runner.engine);
    double sum = 0, all = 0;
    for (long i = 0; i < s->tree.leaves; i++) {
        double edge = 0.5 * s->tree.size[s->tree.node[i]], rings = floor(0.5 * s->w[i] / edge);
        sum += s->mass[i] * ((rings + 0.5) * edge - 0.5);
        all += s->mass[i];
    }
    *cells = sum / all;
    bench_runner_free(&runner);
    return SM_OK;
}
