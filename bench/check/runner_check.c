#include "runner_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../lib/engine/boundary.h"
#include "../../lib/vector.h"
#include "../engines.h"
#include "contact_check.h"
#include "step_check.h"

/* How far a particle at x is from where the handle takes it from rest. */
static double distance(const SmHandle *handle, const double rest[3], const double x[3])
{
    double to[3], off[3];
    sm_pose_apply(handle->pose, rest, to);
    for (int d = 0; d < 3; d++) off[d] = to[d] - x[d];
    double square = sm_dot(off, off);
    return isfinite(square) ? sqrt(square) : INFINITY;
}

/* How far, in cells, what handles hold is from where they hold it; where several do, the nearest of
 * them. */
static double slip(const BenchRunner *runner)
{
    size_t all = (size_t)runner->particles;
    double(*x)[3] = sm_alloc(all, sizeof *x), (*rest)[3] = sm_alloc(all, sizeof *rest), most = 0;
    double *off = sm_alloc(all, sizeof *off);
    runner->type->get(runner->engine, SM_POSITION, x);
    runner->type->get(runner->engine, SM_REST, rest);
    for (size_t p = 0; p < all; p++) off[p] = -1; /* held by none */
    for (int k = 0; k < runner->bound_count; k++)
        for (long n = 0; n < runner->bound[k].count; n++) {
            long p = runner->bound[k].particle[n];
            double far = distance(&runner->bound[k], rest[p], x[p]);
            off[p] = off[p] < 0 ? far : fmin(off[p], far);
        }
    for (size_t p = 0; p < all; p++) most = fmax(most, off[p]);
    free(x);
    free(rest);
    free(off);
    return most / runner->body->voxels.cell;
}

static bool no_more_than(double found, double limit, const char *what, size_t size, char *reason)
{
    if (found <= limit) return true;
    snprintf(reason, size, "%s %.3g cells from where it should be; at most %g allowed", what, found,
             limit);
    return false;
}

BenchDeviation bench_check_find(const BenchCheck *check, const BenchRunner *runner)
{
    BenchDeviation found = bench_check_state(check, runner->type, runner->engine);
    bench_check_damping(check, runner->scene, runner->type, runner->engine, &found);
    bench_check_contacts(check, runner->scene, runner->type, runner->engine, &found);
    bench_check_obstacles(check, runner->scene, runner->type, runner->engine, &found);
    return found;
}

bool bench_check_all(const BenchCheck *check, const BenchRunner *runner, BenchDeviation *found,
                     size_t size, char *reason)
{
    *found = bench_check_find(check, runner);
    if (!bench_check_verdict(found, size, reason)) return false;
    return check->plain || bench_check_keeps(found->momentum_error, size, reason);
}

/* Also says how right the step was that damping was checked in, if any. */
static bool held_to_brute(const BenchRunner *runner, double *motion, size_t size, char *reason)
{
    BenchCheck check;
    BenchDeviation found;
    bench_check_begin(runner->scene, runner->body, runner->type, runner->engine, &check);
    bool right = bench_check_all(&check, runner, &found, size, reason);
    bench_check_free(&check);
    if (runner->scene->params.damping > 0 && !found.sampled) *motion = found.motion_error;
    return right;
}

/* Momentum of all goals alone; infinite of what is not finite. */
static double drift(const BenchRunner *runner)
{
    size_t all = (size_t)runner->particles;
    double(*x)[3] = sm_alloc(all, sizeof *x), (*g)[3] = sm_alloc(all, sizeof *g), most = 0;
    double *mass = sm_alloc((size_t)runner->count, sizeof *mass);
    runner->type->goals(runner->engine);
    runner->type->get(runner->engine, SM_POSITION, x);
    runner->type->get(runner->engine, SM_GOAL, g);
    runner->type->masses(runner->engine, mass);
    for (long first = 0; first < runner->particles; first += runner->count) {
        double error = bench_check_momentum((const double(*)[3])(x + first),
                                            (const double(*)[3])(g + first), mass, runner->count);
        most = isfinite(error) ? fmax(most, error) : INFINITY;
    }
    free(x);
    free(g);
    free(mass);
    return most;
}

bool bench_check_runner(const BenchRunner *runner, size_t size, char *reason)
{
    double limit = bench_check_tolerance(runner->type->precision), motion = -1; /* not known */
    if (!bench_engine(runner->type->name)->twin) {
        snprintf(reason, size, "the engine %s has no twin to be held to", runner->type->name);
        return false;
    }
    double members = bench_twin_members(runner);
    bool plain = runner->scene->octree.weighting == OCT_PLAIN;
    if (members <= BENCH_MOST_SAMPLED) {
        if (!held_to_brute(runner, &motion, size, reason)) return false;
    } else if (!plain && !bench_check_keeps(drift(runner), size, reason)) {
        return false;
    }
    if (motion < 0) motion = bench_check_motion(runner);
    return no_more_than(motion, limit, "a step leaves a particle", size, reason) &&
           no_more_than(slip(runner), limit, "a handle has a particle", size, reason);
}
