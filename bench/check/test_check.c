/* The check of goals, damping and contacts: right engines stand it where rotations are not unique,
 * and wrong damping and contacts do not. */
#include <float.h>

#include "../../fastlsm/fastlsm.h"
#include "../../lib/test_frame.h"
#include "../../lib/test_random.h"
#include "../../reference/condition.h"
#include "../play/runner.h"
#include "contact_check.h"
#include "runner_check.h"
#include "step_check.h"

enum { LONG = 24, WIDE = 6 };

typedef struct {
    BenchScene scene;
    BenchBody body;
    const SmEngineType *type;
    SmEngine *engine;
    long count;
    double (*x)[3], (*v)[3];
} Plate;

static const SmEngineType *const types[] = {&fastlsm_engine_f32, &fastlsm_engine_f64,
                                            &octree_engine_f32, &octree_engine_f64};
enum { TYPES = sizeof types / sizeof *types };

/* A plate of one cell's thickness, whose cells are no mesh units. */
static void strip_create(const SmEngineType *type, int length, int wide, double damping,
                         bool collide, Plate *plate)
{
    SmVoxels voxels;
    SmCounts counts;
    *plate = (Plate){.type = type, .scene.params = {.w = 1, .h = 0.01, .damping = damping}};
    plate->scene.params.collide.self = collide;
    plate->scene.octree.sampling.levels = 1;
    plate->scene.octree.sampling.criteria_count = 1; /* uniform, to the finest cells */
    sm_voxels_block(&voxels, length, wide, 1, 0.3);
    voxels.origin[0] = 40;
    static double home[1][3][4] = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    plate->body = (BenchBody){.voxels = voxels, .instances = 1, .pose = home};
    SmEngineParams params = bench_engine_params(&plate->scene, &plate->body, 1);
    assert_int_equal(type->create(&voxels, &params, &plate->engine, NULL), SM_OK);
    type->count(plate->engine, &counts);
    plate->count = counts.particles;
    plate->x = sm_alloc((size_t)plate->count, sizeof *plate->x);
    plate->v = sm_alloc((size_t)plate->count, sizeof *plate->v);
    plate->body.x0 = sm_alloc((size_t)plate->count, sizeof *plate->x);
    type->get(plate->engine, SM_REST, plate->body.x0);
}

static void plate_create(const SmEngineType *type, double damping, bool collide, Plate *plate)
{
    strip_create(type, LONG, WIDE, damping, collide, plate);
}

static void plate_free(Plate *plate)
{
    plate->type->destroy(plate->engine);
    sm_voxels_free(&plate->body.voxels);
    free(plate->body.x0);
    free(plate->x);
    free(plate->v);
}

static void put(Plate *plate)
{
    plate->type->set(plate->engine, SM_POSITION, (const double(*)[3])plate->x);
    plate->type->set(plate->engine, SM_VELOCITY, (const double(*)[3])plate->v);
}

/* The plate turned by a right angle about y; if `fold`, first folded onto itself along the middle
 * and pressed flat; if `press`, onto a line. A step from there turns its regions. */
static void place(Plate *plate, bool fold, bool press)
{
    bool octree = !strcmp(plate->type->name, "octree"); /* whose nodes are in cells' middles */
    double middle = 40 + 0.3 * (LONG / 2 + (octree ? 0.5 : 0));
    unsigned seed = 3;
    for (long p = 0; p < plate->count; p++) {
        const double *x0 = plate->body.x0[p];
        double along = x0[0] - middle, up = x0[2];
        plate->x[p][0] = press || fold ? 0 : up;
        plate->x[p][1] = x0[1];
        plate->x[p][2] = press ? 0 : fold ? -fabs(along) : -along;
        for (int d = 0; d < 3; d++) plate->v[p][d] = random_unit(&seed);
    }
    put(plate);
    plate->type->step(plate->engine, NULL);
    put(plate);
}

static BenchDeviation check_plate(Plate *plate)
{
    BenchCheck check;
    bench_check_begin(&plate->scene, &plate->body, plate->type, plate->engine, &check);
    BenchDeviation found = bench_check_state(&check, plate->type, plate->engine);
    bench_check_damping(&check, &plate->scene, plate->type, plate->engine, &found);
    bench_check_contacts(&check, &plate->scene, plate->type, plate->engine, &found);
    bench_check_obstacles(&check, &plate->scene, plate->type, plate->engine, &found);
    bench_check_free(&check);
    return found;
}

static void expect_valid(Plate *plate, BenchDeviation *found)
{
    char reason[160];
    *found = check_plate(plate);
    if (!bench_check_verdict(found, sizeof reason, reason))
        fail_msg("%s, %s: %s", plate->type->name, plate->type->precision, reason);
}

/* Lets what the plate's engine does be replaced by what is wrong. */
static const SmEngineType *honest;

static SmEngineType *wrong_type(Plate *plate)
{
    static SmEngineType wrong;
    wrong = *(honest = plate->type);
    plate->type = &wrong;
    return &wrong;
}

static BenchDeviation expect_invalid(Plate *plate, const char *words)
{
    char reason[160];
    BenchDeviation found = check_plate(plate);
    assert_false(bench_check_verdict(&found, sizeof reason, reason));
    if (!strstr(reason, words))
        fail_msg("%s, %s: %s", plate->type->name, plate->type->precision, reason);
    return found;
}

/* Folded, the regions at the fold lie on lines, and only the engine knows how they were turned. */
TEST(ties_are_left_out)
{
    for (int t = 0; t < TYPES; t++) {
        Plate plate;
        BenchDeviation found;
        plate_create(types[t], 0, false, &plate);
        place(&plate, false, false);
        expect_valid(&plate, &found);
        assert_int_equal(found.tied, 0);
        place(&plate, true, false);
        expect_valid(&plate, &found);
        assert_int_equal(found.particles, plate.count);
        assert_true(found.tied >= WIDE && found.tied <= plate.count / 4);
        plate_free(&plate);
    }
}

/* Pressed onto a line all regions can be turned about it. While the engine turns them as brute
 * force does, all are checked; once it keeps other rotations from before, they are left out, and a
 * body of which too little is left to check is not valid. */
TEST(ties_that_differ_alone_are_left_out)
{
    for (int t = 0; t < TYPES; t++) {
        Plate plate;
        BenchDeviation found;
        plate_create(types[t], 0, false, &plate);
        place(&plate, false, true);
        expect_valid(&plate, &found);
        assert_int_equal(found.tied, 0);
        place(&plate, false, false);
        place(&plate, false, true);
        assert_true(check_plate(&plate).tied >= plate.count / 4);
        if (t < 2)
            expect_invalid(&plate, "not unique"); /* of the octree's just a quarter end elsewhere */
        plate_free(&plate);
    }
}

/* Damps less than it is told to, by this factor. */
static double damped_by;

static SmCode slack_create(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **engine,
                           SmError *error)
{
    SmEngineParams slack = *params;
    slack.damping *= damped_by;
    return honest->create(voxels, &slack, engine, error);
}

TEST(wrong_damping_is_invalid)
{
    for (int t = 0; t < TYPES; t++) {
        Plate plate;
        BenchDeviation found;
        char text[384];
        plate_create(types[t], 0.3, false, &plate);
        place(&plate, false, false);
        expect_valid(&plate, &found);
        assert_true(found.damping_tolerance > 0 && found.damping_tolerance < 1e-4);
        assert_int_equal(found.unresolved, 0);
        bench_check_text(&found, sizeof text, text);
        assert_non_null(strstr(text, ", damping within "));
        damped_by = 0.999;
        wrong_type(&plate)->create = slack_create;
        expect_invalid(&plate, "damped velocities are");
        plate_free(&plate);
    }
}

/* Rolls the plate up in a spiral so narrow that it lies within itself. */
static void roll(Plate *plate)
{
    unsigned seed = 5;
    for (long p = 0; p < plate->count; p++) {
        const double *x0 = plate->body.x0[p];
        double angle = 9 * (x0[0] - 40) / (0.3 * LONG), out = 1 + 0.02 * angle + x0[2];
        plate->x[p][0] = 40 + out * cos(angle);
        plate->x[p][1] = x0[1] + random_between(&seed, 0, 0.02);
        plate->x[p][2] = -out * sin(angle);
    }
    plate->type->set(plate->engine, SM_POSITION, (const double(*)[3])plate->x);
}

/* The rotations that a step begins from are those of the step before, whether or not goals were
 * asked for: contacts of the octree, and regions on a line, are as these are. */
TEST(goals_change_nothing_that_follows)
{
    for (int t = 0; t < TYPES; t++)
        for (int rolled = 0; rolled < 2; rolled++) {
            Plate plate[2];
            for (int p = 0; p < 2; p++) {
                plate_create(types[t], 0, rolled, &plate[p]);
                place(&plate[p], false, false);
                if (rolled)
                    roll(&plate[p]);
                else
                    place(&plate[p], false, true);
                for (int step = 0; step < 4; step++) {
                    if (p) types[t]->goals(plate[p].engine);
                    types[t]->step(plate[p].engine, NULL);
                }
                types[t]->get(plate[p].engine, SM_POSITION, plate[p].x);
            }
            size_t bytes = (size_t)plate[0].count * sizeof *plate[0].x;
            assert_memory_equal(plate[0].x, plate[1].x, bytes);
            for (int p = 0; p < 2; p++) plate_free(&plate[p]);
        }
}

TEST(contacts_are_brute_forces)
{
    for (int t = 0; t < TYPES; t++) {
        Plate plate;
        BenchDeviation found;
        char text[384];
        plate_create(types[t], 0, true, &plate);
        roll(&plate);
        expect_valid(&plate, &found);
        assert_int_equal(found.contact_nodes, plate.count); /* all are at the surface */
        assert_int_equal(found.contact_all, plate.count);
        assert_true(found.contacts > 30);
        assert_true(found.turn_error < BENCH_TURN_TOLERANCE / 2);
        bench_check_text(&found, sizeof text, text);
        assert_non_null(strstr(text, ", contacts of "));
        plate_free(&plate);
    }
}

/* A row of cells that was turned one way and then another: how its regions, all lines, are turned
 * about themselves is up to that. */
TEST(lines_are_turned_by_their_past)
{
    for (int t = 0; t < TYPES; t++) {
        Plate row;
        BenchDeviation found;
        strip_create(types[t], LONG, 1, 0, true, &row);
        place(&row, false, false);
        for (long p = 0; p < row.count; p++) {
            row.x[p][1] = row.body.x0[p][0];
            row.x[p][2] = 0;
        }
        row.type->set(row.engine, SM_POSITION, (const double(*)[3])row.x);
        row.type->goals(row.engine);
        expect_valid(&row, &found);
        assert_int_equal(found.tied, 0);
        plate_free(&row);
    }
}

/* Contacts of a place that is not where the particles are. */
static long stale_contacts(SmEngine *engine, double (*turn)[9], SmContact **contact)
{
    SmCounts counts;
    honest->count(engine, &counts);
    double(*x)[3] = sm_alloc((size_t)counts.particles, sizeof *x);
    honest->get(engine, SM_POSITION, x);
    for (long p = 0; p < counts.particles; p++) x[p][p % 3] += 0.01;
    honest->set(engine, SM_POSITION, (const double(*)[3])x);
    long count = honest->contacts(engine, turn, contact);
    for (long p = 0; p < counts.particles; p++) x[p][p % 3] -= 0.01;
    honest->set(engine, SM_POSITION, (const double(*)[3])x);
    free(x);
    return count;
}

/* An engine whose contacts are wrong, in the way of `fault`; a little less is right. */
static enum {
    LESS,
    STALE,
    LOST,
    DEEPER,
    ASIDE,
    LEANING,
    WEIGHED,
    OTHER_CELL,
    NO_CELL,
    MADE_UP,
    ALL_DEEPER,
    TURNED,
    FAULTS
} fault;

static long wrong_contacts(SmEngine *engine, double (*turn)[9], SmContact **contact)
{
    if (fault == STALE) return stale_contacts(engine, turn, contact);
    long count = honest->contacts(engine, turn, contact);
    SmContact *one = &(*contact)[count / 2];
    assert_true(count > 10);
    if (fault == LOST) *one = (*contact)[--count];
    const double tolerance = BENCH_CONTACT_TOLERANCE, cell = 0.3; /* rounding decides half of it */
    if (fault == LESS) one->depth += 0.9 * tolerance * cell, one->out[0] += 9 * tolerance;
    if (fault == DEEPER) one->depth += 2 * tolerance * cell;
    if (fault == LEANING) one->out[0] += 12 * tolerance;
    if (fault == ASIDE) {
        double out = one->out[0];
        one->out[0] = one->out[2];
        one->out[2] = -out;
    }
    if (fault == WEIGHED) one->weight[0] += 3 * tolerance;
    if (fault == OTHER_CELL) one->cell = (one->cell + 2 * WIDE) % (LONG * WIDE);
    if (fault == NO_CELL) one->cell = one->particle - one->particle % (WIDE + 1) + LONG;
    if (fault == MADE_UP) {
        *contact = sm_realloc(*contact, (size_t)count + 1, sizeof **contact);
        (*contact)[count] = (*contact)[0];
        (*contact)[count++].particle = LONG / 2;
    }
    if (fault == TURNED) turn[7][0] += 1e-3;
    for (long i = 0; i < count && fault == ALL_DEEPER; i++)
        (*contact)[i].depth += 2 * tolerance * cell;
    return count;
}

TEST(wrong_contacts_are_invalid)
{
    for (int t = 0; t < TYPES; t++) {
        Plate plate;
        BenchDeviation found;
        char reason[160];
        plate_create(types[t], 0, true, &plate);
        roll(&plate);
        wrong_type(&plate)->contacts = wrong_contacts;
        for (int f = 0; f < FAULTS; f++) {
            fault = f;
            if (fault == TURNED && !strcmp(types[t]->name, "fastlsm")) continue;
            found = check_plate(&plate);
            bool right = bench_check_verdict(&found, sizeof reason, reason);
            if (right != (fault == LESS))
                fail_msg("%s, %s: fault %d: %s", honest->name, honest->precision, f,
                         right ? "unseen" : reason);
            if (right) continue;
            if (!strstr(reason, "brute force")) fail_msg("fault %d: %s", f, reason);
            assert_true(fault == STALE ||
                        (found.turn_error > BENCH_TURN_TOLERANCE) == (fault == TURNED));
            assert_true(fault == TURNED || found.contacts_wrong > 0);
            assert_true(fault == ALL_DEEPER || fault == STALE || found.contacts_wrong <= 2);
        }
        plate_free(&plate);
    }
}

/* Where there are too many pairs of nodes and cells, nodes with contacts are still among those
 * that are compared. */
TEST(of_many_bodies_a_sample_is_compared)
{
    enum { MANY = 36 };
    static double home[MANY][3][4];
    Plate plate;
    BenchDeviation found;
    plate_create(&fastlsm_engine_f32, 0, false, &plate);
    plate.type->destroy(plate.engine);
    for (int i = 0; i < MANY; i++)
        for (int d = 0; d < 3; d++) {
            home[i][d][d] = 1;
            home[i][d][3] = d == 2 ? i / 2 * 2 + 0.1 * (i % 2) : 0.05 * (i % 2); /* in pairs */
        }
    plate.scene.params.collide.bodies = true;
    plate.body.pose = home;
    plate.body.instances = MANY;
    SmEngineParams params = bench_engine_params(&plate.scene, &plate.body, 1);
    assert_int_equal(plate.type->create(&plate.body.voxels, &params, &plate.engine, NULL), SM_OK);
    expect_valid(&plate, &found);
    assert_int_equal(found.contact_all, MANY * plate.count);
    assert_true(found.contact_nodes > 1000 && found.contact_nodes < found.contact_all);
    assert_true(found.contacts > 1000);
    wrong_type(&plate)->contacts = wrong_contacts;
    fault = ALL_DEEPER;
    found = check_plate(&plate);
    assert_int_equal(found.contacts_wrong, found.contacts);
    plate_free(&plate);
}

/* One of each kind in the way of the plate as place() turns it. */
static void add_obstacles(Plate *plate)
{
    const SmObstacle all[] = {
        {.kind = SM_PLANE, .a = {0, 0, -3}, .b = {0, 0, 1}, .friction = 0.3},
        {.kind = SM_SPHERE, .a = {0.2, 0.9, 1}, .radius = 0.7, .friction = 0.1},
        {.kind = SM_BOX, .a = {-0.1, -0.1, 2}, .b = {0.5, 1, 3}, .friction = 0.5},
        {.kind = SM_CAPSULE, .a = {-1, 0.4, -1.5}, .b = {1, 0.7, -1.4}, .radius = 0.35},
    };
    plate->scene.obstacle_count = sizeof all / sizeof *all;
    memcpy(plate->scene.obstacle, all, sizeof all);
}

/* Obstacles are not bound as they were given: one is a little nearer, or smoother. */
static bool smoother;

static void wrong_bound(SmEngine *engine, const SmBoundary *boundary)
{
    SmObstacle wrong[4];
    SmBoundary other = *boundary;
    memcpy(wrong, boundary->obstacle, (size_t)boundary->obstacle_count * sizeof *wrong);
    if (smoother)
        wrong[0].friction *= 0.9;
    else
        wrong[1].radius += 0.003; /* a hundredth of a cell */
    other.obstacle = wrong;
    honest->bound(engine, &other);
}

TEST(wrong_obstacles_are_invalid)
{
    for (int t = 0; t < TYPES; t++) {
        Plate plate;
        BenchDeviation found;
        char text[384];
        plate_create(types[t], 0.2, false, &plate);
        add_obstacles(&plate);
        place(&plate, false, false);
        expect_valid(&plate, &found);
        assert_true(found.obstacles && found.pushed > plate.count / 10);
        assert_true(found.pushed < plate.count);
        bench_check_text(&found, sizeof text, text);
        assert_non_null(strstr(text, " stopped by obstacles"));
        wrong_type(&plate)->bound = wrong_bound;
        for (int k = 0; k < 2; k++) {
            smoother = k;
            found = expect_invalid(&plate, "meet obstacles otherwise");
            assert_true(found.pushed_wrong > 0 && found.pushed_wrong < found.pushed);
        }
        plate_free(&plate);
    }
}

/* Of two findings the worse of each, and finite only if both are. */
TEST(findings_add_up)
{
    BenchDeviation good = {.finite = true, .goal_error = 1e-6, .contacts = 7, .contact_nodes = 90},
                   bad = {.goal_error = INFINITY, .tied = 3},
                   odd = {.finite = true, .goal_error = 1e-7, .contacts = 2, .contacts_wrong = 1};
    BenchDeviation worst = {.finite = true};
    bench_check_merge(&good, &worst);
    assert_true(worst.finite);
    bench_check_merge(&bad, &worst);
    assert_false(worst.finite);
    bench_check_merge(&odd, &worst); /* a later good one mends nothing */
    assert_false(worst.finite);
    assert_true(isinf(worst.goal_error));
    assert_int_equal(worst.tied, 3);
    assert_int_equal(worst.contacts, 9);
    assert_int_equal(worst.contacts_wrong, 1);
    assert_int_equal(worst.contact_nodes, 90);
}

/* Just below each bound, and just above it. */
TEST(drift_has_bounds)
{
    static const struct {
        const char *precision, *words;
        BenchDrift drift;
    } at[] = {{"single", "free steps", {.linear = 5e-9}},
              {"single", "free steps", {.angular = 5e-9}},
              {"single", "along the planes", {.held = 1e-9}},
              {"single", "all that it touches", {.touching = 1e-9}},
              {"single", "a particle that is held", {.hung = 1e-9}},
              {"double", "free steps", {.linear = 1e-14}},
              {"double", "free steps", {.angular = 1e-14}},
              {"double", "along the planes", {.held = 2e-15}},
              {"single", "free steps", {.linear = 1.5e-8, .apart = 3}}};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++)
        for (int above = 0; above < 2; above++) {
            char reason[160] = "";
            double factor = above ? 1.01 : 0.99;
            BenchDrift drift = at[i].drift;
            drift.linear *= factor;
            drift.angular *= factor;
            drift.held *= factor;
            drift.touching *= factor;
            drift.hung *= factor;
            assert_int_equal(bench_drift_verdict(&drift, at[i].precision, sizeof reason, reason),
                             !above);
            if (above && !strstr(reason, at[i].words)) fail_msg("%zu: '%s'", i, reason);
        }
}

TEST(what_was_left_out_is_said)
{
    char text[512];
    BenchDeviation found = {.finite = true,
                            .goal_error = 2e-6,
                            .goal_tolerance = 5e-5,
                            .momentum_error = 0.02,
                            .plain = true,
                            .particles = 100,
                            .tied = 12,
                            .tied_error = 0.3,
                            .unresolved = 15,
                            .unresolved_error = 3e-4};
    bench_check_text(&found, sizeof text, text);
    assert_string_equal(
        text, "goals within 2e-06 cells of brute force (allowed 5e-05), momentum of one step not "
              "kept by plain weighting, off by 0.02; 12 particles of regions whose "
              "rotation is not unique left out (within 0.3); 15 left out of damping, "
              "of whose regions rounding decides whether they turn (within 0.0003 cells "
              "a step)");
}

/* At a strip's ends a third of damping off, of the largest velocity, which is about 1. */
static void get_other_ends(SmEngine *engine, SmField field, double (*values)[3])
{
    SmCounts counts;
    honest->get(engine, field, values);
    honest->count(engine, &counts);
    for (long p = 0; p < 8 && field == SM_VELOCITY; p++) {
        values[p][2] += 0.1;
        values[counts.particles - 1 - p][2] += 0.1;
    }
}

/* Single precision does not know the inertia of a long strip's regions far from its middle, and
 * what an engine does there is known all the same: none is left out, and what is wrong is found. */
TEST(what_is_not_resolved_is_compared)
{
    for (int t = 0; t < TYPES; t++) {
        Plate strip;
        BenchDeviation found;
        strip_create(types[t], 220, 1, 0.3, false, &strip);
        for (long p = 0; p < strip.count; p++) {
            for (int d = 0; d < 3; d++) strip.x[p][d] = strip.body.x0[p][d] + (d == 0 ? 7 : 0);
            strip.v[p][0] = strip.v[p][2] = 0;
            strip.v[p][1] = sin(0.05 * (double)p);
        }
        put(&strip);
        expect_valid(&strip, &found);
        assert_int_equal(found.unresolved, 0);
        wrong_type(&strip)->get = get_other_ends;
        expect_invalid(&strip, "damped velocities are");
        plate_free(&strip);
    }
}

/* What decides a verdict, a little below its bound and a little above. */
TEST(every_bound_has_two_sides)
{
    static const char *const precisions[] = {"single", "double"};
    static const double goals[] = {5e-5, 1e-10}, steps[] = {1e-4, 1e-9};
    char reason[160];
    for (int i = 0; i < 2; i++) {
        assert_true(bench_check_tolerance(precisions[i]) == goals[i]);
        assert_true(bench_check_step(precisions[i]) == steps[i]);
    }
    assert_true(bench_check_keeps(0.99e-6, sizeof reason, reason));
    assert_false(bench_check_keeps(1.01e-6, sizeof reason, reason));
    for (int side = 0; side < 2; side++) {
        const BenchDeviation found = {
            .finite = true, .goal_tolerance = 1, .damping_tolerance = 1, .particles = 1000};
        BenchDeviation of[7];
        double by = side ? 1.01 : 0.99;
        for (int i = 0; i < 7; i++) of[i] = found;
        of[0].goal_error = by;
        of[1].damping_error = by;
        of[2].turn_error = 5e-4 * by;
        of[3].tied = 250 + side;
        of[4].parted_wrong = of[5].contacts_wrong = of[6].pushed_wrong = side;
        for (int i = 0; i < 7; i++)
            if (bench_check_verdict(&of[i], sizeof reason, reason) == side)
                fail_msg("%d: %s", i, side ? "above, and good" : reason);
    }
}

/* Moves the particles that are `fast` by eq. 2, but faster than eq. 1 has it. */
static const bool *fast;
static double faster_by;

static void step_faster(SmEngine *engine, SmLaps *laps)
{
    SmCounts counts;
    honest->step(engine, laps);
    honest->count(engine, &counts);
    double(*value)[3] = sm_alloc((size_t)counts.particles, sizeof *value);
    for (int i = 0; i < 2; i++) {
        honest->get(engine, i ? SM_VELOCITY : SM_POSITION, value);
        for (long p = 0; p < counts.particles; p++)
            value[p][1] += fast[p] ? (i ? 1 : 0.01) * faster_by : 0;
        honest->set(engine, i ? SM_VELOCITY : SM_POSITION, (const double(*)[3])value);
    }
    free(value);
}

/* As it should, but faster by that once in each look at what drifts, or in every step. */
static long steps_taken;
static bool every_step;

static void step_jolted(SmEngine *engine, SmLaps *laps)
{
    bool jolts = every_step || steps_taken == 0 || steps_taken == 1024;
    (jolts ? step_faster : honest->step)(engine, laps);
    steps_taken++;
}

/* 8e-6 cells a step are 8e-9 of each of 1,024 steps, and 1e-9 of each of 8,192. */
TEST(what_trembles_has_not_drifted)
{
    static bool all[LONG * WIDE * 4];
    for (int d = 0; d < 2; d++) {
        Plate plate;
        char reason[160];
        plate_create(&fastlsm_engine_f32, 0, false, &plate);
        place(&plate, false, false);
        wrong_type(&plate)->step = step_jolted;
        assert_in_range(plate.count, 1, sizeof all);
        memset(all, 1, sizeof all);
        fast = all;
        steps_taken = 0;
        every_step = d;
        faster_by = (d ? 8e-9 : 8e-6) * 0.3 / 0.01;
        BenchDrift found = bench_drift(&(BenchRunner){.scene = &plate.scene,
                                                      .body = &plate.body,
                                                      .type = plate.type,
                                                      .engine = plate.engine,
                                                      .particles = plate.count,
                                                      .count = plate.count});
        assert_int_equal(steps_taken, 1024 + 8192);
        assert_int_equal(found.steps, 8192);
        if (bench_drift_verdict(&found, "single", sizeof reason, reason) != !d)
            fail_msg("%g a step", found.linear);
        plate_free(&plate);
    }
}

/* What damping changes is checked elsewhere; undamped, velocities are eq. 1's. */
TEST(undamped_velocities_are_eq_1s)
{
    static const bool one[LONG * WIDE * 4] = {[5] = true};
    for (int t = 0; t < 2 * TYPES; t++) {
        Plate plate;
        bool damped = t % 2;
        plate_create(types[t / 2], damped ? 0.2 : 0, false, &plate);
        place(&plate, false, false);
        wrong_type(&plate)->step = step_faster;
        fast = one;
        double allowed = bench_check_tolerance(honest->precision);
        BenchRunner runner = {.scene = &plate.scene,
                              .body = &plate.body,
                              .type = plate.type,
                              .engine = plate.engine,
                              .particles = plate.count,
                              .count = plate.count};
        for (int more = 0; more < 2; more++) {
            char reason[160];
            double wanted = more && !damped ? 5 * allowed : 0;
            faster_by = more * 5 * allowed * 0.3 / 0.01; /* cells a step */
            assert_true(fabs(bench_check_motion(&runner) - wanted) < allowed);
            if (!damped)
                assert_int_equal(bench_check_runner(&runner, sizeof reason, reason), !more);
        }
        plate_free(&plate);
    }
}

/* Ties may be off by as much as damping moves them, and no more. */
TEST(ties_are_not_damped_by_more_than_all)
{
    for (int t = 0; t < 2 * TYPES; t++) {
        Plate plate;
        BenchCheck check;
        char reason[160];
        plate_create(types[t / 2], 0.3, false, &plate);
        place(&plate, true, false);
        bool *tied = sm_alloc((size_t)plate.count, sizeof *tied), more = t % 2;
        bench_check_begin(&plate.scene, &plate.body, plate.type, plate.engine, &check);
        bench_check_tied(&check, plate.type->precision, (const double(*)[3])plate.x, tied);
        bench_check_free(&check);
        wrong_type(&plate)->step = step_faster;
        fast = tied;
        faster_by = more ? 1e4 : 0.05;
        BenchDeviation found = check_plate(&plate);
        if (bench_check_verdict(&found, sizeof reason, reason) == more)
            fail_msg("%d: %s", t, reason);
        free(tied);
        plate_free(&plate);
    }
}

/* What a region's inertia is known to, between the shares of rounding where that changes. */
TEST(what_rounding_leaves_of_an_inertia)
{
    static const double origin[1][3] = {{0}};
    const RefSums sums = {origin, 1e-6, 0.1}; /* noise 8e-6 c^2 */
    const struct {
        double inertia; /* of what is unsure, 0.1 + noise */
        bool known;
    } sides[] = {{0.49, true}, {0.51, false}, {3.99, false}, {4.01, true}};
    RefCondition c = {.spread = 1};
    for (int i = 0; i < 4; i++) {
        c.inertia = 0.1 * sides[i].inertia;
        assert_int_equal(isfinite(bench_check_rounding(&c, &sums, 0)), sides[i].known);
    }
    c.inertia = 1;
    static const double share[] = {0.99 / 128, 1.01 / 128, 0.99 / 32, 1.01 / 32};
    for (int i = 0; i < 4; i++) { /* either side of a 64th, the engine counts it or not */
        c.centre[0] = sqrt(share[i] / 8e-6);
        double wanted = (i % 3 ? 2 : 1) * share[i] + 8e-6 + 4 * sqrt(1e-6 * share[i]);
        assert_true(fabs(bench_check_rounding(&c, &sums, 0) - wanted) < 1e-9);
    }
}

/* Twice what goals may be off, one way here and the other there, so that momentum is kept. */
static long pushed;

static void push_goals(SmEngine *engine, SmField what, double (*out)[3])
{
    honest->get(engine, what, out);
    if (what != SM_GOAL) return;
    out[pushed][1] += 2e-4 * 0.3;
    out[0][1] -= 2e-4 * 0.3;
}

TEST(a_sample_is_held_to_brute_force)
{
    for (int t = 0; t < 2; t++) {
        Plate plate;
        BenchCheck check;
        char text[512], reason[160];
        strip_create(types[t], 200, WIDE, 0.1, false, &plate);
        place(&plate, false, false);
        bench_check_sample(&plate.body, 1, &check);
        assert_true(check.samples >= 8 * BENCH_SAMPLE_RUN && check.samples < plate.count);
        BenchDeviation found = bench_check_find(&check, &(BenchRunner){.scene = &plate.scene,
                                                                       .body = &plate.body,
                                                                       .type = plate.type,
                                                                       .engine = plate.engine});
        assert_true(bench_check_verdict(&found, sizeof reason, reason));
        /* members come in another order, which rounds their sums otherwise in double precision */
        double all = check_plate(&plate).goal_error + 1e-12;
        assert_true(found.goal_error > 0 && found.goal_error <= all);
        bench_check_text(&found, sizeof text, text);
        assert_non_null(strstr(text, "goals of 1024 of 2814 particles (36%) compared"));
        wrong_type(&plate)->get = push_goals;
        pushed = check.sample[5];
        found = bench_check_state(&check, plate.type, plate.engine);
        assert_false(bench_check_verdict(&found, sizeof reason, reason));
        bench_check_free(&check);
        plate.type = honest;
        plate_free(&plate);
    }
}

TEST(momentum_is_relative_to_the_spread)
{
    const double x[2][3] = {{-1}, {3}}, g[2][3] = {{-1}, {3 + 4e-6}}, m[] = {3, 1};
    assert_true(fabs(bench_check_momentum(x, g, m, 2) - 4e-6 / 6) < 1e-12);
}

/* Regions whose hold is below what is known by their precision are tied, or below an eighth. */
TEST(a_hold_decides_what_is_tied)
{
    for (int wide = 0; wide < 2; wide++) { /* 24 cells: a hundredth; 400: an eighth */
        Plate strip;
        BenchCheck check;
        long near = 0;
        strip_create(&fastlsm_engine_f32, wide ? 400 : 24, 1, 0, false, &strip);
        bench_check_begin(&strip.scene, &strip.body, strip.type, strip.engine, &check);
        for (long p = 0; p < strip.count; p++) {
            double along = strip.body.x0[p][0] - 40, flat = along / (0.3 * (wide ? 400 : 24));
            strip.x[p][0] = along;
            strip.x[p][1] = 0.3 * flat * strip.body.x0[p][1];
            strip.x[p][2] = 0.3 * flat * strip.body.x0[p][2];
        }
        double(*at)[3] = sm_alloc((size_t)check.count, sizeof *at);
        bool *tied = sm_alloc((size_t)check.count, sizeof *tied);
        bool *wanted = sm_alloc((size_t)check.count, sizeof *wanted);
        bench_check_cells(&check, (const double(*)[3])strip.x, at);
        double least = fmin(0.125, FLT_EPSILON * (wide ? 200 : 12) / 2 / 5e-5);
        for (long r = 0; r < check.count; r++) {
            RefCondition found;
            ref_condition(&check.regions, check.weight, (const double(*)[3])check.rest,
                          (const double(*)[3])at, r, 5e-5, &found);
            near += found.hold >= least && found.hold < 0.24;
            RefMembers held = ref_members(&check.regions, r);
            for (long n = 0; n < held.count && found.hold < least; n++)
                wanted[held.member[n]] = true;
        }
        assert_true(near > 0);
        bench_check_tied(&check, "single", (const double(*)[3])strip.x, tied);
        assert_memory_equal(tied, wanted, (size_t)check.count * sizeof *tied);
        sm_free_all(at, tied, wanted);
        bench_check_free(&check);
        plate_free(&strip);
    }
}

/* Never moves. */
static void get_still(SmEngine *engine, SmField field, double (*values)[3])
{
    SmCounts counts;
    honest->get(engine, field, values);
    honest->count(engine, &counts);
    if (field == SM_VELOCITY) memset(values, 0, (size_t)counts.particles * sizeof *values);
}

/* Held at rest is what does not move and is not pulled: neither alone is. */
TEST(a_body_at_rest_neither_moves_nor_is_pulled)
{
    for (int t = 0; t < 2 * TYPES; t++) {
        Plate plate;
        bool moves = t % 2;
        unsigned seed = 6;
        plate_create(types[t / 2], 0.3, false, &plate);
        for (long p = 0; p < plate.count; p++)
            for (int d = 0; d < 3; d++) {
                double off = random_unit(&seed) - 0.5;
                plate.x[p][d] = plate.body.x0[p][d] + (moves ? 0 : 0.03 * off);
                plate.v[p][d] =
                    moves ? 1000 * bench_check_tolerance(types[t / 2]->precision) * off / 50 : 0;
            }
        put(&plate);
        damped_by = 0.5;
        if (moves)
            wrong_type(&plate)->create = slack_create;
        else
            wrong_type(&plate)->get = get_still;
        expect_invalid(&plate, "damped velocities are");
        plate_free(&plate);
    }
}
