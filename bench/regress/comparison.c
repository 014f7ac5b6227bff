#include "comparison.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"
#include "../system/statistic.h"

static const double least_interleaved = 0.02, least_apart = 0.10;

/* Where code lies in memory moves a stage by some percent whenever anything is changed; what that
 * is of a step nobody needs to know. */
static const double least_of_step = 0.005;

const char *bench_comparison_name(BenchComparisonVerdict verdict)
{
    static const char *const names[BENCH_COMPARISONS] = {
        "faster", "same", "slower", "too noisy", "too few samples", "INVALID", "no baseline"};
    return names[verdict];
}

/* The first of the values that are judged, and how many there are. */
static int first_value(const BenchCompareParams *params)
{
    return params->by_cycles ? BENCH_TIMES + BENCH_CYCLES : 0;
}

static int values(const BenchCompareParams *params)
{
    return params->by_cycles ? 1 : BENCH_TIMES;
}

/* Of settings "key = value; ...". */
static const char *next_setting(const char *said)
{
    said += strcspn(said, ";");
    return said + strspn(said, "; ");
}

/* Behind the key's "=". */
static const char *value_of_setting(const char *said, const char *key, size_t length)
{
    while (*said && strncmp(said, key, length) != 0) said = next_setting(said);
    return *said ? said + length : " the default;";
}

/* Have both the value of each setting that `said` has? If not, what the first one is in both. */
static bool same_settings(const char *said, const char *old, const char *new, size_t size,
                          char *reason)
{
    for (; *said; said = next_setting(said)) {
        size_t length = strcspn(said, "=") + 1;
        const char *before = value_of_setting(old, said, length);
        const char *now = value_of_setting(new, said, length);
        size_t value = strcspn(before, ";");
        if (!strncmp(before, now, value + 1)) continue;
        snprintf(reason, size, "other work: %.*s%.*s, now%.*s", (int)length, said, (int)value,
                 before, (int)strcspn(now, ";"), now);
        return false;
    }
    return true;
}

/* Are they of the same work: engine, precision, instruction set unless it may be any, mesh,
 * particles, settings? If not, what differs, and both. What an old file does not state
 * (row_store.h) is not judged. */
static bool same_work(const BenchRow *a, const BenchRow *b, bool any_isa, size_t size, char *reason)
{
    const struct {
        const char *what;
        double old, new;
        bool stated;
    } number[] = {
        {"threads", a->threads, b->threads, a->threads > 0},
        {"particles", (double)a->particles, (double)b->particles, a->particles > 0},
        {"w", a->w, b->w, a->w > 0},
        {"epsilon", a->epsilon, b->epsilon, isfinite(a->epsilon)},
        {"h", a->h, b->h, isfinite(a->h)},
    };
    const struct {
        const char *what, *old, *new, *remedy;
    } name[] = {
        {"engine", a->engine, b->engine, ""},
        {"precision", a->precision, b->precision, ""},
        {"kernels of", any_isa ? "" : a->isa, b->isa, " (--isa)"},
    };
    for (size_t i = 0; i < sizeof name / sizeof *name; i++)
        if (*name[i].old && *name[i].new &&strcmp(name[i].old, name[i].new) != 0) {
            snprintf(reason, size, "other work: %s %s, now %s%s", name[i].what, name[i].old,
                     name[i].new, name[i].remedy);
            return false;
        }
    for (size_t i = 0; i < sizeof number / sizeof *number; i++)
        if (number[i].stated && number[i].old != number[i].new) {
            snprintf(reason, size, "other work: %s %.9g, now %.9g", number[i].what, number[i].old,
                     number[i].new);
            return false;
        }
    bool stated = *a->settings && *b->settings;
    if (stated && !same_settings(a->settings, a->settings, b->settings, size, reason)) return false;
    if (stated && !same_settings(b->settings, a->settings, b->settings, size, reason)) return false;
    if (!a->input_hash || a->input_hash == b->input_hash) return true;
    snprintf(reason, size, "other work: the mesh is another one");
    return false;
}

/* Why nothing of this scene can be compared, if so. */
static bool comparable(BenchComparison *result, const BenchCompareParams *params)
{
    const BenchSide *side = result->samples->side;
    for (int b = BENCH_BUILDS - 1; b >= 0; b--) {
        if (side[b].valid) continue;
        result->verdict = BENCH_INCORRECT;
        snprintf(result->reason, sizeof result->reason, "%s: %s", bench_build_names[b],
                 side[b].reason);
        return false;
    }
    result->verdict = BENCH_NO_BASELINE;
    for (int i = 0; i < BENCH_BUILDS && params->by_cycles; i++) {
        if (!side[i].count || bench_side_has(&side[i], first_value(params))) continue;
        snprintf(result->reason, sizeof result->reason, "%s has no cycles", bench_build_names[i]);
        return false;
    }
    if (side[BENCH_OLD].count == 0 || side[BENCH_NEW].count == 0) {
        int missing = side[BENCH_OLD].count ? BENCH_NEW : BENCH_OLD;
        snprintf(result->reason, sizeof result->reason, "%s has no such scene%s%s",
                 bench_build_names[missing], side[missing].reason[0] ? ": " : "",
                 side[missing].reason);
        return false;
    }
    return same_work(&side[BENCH_OLD].row, &side[BENCH_NEW].row, params->any_isa,
                     sizeof result->reason, result->reason);
}

static BenchTimes times_of(const BenchSide *side, int value)
{
    return (BenchTimes){side->value[value], side->round, side->count};
}

static void compare_interleaved(const BenchTimes *old, const BenchTimes *new,
                                const BenchCompareParams *params, BenchComparison *result)
{
    BenchRatio ratio = bench_ratio_paired(old, new, params->rounds, params->seed);
    result->p = bench_mann_whitney(old->value, old->count, new->value, new->count);
    result->self[BENCH_OLD] = bench_self_noise(old, params->rounds, params->seed);
    result->self[BENCH_NEW] = bench_self_noise(new, params->rounds, params->seed);
    result->ratio = ratio.ratio, result->low = ratio.low, result->high = ratio.high;
}

static void compare_apart(const BenchTimes *old, const BenchTimes *new, int comparisons,
                          const BenchCompareParams *params, BenchComparison *result)
{
    const BenchSide *side = result->samples->side;
    const BenchSide *left = &side[BENCH_OLD], *right = &side[BENCH_NEW];
    BenchRatio ratio = bench_ratio_apart(old, new, params->seed);
    result->p = bench_mann_whitney(left->block[result->value], left->blocks,
                                   right->block[result->value], right->blocks);
    result->self[BENCH_OLD] = NAN;
    result->self[BENCH_NEW] = bench_spread_noise(new, old->count, BENCH_NOISE_LEVEL, comparisons);
    result->ratio = ratio.ratio, result->low = ratio.low, result->high = ratio.high;
}

static void measure(BenchComparison *result, int comparisons, const BenchCompareParams *params)
{
    const BenchSide *side = result->samples->side;
    BenchTimes times[BENCH_BUILDS];
    double low = params->interleaved ? BENCH_LOW : 0.5;
    for (int b = 0; b < BENCH_BUILDS; b++) {
        times[b] = times_of(&side[b], result->value);
        result->amount[b] =
            bench_value_unit(result->value) * bench_quantile(times[b].value, times[b].count, low);
        result->outlier[b] = sm_alloc((size_t)times[b].count, sizeof(bool));
        result->outliers[b] = bench_outliers(times[b].value, times[b].count, result->outlier[b]);
    }
    if (params->interleaved)
        compare_interleaved(&times[BENCH_OLD], &times[BENCH_NEW], params, result);
    else
        compare_apart(&times[BENCH_OLD], &times[BENCH_NEW], comparisons, params, result);
}

/* Could the test call nothing different, whatever is measured? */
static bool finds_nothing(int old, int new, int comparisons)
{
    return bench_least_p(old, new) * comparisons >= BENCH_LEVEL;
}

static BenchComparisonVerdict judge(BenchComparison *result, int comparisons,
                                    const BenchCompareParams *params)
{
    const BenchSide *side = result->samples->side;
    double noise = fmax(result->self[BENCH_OLD], result->self[BENCH_NEW]); /* NaN: the other one */
    double least = params->interleaved ? least_interleaved : least_apart;
    int whole = first_value(params);
    double step = bench_quantile(side[BENCH_OLD].value[whole], side[BENCH_OLD].count,
                                 params->interleaved ? BENCH_LOW : 0.5);
    least = fmax(least, least_of_step * bench_value_unit(whole) * step / result->amount[BENCH_OLD]);
    double limit = isnan(params->threshold) ? BENCH_NOISE_LIMIT : params->threshold;
    result->threshold = fmax(noise, isnan(params->threshold) ? least : params->threshold);
    bool few = params->interleaved
                   ? params->rounds < bench_compare_rounds(comparisons)
                   : side[BENCH_NEW].count < BENCH_LEAST_PROCESSES ||
                         finds_nothing(side[BENCH_OLD].blocks, side[BENCH_NEW].blocks, comparisons);
    if (few || isnan(noise)) return BENCH_TOO_FEW;
    bool sure = result->adjusted < BENCH_LEVEL;
    if (sure && result->ratio > 1 + result->threshold && result->low > 1) return BENCH_SLOWER;
    if (sure && result->ratio < 1 / (1 + result->threshold) && result->high < 1)
        return BENCH_FASTER;
    return noise > limit ? BENCH_TOO_NOISY : BENCH_SAME;
}

/* An entry for each value that both builds have, or a single one that says why there is none. */
static int list_values(const BenchAbScene *samples, const BenchCompareParams *params,
                       BenchComparison *list)
{
    BenchComparison blank = {.samples = samples,
                             .value = first_value(params),
                             .amount = {NAN, NAN},
                             .ratio = NAN,
                             .low = NAN,
                             .high = NAN,
                             .p = NAN,
                             .adjusted = NAN,
                             .self = {NAN, NAN},
                             .threshold = NAN};
    if (!comparable(&blank, params)) {
        *list = blank;
        return 1;
    }
    int count = 0;
    blank.verdict = BENCH_SAME;
    for (int v = first_value(params), end = v + values(params); v < end; v++) {
        if (!bench_side_has(&samples->side[BENCH_OLD], v) ||
            !bench_side_has(&samples->side[BENCH_NEW], v))
            continue;
        list[count] = blank;
        list[count++].value = v;
    }
    return count;
}

int bench_compare(const BenchAbSamples *all, const BenchCompareParams *params,
                  BenchComparison **list)
{
    int count = 0, tested = 0;
    BenchComparison *result = sm_alloc((size_t)(all->count * BENCH_TIMES) + 1, sizeof *result);
    for (int i = 0; i < all->count; i++)
        count += list_values(&all->scenes[i], params, result + count);
    double *p = sm_alloc((size_t)count, sizeof *p);
    for (int i = 0; i < count; i++) {
        if (result[i].verdict == BENCH_SAME) measure(&result[i], count, params);
        p[i] = result[i].p;
        tested += isfinite(p[i]);
    }
    bench_holm(p, count);
    for (int i = 0; i < count; i++) {
        result[i].adjusted = p[i];
        if (result[i].verdict == BENCH_SAME) result[i].verdict = judge(&result[i], tested, params);
    }
    free(p);
    *list = result;
    return count;
}

void bench_comparisons_free(BenchComparison *list, int count)
{
    for (int i = 0; i < count; i++)
        for (int b = 0; b < BENCH_BUILDS; b++) free(list[i].outlier[b]);
    free(list);
}

int bench_compare_rounds(int comparisons)
{
    int rounds = 2; /* what the noise takes */
    while (finds_nothing(2 * rounds, 2 * rounds, comparisons)) rounds++;
    return rounds;
}

int bench_comparisons_rounds(const BenchComparison *list, int count,
                             const BenchCompareParams *params)
{
    int rounds = params->rounds + 1, compared = 0;
    if (!params->interleaved)
        return rounds > BENCH_LEAST_PROCESSES / 2 ? rounds : BENCH_LEAST_PROCESSES / 2 + 1;
    for (int i = 0; i < count; i++)
        compared += list[i].verdict != BENCH_INCORRECT && list[i].verdict != BENCH_NO_BASELINE;
    return rounds > bench_compare_rounds(compared) ? rounds : bench_compare_rounds(compared);
}

int bench_comparisons_exit(const BenchComparison *list, int count)
{
    bool had[BENCH_COMPARISONS] = {false};
    for (int i = 0; i < count; i++) had[list[i].verdict] = true;
    if (had[BENCH_INCORRECT]) return SM_INVALID;
    if (had[BENCH_SLOWER]) return BENCH_EXIT_SLOWER;
    if (had[BENCH_NO_BASELINE]) return BENCH_EXIT_NO_BASELINE;
    return had[BENCH_SAME] || had[BENCH_FASTER] ? SM_OK : BENCH_EXIT_NOT_JUDGED;
}
