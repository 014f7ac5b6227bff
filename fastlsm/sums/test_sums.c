/* Every form of the sums (sums.h) beside what it is to sum, member by member over regions found by
 * brute force, in both precisions (SM_REAL_BITS). Values are small whole numbers, so every order of
 * summation gives the same bits. */
#include "sums.h"

#include "../build.h"
#include "../test_body.h"

/* What the pass that runs is given, by particles: x and v; (q, R) of match.h, or damping's two
 * triples; whose region is solved for, and how many particles have come to their end. */
static struct {
    RefRegions regions;
    double (*state)[6], (*down)[12];
    long solved, ended;
} given;

static double offset(const Lsm *lsm, long from, long to, int d)
{
    return lsm->lattice.coord[to][d] - lsm->lattice.coord[from][d];
}

/* What a member adds to the sums of region r. */
static void add_member(const Lsm *lsm, long r, long member, double sum[12])
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
static void add_region(const Lsm *lsm, long p, long r, double sum[6])
{
    const double *down = given.down[r];
    for (int i = 0; i < (lsm->pass->plain ? 6 : 3); i++) {
        sum[i] += down[i];
        for (int d = 0; d < 3 && !lsm->pass->plain; d++)
            sum[i] -= offset(lsm, p, r, d) * down[3 + 3 * i + d];
    }
}

static void compare(const Lsm *lsm, long p, const char *what, int values, const vec *sum, int lane,
                    const double *want)
{
    for (int i = 0; i < values; i++)
        if ((double)sum[i][lane] != want[i])
            fail_msg("%s, w %d, %ld particles, %s%s of %ld: value %d is %g, not %g",
                     lsm->sums->name, lsm->w, lsm->lattice.count, lsm->pass->plain ? "plain " : "",
                     what, p, i, (double)sum[i][lane], want[i]);
}

static void solve_lane(const Lsm *lsm, long tile, int lane, const vec sum[12], real *down)
{
    const RefRegions *regions = &given.regions;
    int slot = lsm->tile_slot[tile * SM_LANES + lane];
    double want[12] = {0};
    for (int f = 0; f < 12; f++) down[f * SM_LANES + lane] = 0;
    if (slot < 0) return;
    long p = lsm->particle[slot];
    for (long i = regions->start[p]; i < regions->start[p + 1]; i++)
        add_member(lsm, p, regions->member[i], want);
    compare(lsm, p, "region", 12, sum, lane, want);
    for (int f = 0; f < (lsm->pass->plain ? 6 : 12); f++)
        down[f * SM_LANES + lane] = (real)given.down[p][lsm->pass->plain ? f : stage_value(f)];
    given.solved++;
}

static void solve(Lsm *lsm, int layer, long tile, int tiles, vec (*sum)[12], real *down,
                  SmLaps *laps)
{
    (void)laps;
    assert_in_range(tiles, 1, TILE_GROUP);
    assert_in_range(tile, lsm->layer_tile[layer], lsm->layer_tile[layer + 1] - tiles);
    for (int t = 0; t < tiles; t++)
        for (int lane = 0; lane < SM_LANES; lane++)
            solve_lane(lsm, tile + t, lane, sum[t], down + t * TILE_DOWN);
}

static void end(Lsm *lsm, long block, int blocks, vec (*sum)[6], SmLaps *laps)
{
    (void)laps;
    const RefRegions *regions = &given.regions;
    for (long slot = block * SM_LANES; slot < (block + blocks) * SM_LANES; slot++) {
        long p = lsm->particle[slot];
        double want[6] = {0};
        if (p < 0) continue;
        for (long i = regions->start[p]; i < regions->start[p + 1]; i++)
            add_region(lsm, p, regions->member[i], want);
        compare(lsm, p, "particle", lsm->pass->plain ? 6 : 3, sum[slot / SM_LANES - block],
                (int)(slot % SM_LANES), want);
        given.ended++;
    }
}

static void set_state(Lsm *lsm, unsigned *seed)
{
    for (long p = 0; p < lsm->lattice.count; p++)
        for (int i = 0; i < 6; i++) {
            long at = (lsm->slot[p] / SM_LANES * 3 + i % 3) * SM_LANES + lsm->slot[p] % SM_LANES;
            given.state[p][i] = random_int(seed, 7) - 3;
            (i < 3 ? lsm->x : lsm->v)[at] = (real)given.state[p][i];
        }
    for (long i = 0; i < lsm->particle_records.count; i++) {
        ParticleConst *k = &lsm->particle_const[i];
        k->weight = lanes_select(k->inverse_count > 0, lanes_set(1), lanes_set(0));
    }
}

/* A region that equals another is not solved for: it turns, or moves, as that one does. */
static void set_down(const Lsm *lsm, unsigned *seed)
{
    for (long p = 0; p < lsm->lattice.count; p++)
        for (int i = 0; i < 12; i++) given.down[p][i] = random_int(seed, 7) - 3;
    for (long i = 0; i < lsm->copies; i++) {
        long p = lsm->particle[lsm->copy[i][0]], from = lsm->particle[lsm->copy[i][1]];
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
    given.state = sm_alloc((size_t)body->n, sizeof *given.state);
    given.down = sm_alloc((size_t)body->n, sizeof *given.down);
    set_state(lsm, seed);
    for (int i = 0; i < 2; i++) {
        given.solved = given.ended = 0;
        lsm->pass = &passes[i];
        set_down(lsm, seed);
        lsm_run(lsm, &passes[i], NULL);
        assert_int_equal(given.solved, body->n - lsm->copies);
        assert_int_equal(given.ended, body->n);
    }
    free(given.state);
    free(given.down);
    ref_regions_free(&given.regions);
    lsm_free(lsm);
}

/* Bodies of every kind, and one whose regions reach over several layers. */
static void check(SmEngineParams params, const LsmSums *form, int first_w)
{
    unsigned seed = 7;
    for (int trial = 0; trial < (TEST_FIGURES ? 18 : 6); trial++) {
        Body body;
        params.w = first_w + trial / 6;
        body_random(&seed, trial % 6, trial % 4 ? 8 : 14, &body);
        check_body(&body, params, form, &seed);
        body_free(&body);
    }
    Body body;
    params.w = first_w > 2 ? first_w : 2;
    random_block(&seed, (const int[3]){21, 19, 8}, 1, 0.95, &body.voxels);
    body_arrays(&body);
    check_body(&body, params, form, &seed);
    body_free(&body);
}

TEST(member_by_member)
{
    check((SmEngineParams){.summation = SM_SUM_NAIVE, .layout = SM_LAYOUT_LISTS}, &lsm_sums_naive,
          1);
}

TEST(through_bars_and_plates)
{
    check((SmEngineParams){.summation = SM_SUM_BARS, .layout = SM_LAYOUT_LISTS}, &lsm_sums_lists,
          1);
}

TEST(through_lists_that_can_change)
{
    check((SmEngineParams){.strain_limit = 2, .layout = SM_LAYOUT_LISTS}, &lsm_sums_lists, 3);
}

TEST(from_neighbours)
{
    check((SmEngineParams){.layout = SM_LAYOUT_LISTS}, &lsm_sums_running, 4);
}

TEST(over_boxes)
{
    check((SmEngineParams){.layout = SM_LAYOUT_BLOCKS}, &lsm_sums_boxes, 1);
    check((SmEngineParams){.layout = SM_LAYOUT_BLOCKS}, &lsm_sums_boxes, 5);
}

TEST(over_boxes_whose_regions_can_change)
{
    check((SmEngineParams){.strain_limit = 2, .layout = SM_LAYOUT_BLOCKS}, &lsm_sums_boxes, 1);
}
