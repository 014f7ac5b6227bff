#include "contact_check.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../octree/engine.h"
#include "../../octree/surface/outline.h"
#include "../../reference/brute_collide.h"
#include "../../reference/collision_lattice.h"
#include "../../reference/condition.h"

/* Both sides of the comparison. */
typedef struct {
    const BenchCheck *check;
    SmCollideRest rest;
    RefCollisionLattice lattice;
    OctOutline octree;
    RefCollide *twin;
    long all;           /* nodes of all bodies */
    double (*x)[3];     /* [all] cells */
    double (*turn)[9];  /* [all] of an octree's cells; or NULL */
    SmContact *contact; /* [count] the engine's, by particle, then cell */
    long count;
} Contacts;

static int compare(const void *a, const void *b)
{
    const SmContact *x = a, *y = b;
    if (x->particle != y->particle) return x->particle < y->particle ? -1 : 1;
    return (x->cell > y->cell) - (x->cell < y->cell);
}

static void describe(const SmEngine *engine, Contacts *c)
{
    const BenchCheck *check = c->check;
    if (check->hierarchical) {
        oct_outline_build(oct_engine_structure(engine), &c->octree);
        c->rest = c->octree.rest;
        return;
    }
    ref_collision_lattice_build(&check->body->voxels, (const int(*)[2])check->pair, check->parted,
                                &c->lattice);
    c->rest = c->lattice.rest;
}

static void begin(const BenchCheck *check, const BenchScene *scene, const SmEngineType *type,
                  SmEngine *engine, Contacts *c)
{
    long bodies = check->body->instances;
    *c = (Contacts){.check = check, .all = check->count * bodies};
    double(*x)[3] = sm_alloc((size_t)c->all, sizeof *x);
    c->x = sm_alloc((size_t)c->all, sizeof *c->x);
    if (check->hierarchical) c->turn = sm_alloc((size_t)c->all, sizeof *c->turn);
    describe(engine, c);
    type->get(engine, SM_POSITION, x);
    for (long first = 0; first < c->all; first += check->count)
        bench_check_cells(check, (const double(*)[3])(x + first), c->x + first);
    c->count = type->contacts(engine, c->turn, &c->contact);
    if (c->count) qsort(c->contact, (size_t)c->count, sizeof *c->contact, compare);
    c->twin = ref_collide_start(&c->rest, &scene->params.collide, bodies, (const double(*)[3])c->x,
                                (const double(*)[9])c->turn);
    free(x);
}

static void end(Contacts *c)
{
    ref_collide_free(c->twin);
    ref_collision_lattice_free(&c->lattice);
    oct_outline_free(&c->octree);
    free(c->x);
    free(c->turn);
    free(c->contact);
}

/* Marks every n-th of the nodes that `want` says, so that at most `most` are; returns how many. */
static long choose(const bool *want, long all, long most, bool *chosen)
{
    long wanted = 0, seen = 0, count = 0;
    for (long i = 0; i < all; i++) wanted += want[i];
    for (long i = 0; i < all; i++) {
        if (!want[i]) continue;
        bool next = wanted <= most || seen * most / wanted != (seen + 1) * most / wanted;
        seen++;
        if (!next) continue;
        count += !chosen[i];
        chosen[i] = true;
    }
    return count;
}

/* The nodes to compare, NULL of a body small enough for all: half of those that there is time for
 * from the engine's contacts, the others from all that may have some. */
static bool *sample(const Contacts *c, long *count)
{
    long cells = c->rest.cells * c->check->body->instances;
    long most = (long)fmax(BENCH_CONTACT_PAIRS / fmax(1, (double)cells), 64);
    bool *want = sm_alloc((size_t)c->all, sizeof *want);
    bool *chosen = sm_alloc((size_t)c->all, sizeof *chosen);
    for (long i = 0; i < c->count; i++) want[c->contact[i].particle] = true;
    *count = choose(want, c->all, most / 2, chosen);
    for (long i = 0; i < c->all; i++) want[i] = ref_collide_outer(c->twin, i);
    *count += choose(want, c->all, most - *count, chosen);
    free(want);
    return chosen;
}

/* Whether two contacts of the same node and cell are alike. */
static bool alike(const Contacts *c, const SmContact *found, const RefContact *exact)
{
    double slack = BENCH_CONTACT_TOLERANCE;
    bool same = fabs(found->depth / c->check->body->voxels.cell - exact->depth) <= slack;
    for (int d = 0; d < 3; d++) same &= fabs(found->out[d] - exact->out[d]) <= 10 * slack;
    for (int k = 0; k < c->rest.carriers; k++)
        same &= fabs(found->weight[k] - exact->weight[k]) <= slack;
    return same;
}

/* Whether rounding decides: were the node elsewhere by no more than the tolerance, also aslant, as
 * from a corner where faces meet, brute force would say of it and the cell what the engine does
 * (`found` NULL: no contact). */
static bool undecided(const Contacts *c, const SmContact *found, long number, long cell)
{
    for (int move = 0; move < 125; move++) {
        const int to[3] = {move % 5 - 2, move / 5 % 5 - 2, move / 25 - 2};
        double p[3];
        RefContact exact = {0};
        for (int d = 0; d < 3; d++)
            p[d] = c->x[number][d] + 0.125 * to[d] * BENCH_CONTACT_TOLERANCE;
        bool meet = ref_collide_at(c->twin, number, p, cell, &exact);
        if (found ? meet && alike(c, found, &exact) : !meet) return true;
    }
    return false;
}

/* The twin's number of a cell, or -1 where the engine has one that is none. */
static long cell_number(const Contacts *c, long particle)
{
    long count = c->rest.nodes, low = 0, high = c->rest.cells;
    while (low < high) { /* cells follow their first carriers */
        long middle = (low + high) / 2;
        if (c->rest.carrier[middle * c->rest.carriers] < particle % count)
            low = middle + 1;
        else
            high = middle;
    }
    bool known = low < c->rest.cells && c->rest.carrier[low * c->rest.carriers] == particle % count;
    return known ? particle / count * c->rest.cells + low : -1;
}

/* Compares one node's contacts: the engine's from `at` on, and the `count` of brute force. Returns
 * where the next node's begin. */
static long compare_node(const Contacts *c, long number, long at, const RefContact *exact,
                         long count, BenchDeviation *found)
{
    for (long next = 0;; found->contacts++) {
        const SmContact *engine =
            at < c->count && c->contact[at].particle == number ? &c->contact[at] : NULL;
        const RefContact *brute = next < count ? &exact[next] : NULL;
        if (!engine && !brute) return at;
        long cell = engine ? cell_number(c, engine->cell) : LONG_MAX;
        bool missing = brute && brute->cell < cell, extra = !brute || cell < brute->cell, fine;
        if (missing)
            fine = brute->beyond || undecided(c, NULL, number, brute->cell);
        else if (extra)
            fine = cell >= 0 && undecided(c, engine, number, cell);
        else
            fine = alike(c, engine, brute) || undecided(c, engine, number, cell);
        found->contacts_wrong += !fine;
        at += !missing;
        next += !extra;
    }
}

static void compare_contacts(const Contacts *c, BenchDeviation *found)
{
    RefContact *exact = NULL;
    long at = 0;
    bool *chosen = sample(c, &found->contact_nodes);
    for (long i = 0; i < c->all; i++) found->contact_all += ref_collide_outer(c->twin, i);
    for (long i = 0; i < c->count; i++)
        found->deepest = fmax(found->deepest, c->contact[i].depth / c->check->body->voxels.cell);
    for (long number = 0; number < c->all; number++) {
        while (at < c->count && c->contact[at].particle < number) at++;
        if (!chosen[number]) continue;
        long count = ref_collide_node(c->twin, number, &exact, 0);
        at = compare_node(c, number, at, exact, count, found);
    }
    free(chosen);
    free(exact);
}

/* Do a region's nodes lie on a line, or in one place? What it is turned by about that is up to its
 * past, and moves no goal. */
static bool is_line(const BenchCheck *check, long r, double negligible)
{
    const double(*rest)[3] = (const double(*)[3])check->rest;
    RefCondition found;
    ref_condition(bench_check_regions(check), check->weight, rest, rest, r, negligible, &found);
    return !(found.inertia > negligible * negligible);
}

/* How far an octree's cells are turned otherwise than their regions, where that is unique. */
static double turn_error(const Contacts *c, const SmEngineType *type, SmEngine *engine)
{
    const BenchCheck *check = c->check;
    double worst = 0, (*R)[9] = sm_alloc((size_t)c->all, sizeof *R);
    double(*x)[3] = sm_alloc((size_t)c->all, sizeof *x);
    bool *tied = sm_alloc((size_t)check->count, sizeof *tied);
    bool *line = sm_alloc((size_t)check->count, sizeof *line);
    double negligible = bench_check_tolerance(type->precision);
    for (long r = 0; r < check->count; r++) line[r] = is_line(check, r, negligible);
    type->get(engine, SM_POSITION, x);
    bench_check_turns(check, type, engine, (const double(*)[3])x, R);
    for (long first = 0; first < c->all; first += check->count) {
        bench_check_tied(check, type->precision, (const double(*)[3])(x + first), tied);
        for (long n = 0; n < 9 * check->count; n++) {
            double error = fabs(c->turn[first + n / 9][n % 9] - R[first + n / 9][n % 9]);
            if (!tied[n / 9] && !line[n / 9])
                worst = fmax(worst, isfinite(error) ? error : INFINITY);
        }
    }
    free(R);
    free(x);
    free(tied);
    free(line);
    return worst;
}

void bench_check_contacts(const BenchCheck *check, const BenchScene *scene,
                          const SmEngineType *type, SmEngine *engine, BenchDeviation *found)
{
    const SmCollideParams *collide = &scene->params.collide;
    Contacts c;
    if (!found->finite || check->samples ||
        !(collide->self || (collide->bodies && check->body->instances > 1)))
        return;
    type->goals(engine);
    begin(check, scene, type, engine, &c);
    if (check->hierarchical) found->turn_error = turn_error(&c, type, engine);
    compare_contacts(&c, found);
    end(&c);
}
