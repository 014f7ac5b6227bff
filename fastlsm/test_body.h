/* test_body.h - a body, its arrays and engines, for the engine's tests. */
#ifndef LSM_TEST_BODY_H
#define LSM_TEST_BODY_H

#include "../lib/test_fields.h"
#include "../lib/test_frame.h"
#include "../lib/voxel/test_bodies.h"
#include "../reference/brute.h"
#include "fastlsm.h"

static const SmEngineType *const engines[2] = {&fastlsm_engine_f32, &fastlsm_engine_f64};

typedef struct {
    SmVoxels voxels;
    long n;
    double (*x0)[3], (*x)[3], (*v)[3], (*a)[3], (*b)[3], *m;
} Body;

static inline void body_arrays(Body *body)
{
    long n = body->n = body->voxels.particle_count;
    int(*coord)[3] = sm_alloc((size_t)n, sizeof *coord);
    body->x0 = triples(n);
    body->x = triples(n);
    body->v = triples(n);
    body->a = triples(n);
    body->b = triples(n);
    body->m = sm_alloc((size_t)n, sizeof(double));
    sm_voxels_particles(&body->voxels, coord);
    for (long p = 0; p < n; p++) {
        body->m[p] = 1;
        for (int d = 0; d < 3; d++)
            body->x0[p][d] = body->voxels.origin[d] + body->voxels.cell * coord[p][d];
    }
    free(coord);
}

static inline void body_random(unsigned *seed, int kind, int most, Body *body)
{
    random_body(seed, kind, most, &body->voxels);
    body_arrays(body);
    if (random_int(seed, 2))
        for (long p = 0; p < body->n; p++) body->m[p] = 0.5 + random_unit(seed);
    random_deformation(seed, body->voxels.cell, 0.3, body->n, (const double(*)[3])body->x0,
                       body->x);
    for (long p = 0; p < body->n; p++)
        for (int d = 0; d < 3; d++) body->v[p][d] = body->voxels.cell * (random_unit(seed) - 0.5);
}

static inline void body_free(Body *body)
{
    free(body->x0);
    free(body->x);
    free(body->v);
    free(body->a);
    free(body->b);
    free(body->m);
    sm_voxels_free(&body->voxels);
}

static inline SmEngine *create(const SmEngineType *type, const Body *body, SmEngineParams params)
{
    SmEngine *engine;
    SmError error = {0};
    params.mass = body->m;
    if (type->create(&body->voxels, &params, &engine, &error)) fail_msg("%s", error.text);
    type->set(engine, SM_POSITION, (const double(*)[3])body->x);
    type->set(engine, SM_VELOCITY, (const double(*)[3])body->v);
    return engine;
}

/* Largest difference of two fields, in cells. */
static inline double difference(const Body *body, const double (*a)[3], const double (*b)[3])
{
    return field_difference(body->n, a, b) / body->voxels.cell;
}

#endif
