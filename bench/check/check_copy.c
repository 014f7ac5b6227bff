#include "check_copy.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Where the engine has changed since it was made, as it would be built now. */
static SmEngine *build_alike(const SmEngineParams *params, const BenchBody *body, SmEngine *engine,
                             const BenchCopy *copy)
{
    const SmEngineType *type = copy->type;
    SmEngine *made = NULL;
    for (long p = 0; p < copy->all; p++) copy->order[p] = p;
    SmCode code = type->rebuild ? type->rebuild(engine, params, &made, copy->order, NULL) : SM_OK;
    if (!code && !made) code = type->create(&body->voxels, params, &made, NULL);
    if (!code && body->cut) code = type->cut(made, body->cut, 0, NULL);
    assert(!code); /* as `engine` was */
    (void)code;
    return made;
}

void bench_copy_create(const SmEngineParams *params, const BenchBody *body,
                       const SmEngineType *type, SmEngine *engine, long all, BenchCopy *copy)
{
    const SmField fields[] = {SM_POSITION, SM_VELOCITY};
    double(*values)[3] = sm_alloc((size_t)all, sizeof *values);
    *copy = (BenchCopy){.type = type, .all = all};
    copy->order = sm_alloc((size_t)all, sizeof *copy->order);
    copy->field = sm_alloc((size_t)all, sizeof *copy->field);
    copy->engine = build_alike(params, body, engine, copy);
    for (int i = 0; i < 2; i++) {
        type->get(engine, fields[i], values);
        for (long p = 0; p < all; p++)
            memcpy(copy->field[p], values[copy->order[p]], sizeof *values);
        type->set(copy->engine, fields[i], (const double(*)[3])copy->field);
    }
    free(values);
}

void bench_copy_free(BenchCopy *copy)
{
    copy->type->destroy(copy->engine);
    free(copy->order);
    free(copy->field);
    *copy = (BenchCopy){0};
}

void bench_copy_get(BenchCopy *copy, SmField field, double (*values)[3])
{
    copy->type->get(copy->engine, field, copy->field);
    for (long p = 0; p < copy->all; p++)
        memcpy(values[copy->order[p]], copy->field[p], sizeof *values);
}

void bench_copy_step(const SmEngineParams *params, const BenchBody *body, const SmEngineType *type,
                     SmEngine *engine, long all, BenchStep *step)
{
    BenchCopy copy;
    size_t count = (size_t)all;
    *step = (BenchStep){all, sm_alloc(count, sizeof *step->x), sm_alloc(count, sizeof *step->x),
                        sm_alloc(count, sizeof *step->x), sm_alloc(count, sizeof *step->x)};
    bench_copy_create(params, body, type, engine, all, &copy);
    type->goals(copy.engine);
    bench_copy_get(&copy, SM_GOAL, step->after);
    bench_copy_get(&copy, SM_POSITION, step->x);
    bench_copy_get(&copy, SM_VELOCITY, step->before);
    bench_copy_free(&copy);
    for (long p = 0; p < all; p++) /* fastlsm eq. 1 */
        for (int d = 0; d < 3; d++)
            step->before[p][d] +=
                (step->after[p][d] - step->x[p][d]) / params->h + params->h * params->gravity[d];
    bench_copy_create(params, body, type, engine, all, &copy);
    type->step(copy.engine, NULL);
    bench_copy_get(&copy, SM_VELOCITY, step->after);
    bench_copy_get(&copy, SM_POSITION, step->to);
    bench_copy_free(&copy);
}

void bench_copy_step_free(BenchStep *step)
{
    free(step->x);
    free(step->before);
    free(step->after);
    free(step->to);
    *step = (BenchStep){0};
}

double bench_copy_motion(const BenchStep *step, const SmEngineParams *params)
{
    double most = 0, h = params->h;
    for (long p = 0; p < step->all; p++)
        for (int d = 0; d < 3; d++) {
            double after = step->after[p][d], place = step->x[p][d] + h * after;
            double off = fabs(step->to[p][d] - place);
            if (!(params->damping > 0)) off = fmax(off, h * fabs(after - step->before[p][d]));
            most = fmax(most, isfinite(after + step->to[p][d]) ? off : INFINITY);
        }
    return most;
}
