/* test_change_body.h - bodies to be resampled, in one precision, and what moves them. */
#ifndef OCT_TEST_CHANGE_BODY_H
#define OCT_TEST_CHANGE_BODY_H

#include "../../lib/engine/engine.h"
#include "../../lib/test_fields.h"
#include "../body_arrays.h"
#include "../dynamic_body.h"
#include "../ghosts.h"
#include "../octree.h"
#include "test_batches.h"

typedef struct {
    OctStructure structure;
    Oct *oct;
    OctParams params;
    double *painted; /* masses of the vertices, or NULL */
} Body;

/* A random body at rest, ready to be changed. */
static inline void body_random(unsigned *seed, int trial, int most, OctMassRule masses,
                               OctParams params, Body *body)
{
    SmVoxels voxels;
    OctTree tree;
    random_tree(seed, trial % 6, most, &voxels, &tree);
    voxels.cell = 0.5;
    OctOptions options = {.epsilon = random_int(seed, 3) / 2.0,
                          .width = {.cells = random_int(seed, 3), .edges = 1},
                          .masses = masses};
    *body = (Body){.params = params};
    if (random_int(seed, 2)) {
        body->painted = sm_alloc((size_t)voxels.particle_count, sizeof(double));
        for (long p = 0; p < voxels.particle_count; p++) body->painted[p] = 0.5 + random_unit(seed);
    }
    assert_int_equal(oct_structure_of_tree(&voxels, &options, body->painted, &tree, NULL,
                                           &body->structure, NULL),
                     SM_OK);
    OctStructure *s = &body->structure;
    body->oct = oct_build(&s->tree, &s->regions, s->mass, &body->params);
    oct_resample_prepare(s);
    oct_prepare(body->oct, s);
    sm_voxels_free(&voxels);
}

static inline void body_free(Body *body)
{
    oct_free(body->oct);
    oct_structure_free(&body->structure);
    free(body->painted);
}

static inline const OctChange *update(Body *body)
{
    const OctChange *change = oct_resample_update(&body->structure);
    oct_change(body->oct, &body->structure, change, false);
    return change;
}

static inline bool alive(const Body *body, long leaf)
{
    return body->structure.tree.node[leaf] >= 0;
}

/* Where a leaf is, from the corner of voxel (0,0,0), and how fast. */
static inline void state_of(const Body *body, long leaf, double x[3], double v[3])
{
    const OctState *state = body->oct->body;
    for (int d = 0; d < 3; d++) {
        x[d] = oct_origin(body->oct, state, leaf)[d] + (double)state->x[oct_index(leaf, d)];
        v[d] = state->kick[d] + (double)state->v[oct_index(leaf, d)];
    }
}

static inline void rest_of(const Body *body, long leaf, double X[3])
{
    const OctTree *tree = &body->structure.tree;
    for (int d = 0; d < 3; d++) X[d] = 0.5 * tree->centre[tree->node[leaf]][d];
}

/* Pushes every node about a little. */
static inline void shake(unsigned *seed, Body *body, double far, double fast)
{
    OctState *state = body->oct->body;
    for (long leaf = 0; leaf < body->oct->leaves; leaf++)
        for (int d = 0; d < 3 && alive(body, leaf); d++) {
            state->x[oct_index(leaf, d)] += (real)(far * (random_unit(seed) - 0.5));
            state->v[oct_index(leaf, d)] += (real)(fast * (random_unit(seed) - 0.5));
        }
}

/* A block with random splits, whose cells at the sides are not full, or are. */
static inline void block_body(unsigned *seed, bool full, OctParams params, Body *body)
{
    SmVoxels voxels;
    OctTree tree;
    int corner[3] = {-random_int(seed, 8), -random_int(seed, 8), -random_int(seed, 8)};
    for (int d = 0; d < 3 && full; d++) corner[d] = 0;
    int side[3] = {7 + random_int(seed, 5), 9, 6 + random_int(seed, 4)};
    for (int d = 0; d < 3 && full; d++) side[d] = 8;
    sm_voxels_block(&voxels, side[0], side[1], side[2], 1);
    random_split_tree(seed, &voxels, 3, corner, 0.8, &tree);
    OctOptions options = {.epsilon = 0.5, .width = {.edges = 1}};
    *body = (Body){.params = params};
    assert_int_equal(
        oct_structure_of_tree(&voxels, &options, NULL, &tree, NULL, &body->structure, NULL), SM_OK);
    OctStructure *s = &body->structure;
    body->oct = oct_build(&s->tree, &s->regions, s->mass, &body->params);
    oct_resample_prepare(s);
    oct_prepare(body->oct, s);
    sm_voxels_free(&voxels);
}

/* A motion of the whole body. */
typedef struct {
    double R[9], to[3], turn[3], speed[3];
} Rigid;

static inline void rigid_place(const Rigid *r, const double X[3], double x[3])
{
    for (int i = 0; i < 3; i++)
        x[i] = r->to[i] + r->R[3 * i] * X[0] + r->R[3 * i + 1] * X[1] + r->R[3 * i + 2] * X[2];
}

static inline void rigid_velocity(const Rigid *r, const double x[3], double v[3])
{
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        v[d] = r->speed[d] + r->turn[e] * x[f] - r->turn[f] * x[e];
    }
}

static inline void put_rigid(Body *body, const Rigid *r)
{
    double(*x)[3] = triples(body->oct->leaves), v[3];
    for (long leaf = 0; leaf < body->oct->leaves; leaf++) {
        double X[3];
        rest_of(body, leaf, X);
        rigid_place(r, X, x[leaf]);
        rigid_velocity(r, x[leaf], v);
        for (int d = 0; d < 3; d++) body->oct->body->v[oct_index(leaf, d)] = (real)v[d];
    }
    oct_set_positions(body->oct, 0, (const double(*)[3])x);
    free(x);
}

#endif
