/* Fix-ups of box sums (box_sum_fixups.h): what a box sum takes with what its fix-ups take away
 * and add is the region found by brute force, on the way up and on the way down. In both precisions
 * (SM_REAL_BITS). */
#include "box_sum_fixups.h"

#include "../build.h"
#include "../test_body.h"
#include "blocks.h"

/* Which offsets (a, b, c) from a particle its sum takes: [side^3]. */
typedef struct {
    int w, side;
    unsigned char *takes;
} Window;

static unsigned char *taken_at(Window *window, const int offset[3])
{
    int w = window->w, side = window->side;
    for (int d = 0; d < 3; d++) assert_in_range(offset[d] + w, 0, side - 1);
    return window->takes + ((offset[2] + w) * side + offset[1] + w) * side + offset[0] + w;
}

static void take_box(Window *window, const uint64_t *rows)
{
    int side = window->side;
    for (int row = 0; row < side * side; row++)
        for (int i = 0; i < side; i++) window->takes[row * side + i] = rows[row] >> i & 1;
}

/* One fix-up of the particle in `slot`, if it is one of its lanes; `block` is its source. */
static bool fixup_one(const Lsm *lsm, const Fixup *c, long block, long slot, Window *window)
{
    int lane = (int)(slot % SM_PART), offset[3];
    if (!(c->lanes >> lane & 1)) return false;
    assert_in_range(lane + c->from, 0, SM_LANES - 1);
    int source = lsm->particle[block * SM_LANES + lane + c->from];
    assert_true(source >= 0);
    for (int d = 0; d < 3; d++) {
        offset[d] = lsm->lattice.coord[source][d] - lsm->lattice.coord[lsm->particle[slot]][d];
        assert_true(c->offset[d] == offset[d]);
    }
    unsigned char *taken = taken_at(window, offset);
    assert_true(c->sign == (*taken ? -1 : 1)); /* never twice */
    *taken = !*taken;
    return true;
}

/* Whose blocks the sources of `list` are: themselves, or the rows kept of them. */
static long source_of(const Lsm *lsm, const FixupList *list, const Fixup *c)
{
    if (list == &lsm->fixups->up) return c->source;
    long block = 0;
    while (block < lsm->blocks && lsm->fixups->row[block] != c->source) block++;
    assert_true(block < lsm->blocks);
    return block;
}

/* Returns how many fix-ups there were. */
static long check_particle(const Lsm *lsm, const FixupList *list, long p, const uint64_t *box,
                           const RefRegions *regions)
{
    long slot = lsm->slot[p], part = slot / SM_PART, count = 0, members = 0;
    size_t sites = (size_t)(lsm->side * lsm->side * lsm->side);
    Window window = {lsm->w, lsm->side, sm_alloc(sites, 1)};
    if (!(list->clear[slot / SM_LANES] >> slot % SM_LANES & 1)) take_box(&window, box);
    for (long i = list->first[part]; i < list->first[part + 1]; i++)
        count += fixup_one(lsm, &list->of[i], source_of(lsm, list, &list->of[i]), slot, &window);
    for (long i = regions->start[p]; i < regions->start[p + 1]; i++) {
        const int *to = lsm->lattice.coord[regions->member[i]], *at = lsm->lattice.coord[p];
        const int offset[3] = {to[0] - at[0], to[1] - at[1], to[2] - at[2]};
        assert_true(*taken_at(&window, offset));
    }
    for (size_t n = 0; n < sites; n++) members += window.takes[n];
    assert_int_equal(members, regions->start[p + 1] - regions->start[p]);
    free(window.takes);
    return count;
}

/* Box sums are not dropped where fix-ups are fewer than the members. */
static void check_cost(const Lsm *lsm, long p, long fixups, const RefRegions *regions)
{
    long members = regions->start[p + 1] - regions->start[p];
    if (fixups > members)
        fail_msg("particle %ld of %ld members has %ld fixups, w = %d", p, members, fixups, lsm->w);
}

static void check_body(const Body *body, int w, long *fixups, long *cleared)
{
    Lsm *lsm = lsm_build(
        &body->voxels,
        &(SmEngineParams){
            .w = w, .h = 0.01, .layout = SM_LAYOUT_BLOCKS, .mass = body->m, .threads = 1});
    RefRegions regions;
    uint64_t up[LSM_MAX_SIDE * LSM_MAX_SIDE], down[LSM_MAX_SIDE * LSM_MAX_SIDE];
    ref_regions_build(&body->voxels, w, NULL, 0, &regions);
    assert_non_null(lsm->fixups);
    for (long p = 0; p < body->n; p++) {
        lsm_blocks_taken(lsm, p, up, down);
        long count = check_particle(lsm, &lsm->fixups->up, p, up, &regions);
        check_cost(lsm, p, count, &regions);
        *fixups += count;
        count = check_particle(lsm, &lsm->fixups->down, p, down, &regions);
        check_cost(lsm, p, count, &regions);
        *fixups += count;
    }
    for (long b = 0; b < lsm->blocks; b++)
        *cleared += __builtin_popcount(lsm->fixups->up.clear[b]) +
                    __builtin_popcount(lsm->fixups->down.clear[b]);
    ref_regions_free(&regions);
    lsm_free(lsm);
}

TEST(corrected_box_sums_are_the_regions)
{
    long fixups = 0, cleared = 0;
    for (int trial = 0; trial < (TEST_FIGURES ? 60 : 12); trial++) {
        unsigned seed = 100 + (unsigned)trial;
        Body body;
        body_random(&seed, trial % 6, 14, &body);
        check_body(&body, 1 + trial % 5, &fixups, &cleared);
        body_free(&body);
    }
    assert_true(fixups > 1000 && cleared > 50); /* of both kinds */
}
