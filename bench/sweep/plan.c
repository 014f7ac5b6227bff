#include "plan.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/system/hash.h"
#include "../engines.h"
#include "../scene/body.h"

#define FIELD(kind, member) BENCH_FIELD(BenchPlan, kind, member)

const BenchField *bench_plan_fields(int *count)
{
    static const BenchField fields[] = {
        FIELD(BENCH_TEXT, scene),      FIELD(BENCH_TEXT, mesh),      FIELD(BENCH_TEXT, engines),
        FIELD(BENCH_TEXT, precision),  FIELD(BENCH_TEXT, width),     FIELD(BENCH_TEXT, build),
        FIELD(BENCH_HASH, scene_hash), FIELD(BENCH_HASH, mesh_hash), FIELD(BENCH_INT, repeats),
        FIELD(BENCH_DOUBLE, block_ms), FIELD(BENCH_INT, frames),     FIELD(BENCH_INT, steps),
        FIELD(BENCH_INT, threads),     FIELD(BENCH_LONG, seed),      FIELD(BENCH_DOUBLE, size),
        FIELD(BENCH_DOUBLE, cell),     FIELD(BENCH_INT, points),     FIELD(BENCH_INT, ws),
        FIELD(BENCH_INT, epsilons),
    };
    *count = (int)(sizeof fields / sizeof fields[0]);
    return fields;
}

/* Points of one w and engine. */
static int points_of(const BenchPlan *plan, const BenchEngine *engine)
{
    return engine->sampled ? plan->epsilons : 1;
}

/* Points of one w. */
static int points_of_w(const BenchPlan *plan)
{
    const BenchEngine *engine;
    int points = 0;
    for (int e = 0; (engine = bench_engine_planned(plan->engines, e)); e++)
        points += points_of(plan, engine);
    return points;
}

static SmCode check_w(const BenchPlan *plan, const SmEngineType *type, SmError *error)
{
    for (int i = 0; i < plan->ws && type->by_cells; i++)
        if (plan->w[i] != floor(plan->w[i]) || plan->w[i] > SM_MOST_W)
            return sm_fail(error, SM_USAGE,
                           "--w: %g is no half-width of %s, which are whole numbers from 1 to "
                           "%d; give --engine octree to sweep that alone",
                           plan->w[i], type->name, SM_MOST_W);
    return SM_OK;
}

SmCode bench_plan_count(BenchPlan *plan, SmError *error)
{
    const BenchEngine *engine;
    for (int e = 0; (engine = bench_engine_planned(plan->engines, e)); e++) {
        SmCode code = check_w(plan, engine->type[0], error);
        if (code) return code;
    }
    long points = (long)plan->ws * points_of_w(plan);
    if (points < 1) return sm_fail(error, SM_USAGE, "no points: no engine '%.11s'", plan->engines);
    if (points > BENCH_PLAN_POINTS)
        return sm_fail(error, SM_USAGE,
                       "--w and --epsilon make %ld points, and a sweep has %d at most: take larger "
                       "steps, or several files",
                       points, BENCH_PLAN_POINTS);
    plan->points = (int)points;
    return SM_OK;
}

bool bench_plan_alone(const BenchPlan *plan)
{
    char name[BENCH_NAME];
    bench_mesh_name(plan->mesh, name);
    return plan->mesh[0] && !plan->file[0] && !strcmp(name, plan->scene);
}

void bench_plan_point(const BenchPlan *plan, int index, BenchPoint *point)
{
    int each = points_of_w(plan);
    assert(each > 0); /* bench_plan_count() has seen to it */
    int rest = index % each;
    const BenchEngine *engine = bench_engine_planned(plan->engines, 0);
    for (int e = 1; rest >= points_of(plan, engine); e++) {
        rest -= points_of(plan, engine);
        engine = bench_engine_planned(plan->engines, e);
    }
    point->index = index;
    point->w = plan->w[index / each];
    point->epsilon = engine->sampled ? plan->epsilon[rest] : 0;
    snprintf(point->engine, sizeof point->engine, "%s", engine->type[0]->name);
}

static void say_numbers(const char *name, const double *mine, int my_count, const double *theirs,
                        int their_count, size_t size, char *what)
{
    snprintf(what, size, "its %s is %d numbers from %g to %g, and here %d from %g to %g", name,
             their_count, their_count ? theirs[0] : NAN,
             their_count ? theirs[their_count - 1] : NAN, my_count, my_count ? mine[0] : NAN,
             my_count ? mine[my_count - 1] : NAN);
}

static void say_field(const BenchField *field, const void *mine, const void *theirs, size_t size,
                      char *what)
{
    switch (field->kind) {
    case BENCH_TEXT:
        snprintf(what, size, "its %s is '%.90s', and here '%.90s'", field->name,
                 (const char *)theirs, (const char *)mine);
        break;
    case BENCH_DOUBLE:
        snprintf(what, size, "its %s is %g, and here %g", field->name, *(const double *)theirs,
                 *(const double *)mine);
        break;
    case BENCH_INT:
        snprintf(what, size, "its %s is %d, and here %d", field->name, *(const int *)theirs,
                 *(const int *)mine);
        break;
    case BENCH_LONG:
        snprintf(what, size, "its %s is %ld, and here %ld", field->name, *(const long *)theirs,
                 *(const long *)mine);
        break;
    case BENCH_HASH:
    case BENCH_BOOL:
        snprintf(what, size, "its %s differs: the %s has changed", field->name,
                 strcmp(field->name, "mesh_hash") != 0 ? "scene" : "mesh");
        break;
    }
}

bool bench_plan_numbers_same(const char *name, const double *mine, int my_count,
                             const double *theirs, int their_count, size_t size, char *what)
{
    bool same = my_count == their_count && !memcmp(mine, theirs, sizeof *mine * (size_t)my_count);
    if (!same) say_numbers(name, mine, my_count, theirs, their_count, size, what);
    return same;
}

bool bench_plan_fields_same(const BenchField *fields, int count, const void *mine,
                            const void *theirs, size_t size, char *what)
{
    for (int f = 0; f < count; f++) {
        const BenchField *field = &fields[f];
        const char *a = (const char *)mine + field->offset,
                   *b = (const char *)theirs + field->offset;
        bool text = field->kind == BENCH_TEXT;
        /* where a mesh lies is not what it is */
        if (!strcmp(field->name, "mesh")) continue;
        if (text ? !strcmp(a, b) : !memcmp(a, b, field->size)) continue;
        say_field(field, a, b, size, what);
        return false;
    }
    return true;
}

bool bench_plan_same(const BenchPlan *mine, const BenchPlan *theirs, size_t size, char *what)
{
    int count;
    const BenchField *fields = bench_plan_fields(&count);
    return bench_plan_numbers_same("w", mine->w, mine->ws, theirs->w, theirs->ws, size, what) &&
           bench_plan_numbers_same("epsilon", mine->epsilon, mine->epsilons, theirs->epsilon,
                                   theirs->epsilons, size, what) &&
           bench_plan_fields_same(fields, count, mine, theirs, size, what);
}

/* Of this program's file; 0 if it cannot be read. */
static unsigned long long hash_program(void)
{
    FILE *file = fopen("/proc/self/exe", "rbe");
    if (!file) return 0;
    unsigned long long hash = SM_HASH_START;
    char *bytes = sm_alloc(1 << 16, 1);
    for (size_t got; (got = fread(bytes, 1, 1 << 16, file)) > 0;)
        hash = sm_hash_bytes(hash, bytes, got);
    fclose(file);
    free(bytes);
    return hash;
}

void bench_plan_build(const BenchMachine *machine, size_t size, char *build)
{
    char changed[32] = "";
    if (machine->git_dirty) snprintf(changed, sizeof changed, " changed %016llx", hash_program());
    snprintf(build, size, "%s %.16s%s, %s %s", machine->version, machine->git_commit, changed,
             machine->compiler, machine->flags);
}
