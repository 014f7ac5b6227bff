#include "tools.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Out of use: a cut or a touch that is due at no time. */
static const double NEVER = INFINITY;

static void add_blade(BenchScene *scene, ViewTools *tools)
{
    if (scene->instances > 1 || scene->cut_count == BENCH_MAX) return;
    tools->blade = scene->cut_count++;
    BenchCut *blade = &scene->cut[tools->blade];
    *blade = (BenchCut){.start = NEVER, .stop = -NEVER, .level = OCT_MAX_LEVELS, .reach = 4};
    if (tools->blade == 0) return;
    blade->level = scene->cut[0].level; /* cells near it are as fine as near the scene's own */
    blade->reach = scene->cut[0].reach;
}

static void add_fingers(BenchScene *scene, const ViewAllowed *allowed, ViewTools *tools)
{
    tools->first_finger = scene->touch_count;
    for (int i = 0; i < BENCH_MAX && i < scene->instances; i++) {
        if (!allowed->touched[i] || scene->touch_count == BENCH_MAX) continue;
        scene->touch[scene->touch_count++] =
            (BenchTouch){.instance = i + 1, .start = NEVER, .level = OCT_MAX_LEVELS, .hold = 0.3};
        tools->fingers++;
    }
}

void view_tools_add(BenchScene *scene, const ViewAllowed *allowed, bool refines, ViewTools *tools)
{
    *tools = (ViewTools){.blade = -1, .touching = -1};
    if (allowed->cut) add_blade(scene, tools);
    if (refines) add_fingers(scene, allowed, tools);
}

void view_tools_cut(ViewTools *tools, BenchScene *scene, BenchPlayback *play, const double a[3],
                    const double b[3])
{
    if (tools->blade < 0) return;
    BenchCut *blade = &scene->cut[tools->blade];
    SmError left;
    memcpy(blade->base_to, a, sizeof blade->base_to);
    memcpy(blade->tip_to, b, sizeof blade->tip_to);
    blade->start = blade->stop = play->time;
    bench_playback_change_now(play, &left); /* what cannot be cut is left */
    blade->start = NEVER;
    blade->stop = -NEVER;
}

void view_tools_lift(ViewTools *tools, BenchPlayback *play)
{
    for (int g = 0; tools->blade >= 0 && g < play->count; g++)
        sm_blade_lift(&play->group[g].blade[tools->blade]);
}

/* The finger for a body, among the scene's touches, or -1. */
static int find_finger(const ViewTools *tools, const BenchScene *scene, long instance)
{
    for (int i = tools->first_finger; i < tools->first_finger + tools->fingers; i++)
        if (scene->touch[i].instance == instance + 1) return i;
    return -1;
}

bool view_tools_may_touch(const ViewTools *tools, const BenchScene *scene, long instance)
{
    return find_finger(tools, scene, instance) >= 0;
}

void view_tools_touch(ViewTools *tools, BenchScene *scene, long instance, const double centre[3],
                      double radius)
{
    view_tools_leave(tools, scene);
    tools->touching = find_finger(tools, scene, instance);
    if (tools->touching < 0) return;
    BenchTouch *finger = &scene->touch[tools->touching];
    memcpy(finger->centre, centre, sizeof finger->centre);
    finger->radius = radius;
    finger->start = 0;
}

void view_tools_leave(ViewTools *tools, BenchScene *scene)
{
    if (tools->touching >= 0) scene->touch[tools->touching].start = NEVER;
    tools->touching = -1;
}

void view_tools_blow(const ViewTools *tools, BenchPlayback *play)
{
    const double *wind = tools->wind;
    if (wind[0] == 0 && wind[1] == 0 && wind[2] == 0) return;
    for (int g = 0; g < play->count; g++) {
        const BenchRunner *runner = &play->group[g].runner;
        double *mass = sm_alloc((size_t)runner->count, sizeof *mass);
        long *particle = sm_alloc((size_t)runner->particles, sizeof *particle);
        double(*impulse)[3] = sm_alloc((size_t)runner->particles, sizeof *impulse);
        runner->type->masses(runner->engine, mass);
        for (long p = 0; p < runner->particles; p++) {
            particle[p] = p;
            for (int d = 0; d < 3; d++)
                impulse[p][d] = mass[p % runner->count] * play->scene->params.h * wind[d];
        }
        runner->type->push(runner->engine, runner->particles, particle,
                           (const double(*)[3])impulse);
        sm_free_all(mass, particle, impulse);
    }
}
