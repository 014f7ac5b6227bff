#include "parted.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/csr.h"
#include "../../lib/vector.h"
#include "../../reference/link.h"

static bool has(int (*sorted)[2], long count, const int pair[2])
{
    return count > 0 && bsearch(pair, sorted, (size_t)count, sizeof *sorted, sm_compare_pairs);
}

/* Neighbours at rest of which `is_parted` says so. */
static int (*pairs_that(const BenchBody *body, bool (*is_parted)(const void *of, const int pair[2]),
                        const void *of, long *count))[2]
{
    int(*pair)[2] = NULL;
    RefLinks links;
    long room = 0;
    *count = 0;
    ref_links_build(&body->voxels, NULL, 0, &links);
    for (int p = 0; p < links.count; p++)
        for (long n = links.start[p]; n < links.start[p + 1]; n++) {
            int at[2] = {p, links.neighbour[n]};
            if (at[1] < p || !is_parted(of, at)) continue;
            sm_make_room(pair, room, *count + 1);
            memcpy(pair[(*count)++], at, sizeof at);
        }
    ref_links_free(&links);
    return pair;
}

/* The engine's links, sorted. */
typedef struct {
    int (*link)[2];
    long count;
} Links;

static bool is_broken(const void *of, const int pair[2])
{
    const Links *left = of;
    return !has(left->link, left->count, pair);
}

int (*bench_parted(const BenchBody *body, const SmEngineType *type, SmEngine *engine,
                   long *count))[2]
{
    *count = 0;
    if (!type->links) return NULL;
    Links left = {.count = type->links(engine, NULL, 0)};
    left.link = sm_alloc((size_t)left.count, sizeof *left.link);
    type->links(engine, left.link, left.count);
    qsort(left.link, (size_t)left.count, sizeof *left.link, sm_compare_pairs);
    int(*pair)[2] = pairs_that(body, is_broken, &left, count);
    free(left.link);
    return pair;
}

static bool is_cut(const void *of, const int pair[2])
{
    const BenchBody *body = of;
    return sm_cut_crosses(body->cut, 0, body->x0[pair[0]], body->x0[pair[1]]);
}

long bench_parted_wrong(const BenchBody *body, long count, int (*pair)[2])
{
    long cut, both = 0;
    int(*parted)[2] = pairs_that(body, is_cut, body, &cut);
    for (long n = 0; n < count; n++) both += has(parted, cut, pair[n]);
    free(parted);
    return count + cut - 2 * both;
}

/* A step that may have broken links: of those that there were at its beginning, which were broken,
 * and where particles are at its end. */
typedef struct {
    int (*before)[2], (*after)[2];
    long broken, now;
    const double (*x0)[3], (*x)[3];
    double limit, doubt;
} Step;

static bool is_wrong(const void *of, const int pair[2])
{
    const Step *s = of;
    bool broken = has(s->after, s->now, pair);
    if (has(s->before, s->broken, pair)) return !broken;
    double rest = sm_square_between(s->x0[pair[0]], s->x0[pair[1]]);
    double stretch = sqrt(sm_square_between(s->x[pair[0]], s->x[pair[1]]) / rest) / s->limit;
    return broken ? stretch < 1 - s->doubt : stretch > 1 + s->doubt;
}

long bench_parted_step_wrong(BenchRunner *runner)
{
    const SmEngineType *type = runner->type;
    double(*x)[3] = sm_alloc((size_t)runner->particles, sizeof *x);
    long wrong;
    Step s = {.x0 = (const double(*)[3])runner->x0,
              .x = (const double(*)[3])x,
              .limit = runner->scene->params.strain_limit,
              .doubt = strcmp(type->precision, "single") == 0 ? 1e-4 : 1e-9};
    s.before = bench_parted(runner->body, type, runner->engine, &s.broken);
    bench_runner_step(runner);
    s.after = bench_parted(runner->body, type, runner->engine, &s.now);
    type->get(runner->engine, SM_POSITION, x);
    sm_free_all(pairs_that(runner->body, is_wrong, &s, &wrong), s.before, s.after, x);
    return wrong;
}
