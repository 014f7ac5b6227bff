/* Operations on lanes against what they do to one lane after the other, in both precisions
 * (SM_REAL_BITS). */
#include "rigid_lanes.h"
#include "rows.h"

#include <float.h>

#ifdef __linux__
#include <sys/mman.h>
#include <unistd.h>
#endif

#include "../test_frame.h"
#include "../test_random.h"

enum { TRIALS = 200 };

static vec random_vec(unsigned *seed)
{
    vec v;
    for (int i = 0; i < SM_LANES; i++) v[i] = (real)random_between(seed, -1, 1);
    return v;
}

/* Some of its lanes hold what arithmetic seldom meets. */
static vec special_vec(unsigned *seed)
{
    const real most = SM_REAL_BITS == 32 ? (real)FLT_MAX : (real)DBL_MAX,
               least = SM_REAL_BITS == 32 ? (real)FLT_MIN : (real)DBL_MIN;
    const real special[] = {0,    -(real)0, (real)INFINITY, -(real)INFINITY, (real)NAN,
                            most, -most,    least,          least / 4,       -least / 4};
    const int count = sizeof special / sizeof *special;
    vec v = random_vec(seed);
    for (int i = 0; i < SM_LANES; i++)
        if (random_int(seed, 2)) v[i] = special[random_int(seed, count)];
    return v;
}

/* The same bits, so that a zero's sign counts. */
static void check(vec found, vec wanted)
{
    assert_memory_equal(&found, &wanted, sizeof found);
}

static void number(real *p, int count)
{
    for (int i = 0; i < count; i++) p[i] = (real)(i + 1);
}

TEST(loads_and_stores_take_any_alignment)
{
    real from[4 * SM_LANES + 16], to[4 * SM_LANES + 16];
    number(from, 4 * SM_LANES + 16);
    for (int at = 0; at < SM_LANES; at++) {
        vec row[3];
        load3(from + at, row);
        for (int d = 0; d < 3; d++)
            for (int i = 0; i < SM_LANES; i++) assert_true(row[d][i] == at + d * SM_LANES + i + 1);
        memset(to, 0, sizeof to);
        store3(to + at, row);
        assert_memory_equal(to + at, from + at, 3 * SM_LANES * sizeof *to);
        assert_true(to[at + 3 * SM_LANES] == 0 && (at == 0 || to[at - 1] == 0));
        store4(to + at, load4(from));
        half_store(to + at + 4, half_load(from + 4));
        row_store(to + at + 12, row_load(from + 12));
        assert_memory_equal(to + at, from, 28 * sizeof *to);
    }
}

TEST(rows_are_added_whole_and_in_fours)
{
    real from[16], half[8], row[16];
    number(from, 16);
    vec4 first = load4(from + 1), last = load4(from + 9);
    half_store(half, half_of(first, last));
    for (int i = 0; i < 8; i++) assert_true(half[i] == (i < 4 ? from[i + 1] : from[i + 5]));
    store4(half, half_first(half_load(from + 3)));
    store4(half + 4, row_first(row_load(from)));
    for (int i = 0; i < 8; i++) assert_true(half[i] == (i < 4 ? from[i + 3] : from[i - 4]));
    half_store(half, half_add(half_load(from), half_load(from + 8)));
    row_store(row, row_add(row_load(from), row_load(from)));
    for (int i = 0; i < 8; i++) assert_true(half[i] == from[i] + from[i + 8]);
    for (int i = 0; i < 16; i++) assert_true(row[i] == 2 * from[i]);
    half_store(half, half_less(half_load(from), half_load(from + 8)));
    for (int i = 0; i < 8; i++) assert_true(half[i] == from[i] - from[i + 8]);
    row_store(row, row_less(row_of_half(half_load(from + 8)), row_load(from)));
    for (int i = 0; i < 16; i++) assert_true(row[i] == (i < 8 ? from[i + 8] : 0) - from[i]);
    for (int end = 0; end < 4; end++) {
        row_store(row, row_add_four(row_load(from), end, first));
        for (int i = 0; i < 16; i++)
            assert_true(row[i] == from[i] + (i / 4 == end ? from[1 + i % 4] : 0));
        if (end > 1) continue;
        half_store(half, half_add_four(half_load(from), end, last));
        for (int i = 0; i < 8; i++)
            assert_true(half[i] == from[i] + (i / 4 == end ? from[9 + i % 4] : 0));
    }
}

TEST(vectors_are_set_numbered_and_copied)
{
    vec from[16], to[16] = {0};
    for (int i = 0; i < 16; i++) from[i] = lanes_number() + lanes_set((real)i);
    for (int i = 0; i < 16; i++)
        for (int lane = 0; lane < SM_LANES; lane++) assert_true(from[i][lane] == i + lane);
    lanes_copy(7, from, to);
    assert_memory_equal(to, from, 7 * sizeof *to);
    check(to[7], lanes_set(0));
}

TEST(masks_choose_lanes)
{
    unsigned seed = 1;
    for (int trial = 0; trial < TRIALS; trial++) {
        unsigned lanes = (unsigned)random_int(&seed, LANES_ALL + 1);
        vec yes = special_vec(&seed), no = special_vec(&seed), chosen, kept;
        ivec mask;
        for (int i = 0; i < SM_LANES; i++) {
            bool set = lanes >> i & 1;
            mask[i] = -(lane_int)set;
            chosen[i] = set ? yes[i] : no[i];
            kept[i] = set ? yes[i] : 0;
        }
        check(lanes_choose(lanes, yes, no), chosen);
        check(lanes_select(mask, yes, no), chosen);
        check(lanes_keep(lanes, yes), kept);
        check(lanes_and(yes, mask), kept);
        assert_int_equal(lanes_any(mask) != 0, lanes != 0);
    }
    for (int i = 0; i < SM_LANES; i++) { /* a single lane */
        ivec mask = {0};
        for (int bit = 0; bit < SM_REAL_BITS; bit++) {
            mask[i] = (lane_int)((uint64_t)1 << bit);
            assert_true(lanes_any(mask));
        }
    }
    assert_false(lanes_any((ivec){0}));
}

TEST(lanes_are_compared)
{
    unsigned seed = 2;
    for (int trial = 0; trial < TRIALS; trial++) {
        vec a = special_vec(&seed), b = special_vec(&seed), most, size;
        unsigned below = 0;
        b[trial % SM_LANES] = a[trial % SM_LANES];
        for (int i = 0; i < SM_LANES; i++) {
            below |= (unsigned)(a[i] < b[i]) << i;
            most[i] = a[i] > b[i] ? a[i] : b[i];
            size[i] = (real)fabs((double)a[i]);
        }
        check(lanes_max(a, b), most);
        check(lanes_abs(a), size);
        assert_int_equal(lanes_below(a, b), below);
    }
    check(lanes_abs(lanes_set(-(real)0)), lanes_set(0));
}

/* As the standard has them: over the magnitudes of ten decades, and of special values. */
TEST(roots_are_rounded_to_the_last_bit)
{
    unsigned seed = 3;
    for (int trial = 0; trial < 10 * TRIALS; trial++) {
        vec v;
        for (int i = 0; i < SM_LANES; i++) v[i] = (real)pow(10, random_between(&seed, -5, 5));
        vec root = lanes_sqrt(v);
        for (int i = 0; i < SM_LANES; i++) assert_true(root[i] == (real)sqrt((double)v[i]));
    }
    for (int trial = 0; trial < TRIALS; trial++) {
        vec v = special_vec(&seed), root = lanes_sqrt(v);
        for (int i = 0; i < SM_LANES; i++) {
            real want = (real)sqrt((double)v[i]);
            assert_true(isnan(want) ? isnan(root[i])
                                    : root[i] == want && !signbit(root[i]) == !signbit(want));
        }
    }
}

/* Fused, their last bits would be left. */
TEST(products_are_rounded_before_they_are_used)
{
    unsigned seed = 4;
    for (int trial = 0; trial < TRIALS; trial++) {
        vec a = random_vec(&seed), b = random_vec(&seed), product;
        for (int i = 0; i < SM_LANES; i++) {
            volatile real once = a[i] * b[i];
            product[i] = once;
        }
        check(lanes_rounded(a * b) - product, lanes_set(0));
    }
}

static void check_slide(vec slid, int o)
{
    for (int i = 0; i < SM_LANES; i++) assert_true(slid[i] == o + i);
}

TEST(vectors_slide_by_any_number_of_lanes)
{
    vec low = lanes_number(), high = low + SM_LANES;
    for (volatile int o = 0; o <= SM_LANES; o++) check_slide(lanes_slide(low, high, o), o);
    check_slide(lanes_slide(low, high, 0), 0); /* constants have an instruction of their own */
    check_slide(lanes_slide(low, high, 1), 1);
    check_slide(lanes_slide(low, high, 2), 2);
    check_slide(lanes_slide(low, high, 3), 3);
    check_slide(lanes_slide(low, high, SM_LANES / 2), SM_LANES / 2);
    check_slide(lanes_slide(low, high, SM_LANES - 2), SM_LANES - 2);
    check_slide(lanes_slide(low, high, SM_LANES - 1), SM_LANES - 1);
    check_slide(lanes_slide(low, high, SM_LANES), SM_LANES);
    unsigned seed = 6;
    for (int trial = 0; trial < TRIALS; trial++) { /* whatever they hold */
        const vec from[2] = {special_vec(&seed), special_vec(&seed)};
        const volatile int o = random_int(&seed, SM_LANES + 1);
        vec slid = lanes_slide(from[0], from[1], o);
        assert_memory_equal(&slid, (const real *)from + o, sizeof slid);
    }
}

static void check_part(part_vec part, const real *from, unsigned lanes)
{
    for (int i = 0; i < SM_PART; i++) {
        real found = part[i], wanted = lanes >> i & 1 ? from[i] : 0;
        assert_memory_equal(&found, &wanted, sizeof found);
    }
}

/* A page, for the rest of the program; between two that nobody may read where the system can. */
static real *page_apart(real **end)
{
#ifdef __linux__
    size_t page = (size_t)sysconf(_SC_PAGESIZE);
    char *pages = mmap(NULL, 3 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    assert_true(pages != MAP_FAILED);
    assert_int_equal(mprotect(pages, page, PROT_NONE), 0);
    assert_int_equal(mprotect(pages + 2 * page, page, PROT_NONE), 0);
#else
    enum { page = 4096 };
    static char pages[3 * page] __attribute__((aligned(64)));
#endif
    *end = (real *)(pages + 2 * page);
    return (real *)(pages + page);
}

TEST(parts_of_vectors_read_what_is_asked_for_alone)
{
    real *end, *first = page_apart(&end);
    unsigned seed = 7;
    for (real *p = first; p < end; p += SM_LANES) lanes_store(p, special_vec(&seed));
    for (int out = 0; out <= SM_PART; out++) { /* lanes beyond the end, or before the start */
        const unsigned all = (1u << SM_PART) - 1;
        unsigned inside = all >> out, after = all << out & all;
        part_vec low = part_load(end - SM_PART + out, inside), high = part_load(first - out, after);
        check_part(low, end - SM_PART + out, inside);
        check_part(high, first - out, after);
        const part_vec parts[2] = {low, high};
        vec joined = lanes_join(parts);
        assert_memory_equal(&joined, parts, sizeof joined);
    }
}

TEST(interleaved_vectors_are_rows_of_lanes)
{
    unsigned seed = 8;
    for (int n = 1; n <= 16; n *= 2) {
        vec m[16], was[16];
        real row[16 * SM_LANES];
        for (int i = 0; i < n; i++) was[i] = m[i] = special_vec(&seed);
        for (int i = 0; i < n * SM_LANES; i++) row[i] = was[i % n][i / n];
        lanes_interleave(m, n);
        assert_memory_equal(m, row, sizeof *m * (size_t)n);
        lanes_separate(m, n);
        assert_memory_equal(m, was, sizeof *m * (size_t)n);
    }
}

TEST(rows_are_gathered_and_scattered)
{
    real memory[SM_LANES][19], back[SM_LANES][16], *to[SM_LANES];
    const real *from[SM_LANES];
    vec field[16];
    for (int i = 0; i < SM_LANES; i++) {
        for (int f = 0; f < 16; f++) memory[i][f + i % 4] = (real)(100 * i + f);
        from[i] = memory[i] + i % 4; /* at any alignment */
        to[i] = back[SM_LANES - 1 - i];
    }
    lanes_from_rows(from, field);
    for (int f = 0; f < 16; f++)
        for (int i = 0; i < SM_LANES; i++) assert_true(field[f][i] == 100 * i + f);
    lanes_to_rows(field, to);
    for (int i = 0; i < SM_LANES; i++) assert_memory_equal(to[i], from[i], sizeof *back);
}

/* Inertias about x just beyond what rigid_lanes.h says of noise, and an indefinite one of a spread
 * that is all noise: J is I, I + noise, tr S, or tr S + noise, and 1 / J is turned to along x. */
TEST(inertias_are_held_clear_of_noise)
{
    const double thinnest = SM_REAL_BITS == 32 ? 1e-5 : 1e-10, n = 8 * (double)SM_EPSILON;
    const struct {
        double S[3], size, J; /* S on the diagonal alone */
    } cases[] = {{{1, 0.55 * thinnest, 0.55 * thinnest}, 0, 1.1 * thinnest},
                 {{1, 0.45 * thinnest, 0.45 * thinnest}, 0, 1},
                 {{1, 35e-4, 35e-4}, 1e-4 / n, 70e-4},
                 {{1, 30e-4, 30e-4}, 1e-4 / n, 61e-4},
                 {{1, 0.6e-4, 0.6e-4}, 1e-4 / n, 2.2e-4},
                 {{1, 0.4e-4, 0.4e-4}, 1e-4 / n, 1},
                 {{1, 0, 0}, 0.017 / n, 1.017},
                 {{0.9, -1e-4, -1e-4}, 1e-4 / n, 0.8998},
                 {{-2.95, 0.05, 0.05}, 0.05 / n, 0.05},
                 {{-1.1, 1, 1}, 1e-4 / n, 0.9}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        vec S[6] = {0}, L[3] = {lanes_set(1)}, omega[3];
        for (int d = 0; d < 3; d++) S[d] = lanes_set((real)cases[c].S[d]);
        angular_velocity(S, L, lanes_set((real)cases[c].size), omega);
        double found = (double)omega[0][0] * cases[c].J;
        if (!(fabs(found - 1) < 1e-3)) fail_msg("%d: %g of 1 / J", (int)c, found);
    }
}
