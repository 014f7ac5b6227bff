#include "elastic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/boundary.h"
#include "../../lib/vector.h"
#include "../play/runner.h"

#define CONST(array) ((const double(*)[3])(array))

static SmCode check(const BenchScene *scene, SmError *error)
{
    bool deformed = scene->bend != 0 || scene->twist != 0 || scene->squash != 0 || scene->kick != 0;
    const struct {
        bool there;
        const char *what;
    } beyond[] = {
        {scene->obstacle_count > 0, "obstacles"},
        {scene->force_count > 0, "'forces'"},
        {scene->cut_count > 0, "'cuts'"},
        {scene->touch_count > 0 || scene->view.level > 0, "'touches' or a 'view'"},
        {scene->params.collide.self || scene->params.collide.bodies, "'collide'"},
        {scene->instances > 1, "several instances"},
        {deformed, "'bend', 'twist', 'squash' or 'kick'"},
    };
    for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++)
        if (beyond[i].there)
            return sm_fail(error, SM_INPUT,
                           "%s: the frames of a meshless body are measured under handles and "
                           "gravity, and the scene has %s",
                           scene->file, beyond[i].what);
    if (scene->params.damping < 1) return SM_OK;
    return sm_fail(error, SM_INPUT, "%s: damping is 1, which stops a meshless body: give less",
                   scene->file);
}

/* Octants, nodes, covers and matrices of the points' field, whose covers reach all points. */
static SmCode make_body(const BenchScene *scene, const BenchBody *of, BenchElastic *elastic,
                        double (**shown)[3], long *count, SmError *error)
{
    RefMeshlessOptions options = bench_meshless_options(scene, of);
    elastic->material = options.material;
    RefMpu mpu;
    double start = sm_now();
    SmCode code = ref_meshless_field(&options, &mpu, error);
    if (code) return code;
    double built = sm_now();
    elastic->field_seconds = built - start;
    *count = mpu.points.count;
    *shown = sm_alloc((size_t)*count, sizeof **shown);
    memcpy(*shown, mpu.points.position, (size_t)*count * sizeof **shown);
    RefField field = ref_mpu_field(&mpu);
    RefBodyOptions body = {.nodes = options.nodes > 0 ? options.nodes : REF_MESHLESS_NODES,
                           .within = 0.01,
                           .coarser = options.uniform ? 0 : 1,
                           .basis = REF_MLS_LINEAR,
                           .material = options.material};
    code = ref_body_build(&field, &body, *count, CONST(*shown), &elastic->body, error);
    elastic->matrix_seconds = sm_now() - built;
    ref_mpu_free(&mpu);
    return code;
}

static SmCode make_motion(const BenchScene *scene, BenchElastic *elastic, SmError *error)
{
    double start = sm_now(), k = scene->params.damping;
    int wanted = scene->meshless.modes > 0 ? scene->meshless.modes : REF_MESHLESS_MODES;
    RefDamping damping = {k / (1 - k) / scene->params.h, scene->meshless.stiffness_damping};
    SmCode code = ref_modes_find(&elastic->body.matrices, NULL, wanted, &elastic->modes, error);
    if (code) return code;
    elastic->mode_seconds = sm_now() - start;
    ref_motion_create(&elastic->body, &elastic->modes, &damping, &elastic->motion);
    ref_motion_gravity(&elastic->body, scene->params.gravity, &elastic->motion);
    ref_motion_pose(&elastic->motion);
    return SM_OK;
}

/* The selected point that is nearest to the middle of all that are; false where none is. */
static bool find_held(const BenchSelect *select, const BenchBody *of, long count,
                      const double (*x)[3], double held[3])
{
    double middle[3] = {0}, least = INFINITY;
    long chosen = 0;
    for (long p = 0; p < count; p++) {
        if (!bench_select_has(select, of, x[p])) continue;
        for (int d = 0; d < 3; d++) middle[d] += x[p][d];
        chosen++;
    }
    for (int d = 0; d < 3 && chosen; d++) middle[d] /= (double)chosen;
    for (long p = 0; p < count; p++) {
        double away[3] = {x[p][0] - middle[0], x[p][1] - middle[1], x[p][2] - middle[2]};
        double square = sm_dot(away, away);
        if (square >= least || !bench_select_has(select, of, x[p])) continue;
        least = square;
        memcpy(held, x[p], sizeof middle);
    }
    return chosen > 0;
}

/* Two constraints a handle, position and orientation. */
static SmCode hold(const BenchBody *of, long count, const double (*x)[3], BenchElastic *elastic,
                   SmError *error)
{
    const BenchScene *scene = elastic->scene;
    elastic->held = sm_alloc((size_t)scene->handle_count, sizeof *elastic->held);
    for (int i = 0; i < scene->handle_count; i++) {
        double *held = elastic->held[i];
        if (!find_held(&scene->handle[i].select, of, count, x, held) ||
            ref_motion_hold(&elastic->body, REF_HOLD_POSITION, held, &elastic->motion) < 0)
            return sm_fail(error, SM_INPUT,
                           "%s: handle %d selects none of the body's points: enlarge its box or "
                           "sphere",
                           scene->file, i + 1);
        for (int other = 0; other < i; other++)
            if (!memcmp(elastic->held[other], held, sizeof elastic->held[other]))
                return sm_fail(error, SM_INPUT,
                               "%s: handles %d and %d bind the same point of the body: move one's "
                               "box or sphere",
                               scene->file, other + 1, i + 1);
        ref_motion_hold(&elastic->body, REF_HOLD_ROTATION, held, &elastic->motion);
    }
    return SM_OK;
}

SmCode bench_elastic_create(const BenchScene *scene, const BenchBody *of, BenchElastic *elastic,
                            SmError *error)
{
    double(*x)[3] = NULL;
    long count = 0;
    SmError why;
    *elastic = (BenchElastic){.scene = scene};
    SmCode code = check(scene, error);
    if (code) return code;
    code = make_body(scene, of, elastic, &x, &count, &why);
    if (!code) code = make_motion(scene, elastic, &why);
    if (code) sm_fail(error, code, "%s: %s", scene->file, why.text);
    if (!code) code = hold(of, count, CONST(x), elastic, error);
    if (!code) {
        double start = sm_now();
        ref_skin_create(&elastic->body, count, CONST(x), &elastic->skin, NULL);
        elastic->carried = sm_alloc((size_t)count, sizeof *elastic->carried);
        elastic->skin_seconds = sm_now() - start;
    }
    free(x);
    if (code) bench_elastic_free(elastic);
    return code;
}

void bench_elastic_free(BenchElastic *elastic)
{
    ref_motion_free(&elastic->motion);
    ref_modes_free(&elastic->modes);
    ref_skin_free(&elastic->skin);
    ref_body_free(&elastic->body);
    free(elastic->carried);
    free(elastic->held);
    *elastic = (BenchElastic){0};
}

/* The rotation vector of a pose, of less than half a turn. */
static void turn_of(const double pose[3][4], double turn[3])
{
    double twice[3] = {pose[2][1] - pose[1][2], pose[0][2] - pose[2][0], pose[1][0] - pose[0][1]};
    double s = hypot(hypot(twice[0], twice[1]), twice[2]) / 2;
    double c = (pose[0][0] + pose[1][1] + pose[2][2] - 1) / 2, angle = atan2(s, c);
    for (int d = 0; d < 3; d++) turn[d] = s > 0 ? twice[d] / 2 / s * angle : 0;
}

static void move_handles(BenchElastic *elastic)
{
    static const double here[3] = {0};
    for (int i = 0; i < elastic->scene->handle_count; i++) {
        double pose[3][4];
        RefHold *bound = elastic->motion.hold + 2 * i;
        bench_handle_pose(&elastic->scene->handle[i], elastic->time, here, pose);
        sm_pose_apply((const double(*)[4])pose, elastic->held[i], bound[0].target);
        for (int d = 0; d < 3; d++) bound[0].target[d] -= elastic->held[i][d];
        turn_of((const double(*)[4])pose, bound[1].target);
    }
}

void bench_elastic_step(BenchElastic *elastic, SmLaps *laps)
{
    elastic->time += elastic->scene->params.h;
    move_handles(elastic);
    ref_motion_step(&elastic->motion, elastic->scene->params.h);
    sm_lap(laps, SM_SHAPE_MATCHING);
    ref_skin_place(&elastic->skin, CONST(elastic->motion.moved), elastic->carried);
    sm_lap(laps, SM_OTHER);
}

long bench_elastic_bytes(const BenchElastic *elastic)
{
    size_t modes = (size_t)elastic->motion.modes, nodes = (size_t)elastic->motion.nodes;
    size_t bytes = nodes * (6 * modes + 12) * sizeof(double) +
                   (size_t)elastic->skin.count * 2 * sizeof(double[3]);
    for (long b = 0; b < elastic->skin.blocks; b++)
        bytes += (size_t)elastic->skin.block[b].nodes * (size_t)elastic->skin.block[b].room *
                 sizeof(float);
    return (long)bytes;
}
