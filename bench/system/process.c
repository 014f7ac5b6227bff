#define _GNU_SOURCE
#include "process.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "interrupt.h"

static volatile sig_atomic_t caught;

static void note(int number)
{
    if (!caught) caught = number;
}

void bench_process_catch(void)
{
    for (int i = 0; i < BENCH_INTERRUPT_SIGNALS; i++)
        bench_interrupt_handle(bench_interrupt_signals[i], note);
}

int bench_process_caught(void)
{
    return caught;
}

/* In the child; waits for the parent's word (`start` closes), then becomes the program. */
static void become(const BenchProcess *process, int start, int failure, pid_t parent)
{
    char byte;
    for (int s = 1; s < NSIG; s++) signal(s, SIG_DFL);
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent || read(start, &byte, 1) != 0) _exit(127);
    int in = open("/dev/null", O_RDONLY);
    int out =
        open(process->output ? process->output : "/dev/null", O_WRONLY | O_CREAT | O_TRUNC, 0600);
    bool ready = in >= 0 && out >= 0 && dup2(in, 0) >= 0 && dup2(out, 1) >= 0 && dup2(out, 2) >= 0;
    if (ready) execvp(process->word[0], (char *const *)process->word);
    int number = errno;
    ssize_t written = write(failure, &number, sizeof number);
    (void)written;
    _exit(127);
}

/* Ten seconds to tidy up are enough for all but what does not end. */
static void stop_group(pid_t pid, int *status)
{
    kill(-pid, SIGTERM);
    for (int i = 0; i < 500; i++) {
        if (waitpid(pid, status, WNOHANG) == pid) break;
        nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    }
    kill(-pid, SIGKILL);
    while (waitpid(pid, status, 0) < 0 && errno == EINTR) continue;
}

/* Waits for the end, ticking; false when interrupted, and then all is stopped. */
static bool await(const BenchProcess *process, pid_t pid, int *status)
{
    for (long naps = 0;; naps++) {
        pid_t ended = waitpid(pid, status, WNOHANG);
        if (ended == pid || (ended < 0 && errno != EINTR)) return true;
        if (caught) {
            stop_group(pid, status);
            return false;
        }
        if (process->tick && naps % 20 == 0) process->tick(process->context);
        nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
    }
}

static SmCode oversee(const BenchProcess *process, pid_t pid, BenchProcessEnd *end, SmError *error)
{
    int status = 0;
    bool whole = await(process, pid, &status);
    kill(-pid, SIGKILL); /* whatever it has left behind */
    end->status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (!whole) return sm_fail(error, SM_INPUT, "interrupted; nothing is left behind");
    return SM_OK;
}

SmCode bench_process_run(const BenchProcess *process, BenchProcessEnd *end, SmError *error)
{
    int start[2], failure[2], number = 0;
    if (caught) return sm_fail(error, SM_INPUT, "interrupted; nothing is left behind");
    if (pipe2(start, O_CLOEXEC) != 0)
        return sm_fail(error, SM_INPUT, "no pipe can be made: %s", strerror(errno));
    if (pipe2(failure, O_CLOEXEC) != 0) {
        close(start[0]);
        close(start[1]);
        return sm_fail(error, SM_INPUT, "no pipe can be made: %s", strerror(errno));
    }
    fflush(NULL);
    pid_t parent = getpid(), pid = fork();
    if (pid == 0) {
        close(start[1]);
        become(process, start[0], failure[1], parent);
    }
    if (pid > 0) setpgid(pid, pid);
    close(start[0]);
    close(start[1]);
    close(failure[1]);
    if (pid < 0) number = errno;
    SmCode code = SM_OK;
    if (pid > 0 && read(failure[0], &number, sizeof number) == sizeof number)
        waitpid(pid, NULL, 0);
    else if (pid > 0)
        code = oversee(process, pid, end, error);
    close(failure[0]);
    if (number)
        return sm_fail(error, SM_INPUT, "%.100s cannot be started: %s", process->word[0],
                       strerror(number));
    return code;
}

bool bench_process_last_line(const char *path, const char *words, size_t size, char *line)
{
    char text[PATH_MAX + 128];
    line[0] = '\0';
    FILE *file = fopen(path, "re");
    while (file && fgets(text, sizeof text, file)) {
        const char *start = text + strspn(text, " \t");
        text[strcspn(text, "\r\n")] = '\0';
        if (words ? strstr(text, words) != NULL : *start) snprintf(line, size, "%s", start);
    }
    if (file) fclose(file);
    return line[0];
}

bool bench_program_path(char path[PATH_MAX])
{
    ssize_t length = readlink("/proc/self/exe", path, PATH_MAX - 64);
    path[length > 0 ? length : 0] = '\0';
    return length > 0;
}

void bench_program_folder(char path[PATH_MAX])
{
    bench_program_path(path);
    char *name = strrchr(path, '/');
    if (name) *name = '\0';
}

SmCode bench_script_find(const char *name, char path[PATH_MAX], SmError *error)
{
    char folder[PATH_MAX];
    bench_program_folder(folder);
    snprintf(path, PATH_MAX, "%.4000s/../share/shapebench/%.60s", folder, name);
    if (!access(path, R_OK)) return SM_OK;
    snprintf(path, PATH_MAX, "%s/%.60s", SHAPEBENCH_SCRIPTS, name);
    if (!access(path, R_OK)) return SM_OK;
    return sm_fail(error, SM_INPUT,
                   "%.300s is missing: install shapebench again, or keep its sources", path);
}

SmCode bench_scratch_make(char folder[PATH_MAX], SmError *error)
{
    const char *base = getenv("TMPDIR");
    if (!base || !base[0] || strlen(base) > 3800) base = "/tmp";
    snprintf(folder, PATH_MAX, "%.3800s/shapebench_XXXXXX", base);
    if (mkdtemp(folder)) return SM_OK;
    return sm_fail(error, SM_OUTPUT, "cannot write %.300s: %s; set TMPDIR to a folder of yours",
                   folder, strerror(errno));
}

void bench_scratch_remove(const char *folder)
{
    char path[PATH_MAX];
    DIR *all = opendir(folder);
    for (struct dirent *entry; all && (entry = readdir(all));) {
        snprintf(path, sizeof path, "%.3830s/%.255s", folder, entry->d_name);
        unlink(path); /* "." and ".." stay */
    }
    if (all) closedir(all);
    rmdir(folder);
}
