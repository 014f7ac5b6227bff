#include "front.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "grid.h"

static const double near_enough = 0.1; /* of a stiffness: within 10% */

static bool judged(const BenchPoint *p)
{
    return p->valid && isfinite(p->total_ms) && isfinite(p->path_rms);
}

/* Quartiles that are not known overlap with all. */
static bool beats(const BenchPoint *a, const BenchPoint *b)
{
    return a->total_high_ms < b->total_low_ms && a->path_rms <= b->path_rms;
}

void bench_front_mark(BenchPoint *point, long count)
{
    for (long i = 0; i < count; i++) {
        point[i].front = judged(&point[i]);
        for (long j = 0; j < count && point[i].front; j++)
            point[i].front = !(judged(&point[j]) && beats(&point[j], &point[i]));
    }
}

static bool allowed(const BenchPoint *p, const BenchWish *wish)
{
    if (!judged(p)) return false;
    if (!isnan(wish->stiffness) && !(p->frequency > 0)) return false;
    if (!isnan(wish->budget) && p->total_ms > wish->budget) return false;
    return isnan(wish->deviation) || 100 * p->path_rms <= wish->deviation;
}

/* Ratio of the point's stiffness to that wished, 1 or more. */
static double off(const BenchPoint *p, const BenchWish *wish)
{
    return exp(fabs(log(p->frequency / wish->stiffness)));
}

static bool cheaper(const BenchPoint *a, const BenchPoint *b)
{
    return a->total_ms < b->total_ms || (a->total_ms == b->total_ms && a->path_rms < b->path_rms);
}

/* Is `a` to be taken rather than `b`? */
static bool better(const BenchPoint *a, const BenchPoint *b, const BenchWish *wish)
{
    if (!isnan(wish->stiffness)) {
        double far_a = fmax(off(a, wish), 1 + near_enough);
        double far_b = fmax(off(b, wish), 1 + near_enough);
        return far_a < far_b || (far_a == far_b && cheaper(a, b));
    }
    if (!isnan(wish->budget))
        return a->path_rms < b->path_rms || (a->path_rms == b->path_rms && cheaper(a, b));
    return cheaper(a, b);
}

static void say_none(const BenchPoint *point, long count, const BenchWish *wish,
                     char sentence[BENCH_SENTENCE])
{
    double cheapest = INFINITY, nearest = INFINITY;
    for (long i = 0; i < count; i++) {
        if (!judged(&point[i])) continue;
        cheapest = fmin(cheapest, point[i].total_ms);
        nearest = fmin(nearest, 100 * point[i].path_rms);
    }
    if (!isfinite(cheapest))
        snprintf(sentence, BENCH_SENTENCE,
                 "No recommendation: no valid point with a deviation is in the sweep.");
    else
        snprintf(
            sentence, BENCH_SENTENCE,
            "No recommendation: no point of the sweep is within%s%s%s; the cheapest step takes "
            "%.3g ms, and the least deviation is %.3g%%.",
            isnan(wish->budget) ? "" : " the budget",
            !isnan(wish->budget) && !isnan(wish->deviation) ? " and" : "",
            isnan(wish->deviation) ? "" : " the deviation", cheapest, nearest);
}

/* ": wanted ..." of what was wished. */
static void say_wish(const BenchPoint *p, const BenchWish *wish, char text[160])
{
    int used = snprintf(text, 160, "For");
    if (!isnan(wish->stiffness))
        used += snprintf(text + used, 160 - (size_t)used, " a beam of %.4g Hz%s", wish->stiffness,
                         off(p, wish) > 1 + near_enough ? " (nothing is within 10% of it)" : "");
    if (!isnan(wish->deviation))
        used += snprintf(text + used, 160 - (size_t)used, "%s a deviation of at most %.4g%%",
                         used > 3 ? " and" : "", wish->deviation);
    if (!isnan(wish->budget))
        snprintf(text + used, 160 - (size_t)used, "%s a step of at most %.4g ms",
                 used > 3 ? " and" : "", wish->budget);
}

static void say_point(const BenchPoint *p, const BenchWish *wish, const char *width,
                      char sentence[BENCH_SENTENCE])
{
    char wanted[160], choice[96], ms[BENCH_GRID_TEXT];
    say_wish(p, wish, wanted);
    bench_grid_number(p->total_ms, ms);
    bool tree = !strcmp(p->engine, "octree");
    if (tree)
        snprintf(choice, sizeof choice, "the octree with w %g %s and epsilon %g", p->w, width,
                 p->epsilon);
    else
        snprintf(choice, sizeof choice, "fastlsm with w %g", p->w);
    int used = snprintf(sentence, BENCH_SENTENCE, "%s take %s: %.20s ms a step of %ld %s", wanted,
                        choice, ms, p->particles, tree ? "nodes" : "particles");
    if (p->parts > 1)
        used += snprintf(sentence + used, BENCH_SENTENCE - (size_t)used,
                         " in %ld parts that no region joins", p->parts);
    if (isfinite(p->frequency))
        used += snprintf(
            sentence + used, BENCH_SENTENCE - (size_t)used,
            ", a beam of %.3g Hz that sags %.3g%% of its length in the limit of small sags",
            p->frequency, 100 * p->sag);
    if (tree)
        snprintf(sentence + used, BENCH_SENTENCE - (size_t)used,
                 ", the surface %.3g%% of the body's size off full resolution (at most %.3g%%), "
                 "goals %.3g cells off epsilon 0.",
                 100 * p->path_rms, 100 * p->path_most, p->goal_rms);
    else
        snprintf(sentence + used, BENCH_SENTENCE - (size_t)used, ", itself full resolution.");
}

long bench_recommend(const BenchPoint *point, long count, const BenchWish *wish, const char *width,
                     char sentence[BENCH_SENTENCE])
{
    BenchWish wanted = *wish;
    if (isnan(wish->stiffness) && isnan(wish->deviation) && isnan(wish->budget))
        wanted.deviation = 1;
    long best = -1;
    for (long i = 0; i < count; i++)
        if (allowed(&point[i], &wanted) && (best < 0 || better(&point[i], &point[best], &wanted)))
            best = i;
    if (best < 0)
        say_none(point, count, &wanted, sentence);
    else
        say_point(&point[best], &wanted, width, sentence);
    return best;
}
