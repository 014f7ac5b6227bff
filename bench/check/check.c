#include "check.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../../lib/system/team.h"
#include "../../octree/engine.h"
#include "../../reference/condition.h"
#include "../engines.h"
#include "parted.h"

double bench_check_members(const BenchBody *body, int w)
{
    double count = (double)body->voxels.particle_count, members = 1;
    for (int d = 0; d < 3; d++) members *= fmin(2.0 * w + 1, body->voxels.size[d] + 1);
    return count * fmin(members, count);
}

/* The members of the particles in the regions of those around a place of a sample. */
static double sample_members(const BenchBody *body, int w)
{
    double count = (double)body->voxels.particle_count, members = 1, around = 1;
    for (int d = 0; d < 3; d++) {
        double size = body->voxels.size[d] + 1;
        members *= fmin(2.0 * w + 1, size);
        around *= fmin(4.0 * w + (d ? 1 : BENCH_SAMPLE_RUN), size);
    }
    return fmin(around, count) * fmin(members, count);
}

static double lattice_members(const BenchScene *scene, const BenchBody *body,
                              const SmEngine *engine)
{
    (void)engine;
    double members = bench_check_members(body, scene->params.w);
    bool broken = scene->params.strain_limit > 0; /* whose links are of all */
    return members > BENCH_MOST_MEMBERS && !broken ? sample_members(body, scene->params.w)
                                                   : members;
}

static double tree_members(const BenchScene *scene, const BenchBody *body, const SmEngine *engine)
{
    (void)scene, (void)body;
    const OctRegions *regions = &oct_engine_structure(engine)->regions;
    double members = 0;
    const OctTree *tree = &oct_engine_structure(engine)->tree;
    for (long i = 0; i < tree->leaves; i++)
        if (tree->node[i] >= 0) members += regions->size[i];
    return members;
}

void bench_check_cells(const BenchCheck *check, const double (*x)[3], double (*cells)[3])
{
    const SmVoxels *voxels = &check->body->voxels;
    for (long i = 0; i < check->count; i++)
        for (int d = 0; d < 3; d++) cells[i][d] = (x[i][d] - voxels->origin[d]) / voxels->cell;
}

const RefRegions *bench_check_regions(const BenchCheck *check)
{
    return check->hierarchical ? &check->octree.regions : &check->regions;
}

static void begin_lattice(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                          SmEngine *engine, BenchCheck *check)
{
    long parted = 0;
    int(*pair)[2] = NULL;
    if (bench_engine_params(scene, body, 1).strain_limit > 0)
        pair = bench_parted(body, type, engine, &parted);
    long wrong = body->cut ? bench_parted_wrong(body, parted, pair) : 0;
    bench_check_create(body, scene->params.w, parted, pair, check);
    check->parted_wrong = wrong;
}

static void begin_tree(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                       SmEngine *engine, BenchCheck *check)
{
    (void)type;
    const OctStructure *structure = oct_engine_structure(engine);
    *check = (BenchCheck){.body = body,
                          .count = structure->tree.live,
                          .unique = structure->tree.live,
                          .hierarchical = true,
                          .plain = scene->octree.weighting == OCT_PLAIN};
    size_t count = (size_t)check->count;
    ref_tree_init(&structure->tree, &structure->regions, structure->mass, check->plain,
                  &check->octree);
    const OctOptions *options = &scene->octree;
    check->octree.yield = options->yield;
    check->octree.creep = options->creep * scene->params.h;
    check->octree.most = options->most > 0 ? options->most : 1;
    check->mass = sm_alloc(count, sizeof *check->mass);
    check->weight = sm_alloc(count, sizeof *check->weight);
    check->rest = sm_alloc(count, sizeof *check->rest);
    memcpy(check->mass, check->octree.m, count * sizeof *check->mass);
    memcpy(check->weight, check->octree.weight, count * sizeof *check->weight);
    memcpy(check->rest, check->octree.x0, count * sizeof *check->rest);
}

const BenchTwin bench_lattice_twin = {lattice_members, begin_lattice};
const BenchTwin bench_octree_twin = {tree_members, begin_tree};

double bench_twin_members(const BenchRunner *runner)
{
    const BenchTwin *twin = bench_engine(runner->type->name)->twin;
    return twin ? twin->members(runner->scene, runner->body, runner->engine) : INFINITY;
}

void bench_check_begin(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                       SmEngine *engine, BenchCheck *check)
{
    bench_engine(type->name)->twin->begin(scene, body, type, engine, check);
}

/* Of places spread over the body. */
void bench_check_sample(const BenchBody *body, int w, BenchCheck *check)
{
    const long most = 64, count = body->voxels.particle_count;
    *check = (BenchCheck){.body = body, .count = count};
    check->mass = sm_alloc((size_t)count, sizeof *check->mass);
    long places = (long)(BENCH_MOST_MEMBERS / sample_members(body, w));
    places = places < 1 ? 1 : places > most ? most : places;
    check->w = w;
    check->sample = sm_alloc((size_t)places * BENCH_SAMPLE_RUN, sizeof *check->sample);
    for (long i = 0; i < places; i++)
        for (int k = 0; k < BENCH_SAMPLE_RUN; k++)
            check->sample[check->samples++] = (count * (2 * i + 1) / (2 * places) + k) % count;
    ref_links_build(&body->voxels, NULL, 0, &check->links);
    for (long p = 0; p < check->count; p++) check->mass[p] = body->mass ? body->mass[p] : 1;
}

void bench_check_create(const BenchBody *body, int w, long parted, int (*pair)[2],
                        BenchCheck *check)
{
    long count = body->voxels.particle_count;
    if (!parted && bench_check_members(body, w) > BENCH_MOST_MEMBERS) {
        free(pair);
        bench_check_sample(body, w, check);
        return;
    }
    *check = (BenchCheck){.body = body, .count = count, .parted = parted, .pair = pair};
    check->mass = sm_alloc((size_t)count, sizeof *check->mass);
    ref_regions_build(&body->voxels, w, (const int(*)[2])pair, parted, &check->regions);
    check->unique = ref_regions_unique(&check->regions);
    check->weight = sm_alloc((size_t)count, sizeof *check->weight);
    check->rest = sm_alloc((size_t)count, sizeof *check->rest);
    for (long p = 0; p < count; p++) {
        long members = check->regions.start[p + 1] - check->regions.start[p];
        check->mass[p] = body->mass ? body->mass[p] : 1;
        check->weight[p] = check->mass[p] / (double)members;
    }
    bench_check_cells(check, (const double(*)[3])body->x0, check->rest);
}

void bench_check_free(BenchCheck *check)
{
    if (check->hierarchical)
        ref_tree_free(&check->octree);
    else
        ref_regions_free(&check->regions);
    if (check->samples) ref_links_free(&check->links);
    sm_free_all(check->mass, check->weight, check->rest, check->pair, check->sample);
    *check = (BenchCheck){0};
}

static bool all_finite(const double (*value)[3], long count)
{
    double sum = 0; /* 0 times anything that is not finite is NaN */
    for (long i = 0; i < count; i++) sum += 0 * value[i][0] + 0 * value[i][1] + 0 * value[i][2];
    return sum == 0;
}

/* Adds the largest distance of two goals, in cells; apart, that of those that are `tied` and not
 * alike all the same. */
static void find_goal_error(const BenchCheck *check, const double (*g)[3], const double (*exact)[3],
                            const bool *tied, BenchDeviation *found)
{
    double cell = check->body->voxels.cell;
    long count = check->samples ? check->samples : check->count;
    for (long i = 0; i < count; i++) {
        long p = check->samples ? check->sample[i] : i;
        double square = 0;
        for (int d = 0; d < 3; d++) square += (g[p][d] - exact[p][d]) * (g[p][d] - exact[p][d]);
        double error = sqrt(square) / cell;
        bool out = tied[p] && !(error <= found->goal_tolerance);
        double *worst = out ? &found->tied_error : &found->goal_error;
        *worst = fmax(*worst, error);
        found->tied += out;
    }
}

double bench_check_momentum(const double (*x)[3], const double (*g)[3], const double *m, long count)
{
    double mass = 0, centre[3] = {0}, drift[3] = {0}, spread = 0;
    for (long p = 0; p < count; p++) {
        mass += m[p];
        for (int d = 0; d < 3; d++) {
            centre[d] += m[p] * x[p][d];
            drift[d] += m[p] * (g[p][d] - x[p][d]);
        }
    }
    for (long p = 0; p < count; p++) {
        double square = 0;
        for (int d = 0; d < 3; d++) square += pow(x[p][d] - centre[d] / mass, 2);
        spread += m[p] * sqrt(square);
    }
    double length = sqrt(drift[0] * drift[0] + drift[1] * drift[1] + drift[2] * drift[2]);
    return spread > 0 ? length / spread : length;
}

/* The octree's, by the rest shapes S; with `flow` those become what a step leaves. Fills the
 * regions' rotations R. */
static void twin_goals(const BenchCheck *check, const double (*x)[3], double yield, bool flow,
                       double (*S)[9], double (*R)[9], double (*exact)[3])
{
    const SmVoxels *voxels = &check->body->voxels;
    size_t count = (size_t)check->count;
    RefTreeBody twin = check->octree;
    double(*at)[3] = sm_alloc(count, sizeof *at);
    twin.yield = yield;
    twin.S = S;
    twin.R = R;
    memset(R, 0, count * sizeof *R);
    bench_check_cells(check, x, at);
    for (size_t i = 0; i < count; i++)
        for (int d = 0; d < 3; d++) R[i][4 * d] = 1;
    ref_tree_goals(&twin, (const double(*)[3])at, flow, exact);
    for (size_t i = 0; i < count; i++)
        for (int d = 0; d < 3; d++) exact[i][d] = voxels->origin[d] + voxels->cell * exact[i][d];
    free(at);
}

/* The twin's goals of one body, in mesh units. Ties go to the identity, as in a lattice. */
static void exact_goals(const BenchCheck *check, const double (*x)[3], double (*S)[9],
                        double (*R)[9], double (*exact)[3])
{
    if (check->hierarchical)
        twin_goals(check, x, check->octree.yield, false, S, R, exact);
    else if (check->samples)
        ref_goals_of(&check->links, check->w, (const double(*)[3])check->body->x0, check->mass, x,
                     check->sample, check->samples, exact);
    else
        ref_goals(&check->regions, (const double(*)[3])check->body->x0, check->mass, x, exact);
}

/* Those of all instances, of an elastic octree the identity; NULL of a lattice. */
static double (*rest_shapes(const BenchCheck *check, const SmEngineType *type, SmEngine *engine))[9]
{
    if (!check->hierarchical) return NULL;
    long all = check->count * check->body->instances;
    double(*S)[9] = sm_alloc((size_t)all, sizeof *S);
    if (!type->get_shapes(engine, S))
        for (long i = 0; i < all; i++) S[i][0] = S[i][4] = S[i][8] = 1;
    return S;
}

void bench_check_turns(const BenchCheck *check, const SmEngineType *type, SmEngine *engine,
                       const double (*x)[3], double (*R)[9])
{
    double(*S)[9] = rest_shapes(check, type, engine);
    double(*unused)[3] = sm_alloc((size_t)check->count, sizeof *unused);
    for (long first = 0; first < check->count * check->body->instances; first += check->count)
        exact_goals(check, x + first, S + first, R + first, unused);
    free(S);
    free(unused);
}

/* Largest distance along an axis from the mean. */
static double extent(const double (*x)[3], long count)
{
    double largest = 0;
    for (int d = 0; d < 3; d++) {
        double sum = 0;
        for (long i = 0; i < count; i++) sum += x[i][d];
        for (long i = 0; i < count; i++)
            largest = fmax(largest, fabs(x[i][d] - sum / (double)count));
    }
    return largest;
}

void bench_check_tied(const BenchCheck *check, const char *precision, const double (*x)[3],
                      bool *tied)
{
    const RefRegions *regions = bench_check_regions(check);
    double(*at)[3] = sm_alloc((size_t)check->count, sizeof *at);
    double tolerance = bench_check_tolerance(precision);
    bench_check_cells(check, x, at);
    double known =
        0.5 * bench_check_epsilon(precision) * extent((const double(*)[3])at, check->count);
    double least = fmin(0.125, known / tolerance);
    double *hold = sm_alloc((size_t)check->count, sizeof *hold);
#pragma omp parallel for schedule(dynamic, 64)                                                     \
    num_threads(sm_team(0)) if (check->count > REF_SERIAL)
    for (long r = 0; r < check->count; r++) {
        RefCondition found;
        ref_condition(regions, check->weight, (const double(*)[3])check->rest,
                      (const double(*)[3])at, r, tolerance, &found);
        hold[r] = found.hold;
    }
    memset(tied, 0, (size_t)check->count * sizeof *tied);
    for (long r = 0; r < check->count; r++) {
        if (hold[r] >= least) continue;
        RefMembers held = ref_members(regions, r);
        for (long n = 0; n < held.count; n++) tied[held.member[n]] = true;
    }
    free(hold);
    free(at);
}

BenchDeviation bench_check_state(const BenchCheck *check, const SmEngineType *type,
                                 SmEngine *engine)
{
    long count = check->count, all = count * check->body->instances;
    double(*x)[3] = sm_alloc((size_t)all, sizeof *x);
    double(*v)[3] = sm_alloc((size_t)all, sizeof *v);
    double(*g)[3] = sm_alloc((size_t)all, sizeof *g);
    double(*exact)[3] = sm_alloc((size_t)count, sizeof *exact);
    double(*S)[9] = rest_shapes(check, type, engine), (*R)[9] = NULL;
    bool *tied = sm_alloc((size_t)count, sizeof *tied);
    if (check->hierarchical) R = sm_alloc((size_t)count, sizeof *R);
    type->goals(engine);
    type->get(engine, SM_POSITION, x);
    type->get(engine, SM_VELOCITY, v);
    type->get(engine, SM_GOAL, g);
    BenchDeviation result = {.particles = all,
                             .sampled = check->samples * check->body->instances,
                             .parted_wrong = check->parted_wrong,
                             .goal_tolerance = bench_check_tolerance(type->precision),
                             .plain = check->plain,
                             .finite = all_finite((const double(*)[3])x, all) &&
                                       all_finite((const double(*)[3])v, all) &&
                                       all_finite((const double(*)[3])g, all)};
    if (!result.finite) result.goal_error = result.momentum_error = INFINITY;
    for (long first = 0; first < all && result.finite; first += count) {
        const double(*at)[3] = (const double(*)[3])(x + first);
        const double(*goal)[3] = (const double(*)[3])(g + first);
        exact_goals(check, at, S ? S + first : NULL, R, exact);
        if (!check->samples) bench_check_tied(check, type->precision, at, tied);
        find_goal_error(check, goal, (const double(*)[3])exact, tied, &result);
        double drift = bench_check_momentum(at, goal, check->mass, count);
        result.momentum_error = fmax(result.momentum_error, drift);
    }
    free(x);
    free(v);
    free(g);
    free(exact);
    free(tied);
    free(S);
    free(R);
    return result;
}

/* How far a region's shape is from the nearest of two that are both right. */
static double shape_error(const double S[9], const double low[9], const double high[9])
{
    double worst[2] = {0};
    for (int i = 0; i < 9; i++) {
        worst[0] = fmax(worst[0], isfinite(S[i]) ? fabs(S[i] - low[i]) : INFINITY);
        worst[1] = fmax(worst[1], isfinite(S[i]) ? fabs(S[i] - high[i]) : INFINITY);
    }
    return fmin(worst[0], worst[1]);
}

double bench_check_flow(const BenchCheck *check, BenchRunner *runner)
{
    const SmEngineType *type = runner->type;
    if (!(check->hierarchical && check->octree.creep > 0)) return 0;
    size_t count = (size_t)check->count, all = count * (size_t)check->body->instances;
    double(*x)[3] = sm_alloc(all, sizeof *x), (*unused)[3] = sm_alloc(count, sizeof *unused);
    double(*R)[9] = sm_alloc(count, sizeof *R);
    double(*low)[9] = sm_alloc(count, sizeof *low), (*high)[9] = sm_alloc(count, sizeof *high);
    double(*before)[9] = rest_shapes(check, type, runner->engine), worst = 0;
    double slack = bench_check_tolerance(type->precision), yield = check->octree.yield;
    type->get(runner->engine, SM_POSITION, x);
    bench_runner_step(runner);
    double(*after)[9] = rest_shapes(check, type, runner->engine);
    for (size_t first = 0; first < all; first += count) {
        const double(*at)[3] = (const double(*)[3])(x + first);
        memcpy(low, before + first, count * sizeof *low);
        memcpy(high, before + first, count * sizeof *high);
        twin_goals(check, at, fmax(yield - slack, 0), true, low, R, unused);
        twin_goals(check, at, yield + slack, true, high, R, unused);
        for (size_t r = 0; r < count; r++)
            worst = fmax(worst, shape_error(after[first + r], low[r], high[r]));
    }
    free(x);
    free(unused);
    free(R);
    free(low);
    free(high);
    free(before);
    free(after);
    return worst;
}

double bench_check_epsilon(const char *precision)
{
    return strcmp(precision, "double") ? FLT_EPSILON : DBL_EPSILON;
}

double bench_check_tolerance(const char *precision)
{
    return strcmp(precision, "double") ? 5e-5 : 1e-10;
}

double bench_check_step(const char *precision)
{
    return strcmp(precision, "double") ? 1e-4 : 1e-9;
}

bool bench_check_keeps(double momentum_error, size_t size, char *reason)
{
    if (momentum_error <= BENCH_MOMENTUM_TOLERANCE) return true;
    snprintf(reason, size, "linear momentum is off by %.3g; at most %g allowed", momentum_error,
             BENCH_MOMENTUM_TOLERANCE);
    return false;
}

bool bench_check_verdict(const BenchDeviation *found, size_t size, char *reason)
{
    if (!found->finite)
        snprintf(reason, size, "positions, velocities or goals are not finite");
    else if (found->parted_wrong > 0)
        snprintf(reason, size, "%ld links are broken that were not cut, or were cut and are not",
                 found->parted_wrong);
    else if (!(found->goal_error <= found->goal_tolerance))
        snprintf(reason, size, "goals are %.3g cells from brute force; at most %g allowed",
                 found->goal_error, found->goal_tolerance);
    else if (!(found->damping_error <= found->damping_tolerance))
        snprintf(reason, size,
                 "damped velocities are %.3g of the largest from brute force; at most %.2g allowed",
                 found->damping_error, found->damping_tolerance);
    else if (found->contacts_wrong > 0)
        snprintf(reason, size, "%ld of %ld contacts are not those of brute force",
                 found->contacts_wrong, found->contacts);
    else if (found->pushed_wrong > 0)
        snprintf(reason, size, "%ld particles meet obstacles otherwise than brute force has it",
                 found->pushed_wrong);
    else if (!(found->turn_error <= BENCH_TURN_TOLERANCE))
        snprintf(
            reason, size,
            "cells that collide are turned %.3g otherwise than brute force; at most %g allowed",
            found->turn_error, BENCH_TURN_TOLERANCE);
    else if ((double)found->tied > BENCH_LEFT_OUT * (double)found->particles)
        snprintf(reason, size,
                 "%ld of %ld particles are in regions whose rotation is not unique; at most %g%% "
                 "may be",
                 found->tied, found->particles, 100 * BENCH_LEFT_OUT);
    else
        return true;
    return false;
}

void bench_check_merge(const BenchDeviation *found, BenchDeviation *worst)
{
    worst->finite = worst->finite && found->finite;
    worst->goal_tolerance = found->goal_tolerance;
    worst->goal_error = fmax(worst->goal_error, found->goal_error);
    worst->momentum_error = fmax(worst->momentum_error, found->momentum_error);
    worst->plain = found->plain;
    worst->particles = found->particles;
    if (found->tied > worst->tied) worst->tied = found->tied;
    worst->sampled = found->sampled;
    if (found->unresolved > worst->unresolved) worst->unresolved = found->unresolved;
    worst->tied_error = fmax(worst->tied_error, found->tied_error);
    worst->unresolved_error = fmax(worst->unresolved_error, found->unresolved_error);
    if (found->contact_nodes > worst->contact_nodes) worst->contact_nodes = found->contact_nodes;
    if (found->contact_all > worst->contact_all) worst->contact_all = found->contact_all;
    worst->obstacles |= found->obstacles;
    worst->pushed += found->pushed;
    worst->pushed_wrong += found->pushed_wrong;
    worst->parted_wrong += found->parted_wrong;
    worst->contacts += found->contacts;
    worst->deepest = fmax(worst->deepest, found->deepest);
    worst->contacts_wrong += found->contacts_wrong;
    worst->motion_error = fmax(worst->motion_error, found->motion_error);
    worst->turn_error = fmax(worst->turn_error, found->turn_error);
    if (found->damping_error * worst->damping_tolerance <
        worst->damping_error * found->damping_tolerance)
        return;
    worst->damping_error = found->damping_error;
    worst->damping_tolerance = found->damping_tolerance;
}

void bench_check_text(const BenchDeviation *found, size_t size, char *text)
{
    snprintf(text, size,
             "goals within %.2g cells of brute force (allowed %.0e), momentum of one step %s %.1g",
             found->goal_error, found->goal_tolerance,
             found->plain ? "not kept by plain weighting, off by" : "kept to",
             found->momentum_error);
    if (found->sampled)
        sm_append(text, size,
                  ", goals of %ld of %ld particles (%.2g%%) compared, damping and contacts of none",
                  found->sampled, found->particles,
                  100 * (double)found->sampled / (double)found->particles);
    if (found->drift.steps > 0)
        sm_append(text, size,
                  ", over %ld free steps it drifts by %.1g cells and %.1g radians a step",
                  found->drift.steps, found->drift.linear, found->drift.angular);
    if (found->drift.held > 0) sm_append(text, size, ", on planes by %.1g", found->drift.held);
    if (found->drift.touching > 0)
        sm_append(text, size, ", in contact by %.1g", found->drift.touching);
    if (found->drift.hung > 0)
        sm_append(text, size, ", held at a point by %.1g", found->drift.hung);
    if (found->damping_tolerance > 0)
        sm_append(text, size, ", damping within %.1g of the largest velocity (allowed %.0e)",
                  found->damping_error, found->damping_tolerance);
    if (found->contact_nodes > 0)
        sm_append(text, size,
                  ", contacts of %ld of %ld surface nodes right (%ld of %ld; %.2g cells deep)",
                  found->contact_nodes, found->contact_all, found->contacts - found->contacts_wrong,
                  found->contacts, found->deepest);
    if (found->obstacles)
        sm_append(text, size,
                  ", %ld particles stopped by obstacles, all where brute force has them",
                  found->pushed);
    if (found->tied)
        sm_append(text, size,
                  "; %ld particle%s of regions whose rotation is not unique left out (within %.1g)",
                  found->tied, found->tied > 1 ? "s" : "", found->tied_error);
    if (found->unresolved > 0)
        sm_append(text, size,
                  "; %ld left out of damping, of whose regions rounding decides whether they turn "
                  "(within %.1g cells a step)",
                  found->unresolved, found->unresolved_error);
}
