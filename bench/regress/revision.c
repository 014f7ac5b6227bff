#include "revision.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../../lib/system/hash.h"
#include "../system/process.h"

enum { PATH = BENCH_DRAFT_PATH, WORDS = 24, SETTING = 512 };

typedef struct {
    char root[PATH], source[PATH], build[PATH], log[PATH]; /* the worktree, its build folder */
    char answer[PATH];                                     /* what a git command said */
    char generator[SETTING];
    char setting[8][SETTING]; /* -DNAME=VALUE */
    int settings;
    BenchProgress *progress;
    const char *name;
} Build;

/* Runs git with these words (NULL-terminated), its first line into `line`. */
static SmCode git(const Build *build, char *const *word, size_t size, char *line, int *status,
                  SmError *error)
{
    char *all[WORDS] = {"git"};
    int count = 1;
    if (build->root[0]) {
        all[count++] = "-C";
        all[count++] = (char *)build->root;
    }
    while (*word && count < WORDS - 1) all[count++] = *word++;
    BenchProcess process = {.word = all, .output = build->answer, .tidying = true};
    BenchProcessEnd end;
    SmCode code = bench_process_run(&process, &end, error);
    if (code) return code;
    bench_process_last_line(build->answer, size, line);
    *status = end.status;
    return SM_OK;
}

static SmCode find_commit(Build *build, char commit[64], SmError *error)
{
    char line[PATH], wanted[256];
    int status;
    char *top[] = {"rev-parse", "--show-toplevel", NULL};
    SmCode code = git(build, top, sizeof line, line, &status, error);
    if (code) return code;
    if (status)
        return sm_fail(error, SM_INPUT,
                       "--revision: this folder is in no git repository (%.200s); change to your "
                       "clone of shapebench",
                       line);
    snprintf(build->root, sizeof build->root, "%s", line);
    snprintf(wanted, sizeof wanted, "%.200s^{commit}", build->name);
    char *verify[] = {"rev-parse", "--verify", "--quiet", "--end-of-options", wanted, NULL};
    code = git(build, verify, sizeof line, line, &status, error);
    if (code) return code;
    if (status || strlen(line) < 40 || strlen(line) > 63)
        return sm_fail(error, SM_INPUT, "--revision: %.200s has no revision '%.100s'", build->root,
                       build->name);
    snprintf(commit, 64, "%.63s", line);
    return SM_OK;
}

/* Takes a setting over from a line NAME:TYPE=VALUE of a CMake cache. */
static void take_setting(Build *build, const char *line)
{
    static const char *const names[] = {"CMAKE_C_COMPILER",  "CMAKE_BUILD_TYPE",
                                        "CMAKE_C_FLAGS",     "CMAKE_C_COMPILER_LAUNCHER",
                                        "SHAPEBENCH_NATIVE", "SHAPEBENCH_SANITIZE"};
    size_t length = strcspn(line, ":");
    const char *value = strchr(line, '=');
    if (!value) return;
    if (!strncmp(line, "CMAKE_GENERATOR:", 16))
        snprintf(build->generator, SETTING, "%.500s", value + 1);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (length == strlen(names[i]) && !strncmp(line, names[i], length) && value[1])
            snprintf(build->setting[build->settings++], SETTING, "-D%s=%.450s", names[i],
                     value + 1);
}

/* How the running program was built, from the CMake cache beside it; a release build where there is
 * none. */
static void find_settings(Build *build)
{
    char path[PATH], line[1024];
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - 32);
    path[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(path, '/');
    if (slash) strcpy(slash, "/CMakeCache.txt");
    FILE *file = fopen(path, "re");
    while (file && fgets(line, sizeof line, file) && build->settings < 6) {
        line[strcspn(line, "\n")] = '\0';
        take_setting(build, line);
    }
    if (file) fclose(file);
    if (!build->settings) strcpy(build->setting[build->settings++], "-DCMAKE_BUILD_TYPE=Release");
    strcpy(build->setting[build->settings++], "-DSHAPEBENCH_WERROR=OFF");
    /* what is measured runs no ranks, and older ones do not configure with half of an MPI */
    strcpy(build->setting[build->settings++], "-DCMAKE_DISABLE_FIND_PACKAGE_MPI=ON");
}

/* Of the settings, so that builds with others are kept apart. */
static unsigned hash_settings(const Build *build)
{
    unsigned long long hash = SM_HASH_START;
    for (int i = 0; i < build->settings; i++)
        hash = sm_hash_bytes(hash, build->setting[i], strlen(build->setting[i]));
    return (unsigned)(hash ^ hash >> 32);
}

static SmCode make_folder(const char *path, SmError *error)
{
    if (mkdir(path, 0777) == 0 || errno == EEXIST) return SM_OK;
    return bench_draft_fail(path, errno, "", error);
}

static SmCode find_places(Build *build, BenchRevision *revision, SmError *error)
{
    char folder[PATH];
    if (strlen(build->root) > PATH - 256)
        return bench_draft_fail(build->root, ENAMETOOLONG, "", error);
    snprintf(folder, sizeof folder, "%.3800s/build", build->root);
    SmCode code = make_folder(folder, error);
    if (code) return code;
    snprintf(folder, sizeof folder, "%.3800s/build/regress", build->root);
    code = make_folder(folder, error);
    if (code) return code;
    snprintf(revision->program, PATH, "%.3850s/%s-%08x", folder, revision->commit,
             hash_settings(build));
    snprintf(build->source, PATH, "%.4000s.source", revision->program);
    snprintf(build->build, PATH, "%.4000s/build", build->source);
    snprintf(build->log, PATH, "%.4000s.log", revision->program);
    return SM_OK;
}

static void remove_worktree(const Build *build)
{
    char line[256];
    int status;
    struct stat found;
    if (stat(build->source, &found) != 0) return;
    char *words[] = {"worktree", "remove", "--force", "--force", (char *)build->source, NULL};
    char *prune[] = {"worktree", "prune", NULL};
    char *rm[] = {"rm", "-rf", "--", (char *)build->source, NULL};
    BenchProcess process = {.word = rm, .tidying = true};
    BenchProcessEnd end;
    if (git(build, words, sizeof line, line, &status, NULL) == SM_OK && status == 0) return;
    bench_process_run(&process, &end, NULL);
    git(build, prune, sizeof line, line, &status, NULL);
}

/* The share of the build that is done, from the log's "[12/220] ..." (Ninja) or "[ 12%] ..."
 * (make). */
static void show_share(void *context)
{
    const Build *build = context;
    char line[128], what[64];
    int done = 0, all = 100;
    bench_process_last_line(build->log, sizeof line, line);
    if (sscanf(line, "[%d/%d]", &done, &all) != 2) {
        all = 100;
        if (sscanf(line, "[%d%%]", &done) != 1) done = 0;
    }
    snprintf(what, sizeof what, "building %.24s", build->name);
    bench_progress_show(build->progress, what, all > 0 ? (double)done / all : 0);
}

/* The first line of the log that speaks of an error, or its last one. */
static void find_error(const Build *build, size_t size, char *line)
{
    char text[512];
    bench_process_last_line(build->log, size, line);
    FILE *file = fopen(build->log, "re");
    while (file && fgets(text, sizeof text, file)) {
        if (!strstr(text, "rror:") && !strstr(text, "CMake Error")) continue;
        text[strcspn(text, "\n")] = '\0';
        snprintf(line, size, "%.*s", (int)size - 1, text);
        break;
    }
    if (file) fclose(file);
}

static SmCode run_logged(const Build *build, char *const *word, SmError *error)
{
    BenchProcess process = {
        .word = word, .output = build->log, .tick = show_share, .context = (void *)build};
    BenchProcessEnd end;
    SmCode code = bench_process_run(&process, &end, error);
    if (code || end.status == 0) return code;
    char line[160];
    find_error(build, sizeof line, line);
    return sm_fail(error, SM_INPUT,
                   "--revision: %.60s does not build: %.150s; all it said is in %.200s",
                   build->name, line, build->log);
}

static SmCode compile(const Build *build, SmError *error)
{
    char *configure[WORDS] = {"cmake", "-S", (char *)build->source, "-B", (char *)build->build};
    int count = 5;
    if (build->generator[0]) {
        configure[count++] = "-G";
        configure[count++] = (char *)build->generator;
    }
    for (int i = 0; i < build->settings; i++) configure[count++] = (char *)build->setting[i];
    char *make[] = {"cmake", "--build", (char *)build->build, "--target", "shapebench", NULL};
    SmCode code = run_logged(build, configure, error);
    return code ? code : run_logged(build, make, error);
}

static SmCode check_out(Build *build, const char *commit, SmError *error)
{
    char line[256];
    int status;
    /* forced, twice: git may still know one there that somebody has deleted, or that was locked */
    char *words[] = {"worktree", "add",         "--force",      "--force", "--detach",
                     "--quiet",  build->source, (char *)commit, NULL};
    SmCode code = git(build, words, sizeof line, line, &status, error);
    if (!code && status)
        code = sm_fail(error, SM_OUTPUT, "--revision: git cannot check %.60s out: %.250s",
                       build->name, line);
    return code;
}

/* Under the lock: nobody else builds, and a worktree that is there was left by one who was killed.
 */
static SmCode make_program(Build *build, BenchRevision *revision, SmError *error)
{
    char made[PATH];
    if (access(revision->program, X_OK) == 0) return SM_OK;
    remove_worktree(build);
    SmCode code = check_out(build, revision->commit, error);
    if (!code) code = compile(build, error);
    snprintf(made, sizeof made, "%.4050s/shapebench", build->build);
    if (!code && rename(made, revision->program) != 0)
        code =
            sm_fail(error, SM_INPUT, "--revision: %.60s builds no program shapebench", build->name);
    if (!code) {
        unlink(build->log);
        revision->built = true;
    }
    remove_worktree(build);
    return code;
}

/* Takes the lock, waiting for who holds it; -1 and `error` where that is not to be had. */
static int take_lock(const Build *build, SmError *error)
{
    char path[PATH];
    snprintf(path, sizeof path, "%.3800s/build/regress/lock", build->root);
    int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    bool held = false;
    while (file >= 0 && !bench_process_caught() && !(held = flock(file, LOCK_EX) == 0))
        if (errno != EINTR) break;
    if (held) return file;
    if (bench_process_caught())
        sm_fail(error, SM_INPUT, "interrupted; nothing is left behind");
    else
        bench_draft_fail(path, errno, "", error);
    if (file >= 0) close(file);
    return -1;
}

SmCode bench_revision_build(const char *name, const char *folder, BenchProgress *progress,
                            BenchRevision *revision, SmError *error)
{
    Build *build = sm_alloc(1, sizeof *build);
    *revision = (BenchRevision){0};
    build->name = name;
    build->progress = progress;
    snprintf(build->answer, PATH, "%.4000s/git.txt", folder);
    find_settings(build);
    SmCode code = find_commit(build, revision->commit, error);
    if (!code) code = find_places(build, revision, error);
    if (!code) {
        int lock = take_lock(build, error);
        code = lock < 0 ? error->code : make_program(build, revision, error);
        if (lock >= 0) close(lock);
    }
    bench_progress_stop(progress);
    free(build);
    return code;
}
