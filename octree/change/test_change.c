/* Bodies that are resampled while they run, in both precisions (SM_REAL_BITS). */
#include "test_change_body.h"

#define SINGLE (SM_REAL_BITS == 32)

static const double tolerance = SINGLE ? 5e-5 : 1e-10; /* of positions, finest cells */
static const double rounding = SINGLE ? 1e-5 : 1e-12;  /* of constants, relative */

static void near(double a, double b, double scale, const char *what, int trial, long leaf)
{
    if (!(fabs(a - b) <= rounding * scale))
        fail_msg("trial %d, leaf %ld: %s is %.15g, from scratch %.15g", trial, leaf, what, a, b);
}

/* The constants of leaf i against those of leaf j of a body built from scratch. */
static void check_constants(const Body *body, long i, const Oct *fresh, long j, int trial)
{
    const Oct *oct = body->oct;
    const OctConst *a = &oct->block[i / SM_LANES], *b = &fresh->block[j / SM_LANES];
    long m = i % SM_LANES, n = j % SM_LANES;
    double unit = oct->mass_unit / fresh->mass_unit;
    double plain = body->params.weighting == OCT_PLAIN ? unit : 1;
#define CHECK(name, factor, scale)                                                                 \
    near((double)a->name[m] * (factor), (double)b->name[n], (scale), #name, trial, i)
    CHECK(mass, unit, (double)b->mass[n]);
    CHECK(weight, plain, (double)b->weight[n]);
    CHECK(inverse_reach, 1 / unit, (double)b->inverse_reach[n]);
    CHECK(inverse_mass, 1 / plain, (double)b->inverse_mass[n]);
    for (int d = 0; d < 3; d++) CHECK(offset[d], 1, 16);
#undef CHECK
    for (int e = 0; e < 6 && oct->spread; e++)
        near((double)oct->spread[(i / SM_LANES * 6 + e) * SM_LANES + m] * plain,
             (double)fresh->spread[(j / SM_LANES * 6 + e) * SM_LANES + n],
             256 / (double)b->inverse_mass[n], "spread", trial, i);
    OctCollinear none = {.lanes = {0}};
    const OctCollinear *collinear = oct->collinear_of[i / SM_LANES] < 0
                                        ? &none
                                        : &oct->collinear[oct->collinear_of[i / SM_LANES]];
    const OctCollinear *same = fresh->collinear_of[j / SM_LANES] < 0
                                   ? &none
                                   : &fresh->collinear[fresh->collinear_of[j / SM_LANES]];
    assert_int_equal(collinear->lanes[m], same->lanes[n]);
    double along = 0, square = 0; /* either way along the line */
    for (int d = 0; d < 3; d++) {
        along += (double)collinear->axis[d][m] * (double)same->axis[d][n];
        square += (double)same->axis[d][n] * (double)same->axis[d][n];
    }
    near(fabs(along), square, 1, "axis", trial, i);
}

/* Copies the state of leaf i to leaf j of another body. */
static void copy_state(const Oct *oct, long i, Oct *fresh, long j)
{
    const OctState *from = oct->body, *to = fresh->body;
    for (int d = 0; d < 3; d++) {
        to->x[oct_index(j, d)] = from->x[oct_index(i, d)];
        to->v[oct_index(j, d)] = from->v[oct_index(i, d)];
    }
    for (int e = 0; e < 6; e++)
        to->last[(j / SM_LANES * 6 + e) * SM_LANES + j % SM_LANES] =
            from->last[(i / SM_LANES * 6 + e) * SM_LANES + i % SM_LANES];
    for (int e = 0; e < 9 && oct->spread; e++)
        to->plastic[(j / SM_LANES * 9 + e) * SM_LANES + j % SM_LANES] =
            from->plastic[(i / SM_LANES * 9 + e) * SM_LANES + i % SM_LANES];
}

static void check_field(const Body *body, const real *field, const long *same, const real *fresh,
                        const char *what, int trial)
{
    for (long leaf = 0; leaf < body->oct->leaves; leaf++)
        for (int d = 0; d < 3 && same[leaf] >= 0; d++) {
            double a = (double)field[oct_index(leaf, d)],
                   b = (double)fresh[oct_index(same[leaf], d)];
            if (!(fabs(a - b) <= tolerance))
                fail_msg("trial %d, leaf %ld: %s is %.15g, from scratch %.15g", trial, leaf, what,
                         a, b);
        }
}

/* What regions keep of a step depends on their rest moments. */
static void check_shapes(const Body *body, const long *same, const Oct *twin, int trial)
{
    for (long leaf = 0; leaf < body->oct->leaves && twin->spread; leaf++)
        for (int e = 0; e < 9 && same[leaf] >= 0; e++) {
            long to = same[leaf];
            double a = (double)body->oct->body
                           ->plastic[(leaf / SM_LANES * 9 + e) * SM_LANES + leaf % SM_LANES],
                   b = (double)
                           twin->body->plastic[(to / SM_LANES * 9 + e) * SM_LANES + to % SM_LANES];
            /* in single precision rounding may decide whether a region yields */
            if (!(fabs(a - b) <= (SINGLE ? 5e-3 : 1e-8)))
                fail_msg("trial %d, leaf %ld: shape is %g, from scratch %g", trial, leaf, a, b);
        }
}

/* The body against one built from scratch and put into the same state: constants, goal positions,
 * and what a step makes of it. */
static void check_rebuilt(Body *body, int trial)
{
    OctStructure fresh;
    Oct *oct = body->oct;
    rebuild(&body->structure, body->painted, &fresh);
    Oct *twin = oct_build(&fresh.tree, &fresh.regions, fresh.mass, &body->params);
    assert_int_equal(oct->alive, twin->leaves);
    oct_ghosts_merge(twin);
    long *same = sm_alloc((size_t)oct->leaves, sizeof *same), found = 0;
    for (long leaf = 0; leaf < oct->leaves; leaf++) {
        same[leaf] = -1;
        assert_int_equal(alive(body, leaf), oct_alive(oct, leaf));
        if (!alive(body, leaf)) continue;
        same[leaf] = same_leaf(&body->structure, leaf, &fresh);
        check_constants(body, leaf, twin, same[leaf], trial);
        copy_state(oct, leaf, twin, same[leaf]);
        found++;
    }
    assert_int_equal(found, twin->leaves);
    memcpy(twin->body->origin, oct->body->origin, sizeof *oct->body->origin);
    memcpy(twin->body->kick, oct->body->kick, sizeof oct->body->kick);
    for (long block = 0; block < twin->blocks && twin->spread; block++)
        oct_block_inverse(twin, 0, block);
    twin->steps = oct->steps;
    oct_goals(oct);
    oct_goals(twin);
    check_field(body, oct->body->g, same, twin->body->g, "goal", trial);
    oct_step(oct, NULL);
    oct_step(twin, NULL);
    check_field(body, oct->body->x, same, twin->body->x, "place", trial);
    check_field(body, oct->body->v, same, twin->body->v, "velocity", trial);
    check_shapes(body, same, twin, trial);
    free(same);
    oct_free(twin);
    oct_structure_free(&fresh);
}

static OctParams random_params(int trial)
{
    OctParams params = {.weighting = (OctWeighting)(trial % 5 == 4),
                        .damping = trial % 3 ? 0.2 : 0,
                        .gravity = {0, -0.001, 0},
                        .threads = 1};
    if (trial % 2) {
        params.creep = 0.1;
        params.yield = 0.02;
        params.most = 0.4;
    }
    return params;
}

TEST(test_rebuilt)
{
    unsigned seed = 1;
    for (int trial = 0; trial < 60; trial++) {
        Body body;
        body_random(&seed, trial, 10, (OctMassRule)(trial % 4 == 3), random_params(trial), &body);
        for (int batch = 0; batch < 8; batch++) {
            shake(&seed, &body, 0.1, 0.01);
            random_batch(&seed, &body.structure, 3 + trial % 5);
            update(&body);
            check_rebuilt(&body, trial);
        }
        body_free(&body);
    }
}

/* All of the body moves rigidly, but for one translation of place and velocity that all share;
 * after a step only the velocity is that of before. */
static void check_rigid(const Body *body, const Rigid *r, bool stepped, int trial)
{
    double first[2][3], X[3], x[3], v[3], off[2][3];
    bool any = false;
    for (long leaf = 0; leaf < body->oct->leaves; leaf++) {
        if (!alive(body, leaf)) continue;
        rest_of(body, leaf, X);
        state_of(body, leaf, x, v);
        rigid_place(r, X, off[0]);
        rigid_velocity(r, off[0], off[1]);
        for (int d = 0; d < 3; d++) {
            off[0][d] = stepped ? 0 : off[0][d] - x[d];
            off[1][d] -= v[d];
        }
        if (!any) memcpy(first, off, sizeof first);
        any = true;
        for (int k = 0; k < 2; k++)
            for (int d = 0; d < 3; d++)
                if (!(fabs(off[k][d] - first[k][d]) < tolerance))
                    fail_msg("trial %d: leaf %ld %s by %g", trial, leaf,
                             k ? "is off in velocity" : "is off", off[k][d] - first[k][d]);
    }
}

/* A rigidly moving body goes on so when it is resampled, and so does one at rest. */
TEST(test_rigid)
{
    unsigned seed = 2;
    for (int trial = 0; trial < 24; trial++) {
        Body body;
        double c = cos(0.7), s = sin(0.7), turn = trial % 2 ? 0.0005 : 0;
        const Rigid rigid = {.R = {c, -s, 0, s, c, 0, 0, 0, 1},
                             .to = {3, 0, -7},
                             .turn = {0.3 * turn, -turn, turn},
                             .speed = {0, trial % 2 ? 0.01 : 0, 0}};
        block_body(&seed, false, (OctParams){.damping = 0.5, .threads = 1}, &body);
        put_rigid(&body, &rigid);
        for (int batch = 0; batch < 6; batch++) {
            split_some(&seed, &body.structure, 4);
            merge_some(&seed, &body.structure, 6);
            update(&body);
            check_rigid(&body, &rigid, false, trial);
        }
        oct_step(body.oct, NULL);
        check_rigid(&body, &rigid, true, trial);
        body_free(&body);
    }
}

typedef struct {
    double mass, place[3], momentum[3];
} Sums;

static Sums sums(const Body *body)
{
    Sums s = {0};
    double x[3], v[3];
    for (long leaf = 0; leaf < body->oct->leaves; leaf++) {
        if (!alive(body, leaf)) continue;
        double m = body->structure.mass[leaf];
        state_of(body, leaf, x, v);
        s.mass += m;
        for (int d = 0; d < 3; d++) {
            s.place[d] += m * x[d];
            s.momentum[d] += m * v[d];
        }
    }
    return s;
}

/* Momentum and centre of mass stay whatever the body does. */
TEST(test_momentum)
{
    unsigned seed = 3;
    for (int trial = 0; trial < 24; trial++) {
        Body body;
        body_random(&seed, trial, 10, OCT_MATERIAL, random_params(trial), &body);
        for (int batch = 0; batch < 8; batch++) {
            shake(&seed, &body, 0.3, 0.1);
            oct_step(body.oct, NULL);
            Sums before = sums(&body);
            random_batch(&seed, &body.structure, 5);
            update(&body);
            Sums after = sums(&body);
            near(after.mass, before.mass, before.mass, "mass", trial, -1);
            for (int d = 0; d < 3; d++) {
                double limit = 1e-12 * before.mass;
                if (!(fabs(after.place[d] - before.place[d]) < 30 * limit &&
                      fabs(after.momentum[d] - before.momentum[d]) < limit))
                    fail_msg("trial %d: centre of mass moved by %g, momentum changed by %g", trial,
                             (after.place[d] - before.place[d]) / before.mass,
                             (after.momentum[d] - before.momentum[d]) / before.mass);
            }
        }
        body_free(&body);
    }
}

/* Keeps the state of every leaf by its number. */
static double (*snapshot(const Body *body))[6]
{
    double(*kept)[6] = sm_alloc((size_t)body->oct->leaves, sizeof *kept);
    for (long leaf = 0; leaf < body->oct->leaves; leaf++)
        if (alive(body, leaf)) state_of(body, leaf, kept[leaf], kept[leaf] + 3);
    return kept;
}

/* By volume a body weighs less once cells that are not full are split: what the change does not
 * touch stays where it is, and is given no velocity for what is gone. */
TEST(test_volume)
{
    unsigned seed = 8;
    for (int trial = 0; trial < 24; trial++) {
        Body body;
        body_random(&seed, trial, 10, OCT_VOLUME, random_params(trial), &body);
        const OctStructure *s = &body.structure;
        for (int batch = 0; batch < 4; batch++) {
            shake(&seed, &body, 0.3, 0.1);
            double(*before)[6] = snapshot(&body), now[6];
            long leaves = body.oct->leaves;
            random_batch(&seed, &body.structure, 5);
            const OctChange *change = update(&body);
            char *touched = sm_alloc((size_t)s->tree.leaves, 1);
            for (long n = 0; n < change->added_count; n++) touched[change->added[n].leaf] = 1;
            for (long leaf = 0; leaf < leaves; leaf++) {
                if (!alive(&body, leaf) || touched[leaf]) continue;
                state_of(&body, leaf, now, now + 3);
                assert_memory_equal(now, before[leaf], sizeof now);
            }
            for (long leaf = 0; leaf < s->tree.leaves; leaf++) {
                double edge = alive(&body, leaf) ? 0.5 * s->tree.size[s->tree.node[leaf]] : 0;
                if (!body.painted) assert_true(fabs(s->mass[leaf] - edge * edge * edge) < 1e-9);
            }
            free(touched);
            free(before);
        }
        body_free(&body);
    }
}

/* Leaves that are split and merged again have the state that they had; all others always kept it.
 */
TEST(test_back)
{
    unsigned seed = 5;
    for (int trial = 0; trial < 24; trial++) {
        Body body;
        block_body(&seed, trial % 2, random_params(trial), &body);
        if (trial % 2)
            shake(&seed, &body, 0.2, 0.02);
        else
            put_rigid(&body, &(Rigid){.R = {0, -1, 0, 1, 0, 0, 0, 0, 1}, .turn = {0, 0.01, 0}});
        OctStructure *s = &body.structure;
        int node[8], count = 0;
        double(*before)[6] = snapshot(&body), x[6];
        long leaves = body.oct->leaves;
        for (int n = 0; n < 8; n++) {
            int picked = s->tree.node[random_int(&seed, (int)leaves)];
            if (s->tree.size[picked] <= 2 || s->tree.children[picked]) continue;
            assert_int_equal(oct_resample_split(s, picked, NULL), SM_OK);
            node[count++] = picked;
        }
        update(&body);
        for (int n = 0; n < count; n++)
            assert_int_equal(oct_resample_merge(s, node[n], NULL), SM_OK);
        const OctChange *change = update(&body);
        assert_int_equal(change->added_count, count);
        assert_int_equal(s->tree.live, leaves);
        OctStructure fresh;
        rebuild(s, NULL, &fresh); /* numbers as they were */
        for (long leaf = 0; leaf < body.oct->leaves; leaf++) {
            if (!alive(&body, leaf)) continue;
            long same = same_leaf(s, leaf, &fresh);
            state_of(&body, leaf, x, x + 3);
            for (int e = 0; e < 6; e++)
                if (!(fabs(x[e] - before[same][e]) < tolerance))
                    fail_msg("trial %d: leaf %ld was %g, is %g", trial, leaf, before[same][e],
                             x[e]);
        }
        oct_structure_free(&fresh);
        free(before);
        body_free(&body);
    }
}

static void merge_all(OctStructure *s)
{
    for (int level = s->tree.levels - 1; level >= 0; level--)
        for (int node = 0; node < s->tree.nodes; node++) {
            bool here = s->tree.size[node] && oct_tree_level(&s->tree, node) == level;
            if (here && s->tree.children[node])
                assert_int_equal(oct_resample_merge(s, node, NULL), SM_OK);
        }
}

static void split_all(OctStructure *s)
{
    for (int level = 0; level < s->tree.levels; level++) {
        long nodes = s->tree.nodes;
        for (int node = 0; node < nodes; node++) {
            bool here = s->tree.size[node] && oct_tree_level(&s->tree, node) == level;
            if (here && !s->tree.children[node])
                assert_int_equal(oct_resample_split(s, node, NULL), SM_OK);
        }
    }
}

/* All the way down and up: blocks without a leaf, one leaf alone, states that stay finite. */
TEST(test_extremes)
{
    unsigned seed = 6;
    for (int trial = 0; trial < 12; trial++) {
        Body body;
        body_random(&seed, trial, 9, OCT_MATERIAL, random_params(trial), &body);
        for (int turn = 0; turn < 4; turn++) {
            if (turn % 2)
                merge_all(&body.structure);
            else
                split_all(&body.structure);
            shake(&seed, &body, 0.5, 0.1);
            update(&body);
            check_rebuilt(&body, trial);
            for (int step = 0; step < 30; step++) {
                oct_step(body.oct, NULL);
                if (step % 10 == 0) oct_recentre(body.oct);
            }
            for (long slot = 0; slot < body.oct->blocks * SM_LANES; slot++)
                for (int d = 0; d < 3; d++) {
                    assert_true(fabs((double)body.oct->body->x[oct_index(slot, d)]) < 50);
                    assert_true(fabs((double)body.oct->body->v[oct_index(slot, d)]) < 5);
                }
        }
        body_free(&body);
    }
}

/* Any number of threads gives the same bits. */
TEST(test_threads)
{
    double(*kept)[6] = NULL;
    for (int threads = 1; threads <= 3; threads += 2) {
        unsigned seed = 7;
        SmVoxels voxels;
        OctTree tree;
        sm_voxels_block(&voxels, 20, 20, 20, 1);
        random_split_tree(&seed, &voxels, 2, (int[3]){0}, 1, &tree);
        OctOptions options = {.epsilon = 0.5, .width = {.edges = 1}};
        Body body = {.params = {.damping = 0.1, .threads = threads}};
        assert_int_equal(
            oct_structure_of_tree(&voxels, &options, NULL, &tree, NULL, &body.structure, NULL),
            SM_OK);
        OctStructure *s = &body.structure;
        body.oct = oct_build(&s->tree, &s->regions, s->mass, &body.params);
        assert_int_equal(body.oct->threads, threads);
        oct_resample_prepare(s);
        oct_prepare(body.oct, s);
        shake(&seed, &body, 0.3, 0.1);
        for (int batch = 0; batch < 3; batch++) {
            merge_some(&seed, s, 40);
            split_some(&seed, s, 20);
            update(&body);
            oct_step(body.oct, NULL);
        }
        double(*now)[6] = snapshot(&body);
        if (kept) assert_memory_equal(now, kept, (size_t)body.oct->leaves * sizeof *now);
        free(kept);
        kept = now;
        body_free(&body);
        sm_voxels_free(&voxels);
    }
    free(kept);
}
