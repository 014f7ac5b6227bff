#include "revision.h"

#include <stdio.h>
#include <string.h>

#include "../system/process.h"

enum { PATH = BENCH_DRAFT_PATH };

typedef struct {
    const char *name, *said; /* the revision; the file of what building it says */
    BenchProgress *progress;
} Build;

/* The share of the build that is done, from a line "[12/220] ..." (Ninja) or "[ 12%] ..." (make).
 */
static void show_share(void *context)
{
    const Build *build = context;
    char line[128], what[64];
    int done = 0, all = 100;
    bench_process_last_line(build->said, NULL, sizeof line, line);
    if (sscanf(line, "[%d/%d]", &done, &all) != 2) {
        all = 100;
        if (sscanf(line, "[%d%%]", &done) != 1) done = 0;
    }
    snprintf(what, sizeof what, "building %.24s", build->name);
    bench_progress_show(build->progress, what, all > 0 ? (double)done / all : 0);
}

SmCode bench_revision_build(const char *name, const char *folder, BenchProgress *progress,
                            BenchRevision *revision, SmError *error)
{
    char script[PATH], said[PATH], cache[PATH], line[PATH + 64];
    *revision = (BenchRevision){0};
    snprintf(said, sizeof said, "%.4000s/revision.txt", folder);
    bench_program_folder(cache);
    strcat(cache, "/CMakeCache.txt");
    SmCode code = bench_script_find("build_revision", script, error);
    if (code) return code;
    const char *const words[] = {script, name, cache, NULL};
    Build build = {name, said, progress};
    BenchProcess process = {.word = words, .output = said, .tick = show_share, .context = &build};
    BenchProcessEnd end;
    code = bench_process_run(&process, &end, error);
    bench_progress_stop(progress);
    if (code) return code;
    bench_process_last_line(said, NULL, sizeof line, line);
    if (end.status)
        return sm_fail(error, end.status == SM_OUTPUT ? SM_OUTPUT : SM_INPUT, "%.500s", line);
    sscanf(line, "%63s %4095[^\n]", revision->commit, revision->program);
    return SM_OK;
}
