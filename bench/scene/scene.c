#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../../lib/printable.h"
#include "../../lib/system/hash.h"
#include "../../reference/meshless/surface/points.h"
#include "../engines.h"
#include "../settings/config_file.h"
#include "../system/suggest.h"
#include "builtin.h"

enum { BUILTIN_MAX = 64 };

void bench_scene_init(BenchScene *scene)
{
    memset(scene, 0, sizeof *scene);
    strcpy(scene->engine, bench_engine_names()[0]);
    scene->meshless.material = (RefMaterial){.young = 1e5, .poisson = 0.3, .density = 1000};
    scene->metre = 1;
    scene->params.w = 2;
    scene->params.h = 0.01;
    scene->params.damping_every = 1;
    scene->instances = 1;
    scene->spacing = 1.5;
    scene->steps_per_frame = 4;
    scene->frames = 100;
    scene->settle = BENCH_SETTLE_STEPS;
}

/* ---- what settings must say beyond each one's own range */

static SmCode check_selection(BenchSelect *select, const char *what, int number,
                              const BenchScene *scene, SmError *error)
{
    select->sphere = select->radius > 0;
    if (select->sphere) return SM_OK;
    for (int d = 0; d < 3; d++)
        if (!(select->high[d] > select->low[d]))
            return sm_fail(error, SM_INPUT,
                           "%s: %s %d selects nothing: it needs 'box_low' below 'box_high', or "
                           "'sphere_centre' and 'sphere_radius'",
                           scene->file, what, number);
    return SM_OK;
}

static bool any(const double v[3])
{
    return v[0] != 0 || v[1] != 0 || v[2] != 0;
}

/* Places and widths that would not be looked at, and plasticity without its rate: mistakes, not to
 * be passed over. */
static SmCode check_octree(const BenchScene *scene, SmError *error)
{
    const OctOptions *o = &scene->octree;
    for (int i = 0; i < o->sampling.criteria_count; i++) {
        const OctCriterion *c = &o->sampling.criteria[i];
        if ((c->kind != OCT_BOX && (any(c->low) || any(c->high))) ||
            (c->kind != OCT_SPHERE && (any(c->centre) || c->radius > 0)))
            return sm_fail(error, SM_INPUT,
                           "%s: criterion %d: 'low' and 'high' are of the kind \"box\", 'centre' "
                           "and 'radius' of \"sphere\"",
                           scene->file, i + 1);
    }
    for (int i = 0; i < o->local_count; i++)
        if ((any(o->local[i].low) || any(o->local[i].high)) && o->local[i].radius > 0)
            return sm_fail(
                error, SM_INPUT,
                "%s: width %d has a box and a sphere: give 'low' and 'high', or 'centre' "
                "and 'radius'",
                scene->file, i + 1);
    if (o->summation_nodes > 0 && (o->width.cells > 0 || o->width.edges > 0))
        return sm_fail(error, SM_INPUT,
                       "%s: the width is searched for 'summation_nodes', or given by 'w' and "
                       "'edges': not both",
                       scene->file);
    if ((o->yield > 0 || o->most > 0) && !(o->creep > 0))
        return sm_fail(error, SM_INPUT,
                       "%s: 'yield' and 'most' are a plastic body's: give 'creep' too, in 1/s",
                       scene->file);
    return SM_OK;
}

/* Cuts, touches and an eye that would change nothing: mistakes too. */
static SmCode check_changes(BenchScene *scene, SmError *error)
{
    for (int i = 0; i < scene->cut_count; i++) {
        BenchCut *cut = &scene->cut[i];
        if (!(cut->stop > cut->start))
            return sm_fail(error, SM_INPUT,
                           "%s: cut %d ends before it begins: give a 'stop' after "
                           "its 'start'",
                           scene->file, i + 1);
        if (cut->reach == 0) cut->reach = 1;
    }
    if ((scene->cut_count > 0 || scene->view.level > 0) && scene->instances > 1)
        return sm_fail(error, SM_INPUT,
                       "%s: 'cuts' and 'view' are of a body alone, and here are %ld instances; of "
                       "those, 'touches' names one",
                       scene->file, scene->instances);
    for (int i = 0; i < scene->touch_count; i++) {
        BenchTouch *touch = &scene->touch[i];
        if (touch->instance == 0) touch->instance = 1;
        if (!(touch->radius > 0) || touch->level == 0)
            return sm_fail(error, SM_INPUT, "%s: touch %d needs a 'radius' and a 'level'",
                           scene->file, i + 1);
        if (touch->instance > scene->instances)
            return sm_fail(error, SM_INPUT, "%s: touch %d is on instance %ld, and there are %ld",
                           scene->file, i + 1, touch->instance, scene->instances);
    }
    if (scene->view.level > 0 && !(scene->view.near > 0))
        return sm_fail(error, SM_INPUT, "%s: 'view' needs 'near', a distance above 0", scene->file);
    return SM_OK;
}

static SmCode check_handle(BenchHandle *handle, int number, const BenchScene *scene, SmError *error)
{
    SmCode code = check_selection(&handle->select, "handle", number, scene, error);
    double length = hypot(hypot(handle->axis[0], handle->axis[1]), handle->axis[2]);
    bool turns = handle->rate != 0 || (handle->amplitude != 0 && handle->period > 0);
    if (!code && turns && !(length > 0))
        code =
            sm_fail(error, SM_INPUT, "%s: handle %d turns but has no 'axis'", scene->file, number);
    for (int d = 0; d < 3 && length > 0; d++) handle->axis[d] /= length;
    return code;
}

/* Refuses what is missing, contradicts itself, or would be passed over in silence, and completes
 * the rest: axes get unit length, what has a default of its own gets it. */
static SmCode check_scene(BenchScene *scene, SmError *error)
{
    if (!scene->mesh[0])
        return sm_fail(error, SM_INPUT, "%s: no 'mesh': give \"shape:NAME\" or a mesh file's path",
                       scene->file);
    if ((scene->voxel.particles > 0) + (scene->voxel.cell > 0) + (scene->cells > 0) != 1)
        return sm_fail(error, SM_INPUT, "%s: give one of 'particles', 'cell' and 'cells'",
                       scene->file);
    SmCode code = check_octree(scene, error);
    if (!code) code = check_changes(scene, error);
    for (int i = 0; i < scene->handle_count && !code; i++)
        code = check_handle(&scene->handle[i], i + 1, scene, error);
    for (int i = 0; i < scene->force_count && !code; i++)
        code = check_selection(&scene->force[i].select, "force", i + 1, scene, error);
    return code;
}

static SmCode add_obstacles(BenchScene *scene, const SmObstacle *items, int count,
                            SmObstacleKind kind, SmError *error)
{
    if (scene->obstacle_count + count > BENCH_MAX)
        return sm_fail(error, SM_INPUT, "%s: more than %d planes, spheres, boxes and capsules",
                       scene->file, BENCH_MAX);
    for (int i = 0; i < count; i++) {
        SmObstacle *obstacle = &scene->obstacle[scene->obstacle_count++];
        *obstacle = items[i];
        obstacle->kind = kind;
        if (kind != SM_PLANE) continue;
        double *n = obstacle->b, length = hypot(hypot(n[0], n[1]), n[2]);
        if (!(length > 0))
            return sm_fail(error, SM_INPUT, "%s: plane %d needs a 'normal' that is not zero",
                           scene->file, i + 1);
        for (int d = 0; d < 3; d++) n[d] /= length;
    }
    return SM_OK;
}

static SmCode check(BenchSceneFile *read, SmError *error)
{
    BenchScene *scene = &read->scene;
    SmCode code = check_scene(scene, error);
    if (!code) code = add_obstacles(scene, read->plane, read->planes, SM_PLANE, error);
    if (!code) code = add_obstacles(scene, read->ball, read->balls, SM_SPHERE, error);
    if (!code) code = add_obstacles(scene, read->box, read->boxes, SM_BOX, error);
    if (!code) code = add_obstacles(scene, read->capsule, read->capsules, SM_CAPSULE, error);
    return code;
}

/* ---- files */

/* "dir/penguin.cfg" names the scene "penguin". */
static void name_scene(BenchScene *scene, const char *file)
{
    const char *slash = strrchr(file, '/');
    snprintf(scene->file, sizeof scene->file, "%s", file);
    snprintf(scene->name, sizeof scene->name, "%.*s", BENCH_NAME - 1, slash ? slash + 1 : file);
    char *dot = strrchr(scene->name, '.');
    if (dot && dot != scene->name) *dot = '\0';
    sm_printable(scene->name);
}

SmCode bench_scene_parse(const char *text, size_t size, const char *file, BenchScene *scene,
                         SmError *error)
{
    config_t config;
    SmCode code = bench_config_parse(text, size, file, "scene", &config, error);
    if (code) return code;
    BenchSceneFile *read = sm_alloc(1, sizeof *read);
    bench_scene_init(&read->scene);
    name_scene(&read->scene, file);
    code =
        bench_settings_read(config_root_setting(&config), bench_scene_settings, read, file, error);
    config_destroy(&config);
    if (!code) code = check(read, error);
    if (!code) *scene = read->scene;
    free(read);
    return code;
}

void bench_scene_said(const BenchScene *scene, size_t size, char *text)
{
    BenchSceneFile *said = sm_alloc(1, sizeof *said), *usual = sm_alloc(1, sizeof *usual);
    SmObstacle *const of[] = {said->plane, said->ball, said->box, said->capsule};
    int *const count[] = {&said->planes, &said->balls, &said->boxes, &said->capsules};
    char *all;
    size_t length;
    FILE *file = open_memstream(&all, &length);
    bench_scene_init(&usual->scene);
    said->scene = *scene;
    for (int i = 0; i < scene->obstacle_count; i++) {
        SmObstacleKind kind = scene->obstacle[i].kind;
        of[kind][(*count[kind])++] = scene->obstacle[i];
    }
    char *const elsewhere[] = {said->scene.title, said->scene.paper, said->scene.row,
                               said->scene.mesh, said->scene.vertex_mass};
    for (int i = 0; i < 5; i++) *elsewhere[i] = '\0';
    bench_settings_said(file, bench_scene_settings, "", said, usual);
    fclose(file);
    if (length >= size)
        snprintf(all + size - 32, 32, "; all = %016llx; ",
                 sm_hash_bytes(SM_HASH_START, all, length));
    strcpy(text, all);
    free(all);
    sm_free_all(said, usual);
}

/* A mesh or mass path in a scene file is relative to that file. */
static SmCode resolve(char path[BENCH_PATH], const char *file, SmError *error)
{
    const char *slash = strrchr(file, '/');
    if (!slash || !path[0] || path[0] == '/' || !strncmp(path, "shape:", 6)) return SM_OK;
    char joined[2 * BENCH_PATH];
    snprintf(joined, sizeof joined, "%.*s/%s", (int)(slash - file), file, path);
    if (strlen(joined) >= BENCH_PATH)
        return sm_fail(error, SM_INPUT, "%s: the path '%.100s' is too long", file, path);
    strcpy(path, joined);
    return SM_OK;
}

SmCode bench_scene_read(const char *path, BenchScene *scene, SmError *error)
{
    size_t size = 0;
    if (strlen(path) >= BENCH_PATH)
        return sm_fail(error, SM_INPUT, "%.100s...: the path is too long", path);
    char *text = bench_config_load(path, &size, error);
    if (!text) return SM_INPUT;
    SmCode code = bench_scene_parse(text, size, path, scene, error);
    free(text);
    if (!code) code = resolve(scene->mesh, path, error);
    if (!code) code = resolve(scene->vertex_mass, path, error);
    return code;
}

const char *bench_scene_text(const char *name, size_t *size)
{
    for (const BenchBuiltin *scene = bench_builtin; scene->name; scene++)
        if (!strcmp(scene->name, name)) {
            if (size) *size = strlen(scene->text);
            return scene->text;
        }
    return NULL;
}

bool bench_scene_is_file(const char *path)
{
    size_t length = strlen(path);
    return length > 4 && !strcmp(path + length - 4, ".cfg");
}

bool bench_scene_named(const char *name_or_path)
{
    return bench_scene_is_file(name_or_path) ||
           (!strpbrk(name_or_path, "./") && strncmp(name_or_path, "shape:", 6) != 0);
}

SmCode bench_scene_find(const char *name_or_path, BenchScene *scene, SmError *error)
{
    size_t size;
    const char *text = bench_scene_text(name_or_path, &size);
    if (text) {
        char file[BENCH_NAME + 8];
        snprintf(file, sizeof file, "%s.cfg", name_or_path);
        return bench_scene_parse(text, size, file, scene, error);
    }
    if (strchr(name_or_path, '/') || bench_scene_is_file(name_or_path))
        return bench_scene_read(name_or_path, scene, error);
    if (access(name_or_path, F_OK) == 0)
        return sm_fail(error, SM_USAGE,
                       "%.100s: the ending of its name must say what it is: .cfg a scene, .obj, "
                       ".ply, .stl, .off or .glb a mesh",
                       name_or_path);
    char near[BENCH_SUGGEST_TEXT];
    return sm_fail(error, SM_USAGE,
                   "'%.100s' is neither a built-in scene (list them with 'shapebench scenes') nor "
                   "a scene file NAME.cfg%s",
                   name_or_path, bench_scene_suggest(name_or_path, near));
}

const char *bench_scene_suggest(const char *typed, char text[BENCH_SUGGEST_TEXT])
{
    return bench_suggest_among(typed, bench_scene_names(), text);
}

const char *const *bench_scene_names(void)
{
    static const char *names[BUILTIN_MAX + 1];
    for (int i = 0; i < BUILTIN_MAX && bench_builtin[i].name; i++) names[i] = bench_builtin[i].name;
    return names;
}

void bench_width_text(const OctWidth *width, char text[BENCH_WIDTH_TEXT])
{
    int used = 0;
    if (width->cells > 0 || !(width->edges > 0))
        used = snprintf(text, BENCH_WIDTH_TEXT, "%.6g finest cells%s", width->cells,
                        width->edges > 0 ? " + " : "");
    if (width->edges > 0)
        snprintf(text + used, BENCH_WIDTH_TEXT - (size_t)used, "%.6g x the node's edge",
                 width->edges);
}

void bench_width_of_octree(BenchScene *scene, double w, double epsilon, bool cells)
{
    scene->params.summation = SM_SUM_FAST; /* it has only one way */
    scene->params.polar = SM_POLAR_FAST;
    scene->params.layout = SM_LAYOUT_AUTO;
    scene->octree.width = cells ? (OctWidth){.cells = w} : (OctWidth){.edges = w};
    scene->octree.epsilon = epsilon;
}
