/* scene.h - a scene as data: what to simulate, how, and what disturbs it.
 *
 * Scene files are libconfig; bench/scenes/ holds those that come with the program. What they can
 * say is the table of scene_settings.c. Lengths are in the mesh's units. */
#ifndef BENCH_SCENE_H
#define BENCH_SCENE_H

#include "../../lib/voxel/voxelise.h"
#include "../../octree/engine.h"
#include "../../reference/meshless/engine.h"
#include "../settings/setting.h"
#include "../system/suggest.h"

enum { BENCH_NAME = 64, BENCH_PATH = 1024, BENCH_MAX = 64, BENCH_SETTLE_STEPS = 8 };

/* Particles whose rest position lies in a box, given in fractions of the mesh's bounding box
 * (0..1 each axis), or in a sphere in mesh units. */
typedef struct {
    bool sphere;
    double low[3], high[3];   /* box */
    double centre[3], radius; /* sphere */
} BenchSelect;

/* A handle's motion; all zero: a pin. angle(t) = rate * t, or amplitude * sin(2 pi t / period). */
typedef struct {
    BenchSelect select;
    double velocity[3]; /* m/s */
    double axis[3], centre[3];
    double rate;              /* rad/s */
    double amplitude, period; /* rad, s; period 0: none */
    double start, stop;       /* s; stop 0: for ever. After it the handle stays where it is */
    bool release;             /* at `stop` let go instead */
} BenchHandle;

/* A force on the selected particles, N per particle, from start to stop. */
typedef struct {
    BenchSelect select;
    double force[3];
    double start, stop;
} BenchForce;

/* A blade: a segment from base to tip, swept evenly through the moving world from start to stop. It
 * cuts what it crosses. */
typedef struct {
    double base_from[3], tip_from[3], base_to[3], tip_to[3]; /* mesh units */
    double start, stop;                                      /* s */
    int level;    /* octree: leaves near the cut are split down to it; 0: not */
    double reach; /* how near, in finest cells */
} BenchCut;

/* A finger on one instance: octree leaves that meet the ball, in the body's rest position, are
 * split down to `level` while it touches, and merged again once it has been gone for `hold`. */
typedef struct {
    long instance;            /* from 1 */
    double centre[3], radius; /* mesh units */
    int level;
    double start, stop, hold; /* s; stop 0: for ever */
} BenchTouch;

/* An eye that moves evenly from start to stop: leaves nearer to it than `near` are split down to
 * `level`, to a level less with every doubling of the distance, and merged again where they are
 * farther by the share `slack`. */
typedef struct {
    double eye_from[3], eye_to[3]; /* mesh units */
    double start, stop;            /* s */
    double near, slack;
    int level; /* 0: no eye */
} BenchView;

typedef struct BenchScene {
    char name[BENCH_NAME];
    char title[160];
    char paper[24], row[24]; /* the paper's table row that it regenerates; empty: none */
    char mesh[BENCH_PATH];   /* "shape:penguin", or a path relative to the scene file */
    char file[BENCH_PATH];   /* where the scene was read from; for messages */
    char engine[24];
    SmVoxelParams voxel;
    long cells;                   /* wanted material cells, or 0: as `voxel` says */
    SmEngineParams params;        /* mass, instance_pose, octree: filled by the runner */
    double density;               /* kg/m^3; 0: unit masses */
    char vertex_mass[BENCH_PATH]; /* text file, a mass for every vertex; nearest vertex wins */
    OctOptions octree;            /* octree only */
    RefMeshlessOptions meshless;  /* meshless and shell; in metres, mesh filled by the runner */
    double metre;                 /* mesh units that the meshless body's material takes for one */
    long instances;
    double spacing; /* between instances, in widths of the body */
    int steps_per_frame;
    int frames;
    int settle; /* steps before what `tables` measures */
    int handle_count, force_count, obstacle_count, cut_count, touch_count;
    BenchHandle handle[BENCH_MAX];
    BenchForce force[BENCH_MAX];
    SmObstacle obstacle[BENCH_MAX];
    BenchCut cut[BENCH_MAX];
    BenchTouch touch[BENCH_MAX];
    BenchView view;
    double bend, twist, squash; /* initial deformation that starts it moving, 0: none */
    double kick;                /* random initial velocity, cells per step, from the seed */
} BenchScene;

/* Does it begin otherwise than at rest? */
static inline bool bench_scene_disturbs(const BenchScene *scene)
{
    return scene->bend != 0 || scene->twist != 0 || scene->squash != 0 || scene->kick != 0;
}

/* Words for choices, in the order of their enumerations; NULL-terminated. */
extern const char *const bench_precisions[];
extern const char *const bench_widths[]; /* units of an octree's w: of each node's own, finest */
extern const char *const bench_summations[], *const bench_polars[], *const bench_layouts[];
extern const char *const bench_masses[], *const bench_symmetries[], *const bench_weightings[];
extern const char *const bench_goal_forms[];
#define BENCH_LAYOUT_HELP "Fastlsm's sums: auto, lists, or blocks where it can"

/* Who takes an option of the settings, and which engines alone. */
enum { BENCH_BY_RUN = 1, BENCH_BY_TABLES = 2 };
/* `own` of a BenchEngine */
enum { BENCH_OF_SAMPLED = 1, BENCH_OF_ELASTIC = 2, BENCH_OF_SHELL = 4 };

/* What a file says, before the four kinds of obstacle become one array. */
typedef struct {
    BenchScene scene; /* first: the settings' members are as far from the record's beginning */
    SmObstacle plane[BENCH_MAX], ball[BENCH_MAX], box[BENCH_MAX], capsule[BENCH_MAX];
    int planes, balls, boxes, capsules;
} BenchSceneFile;

/* Everything that a scene file can say, and the options that replace some of it: the key in the
 * file, the option, the range and the help, one line each (settings/setting.h). Of a
 * BenchSceneFile, and of a scene, which is its first member. */
extern const BenchSetting bench_scene_settings[];

/* The defaults of everything that a scene file may leave out; no mesh. */
void bench_scene_init(BenchScene *scene);

/* Parses `size` bytes of a scene file's text. `file` is for messages and names the scene
 * ("dir/penguin.cfg": "penguin"). Paths in the text stay as they are. Errors: SM_INPUT, with file
 * and line; `scene` is then untouched. */
SmCode bench_scene_parse(const char *text, size_t size, const char *file, BenchScene *scene,
                         SmError *error);

/* "damping = 0.1; planes[0].point = [0, 0, 0]; ": what it says that is not the default, whatever it
 * and its mesh are called; if that is longer, the beginning and a hash of all. */
void bench_scene_said(const BenchScene *scene, size_t size, char *text);

/* Text of a built-in scene's file (and its size, unless NULL), or NULL. */
const char *bench_scene_text(const char *name, size_t *size);

/* Is it a scene file by its ending? Is it that or a scene's name, by its letters? Anything else is
 * a mesh or points. */
bool bench_scene_is_file(const char *path);
bool bench_scene_named(const char *name_or_path);

/* Reads a scene file, or finds a built-in scene by name. Errors name file and line. */
SmCode bench_scene_read(const char *path, BenchScene *scene, SmError *error);
SmCode bench_scene_find(const char *name_or_path, BenchScene *scene, SmError *error);

enum { BENCH_WIDTH_TEXT = 64 };

/* "2.5 finest cells", "0.75 x the node's edge", or their sum. */
void bench_width_text(const OctWidth *width, char text[BENCH_WIDTH_TEXT]);

/* How wide an octree's regions are (BenchEngine.set_width). */
void bench_width_of_octree(BenchScene *scene, double w, double epsilon, bool cells);

/* Built-in scene names, in order, NULL-terminated. */
const char *const *bench_scene_names(void);

/* "; did you mean 'NAME'?" where a built-in scene's name is near, or "". Returns `text`. */
const char *bench_scene_suggest(const char *typed, char text[BENCH_SUGGEST_TEXT]);

#endif
