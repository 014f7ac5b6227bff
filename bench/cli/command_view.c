#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/mesh/reader.h"
#include "../engines.h"
#include "../scene/body.h"
#include "../store/draft.h"
#include "../system/process.h"
#include "../system/remark.h"
#include "command.h"

typedef struct {
    BenchCommon common;
    const char *output;
    bool overwrite;
} Options;

static const BenchSetting settings[] = {
    {BENCH_OUTPUT_OPTION("FILE.html", 1, "Write the page there (default: view.html)"),
     BENCH_IN(Options, output)},
    BENCH_OVERWRITE_OPTION(Options, overwrite, 1),
    {0},
};

static const char help[] =
    "Make a page that runs both engines in a browser on a scene or a mesh: pull it, cut it, turn w "
    "and epsilon. One file, without a server or a network.\v"
    "SCENE: a built-in scene or a scene file, whose mesh the page carries (default: penguin). "
    "MESH: as of run; it drops on the ground. 'scripts/run view' of a clone builds the page of "
    "that clone's engines, and films it.\n" BENCH_EXIT_CODES;

/* What the page is to open: a scene's text, a mesh; files, or empty. */
typedef struct {
    char folder[PATH_MAX]; /* for those that are made of it */
    char text[PATH_MAX], mesh[PATH_MAX];
} Given;

static void print_text(FILE *file, const void *what)
{
    fputs(what, file);
}

/* The file itself where the page reads its format; else all of it as OBJ. */
static SmCode take_mesh(const char *path, const SmMesh *mesh, Given *given, SmError *error)
{
    char name[BENCH_NAME];
    bool shape = !strncmp(path, "shape:", 6);
    snprintf(given->mesh, sizeof given->mesh, "%s", path);
    if (!shape && sm_mesh_readable(path)) return SM_OK;
    bench_mesh_name(shape ? path + 6 : path, name);
    snprintf(given->mesh, sizeof given->mesh, "%.4000s/%s.obj", given->folder, name);
    return bench_draft_write(given->mesh, bench_print_mesh, mesh, error);
}

/* Its mesh keeps the name that the text has. */
static SmCode take_scene(const char *name, const BenchScene *scene, Given *given, SmError *error)
{
    const char *text = bench_scene_text(name, NULL);
    bool own = bench_engine(scene->engine)->own & BENCH_OF_ELASTIC;
    if (own && strcmp(name, "beam-elastic") != 0 && strcmp(name, "balljoint") != 0)
        bench_remark("%s: the page has the elastic bodies of beam-elastic and balljoint alone; "
                     "'scripts/run view' of a clone makes one with others",
                     name);
    bool shape = !strncmp(scene->mesh, "shape:", 6);
    if (!shape) snprintf(given->mesh, sizeof given->mesh, "%s", scene->mesh);
    if (!shape && !sm_mesh_readable(scene->mesh))
        return sm_fail(error, SM_INPUT,
                       "%s: the page opens OBJ, PLY, STL, OFF, glTF and GLB meshes; save it as one",
                       scene->mesh);
    snprintf(given->text, sizeof given->text, "%s", name);
    if (!text) return SM_OK;
    snprintf(given->text, sizeof given->text, "%.4000s/scene.cfg", given->folder);
    return bench_draft_write(given->text, print_text, text, error);
}

/* Reads all of it, so that what is damaged is told here. */
static SmCode take(const char *name, Given *given, SmError *error)
{
    BenchScene scene;
    SmMesh mesh;
    bool named = bench_scene_named(name);
    SmCode code = named ? bench_scene_find(name, &scene, error) : SM_OK;
    if (!code) code = bench_mesh_load(named ? scene.mesh : name, &mesh, error);
    if (code) return code;
    code = named ? take_scene(name, &scene, given, error) : take_mesh(name, &mesh, given, error);
    sm_mesh_free(&mesh);
    return code;
}

/* The page that comes along, with that in it. */
static SmCode make_page(const Given *given, const char *output, SmError *error)
{
    char script[PATH_MAX], page[PATH_MAX], log[PATH_MAX], line[256];
    BenchDraft draft;
    SmCode code = bench_script_find("view/build.py", script, error);
    if (!code && bench_script_find("page.html", page, NULL))
        code = bench_script_find("../results/page.html", page, error);
    if (!code) code = bench_draft_begin(output, &draft, error);
    if (code) return code;
    snprintf(log, sizeof log, "%.4000s/log", given->folder);
    const char *const word[] = {"python3", script, page, draft.tmp, given->text, given->mesh, NULL};
    BenchProcess process = {.word = word, .output = log};
    BenchProcessEnd end = {0};
    SmError why;
    if (bench_process_run(&process, &end, &why))
        code = sm_fail(error, SM_INPUT, "%s%s", why.text,
                       bench_process_caught() ? "" : "; python3 makes the page: install it");
    else if (end.status)
        code = sm_fail(error, end.status == SM_OUTPUT ? SM_OUTPUT : SM_INPUT, "%s",
                       bench_process_last_line(log, NULL, sizeof line, line)
                           ? line
                           : "python3 made no page, and does not say why");
    if (!code) return bench_draft_commit(&draft, error);
    bench_draft_discard(&draft);
    return code;
}

static SmCode perform(void *record, int argc, char **argv, SmError *error)
{
    const Options *options = record;
    const BenchCommon *common = &options->common;
    (void)argc, (void)argv;
    Given given = {.text = ""};
    bench_process_catch();
    SmCode code = bench_draft_reserve(options->output, options->overwrite, error);
    if (!code) code = bench_scratch_make(given.folder, error);
    if (code) return code;
    code = take(common->words ? common->word[0] : "penguin", &given, error);
    if (!code) code = make_page(&given, options->output, error);
    bench_scratch_remove(given.folder);
    int caught = bench_process_caught();
    if (!code && !common->quiet) printf("wrote %s: open it in a browser\n", options->output);
    return caught ? (SmCode)(128 + caught) : code;
}

static const Options defaults = {.output = "view.html"};

const BenchCommand bench_command_view = {
    .name = "view",
    .summary = "make a page that runs a scene or a mesh in a browser",
    .line = {settings, BENCH_TAKES_QUIET, "[SCENE|FILE.cfg|MESH]", help, .most = 1,
             .limit = "One scene or mesh only"},
    .size = sizeof(Options),
    .defaults = &defaults,
    .perform = perform,
};
