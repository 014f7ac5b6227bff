/* check_obstacles.c - the check of what static obstacles do in a step (check.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/brute_obstacle.h"
#include "check.h"
#include "check_copy.h"

/* A step's end: of mesh units and mesh units a second. */
typedef struct {
    double (*x)[3], (*v)[3]; /* [all] */
} End;

typedef struct {
    const BenchScene *scene;
    double cell, tolerance; /* mesh units; cells */
} Walls;

/* The state of `engine` stepped once by a copy, against these obstacles. */
static End take_step(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                     SmEngine *engine, long all, int obstacles)
{
    SmEngineParams params = bench_engine_params(scene, body, 1);
    SmBoundary boundary = {.obstacle_count = obstacles, .obstacle = scene->obstacle};
    End end = {sm_alloc((size_t)all, sizeof *end.x), sm_alloc((size_t)all, sizeof *end.v)};
    BenchCopy copy;
    params.collide = (SmCollideParams){0}; /* contacts come after obstacles */
    bench_copy_create(&params, body, type, engine, all, &copy);
    type->bound(copy.engine, &boundary);
    type->step(copy.engine, NULL);
    bench_copy_get(&copy, SM_POSITION, end.x);
    bench_copy_get(&copy, SM_VELOCITY, end.v);
    bench_copy_free(&copy);
    return end;
}

/* Whether obstacles, one after the other, make of a free particle at x what the engine did; counts
 * those that push in `pushes`. */
static bool agrees(const Walls *walls, const double x[3], const double v[3], const double to_x[3],
                   const double to_v[3], long *pushes)
{
    double at[3], speed[3], slack = 3 * walls->tolerance;
    bool same = true;
    memcpy(at, x, sizeof at);
    memcpy(speed, v, sizeof speed);
    for (int n = 0; n < walls->scene->obstacle_count; n++)
        *pushes += ref_obstacle_push_out(&walls->scene->obstacle[n], at, speed);
    for (int d = 0; d < 3; d++)
        same = same && fabs(at[d] - to_x[d]) <= slack * walls->cell &&
               fabs(speed[d] - to_v[d]) * walls->scene->params.h <= slack * walls->cell;
    return same;
}

/* The same, were the particle elsewhere by no more than rounding may take it. */
static bool undecided(const Walls *walls, const double x[3], const double v[3],
                      const double to_x[3], const double to_v[3])
{
    long unused = 0;
    for (int move = 0; move < 6; move++) {
        double at[3];
        memcpy(at, x, sizeof at);
        at[move / 2] += (move % 2 ? 1 : -1) * walls->tolerance * walls->cell;
        if (agrees(walls, at, v, to_x, to_v, &unused)) return true;
    }
    return false;
}

/* Rounding of coordinates that count from where the first particle was at rest. */
static double tolerance(const BenchCheck *check, const SmEngineType *type, const End *end, long all)
{
    double farthest = 1;
    for (long p = 0; p < all; p++)
        for (int d = 0; d < 3; d++)
            farthest = fmax(farthest, fabs(end->x[p][d] - check->body->voxels.origin[d]) /
                                          check->body->voxels.cell);
    return 16 * bench_check_epsilon(type->precision) * farthest;
}

void bench_check_obstacles(const BenchCheck *check, const BenchScene *scene,
                           const SmEngineType *type, SmEngine *engine, BenchDeviation *found)
{
    const BenchBody *body = check->body;
    long all = check->count * body->instances;
    if (scene->obstacle_count == 0 || !found->finite) return;
    End before = take_step(scene, body, type, engine, all, 0);
    End after = take_step(scene, body, type, engine, all, scene->obstacle_count);
    Walls walls = {scene, body->voxels.cell, tolerance(check, type, &before, all)};
    for (long p = 0; p < all; p++) {
        long pushes = 0;
        bool right = agrees(&walls, before.x[p], before.v[p], after.x[p], after.v[p], &pushes) ||
                     undecided(&walls, before.x[p], before.v[p], after.x[p], after.v[p]);
        found->pushed += pushes > 0;
        found->pushed_wrong += !right;
    }
    found->obstacles = true;
    free(before.x);
    free(before.v);
    free(after.x);
    free(after.v);
}
