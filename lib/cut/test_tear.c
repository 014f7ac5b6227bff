/* Squares of links that have gone, in random bodies: between the particles that they joined, and
 * nowhere else. */
#include "tear.h"

#include "../test_frame.h"
#include "../test_random.h"
#include "../voxel/test_bodies.h"

enum { BODIES = 60 };

typedef struct {
    SmVoxels voxels;
    SmSites sites;
    long links;
    int (*link)[2];
} Body;

static void make_body(unsigned *seed, int kind, Body *body)
{
    random_body(seed, kind, 9, &body->voxels);
    body->voxels.cell = 0.3;
    body->voxels.origin[1] = 100;
    sm_sites_init(&body->voxels, &body->sites);
    body->link = sm_alloc(SM_RING * (size_t)body->voxels.particle_count, sizeof *body->link);
    body->links = 0;
    for (long p = 0; p < body->voxels.particle_count; p++) {
        int neighbour[SM_RING], count = sm_sites_ring(&body->sites, p, neighbour);
        for (int n = 0; n < count; n++)
            if (neighbour[n] > p) {
                body->link[body->links][0] = (int)p;
                body->link[body->links++][1] = neighbour[n];
            }
    }
}

static void free_body(Body *body)
{
    sm_sites_free(&body->sites);
    sm_voxels_free(&body->voxels);
    free(body->link);
}

static void place(const Body *body, int p, double at[3])
{
    for (int d = 0; d < 3; d++)
        at[d] = body->voxels.origin[d] + body->voxels.cell * body->sites.coordinate[p][d];
}

/* A share of the links that are left goes; returns how many along axes are among them. */
static long break_some(unsigned *seed, double share, Body *body, bool *gone)
{
    long straight = 0;
    for (long n = 0; n < body->links; n++) {
        const int *a = body->sites.coordinate[body->link[n][0]];
        const int *b = body->sites.coordinate[body->link[n][1]];
        if (gone[n] || random_unit(seed) >= share) continue;
        gone[n] = true;
        straight += abs(b[0] - a[0]) + abs(b[1] - a[1]) + abs(b[2] - a[2]) == 1;
    }
    return straight;
}

static void update(Body *body, const bool *gone, SmTear *tear, SmCut *cut)
{
    int(*left)[2] = sm_alloc((size_t)body->links, sizeof *left);
    long count = 0;
    for (long n = body->links - 1; n >= 0; n--) /* in any order */
        if (!gone[n]) memcpy(left[count++], body->link[n], sizeof *left);
    sm_tear_update(tear, count, (const int(*)[2])left, cut);
    free(left);
}

/* Of the links along axes those that have gone cross the cut, and no others. */
static void check_straight(const Body *body, const bool *gone, const SmCut *cut)
{
    for (long n = 0; n < body->links; n++) {
        double a[3], b[3];
        place(body, body->link[n][0], a);
        place(body, body->link[n][1], b);
        if (sm_square_between(a, b) > 1.1 * body->voxels.cell * body->voxels.cell) continue;
        assert_int_equal(sm_cut_crosses(cut, 0, a, b), gone[n]);
    }
}

TEST(what_has_gone_is_between_squares)
{
    unsigned seed = 7;
    for (int n = 0; n < BODIES; n++) {
        Body body;
        SmTear tear;
        SmCut cut;
        make_body(&seed, n % 6, &body);
        bool *gone = sm_alloc((size_t)body.links, sizeof *gone);
        sm_cut_init(&cut, 2 * body.voxels.cell);
        sm_tear_init(&body.sites, &tear);
        update(&body, gone, &tear, NULL);
        long straight = 0;
        for (int round = 0; round < 3; round++) {
            straight += break_some(&seed, n % 2 ? 0.1 : 0.6, &body, gone);
            update(&body, gone, &tear, &cut);
            assert_int_equal(cut.triangles, 2 * straight);
            check_straight(&body, gone, &cut);
        }
        update(&body, gone, &tear, &cut); /* nothing new */
        assert_int_equal(cut.triangles, 2 * straight);
        for (long v = 0; v < cut.vertices; v++) /* neighbours share them */
            for (long u = 0; u < v; u++)
                assert_true(sm_square_between(cut.vertex[u], cut.vertex[v]) > 1e-6);
        break_some(&seed, 0.3, &body, gone); /* by a blade */
        update(&body, gone, &tear, NULL);
        update(&body, gone, &tear, &cut);
        assert_int_equal(cut.triangles, 2 * straight);
        sm_tear_free(&tear);
        sm_cut_free(&cut);
        free(gone);
        free_body(&body);
    }
}

/* Where bodies fall into pieces at random, every way between linked particles of two, and from near
 * the one to near the other, goes through a square. */
TEST(squares_close_about_pieces)
{
    unsigned seed = 3;
    for (int n = 0; n < BODIES; n++) {
        Body body;
        SmTear tear;
        SmCut cut;
        make_body(&seed, n % 6, &body);
        long particles = body.voxels.particle_count;
        int *piece = sm_alloc((size_t)particles, sizeof *piece);
        bool *gone = sm_alloc((size_t)body.links, sizeof *gone);
        for (long p = 0; p < particles; p++) piece[p] = random_int(&seed, 3);
        for (long l = 0; l < body.links; l++)
            gone[l] = piece[body.link[l][0]] != piece[body.link[l][1]];
        sm_cut_init(&cut, 2 * body.voxels.cell);
        sm_tear_init(&body.sites, &tear);
        bool *none = sm_alloc((size_t)body.links, sizeof *none);
        update(&body, none, &tear, NULL);
        update(&body, gone, &tear, &cut);
        for (long l = 0; l < body.links; l++) {
            double a[3], b[3];
            place(&body, body.link[l][0], a);
            place(&body, body.link[l][1], b);
            for (int d = 0; d < 3; d++) {
                a[d] += 0.4 * body.voxels.cell * (random_unit(&seed) - 0.5);
                b[d] += 0.4 * body.voxels.cell * (random_unit(&seed) - 0.5);
            }
            if (gone[l]) assert_true(sm_cut_crosses(&cut, 0, a, b));
        }
        sm_tear_free(&tear);
        sm_cut_free(&cut);
        sm_free_all(gone, none, piece);
        free_body(&body);
    }
}
