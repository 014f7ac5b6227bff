#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../octree/structure.h"

double bench_check_members(const BenchBody *body, int w)
{
    double side = 2.0 * w + 1, count = (double)body->voxels.particle_count;
    return count * fmin(side * side * side, count);
}

static bool is_octree(const SmEngineType *type)
{
    return !strcmp(type->name, "octree");
}

double bench_check_room(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                        const SmEngine *engine)
{
    if (!is_octree(type)) return bench_check_members(body, scene->params.w);
    const OctRegions *regions = &oct_engine_structure(engine)->regions;
    double members = 0;
    for (long i = 0; i < regions->leaves; i++) members += regions->size[i];
    return members;
}

void bench_check_begin(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                       const SmEngine *engine, BenchCheck *check)
{
    if (!is_octree(type)) {
        bench_check_create(body, scene->params.w, check);
        return;
    }
    const OctStructure *structure = oct_engine_structure(engine);
    *check = (BenchCheck){.body = body,
                          .count = structure->tree.leaves,
                          .unique = structure->tree.leaves,
                          .hierarchical = true,
                          .plain = scene->octree.weighting == OCT_PLAIN};
    check->mass = sm_alloc((size_t)check->count, sizeof *check->mass);
    memcpy(check->mass, structure->mass, (size_t)check->count * sizeof *check->mass);
    ref_tree_init(&structure->tree, &structure->regions, structure->mass, check->plain,
                  &check->octree);
}

void bench_check_create(const BenchBody *body, int w, BenchCheck *check)
{
    long count = body->voxels.particle_count;
    *check = (BenchCheck){.body = body, .count = count};
    ref_regions_build(&body->voxels, w, NULL, 0, &check->regions);
    check->unique = ref_regions_unique(&check->regions);
    check->mass = sm_alloc((size_t)count, sizeof *check->mass);
    for (long p = 0; p < count; p++) check->mass[p] = body->mass ? body->mass[p] : 1;
}

void bench_check_free(BenchCheck *check)
{
    if (check->hierarchical)
        ref_tree_free(&check->octree);
    else
        ref_regions_free(&check->regions);
    free(check->mass);
    *check = (BenchCheck){0};
}

static bool all_finite(const double (*value)[3], long count)
{
    double sum = 0; /* 0 times anything that is not finite is NaN */
    for (long i = 0; i < count; i++) sum += 0 * value[i][0] + 0 * value[i][1] + 0 * value[i][2];
    return sum == 0;
}

/* Largest distance of two goals, in cells. */
static double goal_error(const double (*g)[3], const double (*exact)[3], long count, double cell)
{
    double largest = 0;
    for (long p = 0; p < count; p++) {
        double square = 0;
        for (int d = 0; d < 3; d++) square += (g[p][d] - exact[p][d]) * (g[p][d] - exact[p][d]);
        largest = fmax(largest, square);
    }
    return sqrt(largest) / cell;
}

static double momentum_error(const double (*x)[3], const double (*g)[3], const double *m,
                             long count)
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

/* The twin's goals of one body, in mesh units. Ties go to the identity, as in a lattice. */
static void exact_goals(const BenchCheck *check, const double (*x)[3], double (*exact)[3])
{
    const BenchBody *body = check->body;
    if (!check->hierarchical) {
        ref_goals(&check->regions, (const double(*)[3])body->x0, check->mass, x, exact);
        return;
    }
    RefTreeBody twin = check->octree;
    double(*at)[3] = sm_alloc((size_t)check->count, sizeof *at), cell = body->voxels.cell;
    twin.R = sm_alloc((size_t)check->count, sizeof *twin.R);
    for (long i = 0; i < check->count; i++)
        for (int d = 0; d < 3; d++) {
            at[i][d] = (x[i][d] - body->voxels.origin[d]) / cell;
            twin.R[i][4 * d] = 1;
        }
    ref_tree_goals(&twin, (const double(*)[3])at, false, exact);
    for (long i = 0; i < check->count; i++)
        for (int d = 0; d < 3; d++) exact[i][d] = body->voxels.origin[d] + cell * exact[i][d];
    free(at);
    free(twin.R);
}

BenchDeviation bench_check_state(const BenchCheck *check, const SmEngineType *type,
                                 SmEngine *engine)
{
    long count = check->count, all = count * check->body->instances;
    double(*x)[3] = sm_alloc((size_t)all, sizeof *x);
    double(*v)[3] = sm_alloc((size_t)all, sizeof *v);
    double(*g)[3] = sm_alloc((size_t)all, sizeof *g);
    double(*exact)[3] = sm_alloc((size_t)count, sizeof *exact);
    type->goals(engine);
    type->get(engine, SM_POSITION, x);
    type->get(engine, SM_VELOCITY, v);
    type->get(engine, SM_GOAL, g);
    BenchDeviation result = {.finite = all_finite((const double(*)[3])x, all) &&
                                       all_finite((const double(*)[3])v, all) &&
                                       all_finite((const double(*)[3])g, all)};
    if (!result.finite) result.goal_error = result.momentum_error = INFINITY;
    for (long first = 0; first < all && result.finite; first += count) {
        const double(*at)[3] = (const double(*)[3])(x + first);
        const double(*goal)[3] = (const double(*)[3])(g + first);
        exact_goals(check, at, exact);
        double error = goal_error(goal, (const double(*)[3])exact, count, check->body->voxels.cell);
        double drift = momentum_error(at, goal, check->mass, count);
        result.goal_error = fmax(result.goal_error, error);
        result.momentum_error = fmax(result.momentum_error, drift);
    }
    free(x);
    free(v);
    free(g);
    free(exact);
    return result;
}

double bench_check_tolerance(const char *precision)
{
    return strcmp(precision, "double") ? 5e-5 : 1e-10;
}
