#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/meshless/surface/surface_nets.h"
#include "../check/full_check.h"
#include "../engines.h"
#include "../play/mode.h"
#include "../play/recording.h"
#include "../play/strides.h"
#include "../scene/override.h"
#include "../store/draft.h"
#include "../system/progress.h"
#include "../system/quote.h"
#include "command.h"
#include "summary.h"

typedef struct {
    BenchCommon common;
    BenchOverride chosen;
    const char *scene, *output, *w, *width;
    bool no_output, overwrite, hash;
    int check;  /* the last state alone, or all */
    long nodes; /* 0: not given */
    int mode;   /* of an elastic body, to be shown; 0: it is simulated */
    int record; /* BenchRecord */
    BenchFields fields;
} Options;

static const char *const checks[] = {"end", "full", NULL};
static const char *const records[] = {"particles", "nodes", NULL}; /* BenchRecord from 1 */

/* "speed,strain" */
static void take_fields(const struct argp_state *state, const char *text, void *member)
{
    const BenchSetting field = {.kind = BENCH_SET_INT, .choices = bench_field_names};
    char name[64];
    int number;
    SmError error;
    for (const char *end = text; end; text = end + 1) {
        end = strchr(text, ',');
        int length = end ? (int)(end - text) : (int)strlen(text);
        snprintf(name, sizeof name, "%.*s", length, text);
        if (bench_setting_text(&field, name, &number, &error))
            bench_usage(state, "--fields: %s", error.text);
        *(BenchFields *)member |= 1u << number;
        if (!end) break;
    }
}

static const BenchSetting settings[] = {
    {.section = 1, .help = "What replaces the scene's settings:"},
    {BENCH_OPTION(
         "w", "W", 1,
         "Region half-width, in edges of each node's own cell (octree default: 1, the least "
         "that holds together what touches); of a lattice, whose cells are alike, 1 to 32 "
         "cells"),
     BENCH_IN(Options, w)},
    {BENCH_OPTION("width", "UNIT", 1,
                  "What an octree's --w counts: edges of each node's own cell, or finest cells "
                  "(default: edges)"),
     BENCH_IN(Options, width), BENCH_CHOICES(bench_widths)},
    {BENCH_IN(Options, chosen), .table = bench_override_settings, .who = BENCH_BY_RUN},
    {BENCH_OPTION("nodes", "N", 1,
                  "Octree, meshless, shell: wanted simulation nodes (meshless: "
                  "1000, shell: 450)"),
     BENCH_IN(Options, nodes), 1, 1e9, .of = BENCH_OF_SAMPLED | BENCH_OF_ELASTIC | BENCH_OF_SHELL},
    {BENCH_OPTION(
         "mode", "K", 1,
         "Meshless, shell: in place of the motion, one period of the free body's K-th natural "
         "mode that deforms it, from 1, in so many frames; its frequency, and that with half the "
         "nodes"),
     BENCH_IN(Options, mode), 1, 994},
    {BENCH_OPTION("check", "WHAT", 1,
                  "end: hold the last state to brute force (default); full: then play the scene "
                  "again by 1 thread, each frame's end held to brute force, and by every other "
                  "number to 4 or to the machine's cores, held to the same bits"),
     BENCH_IN(Options, check), BENCH_CHOICES(checks)},
    {.section = 2, .help = "What is written:"},
    {BENCH_OUTPUT_OPTION("FILE.vtkhdf", 2, "Trajectory (default: SCENE.vtkhdf in this folder)"),
     BENCH_IN(Options, output)},
    BENCH_OVERWRITE_OPTION(Options, overwrite, 2),
    {BENCH_OPTION("no-output", NULL, 2, "Write no trajectory"), BENCH_IN(Options, no_output)},
    {BENCH_OPTION("hash", NULL, 2,
                  "Print a hash of the last positions and velocities, as the trajectory holds it: "
                  "the same for any number of threads"),
     BENCH_IN(Options, hash)},
    {BENCH_OPTION(
         "record", "WHAT", 2,
         "particles: also store the lattice, and every step's particle positions, velocities "
         "and goals, 72 bytes a particle and step; nodes: the same of an octree, with its "
         "tree, edges and regions"),
     BENCH_IN(Options, record), .low = 1, BENCH_CHOICES(records)},
    {BENCH_OPTION(
         "fields", "LIST", 2,
         "Also store, for every point of the surface and frame: displacement (12 bytes), "
         "speed, strain (largest in the surface), piece (of material), level (of the octree's "
         "leaf; 4 bytes each); several with commas between them"),
     BENCH_IN(Options, fields), .take = take_fields, BENCH_CHOICES(bench_field_names)},
    {0},
};

static void check(const struct argp_state *state, void *record)
{
    Options *options = record;
    const BenchGiven *given = &options->chosen.given;
    if (!options->common.words) bench_usage(state, "which scene or mesh?");
    options->scene = options->common.word[0];
    if (bench_given(given, "particles") && bench_given(given, "cell"))
        bench_usage(state, "either --particles or --cell");
    if (options->mode && options->check)
        bench_usage(state, "--mode shows a mode and simulates nothing that --check could hold");
    if (options->no_output &&
        (options->output || options->record || options->fields || options->overwrite))
        bench_usage(state,
                    "--no-output goes with none of --output, --record, --fields and --overwrite");
}

static const char help[] =
    "Simulate a scene and write the motion of its surface: a built-in scene (shapebench scenes), a "
    "scene file NAME.cfg, or a mesh file.\v"
    "A mesh alone becomes a solid of about 2,000 particles, w 2, damping 0.1, that drops from half "
    "its height onto a ground plane; with --engine octree a lattice of about 35,000 (fewer where "
    "that takes too large a one), sampled by features at epsilon 0.5; with --engine meshless an "
    "elastic body 1 m high, held at its lowest tenth, for which points with normals do, too: a PLY "
    "file, or lines of x y z nx ny nz in a file .xyz, .pts or .txt, which are carried and written "
    "in their order; with --engine shell, held like that, points without normals do, too. Its "
    "units are unknown, so gravity is 9.81 heights of the body per second "
    "squared: a body 70 units tall falls like one of 1 m.\n"
    "The trajectory is VTKHDF with an XDMF sidecar (FILE.vtkhdf.xdmf; a script of ParaView's must "
    "open ./FILE.vtkhdf.xdmf, with a folder) for ParaView; it appears whole or not at all. The "
    "deviation printed is the largest distance of a goal position from double-precision brute "
    "force in the last state; beyond the tolerance of 'tables', or where a shell stands still as a "
    "crack of it could not be followed, the run is INVALID (exit code 1), its trajectory "
    "kept.\n" BENCH_EXIT_CODES;

/* Which engine's the setting is first of all. */
static unsigned first_of(const BenchSetting *setting)
{
    return setting->of & -setting->of;
}

/* Adds the names of a table's options that are first of all this owner's, and that the engine has
 * not. */
static void name_options(const BenchSetting *table, unsigned owner, unsigned engine,
                         BenchNames *names)
{
    for (; !bench_setting_ends(table); table++) {
        if (table->table && table->kind != BENCH_SET_LIST)
            name_options(table->table, owner, engine, names);
        bool first = first_of(table) == owner;
        if (table->option && first && !(table->of & engine))
            names->name[names->count++] = table->option;
    }
}

static SmCode fail_of_owner(const BenchEngine *owner, unsigned engine, SmError *error)
{
    char list[256];
    BenchNames names = {.count = 0};
    name_options(settings, owner->own, engine, &names);
    return sm_fail(error, SM_USAGE, "%s are %s: add --engine %s",
                   bench_enumerate(names.name, "--", " and ", sizeof list, list), owner->whose,
                   owner->type[0]->name);
}

/* Refuses options that the engine has not. */
static SmCode check_owners(const Options *options, const BenchEngine *engine, SmError *error)
{
    const BenchGiven *given = &options->chosen.given;
    for (const BenchEngine *const *owner = bench_engine_list; *owner; owner++) {
        unsigned others = (*owner)->own & ~engine->own;
        bool missed = others && options->nodes && !engine->nodes;
        for (int i = 0; i < given->count && others; i++)
            missed |= first_of(given->item[i].setting) == (*owner)->own &&
                      !(given->item[i].setting->of & engine->own);
        if (missed) return fail_of_owner(*owner, engine->own, error);
    }
    if (!engine->twin && options->record)
        return sm_fail(error, SM_USAGE,
                       "--record stores goals of shape matching, and %s has none: leave it out",
                       engine->type[0]->name);
    if (options->mode && !engine->modes)
        return sm_fail(error, SM_USAGE,
                       "--mode is of a meshless body or a shell, and %s has no natural modes: add "
                       "--engine meshless or shell, or leave it out",
                       engine->type[0]->name);
    return SM_OK;
}

static void apply_options(const Options *options, BenchScene *scene)
{
    const BenchGiven *given = &options->chosen.given;
    OctSampling *sampling = &scene->octree.sampling;
    bool particles = bench_given(given, "particles"), cell = bench_given(given, "cell");
    if (particles || cell) {
        scene->cells = 0;
        scene->voxel = (SmVoxelParams){.fill = scene->voxel.fill};
    }
    bench_override_apply(&options->chosen, scene);
    for (int i = 0; i < sampling->criteria_count && bench_given(given, "levels"); i++)
        sampling->criteria[i].level = 0; /* the deepest */
    const BenchEngine *engine = bench_engine(scene->engine);
    if (options->nodes && engine->nodes) *engine->nodes(scene) = options->nodes;
}

static bool sampled(const BenchEngine *engine)
{
    return engine->sampled;
}

/* A lattice's w is a whole number, an octree's is not. */
static SmCode apply_w(const Options *options, const BenchEngine *engine, BenchScene *scene,
                      SmError *error)
{
    const char *text = options->w;
    char names[BENCH_ENGINES_TEXT];
    if (options->width && !(text && engine->sampled))
        return sm_fail(error, SM_USAGE,
                       "--width says what an octree's --w counts: add --%s%s, or leave it out",
                       text ? "engine " : "w", text ? bench_engines_that(sampled, names) : "");
    if (!text) return SM_OK;
    char *end;
    double w = strtod(text, &end);
    bool number = end != text && !*end;
    if (engine->sampled) {
        if (!number || !(w > 0 && w <= 1e6))
            return sm_fail(error, SM_USAGE, "--w: '%.40s' is not a number above 0, to 1e6", text);
        bool cells = options->width && !strcmp(options->width, bench_widths[1]);
        scene->octree.width = cells ? (OctWidth){.cells = w} : (OctWidth){.edges = w};
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

/* What there is of a body before its scene: a mesh, of points their surface. */
typedef struct {
    SmMesh mesh;
    RefMpu given;   /* of a meshless body's points, */
    bool of_points; /* and of a shell's the mesh is of triangles between them */
} Loaded;

/* A mesh, or for meshless bodies and shells points. */
static SmCode load_body(const Options *options, const BenchEngine *engine, Loaded *loaded,
                        SmError *error)
{
    const char *name = options->scene;
    SmMesh *mesh = &loaded->mesh;
    RefPoints points;
    if (engine->own & BENCH_OF_SHELL)
        return bench_sheet_load(name, mesh, &loaded->of_points, error);
    if (!(engine->own & BENCH_OF_ELASTIC)) return bench_mesh_load(name, mesh, error);
    SmCode code = bench_points_or_mesh(name, &points, mesh, error);
    if (code || !points.count) return code;
    if (bench_given(&options->chosen.given, "points")) {
        ref_points_free(&points);
        return sm_fail(error, SM_USAGE, "--points are taken of a mesh, and %s has its own", name);
    }
    return outline_points(name, &points, &loaded->given, mesh, error);
}

/* A scene's name or file; anything else is a mesh, or the surface of points that are given. */
static SmCode load(const Options *options, BenchScene *scene, Loaded *loaded, SmError *error)
{
    *loaded = (Loaded){.of_points = false};
    const char *name = options->scene;
    if (bench_scene_named(name)) {
        SmCode code = bench_scene_find(name, scene, error);
        if (code) return code;
        const BenchSubstitutes *chosen = &options->chosen.substitutes;
        const char *substitute = bench_substitute_find(chosen, scene->name);
        if (chosen->count && !substitute)
            return sm_fail(error, SM_USAGE, "--mesh: '%s' is not this scene, %s", chosen->scene[0],
                           scene->name);
        return bench_mesh_of_scene(scene, substitute, &loaded->mesh, error);
    }
    if (options->chosen.substitutes.count)
        return sm_fail(error, SM_USAGE, "--mesh goes with a scene, and %.100s is a mesh itself",
                       name);
    if (strlen(name) >= BENCH_PATH)
        return sm_fail(error, SM_INPUT, "%.100s...: the path is too long", name);
    const char *chosen = options->chosen.engine;
    const BenchEngine *engine = bench_engine(chosen ? chosen : "");
    SmCode code = load_body(options, engine, loaded, error);
    if (code) return code;
    bench_scene_drop(&loaded->mesh, name, scene);
    if (engine->adapt) engine->adapt(&loaded->mesh, scene);
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

static void count_change(bool changed, BenchOutcome *outcome)
{
    double seconds = bench_watch_stop(&outcome->change.watch);
    if (!changed) return;
    outcome->changes++;
    bench_mean_add(&outcome->change, seconds, 1);
}

/* What the scene changes before a frame. */
static SmCode change(BenchPlayback *play, BenchOutcome *outcome, SmError *error)
{
    bench_watch_start(&outcome->change.watch);
    SmCode code = bench_playback_change(play, error);
    bool changed = false;
    for (int p = 0; p < play->count; p++) changed |= play->group[p].last.resampled;
    count_change(changed, outcome);
    return code;
}

/* What its steps have broken. */
static void follow(BenchPlayback *play, BenchOutcome *outcome)
{
    bench_watch_start(&outcome->change.watch);
    count_change(bench_playback_follow(play), outcome);
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
    BenchStrides strides = {.count = 0};
    SmCode code = recording ? bench_recording_frame(recording, error) : SM_OK;
    for (int f = 0; f < scene->frames && !code && outcome->finite; f++) {
        code = change(play, outcome, error);
        for (int s = 0; s < scene->steps_per_frame && !code; s++)
            code = run_step(play, recording, options->record, outcome, error);
        end_span(outcome);
        if (code) break;
        outcome->finite = bench_strides_look(&strides, play);
        if (outcome->finite) follow(play, outcome);
        if (recording && outcome->finite) code = bench_recording_frame(recording, error);
        bench_progress_show(&progress, scene->name, (f + 1.0) / scene->frames);
    }
    if (!code && options->record && outcome->finite)
        code = bench_recording_step(recording, outcome->steps, false, error);
    bench_progress_stop(&progress);
    if (!code) bench_strides_remark(&strides, play);
    free(strides.x);
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
    BenchOutcome outcome = {.finite = true};
    if (options->mode)
        code = bench_mode_record(play, recorder, options->mode, error);
    else
        code = run_frames(play, recorder, options, &outcome, error);
    if (code || !outcome.finite) {
        if (recorder) bench_recording_abandon(recorder);
        if (code) return code;
        bench_summary_print(play, &outcome);
        return sm_fail(error, SM_INVALID, "%s is INVALID: positions are not finite after step %ld",
                       scene->name, outcome.steps);
    }
    char hash[BENCH_HASH_TEXT] = "";
    if (options->hash) bench_playback_hash(play, hash);
    if (recorder) code = bench_recording_close(recorder, error);
    if (code) return code;
    bool valid = options->mode || bench_summary_print(play, &outcome);
    SmCounts counts;
    bench_playback_runner(play)->type->count(bench_playback_runner(play)->engine, &counts);
    if (options->hash)
        printf("state after %ld step%s: %s (%s, %s precision)\n", outcome.steps,
               outcome.steps == 1 ? "" : "s", hash, machine->isa,
               play->group[0].runner.type->precision);
    if (recorder && !options->common.quiet)
        printf("wrote %s and %s.xdmf: %d frame%s\n", path, path, scene->frames + 1,
               scene->frames ? "s" : "");
    if (valid) return SM_OK;
    if (counts.stopped)
        return sm_fail(error, SM_INVALID,
                       "%s is INVALID: a crack could not be followed, and the body stands still "
                       "since then; give it more nodes, or a greater strength",
                       scene->name);
    return sm_fail(error, SM_INVALID,
                   "%s is INVALID: its last state is not that of brute force; try "
                   "--precision double or a smaller --h",
                   scene->name);
}

static SmCode run(const Options *options, const BenchMachine *machine, SmError *error)
{
    BenchScene scene;
    const SmEngineType *type;
    Loaded loaded;
    BenchBody body;
    BenchPlayback play;
    char room[BENCH_NAME + 8];
    SmCode code = load(options, &scene, &loaded, error);
    if (code) return code;
    apply_options(options, &scene);
    const BenchEngine *engine = bench_engine(scene.engine);
    code = check_owners(options, engine, error);
    if (!code) code = bench_engine_find(scene.engine, options->chosen.precision, &type, error);
    if (!code) code = apply_w(options, engine, &scene, error);
    const char *path = output_path(options, &scene, room);
    if (!code) code = reserve(options, path, error);
    if (!code) code = bench_body_create(&scene, &loaded.mesh, &body, error);
    if (code) {
        sm_mesh_free(&loaded.mesh);
        ref_mpu_free(&loaded.given);
        return code;
    }
    if (loaded.given.count) body.given = &loaded.given;
    body.of_points = loaded.of_points;
    code = bench_playback_create(&scene, &body, type, options->common.threads, options->common.seed,
                                 &play, error);
    if (!code) {
        code = record(options, &play, machine, path, error);
        bench_playback_free(&play);
    }
    if (!code && options->check) {
        BenchProgress progress;
        bench_progress_start(&progress, options->common.quiet);
        code = bench_full_check(&scene, &body, type, options->common.seed, machine->cores,
                                &progress, error);
    }
    bench_body_free(&body);
    ref_mpu_free(&loaded.given);
    return code;
}

static SmCode perform(void *record, int argc, char **argv, SmError *error)
{
    const Options *options = record;
    BenchMachine machine;
    bench_machine_read(argc, argv, options->common.threads, &machine);
    return run(options, &machine, error);
}

const BenchCommand bench_command_simulate = {
    .name = "run",
    .summary = "simulate a scene or a mesh and write its motion",
    .line = {settings, BENCH_TAKES_ALL, "SCENE|FILE.cfg|MESH|POINTS", help, check, .most = 1,
             .limit = "One scene or mesh only"},
    .size = sizeof(Options),
    .perform = perform,
};
