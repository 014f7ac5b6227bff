/* test_program.h - the program as a user runs it, in the test's folder. */
#ifndef BENCH_TEST_PROGRAM_H
#define BENCH_TEST_PROGRAM_H

#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "../../lib/test_folder.h"

typedef struct {
    int code; /* exit code, or 1000 + signal */
    char out[65536], err[4096];
} Result;

/* The text of a file in the test's folder. */
static inline void slurp(const char *name, char *text, size_t room)
{
    FILE *file = fopen(path_in(name), "r");
    size_t size = file ? fread(text, 1, room - 1, file) : 0;
    text[size] = '\0';
    if (file) fclose(file);
}

/* Runs "PREFIX shapebench ARGUMENTS" by a shell in the test's folder. */
static inline void run_with(const char *prefix, const char *arguments, Result *result)
{
    char command[2048];
    snprintf(command, sizeof command, "cd %s && %s '%s/shapebench' %s >out 2>err", folder, prefix,
             BINARY_DIR, arguments);
    int status = system(command);
    result->code = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    slurp("out", result->out, sizeof result->out);
    slurp("err", result->err, sizeof result->err);
}

static inline void run(const char *arguments, Result *result)
{
    run_with("", arguments, result);
}

/* The same by two processes of mpirun. Where there is none, or the program was built without MPI
 * and says so, the test ends as skipped. */
static inline void run_ranks(const char *arguments, Result *result)
{
    needs(system("command -v mpirun >/dev/null 2>&1") == 0, "no mpirun here (openmpi-bin)");
    run_with("ASAN_OPTIONS=detect_leaks=0 mpirun --allow-run-as-root --oversubscribe -n 2",
             arguments, result);
    if (!strstr(result->err, "built without MPI")) return;
    assert_int_equal(result->code, 2);
    skip_because("built without MPI (libopenmpi-dev): only its refusal is tested");
}

/* Starts "shapebench ARGUMENTS", interrupts it (SIGINT) as soon as the file is there, and returns
 * its exit code, or 1000 + signal. */
static inline int interrupt(const char *arguments, const char *file)
{
    char command[2048];
    snprintf(command, sizeof command, "cd %s && exec '%s/shapebench' %s >out 2>err", folder,
             BINARY_DIR, arguments);
    pid_t child = fork();
    if (child == 0) {
        execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(98);
    }
    int status;
    while (access(path_in(file), F_OK) != 0 && waitpid(child, &status, WNOHANG) == 0)
        nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
    assert_int_equal(kill(child, SIGINT), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

/* A mistake: its exit code, and what its one line on standard error says. */
typedef struct {
    const char *arguments;
    int code;
    const char *wanted;
} Mistake;

static inline void make_mistakes(const Mistake *mistakes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        Result result;
        run(mistakes[i].arguments, &result);
        const char *end = strchr(result.err, '\n');
        bool line = end && !end[1] && !strncmp(result.err, "shapebench", 10);
        if (result.code != mistakes[i].code || !line || !strstr(result.err, mistakes[i].wanted))
            fail_msg("shapebench %s: exit code %d (wanted %d), standard error:\n%s",
                     mistakes[i].arguments, result.code, mistakes[i].code, result.err);
        assert_string_equal(result.out, "");
    }
}

#endif
