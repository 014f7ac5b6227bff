#include "calibration.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../engines.h"
#include "../sweep/plan.h"

#define FIELD(kind, member) BENCH_FIELD(BenchCalibrationPlan, kind, member)

enum { SHORTEST = 3, MOST_ASPECT = 100 };

const BenchField *bench_calibration_fields(int *count)
{
    static const BenchField fields[] = {
        FIELD(BENCH_TEXT, scene),     FIELD(BENCH_TEXT, engines),   FIELD(BENCH_TEXT, build),
        FIELD(BENCH_INT, across),     FIELD(BENCH_INT, aspect),     FIELD(BENCH_DOUBLE, thickness),
        FIELD(BENCH_DOUBLE, h),       FIELD(BENCH_DOUBLE, density), FIELD(BENCH_DOUBLE, poisson),
        FIELD(BENCH_DOUBLE, damping), FIELD(BENCH_BOOL, meshless),  FIELD(BENCH_INT, specimens),
        FIELD(BENCH_INT, ws),         FIELD(BENCH_INT, epsilons),   FIELD(BENCH_INT, acrosses),
        FIELD(BENCH_INT, aspects),    FIELD(BENCH_INT, steps),
    };
    *count = (int)(sizeof fields / sizeof fields[0]);
    return fields;
}

/* ---- the beam */

/* Whether the mesh fills its box, whose axes are the longest one and two that are alike. */
static bool is_beam(const SmMeshInfo *info, double *length, double *thickness)
{
    double side[3], volume = 1;
    int longest = 0;
    for (int d = 0; d < 3; d++) {
        side[d] = info->high[d] - info->low[d];
        volume *= side[d];
        if (side[d] > side[longest]) longest = d;
    }
    double one = side[(longest + 1) % 3], other = side[(longest + 2) % 3];
    *length = side[longest];
    *thickness = sqrt(one * other);
    return fabs(one - other) < 1e-3 * one && fabs(info->volume / volume - 1) < 1e-3;
}

static SmCode find_beam(const BenchScene *scene, const BenchBody *body, BenchCalibrationPlan *plan,
                        SmError *error)
{
    SmMeshInfo info = sm_mesh_info(&body->mesh);
    double length, thickness;
    bool beam = is_beam(&info, &length, &thickness);
    double aspect = rint(length / thickness), across = rint(thickness / body->voxels.cell);
    if (!beam || !(aspect >= SHORTEST && aspect <= MOST_ASPECT))
        return sm_fail(
            error, SM_INPUT,
            "%.200s: its body is no beam, which fills its box and is square, and %d to %d "
            "times as long as thick: take the scene 'beam', or one of such a mesh",
            scene->file, SHORTEST, MOST_ASPECT);
    if (!(across >= 1 && across <= BENCH_MOST_ACROSS))
        return sm_fail(error, SM_INPUT, "%.200s: its beam is %g cells thick; 1 to %d can be",
                       scene->file, across, BENCH_MOST_ACROSS);
    snprintf(plan->scene, sizeof plan->scene, "%s", scene->name);
    plan->thickness = thickness;
    plan->aspect = (int)aspect;
    plan->across = (int)across;
    plan->h = scene->params.h;
    return SM_OK;
}

SmCode bench_calibration_beam(BenchCalibrationPlan *plan, SmError *error)
{
    BenchScene *scene = sm_alloc(1, sizeof *scene);
    BenchBody body = {0};
    SmCode code = bench_scene_find(plan->file, scene, error);
    if (!code) code = bench_body_of_scene(scene, NULL, &body, error);
    if (!code) code = find_beam(scene, &body, plan, error);
    bench_body_free(&body);
    free(scene);
    return code;
}

/* ---- its specimens */

typedef struct {
    BenchCalibrationPlan *plan;
    BenchSpecimen *specimen; /* or NULL */
    int count;
} List;

/* One more, unless it is the scene's own. */
static void add(List *list, const BenchEngine *engine, int w, double epsilon, const char *set,
                double setting)
{
    const BenchCalibrationPlan *plan = list->plan;
    BenchSpecimen s = bench_specimen_none();
    s.index = list->count;
    snprintf(s.engine, sizeof s.engine, "%s", engine->type[0]->name);
    snprintf(s.set, sizeof s.set, "%s", set);
    s.w = w;
    s.epsilon = engine->sampled ? epsilon : 0;
    s.across = !strcmp(set, "spacing") ? (int)setting : plan->across;
    s.aspect = !strcmp(set, "aspect") ? (int)setting : plan->aspect;
    s.h = !strcmp(set, "step") ? setting * plan->h : plan->h;
    s.spacing = plan->thickness / s.across;
    s.wide = 2 * w + 1 > s.across + engine->type[0]->by_cells;
    if (strcmp(set, "grid") != 0 && s.across == plan->across && s.aspect == plan->aspect &&
        s.h == plan->h)
        return;
    if (list->specimen && list->count < BENCH_CALIBRATION_SPECIMENS)
        list->specimen[list->count] = s;
    list->count++;
}

static void add_engines(List *list, int w, bool all, const char *set, double setting)
{
    const BenchCalibrationPlan *plan = list->plan;
    const BenchEngine *engine;
    for (int i = 0; (engine = bench_engine_planned(plan->engines, i)); i++)
        for (int e = 0; e < (all && engine->sampled ? plan->epsilons : 1); e++)
            add(list, engine, w, plan->epsilon[e], set, setting);
}

/* The first, middle and last w. */
static void add_some(List *list, const char *set, double setting)
{
    const BenchCalibrationPlan *plan = list->plan;
    const int some[] = {0, plan->ws / 2, plan->ws - 1};
    for (int i = 0; i < 3; i++)
        if (i == 0 || some[i] != some[i - 1])
            add_engines(list, (int)plan->w[some[i]], false, set, setting);
}

static SmCode check_whole(const char *name, const double *value, int count, SmError *error)
{
    for (int i = 0; i < count; i++)
        if (value[i] != floor(value[i]))
            return sm_fail(error, SM_USAGE, "%s: %g is no whole number", name, value[i]);
    return SM_OK;
}

SmCode bench_calibration_plan(BenchCalibrationPlan *plan, BenchSpecimen *specimen, SmError *error)
{
    SmCode code = check_whole("--w", plan->w, plan->ws, error);
    if (!code) code = check_whole("--across", plan->other_across, plan->acrosses, error);
    if (!code) code = check_whole("--aspect", plan->other_aspect, plan->aspects, error);
    if (code) return code;
    List list = {plan, specimen, 0};
    for (int i = 0; i < plan->ws; i++) add_engines(&list, (int)plan->w[i], true, "grid", 0);
    for (int a = 0; a < plan->acrosses; a++)
        for (int i = 0; i < plan->ws; i++)
            add_engines(&list, (int)plan->w[i], false, "spacing", plan->other_across[a]);
    for (int a = 0; a < plan->aspects; a++) add_some(&list, "aspect", plan->other_aspect[a]);
    for (int s = 0; s < plan->steps; s++) add_some(&list, "step", plan->step[s]);
    plan->specimens = list.count;
    if (list.count >= 1 && list.count <= BENCH_CALIBRATION_SPECIMENS) return SM_OK;
    return sm_fail(error, SM_USAGE, "the options make %d specimens; 1 to %d can be", list.count,
                   BENCH_CALIBRATION_SPECIMENS);
}

void bench_calibration_lists(BenchCalibrationPlan *plan,
                             BenchCalibrationList list[BENCH_CALIBRATION_LISTS])
{
    const BenchCalibrationList all[BENCH_CALIBRATION_LISTS] = {
        {"w", "--w", 1, SM_MOST_W, plan->w, &plan->ws},
        {"epsilon", "--epsilon", 0, 4, plan->epsilon, &plan->epsilons},
        {"across", "--across", 1, BENCH_MOST_ACROSS, plan->other_across, &plan->acrosses},
        {"aspect", "--aspect", SHORTEST, MOST_ASPECT, plan->other_aspect, &plan->aspects},
        {"step", "--step", 0.001, 1000, plan->step, &plan->steps},
    };
    memcpy(list, all, sizeof all);
}

bool bench_calibration_same(const BenchCalibrationPlan *mine, const BenchCalibrationPlan *theirs,
                            size_t size, char *what)
{
    int count;
    BenchCalibrationPlan one = *mine, other = *theirs;
    BenchCalibrationList my[BENCH_CALIBRATION_LISTS], their[BENCH_CALIBRATION_LISTS];
    bench_calibration_lists(&one, my);
    bench_calibration_lists(&other, their);
    for (int l = 0; l < BENCH_CALIBRATION_LISTS; l++)
        if (!bench_plan_numbers_same(my[l].name, my[l].value, *my[l].count, their[l].value,
                                     *their[l].count, size, what))
            return false;
    const BenchField *fields = bench_calibration_fields(&count);
    return bench_plan_fields_same(fields, count, mine, theirs, size, what);
}

void bench_calibration_add(BenchCalibration *calibration, const BenchSpecimen *specimen)
{
    long place = calibration->count++;
    calibration->specimen = sm_realloc(calibration->specimen, (size_t)calibration->count,
                                       sizeof *calibration->specimen);
    for (; place > 0 && calibration->specimen[place - 1].index > specimen->index; place--)
        calibration->specimen[place] = calibration->specimen[place - 1];
    calibration->specimen[place] = *specimen;
    bench_calibration_conclude(calibration);
}

void bench_calibration_conclude(BenchCalibration *calibration)
{
    const BenchCalibrationPlan *plan = &calibration->plan;
    calibration->laws = bench_law_fit(calibration->specimen, calibration->count, plan->thickness,
                                      plan->density, calibration->law);
    bench_advice_found(calibration->specimen, calibration->count, calibration->law,
                       calibration->laws, calibration->found);
}

void bench_calibration_free(BenchCalibration *calibration)
{
    free(calibration->specimen);
    memset(calibration, 0, sizeof *calibration);
}
