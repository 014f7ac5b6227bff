#include "recommend.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../engines.h"
#include "../scene/scene.h"
#include "../system/quote.h"
#include "../table/grid.h"

static const double noise = 0.1; /* points minutes apart differ by more than their quartiles say */
enum { MOST_BOUGHT = 6, WORD = 4200 /* a path, every character quoted */ };

/* An engine's points, and what they are held against. */
typedef struct {
    const BenchPoint *point;
    long count;
    const char *engine;
    const BenchWish *wish;
    long parts; /* least of any point */
    double far; /* ratio to the stiffness at most */
} Choice;

static bool of_engine(const Choice *c, const BenchPoint *p)
{
    return bench_point_judged(p) && !strcmp(p->engine, c->engine);
}

static bool whole(const Choice *c, const BenchPoint *p)
{
    return of_engine(c, p) && p->parts <= c->parts;
}

/* Ratio of the point's stiffness to that wished, 1 or more; NaN where none is wished. */
static double off(const BenchPoint *p, const BenchWish *wish)
{
    return exp(fabs(log(p->frequency / wish->stiffness)));
}

/* Whole, and near enough to the stiffness wished; any where none is. */
static bool fits(const Choice *c, const BenchPoint *p)
{
    return whole(c, p) && !(off(p, c->wish) > c->far);
}

static bool allowed(const Choice *c, const BenchPoint *p)
{
    return fits(c, p) && !(100 * p->path_rms > c->wish->deviation) &&
           !(fmax(p->total_ms, p->total_high_ms) > c->wish->budget);
}

static Choice choose(const BenchPoint *point, long count, const char *engine, const BenchWish *wish)
{
    Choice c = {point, count, engine, wish, -1, INFINITY};
    for (long i = 0; i < count; i++)
        if (of_engine(&c, &point[i]) && (c.parts < 0 || point[i].parts < c.parts))
            c.parts = point[i].parts;
    double nearest = INFINITY;
    for (long i = 0; i < count; i++)
        if (allowed(&c, &point[i])) nearest = fmin(nearest, off(&point[i], wish));
    c.far = fmax(nearest, BENCH_ALIKE);
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

static bool better(const BenchPoint *a, const BenchPoint *b)
{
    return a->path_rms < b->path_rms || (a->path_rms == b->path_rms && a->w < b->w);
}

static const BenchPoint *best_of(const Choice *c)
{
    const BenchPoint *cheapest = NULL;
    for (long i = 0; i < c->count; i++)
        if (allowed(c, &c->point[i]) && (!cheapest || cheaper(&c->point[i], cheapest)))
            cheapest = &c->point[i];
    const BenchPoint *best = cheapest;
    for (long i = 0; i < c->count; i++)
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

static const BenchEngine *planned(const BenchCampaign *sweep, int e)
{
    return bench_engine_planned(((const BenchPlan *)sweep->plan)->engines, e);
}

/* "octree w 1 and epsilon 0: 0.0245 ms a step of 370 nodes, a beam of 0.435 Hz that sags ..." */
static void say_figures(FILE *file, const char *before, const BenchPoint *p)
{
    char ms[BENCH_GRID_TEXT];
    bool tree = bench_engine(p->engine)->sampled;
    bench_grid_number(p->total_ms, ms);
    fprintf(file, "%s%s w %g", before, p->engine, p->w);
    if (tree) fprintf(file, " and epsilon %g", p->epsilon);
    fprintf(file, ": %s ms a step of %ld %s", ms, p->particles, tree ? "nodes" : "particles");
    if (p->parts > 1)
        fprintf(file, " in %ld parts that no region joins, as in all points", p->parts);
    fprintf(file, ", a beam of %.3g Hz that sags %.3g%% of its length, ", p->frequency,
            100 * p->sag);
    if (tree)
        fprintf(file, "the surface %.3g%% of the body's size off full resolution.\n",
                100 * p->path_rms);
    else
        fputs("itself full resolution.\n", file);
}

static void say_point(FILE *file, const BenchPlan *plan, const Choice *c, const BenchPoint *p)
{
    char command[3 * WORD];
    const BenchWish *wish = c->wish;
    fprintf(file, "For a beam of %.4g Hz", wish->stiffness);
    if (c->far > BENCH_ALIKE) fputs(" (nothing is within 10% of it)", file);
    if (!isnan(wish->deviation))
        fprintf(file, " and a deviation of at most %.4g%%", wish->deviation);
    if (!isnan(wish->budget)) fprintf(file, " and a step of at most %.4g ms", wish->budget);
    say_figures(file, " take ", p);
    bench_recommend_command(plan, p, sizeof command, command);
    fprintf(file, "  %s\n", command);
}

static void say_none(FILE *file, const Choice *c)
{
    double cheapest = INFINITY, least = INFINITY;
    for (long i = 0; i < c->count; i++) {
        if (!whole(c, &c->point[i])) continue;
        cheapest = fmin(cheapest, c->point[i].total_ms);
        least = fmin(least, c->point[i].path_rms);
    }
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
            isnan(c->wish->deviation) ? "" : " the deviation", cheapest, 100 * least);
}

/* From the least deviation on, each time what deviates least of what is cheaper. */
static void say_bought(FILE *file, const Choice *c)
{
    const BenchPoint *last = NULL;
    for (int n = 0; n < MOST_BOUGHT; n++) {
        const BenchPoint *next = NULL;
        for (long i = 0; i < c->count; i++) {
            const BenchPoint *p = &c->point[i];
            if (!fits(c, p) || (last && as_cheap(last, p))) continue;
            if (!next || p->path_rms < next->path_rms ||
                (p->path_rms == next->path_rms && cheaper(p, next)))
                next = p;
        }
        if (!next) break;
        fprintf(file, "%s%.3g%%: %.3g ms (w %g, epsilon %g)", n ? "; " : "  A deviation of ",
                100 * next->path_rms, next->total_ms, next->w, next->epsilon);
        last = next;
    }
    fputs(".\n", file);
}

static void say_apart(FILE *file, const Choice *c)
{
    int apart = 0;
    for (long i = 0; i < c->count; i++)
        apart += of_engine(c, &c->point[i]) && c->point[i].parts > c->parts;
    if (apart)
        fprintf(file,
                "%s: left out: %d point%s whose body falls apart; a w of 1 edge of each node's own "
                "cell holds together what touches.\n",
                c->engine, apart, apart == 1 ? "" : "s");
}

/* ---- the question */

/* In two digits, as the option has it. */
static double rounded(double hz)
{
    char text[32];
    snprintf(text, sizeof text, "%.1e", hz);
    return strtod(text, NULL);
}

/* The softest and the stiffest beam that all engines with an allowed point reach; where they share
 * none, what lies between; false: there is no such point. */
static bool find_range(const BenchCampaign *sweep, const BenchWish *wish, double *low, double *high)
{
    const BenchEngine *engine;
    double softest = 0, stiffest = INFINITY;
    for (int e = 0; (engine = planned(sweep, e)); e++) {
        Choice c = choose(sweep->point, sweep->count, engine->type[0]->name, wish);
        double least = INFINITY, most = 0;
        for (long i = 0; i < c.count; i++) {
            if (!allowed(&c, &c.point[i])) continue;
            least = fmin(least, c.point[i].frequency);
            most = fmax(most, c.point[i].frequency);
        }
        if (most > 0) softest = fmax(softest, least), stiffest = fmin(stiffest, most);
    }
    *low = rounded(fmin(softest, stiffest));
    *high = rounded(fmax(softest, stiffest));
    return isfinite(stiffest);
}

static void ask(FILE *file, const BenchCampaign *sweep, BenchWish wish)
{
    static const char *const names[] = {"soft", "middle", "stiff"};
    const BenchEngine *engine;
    double low, high;
    if (!find_range(sweep, &wish, &low, &high)) return;
    fputs("How stiff is the body to be? Pick one by its option, or any other frequency in Hz:\n",
          file);
    for (int k = 0; k < 3 && (k == 0 || low < high); k++) {
        wish.stiffness = k == 0 ? low : k == 1 ? rounded(sqrt(low * high)) : high;
        fprintf(file, "  %s: --stiffness %g\n", names[k], wish.stiffness);
        for (int e = 0; (engine = planned(sweep, e)); e++) {
            Choice c = choose(sweep->point, sweep->count, engine->type[0]->name, &wish);
            const BenchPoint *best = best_of(&c);
            if (best) say_figures(file, "    ", best);
        }
    }
}

void bench_recommend(FILE *file, const BenchCampaign *sweep, const BenchWish *wish)
{
    const BenchEngine *engine;
    bool asks = isnan(wish->stiffness);
    if (asks) ask(file, sweep, *wish);
    for (int e = 0; (engine = planned(sweep, e)); e++) {
        Choice c = choose(sweep->point, sweep->count, engine->type[0]->name, wish);
        const BenchPoint *best = best_of(&c);
        if (best && !asks) say_point(file, sweep->plan, &c, best);
        if (best && !asks && engine->sampled) say_bought(file, &c);
        if (!best) say_none(file, &c);
        if (best) say_apart(file, &c);
    }
}
