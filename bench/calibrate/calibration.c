#include "calibration.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../campaign/campaign_run.h"
#include "../check/runner_check.h"
#include "../engines.h"
#include "../table/records.h"
#include "cantilever.h"

#define FIELD(type, member)  BENCH_FIELD_AS(BenchCalibrationPlan, BENCH_##type, member, #member)
#define MEANS(of_what, what) BENCH_MEANS(of_what, what)
#define LIST(name, member, counter, least, low, high)                                              \
    {                                                                                              \
        name, "--" name, offsetof(BenchCalibrationPlan, member),                                   \
            offsetof(BenchCalibrationPlan, counter), least, BENCH_CALIBRATION_VALUES, low, high    \
    }

enum { SHORTEST = 3, MOST_ASPECT = 100 };

static const BenchField plan_fields[] = {
    {FIELD(TEXT, scene), MEANS(NULL, "whose beam it is")},
    {FIELD(TEXT, engines), MEANS(NULL, "\"both\", \"fastlsm\" or \"octree\"")},
    {FIELD(TEXT, build), MEANS(NULL, "as of a sweep")},
    {FIELD(INT, across), MEANS("cells", "through the scene's beam")},
    {FIELD(INT, aspect), MEANS(NULL, "its length over its thickness")},
    {FIELD(DOUBLE, thickness), MEANS("m", "of it")},
    {FIELD(DOUBLE, h), MEANS("s", "its time step")},
    {FIELD(DOUBLE, density), MEANS("kg/m^3", "of every specimen")},
    {FIELD(DOUBLE, poisson), MEANS(NULL, "Poisson's ratio taken for the elastic body")},
    {FIELD(DOUBLE, damping), MEANS(NULL, "share k of region damping")},
    {FIELD(BOOL, meshless),
     MEANS(NULL, "1: the meshless reference is there, otherwise theory stands alone")},
    {FIELD(INT, specimens), MEANS(NULL, "planned")},
    {FIELD(INT, ws), MEANS(NULL, "length of the list `w`")},
    {FIELD(INT, epsilons), MEANS(NULL, "of `epsilon`")},
    {FIELD(INT, acrosses), MEANS(NULL, "of `across`")},
    {FIELD(INT, aspects), MEANS(NULL, "of `aspect`")},
    {FIELD(INT, steps), MEANS(NULL, "of `step`")},
};

static const int plan_field_count = sizeof plan_fields / sizeof plan_fields[0];

static const BenchCampaignList lists[] = {
    LIST("w", w, ws, 1, 1, SM_MOST_W),
    LIST("epsilon", epsilon, epsilons, 1, 0, 4),
    LIST("across", other_across, acrosses, 0, 1, BENCH_MOST_ACROSS),
    LIST("aspect", other_aspect, aspects, 0, SHORTEST, MOST_ASPECT),
    LIST("step", step, steps, 0, 0.001, 1000),
};

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
    const BenchCalibrationPlan *plan;
    BenchSpecimen *specimen; /* of the index `wanted`, if any */
    int wanted, count;
} List;

static void use_settings(const BenchSpecimen *from, BenchSpecimen *to)
{
    for (int f = 0; f < bench_specimen_field_count; f++) {
        const BenchField *field = &bench_specimen_fields[f];
        if (field->given_by_plan)
            memcpy((char *)to + field->offset, (const char *)from + field->offset, field->size);
    }
}

/* One more, unless it is the scene's own. */
static void add(List *list, const BenchEngine *engine, int w, double epsilon, const char *set,
                double setting)
{
    const BenchCalibrationPlan *plan = list->plan;
    BenchSpecimen s = {0};
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
    if (list->count++ == list->wanted) use_settings(&s, list->specimen);
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

static void list_all(List *list)
{
    const BenchCalibrationPlan *plan = list->plan;
    for (int i = 0; i < plan->ws; i++) add_engines(list, (int)plan->w[i], true, "grid", 0);
    for (int a = 0; a < plan->acrosses; a++)
        for (int i = 0; i < plan->ws; i++)
            add_engines(list, (int)plan->w[i], false, "spacing", plan->other_across[a]);
    for (int a = 0; a < plan->aspects; a++) add_some(list, "aspect", plan->other_aspect[a]);
    for (int s = 0; s < plan->steps; s++) add_some(list, "step", plan->step[s]);
}

static SmCode count(void *record, SmError *error)
{
    BenchCalibrationPlan *plan = record;
    SmCode code = check_whole("--w", plan->w, plan->ws, error);
    if (!code) code = check_whole("--across", plan->other_across, plan->acrosses, error);
    if (!code) code = check_whole("--aspect", plan->other_aspect, plan->aspects, error);
    if (code) return code;
    List list = {plan, NULL, -1, 0};
    if (plan->across >= 1) list_all(&list);
    plan->specimens = list.count;
    if (list.count >= 1 && list.count <= BENCH_CALIBRATION_SPECIMENS) return SM_OK;
    return sm_fail(error, SM_USAGE, "the options make %d specimens; 1 to %d can be", list.count,
                   BENCH_CALIBRATION_SPECIMENS);
}

/* ---- what follows from them */

BenchConclusion bench_calibration_conclude(const BenchCampaign *calibration)
{
    const BenchCalibrationPlan *plan = calibration->plan;
    BenchConclusion c = {0};
    c.laws = bench_stiffness_fit(calibration->point, calibration->count, plan->thickness,
                                 plan->density, c.law);
    bench_recommendation_found(calibration->point, calibration->count, c.law, c.laws, c.found);
    return c;
}

static void write_laws(BenchH5 *h5, const BenchCampaign *calibration)
{
    BenchConclusion c = bench_calibration_conclude(calibration);
    hid_t group = bench_h5_group(h5, h5->file, "laws");
    bench_h5_columns(h5, group, bench_stiffness_fit_fields, bench_stiffness_fit_field_count, c.law,
                     sizeof *c.law, c.laws);
    for (int i = 0; i < BENCH_FOUND; i++) {
        char name[16];
        snprintf(name, sizeof name, "found_%d", i + 1);
        bench_h5_text(h5, group, name, c.found[i]);
    }
}

/* ---- how they are measured */

static void measure_beam(BenchClampedBeam *beam, bool range, BenchSpecimen *specimen)
{
    BenchStiffness found;
    specimen->particles = beam->runner.particles;
    bench_stiffness_measure(beam, &(BenchBeamTrial){BENCH_TONES, 5, 0}, &found);
    if (found.why[0]) {
        snprintf(specimen->reason, sizeof specimen->reason, "%s", found.why);
        return;
    }
    specimen->valid = bench_check_runner(&beam->runner, sizeof specimen->reason, specimen->reason);
    if (!specimen->valid) return;
    if (range) bench_stiffness_range(beam, &found);
    memcpy(specimen->frequency, found.frequency, sizeof found.frequency);
    memcpy(specimen->loss, found.loss, sizeof found.loss);
    specimen->load = found.load;
    specimen->sag = found.sag;
    specimen->unrest = found.unrest;
    specimen->linear_to = found.linear_to;
}

/* Measures a specimen that has its settings. What cannot be had is said in it. */
static void measure_specimen(const BenchCalibrationPlan *plan,
                             const BenchElasticCantilever elastic[BENCH_MODELS], bool range,
                             BenchSpecimen *specimen)
{
    BenchCantileverOptions options = {.w = specimen->w,
                                      .epsilon = specimen->epsilon,
                                      .damping = plan->damping,
                                      .across = specimen->across,
                                      .along = specimen->across * specimen->aspect,
                                      .root = (int)ceil(2 * specimen->w * (1 + specimen->epsilon)),
                                      .cell = specimen->spacing,
                                      .h = specimen->h,
                                      .density = plan->density};
    snprintf(options.engine, sizeof options.engine, "%s", specimen->engine);
    BenchCantilever *beam = sm_alloc(1, sizeof *beam);
    const SmEngineType *type;
    SmError error;
    SmCode code = bench_engine_find(options.engine, "double", &type, &error);
    if (!code) code = bench_cantilever_create(&options, type, beam, &error);
    if (code)
        snprintf(specimen->reason, sizeof specimen->reason, "%.*s",
                 (int)sizeof specimen->reason - 1, error.text);
    else
        measure_beam(&beam->beam, range, specimen);
    bench_cantilever_free(beam);
    free(beam);
    bench_specimen_judge(elastic, plan->thickness, plan->density, specimen);
}

/* What elastic beams of one aspect do, found when it is first asked for. */
typedef struct {
    int aspect;
    BenchElasticCantilever beam[BENCH_MODELS];
} Elastic;

static SmCode find_elastic(const BenchCalibrationPlan *plan, int aspect, Elastic *elastic,
                           SmError *error)
{
    if (elastic->aspect == aspect) return SM_OK;
    SmCode code = SM_OK;
    for (int m = 0; m < BENCH_MODELS && !code; m++)
        code = bench_elastic_cantilever((BenchModel)m, aspect, plan->poisson, &elastic->beam[m],
                                        error);
    elastic->aspect = code ? 0 : aspect;
    return code;
}

/* The scene's own beam at the first, middle and last w and the first epsilon: where the range is
 * looked for. */
static bool wants_range(const BenchCalibrationPlan *plan, const BenchSpecimen *s)
{
    bool some =
        s->w == plan->w[0] || s->w == plan->w[plan->ws / 2] || s->w == plan->w[plan->ws - 1];
    return some && !strcmp(s->set, "grid") &&
           (!bench_engine(s->engine)->sampled || s->epsilon == plan->epsilon[0]);
}

static SmCode begin(BenchCampaign *campaign, const BenchCampaignRun *run, void **work,
                    SmError *error)
{
    (void)campaign, (void)run, (void)error;
    *work = sm_alloc(1, sizeof(Elastic));
    return SM_OK;
}

static SmCode measure(void *work, const BenchCampaign *campaign, void *point, SmError *error)
{
    Elastic *elastic = work;
    const BenchCalibrationPlan *plan = campaign->plan;
    BenchSpecimen *s = point;
    SmCode code = find_elastic(plan, s->aspect, elastic, error);
    if (!code) measure_specimen(plan, elastic->beam, wants_range(plan, s), s);
    return code;
}

/* ---- its table */

enum { REASONS = 8 };

static void write_reasons(FILE *file, const BenchCampaign *calibration)
{
    int said = 0;
    for (long i = 0; i < calibration->count && said < REASONS; i++) {
        const BenchSpecimen *s = bench_campaign_at(calibration, i);
        if (s->valid) continue;
        fprintf(file, "  %s w %d epsilon %g is INVALID: %s\n", s->engine, s->w, s->epsilon,
                s->reason);
        said++;
    }
}

static void print_head(FILE *file, BenchFormat format, const BenchCampaign *calibration,
                       BenchGrid *grid)
{
    (void)grid;
    if (format != BENCH_AS_TEXT) return;
    const BenchCalibrationPlan *plan = calibration->plan;
    fprintf(file,
            "%s: Young's modulus at %g kg/m^3 of the elastic beam that behaves alike, %ld of %d "
            "specimens.\n%g thick, %d times as long, %d cells through; damping %g; Poisson's ratio "
            "taken as %g.\n\n",
            plan->scene, plan->density, calibration->count, plan->specimens, plan->thickness,
            plan->aspect, plan->across, plan->damping, plan->poisson);
}

static void write_legend(FILE *file, const BenchCalibrationPlan *plan)
{
    fprintf(
        file,
        "\nE: geometric mean of what the static sag and the first natural frequency of a clamped "
        "beam say, by the %s. by sag, by f1..f3: each alone; apart: the largest over the least.\n"
        "theory: by the sag, of Timoshenko's beam. regions: wide where 2 w + 1 particles are more "
        "than the beam is thick. loss factor: logarithmic decrement of the first mode / pi.\n"
        "linear to: largest of sags of 5, 10, 20, 40%% of the length in proportion to the load "
        "within 5%%; looked for at some.\n",
        plan->meshless ? "meshless reference"
                       : "theory of Timoshenko's beam (no meshless reference: built without its "
                         "libraries)");
}

static void print_tail(FILE *file, BenchFormat format, const BenchCampaign *calibration)
{
    BenchConclusion conclusion = bench_calibration_conclude(calibration);
    BenchGrid laws = bench_records_grid(bench_stiffness_fit_fields, bench_stiffness_fit_field_count,
                                        conclusion.law, sizeof *conclusion.law, conclusion.laws, 0);
    bool text = format == BENCH_AS_TEXT;
    if (text) write_legend(file, calibration->plan);
    if (text && laws.lines)
        fputs("\nLaw: E = " BENCH_STIFFNESS_LAW ", with 95% confidence intervals.\n\n", file);
    if (!text) fputc('\n', file);
    if (laws.lines) bench_grid_whole(file, &laws, bench_format_form(format));
    bench_grid_free(&laws);
    if (!text) return;
    fputc('\n', file);
    for (int i = 0; i < BENCH_FOUND; i++)
        if (conclusion.found[i][0]) fprintf(file, "%s\n", conclusion.found[i]);
    write_reasons(file, calibration);
}

static json_t *json_conclusion(const BenchCampaign *calibration)
{
    BenchConclusion conclusion = bench_calibration_conclude(calibration);
    json_t *object = json_object(), *found = json_array();
    json_object_set_new(object, "laws",
                        bench_json_records(bench_stiffness_fit_fields,
                                           bench_stiffness_fit_field_count, conclusion.law,
                                           sizeof *conclusion.law, conclusion.laws));
    for (int i = 0; i < BENCH_FOUND; i++)
        json_array_append_new(found, bench_json_text(conclusion.found[i]));
    json_object_set_new(object, "found", found);
    return object;
}

/* ---- the campaign */

static void plan_point(const void *plan, int index, void *point)
{
    list_all(&(List){plan, point, index, 0});
}

static void say(const void *point, size_t size, char *text)
{
    const BenchSpecimen *s = point;
    snprintf(text, size, "%s with w %d, epsilon %g, %d cells thick", s->engine, s->w, s->epsilon,
             s->across);
}

static const char *fault(const void *point)
{
    const BenchSpecimen *s = point;
    return s->valid ? NULL : s->reason;
}

const BenchCampaignType bench_calibration_type = {
    .command = "calibrate",
    .name = "calibration",
    .point = "specimen",
    .another = "another calibration",
    .schema = 1,
    .plan_size = sizeof(BenchCalibrationPlan),
    .point_size = sizeof(BenchSpecimen),
    .plan = plan_fields,
    .points = bench_specimen_fields,
    .plan_fields = &plan_field_count,
    .point_fields = &bench_specimen_field_count,
    .more = bench_stiffness_fit_fields,
    .more_fields = &bench_stiffness_fit_field_count,
    .more_name = "laws",
    .list = lists,
    .lists = sizeof lists / sizeof *lists,
    .planned = offsetof(BenchCalibrationPlan, specimens),
    .build = offsetof(BenchCalibrationPlan, build),
    .stamp = offsetof(BenchSpecimen, stamp),
    .count = count,
    .plan_point = plan_point,
    .write_plan = bench_campaign_write_sampled,
    .say = say,
    .fault = fault,
    .begin = begin,
    .measure = measure,
    .end = free,
    .write = write_laws,
    .head = print_head,
    .tail = print_tail,
    .more_json = json_conclusion,
};
