#include "draft.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <signal.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SLOTS = 16 };

/* Read by a signal handler of the one thread that writes: a name is complete before its flag is
 * set. */
static char listed[SLOTS][BENCH_DRAFT_PATH];
static volatile sig_atomic_t in_use[SLOTS];

static int list_draft(const char *tmp)
{
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

SmCode bench_draft_begin(const char *path, BenchDraft *draft, SmError *error)
{
    draft->slot = -1;
    struct stat status;
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode))
        return bench_draft_fail(path, 0, "it is there and not a regular file; choose another name",
                                error);
    int length = snprintf(draft->tmp, sizeof draft->tmp, "%s.%ld.tmp", path, (long)getpid());
    if (length >= (int)sizeof draft->tmp) return bench_draft_fail(path, ENAMETOOLONG, "", error);
    strcpy(draft->path, path);
    int file = open(draft->tmp, O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (file < 0) return bench_draft_fail(path, errno, "", error);
    close(file);
    draft->slot = list_draft(draft->tmp);
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

SmCode bench_draft_try(const char *path, SmError *error)
{
    BenchDraft draft;
    SmCode code = path ? bench_draft_begin(path, &draft, error) : SM_OK;
    if (path && !code) bench_draft_discard(&draft);
    return code;
}

SmCode bench_draft_commit(BenchDraft *draft, SmError *error)
{
    int number = sync_path(draft->tmp);
    if (number == 0 && rename(draft->tmp, draft->path) != 0) number = errno;
    if (number) {
        bench_draft_discard(draft);
        return bench_draft_fail(draft->path, number, "", error);
    }
    if (draft->slot >= 0) in_use[draft->slot] = 0;
    char folder[BENCH_DRAFT_PATH];
    strcpy(folder, draft->path);
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
    if (draft->slot >= 0) in_use[draft->slot] = 0;
    draft->slot = -1;
    draft->tmp[0] = '\0';
}

void bench_drafts_remove(void)
{
    for (int slot = 0; slot < SLOTS; slot++)
        if (in_use[slot]) unlink(listed[slot]);
}
