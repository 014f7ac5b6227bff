/* Every form of the sums (sums.h) beside what it is to sum, member by member over regions found by
 * brute force, in both precisions (SM_REAL_BITS). Values are small whole numbers, so every order of
 * summation gives the same bits. */
#include "sums.h"

#include "../build.h"
#include "../test_body.h"

/* What the pass that runs is given, by particles: x and v; (q, R) of match.h, or damping's two
 * triples; how many regions have been solved for, and how many particles have come to their end.
 * Particle p of body k is number k * n + p. */
static struct {
    RefRegions regions;
    double (*state)[6], (*down)[12];
    long solved, ended;
} given;

static double offset(const Lsm *lsm, long from, long to, int d)
{
    long n = lsm->lattice.count;
    return lsm->lattice.coord[to % n][d] - lsm->lattice.coord[from % n][d];
}

/* What a member adds to the sums of region r. */
static void add_member(const Lsm *lsm, long r, long member, double *sum)
{
    const double *x = given.state[member], *v = x + 3;
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        const double product[4] = {v[d], x[e] * v[f] - x[f] * v[e], x[d] * x[d], x[e] * x[f]};
        for (int k = 0; k < 4 && lsm->pass->plain; k++) sum[3 * k + d] += product[k];
        if (lsm->pass->plain) continue;
        sum[d] += x[d];
        for (int axis = 0; axis < 3; axis++)
            sum[3 + 3 * d + axis] += offset(lsm, r, member, axis) * x[d];
    }
}

/* What region r brings down to a particle. */
static void add_region(const Lsm *lsm, long p, long r, double *sum)
{
    const double *down = given.down[r];
    for (int i = 0; i < (lsm->pass->plain ? 6 : 3); i++) {
        sum[i] += down[i];
        for (int d = 0; d < 3 && !lsm->pass->plain; d++)
            sum[i] -= offset(lsm, p, r, d) * down[3 + 3 * i + d];
    }
}

/* A lane's sums are what its particle's members, or regions, add up to. */
static void compare(const Lsm *lsm, long number, void (*add)(const Lsm *, long, long, double *),
                    int values, const vec *sum, int lane)
{
    double want[12] = {0};
    long p = number % lsm->lattice.count;
    for (long i = given.regions.start[p]; i < given.regions.start[p + 1]; i++)
        add(lsm, number, number - p + given.regions.member[i], want);
    for (int i = 0; i < values; i++)
        if ((double)sum[i][lane] != want[i])
            fail_msg("%s, w %d, %ld particles, %s%s of %ld: value %d is %g, not %g",
                     lsm->sums->name, lsm->w, lsm->lattice.count, lsm->pass->plain ? "plain " : "",
                     add == add_member ? "region" : "particle", number, i, (double)sum[i][lane],
                     want[i]);
}

/* The number of a lane's body's particle, or -1 where there is no such body. */
static long instance_at(const Lsm *lsm, long layer, int lane, long p)
{
    long body = layer * SM_LANES + lane;
    return body < lsm->bodies ? body * lsm->lattice.count + p : -1;
}

static long region_at(const Lsm *lsm, int layer, long tile, int lane)
{
    if (lsm->bodies > 1)
        return instance_at(lsm, layer, lane, lsm->tile_slot[tile - lsm->layer_tile[layer]]);
    int slot = lsm->tile_slot[tile * SM_LANES + lane];
    return slot < 0 ? -1 : lsm->particle[slot];
}

static void solve_lane(const Lsm *lsm, long r, int lane, const vec sum[12], real *down)
{
    for (int f = 0; f < 12; f++) down[f * SM_LANES + lane] = 0;
    if (r < 0) return;
    compare(lsm, r, add_member, 12, sum, lane);
    for (int f = 0; f < (lsm->pass->plain ? 6 : 12); f++)
        down[f * SM_LANES + lane] = (real)given.down[r][lsm->pass->plain ? f : stage_value(f)];
    given.solved++;
}

static void solve(Lsm *lsm, int layer, long tile, int tiles, vec (*sum)[12], real *down,
                  SmLaps *laps)
{
    (void)laps;
    assert_in_range(tiles, 1, POLAR_TILES);
    assert_in_range(tile, lsm->layer_tile[layer], lsm->layer_tile[layer + 1] - tiles);
    for (int t = 0; t < tiles; t++)
        for (int lane = 0; lane < SM_LANES; lane++)
            solve_lane(lsm, region_at(lsm, layer, tile + t, lane), lane, sum[t],
                       down + t * TILE_DOWN);
}

static void end(Lsm *lsm, long block, int blocks, vec (*sum)[6], SmLaps *laps)
{
    (void)laps;
    long n = lsm->lattice.count;
    for (int k = 0; k < blocks; k++, block++)
        for (int lane = 0; lane < SM_LANES; lane++) {
            long number = lsm->bodies > 1 ? instance_at(lsm, block / n, lane, block % n)
                                          : lsm->particle[block * SM_LANES + lane];
            if (number < 0) continue;
            compare(lsm, number, add_region, lsm->pass->plain ? 6 : 3, sum[k], lane);
            given.ended++;
        }
}

static void set_state(Lsm *lsm, unsigned *seed)
{
    long n = lsm->lattice.count;
    for (long number = 0; number < lsm->bodies * n; number++)
        for (int i = 0; i < 6; i++) {
            long at = place_of(lsm, number / n, number % n) + i % 3 * SM_LANES;
            given.state[number][i] = random_int(seed, 7) - 3;
            (i < 3 ? lsm->x : lsm->v)[at] = (real)given.state[number][i];
        }
    for (long i = 0; i < lsm->particle_records.count; i++) {
        ParticleConst *k = &lsm->particle_const[i];
        k->weight = lanes_select(k->inverse_count > 0, lanes_set(1), lanes_set(0));
    }
}

/* A region that equals another is not solved for: it turns, or moves, as that one does. */
static void set_down(const Lsm *lsm, unsigned *seed)
{
    long n = lsm->lattice.count;
    for (long number = 0; number < lsm->bodies * n; number++)
        for (int i = 0; i < 12; i++) given.down[number][i] = random_int(seed, 7) - 3;
    for (long i = 0; i < lsm->copies * lsm->bodies; i++) {
        const int *copy = lsm->copy[i % lsm->copies];
        long first = i / lsm->copies * n;
        long p = first + (lsm->particle ? lsm->particle[copy[0]] : copy[0]);
        long from = first + (lsm->particle ? lsm->particle[copy[1]] : copy[1]);
        memcpy(given.down[p], given.down[from], sizeof *given.down);
        for (int k = 0; k < 9 && !lsm->pass->plain; k++)
            given.down[p][k / 3] += offset(lsm, from, p, k % 3) * given.down[p][3 + k];
    }
}

static void check_body(const Body *body, SmEngineParams params, const LsmSums *form, unsigned *seed)
{
    static const LsmPass passes[] = {{.solve = solve, .end = end},
                                     {.plain = true, .solve = solve, .end = end}};
    params.h = 0.01;
    params.threads = 1;
    Lsm *lsm = lsm_build(&body->voxels, &params);
    assert_ptr_equal(lsm->sums, form);
    ref_regions_build(&body->voxels, params.w, NULL, 0, &given.regions);
    given.state = sm_alloc((size_t)(lsm->bodies * body->n), sizeof *given.state);
    given.down = sm_alloc((size_t)(lsm->bodies * body->n), sizeof *given.down);
    set_state(lsm, seed);
    for (int i = 0; i < 2; i++) {
        given.solved = given.ended = 0;
        lsm->pass = &passes[i];
        set_down(lsm, seed);
        lsm_run(lsm, &passes[i], NULL);
        assert_int_equal(given.solved, lsm->bodies * (body->n - lsm->copies));
        assert_int_equal(given.ended, lsm->bodies * body->n);
    }
    free(given.state);
    free(given.down);
    ref_regions_free(&given.regions);
    lsm_free(lsm);
}

/* Bodies of every kind. */
static void check(SmEngineParams params, const LsmSums *form, int first_w, int most)
{
    unsigned seed = 7;
    for (int trial = 0; trial < (TEST_FIGURES ? 18 : 6); trial++) {
        Body body;
        params.w = first_w + trial / 6;
        body_random(&seed, trial % 6, trial % 4 ? most / 2 : most, &body);
        check_body(&body, params, form, &seed);
        body_free(&body);
    }
}

/* The same, and one whose regions reach over several layers. */
static void check_block(SmEngineParams params, const LsmSums *form, const int size[3], double fill)
{
    unsigned seed = 8;
    Body body;
    random_block(&seed, size, 1, fill, &body.voxels);
    body_arrays(&body);
    check_body(&body, params, form, &seed);
    body_free(&body);
}

static void check_layers(SmEngineParams params, const LsmSums *form, int first_w)
{
    check(params, form, first_w, 14);
    params.w = first_w > 2 ? first_w : 2;
    check_block(params, form, (const int[3]){22, 20, 8}, 0.95); /* layers of one plane */
}

TEST(member_by_member)
{
    check_layers((SmEngineParams){.summation = SM_SUM_NAIVE, .layout = SM_LAYOUT_LISTS},
                 &lsm_sums_naive, 1);
}

TEST(through_bars_and_plates)
{
    check_layers((SmEngineParams){.summation = SM_SUM_BARS, .layout = SM_LAYOUT_LISTS},
                 &lsm_sums_lists, 1);
}

TEST(through_lists_that_can_change)
{
    check_layers((SmEngineParams){.strain_limit = 2, .layout = SM_LAYOUT_LISTS}, &lsm_sums_lists,
                 3);
}

TEST(from_neighbours)
{
    SmEngineParams params = {.w = 4, .layout = SM_LAYOUT_LISTS};
    check_layers(params, &lsm_sums_running, 3);
    check_block(params, &lsm_sums_running, (const int[3]){7, 9, 60}, 0.9); /* plates take turns */
}

/* A heavy particle that leaves a sum leaves its rounding: masses are at most 16 times as large as
 * others. */
TEST(masses_are_alike_where_sums_run)
{
    Body body;
    sm_voxels_block(&body.voxels, 12, 12, 12, 1);
    body_arrays(&body);
    for (int far = 0; far < 2; far++) {
        for (long p = 0; p < body.n; p++) body.m[p] = p == 7 ? 15.9 + 0.2 * far : 1;
        const SmEngineParams params = {
            .w = 5, .h = 0.01, .layout = SM_LAYOUT_LISTS, .mass = body.m, .threads = 1};
        Lsm *lsm = lsm_build(&body.voxels, &params);
        assert_ptr_equal(lsm->sums, far ? &lsm_sums_lists : &lsm_sums_running);
        lsm_free(lsm);
    }
    body_free(&body);
}

TEST(over_boxes)
{
    check_layers((SmEngineParams){.layout = SM_LAYOUT_BLOCKS}, &lsm_sums_boxes, 1);
    check_layers((SmEngineParams){.layout = SM_LAYOUT_BLOCKS}, &lsm_sums_boxes, 5);
    for (int w = 3; w <= 5; w += 2) /* more rows than windows move on over */
        check_block((SmEngineParams){.w = w, .layout = SM_LAYOUT_BLOCKS}, &lsm_sums_boxes,
                    (const int[3]){47, 41, 5}, 0.999);
}

TEST(over_boxes_whose_regions_can_change)
{
    check_layers((SmEngineParams){.strain_limit = 2, .layout = SM_LAYOUT_BLOCKS}, &lsm_sums_boxes,
                 1);
}

TEST(of_many_bodies)
{
    check((SmEngineParams){.instances = SM_LANES + 2, .layout = SM_LAYOUT_LISTS},
          &lsm_sums_instances, 1, 8);
}
