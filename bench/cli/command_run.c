#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/meshless/surface/surface_nets.h"
#include "../engines.h"
#include "../play/recording.h"
#include "../scene/points_file.h"
#include "../store/draft.h"
#include "../system/progress.h"
#include "command.h"
#include "option.h"
#include "override.h"
#include "summary.h"

enum {
    KEY_W = 0x2000,
    KEY_WIDTH,
    KEY_EPSILON,
    KEY_LEVELS,
    KEY_NODES,
    KEY_YOUNG,
    KEY_POISSON,
    KEY_DENSITY,
    KEY_MODES,
    KEY_POINTS,
    KEY_PARTICLES,
    KEY_CELL,
    KEY_SHELL,
    KEY_DAMPING,
    KEY_H,
    KEY_FRAMES,
    KEY_STEPS,
    KEY_GRAVITY,
    KEY_SUMMATION,
    KEY_POLAR,
    KEY_STRAIN,
    KEY_RECORD,
    KEY_FIELDS,
    KEY_NO_OUTPUT
};

/* Options that were given replace the scene's settings; those that were not are below zero. */
typedef struct {
    BenchCommon common;
    BenchOverride chosen;
    const char *scene, *output, *w;
    bool shell, no_output, has_gravity, overwrite;
    int frames, steps, summation, polar, levels, record, width;
    int modes;
    BenchFields fields;
    long particles, nodes, points;
    double young, poisson, density; /* density 0: not given; poisson INFINITY */
    double cell, damping, epsilon, h, strain_limit, gravity[3];
} Options;

static const char *const summations[] = {"fast", "bars", "naive", NULL};
static const char *const polars[] = {"fast", "jacobi", NULL};
static const char *const records[] = {"particles", "nodes", NULL}; /* BenchRecord from 1 */

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "What replaces the scene's settings:", 1},
    {"w", KEY_W, "W", 0,
     "Region half-width, in edges of each node's own cell (octree default: 1, the least that holds "
     "together what touches); of a lattice, whose cells are alike, 1 to 31 cells",
     1},
    {"width", KEY_WIDTH, "UNIT", 0,
     "What an octree's --w counts: edges of each node's own cell, or finest cells (default: edges)",
     1},
    {"epsilon", KEY_EPSILON, "E", 0,
     "Octree: regions may be wider by this share (default for a mesh: 0.5)", 1},
    {"levels", KEY_LEVELS, "N", 0, "Octree: a base cell is 2^N finest cells wide, 1 to 12", 1},
    {"nodes", KEY_NODES, "N", 0, "Octree, meshless: wanted simulation nodes (meshless: 1000)", 1},
    {"young", KEY_YOUNG, "E", 0, "Meshless: Young's modulus, Pa (default: 1e5)", 1},
    {"poisson", KEY_POISSON, "NU", 0, "Meshless: Poisson's ratio, above -1 to 0.49 (default: 0.3)",
     1},
    {"density", KEY_DENSITY, "RHO", 0, "Meshless: kg/m^3 (default: 1000)", 1},
    {"modes", KEY_MODES, "N", 0, "Meshless: natural modes, 7 to 1000 (default: 64)", 1},
    {"points", KEY_POINTS, "N", 0,
     "Meshless: points on the mesh, of which its field is made (default: 12000, of thin bodies up "
     "to 400000)",
     1},
    {"particles", KEY_PARTICLES, "N", 0, "Wanted particle count", 1},
    {"cell", KEY_CELL, "SIZE", 0, "Edge of a cell, in the mesh's units", 1},
    {"shell", KEY_SHELL, 0, 0, "Surface cells only, not the interior", 1},
    {"damping", KEY_DAMPING, "K", 0, "Region damping, 0 to 1", 1},
    {"h", KEY_H, "S", 0, "Time step, seconds", 1},
    {"gravity", KEY_GRAVITY, "X,Y,Z", 0, "Mesh units per second squared", 1},
    {"strain-limit", KEY_STRAIN, "S", 0,
     "Links break beyond this times their length, above 1; 0: never. The surface does not tear: "
     "its triangles stretch",
     1},
    {"summation", KEY_SUMMATION, "HOW", 0, "fast, bars or naive", 1},
    {"polar", KEY_POLAR, "HOW", 0, "fast or jacobi", 1},
    {0, 0, 0, 0, "What is written:", 2},
    {"frames", KEY_FRAMES, "N", 0, "Frames after the first", 2},
    {"steps", KEY_STEPS, "N", 0, "Steps in a frame", 2},
    {"output", 'o', "FILE.vtkhdf", 0, "Trajectory (default: SCENE.vtkhdf in this folder)", 2},
    BENCH_OVERWRITE_OPTION(2),
    {"no-output", KEY_NO_OUTPUT, 0, 0, "Write no trajectory", 2},
    {"record", KEY_RECORD, "WHAT", 0,
     "particles: also store the lattice, and every step's particle positions, velocities and "
     "goals, 72 bytes a particle and step; nodes: the same of an octree, with its tree, edges and "
     "regions",
     2},
    {"fields", KEY_FIELDS, "LIST", 0,
     "Also store, for every point of the surface and frame: displacement (12 bytes), speed, strain "
     "(largest in the surface), piece (of material), level (of the octree's leaf; 4 bytes each); "
     "several with commas between them",
     2},
    {0},
};

static const BenchOption options_taken[] = {
    {KEY_W, BENCH_TO(TEXT, w), 0, 0, NULL},
    {KEY_WIDTH, BENCH_TO(CHOICE, width), 0, 0, bench_widths},
    {KEY_EPSILON, BENCH_TO(REAL, epsilon), 0, 1e6, NULL},
    {KEY_LEVELS, BENCH_TO(INT, levels), 1, OCT_MAX_LEVELS, NULL},
    {KEY_NODES, BENCH_TO(LONG, nodes), 1, 1e9, NULL},
    {KEY_YOUNG, BENCH_TO(REAL, young), 1e-30, 1e30, NULL},
    {KEY_POISSON, BENCH_TO(REAL, poisson), -0.99, 0.49, NULL},
    {KEY_DENSITY, BENCH_TO(REAL, density), 1e-30, 1e30, NULL},
    {KEY_MODES, BENCH_TO(INT, modes), 7, 1000, NULL},
    {KEY_POINTS, BENCH_TO(LONG, points), REF_LEAST_POINTS, REF_MOST_POINTS, NULL},
    {KEY_PARTICLES, BENCH_TO(LONG, particles), 8, 1e9, NULL},
    {KEY_CELL, BENCH_TO(REAL, cell), 1e-30, 1e30, NULL},
    {KEY_SHELL, BENCH_TO(TRUE, shell), 0, 0, NULL},
    {KEY_DAMPING, BENCH_TO(REAL, damping), 0, 1, NULL},
    {KEY_H, BENCH_TO(REAL, h), 1e-9, 10, NULL},
    {KEY_STRAIN, BENCH_TO(REAL, strain_limit), 0, 1e6, NULL},
    {KEY_SUMMATION, BENCH_TO(CHOICE, summation), 0, 0, summations},
    {KEY_POLAR, BENCH_TO(CHOICE, polar), 0, 0, polars},
    {KEY_FRAMES, BENCH_TO(INT, frames), 0, 1e7, NULL},
    {KEY_STEPS, BENCH_TO(INT, steps), 1, 1e6, NULL},
    {'o', BENCH_TO(TEXT, output), 0, 0, NULL},
    BENCH_OVERWRITE_TAKEN,
    {KEY_NO_OUTPUT, BENCH_TO(TRUE, no_output), 0, 0, NULL},
    {0},
};

/* "speed,strain" */
static BenchFields parse_fields(const struct argp_state *state, const char *text)
{
    char name[64];
    BenchFields fields = 0;
    for (const char *end = text; end; text = end + 1) {
        end = strchr(text, ',');
        int length = end ? (int)(end - text) : (int)strlen(text);
        snprintf(name, sizeof name, "%.*s", length, text);
        fields |= 1u << bench_option_choice(state, "--fields", name, bench_field_names);
        if (!end) break;
    }
    return fields;
}

static void check_options(const Options *options, const struct argp_state *state)
{
    if (!options->scene) bench_usage(state, "which scene or mesh?");
    if (options->particles && options->cell > 0) bench_usage(state, "either --particles or --cell");
    if (options->no_output &&
        (options->output || options->record || options->fields || options->overwrite))
        bench_usage(state,
                    "--no-output goes with none of --output, --record, --fields and --overwrite");
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    Options *options = state->input;
    if (bench_option_take(option_list, options_taken, key, text, state)) return 0;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->chosen;
        return 0;
    case KEY_GRAVITY:
        bench_option_vector(state, "--gravity", text, options->gravity);
        options->has_gravity = true;
        return 0;
    case KEY_RECORD:
        options->record = 1 + bench_option_choice(state, "--record", text, records);
        return 0;
    case KEY_FIELDS:
        options->fields |= parse_fields(state, text);
        return 0;
    case ARGP_KEY_ARG:
        if (options->scene) bench_usage(state, "one scene or mesh only, not also '%s'", text);
        options->scene = text;
        return 0;
    case ARGP_KEY_END:
        check_options(options, state);
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const char help[] =
    "Simulate a scene and write the motion of its surface: a built-in scene (shapebench scenes), a "
    "scene file NAME.cfg, or a mesh file.\v"
    "A mesh alone becomes a solid of about 2,000 particles, w 2, damping 0.1, that drops from half "
    "its height onto a ground plane; with --engine octree a lattice of about 35,000 (fewer where "
    "that takes too large a one), sampled by "
    "features at epsilon 0.5; with --engine meshless an elastic body 1 m high, held at its lowest "
    "tenth, for which points with normals do, too: a PLY file, or lines of x y z nx ny nz in a "
    "file "
    ".xyz, .pts or .txt, which are carried and written in their order. Its units are unknown, so "
    "gravity is 9.81 heights of the body "
    "per second squared: a body 70 units tall falls like one of 1 m.\n"
    "The trajectory is VTKHDF with an XDMF sidecar (FILE.vtkhdf.xdmf; a script of ParaView's must "
    "open ./FILE.vtkhdf.xdmf, with a folder) for ParaView; it appears "
    "whole or not at all. The deviation printed is the largest distance of a goal position from "
    "double-precision brute force in the last state; beyond the tolerance of 'tables' the run is "
    "INVALID (exit code 1), its trajectory kept.\n" BENCH_EXIT_CODES;

static const struct argp argp = {
    option_list, parse, "SCENE|FILE.cfg|MESH|POINTS", help, bench_override_children, NULL, NULL};

static void apply_options(const Options *options, BenchScene *scene)
{
    SmEngineParams *params = &scene->params;
    const BenchOverride *chosen = &options->chosen;
    if (chosen->engine) snprintf(scene->engine, sizeof scene->engine, "%.23s", chosen->engine);
    if (options->h > 0) params->h = options->h;
    if (options->damping >= 0) params->damping = options->damping;
    if (options->strain_limit >= 0) params->strain_limit = options->strain_limit;
    if (options->summation >= 0) params->summation = (SmSummation)options->summation;
    if (options->polar >= 0) params->polar = (SmPolarMethod)options->polar;
    if (chosen->layout >= 0) params->layout = (SmLayout)chosen->layout;
    if (options->has_gravity) memcpy(params->gravity, options->gravity, sizeof params->gravity);
    if (options->shell) scene->voxel.fill = SM_SHELL;
    if (options->particles || options->cell > 0) scene->cells = 0;
    if (options->particles)
        scene->voxel = (SmVoxelParams){scene->voxel.fill, 0, options->particles, false};
    if (options->cell > 0)
        scene->voxel = (SmVoxelParams){scene->voxel.fill, options->cell, 0, false};
    if (options->frames >= 0) scene->frames = options->frames;
    if (options->steps) scene->steps_per_frame = options->steps;
}

static SmCode apply_elastic(const Options *options, const BenchEngine *engine, BenchScene *scene,
                            SmError *error)
{
    RefMeshlessOptions *meshless = &scene->meshless;
    bool given = options->young > 0 || isfinite(options->poisson) || options->density > 0 ||
                 options->modes || options->points;
    if (!engine->elastic)
        return given ? sm_fail(error, SM_USAGE,
                               "--young, --poisson, --density, --modes and --points are a meshless "
                               "body's: add --engine meshless")
                     : SM_OK;
    if (options->record)
        return sm_fail(error, SM_USAGE, "--record is of shape matching; leave it out");
    if (options->young > 0) meshless->material.young = options->young;
    if (isfinite(options->poisson)) meshless->material.poisson = options->poisson;
    if (options->density > 0) meshless->material.density = options->density;
    if (options->modes) meshless->modes = options->modes;
    if (options->nodes) meshless->nodes = options->nodes;
    if (options->points) meshless->points = options->points;
    return SM_OK;
}

/* A lattice's w is a whole number, an octree's is not. */
static SmCode apply_w(const Options *options, const BenchEngine *engine, BenchScene *scene,
                      SmError *error)
{
    const char *text = options->w;
    if (options->width >= 0 && !(text && engine->sampled))
        return sm_fail(error, SM_USAGE,
                       "--width says what an octree's --w counts: add %s, or leave it out",
                       text ? "--engine octree" : "--w");
    if (!text) return SM_OK;
    char *end;
    double w = strtod(text, &end);
    bool number = end != text && !*end;
    if (engine->sampled) {
        if (!number || !(w > 0 && w <= 1e6))
            return sm_fail(error, SM_USAGE, "--w: '%.40s' is not a number above 0, to 1e6", text);
        scene->octree.width = options->width > 0 ? (OctWidth){.cells = w} : (OctWidth){.edges = w};
        scene->octree.summation_nodes = 0;
        return SM_OK;
    }
    if (!engine->type[0]->by_cells)
        return sm_fail(error, SM_USAGE, "--w: a %s body has no regions", scene->engine);
    if (!number || !(w >= 1 && w <= SM_MOST_W) || w != floor(w))
        return sm_fail(error, SM_USAGE, "--w: '%.40s' is not a whole number from 1 to %d", text,
                       SM_MOST_W);
    scene->params.w = (int)w;
    return SM_OK;
}

/* The octree's options are its own. */
static SmCode apply_sampling(const Options *options, const BenchEngine *engine, BenchScene *scene,
                             SmError *error)
{
    OctOptions *octree = &scene->octree;
    bool nodes = options->nodes && !engine->elastic;
    if (!engine->sampled && (options->epsilon >= 0 || options->levels || nodes))
        return sm_fail(error, SM_USAGE,
                       engine->elastic
                           ? "--epsilon and --levels are the octree's: add --engine octree"
                           : "--epsilon, --levels and --nodes are the octree's: add --engine "
                             "octree");
    if (options->epsilon >= 0) octree->epsilon = options->epsilon;
    if (options->levels) {
        octree->sampling.levels = options->levels;
        for (int i = 0; i < octree->sampling.criteria_count; i++)
            octree->sampling.criteria[i].level = 0; /* the deepest */
    }
    if (options->nodes) octree->sampling.nodes = options->nodes;
    return SM_OK;
}

/* The implicit function of oriented points, and its surface. */
static SmCode outline_points(const char *path, RefPoints *points, RefMpu *given, SmMesh *mesh,
                             SmError *error)
{
    enum { CELLS = 96 };
    SmError why;
    SmCode code = ref_mpu_build(points, NULL, given, &why);
    if (!code) {
        RefField field = ref_mpu_field(given);
        code = ref_surface_nets(&field, CELLS, mesh, &why);
        if (code) ref_mpu_free(given);
    }
    return code ? sm_fail(error, code, "%s: %s", path, why.text) : SM_OK;
}

/* A mesh, or for the meshless engine points. */
static SmCode load_body(const Options *options, const BenchEngine *engine, RefMpu *given,
                        SmMesh *mesh, SmError *error)
{
    const char *name = options->scene;
    RefPoints points;
    if (!engine->elastic) return bench_mesh_load(name, mesh, error);
    SmCode code = bench_points_or_mesh(name, &points, mesh, error);
    if (code || !points.count) return code;
    if (options->points) {
        ref_points_free(&points);
        return sm_fail(error, SM_USAGE, "--points are taken of a mesh, and %s has its own", name);
    }
    return outline_points(name, &points, given, mesh, error);
}

/* A scene's name or file; anything else is a mesh, or the surface of points that are given. */
static SmCode load(const Options *options, BenchScene *scene, RefMpu *given, SmMesh *mesh,
                   SmError *error)
{
    *given = (RefMpu){0};
    const char *name = options->scene;
    size_t length = strlen(name);
    bool file = length > 4 && !strcmp(name + length - 4, ".cfg");
    bool other = strchr(name, '.') || strchr(name, '/') || !strncmp(name, "shape:", 6);
    if (file || !other) {
        SmCode code = bench_scene_find(name, scene, error);
        if (code) return code;
        const BenchSubstitutes *chosen = &options->chosen.substitutes;
        const char *substitute = bench_substitute_find(chosen, scene->name);
        if (chosen->count && !substitute)
            return sm_fail(error, SM_USAGE, "--mesh: '%s' is not this scene, %s", chosen->scene[0],
                           scene->name);
        return bench_mesh_of_scene(scene, substitute, mesh, error);
    }
    if (options->chosen.substitutes.count)
        return sm_fail(error, SM_USAGE, "--mesh goes with a scene, and %.100s is a mesh itself",
                       name);
    if (length >= BENCH_PATH)
        return sm_fail(error, SM_INPUT, "%.100s...: the path is too long", name);
    const char *chosen = options->chosen.engine;
    const BenchEngine *engine = bench_engine(chosen ? chosen : "");
    SmCode code = load_body(options, engine, given, mesh, error);
    if (code) return code;
    bench_scene_drop(mesh, name, scene);
    if (engine->sampled) bench_scene_sample(scene);
    if (engine->elastic) bench_scene_hold(mesh, scene);
    return SM_OK;
}

/* Steps are looked at together that take long beside looking. */
static void end_span(BenchOutcome *outcome)
{
    if (!outcome->open_steps) return;
    bench_watch_stop(&outcome->step.watch);
    bench_mean_add(&outcome->step, outcome->open_seconds, outcome->open_steps);
    outcome->open_seconds = 0;
    outcome->open_steps = 0;
}

static SmCode run_step(BenchPlayback *play, BenchRecording *recording, bool record,
                       BenchOutcome *outcome, SmError *error)
{
    bench_playback_prepare(play);
    if (record) {
        SmCode code = bench_recording_step(recording, outcome->steps, true, error);
        if (code) return code;
    }
    BenchMean *step = &outcome->step;
    if (!outcome->open_steps) bench_watch_start(&step->watch);
    double start = sm_now();
    bench_playback_advance(play, NULL);
    outcome->open_seconds += sm_now() - start;
    outcome->open_steps++;
    outcome->steps++;
    if (record || outcome->open_seconds >= bench_watch_span(step->watch.threads)) end_span(outcome);
    return SM_OK;
}

static bool state_finite(const BenchPlayback *play)
{
    double sum = 0;
    for (int p = 0; p < play->count; p++) {
        const BenchRunner *runner = &play->group[p].runner;
        double(*x)[3] = sm_alloc((size_t)runner->particles, sizeof *x);
        runner->type->get(runner->engine, SM_POSITION, x);
        for (long i = 0; i < runner->particles; i++) sum += 0 * (x[i][0] + x[i][1] + x[i][2]);
        free(x);
    }
    return sum == 0;
}

/* What the scene changes before a frame. */
static SmCode change(BenchPlayback *play, BenchOutcome *outcome, SmError *error)
{
    bench_watch_start(&outcome->change.watch);
    SmCode code = bench_playback_change(play, error);
    double seconds = bench_watch_stop(&outcome->change.watch);
    bool changed = false;
    for (int p = 0; p < play->count; p++) changed |= play->group[p].last.resampled;
    if (!changed) return code;
    outcome->changes++;
    bench_mean_add(&outcome->change, seconds, 1);
    return code;
}

/* Runs all frames; stops early when no longer finite. `recording` may be NULL. */
static SmCode run_frames(BenchPlayback *play, BenchRecording *recording, const Options *options,
                         BenchOutcome *outcome, SmError *error)
{
    const BenchScene *scene = play->scene;
    BenchProgress progress;
    bench_progress_start(&progress, options->common.quiet);
    BenchMean none = {.watch = bench_watch(options->common.threads)};
    *outcome = (BenchOutcome){.finite = true, .step = none, .change = none};
    SmCode code = recording ? bench_recording_frame(recording, error) : SM_OK;
    for (int f = 0; f < scene->frames && !code && outcome->finite; f++) {
        code = change(play, outcome, error);
        for (int s = 0; s < scene->steps_per_frame && !code; s++)
            code = run_step(play, recording, options->record, outcome, error);
        end_span(outcome);
        if (code) break;
        outcome->finite = state_finite(play);
        if (recording && outcome->finite) code = bench_recording_frame(recording, error);
        bench_progress_show(&progress, scene->name, (f + 1.0) / scene->frames);
    }
    if (!code && options->record && outcome->finite)
        code = bench_recording_step(recording, outcome->steps, false, error);
    bench_progress_stop(&progress);
    return code;
}

/* What --output says, or the scene's name in this folder, which `room` has room for. */
static const char *output_path(const Options *options, const BenchScene *scene,
                               char room[BENCH_NAME + 8])
{
    if (options->output) return options->output;
    const char *stem = strncmp(scene->name, "shape:", 6) ? scene->name : scene->name + 6;
    const char *dot = strrchr(stem, '.');
    int length = dot && dot != stem ? (int)(dot - stem) : (int)strlen(stem);
    snprintf(room, BENCH_NAME + 8, "%.*s.vtkhdf", length, stem);
    return room;
}

/* The trajectory and its sidecar, before anything takes long. */
static SmCode reserve(const Options *options, const char *path, SmError *error)
{
    char sidecar[BENCH_DRAFT_PATH + 8];
    if (options->no_output) return SM_OK;
    size_t length = strlen(path);
    if (length >= 5 && !strcmp(path + length - 5, ".xdmf"))
        return sm_fail(
            error, SM_USAGE,
            "-o %.300s: readers take the trajectory, which is HDF5, for the XDMF that is "
            "written beside it as NAME.xdmf: give a name that ends in .vtkhdf",
            path);
    SmCode code = bench_draft_reserve(path, options->overwrite, error);
    snprintf(sidecar, sizeof sidecar, "%s.xdmf", path);
    return code ? code : bench_draft_reserve(sidecar, options->overwrite, error);
}

/* Before a long wait for a file that fills a disk. */
static void warn_of_size(const Options *options, const BenchRecording *recording, const char *path)
{
    static const double much = 200e6;
    double bytes = bench_recording_bytes(recording);
    if (bytes <= much || options->common.quiet) return;
    fprintf(stderr,
            "shapebench run: %s will take about %.*f %s; --frames N writes fewer than its %d "
            "frames%s\n",
            path, bytes < 1e9 ? 0 : 1, bytes < 1e9 ? bytes / 1e6 : bytes / 1e9,
            bytes < 1e9 ? "MB" : "GB", recording->runner->scene->frames + 1,
            options->record ? ", --steps N records fewer steps in each" : "");
}

/* Runs the scene on an engine that is ready, and writes what was asked for. */
static SmCode record(const Options *options, BenchPlayback *play, const BenchMachine *machine,
                     const char *path, SmError *error)
{
    const BenchScene *scene = play->scene;
    BenchRecording recording;
    BenchRecording *recorder = options->no_output ? NULL : &recording;
    SmCode code = SM_OK;
    if (recorder)
        code = bench_recording_open(play, path, (BenchRecord)options->record, options->fields,
                                    machine, recorder, error);
    if (code) return code;
    if (recorder) warn_of_size(options, recorder, path);
    BenchOutcome outcome;
    code = run_frames(play, recorder, options, &outcome, error);
    if (code || !outcome.finite) {
        if (recorder) bench_recording_abandon(recorder);
        if (code) return code;
        bench_summary_print(play, &outcome);
        return sm_fail(error, SM_INVALID, "%s is INVALID: positions are not finite after step %ld",
                       scene->name, outcome.steps);
    }
    if (recorder) code = bench_recording_close(recorder, error);
    if (code) return code;
    bool valid = bench_summary_print(play, &outcome);
    if (recorder && !options->common.quiet)
        printf("wrote %s and %s.xdmf: %d frame%s\n", path, path, scene->frames + 1,
               scene->frames ? "s" : "");
    if (valid) return SM_OK;
    return sm_fail(error, SM_INVALID,
                   "%s is INVALID: its last state is not that of brute force; try "
                   "--precision double or a smaller --h",
                   scene->name);
}

static SmCode run(const Options *options, const BenchMachine *machine, SmError *error)
{
    BenchScene scene;
    const SmEngineType *type;
    RefMpu given;
    SmMesh mesh;
    BenchBody body;
    BenchPlayback play;
    char room[BENCH_NAME + 8];
    SmCode code = load(options, &scene, &given, &mesh, error);
    if (code) return code;
    apply_options(options, &scene);
    const BenchEngine *engine = bench_engine(scene.engine);
    code = apply_sampling(options, engine, &scene, error);
    if (!code) code = apply_elastic(options, engine, &scene, error);
    if (!code) code = bench_engine_find(scene.engine, options->chosen.precision, &type, error);
    if (!code) code = apply_w(options, engine, &scene, error);
    const char *path = output_path(options, &scene, room);
    if (!code) code = reserve(options, path, error);
    if (!code) code = bench_body_create(&scene, &mesh, &body, error);
    if (code) {
        sm_mesh_free(&mesh);
        ref_mpu_free(&given);
        return code;
    }
    if (given.count) body.given = &given;
    code = bench_playback_create(&scene, &body, type, options->common.threads, options->common.seed,
                                 &play, error);
    if (!code) {
        code = record(options, &play, machine, path, error);
        bench_playback_free(&play);
    }
    bench_body_free(&body);
    ref_mpu_free(&given);
    return code;
}

int bench_command_run(int argc, char **argv)
{
    Options options = {.frames = -1,
                       .summation = -1,
                       .polar = -1,
                       .width = -1,
                       .damping = -1,
                       .epsilon = -1,
                       .poisson = INFINITY,
                       .strain_limit = -1};
    SmError error;
    BenchMachine machine;
    bench_options_parse(&argp, argc, argv, &options, BENCH_TAKES_ALL, &options.common);
    bench_machine_read(argc, argv, options.common.threads, &machine);
    SmCode code = run(&options, &machine, &error);
    if (code) bench_option_fail(argv[0], &error);
    return (int)code;
}
