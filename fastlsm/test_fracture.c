/* Breaking links beside the brute-force regions and beside a rebuild, in both precisions
 * (SM_REAL_BITS). */
#include "build.h"
#include "fracture.h"
#include "step.h"
#include "sums/blocks.h"
#include "test_body.h"

enum { TRIALS = 600, LONG = -1 };

/* Goals, in cells: what the engine promises in single precision; rounding of sums in double. */
static const double limit = SM_REAL_BITS == 32 ? 5e-5 : 1e-11;

static Lsm *breakable(const Body *body, int w, SmLayout layout, double damping)
{
    const SmEngineParams params = {.w = w,
                                   .h = 0.01,
                                   .damping = damping,
                                   .strain_limit = 1e9,
                                   .layout = layout,
                                   .mass = body->m,
                                   .threads = 1};
    return lsm_build(&body->voxels, &params);
}

static size_t index_of(const Lsm *lsm, long p, int d)
{
    long slot = lsm->slot[p];
    return (size_t)((slot / SM_LANES * 3 + d) * SM_LANES + slot % SM_LANES);
}

/* Bodies are as large as one cell of 1 at the origin: positions in cells and in mesh units agree.
 */
static void set_state(Lsm *lsm, const Body *body)
{
    for (long p = 0; p < body->n; p++)
        for (int d = 0; d < 3; d++) {
            lsm->x[index_of(lsm, p, d)] = (real)body->x[p][d];
            lsm->v[index_of(lsm, p, d)] = 0;
        }
}

static void get_goals(Lsm *lsm, const Body *body, double (*g)[3])
{
    lsm_goals(lsm);
    for (long p = 0; p < body->n; p++)
        for (int d = 0; d < 3; d++) g[p][d] = (double)lsm->g[index_of(lsm, p, d)];
}

/* A random shape, its cells of size 1, bent but nowhere inside out. */
static void make_body(unsigned *seed, int kind, int most, Body *body)
{
    if (kind == LONG)
        random_block(seed, (const int[3]){70, 3, 3}, 1, 1, &body->voxels);
    else
        random_body(seed, kind, most, &body->voxels);
    body->voxels.cell = 1;
    for (int d = 0; d < 3; d++) body->voxels.origin[d] = -0.5 * body->voxels.size[d];
    body_arrays(body);
    for (long p = 0; p < body->n; p++) body->m[p] = 0.5 + random_unit(seed);
    random_deformation(seed, 1, 0.05, body->n, (const double(*)[3])body->x0, body->x);
    for (long p = 0; p < body->n; p++) /* as stored */
        for (int d = 0; d < 3; d++) body->x[p][d] = (double)(real)body->x[p][d];
}

/* Links that have broken, as the engine and as the reference name them. */
typedef struct {
    LsmLink *link;
    int (*pair)[2];
    long count, room;
} Breaks;

static void breaks_free(Breaks *breaks)
{
    free(breaks->link);
    free(breaks->pair);
}

static void add_break(Breaks *breaks, const LsmLattice *l, long p, int bit)
{
    const int *c = l->coord[p];
    if (bit == LSM_SELF || !(l->link[p] >> bit & 1)) return;
    if (breaks->count == breaks->room) {
        breaks->room = 2 * breaks->room + 64;
        breaks->link = sm_realloc(breaks->link, (size_t)breaks->room, sizeof *breaks->link);
        breaks->pair = sm_realloc(breaks->pair, (size_t)breaks->room, sizeof *breaks->pair);
    }
    breaks->link[breaks->count] = (LsmLink){(int)p, bit};
    breaks->pair[breaks->count][0] = (int)p;
    breaks->pair[breaks->count++][1] =
        (int)lsm_lattice_find(l, c[0] + bit % 3 - 1, c[1] + bit / 3 % 3 - 1, c[2] + bit / 9 - 1);
}

/* A few links anywhere, all links of a particle, or a cut across the body. */
static void choose_breaks(unsigned *seed, const LsmLattice *l, Breaks *breaks)
{
    int way = random_int(seed, 4), n = 1 + random_int(seed, 8), axis = random_int(seed, 3);
    long middle = random_int(seed, (int)l->count);
    for (int i = 0; i < n && way < 2; i++)
        add_break(breaks, l, random_int(seed, (int)l->count), random_int(seed, LSM_RING));
    for (int bit = 0; bit < LSM_RING && way == 2; bit++) add_break(breaks, l, middle, bit);
    for (long p = 0; p < l->count && way == 3; p++)
        for (int bit = 0; bit < LSM_RING; bit++) {
            int step = axis == 0 ? bit % 3 : axis == 1 ? bit / 3 % 3 : bit / 9;
            if (l->coord[p][axis] == l->coord[middle][axis] && step == 2 && random_int(seed, 8))
                add_break(breaks, l, p, bit);
        }
}

/* Regions, their sizes and how many differ, beside the reference. */
static void assert_regions(Lsm *lsm, const RefRegions *regions)
{
    LsmRow rows[LSM_MAX_SIDE * LSM_MAX_SIDE];
    const LsmLattice *l = &lsm->lattice;
    for (long p = 0; p < l->count; p++) {
        long at = regions->start[p], count = regions->start[p + 1] - at;
        assert_int_equal(lsm_region_rows(l, &lsm->interior, p, rows), count);
        assert_int_equal(lsm->members[p], count);
        for (int row = 0; row < lsm->side * lsm->side; row++)
            for (LsmRow rest = rows[row]; rest; rest &= rest - 1) {
                const int *c = l->coord[p];
                long member = lsm_lattice_find(l, c[0] - lsm->w + lsm_row_first(rest),
                                               c[1] - lsm->w + row % lsm->side,
                                               c[2] - lsm->w + row / lsm->side);
                assert_int_equal(member, regions->member[at++]);
            }
    }
}

static void assert_close(const Body *body, double most, const char *beside, int trial)
{
    double worst = difference(body, (const double(*)[3])body->a, (const double(*)[3])body->b);
    if (!(worst <= most)) fail_msg("trial %d: %g cells beside %s", trial, worst, beside);
}

/* Last rotations survive, whatever empty lanes hold. */
static void assert_last(const Lsm *lsm, const short *last)
{
    for (long i = 0; i < lsm->tiles * 6 * SM_LANES; i++)
        if (lsm->tile_slot[i / (6 * SM_LANES) * SM_LANES + i % SM_LANES] >= 0)
            assert_int_equal(lsm->last[i], last[i]);
}

/* Breaks `breaks->link[first ...]` in `lsm` and, with a rebuild, in `twin`. */
static void break_both(Lsm *lsm, Lsm *twin, const Breaks *breaks, long first)
{
    size_t shorts = (size_t)lsm->tiles * 6 * SM_LANES;
    short *last = sm_alloc(shorts, sizeof *last);
    memcpy(last, lsm->last, shorts * sizeof *last);
    lsm_break(lsm, breaks->count - first, breaks->count ? &breaks->link[first] : NULL);
    assert_last(lsm, last);
    free(last);
    for (long i = first; i < breaks->count; i++)
        lsm_lattice_break(&twin->lattice, breaks->link[i].particle, breaks->link[i].bit);
    lsm_rebuild_regions(twin);
}

static void compare(Lsm *lsm, Lsm *twin, Body *body, const Breaks *breaks, int trial)
{
    RefRegions regions;
    ref_regions_build(&body->voxels, lsm->w, (const int(*)[2])breaks->pair, breaks->count,
                      &regions);
    assert_regions(lsm, &regions);
    if (trial % 3) {
        assert_int_equal(lsm_unique(lsm), ref_regions_unique(&regions));
        assert_int_equal(lsm_unique(lsm), lsm_unique(twin));
    }
    assert_int_equal(lsm_lattice_links(&lsm->lattice), lsm_lattice_links(&twin->lattice));
    set_state(lsm, body);
    set_state(twin, body);
    get_goals(lsm, body, body->a);
    ref_goals(&regions, (const double(*)[3])body->x0, body->m, (const double(*)[3])body->x,
              body->b);
    assert_close(body, limit, "the reference", trial);
    get_goals(twin, body, body->b);
    assert_close(body, limit, "a rebuild", trial);
    ref_regions_free(&regions);
}

/* A step from the same state, damped or not: its velocities. */
static void compare_steps(Lsm *lsm, Lsm *twin, const Body *body, int trial)
{
    lsm_step(lsm, NULL);
    lsm_step(twin, NULL);
    for (long p = 0; p < body->n; p++)
        for (int d = 0; d < 3; d++) {
            body->a[p][d] = (double)lsm->v[index_of(lsm, p, d)];
            body->b[p][d] = (double)twin->v[index_of(twin, p, d)];
        }
    /* loose particles in a row hardly resist turning: single precision's rounding spins them */
    bool spins = SM_REAL_BITS == 32 && lsm->params.damping > 0;
    assert_close(body, spins ? 1e-2 : limit, "a rebuild's step", trial);
}

TEST(test_equal_to_rebuild)
{
    unsigned seed = 5;
    int rebuilt = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        Body body;
        bool widest = trial > TRIALS - 3; /* in both layouts */
        int w = widest ? SM_MOST_W : 1 + trial % 4;
        SmLayout layout = (widest ? trial : trial / 4) % 2 ? SM_LAYOUT_BLOCKS : SM_LAYOUT_LISTS;
        make_body(&seed, widest ? LONG : trial / 8 % 6, trial % 32 < 4 ? 9 : 5, &body);
        Lsm *lsm = breakable(&body, w, layout, trial % 5 ? 0 : 0.3),
            *twin = breakable(&body, w, layout, trial % 5 ? 0 : 0.3);
        Breaks breaks = {0};
        for (int batch = 0; batch < 5; batch++) {
            long first = breaks.count;
            choose_breaks(&seed, &lsm->lattice, &breaks);
            break_both(lsm, twin, &breaks, first);
            compare(lsm, twin, &body, &breaks, trial);
            compare_steps(lsm, twin, &body, trial);
        }
        rebuilt += lsm->spare > twin->spare;
        breaks_free(&breaks);
        lsm_free(lsm);
        lsm_free(twin);
        body_free(&body);
    }
    if (rebuilt > TRIALS / 10) fail_msg("%d bodies of %d were rebuilt", rebuilt, TRIALS);
}

/* Planes and random triangles anywhere, through sites, along cells, the same again: the links that
 * the reference finds crossed, one by one, and the state that a rebuild has without them. */
static void random_cut(unsigned *seed, const Body *body, SmCut *cut)
{
    int axis = random_int(seed, 3), kind = random_int(seed, 3);
    double at = random_int(seed, 2 * body->voxels.size[axis]) / 2.0 + body->voxels.origin[axis];
    if (cut->vertices == 0 || random_int(seed, 5))
        for (int i = 0; i < 3; i++) {
            double place[3];
            for (int d = 0; d < 3; d++) {
                place[d] = body->voxels.origin[d] + 1.4 * random_unit(seed) * body->voxels.size[d];
                if (kind == 0) place[d] = rint(place[d]);
            }
            if (kind == 1) place[axis] = at;
            sm_cut_vertex(cut, place);
        }
    int last = (int)cut->vertices - 1;
    sm_cut_triangle(cut, (int[3]){last, last - 1, last - 2});
}

TEST(test_cut_breaks_what_it_crosses)
{
    unsigned seed = 9;
    long broken = 0;
    for (int trial = 0; trial < TRIALS / 3; trial++) {
        Body body;
        make_body(&seed, trial / 8 % 6, 5, &body);
        SmLayout layout = trial / 4 % 2 ? SM_LAYOUT_BLOCKS : SM_LAYOUT_LISTS;
        Lsm *lsm = breakable(&body, 1 + trial % 3, layout, 0),
            *twin = breakable(&body, 1 + trial % 3, layout, 0);
        const LsmLattice *l = &twin->lattice;
        Breaks breaks = {0};
        SmCut cut;
        sm_cut_init(&cut, 2);
        for (int batch = 0; batch < 4; batch++) {
            long first = cut.triangles, known = breaks.count;
            for (int n = random_int(&seed, 3); n >= 0; n--) random_cut(&seed, &body, &cut);
            for (long p = 0; p < l->count; p++)
                for (int bit = LSM_SELF + 1; bit < LSM_RING; bit++) {
                    double to[3];
                    for (int d = 0; d < 3; d++)
                        to[d] = body.x0[p][d] +
                                (d == 0   ? bit % 3
                                 : d == 1 ? bit / 3 % 3
                                          : bit / 9) -
                                1;
                    if (sm_cut_crosses(&cut, first, body.x0[p], to)) add_break(&breaks, l, p, bit);
                }
            assert_int_equal(lsm_cut(lsm, 0, &cut, first), breaks.count - known);
            for (long i = known; i < breaks.count; i++)
                lsm_lattice_break(&twin->lattice, breaks.link[i].particle, breaks.link[i].bit);
            lsm_rebuild_regions(twin);
            compare(lsm, twin, &body, &breaks, trial);
        }
        broken += breaks.count;
        sm_cut_free(&cut);
        breaks_free(&breaks);
        lsm_free(lsm);
        lsm_free(twin);
        body_free(&body);
    }
    assert_true(broken > 10 * TRIALS);
}

static void full_box(int cells, Body *body)
{
    memset(body, 0, sizeof *body);
    sm_voxels_block(&body->voxels, cells, cells, cells, 1);
    body_arrays(body);
}

/* One link at the centre of a cube, then one at its corner: the regions searched. */
static void work(int cells, int w, SmLayout layout, long searched[2])
{
    Body body;
    full_box(cells, &body);
    Lsm *lsm = breakable(&body, w, layout, 0);
    int middle = cells / 2, at[2][3] = {{middle, middle, middle}, {0, 0, 0}};
    for (int i = 0; i < 2; i++) {
        long p = lsm_lattice_find(&lsm->lattice, at[i][0], at[i][1], at[i][2]);
        long spare = lsm->spare;
        searched[i] = lsm_break(lsm, 1, &(LsmLink){(int)p, LSM_RING - 1});
        assert_int_equal(lsm->spare, spare); /* nothing was rebuilt */
    }
    lsm_free(lsm);
    body_free(&body);
}

TEST(test_local)
{
    for (int trial = 0; trial < 4; trial++) {
        long small[2], large[2];
        SmLayout layout = trial % 2 ? SM_LAYOUT_BLOCKS : SM_LAYOUT_LISTS;
        int w = 1 + trial / 2;
        work(9, w, layout, small);  /* 10^3 particles */
        work(45, w, layout, large); /* 46^3 */
        for (int i = 0; i < 2; i++) {
            assert_true(small[i] > 0 && small[i] < 500);
            assert_int_equal(small[i], large[i]);
        }
    }
}

/* A body that breaks link by link into single particles is seldom rebuilt. */
TEST(test_crumble)
{
    for (int trial = 0; trial < 4; trial++) {
        Body body;
        full_box(7, &body);
        Lsm *lsm =
            breakable(&body, 1 + trial / 2, trial % 2 ? SM_LAYOUT_BLOCKS : SM_LAYOUT_LISTS, 0);
        long spare = lsm->spare, links = lsm_lattice_links(&lsm->lattice);
        for (long p = 0; p < body.n; p++)
            for (int bit = LSM_SELF + 1; bit < LSM_RING; bit++)
                lsm_break(lsm, 1, &(LsmLink){(int)p, bit});
        assert_int_equal(lsm_lattice_links(&lsm->lattice), 0);
        assert_int_equal(lsm->broken, links);
        assert_int_equal(lsm_unique(lsm), body.n);
        if (lsm->spare > 32 * spare) fail_msg("rebuilt %ld times its room", lsm->spare / spare);
        memcpy(body.x, body.x0, (size_t)body.n * sizeof *body.x);
        for (long p = 0; p < body.n; p++) body.x[p][p % 3] += 0.1 * (double)(p % 7);
        for (long p = 0; p < body.n; p++)
            for (int d = 0; d < 3; d++) body.x[p][d] = (double)(real)body.x[p][d];
        set_state(lsm, &body);
        get_goals(lsm, &body, body.a); /* alone, a particle stays where it is */
        assert_true(difference(&body, (const double(*)[3])body.a, (const double(*)[3])body.x) <
                    limit);
        lsm_free(lsm);
        body_free(&body);
    }
}

/* After a cut two threads give the bits of one. */
TEST(test_threads)
{
    for (int layout = SM_LAYOUT_LISTS; layout <= SM_LAYOUT_BLOCKS; layout++) {
        Body body;
        Lsm *lsm[2];
        Breaks breaks = {0};
        full_box(19, &body);
        for (int i = 0; i < 2; i++) {
            lsm[i] = breakable(&body, 2, (SmLayout)layout, 0.2);
            lsm[i]->params.threads = i + 1;
            lsm_rebuild_regions(lsm[i]);
            assert_int_equal(lsm[i]->threads, i + 1);
        }
        for (long p = 0; p < body.n; p++)
            if (lsm[0]->lattice.coord[p][2] == 9)
                for (int bit = 18; bit < LSM_RING; bit++)
                    add_break(&breaks, &lsm[0]->lattice, p, bit);
        unsigned seed = 2;
        random_deformation(&seed, 1, 0.2, body.n, (const double(*)[3])body.x0, body.x);
        for (int i = 0; i < 2; i++) {
            lsm_break(lsm[i], breaks.count, breaks.link);
            set_state(lsm[i], &body);
            for (int step = 0; step < 3; step++) lsm_step(lsm[i], NULL);
        }
        assert_memory_equal(lsm[0]->x, lsm[1]->x,
                            (size_t)lsm[0]->blocks * 3 * SM_LANES * sizeof(real));
        breaks_free(&breaks);
        lsm_free(lsm[0]);
        lsm_free(lsm[1]);
        body_free(&body);
    }
}
