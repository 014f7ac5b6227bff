#define _GNU_SOURCE
#include "confine.h"

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#if __has_include(<linux/landlock.h>)
#include <linux/landlock.h>
#endif
#include <linux/seccomp.h>
#ifdef SHAPEBENCH_SECCOMP
#include <seccomp.h>
#endif

#ifdef LANDLOCK_ACCESS_FS_READ_FILE

static void allow(int rules, const char *path)
{
    struct landlock_path_beneath_attr rule = {.allowed_access = LANDLOCK_ACCESS_FS_READ_FILE};
    rule.parent_fd = open(path, O_PATH | O_CLOEXEC);
    if (rule.parent_fd < 0) return;
    syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
    close(rule.parent_fd);
}

/* All that the first version of Landlock knows is forbidden but for reading these. */
static bool confine_files(const char *folder, const char *file)
{
    struct landlock_ruleset_attr all = {.handled_access_fs = 2 * LANDLOCK_ACCESS_FS_MAKE_SYM - 1};
    int rules = (int)syscall(SYS_landlock_create_ruleset, &all, sizeof all, 0);
    if (rules < 0) return false;
    allow(rules, folder);
    allow(rules, file);
    bool done = syscall(SYS_landlock_restrict_self, rules, 0) == 0;
    close(rules);
    return done;
}

#else

static bool confine_files(const char *folder, const char *file)
{
    (void)folder;
    (void)file;
    return false;
}

#endif

#ifdef SHAPEBENCH_SECCOMP

/* Needed by C and C++ libraries that read files, compute and abort. */
static const int harmless[] = {
    SCMP_SYS(read),          SCMP_SYS(readv),        SCMP_SYS(pread64),
    SCMP_SYS(write),         SCMP_SYS(writev),       SCMP_SYS(close),
    SCMP_SYS(lseek),         SCMP_SYS(stat),         SCMP_SYS(lstat),
    SCMP_SYS(fstat),         SCMP_SYS(newfstatat),   SCMP_SYS(statx),
    SCMP_SYS(access),        SCMP_SYS(faccessat),    SCMP_SYS(faccessat2),
    SCMP_SYS(readlink),      SCMP_SYS(readlinkat),   SCMP_SYS(getcwd),
    SCMP_SYS(munmap),        SCMP_SYS(mremap),       SCMP_SYS(brk),
    SCMP_SYS(madvise),       SCMP_SYS(futex),        SCMP_SYS(exit),
    SCMP_SYS(exit_group),    SCMP_SYS(rt_sigaction), SCMP_SYS(rt_sigprocmask),
    SCMP_SYS(rt_sigreturn),  SCMP_SYS(getpid),       SCMP_SYS(gettid),
    SCMP_SYS(clock_gettime), SCMP_SYS(clock_getres), SCMP_SYS(gettimeofday),
    SCMP_SYS(time),          SCMP_SYS(getrandom),    SCMP_SYS(sched_yield),
    SCMP_SYS(getrlimit),     SCMP_SYS(sysinfo),      SCMP_SYS(uname),
    SCMP_SYS(sigaltstack)};

/* Memory that is never code; files that are only read; signals to itself alone. */
static int allow_some(scmp_filter_ctx filter)
{
    const scmp_datum_t writes = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC;
    struct scmp_arg_cmp reading = SCMP_A1(SCMP_CMP_MASKED_EQ, writes, 0);
    struct scmp_arg_cmp reading_at = SCMP_A2(SCMP_CMP_MASKED_EQ, writes, 0);
    struct scmp_arg_cmp data = SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0);
    struct scmp_arg_cmp itself = SCMP_A0(SCMP_CMP_EQ, (scmp_datum_t)getpid(), 0);
    struct scmp_arg_cmp flags = SCMP_A1(SCMP_CMP_EQ, F_GETFL, 0);
    int failed = seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, SCMP_SYS(open), 1, &reading);
    failed |= seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, SCMP_SYS(openat), 1, &reading_at);
    failed |= seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, SCMP_SYS(mmap), 1, &data);
    failed |= seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, SCMP_SYS(mprotect), 1, &data);
    failed |= seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, SCMP_SYS(tgkill), 1, &itself);
    return failed | seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, SCMP_SYS(fcntl), 1, &flags);
}

static bool confine_calls(void)
{
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
    if (!filter) return false;
    int failed = allow_some(filter);
    for (size_t i = 0; i < sizeof harmless / sizeof *harmless; i++)
        failed |= seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, harmless[i], 0, NULL);
    failed |= seccomp_load(filter);
    seccomp_release(filter);
    return !failed;
}

#else

static bool confine_calls(void)
{
    return false;
}

#endif

/* Both kernel interfaces answer a question that sets nothing: the version, and a filter at no
 * address. */
SmConfined sm_confinable(void)
{
    SmConfined confinable = {false, false};
#ifdef LANDLOCK_CREATE_RULESET_VERSION
    confinable.files =
        syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION) > 0;
#endif
#ifdef SHAPEBENCH_SECCOMP
    confinable.calls = prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, NULL) < 0 && errno == EFAULT;
#endif
    return confinable;
}

SmConfined sm_confine(const char *folder, const char *file)
{
    SmConfined confined = {false, false};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return confined;
    confined.files = confine_files(folder, file);
    confined.calls = confine_calls();
    return confined;
}
