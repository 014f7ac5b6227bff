/* The feet of many points at once, of each instruction set, beside those found one by one. */
#include "foot_search.h"

#include "../../../lib/test_frame.h"
#include "../../../lib/test_random.h"
#include "../../../lib/vector.h"
#include "foot.h"

enum { MOST = REF_SKIN_BLOCK, TRIALS = 300 };

/* Calls a test with each instruction set that there is, and ends with the one that was in use. */
static void with_each_set(void (*test)(unsigned *seed))
{
    const char *before = sm_isa_name(sm_isa());
    unsigned seed = 1;
    for (int isa = 0; isa < sm_isa_count(); isa++) {
        if (!sm_isa_there(isa)) continue;
        assert_int_equal(sm_isa_use(sm_isa_name(isa), NULL), SM_OK);
        for (int trial = 0; trial < TRIALS; trial++) test(&seed);
    }
    assert_int_equal(sm_isa_use(before, NULL), SM_OK);
}

static void random_vector(unsigned *seed, double most, double v[3])
{
    for (int d = 0; d < 3; d++) v[d] = random_between(seed, -most, most);
}

/* What is at a point: a bent surface, tangents and normal at any angles, and a place beside it. */
typedef struct {
    double place[3][3], normal[3][3], edge[2], x[3];
} Beside;

/* Tangents in a line, no tangent, no normal, a normal in the plane of tangents, or none of these.
 */
static void degenerate(unsigned *seed, Beside *at)
{
    int kind = random_int(seed, 12);
    for (int d = 0; d < 3; d++) {
        if (kind == 0) at->place[2][d] = -2 * at->place[1][d];
        if (kind == 1) at->place[1][d] = 0;
        if (kind == 2) at->normal[0][d] = 0;
        if (kind == 3) at->normal[0][d] = at->place[1][d] - at->place[2][d];
        for (int k = 1; k < 3 && kind < 4; k++) at->normal[k][d] = 0; /* and so it stays */
    }
}

/* Near, far, or at the very reach along a tangent. */
static void put_beside(unsigned *seed, Beside *at)
{
    static const double far[] = {0.02, 0.3, 1.5, 30};
    double o[3], most = far[random_int(seed, 4)];
    for (int k = 0; k < 2; k++) o[k] = random_between(seed, -most, most) * at->edge[k];
    o[2] = random_between(seed, -most, most) * at->edge[0];
    if (random_int(seed, 8) == 0) {
        o[0] = at->edge[0];
        o[1] = o[2] = 0;
    }
    for (int d = 0; d < 3; d++)
        at->x[d] = at->place[0][d] + o[0] * at->place[1][d] + o[1] * at->place[2][d] +
                   o[2] * (at->normal[0][d] + o[0] * at->normal[1][d] + o[1] * at->normal[2][d]);
}

static void random_beside(unsigned *seed, Beside *at)
{
    double bend = random_int(seed, 2) ? 0.3 : 3;
    random_vector(seed, 5, at->place[0]);
    for (int k = 1; k < 3; k++) random_vector(seed, 1, at->place[k]);
    for (int k = 0; k < 3; k++) random_vector(seed, k ? bend : 1, at->normal[k]);
    for (int d = 0; d < 2; d++) at->edge[d] = random_between(seed, 0.05, 0.5);
    degenerate(seed, at);
    put_beside(seed, at);
}

static void put(const Beside *at, int p, RefFootPoints *points)
{
    for (int d = 0; d < 3; d++) {
        points->x[d][p] = at->x[d];
        for (int k = 0; k < 3; k++) {
            points->place[k][d][p] = at->place[k][d];
            points->normal[k][d][p] = at->normal[k][d];
        }
    }
    for (int d = 0; d < 2; d++) points->edge[d][p] = at->edge[d];
}

static double height_of(const Beside *at)
{
    double square = sm_dot(at->place[1], at->place[1]) * sm_dot(at->place[2], at->place[2]);
    return 2 * sqrt(sqrt(square)) * fmax(at->edge[0], at->edge[1]);
}

/* No offset leads farther than twice as far as the point is. */
static bool are_near(const Beside *at, const double o[3])
{
    double off = sqrt(sm_square_between(at->x, at->place[0])), most = 0;
    for (int k = 0; k < 3; k++) {
        const double *side = k < 2 ? at->place[1 + k] : at->normal[0];
        most = fmax(most, fabs(o[k]) * sqrt(sm_dot(side, side)));
    }
    return most <= 2.001 * off + 1e-6 * height_of(at);
}

static void find_feet(unsigned *seed)
{
    static RefFootPoints points;
    static Beside beside[MOST];
    const int count = 1 + random_int(seed, MOST);
    for (int p = 0; p < count; p++) {
        random_beside(seed, beside + p);
        put(beside + p, p, &points);
    }
    ref_foot_search.find(count, &points);
    for (int p = 0; p < count; p++) {
        const Beside *at = beside + p;
        const double reach[3] = {at->edge[0], at->edge[1], height_of(at)};
        double o[3] = {0};
        bool varies = ref_foot_offsets((const double(*)[3])at->place,
                                       (const double(*)[3])at->normal, at->x, at->edge, o);
        for (int k = 0; k < 3; k++) {
            assert_true(fabs(points.offset[k][p] - o[k]) <= 1e-8 * reach[k]);
            assert_true(fabs(o[k]) <= 1.001 * reach[k] && (varies || o[k] == 0));
        }
        assert_true(are_near(at, o));
    }
}

/* Offsets to a point above a plane, which is so many cells along it. */
static void find_along(double cells, double o[3])
{
    const double place[3][3] = {{0}, {1, 0, 0}, {0, 1, 0}}, normal[3][3] = {{0, 0, 1}};
    const double edge[2] = {1, 1}, x[3] = {cells, 0, 0.5};
    assert_true(ref_foot_offsets(place, normal, x, edge, o));
    assert_true(o[1] == 0);
}

TEST(out_of_reach_points_go_over_to_their_normal)
{
    double inside[3], outside[3], far[3];
    find_along(0.999, inside);
    find_along(1.001, outside);
    find_along(1e4, far);
    assert_true(fabs(inside[0] - 0.999) < 1e-9 && fabs(inside[2] - 0.5) < 1e-9);
    for (int k = 0; k < 3; k++) assert_true(fabs(outside[k] - inside[k]) < 0.004);
    assert_true(fabs(far[0]) < 0.001 && fabs(far[2] - 0.5) < 0.001);
}

TEST(feet_are_those_found_one_by_one)
{
    with_each_set(find_feet);
}

/* Of places and normals whose slopes are what they change by, and of no points before. */
static void expand_sums(unsigned *seed)
{
    static RefFootPoints points;
    double sum[6][REF_FRAME_SLOPES];
    const int first = random_int(seed, MOST), count = 1 + random_int(seed, MOST - first);
    for (int m = 0; m < 6; m++)
        for (int f = 0; f < REF_FRAME_SLOPES; f++) sum[m][f] = random_between(seed, -1, 1);
    for (int p = 0; p < MOST; p++)
        for (int d = 0; d < 2; d++) points.from[d][p] = random_between(seed, -1, 1);
    if (first) points.place[2][1][first - 1] = 7;
    ref_foot_search.expand((const double(*)[REF_FRAME_SLOPES])sum, first, count, &points);
    assert_true(!first || points.place[2][1][first - 1] == 7);
    for (int p = first; p < first + count; p++) {
        const double x = points.from[0][p], y = points.from[1][p];
        const double times[3][6] = {
            {1, x, y, x * x / 2, y * y / 2, x * y}, {0, 1, 0, x, 0, y}, {0, 0, 1, 0, y, x}};
        for (int k = 0; k < 3; k++)
            for (int d = 0; d < 3; d++) {
                double place = points.place[k][d][p], normal = points.normal[k][d][p];
                for (int m = 0; m < 6; m++) {
                    place -= times[k][m] * sum[m][d];
                    normal -= times[k][m] * sum[m][3 + d];
                }
                assert_true(fabs(place) < 1e-14 && fabs(normal) < 1e-14);
            }
    }
}

TEST(sums_are_expanded)
{
    with_each_set(expand_sums);
}

/* Functions and their slopes at the sample's parameters, which go on straight to the foot. */
static void multiply_parts(unsigned *seed)
{
    static RefFootPoints points;
    static double times[6][REF_SKIN_ROOM];
    const int count = 1 + random_int(seed, MOST);
    for (int p = 0; p < count; p++)
        for (int d = 0; d < 2; d++) {
            points.from[d][p] = random_between(seed, -1, 1);
            points.offset[d][p] = random_between(seed, -1, 1);
        }
    ref_foot_search.series(count, &points, times);
    for (int p = 0; p < count; p++) {
        const double x = points.from[0][p], y = points.from[1][p];
        const double u = points.offset[0][p], v = points.offset[1][p];
        const double wanted[6] = {
            1, x + u, y + v, x * x / 2 + u * x, y * y / 2 + v * y, x * y + u * y + v * x};
        for (int m = 0; m < 6; m++) assert_true(fabs(times[m][p] - wanted[m]) < 1e-14);
    }
}

TEST(parts_are_multiplied_at_the_foot)
{
    with_each_set(multiply_parts);
}
