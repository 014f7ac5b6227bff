#define _GNU_SOURCE
#include "draft.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { SLOTS = 16, LINKS = 40 /* one after another, as the kernel allows */ };

/* Read by a signal handler of the one thread that writes: a name is complete before its flag is
 * set. */
static char listed[SLOTS][BENCH_DRAFT_PATH];
static volatile sig_atomic_t in_use[SLOTS];

static pid_t owner; /* a child that ends by exit() leaves its parent's drafts alone */

/* Out of memory ends the program by exit(). */
static void remove_at_exit(void)
{
    if (getpid() == owner) bench_drafts_remove();
}

static int list_draft(const char *tmp)
{
    if (!owner) atexit(remove_at_exit);
    owner = getpid();
    for (int slot = 0; slot < SLOTS; slot++) {
        if (in_use[slot]) continue;
        strcpy(listed[slot], tmp);
        in_use[slot] = 1;
        return slot;
    }
    return -1;
}

/* Not of every file system's folders: /proc takes no new files. */
static bool has_folder(const char *path)
{
    char folder[BENCH_DRAFT_PATH];
    snprintf(folder, sizeof folder, "%s", path);
    return access(dirname(folder), F_OK) == 0;
}

static const char *remedy(const char *path, int number)
{
    switch (number) {
    case ENOENT:
        return has_folder(path) ? "; no file can be made in that folder, choose another"
                                : "; create the folder first";
    case EACCES:
    case EPERM:
    case EROFS:
        return "; choose a folder that you may write to";
    case ENOSPC:
    case EDQUOT:
        return "; free some space or write to another disk";
    case EFBIG:
        return "; raise the file size limit (ulimit -f)";
    default:
        return "";
    }
}

SmCode bench_draft_fail(const char *path, int number, const char *detail, SmError *error)
{
    if (number == 0) return sm_fail(error, SM_OUTPUT, "cannot write %.300s: %s", path, detail);
    return sm_fail(error, SM_OUTPUT, "cannot write %.300s: %s%s", path, strerror(number),
                   remedy(path, number));
}

/* The folder that a path's last name lies in, without links. */
static bool folder_of(const char *path, char folder[PATH_MAX])
{
    char copy[BENCH_DRAFT_PATH];
    snprintf(copy, sizeof copy, "%s", path);
    return realpath(dirname(copy), folder) != NULL;
}

/* One link further, seen from the link's own folder. False at links that stand for devices or open
 * files (/dev/stdout, /proc/self/fd/1), and at paths too long. */
static bool follow(char path[BENCH_DRAFT_PATH])
{
    char folder[PATH_MAX], to[BENCH_DRAFT_PATH];
    ssize_t length = readlink(path, to, sizeof to - 1);
    if (length < 0 || !folder_of(path, folder)) return false;
    if (!strcmp(folder, "/dev") || !strncmp(folder, "/proc/", 6)) return false;
    to[length] = '\0';
    if (to[0] == '/') {
        strcpy(path, to);
        return true;
    }
    return snprintf(path, BENCH_DRAFT_PATH, "%s/%s", folder, to) < BENCH_DRAFT_PATH;
}

/* Where the bytes go: links at the path's end are followed, so that they stay. stat() comes first:
 * it asks the kernel, which follows no other user's link in /tmp. */
static SmCode resolve(const char *path, char target[BENCH_DRAFT_PATH], SmError *error)
{
    static const char other[] = "it is there and not a regular file; choose another name";
    struct stat status;
    if (strlen(path) >= BENCH_DRAFT_PATH) return bench_draft_fail(path, ENAMETOOLONG, "", error);
    bool there = stat(path, &status) == 0;
    if (there && !S_ISREG(status.st_mode)) return bench_draft_fail(path, 0, other, error);
    if (!there && errno != ENOENT) return bench_draft_fail(path, errno, "", error);
    strcpy(target, path);
    for (int links = 0; lstat(target, &status) == 0 && S_ISLNK(status.st_mode); links++)
        if (links == LINKS || !follow(target)) return bench_draft_fail(path, 0, other, error);
    return SM_OK;
}

/* May a file that is there be written? Root may, whatever the mode says: a file that nobody may
 * write is protected from root, too. */
static SmCode check_rights(const char *path, const char *target, const struct stat *status,
                           SmError *error)
{
    int file = open(target, O_WRONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
    int number = file < 0 ? errno : status->st_mode & 0222 ? 0 : EACCES;
    if (file >= 0) close(file);
    if (number == EACCES || number == EPERM)
        return bench_draft_fail(path, 0, "it is write-protected; choose another name, or chmod +w",
                                error);
    return number ? bench_draft_fail(path, number, "", error) : SM_OK;
}

static void unlist(int slot)
{
    if (slot >= 0) in_use[slot] = 0;
}

/* Makes a file that was not there, under a name of this process, and opens it; -1 and errno. It is
 * listed before it is there: no signal comes between. */
static int create(BenchDraft *draft)
{
    for (int n = 0; n < 100; n++) { /* an older process of this number may have left some */
        char more[16] = "";
        if (n) snprintf(more, sizeof more, "-%d", n);
        int length = snprintf(draft->tmp, sizeof draft->tmp, "%s.%ld%s.tmp", draft->target,
                              (long)getpid(), more);
        errno = ENAMETOOLONG;
        if (length >= (int)sizeof draft->tmp) return -1;
        draft->slot = list_draft(draft->tmp);
        int file = open(draft->tmp, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
        if (file >= 0) return file;
        unlist(draft->slot);
        draft->slot = -1;
        if (errno != EEXIST) return -1;
    }
    return -1;
}

SmCode bench_draft_begin(const char *path, BenchDraft *draft, SmError *error)
{
    struct stat status;
    draft->slot = -1;
    draft->tmp[0] = '\0';
    SmCode code = resolve(path, draft->target, error);
    if (code) return code;
    bool there = lstat(draft->target, &status) == 0;
    if (there) code = check_rights(path, draft->target, &status, error);
    if (code) return code;
    strcpy(draft->path, path);
    int file = create(draft);
    if (file < 0) {
        draft->tmp[0] = '\0';
        return bench_draft_fail(path, errno, "", error);
    }
    if (there) { /* who may read it, and whose it is: as before, where that can be */
        if (fchown(file, status.st_uid, status.st_gid) != 0) status.st_mode &= 0777;
        (void)fchmod(file, status.st_mode & 07777);
    }
    close(file);
    return SM_OK;
}

static int sync_path(const char *path)
{
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0) return errno;
    int number = fsync(file) == 0 ? 0 : errno;
    close(file);
    return number;
}

/* Who holds a lock, as its holder wrote it; control characters are not shown. */
static SmCode refuse_held(const char *path, int file, SmError *error)
{
    char holder[160] = "";
    ssize_t length = pread(file, holder, sizeof holder - 1, 0);
    for (ssize_t i = 0; i < length; i++)
        if ((unsigned char)holder[i] < ' ') holder[i] = '\0';
    return sm_fail(error, SM_OUTPUT,
                   "cannot write %.300s: %s is writing it; wait for it, or choose another name",
                   path, holder[0] ? holder : "another program");
}

/* Says in the lock who holds it. It is not closed: it is held until the program has ended. */
static void sign(int file)
{
    char host[64] = "unknown", utc[32], holder[160];
    time_t now = time(NULL);
    struct tm when;
    if (gethostname(host, sizeof host - 1)) strcpy(host, "unknown");
    strftime(utc, sizeof utc, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &when));
    int length = snprintf(holder, sizeof holder, "process %ld on %s, since %s,\n", (long)getpid(),
                          host, utc);
    if (ftruncate(file, 0) == 0) (void)!pwrite(file, holder, (size_t)length, 0);
}

static SmCode lock(const BenchDraft *draft, const char *path, SmError *error)
{
    struct stat mine, there;
    for (;;) {
        int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
        if (file < 0) return bench_draft_fail(path, errno, "", error);
        if (flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            SmCode code = refuse_held(draft->path, file, error);
            close(file);
            return code;
        }
        if (fstat(file, &mine) == 0 && lstat(path, &there) == 0 && mine.st_ino == there.st_ino) {
            sign(file);
            list_draft(path);
            return SM_OK;
        }
        close(file); /* its last holder has just removed it */
    }
}

/* Locks TARGET.lock. The kernel lets a lock go when its holder ends, however it does; a file system
 * without locks is trusted. Signals wait until it is listed. */
static SmCode take_lock(const BenchDraft *draft, SmError *error)
{
    char path[BENCH_DRAFT_PATH];
    if (snprintf(path, sizeof path, "%s.lock", draft->target) >= (int)sizeof path)
        return bench_draft_fail(draft->path, ENAMETOOLONG, "", error);
    sigset_t all, before;
    sigfillset(&all);
    sigprocmask(SIG_BLOCK, &all, &before);
    SmCode code = lock(draft, path, error);
    sigprocmask(SIG_SETMASK, &before, NULL);
    return code;
}

SmCode bench_draft_reserve(const char *path, bool overwrite, SmError *error)
{
    BenchDraft draft;
    if (!path && overwrite)
        return sm_fail(error, SM_USAGE, "--overwrite: what? Name the file with --output");
    if (!path) return SM_OK;
    SmCode code = bench_draft_begin(path, &draft, error);
    if (code) return code;
    bench_draft_discard(&draft);
    code = take_lock(&draft, error);
    if (code || overwrite || access(draft.target, F_OK) != 0) return code;
    return bench_draft_fail(path, 0, "it is there; choose another name, or give --overwrite",
                            error);
}

SmCode bench_draft_commit(BenchDraft *draft, SmError *error)
{
    int number = sync_path(draft->tmp);
    if (number == 0 && rename(draft->tmp, draft->target) != 0) number = errno;
    if (number) {
        bench_draft_discard(draft);
        return bench_draft_fail(draft->path, number, "", error);
    }
    unlist(draft->slot);
    char folder[BENCH_DRAFT_PATH];
    strcpy(folder, draft->target);
    /* Some file systems cannot sync a folder; the file itself is safe by now. */
    (void)sync_path(dirname(folder));
    draft->slot = -1;
    draft->tmp[0] = '\0';
    return SM_OK;
}

SmCode bench_draft_fill(const BenchDraft *draft, BenchDraftPrint *print, const void *what,
                        SmError *error)
{
    FILE *file = fopen(draft->tmp, "we");
    if (!file) return bench_draft_fail(draft->path, errno, "", error);
    print(file, what);
    int number = ferror(file) ? EIO : 0;
    if (fflush(file) != 0) number = errno;
    if (fclose(file) != 0 && number == 0) number = errno;
    return number ? bench_draft_fail(draft->path, number, "", error) : SM_OK;
}

SmCode bench_draft_write(const char *path, BenchDraftPrint *print, const void *what, SmError *error)
{
    BenchDraft draft;
    SmCode code = bench_draft_begin(path, &draft, error);
    if (code) return code;
    code = bench_draft_fill(&draft, print, what, error);
    if (!code) return bench_draft_commit(&draft, error);
    bench_draft_discard(&draft);
    return code;
}

void bench_draft_discard(BenchDraft *draft)
{
    if (draft->tmp[0]) unlink(draft->tmp);
    unlist(draft->slot);
    draft->slot = -1;
    draft->tmp[0] = '\0';
}

void bench_drafts_remove(void)
{
    for (int slot = 0; slot < SLOTS; slot++)
        if (in_use[slot]) unlink(listed[slot]);
}
