#include "strides.h"

#include <math.h>
#include <stdlib.h>

#include "../../lib/vector.h"
#include "../../reference/brute_obstacle.h"
#include "../system/remark.h"

/* How thick an obstacle is: what is within is put out at the nearest side. */
static double thickness(const SmObstacle *o)
{
    double least = o->kind == SM_PLANE || o->kind == SM_BOX ? INFINITY : 2 * o->radius;
    for (int d = 0; d < 3 && o->kind == SM_BOX; d++) least = fmin(least, o->b[d] - o->a[d]);
    return least;
}

/* Is x on the other side of it than `before`, straight through it? */
static bool passes(const SmObstacle *o, double thick, const double before[3], const double x[3])
{
    double by[3], end[3], v[3] = {0};
    for (int d = 0; d < 3; d++) by[d] = (end[d] = x[d]) - before[d];
    double length = sqrt(sm_dot(by, by));
    if (length <= thick / 2) return false;
    int samples = (int)fmin(1000, ceil(4 * length / thick));
    ref_obstacle_push_out(o, end, v);
    for (int i = 1; i <= samples; i++) {
        double at[3], out[3], from_end[3];
        for (int d = 0; d < 3; d++) at[d] = out[d] = before[d] + by[d] * i / samples;
        if (!ref_obstacle_push_out(o, out, v)) continue;
        for (int d = 0; d < 3; d++) {
            from_end[d] = out[d] - end[d];
            at[d] = out[d] - at[d];
        }
        return sm_dot(from_end, at) > 0.9 * thick * sqrt(sm_dot(at, at));
    }
    return false;
}

bool bench_strides_look(BenchStrides *strides, const BenchPlayback *play)
{
    const BenchScene *scene = play->scene;
    double sum = 0;
    for (int p = 0; p < play->count; p++) {
        const BenchRunner *runner = &play->group[p].runner;
        double(*x)[3] = sm_alloc((size_t)runner->particles, sizeof *x);
        bool followed = play->count == 1 && strides->count == runner->particles;
        runner->type->get(runner->engine, SM_POSITION, x);
        for (long i = 0; i < runner->particles; i++) {
            sum += 0 * (x[i][0] + x[i][1] + x[i][2]);
            if (!followed) continue;
            double step = sqrt(sm_square_between(x[i], strides->x[i])) / scene->steps_per_frame;
            strides->farthest = fmax(strides->farthest, step);
            for (int k = 0; k < scene->obstacle_count; k++)
                if (passes(&scene->obstacle[k], thickness(&scene->obstacle[k]), strides->x[i],
                           x[i]))
                    strides->through[k] = fmax(strides->through[k], step);
        }
        free(strides->x);
        strides->x = x;
        strides->count = play->count == 1 ? runner->particles : 0;
    }
    return sum == 0;
}

void bench_strides_remark(const BenchStrides *strides, const BenchPlayback *play)
{
    static const char *const kinds[] = {"plane", "sphere", "box", "capsule"};
    const BenchScene *scene = play->scene;
    double h = scene->params.h, size = bench_body_size(play->body);
    int number[4] = {0};
    for (int i = 0; i < scene->obstacle_count; i++) {
        const SmObstacle *o = &scene->obstacle[i];
        double thick = thickness(o);
        number[o->kind]++;
        if (strides->through[i] > 0)
            bench_remark("%s: particles passed through %s %d, which is %.3g thick: a step took "
                         "them up to %.3g; --h %.2g, or a thickness of %.2g, holds them",
                         scene->name, kinds[o->kind], number[o->kind], thick, strides->through[i],
                         0.3 * h * thick / strides->through[i], 3 * strides->through[i]);
    }
    if (strides->farthest > size)
        bench_remark("%s: a step took a particle up to %.3g times as far as the body is large: "
                     "--h %.2g is short enough to see it move",
                     scene->name, strides->farthest / size, 0.1 * h * size / strides->farthest);
}
