#include "file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static SmCode check(const char *path, const struct stat *status, SmError *error)
{
    if (S_ISDIR(status->st_mode)) return sm_fail(error, SM_INPUT, "%s: is a directory", path);
    if (S_ISREG(status->st_mode)) return SM_OK;
    return sm_fail(error, SM_INPUT, "%s: is a pipe or device, not a file", path);
}

FILE *sm_file_open(const char *path, double *bytes, SmError *error)
{
    struct stat status;
    /* asked before opening, which a pipe's writer or a tape would notice; and after it, of what is
     * open */
    if (stat(path, &status) == 0 && check(path, &status, error) != SM_OK) return NULL;
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor < 0) {
        sm_fail(error, SM_INPUT, "%s: %s%s", path, errno == ENOENT ? "" : "cannot be opened: ",
                errno == ENOENT ? "no such file" : strerror(errno));
        return NULL;
    }
    FILE *file = fdopen(descriptor, "rb");
    if (!file || fstat(descriptor, &status) != 0)
        sm_fail(error, SM_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
    else if (check(path, &status, error) == SM_OK) {
        if (bytes) *bytes = (double)status.st_size;
        return file;
    }
    if (file)
        fclose(file);
    else
        close(descriptor);
    return NULL;
}
