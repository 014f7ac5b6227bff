#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/shapes/shape.h"
#include "../scene/body.h"
#include "../store/draft.h"
#include "command.h"

typedef struct {
    BenchCommon common;
    const char *write; /* mesh file to write */
    bool overwrite, settings;
} Options;

static const BenchSetting settings[] = {
    {BENCH_OPTION("write-mesh", "FILE.obj", 1,
                  "Write the mesh of the scene or shape NAME instead, as Wavefront OBJ"),
     BENCH_IN(Options, write)},
    BENCH_OVERWRITE_OPTION(Options, overwrite, 1),
    {BENCH_OPTION("settings", NULL, 1,
                  "List all settings of a scene file, with ranges and defaults, and end"),
     BENCH_IN(Options, settings)},
    {0},
};

static void check(const struct argp_state *state, void *record)
{
    const Options *options = record;
    bool named = options->common.words;
    if (options->write && !named) bench_usage(state, "--write-mesh: which shape?");
    if (options->overwrite && !options->write)
        bench_usage(state, "--overwrite goes with --write-mesh");
    if (options->settings && named)
        bench_usage(state, "--settings goes alone: it lists what every scene file can say");
}

static const char help[] =
    "List the built-in scenes and shapes; with NAME, print that scene's file, which can be copied, "
    "edited (--settings explains what it says) and run.\n"
    "  shapebench scenes penguin > my.cfg\n"
    "  shapebench run my.cfg\v" BENCH_EXIT_CODES;

static SmCode list(SmError *error)
{
    puts("Scenes:");
    for (const char *const *name = bench_scene_names(); *name; name++) {
        BenchScene scene;
        SmCode code = bench_scene_find(*name, &scene, error);
        if (code) return code;
        printf("  %-20s %s\n", *name, scene.title);
    }
    int count;
    const SmShape *shape = sm_shapes(&count);
    puts("\nShapes (mesh = \"shape:NAME\" in a scene file; --write-mesh exports one):");
    for (int i = 0; i < count; i++)
        printf("  %-16s %s (%ld triangles)\n", shape[i].name, shape[i].description,
               shape[i].triangles);
    return SM_OK;
}

static SmCode print_scene(const char *name, SmError *error)
{
    size_t size;
    const char *text = bench_scene_text(name, &size);
    char near[BENCH_SUGGEST_TEXT];
    if (!text)
        return sm_fail(error, SM_USAGE,
                       "'%.100s' is not a built-in scene; 'shapebench scenes' lists them%s", name,
                       bench_scene_suggest(name, near));
    fwrite(text, 1, size, stdout);
    return SM_OK;
}

static SmCode write_mesh(const Options *options, SmError *error)
{
    const char *name = options->common.word[0], *path = options->write;
    SmMesh mesh;
    BenchScene scene;
    SmCode code = bench_draft_reserve(path, options->overwrite, error);
    if (code) return code;
    if (bench_scene_text(name, NULL)) {
        code = bench_scene_find(name, &scene, error);
        if (!code) code = bench_mesh_load(scene.mesh, &mesh, error);
    } else {
        code = sm_shape_mesh(name, &mesh, error);
    }
    if (code) return code;
    code = bench_draft_write(path, bench_print_mesh, &mesh, error);
    sm_mesh_free(&mesh);
    return code;
}

static void list_settings(void)
{
    BenchScene *defaults = sm_alloc(1, sizeof *defaults);
    bench_scene_init(defaults);
    puts("A scene file (NAME.cfg) has lines NAME = VALUE; in any order. Lengths are in the mesh's\n"
         "units, times in seconds, angles in radians; y is up. Numbers in [ ] all need a decimal\n"
         "point. What is left out has its default. The scene hand has handles, flower forces,\n"
         "penguins obstacles, beam-cut a cut, flowers a touch, hand-stiffness criteria and "
         "widths.\n");
    bench_settings_document(stdout, bench_scene_settings, defaults, 0);
    free(defaults);
}

static SmCode perform(void *record, int argc, char **argv, SmError *error)
{
    const Options *options = record;
    (void)argc, (void)argv;
    if (options->write) return write_mesh(options, error);
    if (options->common.words) return print_scene(options->common.word[0], error);
    if (!options->settings) return list(error);
    list_settings();
    return SM_OK;
}

const BenchCommand bench_command_scenes = {
    .name = "scenes",
    .summary = "list the built-in scenes, or print one to copy and edit",
    .line = {settings, 0, "[NAME]", help, check, .most = 1, .limit = "One NAME only"},
    .size = sizeof(Options),
    .perform = perform,
};
