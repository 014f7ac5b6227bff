/* Holds collisions to their slow twin on random irregular bodies, and the response to its laws. */
#include "../../fastlsm/lattice/outline.h"
#include "../../octree/change/test_batches.h"
#include "../../octree/surface/outline.h"
#include "../../reference/brute_collide.h"
#include "../test_fields.h"
#include "../test_frame.h"
#include "../vector.h"
#include "../voxel/test_bodies.h"
#include "patches.h"
#include "rest.h"

enum { BODIES = 3 };

/* A body's description and BODIES instances of it somewhere. */
typedef struct {
    SmVoxels voxels;
    LsmLattice lattice;
    LsmOutline outline;
    OctStructure structure;
    OctOutline leaves;
    const SmCollideRest *rest;
    double *mass, (*x)[3], (*v)[3], (*frame)[9];
} Body;

static const SmCollideParams everything = {.self = true, .bodies = true, .friction = 0.3};

/* Rolls the body up along its first axis, so that its ends meet and it lies within itself, and
 * shakes it. */
static void roll(unsigned *seed, const Body *body, double angle, double noise, double (*x)[3])
{
    const SmCollideRest *rest = body->rest;
    double length = 1, radius, shift[3];
    for (long i = 0; i < rest->nodes; i++) length = fmax(length, rest->x0[i][0]);
    radius = length / angle;
    for (int d = 0; d < 3; d++) shift[d] = 3 * random_unit(seed);
    for (long i = 0; i < rest->nodes; i++) {
        double turn = rest->x0[i][0] / radius, out = radius + rest->x0[i][1];
        double to[3] = {-out * cos(turn), out * sin(turn), rest->x0[i][2]};
        if (angle < 0.1) memcpy(to, rest->x0[i], sizeof to);
        for (int d = 0; d < 3; d++) x[i][d] = to[d] + shift[d] + noise * (random_unit(seed) - 0.5);
    }
}

static void place(unsigned *seed, Body *body)
{
    long n = body->rest->nodes;
    double angle = random_int(seed, 3) ? 5 + 3 * random_unit(seed) : 0;
    body->x = triples(BODIES * n);
    body->v = triples(BODIES * n);
    for (long b = 0; b < BODIES; b++) roll(seed, body, angle, 0.3, body->x + b * n);
    for (long i = 0; i < BODIES * n; i++)
        for (int d = 0; d < 3; d++) body->v[i][d] = random_unit(seed) - 0.5;
}

/* Any shape, or a strip that is long enough to be rolled up. */
static void any_voxels(unsigned *seed, int most, SmVoxels *voxels)
{
    int size[3] = {18 + random_int(seed, 8), 1 + random_int(seed, 3), 1 + random_int(seed, 4)};
    if (random_int(seed, 2))
        random_body(seed, random_int(seed, 6), most, voxels);
    else
        random_block(seed, size, 1, 0.95, voxels);
}

static void lattice_body(unsigned *seed, Body *body)
{
    *body = (Body){0};
    any_voxels(seed, 7, &body->voxels);
    lsm_lattice_build(&body->voxels, &body->lattice);
    body->mass = sm_alloc((size_t)body->lattice.count, sizeof(double));
    for (long p = 0; p < body->lattice.count; p++) {
        body->mass[p] = 0.5 + random_unit(seed);
        for (int bit = 0; bit < LSM_RING; bit++) /* some links are broken */
            if (bit != LSM_SELF && body->lattice.link[p] >> bit & 1 && random_int(seed, 300) == 0)
                lsm_lattice_break(&body->lattice, p, bit);
    }
    lsm_outline_build(&body->lattice, body->mass, &body->outline);
    body->rest = &body->outline.rest;
    place(seed, body);
}

static void octree_body(unsigned *seed, Body *body)
{
    *body = (Body){0};
    OctOptions options = {.sampling = {.levels = 2, .criteria_count = 1}};
    options.sampling.criteria[0] =
        (OctCriterion){.kind = random_int(seed, 2) ? OCT_SURFACE : OCT_FEATURES, .level = 2};
    SmError error;
    any_voxels(seed, 9, &body->voxels);
    if (oct_structure_build(&body->voxels, &options, NULL, &body->structure, &error))
        fail_msg("%s", error.text);
    unsigned own = *seed;
    for (int batch = random_int(&own, 4); batch > 0; batch--) { /* some have been changed and cut */
        random_batch(&own, &body->structure, 3);
        oct_resample_update(&body->structure);
    }
    oct_outline_build(&body->structure, &body->leaves);
    body->rest = &body->leaves.rest;
    place(seed, body);
    size_t all = (size_t)(BODIES * body->rest->nodes);
    body->frame = sm_alloc(all, sizeof *body->frame);
    for (size_t i = 0; i < all; i++) {
        double a[3], b[3], c[3];
        for (int d = 0; d < 3; d++) {
            a[d] = random_unit(seed) - 0.5;
            b[d] = random_unit(seed) - 0.5;
        }
        sm_normalize(a);
        sm_cross(a, b, c);
        sm_normalize(c);
        sm_cross(c, a, b);
        for (int d = 0; d < 3; d++) {
            body->frame[i][3 * d] = a[d];
            body->frame[i][3 * d + 1] = b[d];
            body->frame[i][3 * d + 2] = c[d];
        }
    }
}

static void any_body(unsigned *seed, bool lattice, Body *body)
{
    if (lattice)
        lattice_body(seed, body);
    else
        octree_body(seed, body);
}

static void body_free(Body *body)
{
    if (body->frame) {
        oct_outline_free(&body->leaves);
        oct_structure_free(&body->structure);
    } else {
        lsm_outline_free(&body->outline);
        lsm_lattice_free(&body->lattice);
    }
    sm_voxels_free(&body->voxels);
    free(body->mass);
    free(body->x);
    free(body->v);
    free(body->frame);
}

static SmCollide *find(const Body *body, const SmCollideParams *params, int threads)
{
    SmCollide *c = sm_collide_build(body->rest, params, BODIES, 0, threads);
    sm_collide_find(c, (const double(*)[3])body->x, (const double(*)[9])body->frame);
    return c;
}

static int compare(const void *a, const void *b)
{
    const SmCollideContact *x = a, *y = b;
    if (x->node != y->node) return x->node < y->node ? -1 : 1;
    return (x->cell > y->cell) - (x->cell < y->cell);
}

static void same_contact(const Body *body, const SmCollideContact *found, const RefContact *exact)
{
    assert_int_equal(found->cell, exact->cell);
    assert_int_equal(found->node, exact->node);
    assert_float_equal(found->depth, exact->depth, 1e-9);
    for (int d = 0; d < 3; d++) assert_float_equal(found->out[d], exact->out[d], 1e-6);
    for (int k = 0; k < body->rest->carriers; k++)
        assert_float_equal(found->weight[k], exact->weight[k], 1e-9);
}

/* All contacts, by rising node, then cell; the caller frees them. O(bodies^2 nodes x cells). */
static long brute_contacts(const SmCollideRest *rest, const SmCollideParams *params, long bodies,
                           const double (*x)[3], const double (*frame)[9], RefContact **contact)
{
    RefCollide *twin = ref_collide_start(rest, params, bodies, x, frame);
    long count = 0;
    *contact = NULL;
    for (long number = 0; number < bodies * rest->nodes; number++)
        count = ref_collide_node(twin, number, contact, count);
    ref_collide_free(twin);
    return count;
}

/* Returns how many contacts there are. */
static long same_contacts(const Body *body, const SmCollideParams *params)
{
    SmCollide *c = find(body, params, 1);
    RefContact *exact;
    long at = 0, count = brute_contacts(body->rest, params, BODIES, (const double(*)[3])body->x,
                                        (const double(*)[9])body->frame, &exact);
    if (c->contact_count) qsort(c->contact, (size_t)c->contact_count, sizeof *c->contact, compare);
    for (long i = 0; i < count; i++) {
        const SmCollideContact *found = &c->contact[at];
        bool missing =
            at == c->contact_count || found->cell != exact[i].cell || found->node != exact[i].node;
        if (missing && exact[i].beyond) continue; /* collide.h */
        assert_true(at < c->contact_count);
        same_contact(body, found, &exact[i]);
        at++;
    }
    assert_int_equal(at, c->contact_count);
    free(exact);
    sm_collide_free(c);
    return at;
}

/* The middle of a cross has 24 outer faces equally near: depth is measured to whichever is nearest
 * to a place, however cells are numbered. */
TEST(depth_is_from_any_of_the_nearest_faces)
{
    Body body = {0};
    SmCollideShape shape;
    double mass[64];
    for (int n = 0; n < 64; n++) mass[n] = 1;
    sm_voxels_init(&body.voxels, 3, 3, 3, 1);
    for (int n = 0; n < 27; n++)
        if ((n % 3 == 1) + (n / 3 % 3 == 1) + (n / 9 == 1) >= 2)
            sm_voxel_set(&body.voxels, n % 3, n / 3 % 3, n / 9);
    sm_voxels_count(&body.voxels);
    lsm_lattice_build(&body.voxels, &body.lattice);
    lsm_outline_build(&body.lattice, mass, &body.outline);
    sm_collide_shape_build(&body.outline.rest, &shape);
    const SmCollideCell *middle = shape.cell;
    while (middle->level == 0) middle++;
    assert_int_equal(middle->face_end - middle->face, 24);
    for (int edge = 0; edge < 12; edge++) {
        double q[3], out[3], depth;
        for (int k = 0; k < 3; k++) {
            double off = k == 2 ? 0 : edge >> k & 1 ? 0.4 : -0.4;
            q[(edge / 4 + k) % 3] = middle->centre[(edge / 4 + k) % 3] + off;
        }
        assert_true(sm_collide_depth(&shape, middle, q, 0, &depth, out));
        assert_true(fabs(depth - 0.1 * sqrt(2)) < 1e-12);
    }
    sm_collide_shape_free(&shape);
    lsm_outline_free(&body.outline);
    lsm_lattice_free(&body.lattice);
    sm_voxels_free(&body.voxels);
}

TEST(test_twin)
{
    unsigned seed = 5;
    long contacts = 0, self = 0;
    for (int round = 0; round < 60; round++) {
        Body body;
        any_body(&seed, round % 3 > 0, &body);
        contacts += same_contacts(&body, &everything);
        self += same_contacts(&body, &(SmCollideParams){.self = true});
        same_contacts(&body, &(SmCollideParams){.bodies = true});
        body_free(&body);
    }
    assert_true(self > 300 && contacts > 5000);
}

/* Parts that are joined have no node and cell that may collide, and what a search says of a node
 * and a cell is what the twin says. */
TEST(test_parts)
{
    unsigned seed = 15;
    long joined = 0, far = 0;
    for (int round = 0; round < 40; round++) {
        Body body;
        any_body(&seed, round % 2 > 0, &body);
        SmCollideShape shape;
        SmCollidePatches patches;
        SmCollidePaths paths = {0};
        sm_collide_shape_build(body.rest, &shape);
        sm_collide_patches_build(&shape, &patches);
        sm_collide_paths_start(&paths, &shape);
        for (long a = 0; a < patches.count; a++)
            for (long j = patches.joined_first[a]; j < patches.joined_first[a + 1]; j++, joined++) {
                int b = patches.joined[j];
                assert_true(sm_collide_patches_joined(&patches, b, a));
                for (long i = patches.node_first[a]; i < patches.node_first[a + 1]; i++)
                    for (long k = patches.cell_first[b]; k < patches.cell_first[b + 1]; k++)
                        assert_false(
                            sm_collide_may(&paths, &shape, patches.node[i], patches.cell[k]));
            }
        for (int n = 0; n < 3 && shape.surface_count; n++) {
            int node = shape.surface[random_int(&seed, (int)shape.surface_count)];
            int k = random_int(&seed, (int)shape.cell_count);
            bool may = sm_collide_may(&paths, &shape, node, k);
            SmCollideRelation told = sm_collide_relation(&shape, node, k);
            assert_int_equal(may, !ref_collide_near(body.rest, node, shape.cell[k].number));
            assert_true(told == SM_COLLIDE_UNKNOWN || (told == SM_COLLIDE_MAY) == may);
            far += may;
        }
        sm_collide_paths_free(&paths);
        sm_collide_patches_free(&patches);
        sm_collide_shape_free(&shape);
        body_free(&body);
    }
    assert_true(joined > 500 && far > 20);
}

/* At rest nothing touches, whatever the shape. */
TEST(test_rest)
{
    unsigned seed = 9;
    for (int round = 0; round < 40; round++) {
        Body body;
        any_body(&seed, round % 2 > 0, &body);
        long n = body.rest->nodes;
        for (long i = 0; i < BODIES * n; i++)
            for (int d = 0; d < 3; d++)
                body.x[i][d] = body.rest->x0[i % n][d] + (double)(d == 0) * 1e3 * (double)(i / n);
        for (long i = 0; i < BODIES * n && body.frame; i++)
            for (int k = 0; k < 9; k++) body.frame[i][k] = k % 4 == 0;
        SmCollide *c = find(&body, &everything, 1);
        assert_int_equal(c->contact_count, 0);
        sm_collide_free(c);
        body_free(&body);
    }
}

/* Sum of m |v|^2 / 2 of the nodes that contacts change, at the mean of the two velocities. */
static double motion(const SmCollide *c, const double (*before)[3], const double (*after)[3])
{
    double sum = 0;
    for (long i = 0; i < c->node_count; i++)
        for (int d = 0; d < 3; d++) {
            double v = 0.5 * (before[i][d] + after[i][d]);
            sum += 0.5 * v * v / c->shape.inverse_mass[c->node[i] % c->shape.nodes];
        }
    return sum;
}

/* Momentum stays; the energy that motion loses is what the reserve gains. */
static void check_response(unsigned *seed, const Body *body)
{
    SmCollide *c = find(body, &everything, 1);
    double(*before)[3] = triples(c->node_count), (*after)[3] = triples(c->node_count);
    for (long i = 0; i < c->node_count; i++)
        for (int d = 0; d < 3; d++) {
            before[i][d] = body->v[c->node[i]][d];
            after[i][d] = before[i][d] + 0.2 * (random_unit(seed) - 0.5);
        }
    c->reserve = 0.5;
    if (c->node_count) memcpy(c->v, before, (size_t)c->node_count * sizeof *before);
    sm_collide_begin(c);
    if (c->node_count) memcpy(c->v, after, (size_t)c->node_count * sizeof *after);
    double was = motion(c, (const double(*)[3])before, (const double(*)[3])after);
    sm_collide_respond(c);
    double moved[3] = {0}, size = 0;
    for (long i = 0; i < c->node_count; i++)
        for (int d = 0; d < 3; d++) {
            double p = c->v[i][d] / c->shape.inverse_mass[c->node[i] % c->shape.nodes];
            moved[d] += p;
            size += fabs(p);
            before[i][d] += c->v[i][d]; /* an impulse at the positions changes both */
            after[i][d] += c->v[i][d];
        }
    for (int d = 0; d < 3; d++) assert_true(fabs(moved[d]) <= 1e-12 * (1 + size));
    double is = motion(c, (const double(*)[3])before, (const double(*)[3])after);
    assert_true(c->reserve >= 0);
    assert_float_equal(is + c->reserve, was + 0.5, 1e-10 * (1 + was));
    free(before);
    free(after);
    sm_collide_free(c);
}

TEST(test_response)
{
    unsigned seed = 21;
    for (int round = 0; round < 30; round++) {
        Body body;
        any_body(&seed, round % 3 > 0, &body);
        check_response(&seed, &body);
        body_free(&body);
    }
}

/* Fixed nodes get nothing, and the others all the more. */
TEST(test_fixed)
{
    unsigned seed = 33;
    Body body;
    do { /* one with contacts */
        lattice_body(&seed, &body);
        SmCollide *c = find(&body, &everything, 1);
        long found = c->contact_count;
        sm_collide_free(c);
        if (found > 10) break;
        body_free(&body);
    } while (true);
    long n = body.rest->nodes, *fixed = sm_alloc((size_t)n, sizeof *fixed), moved = 0;
    SmCollide *c = sm_collide_build(body.rest, &everything, BODIES, 0, 1);
    for (long i = 0; i < n; i++) fixed[i] = n + i;
    sm_collide_fix(c, n, fixed);
    sm_collide_find(c, (const double(*)[3])body.x, NULL);
    for (int twice = 0; twice < 2; twice++) {
        for (long i = 0; i < c->node_count; i++) memcpy(c->v[i], body.v[c->node[i]], sizeof *c->v);
        if (!twice) sm_collide_begin(c);
    }
    sm_collide_respond(c);
    for (long i = 0; i < c->node_count; i++)
        for (int d = 0; d < 3; d++) {
            if (c->node[i] / n == 1)
                assert_true(c->v[i][d] == 0);
            else
                moved += c->v[i][d] != 0;
        }
    assert_true(moved > 0);
    free(fixed);
    sm_collide_free(c);
    body_free(&body);
}

/* The same bits from any number of threads, and from a description given later. */
TEST(test_threads)
{
    unsigned seed = 41;
    for (int round = 0; round < 12; round++) {
        Body body, other;
        lattice_body(&seed, &body);
        lattice_body(&seed, &other);
        SmCollide *c[3] = {find(&body, &everything, 1), find(&body, &everything, 3),
                           find(&other, &everything, 2)};
        sm_collide_describe(c[2], body.rest);
        sm_collide_find(c[2], (const double(*)[3])body.x, NULL);
        for (int k = 1; k < 3; k++) {
            assert_int_equal(c[k]->contact_count, c[0]->contact_count);
            assert_int_equal(c[k]->node_count, c[0]->node_count);
            for (long i = 0; i < c[0]->contact_count; i++) {
                assert_int_equal(c[k]->contact[i].node, c[0]->contact[i].node);
                assert_int_equal(c[k]->contact[i].cell, c[0]->contact[i].cell);
                assert_true(c[k]->contact[i].depth == c[0]->contact[i].depth);
            }
        }
        for (int k = 0; k < 3; k++) sm_collide_free(c[k]);
        body_free(&body);
        body_free(&other);
    }
}

/* Positions that are not finite touch nothing, and hang nothing; what touches lies at places that
 * are, no deeper than cells may be stretched, and its way out is a direction. */
TEST(test_wild)
{
    static const double wild[] = {NAN, INFINITY, -INFINITY, 1e300, -1e12, 1e9};
    unsigned seed = 51;
    for (int round = 0; round < 24; round++) {
        Body body;
        any_body(&seed, round % 2 > 0, &body);
        long all = BODIES * body.rest->nodes;
        double other = wild[round / 2 % 6];
        for (long i = 0; i < all; i++)
            if (round < 12 || random_int(&seed, 4) == 0) body.x[i][round % 3] = other;
        SmCollide *c = find(&body, &everything, 1);
        if (round < 12 && !isfinite(other)) assert_int_equal(c->contact_count, 0);
        for (long i = 0; i < c->contact_count; i++) {
            const SmCollideContact *contact = &c->contact[i];
            assert_true(contact->depth > 0 && contact->depth < SM_COLLIDE_LAYERS * 8);
            assert_float_equal(sm_dot(contact->out, contact->out), 1, 1e-12);
            for (int d = 0; d < 3; d++) assert_true(isfinite(body.x[contact->node][d]));
        }
        sm_collide_free(c);
        body_free(&body);
    }
}

/* Bodies that move: what is found does not depend on where they have been before. */
TEST(test_moves)
{
    unsigned seed = 71;
    long found = 0;
    for (int round = 0; round < 12; round++) {
        Body body;
        if (round % 2)
            lattice_body(&seed, &body);
        else
            octree_body(&seed, &body);
        long n = body.rest->nodes;
        SmCollide *c = find(&body, &everything, 1);
        for (int move = 0; move < 8; move++) {
            double turn = 0.1 * random_unit(&seed), far = move == 5 ? 30 : 0.3;
            for (long i = 0; i < BODIES * n; i++) {
                double *x = body.x[i], y = x[1];
                x[1] = y - turn * x[2] + far * random_unit(&seed);
                x[2] += turn * y + (move == 3 && i % n < n / 2 ? 2 : 0);
            }
            sm_collide_find(c, (const double(*)[3])body.x, (const double(*)[9])body.frame);
            SmCollide *fresh = find(&body, &everything, 1);
            assert_int_equal(c->contact_count, fresh->contact_count);
            for (long i = 0; i < c->contact_count; i++) {
                assert_int_equal(c->contact[i].node, fresh->contact[i].node);
                assert_int_equal(c->contact[i].cell, fresh->contact[i].cell);
                assert_true(c->contact[i].depth == fresh->contact[i].depth);
            }
            found += c->contact_count;
            sm_collide_free(fresh);
        }
        sm_collide_free(c);
        body_free(&body);
    }
    assert_true(found > 1000);
}
