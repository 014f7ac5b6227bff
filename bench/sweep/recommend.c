#include "recommend.h"

#include <math.h>
#include <string.h>

#include "../engines.h"
#include "../scene/scene.h"
#include "../system/quote.h"
#include "../table/grid.h"

static const double near_enough = 0.1; /* of a stiffness: within 10% */
static const double some_more = 0.01;  /* of the body's size: deviation where nothing is wished */
static const double noise = 0.1; /* points minutes apart differ by more than their quartiles say */
enum { MOST_BOUGHT = 6, WORD = 4200 /* a path, every character quoted */ };

/* An engine's points, and what they are held against. */
typedef struct {
    const BenchPoint *point;
    long count;
    const char *engine;
    const BenchWish *wish;
    long parts;       /* least of any point */
    double deviation; /* at most, share of the body's size; INFINITY: any */
    double least;     /* deviation of any point */
    double far;       /* ratio to the stiffness at most */
} Choice;

static bool of_engine(const Choice *c, const BenchPoint *p)
{
    return bench_point_judged(p) && !strcmp(p->engine, c->engine);
}

static bool whole(const Choice *c, const BenchPoint *p)
{
    return of_engine(c, p) && p->parts <= c->parts;
}

/* Ratio of the point's stiffness to that wished, 1 or more. */
static double off(const BenchPoint *p, const BenchWish *wish)
{
    return p->frequency > 0 ? exp(fabs(log(p->frequency / wish->stiffness))) : INFINITY;
}

static bool allowed(const Choice *c, const BenchPoint *p)
{
    const BenchWish *wish = c->wish;
    if (!whole(c, p) || p->path_rms > c->deviation) return false;
    if (!isnan(wish->budget) && !(fmax(p->total_ms, p->total_high_ms) <= wish->budget))
        return false;
    return isnan(wish->stiffness) || off(p, wish) <= c->far;
}

static Choice choose(const BenchPoint *point, long count, const char *engine, const BenchWish *wish)
{
    Choice c = {point, count, engine, wish, 0, INFINITY, INFINITY, INFINITY};
    long parts = -1;
    for (long i = 0; i < count; i++)
        if (of_engine(&c, &point[i]) && (parts < 0 || point[i].parts < parts))
            parts = point[i].parts;
    c.parts = parts;
    for (long i = 0; i < count; i++)
        if (whole(&c, &point[i])) c.least = fmin(c.least, point[i].path_rms);
    bool wished = !isnan(wish->stiffness) || !isnan(wish->deviation) || !isnan(wish->budget);
    if (!isnan(wish->deviation)) c.deviation = wish->deviation / 100;
    if (!wished) c.deviation = c.least + some_more;
    if (isnan(wish->stiffness)) return c;
    double nearest = INFINITY;
    for (long i = 0; i < count; i++)
        if (allowed(&c, &point[i])) nearest = fmin(nearest, off(&point[i], wish));
    c.far = fmax(nearest, 1 + near_enough);
    return c;
}

static bool cheaper(const BenchPoint *a, const BenchPoint *b)
{
    return a->total_ms < b->total_ms;
}

/* Not dearer beyond the noise; quartiles that are not known overlap with none. */
static bool as_cheap(const BenchPoint *p, const BenchPoint *cheapest)
{
    return p->total_ms <= cheapest->total_ms ||
           p->total_low_ms <= (1 + noise) * cheapest->total_high_ms;
}

/* Is the one that deviates least wanted, whatever it costs within the budget? */
static bool exact(const BenchWish *wish)
{
    return !isnan(wish->budget) && isnan(wish->stiffness);
}

static const BenchPoint *cheapest_of(const Choice *c)
{
    const BenchPoint *best = NULL;
    double least = INFINITY;
    for (long i = 0; i < c->count && exact(c->wish); i++)
        if (allowed(c, &c->point[i])) least = fmin(least, c->point[i].path_rms);
    for (long i = 0; i < c->count; i++)
        if (allowed(c, &c->point[i]) && c->point[i].path_rms <= least &&
            (!best || cheaper(&c->point[i], best)))
            best = &c->point[i];
    return best;
}

static bool better(const BenchPoint *a, const BenchPoint *b)
{
    return a->path_rms < b->path_rms || (a->path_rms == b->path_rms && a->w < b->w);
}

static const BenchPoint *best_of(const Choice *c)
{
    const BenchPoint *cheapest = cheapest_of(c), *best = cheapest;
    for (long i = 0; i < c->count && cheapest; i++)
        if (allowed(c, &c->point[i]) && as_cheap(&c->point[i], cheapest) &&
            better(&c->point[i], best))
            best = &c->point[i];
    return best;
}

long bench_recommend_point(const BenchPoint *point, long count, const char *engine,
                           const BenchWish *wish)
{
    Choice c = choose(point, count, engine, wish);
    const BenchPoint *best = best_of(&c);
    return best ? best - point : -1;
}

/* ---- in words */

void bench_recommend_command(const BenchPlan *plan, const BenchPoint *point, size_t size,
                             char *command)
{
    char body[WORD], mesh[1100], word[WORD], epsilon[40] = "", cell[32] = "";
    bool alone = bench_plan_alone(plan), substituted = plan->mesh[0] && !alone;
    bool stored = !plan->file[0] && !bench_scene_text(plan->scene, NULL); /* where it was is not */
    char file[sizeof plan->scene + 4];
    snprintf(file, sizeof file, "%s%s", plan->scene, stored ? ".cfg" : "");
    bench_quote(alone ? plan->mesh : plan->file[0] ? plan->file : file, sizeof body, body);
    snprintf(mesh, sizeof mesh, "%s=%s", plan->scene, plan->mesh);
    bench_quote(mesh, sizeof word, word);
    bool tree = bench_engine(point->engine)->sampled, cells = !strcmp(plan->width, "cells");
    if (tree)
        snprintf(epsilon, sizeof epsilon, "%s --epsilon %g", cells ? " --width cells" : "",
                 point->epsilon);
    if (tree && alone) /* of a mesh alone, run gives the octree a finer lattice */
        snprintf(cell, sizeof cell, " --cell %.10g", plan->cell);
    snprintf(command, size, "shapebench run %s%s%s --engine %s --w %g%s%s%s", body,
             substituted ? " --mesh " : "", substituted ? word : "", point->engine, point->w,
             epsilon, cell, strcmp(plan->precision, "double") != 0 ? "" : " --precision double");
}

static void say_wish(FILE *file, const Choice *c)
{
    const BenchWish *wish = c->wish;
    const char *and = "for ";
    if (!isnan(wish->stiffness)) fprintf(file, "%sa beam of %.4g Hz", and, wish->stiffness);
    if (!isnan(wish->stiffness)) and = " and ";
    if (c->far > 1 + near_enough && isfinite(c->far)) fputs(" (nothing is within 10% of it)", file);
    if (!isnan(wish->deviation))
        fprintf(file, "%sa deviation of at most %.4g%%", and, wish->deviation);
    else if (isfinite(c->deviation) && c->deviation > some_more)
        fprintf(file, "%sa deviation of at most %.3g%%, 1%% more than its least", and,
                100 * c->deviation);
    else if (isfinite(c->deviation))
        fputs("whatever is cheapest", file); /* a lattice: none deviates */
    if (!isnan(wish->deviation)) and = " and ";
    if (!isnan(wish->budget)) fprintf(file, "%sa step of at most %.4g ms", and, wish->budget);
}

/* How many cost the same, and how stiff they are. */
static void say_alike(FILE *file, const Choice *c)
{
    const BenchPoint *cheapest = cheapest_of(c);
    double low = INFINITY, high = 0;
    int alike = 0;
    for (long i = 0; i < c->count; i++) {
        const BenchPoint *p = &c->point[i];
        if (!allowed(c, p) || !as_cheap(p, cheapest)) continue;
        if (exact(c->wish) && p->path_rms > cheapest->path_rms) continue;
        alike++;
        low = fmin(low, p->frequency);
        high = fmax(high, p->frequency);
    }
    if (alike < 2) return;
    fprintf(file, "  %d points cost the same within the noise", alike);
    if (high > low)
        fprintf(file, ", with beams of %.3g to %.3g Hz: --stiffness chooses", low, high);
    fputs(".\n", file);
}

static void say_point(FILE *file, const BenchPlan *plan, const Choice *c, const BenchPoint *p)
{
    char ms[BENCH_GRID_TEXT], command[3 * WORD];
    bool tree = bench_engine(p->engine)->sampled, cells = !strcmp(plan->width, "cells");
    bench_grid_number(p->total_ms, ms);
    fprintf(file, "%s: ", c->engine);
    say_wish(file, c);
    fprintf(file, " take w %g %s", p->w,
            !tree   ? "(cells)"
            : cells ? "(finest cells)"
                    : "(edges of each node's own cell)");
    if (tree) fprintf(file, " and epsilon %g", p->epsilon);
    fprintf(file, ": %s ms a step of %ld %s", ms, p->particles, tree ? "nodes" : "particles");
    if (p->parts > 1)
        fprintf(file, " in %ld parts that no region joins, as in all points", p->parts);
    if (isfinite(p->frequency))
        fprintf(file,
                ", a beam of %.3g Hz that sags %.3g%% of its length in the limit of small sags",
                p->frequency, 100 * p->sag);
    if (tree)
        fprintf(file,
                ", the surface %.3g%% of the body's size off full resolution (at most %.3g%%), "
                "goals %.3g cells off epsilon 0.\n",
                100 * p->path_rms, 100 * p->path_most, p->goal_rms);
    else
        fputs(", itself full resolution.\n", file);
    bench_recommend_command(plan, p, sizeof command, command);
    fprintf(file, "  %s\n", command);
}

static void say_none(FILE *file, const Choice *c)
{
    double cheapest = INFINITY;
    for (long i = 0; i < c->count; i++)
        if (whole(c, &c->point[i])) cheapest = fmin(cheapest, c->point[i].total_ms);
    if (!isfinite(cheapest)) {
        fprintf(file, "%s: no recommendation: no valid point with a deviation is in the sweep.\n",
                c->engine);
        return;
    }
    fprintf(file,
            "%s: no recommendation: no point is within%s%s%s; the cheapest step takes %.3g ms, and "
            "the least deviation is %.3g%%.\n",
            c->engine, isnan(c->wish->budget) ? "" : " the budget",
            !isnan(c->wish->budget) && !isnan(c->wish->deviation) ? " and" : "",
            isnan(c->wish->deviation) ? "" : " the deviation", cheapest, 100 * c->least);
}

/* From the least deviation on, each time what deviates least of what is cheaper. */
static void say_bought(FILE *file, const Choice *c)
{
    const BenchPoint *last = NULL;
    for (int n = 0; n < MOST_BOUGHT; n++) {
        const BenchPoint *next = NULL;
        for (long i = 0; i < c->count; i++) {
            const BenchPoint *p = &c->point[i];
            if (!whole(c, p) || (last && as_cheap(last, p))) continue;
            if (!next || p->path_rms < next->path_rms ||
                (p->path_rms == next->path_rms && cheaper(p, next)))
                next = p;
        }
        if (!next) break;
        fprintf(file, "%s%.3g%%: %.3g ms (w %g, epsilon %g)", n ? "; " : "  A deviation of ",
                100 * next->path_rms, next->total_ms, next->w, next->epsilon);
        last = next;
    }
    if (last) fputs(".\n", file);
}

static void say_apart(FILE *file, const Choice *c)
{
    int apart = 0;
    for (long i = 0; i < c->count; i++)
        apart += of_engine(c, &c->point[i]) && c->point[i].parts > c->parts;
    if (apart)
        fprintf(file,
                "  Left out: %d point%s whose body falls apart; a w of 1 edge of each node's own "
                "cell holds together what touches.\n",
                apart, apart == 1 ? "" : "s");
}

void bench_recommend(FILE *file, const BenchPlan *plan, const BenchPoint *point, long count,
                     const BenchWish *wish)
{
    const BenchEngine *engine;
    for (int e = 0; (engine = bench_engine_planned(plan->engines, e)); e++) {
        Choice c = choose(point, count, engine->type[0]->name, wish);
        const BenchPoint *best = best_of(&c);
        if (!best) {
            say_none(file, &c);
            continue;
        }
        say_point(file, plan, &c, best);
        say_alike(file, &c);
        if (engine->sampled) say_bought(file, &c);
        say_apart(file, &c);
    }
}
