/* Cracks of a plane of cylinders that are joined: ways across joints, around zeros and to rims. */
#include "../body/mls.h"
#include "../body/test_trousers.h"
#include "test_cracks.h"

static unsigned seed = 7;

/* The slow twin of what gets past cracks: the way is followed from cylinder to cylinder, and in
 * each the pieces that lie there are looked at, a few widths to both sides. */
static double pass_slowly(const RefCracks *cracks, const double x[2], const double from[2],
                          double reach)
{
    double at[2] = {x[0], x[1]}, to[2] = {from[0], from[1]}, leg[2][2], value = 1, slope[2];
    RefChartLeg kind = REF_LEG_GOES_ON;
    while (kind == REF_LEG_GOES_ON) {
        int plane = ref_chart_plane(cracks->chart, at);
        bool turned;
        kind = ref_chart_leg(cracks->chart, at, to, leg, &turned);
        for (long p = 0; p < cracks->pieces; p++) {
            const RefCrackPiece *piece = cracks->piece + p;
            const double *a = piece->at.end[0], *b = piece->at.end[1];
            if (piece->at.home != plane || piece->at.plane != plane) continue;
            if (piece->at.shift[0] != 0 || piece->at.shift[1] != 0) continue;
            for (int k = -3; k <= 3; k++) {
                double on = k * widths[plane], way[2], along[2], start[2];
                for (int d = 0; d < 2; d++) {
                    way[d] = leg[1][d] - leg[0][d];
                    along[d] = b[d] - a[d];
                    start[d] = leg[0][d] - a[d] - (d == 0) * on;
                }
                double turn = along[0] * way[1] - along[1] * way[0];
                double t = (start[0] * way[1] - start[1] * way[0]) / turn;
                double s = (start[0] * along[1] - start[1] * along[0]) / turn;
                if (!(t >= 0 && t <= 1 && s >= 0 && s <= 1)) continue;
                double far = (hypot(along[0], along[1]) * (1 - t) + piece->ahead) / (reach / 4);
                value *= far < 1 ? ref_mls_spline(far, slope) : 0;
            }
        }
    }
    return value;
}

TEST(what_passes_is_what_lies_on_the_way)
{
    const double reach = 0.8;
    long cut = 0, dimmed = 0, all = 0;
    for (int trial = 0; trial < 6; trial++) {
        Trousers t;
        RefCracks cracks;
        make_trousers(1.3, (double[3]){0.3, 0.7, 1.1}, &t);
        RefChart chart = chart_of_trousers(&t, false);
        ref_cracks_create(&chart, reach, &cracks);
        for (int n = 0; n < 8; n++) {
            random_start(&seed, &cracks, 0.17);
            random_growth(&seed, &cracks, 0.17);
        }
        for (int n = 0; n < 20000; n++) {
            double x[3] = {0}, from[3] = {0}, part[6];
            random_place(&seed, &t, x);
            for (int d = 0; d < 2; d++) from[d] = x[d] + random_between(&seed, -reach, reach);
            double slow = pass_slowly(&cracks, x, from, reach);
            double fast = ref_cracks_pass(&cracks, x, from, reach, part) ? part[0] : 0;
            assert_true(fabs(fast - slow) < 1e-9);
            cut += slow == 0;
            dimmed += slow > 0 && slow < 1;
            all++;
        }
        ref_cracks_free(&cracks);
    }
    assert_true(cut > all / 50 && dimmed > 100);
}

/* Two places are one but for rounding. */
static void assert_same(const double a[2], const double b[2])
{
    for (int d = 0; d < 2; d++) assert_true(fabs(a[d] - b[d]) < 1e-9);
}

/* The arms of both are the same, at places that `move` maps. */
static void assert_same_arms(const RefCracks *cracks, const RefCracks *others,
                             void (*move)(const void *data, const double from[2], double to[2]),
                             const void *data)
{
    assert_int_equal(cracks->arms, others->arms);
    for (long a = 0; a < cracks->arms; a++) {
        const RefCrackArm *one = cracks->arm + a, *other = others->arm + a;
        double tip[2];
        assert_int_equal(one->open, other->open);
        assert_true(fabs(one->length - other->length) < 1e-9);
        assert_same(one->way, other->way);
        move(data, one->tip, tip);
        assert_same(tip, other->tip);
    }
}

/* Random places see the same through the cracks of both. */
static void assert_same_passes(const RefCracks *cracks, const RefCracks *others,
                               void (*move)(const void *data, const double from[2], double to[2]),
                               const void *data, const double (*x)[2], int count)
{
    const double reach = cracks->margin;
    int cut = 0;
    for (int n = 0; n < count; n++) {
        double at[2][3] = {{x[n][0], x[n][1]}}, from[2][3] = {{0}}, part[2][6] = {{0}};
        move(data, x[n], at[1]);
        for (int d = 0; d < 2; d++) {
            double way = random_between(&seed, -reach, reach);
            for (int k = 0; k < 2; k++) from[k][d] = at[k][d] + way;
        }
        bool passes = ref_cracks_pass(cracks, at[0], from[0], reach, part[0]);
        assert_int_equal(ref_cracks_pass(others, at[1], from[1], reach, part[1]), passes);
        assert_int_equal(ref_cracks_part(cracks, at[0], from[0]),
                         ref_cracks_part(others, at[1], from[1]));
        for (int k = 0; k < 6 && passes; k++)
            assert_true(fabs(part[0][k] - part[1][k]) < 1e-6 * (1 + fabs(part[0][k])));
        cut += !passes;
    }
    assert_true(cut > count / 50);
}

/* A torus as two cylinders, the second one on the first, or as one rectangle. */
typedef struct {
    RefCylinder cylinder[2];
    RefJoint joint[4];
    RefCylinders all;
    RefChart parts, whole;
    double along; /* where the second one's beginning is on the first one's upper side */
} Torus;

static void make_torus(Torus *t)
{
    const double width = 2, height[2] = {0.9, 0.7}, back = random_between(&seed, 0, width);
    *t = (Torus){.along = random_between(&seed, 0, width)};
    for (int c = 0; c < 2; c++)
        t->cylinder[c] = (RefCylinder){{c * 3, 0}, {c * 3 + width, height[c]}};
    double on[2] = {t->along, back}; /* of a beginning of the next one */
    for (int c = 0; c < 2; c++) {
        const RefCylinder *low = t->cylinder + c, *high = t->cylinder + !c;
        double shift[2] = {high->low[0] - low->low[0] - on[c], -height[c]};
        double begin = low->low[0] + on[c];
        t->joint[2 * c] = (RefJoint){c, !c, true, begin, begin + width, {shift[0], shift[1]}};
        t->joint[2 * c + 1] =
            (RefJoint){!c, c, false, high->low[0], high->low[0] + width, {-shift[0], -shift[1]}};
    }
    t->all = (RefCylinders){2, 4, t->cylinder, t->joint};
    t->parts = (RefChart){.high = {3 + width, height[0]}, .cylinders = &t->all};
    t->whole = (RefChart){.high = {width, height[0] + height[1]}};
    double skew = t->along + back;
    ref_chart_skew(&t->whole, skew - width * rint(skew / width));
}

static void into_torus(const void *data, const double from[2], double to[2])
{
    const Torus *t = data;
    bool up = from[1] > t->cylinder[0].high[1];
    to[0] = up ? 3 + wrapped(from[0] - t->along, 2) : from[0];
    to[1] = from[1] - (up ? t->cylinder[0].high[1] : 0);
}

/* Cracks of a torus are the same in two cylinders, where they come to joints, and in a rectangle,
 * in whose middle these are. */
TEST(a_joint_is_no_end)
{
    for (int trial = 0; trial < 10; trial++) {
        Torus t;
        RefCracks one, two;
        make_torus(&t);
        ref_cracks_create(&t.whole, 0.4, &one);
        ref_cracks_create(&t.parts, 0.4, &two);
        for (int n = 0; n < 12; n++) {
            double at[2], angle = random_between(&seed, 0, 6);
            for (int d = 0; d < 2; d++) at[d] = random_between(&seed, 0, t.whole.high[d]);
            for (int k = 0; k < 2; k++) {
                RefCracks *cracks = k ? &two : &one;
                if (k) into_torus(&t, at, at);
                for (int side = 0; n % 3 == 0 && side < 2; side++)
                    grow_by(cracks, ref_cracks_start(cracks, at, -1), 0.1, angle + side * M_PI);
            }
            unsigned same = seed;
            random_growth(&seed, &one, 0.1);
            random_growth(&same, &two, 0.1);
            assert_same_arms(&one, &two, into_torus, &t);
            for (long a = 0; a < one.arms; a++)
                assert_int_equal(ref_cracks_end_ahead(&one, (int)a, 0.1),
                                 ref_cracks_end_ahead(&two, (int)a, 0.1));
        }
        double x[2000][2];
        for (int n = 0; n < 2000; n++)
            for (int d = 0; d < 2; d++) x[n][d] = random_between(&seed, 0, t.whole.high[d]);
        assert_same_passes(&one, &two, into_torus, &t, (const double(*)[2])x, 2000);
        for (int n = 0; n < 200; n++) {
            double there[2];
            into_torus(&t, x[n], there);
            assert_true(fabs(ref_cracks_distance(&one, x[n], 0.4) -
                             ref_cracks_distance(&two, there, 0.4)) < 1e-9);
        }
        ref_cracks_free(&one);
        ref_cracks_free(&two);
    }
}

typedef struct {
    Trousers t;
    double cut[3];
} Moved;

static void move_cut(const void *data, const double from[2], double to[2])
{
    const Moved *moved = data;
    double there[3];
    move_place(&moved->t, moved->cut, from, there);
    memcpy(to, there, 2 * sizeof *to);
}

/* Cylinders that are cut open elsewhere have the same cracks, around zeros, too. */
TEST(moving_the_cuts_moves_no_crack)
{
    for (int trial = 0; trial < 10; trial++) {
        Moved moved = {.cut = {0}};
        Trousers other;
        RefCracks one, two;
        for (int c = 0; c < 3; c++) moved.cut[c] = random_between(&seed, 0, widths[c]);
        make_trousers(1.3, (double[3]){0, 0, 0}, &moved.t);
        make_trousers(1.3, moved.cut, &other);
        RefChart chart = chart_of_trousers(&moved.t, false);
        RefChart other_chart = chart_of_trousers(&other, false);
        ref_cracks_create(&chart, 0.8, &one);
        ref_cracks_create(&other_chart, 0.8, &two);
        for (int n = 0; n < 12; n++) {
            double at[2], angle = random_between(&seed, 0, 6);
            random_place(&seed, &moved.t, at);
            for (int k = 0; k < 2; k++) {
                RefCracks *cracks = k ? &two : &one;
                if (k) move_cut(&moved, at, at);
                grow_by(cracks, ref_cracks_start(cracks, at, -1), 0.2, angle);
            }
            unsigned same = seed;
            random_growth(&seed, &one, 0.2);
            random_growth(&same, &two, 0.2);
            assert_same_arms(&one, &two, move_cut, &moved);
        }
        double x[2000][2];
        for (int n = 0; n < 2000; n++) random_place(&seed, &moved.t, x[n]);
        assert_same_passes(&one, &two, move_cut, &moved, (const double(*)[2])x, 2000);
        ref_cracks_free(&one);
        ref_cracks_free(&two);
    }
}

static void stay(const void *data, const double from[2], double to[2])
{
    (void)data;
    to[0] = from[0];
    to[1] = from[1];
}

/* Straight arms across joints are the same in one go and by steps. */
TEST(pieces_of_an_arm_are_the_arm)
{
    Trousers t;
    make_trousers(1.3, (double[3]){0.2, 0.4, 0.9}, &t);
    RefChart chart = chart_of_trousers(&t, false);
    for (int trial = 0; trial < 20; trial++) {
        RefCracks one, two;
        double at[2], angle = random_between(&seed, 0, 6), x[2000][2];
        ref_cracks_create(&chart, 0.8, &one);
        ref_cracks_create(&chart, 0.8, &two);
        random_place(&seed, &t, at);
        grow_by(&one, ref_cracks_start(&one, at, -1), 4.2, angle);
        int arm = ref_cracks_start(&two, at, -1);
        for (int n = 0; n < 30; n++) grow_by(&two, arm, 0.14, angle);
        assert_same_arms(&one, &two, stay, NULL);
        for (int n = 0; n < 2000; n++) random_place(&seed, &t, x[n]);
        assert_same_passes(&one, &two, stay, NULL, (const double(*)[2])x, 2000);
        ref_cracks_free(&one);
        ref_cracks_free(&two);
    }
}

/* The nearest image of a place is where the shortest way leads to it. */
TEST(images_are_where_short_ways_lead)
{
    Trousers t;
    make_trousers(1.3, (double[3]){0.2, 0.4, 0.9}, &t);
    RefChart chart = chart_of_trousers(&t, false);
    int joined = 0;
    for (int n = 0; n < 2000; n++) {
        double near[2], there[2], way[2], image[2];
        random_place(&seed, &t, near);
        for (int d = 0; d < 2; d++) {
            way[d] = random_between(&seed, -0.3, 0.3); /* widths and heights are 1 and more */
            there[d] = near[d];
        }
        assert_true(ref_chart_walk(&chart, there, way));
        assert_true(ref_chart_image(&chart, there, near, image));
        joined += ref_chart_plane(&chart, there) != ref_chart_plane(&chart, near);
        for (int d = 0; d < 2; d++) way[d] += near[d];
        assert_same(image, way);
    }
    assert_true(joined > 100);
}
