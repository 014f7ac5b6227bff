/* check_damping.c - the check of one step's damping (check.h). */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/team.h"
#include "../../lib/vector.h"
#include "../../octree/change/structure.h"
#include "../../octree/region/frames.h"
#include "../../reference/condition.h"
#include "../play/runner.h"
#include "check.h"
#include "check_copy.h"

static double length(const double v[3])
{
    return sqrt(sm_dot(v, v));
}

/* The frame of every leaf that lives, by rank, in an engine made for the structure of this one;
 * returns how many there are. */
static long tree_frames(const SmEngine *engine, int *frame)
{
    const OctStructure *s = oct_engine_structure(engine);
    int *of = sm_alloc((size_t)s->tree.leaves, sizeof *of);
    long frames = oct_frames_find(&s->tree, &s->regions, of), live = 0;
    for (long leaf = 0; leaf < s->tree.leaves; leaf++)
        if (s->tree.node[leaf] >= 0) frame[live++] = of[leaf];
    free(of);
    return frames;
}

/* Where the sums of each region count from in an engine made for one body at x (cells): from the
 * middle of its frame of reference, or of the body. */
static void find_origins(const BenchCheck *check, const SmEngine *engine, const double (*x)[3],
                         double (*origin)[3])
{
    long count = check->count, frames = 1;
    int *frame = sm_alloc((size_t)count, sizeof *frame); /* zeroed */
    if (check->hierarchical) frames = tree_frames(engine, frame);
    double(*sum)[4] = sm_alloc((size_t)frames, sizeof *sum);
    for (long i = 0; i < count; i++) {
        for (int d = 0; d < 3; d++) sum[frame[i]][d] += x[i][d];
        sum[frame[i]][3]++;
    }
    for (long i = 0; i < count; i++)
        for (int d = 0; d < 3; d++) origin[i][d] = sum[frame[i]][d] / sum[frame[i]][3];
    free(sum);
    free(frame);
}

/* What rounding may make of region r's rigid velocity, relative; INFINITY: anything. */
static double region_rounding(const RefCondition *c, const RefSums *sums, long r)
{
    double epsilon = sums->epsilon, square = 0, inertia = c->inertia;
    for (int d = 0; d < 3; d++) square += pow(c->centre[d] - sums->origin[r][d], 2);
    double noise = 8 * epsilon * square, unsure = sums->thinnest * c->spread + noise;
    bool line = inertia <= 0.5 * unsure;
    if (!(c->spread > 0) || (!line && !(inertia >= 4 * unsure))) return INFINITY;
    if (line) inertia = c->spread + noise;
    double share = noise / inertia, form = c->spread / inertia;
    bool maybe = !line && share > 1.0 / 128 && share < 1.0 / 32; /* a 64th, to rounding */
    double known = line ? share * form : maybe ? 2 * share : share;
    return known + 8 * epsilon * form + 4 * sqrt(epsilon * share * form);
}

/* The same of every particle of one body at x (cells), of the worst region that holds it. */
static void particle_rounding(const BenchCheck *check, const RefSums *sums, const double (*x)[3],
                              double *rounding)
{
    const RefRegions *regions = bench_check_regions(check);
    double *of = sm_alloc((size_t)check->count, sizeof *of);
#pragma omp parallel for num_threads(sm_team(0)) if (check->count > REF_SERIAL)
    for (long r = 0; r < check->count; r++) {
        RefCondition found;
        ref_condition(regions, check->weight, (const double(*)[3])check->rest, x, r, 0, &found);
        of[r] = region_rounding(&found, sums, r);
        if (regions->start[r + 1] - regions->start[r] == 1) of[r] = 0; /* it cannot turn */
    }
    for (long r = 0; r < check->count; r++)
        for (long n = regions->start[r]; n < regions->start[r + 1]; n++)
            rounding[regions->member[n]] = fmax(rounding[regions->member[n]], of[r]);
    free(of);
}

/* u of eq. 14 of one body, as an engine of this precision has it, and what rounding may make of it.
 */
static void rigid_velocity(const BenchCheck *check, const SmEngine *engine, const char *precision,
                           const double (*x)[3], const double (*v)[3], double (*u)[3],
                           double *rounding)
{
    double(*cells)[3] = sm_alloc((size_t)check->count, sizeof *cells);
    double(*origin)[3] = sm_alloc((size_t)check->count, sizeof *origin);
    double epsilon = bench_check_epsilon(precision);
    const double(*at)[3] = (const double(*)[3])cells;
    const RefSums sums = {(const double(*)[3])origin, epsilon, epsilon > 1e-10 ? 1e-5 : 1e-10};
    bench_check_cells(check, x, cells);
    find_origins(check, engine, at, origin);
    if (check->hierarchical)
        ref_tree_rigid_velocity(&check->octree, at, v, &sums, u);
    else
        ref_rigid_velocity(&check->regions, check->mass, at, v, &sums, u);
    particle_rounding(check, &sums, at, rounding);
    free(cells);
    free(origin);
}

/* Compares one body's velocities; keeps the worst particle in `found`. */
static void compare(const BenchCheck *check, const BenchScene *scene, const SmEngine *engine,
                    const char *precision, const BenchStep *step, long first, BenchDeviation *found)
{
    double k = scene->params.damping, h = scene->params.h;
    double epsilon = bench_check_epsilon(precision);
    size_t count = (size_t)check->count;
    const double(*x)[3] = (const double(*)[3])(step->x + first);
    const double(*v)[3] = (const double(*)[3])(step->before + first);
    double(*u)[3] = sm_alloc(count, sizeof *u), *rounding = sm_alloc(count, sizeof *rounding);
    bool *tied = sm_alloc(count, sizeof *tied);
    double largest = 0, away = 0;
    rigid_velocity(check, engine, precision, x, v, u, rounding);
    bench_check_tied(check, precision, x, tied);
    for (size_t p = 0; p < count; p++) {
        largest = fmax(largest, length(v[p]));
        away = fmax(away, length(x[p]));
    }
    double known = 16 * epsilon + 8 * DBL_EPSILON * away / (h * largest);
    for (size_t p = 0; p < count && largest > 0; p++) {
        double off[3], allowed = known + k * rounding[p];
        for (int d = 0; d < 3; d++)
            off[d] = v[p][d] + k * (u[p][d] - v[p][d]) - step->after[(size_t)first + p][d];
        double error = length(off) / largest,
               worst = found->damping_error / found->damping_tolerance;
        if (!isfinite(error)) error = INFINITY;
        if (tied[p] || isinf(allowed)) {
            double cells = error * largest * h / check->body->voxels.cell;
            allowed = known + 2 * k;
            if (cells > bench_check_step(precision) && error <= allowed) {
                found->blurred++;
                found->blurred_error = fmax(found->blurred_error, cells);
            }
            if (error <= allowed) continue;
        }
        if (found->damping_tolerance > 0 && error / allowed <= worst) continue;
        found->damping_error = error;
        found->damping_tolerance = allowed;
    }
    free(u);
    free(rounding);
    free(tied);
}

/* Does nothing move, and is no particle pulled by more than goals may be off? A body at rest in
 * empty space is held there (lib/integrate.h), while its goals are off by rounding, which is all
 * that there is to its velocities. */
static bool is_held_at_rest(const BenchCheck *check, const char *precision, double h,
                            const BenchStep *step)
{
    double most = bench_check_tolerance(precision) * check->body->voxels.cell / h;
    for (long p = 0; p < step->all; p++)
        if (sm_dot(step->after[p], step->after[p]) != 0 || !(length(step->before[p]) <= most))
            return false;
    return true;
}

void bench_check_damping(const BenchCheck *check, const BenchScene *scene, const SmEngineType *type,
                         SmEngine *engine, BenchDeviation *found)
{
    if (!(scene->params.damping > 0) || !found->finite) return;
    SmEngineParams params = bench_engine_params(scene, check->body, 1);
    params.collide = (SmCollideParams){0}; /* contacts would change velocities too */
    BenchStep step;
    bench_copy_step(&params, check->body, type, engine, check->count * check->body->instances,
                    &step);
    bool held = is_held_at_rest(check, type->precision, params.h, &step);
    if (held) found->damping_tolerance = 16 * bench_check_epsilon(type->precision);
    for (long first = 0; first < step.all && !held; first += check->count)
        compare(check, scene, engine, type->precision, &step, first, found);
    found->motion_error = bench_copy_motion(&step, &params) / check->body->voxels.cell;
    bench_copy_step_free(&step);
}
