#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../../lib/system/printable.h"
#include "../../reference/meshless/surface/points.h"
#include "builtin.h"
#include "config_file.h"
#include "scene_check.h"
#include "setting.h"

enum { BUILTIN_MAX = 64 };

/* What a file says, before the four kinds of obstacle become one array. */
typedef struct {
    BenchScene scene;
    SmObstacle plane[BENCH_MAX], ball[BENCH_MAX], box[BENCH_MAX], capsule[BENCH_MAX];
    int planes, balls, boxes, capsules;
} SceneFile;

#define FAR 1e12 /* a length, speed or force beyond this is a mistake */

#define ITEM(name, kind, offset, low, high)                                                        \
    {                                                                                              \
        name, kind, offset, low, high, NULL, NULL, 0, 0                                            \
    }
#define WORDS(name, offset, words)                                                                 \
    {                                                                                              \
        name, BENCH_CHOICE, offset, 0, 0, words, NULL, 0, 0                                        \
    }
#define SELECT(type)                                                                               \
    ITEM("box_low", BENCH_VECTOR, offsetof(type, select.low), -FAR, FAR),                          \
        ITEM("box_high", BENCH_VECTOR, offsetof(type, select.high), -FAR, FAR),                    \
        ITEM("sphere_centre", BENCH_VECTOR, offsetof(type, select.centre), -FAR, FAR),             \
        ITEM("sphere_radius", BENCH_REAL, offsetof(type, select.radius), 0, FAR)

static const BenchSetting handle_table[] = {
    SELECT(BenchHandle),
    ITEM("velocity", BENCH_VECTOR, offsetof(BenchHandle, velocity), -FAR, FAR),
    ITEM("axis", BENCH_VECTOR, offsetof(BenchHandle, axis), -FAR, FAR),
    ITEM("centre", BENCH_VECTOR, offsetof(BenchHandle, centre), -FAR, FAR),
    ITEM("rate", BENCH_REAL, offsetof(BenchHandle, rate), -1e4, 1e4),
    ITEM("amplitude", BENCH_REAL, offsetof(BenchHandle, amplitude), -1e4, 1e4),
    ITEM("period", BENCH_REAL, offsetof(BenchHandle, period), 0, 1e6),
    ITEM("start", BENCH_REAL, offsetof(BenchHandle, start), 0, 1e6),
    ITEM("stop", BENCH_REAL, offsetof(BenchHandle, stop), 0, 1e6),
    ITEM("release", BENCH_BOOL, offsetof(BenchHandle, release), 0, 0),
    {0},
};

static const BenchSetting force_table[] = {
    SELECT(BenchForce),
    ITEM("force", BENCH_VECTOR, offsetof(BenchForce, force), -FAR, FAR),
    ITEM("start", BENCH_REAL, offsetof(BenchForce, start), 0, 1e6),
    ITEM("stop", BENCH_REAL, offsetof(BenchForce, stop), 0, 1e6),
    {0},
};

static const BenchSetting cut_table[] = {
    ITEM("base_from", BENCH_VECTOR, offsetof(BenchCut, base_from), -FAR, FAR),
    ITEM("tip_from", BENCH_VECTOR, offsetof(BenchCut, tip_from), -FAR, FAR),
    ITEM("base_to", BENCH_VECTOR, offsetof(BenchCut, base_to), -FAR, FAR),
    ITEM("tip_to", BENCH_VECTOR, offsetof(BenchCut, tip_to), -FAR, FAR),
    ITEM("start", BENCH_REAL, offsetof(BenchCut, start), 0, 1e6),
    ITEM("stop", BENCH_REAL, offsetof(BenchCut, stop), 0, 1e6),
    ITEM("level", BENCH_INT, offsetof(BenchCut, level), 1, OCT_MAX_LEVELS),
    ITEM("reach", BENCH_REAL, offsetof(BenchCut, reach), 0, 1e6),
    {0},
};

static const BenchSetting touch_table[] = {
    ITEM("instance", BENCH_LONG, offsetof(BenchTouch, instance), 1, 1000000),
    ITEM("centre", BENCH_VECTOR, offsetof(BenchTouch, centre), -FAR, FAR),
    ITEM("radius", BENCH_REAL, offsetof(BenchTouch, radius), 0, FAR),
    ITEM("level", BENCH_INT, offsetof(BenchTouch, level), 1, OCT_MAX_LEVELS),
    ITEM("start", BENCH_REAL, offsetof(BenchTouch, start), 0, 1e6),
    ITEM("stop", BENCH_REAL, offsetof(BenchTouch, stop), 0, 1e6),
    ITEM("hold", BENCH_REAL, offsetof(BenchTouch, hold), 0, 1e6),
    {0},
};

static const BenchSetting view_table[] = {
    ITEM("eye_from", BENCH_VECTOR, offsetof(BenchView, eye_from), -FAR, FAR),
    ITEM("eye_to", BENCH_VECTOR, offsetof(BenchView, eye_to), -FAR, FAR),
    ITEM("start", BENCH_REAL, offsetof(BenchView, start), 0, 1e6),
    ITEM("stop", BENCH_REAL, offsetof(BenchView, stop), 0, 1e6),
    ITEM("near", BENCH_REAL, offsetof(BenchView, near), 0, FAR),
    ITEM("slack", BENCH_REAL, offsetof(BenchView, slack), 0, 1e6),
    ITEM("level", BENCH_INT, offsetof(BenchView, level), 1, OCT_MAX_LEVELS),
    {0},
};

#define CORNER(name, member) ITEM(name, BENCH_VECTOR, offsetof(SmObstacle, member), -FAR, FAR)
#define RADIUS               ITEM("radius", BENCH_REAL, offsetof(SmObstacle, radius), 0, FAR)
#define FRICTION             ITEM("friction", BENCH_REAL, offsetof(SmObstacle, friction), 0, 1)

static const BenchSetting plane_table[] = {CORNER("point", a), CORNER("normal", b), FRICTION, {0}};
static const BenchSetting ball_table[] = {CORNER("centre", a), RADIUS, FRICTION, {0}};
static const BenchSetting box_table[] = {CORNER("low", a), CORNER("high", b), FRICTION, {0}};
static const BenchSetting capsule_table[] = {
    CORNER("from", a), CORNER("to", b), RADIUS, FRICTION, {0}};

static const char criterion_kinds[] = "uniform|features|surface|box|sphere";

static const BenchSetting criterion_table[] = {
    {"kind", BENCH_CHOICE, offsetof(OctCriterion, kind), 1, 0, criterion_kinds, NULL, 0, 0},
    ITEM("level", BENCH_INT, offsetof(OctCriterion, level), 1, OCT_MAX_LEVELS),
    ITEM("low", BENCH_VECTOR, offsetof(OctCriterion, low), -FAR, FAR),
    ITEM("high", BENCH_VECTOR, offsetof(OctCriterion, high), -FAR, FAR),
    ITEM("centre", BENCH_VECTOR, offsetof(OctCriterion, centre), -FAR, FAR),
    ITEM("radius", BENCH_REAL, offsetof(OctCriterion, radius), 0, FAR),
    {0},
};

static const BenchSetting width_table[] = {
    ITEM("w", BENCH_REAL, offsetof(OctLocalWidth, width.cells), 0, 1e6),
    ITEM("edges", BENCH_REAL, offsetof(OctLocalWidth, width.edges), 0, 1e6),
    ITEM("low", BENCH_VECTOR, offsetof(OctLocalWidth, low), -FAR, FAR),
    ITEM("high", BENCH_VECTOR, offsetof(OctLocalWidth, high), -FAR, FAR),
    ITEM("centre", BENCH_VECTOR, offsetof(OctLocalWidth, centre), -FAR, FAR),
    ITEM("radius", BENCH_REAL, offsetof(OctLocalWidth, radius), 0, FAR),
    {0},
};

static const BenchSetting collide_table[] = {
    ITEM("self", BENCH_BOOL, offsetof(SmCollideParams, self), 0, 0),
    ITEM("bodies", BENCH_BOOL, offsetof(SmCollideParams, bodies), 0, 0),
    ITEM("friction", BENCH_REAL, offsetof(SmCollideParams, friction), 0, 1),
    {0},
};

#define OCT_LIST(name, items, most, count, type, table)                                            \
    {                                                                                              \
        name, BENCH_LIST, offsetof(OctOptions, items), 0, most, NULL, table, sizeof(type),         \
            offsetof(OctOptions, count)                                                            \
    }

static const BenchSetting octree_table[] = {
    ITEM("levels", BENCH_INT, offsetof(OctOptions, sampling.levels), 1, OCT_MAX_LEVELS),
    ITEM("bases", BENCH_LONG, offsetof(OctOptions, sampling.bases), 0, 1e9),
    ITEM("nodes", BENCH_LONG, offsetof(OctOptions, sampling.nodes), 0, 1e9),
    ITEM("balance", BENCH_BOOL, offsetof(OctOptions, sampling.balance), 0, 0),
    OCT_LIST("criteria", sampling.criteria, OCT_MAX_CRITERIA, sampling.criteria_count, OctCriterion,
             criterion_table),
    ITEM("w", BENCH_REAL, offsetof(OctOptions, width.cells), 0, 1e6),
    ITEM("edges", BENCH_REAL, offsetof(OctOptions, width.edges), 0, 1e6),
    ITEM("summation_nodes", BENCH_REAL, offsetof(OctOptions, summation_nodes), 0, 1e6),
    OCT_LIST("widths", local, OCT_MAX_WIDTHS, local_count, OctLocalWidth, width_table),
    WORDS("masses", offsetof(OctOptions, masses), BENCH_MASSES),
    WORDS("symmetry", offsetof(OctOptions, symmetry), BENCH_SYMMETRIES),
    WORDS("weighting", offsetof(OctOptions, weighting), BENCH_WEIGHTINGS),
    WORDS("goals", offsetof(OctOptions, form), "gather|adjoint"),
    ITEM("yield", BENCH_REAL, offsetof(OctOptions, yield), 0, 1e6),
    ITEM("creep", BENCH_REAL, offsetof(OctOptions, creep), 0, 1e6),
    ITEM("most", BENCH_REAL, offsetof(OctOptions, most), 0, 1e6),
    {0},
};

#define AT(member) offsetof(SceneFile, scene.member)

static const BenchSetting meshless_table[] = {
    ITEM("young", BENCH_REAL, AT(meshless.material.young), 1e-30, 1e30),
    ITEM("poisson", BENCH_REAL, AT(meshless.material.poisson), -0.99, 0.49),
    ITEM("density", BENCH_REAL, AT(meshless.material.density), 1e-30, 1e30),
    ITEM("stiffness_damping", BENCH_REAL, AT(meshless.stiffness_damping), 0, 1e6),
    ITEM("points", BENCH_LONG, AT(meshless.points), REF_LEAST_POINTS, REF_MOST_POINTS),
    ITEM("nodes", BENCH_LONG, AT(meshless.nodes), 8, 1e6),
    ITEM("uniform", BENCH_BOOL, AT(meshless.uniform), 0, 0),
    ITEM("modes", BENCH_INT, AT(meshless.modes), 7, 1000),
    ITEM("metre", BENCH_REAL, AT(metre), 1e-30, 1e30),
    {0},
};
#define LIST(name, items, count, type, table)                                                      \
    {                                                                                              \
        name, BENCH_LIST, offsetof(SceneFile, items), 0, BENCH_MAX, NULL, table, sizeof(type),     \
            offsetof(SceneFile, count)                                                             \
    }

static const BenchSetting scene_table[] = {
    ITEM("title", BENCH_TEXT, AT(title), 0, sizeof((BenchScene *)0)->title),
    ITEM("paper", BENCH_TEXT, AT(paper), 0, sizeof((BenchScene *)0)->paper),
    ITEM("row", BENCH_TEXT, AT(row), 0, sizeof((BenchScene *)0)->row),
    ITEM("mesh", BENCH_TEXT, AT(mesh), 0, BENCH_PATH),
    WORDS("fill", AT(voxel.fill), "solid|shell"),
    ITEM("particles", BENCH_LONG, AT(voxel.particles), 8, 1e9),
    ITEM("cell", BENCH_REAL, AT(voxel.cell), 1e-30, 1e30),
    ITEM("cells", BENCH_LONG, AT(cells), 1, 1e9),
    ITEM("engine", BENCH_TEXT, AT(engine), 0, sizeof((BenchScene *)0)->engine),
    ITEM("w", BENCH_INT, AT(params.w), 1, SM_MOST_W),
    ITEM("h", BENCH_REAL, AT(params.h), 1e-9, 10),
    ITEM("damping", BENCH_REAL, AT(params.damping), 0, 1),
    ITEM("damping_every", BENCH_INT, AT(params.damping_every), 1, 1000000),
    ITEM("gravity", BENCH_VECTOR, AT(params.gravity), -FAR, FAR),
    ITEM("strain_limit", BENCH_REAL, AT(params.strain_limit), 0, 1e6),
    WORDS("summation", AT(params.summation), "fast|bars|naive"),
    WORDS("polar", AT(params.polar), "fast|jacobi"),
    WORDS("layout", AT(params.layout), "auto|lists|blocks"),
    ITEM("epsilon", BENCH_REAL, AT(octree.epsilon), 0, 1e6),
    {"octree", BENCH_GROUP, AT(octree), 0, 0, NULL, octree_table, 0, 0},
    {"meshless", BENCH_GROUP, 0, 0, 0, NULL, meshless_table, 0, 0},
    {"collide", BENCH_GROUP, AT(params.collide), 0, 0, NULL, collide_table, 0, 0},
    ITEM("density", BENCH_REAL, AT(density), 0, FAR),
    ITEM("vertex_mass", BENCH_TEXT, AT(vertex_mass), 0, BENCH_PATH),
    ITEM("instances", BENCH_LONG, AT(instances), 1, 1000000),
    ITEM("spacing", BENCH_REAL, AT(spacing), 0, 1e6),
    ITEM("steps_per_frame", BENCH_INT, AT(steps_per_frame), 1, 1000000),
    ITEM("frames", BENCH_INT, AT(frames), 0, 10000000),
    ITEM("settle", BENCH_INT, AT(settle), 0, 1000000),
    ITEM("bend", BENCH_REAL, AT(bend), -100, 100),
    ITEM("twist", BENCH_REAL, AT(twist), -100, 100),
    ITEM("squash", BENCH_REAL, AT(squash), -10, 10),
    ITEM("kick", BENCH_REAL, AT(kick), 0, 100),
    LIST("handles", scene.handle, scene.handle_count, BenchHandle, handle_table),
    LIST("forces", scene.force, scene.force_count, BenchForce, force_table),
    LIST("cuts", scene.cut, scene.cut_count, BenchCut, cut_table),
    LIST("touches", scene.touch, scene.touch_count, BenchTouch, touch_table),
    {"view", BENCH_GROUP, AT(view), 0, 0, NULL, view_table, 0, 0},
    LIST("planes", plane, planes, SmObstacle, plane_table),
    LIST("spheres", ball, balls, SmObstacle, ball_table),
    LIST("boxes", box, boxes, SmObstacle, box_table),
    LIST("capsules", capsule, capsules, SmObstacle, capsule_table),
    {0},
};

void bench_scene_init(BenchScene *scene)
{
    memset(scene, 0, sizeof *scene);
    strcpy(scene->engine, "fastlsm");
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

static SmCode check(SceneFile *read, SmError *error)
{
    BenchScene *scene = &read->scene;
    SmCode code = bench_scene_check(scene, error);
    if (!code) code = add_obstacles(scene, read->plane, read->planes, SM_PLANE, error);
    if (!code) code = add_obstacles(scene, read->ball, read->balls, SM_SPHERE, error);
    if (!code) code = add_obstacles(scene, read->box, read->boxes, SM_BOX, error);
    if (!code) code = add_obstacles(scene, read->capsule, read->capsules, SM_CAPSULE, error);
    return code;
}

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
    SceneFile *read = sm_alloc(1, sizeof *read);
    bench_scene_init(&read->scene);
    name_scene(&read->scene, file);
    code = bench_settings_read(config_root_setting(&config), scene_table, read, file, error);
    config_destroy(&config);
    if (!code) code = check(read, error);
    if (!code) *scene = read->scene;
    free(read);
    return code;
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

SmCode bench_scene_find(const char *name_or_path, BenchScene *scene, SmError *error)
{
    size_t size, length = strlen(name_or_path);
    const char *text = bench_scene_text(name_or_path, &size);
    if (text) {
        char file[BENCH_NAME + 8];
        snprintf(file, sizeof file, "%s.cfg", name_or_path);
        return bench_scene_parse(text, size, file, scene, error);
    }
    bool path =
        strchr(name_or_path, '/') || (length > 4 && !strcmp(name_or_path + length - 4, ".cfg"));
    if (path) return bench_scene_read(name_or_path, scene, error);
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
