#define _GNU_SOURCE
#include "child.h"
#include "../error.h"
#include "clock.h"
#include "team.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const double megabyte = 1024.0 * 1024.0;

static void limit(int resource, double value)
{
    struct rlimit old, new;
    if (getrlimit((__rlimit_resource_t)resource, &old) != 0) return;
    new = old;
    new.rlim_cur = value < 1e18 ? (rlim_t)value : RLIM_INFINITY;
    if (new.rlim_cur > old.rlim_max) new.rlim_cur = old.rlim_max;
    new.rlim_max = new.rlim_cur;
    setrlimit((__rlimit_resource_t)resource, &new);
}

/* What the parent has already and the child inherits, in bytes. */
typedef struct {
    double mapped, resident;
} Memory;

static Memory own_memory(void)
{
    long mapped = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%ld %ld", &mapped, &resident) != 2) mapped = resident = 0;
    if (file) fclose(file);
    double page = (double)sysconf(_SC_PAGESIZE);
    return (Memory){(double)mapped * page, (double)resident * page};
}

/* The parent's signal handlers would tidy up the parent's files. */
static void reset_signals(void)
{
    sigset_t none;
    for (int s = 1; s < NSIG; s++) signal(s, SIG_DFL);
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
}

static void close_others(int keep)
{
    int null = open("/dev/null", O_RDWR);
    for (int stream = 0; null >= 0 && stream < 3; stream++)
        if (stream != keep) dup2(null, stream);
    if (keep > 3) close_range(3, (unsigned)keep - 1, 0);
    close_range((unsigned)(keep > 2 ? keep + 1 : 3), ~0U, 0);
}

/* Runs in the child; never returns. */
static void child(SmChildBody body, void *argument, const SmChildLimits *limits, int reply,
                  double inherited, pid_t parent)
{
    reset_signals();
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    close_others(reply);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, ceil(limits->seconds) + 1);
    omp_set_num_threads(1); /* the parent's threads are not here */
    if (SM_CHILD_LIMITS_MEMORY) limit(RLIMIT_AS, inherited + limits->megabytes * megabyte);
    _exit(body(argument, reply));
}

/* Appends what the pipe holds. 1: more may come, 0: end, -1: larger than `most`. */
static int read_some(int pipe_end, SmChildResult *result, size_t *room, double most)
{
    if (*room - result->size < 65536) {
        *room = *room * 2 + 131072;
        result->reply = sm_realloc(result->reply, *room, 1);
    }
    ssize_t got = read(pipe_end, result->reply + result->size, *room - result->size);
    if (got < 0) return errno == EINTR || errno == EAGAIN;
    result->size += (size_t)got;
    return (double)result->size > most ? -1 : got > 0;
}

/* Collects the reply up to its end, the deadline or the size limit. */
static SmChildEnd collect(int pipe_end, const SmChildLimits *limits, double deadline,
                          SmChildResult *result)
{
    size_t room = 0;
    for (;;) {
        double left = deadline - sm_now();
        if (left <= 0) return SM_CHILD_TOO_LONG;
        struct pollfd ready = {.fd = pipe_end, .events = POLLIN};
        int count = poll(&ready, 1, (int)fmin(ceil(left * 1000), 1e6));
        if (count <= 0) continue;
        int more = read_some(pipe_end, result, &room, limits->megabytes * megabyte);
        if (more < 0) return SM_CHILD_TOO_LARGE;
        if (more == 0) return SM_CHILD_REPLIED;
    }
}

/* Waits until the deadline for a child that has closed its pipe. False: still running. A parent
 * that ignores SIGCHLD has no status to wait for and sees an end with status 0. */
static bool wait_until(pid_t pid, double deadline, int *status, struct rusage *usage)
{
    *status = 0;
    for (;;) {
        pid_t ended = wait4(pid, status, WNOHANG, usage);
        if (ended == pid || (ended < 0 && errno != EINTR)) return true;
        if (sm_now() >= deadline) return false;
        nanosleep(&(struct timespec){.tv_nsec = 200000}, NULL);
    }
}

static void kill_child(pid_t pid)
{
    kill(pid, SIGKILL);
    while (waitpid(pid, NULL, 0) < 0 && errno == EINTR) continue;
}

/* A C++ library without memory aborts or dies of a null pointer: most of the limit having been in
 * use, beside what was inherited, tells that from other crashes. */
static SmChildEnd judge(int status, double peak_bytes, const SmChildLimits *limits,
                        SmChildResult *result)
{
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return SM_CHILD_REPLIED;
    if (WIFEXITED(status) && WEXITSTATUS(status) == SM_CHILD_NO_MEMORY) return SM_CHILD_TOO_LARGE;
    result->status = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    result->signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    if (result->signal == SIGXCPU) return SM_CHILD_TOO_LONG;
    return peak_bytes > 0.75 * limits->megabytes * megabyte ? SM_CHILD_TOO_LARGE : SM_CHILD_CRASHED;
}

static void oversee(pid_t pid, int pipe_end, const SmChildLimits *limits, double inherited,
                    double deadline, SmChildResult *result)
{
    int status;
    struct rusage usage = {0};
    result->end = collect(pipe_end, limits, deadline, result);
    if (result->end != SM_CHILD_REPLIED) {
        kill_child(pid);
    } else if (!wait_until(pid, deadline, &status, &usage)) {
        kill_child(pid);
        result->end = SM_CHILD_TOO_LONG;
    } else {
        result->end = judge(status, (double)usage.ru_maxrss * 1024 - inherited, limits, result);
    }
}

SmChildResult sm_child_run(SmChildBody body, void *argument, const SmChildLimits *limits)
{
    SmChildResult result = {.end = SM_CHILD_FAILED};
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) {
        result.status = errno;
        return result;
    }
    Memory inherited = own_memory();
    double deadline = sm_now() + limits->seconds;
    pid_t parent = getpid(), pid = fork();
    if (pid == 0) child(body, argument, limits, ends[1], inherited.mapped, parent);
    result.status = pid < 0 ? errno : 0;
    close(ends[1]);
    if (pid > 0) oversee(pid, ends[0], limits, inherited.resident, deadline, &result);
    close(ends[0]);
    return result;
}
