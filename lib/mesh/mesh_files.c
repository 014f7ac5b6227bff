#include "mesh_files.h"
#include "../system/file.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static FILE *stream(struct aiFile *file)
{
    return (FILE *)(void *)file->UserData;
}

static size_t read_proc(struct aiFile *file, char *to, size_t size, size_t count)
{
    return fread(to, size, count, stream(file));
}

static size_t write_proc(struct aiFile *file, const char *from, size_t size, size_t count)
{
    (void)file;
    (void)from;
    (void)size;
    (void)count;
    return 0;
}

static size_t tell_proc(struct aiFile *file)
{
    return (size_t)ftell(stream(file));
}

static size_t size_proc(struct aiFile *file)
{
    FILE *of = stream(file);
    long at = ftell(of), size = fseek(of, 0, SEEK_END) == 0 ? ftell(of) : 0;
    fseek(of, at, SEEK_SET);
    return size > 0 ? (size_t)size : 0;
}

static enum aiReturn seek_proc(struct aiFile *file, size_t to, enum aiOrigin from)
{
    static const int whence[] = {
        [aiOrigin_SET] = SEEK_SET, [aiOrigin_CUR] = SEEK_CUR, [aiOrigin_END] = SEEK_END};
    bool known = (unsigned)from < sizeof whence / sizeof *whence;
    return known && fseek(stream(file), (long)to, whence[from]) == 0 ? aiReturn_SUCCESS
                                                                     : aiReturn_FAILURE;
}

static void flush_proc(struct aiFile *file)
{
    (void)file;
}

/* A file beneath the folder; NULL, and noted, for others. */
static FILE *open_beneath(SmMeshFiles *files, const char *name)
{
    char *resolved = realpath(name, NULL);
    FILE *file = NULL;
    double bytes = 0;
    if (!resolved) return NULL;
    if (files->folder && !strncmp(resolved, files->folder, strlen(files->folder)))
        file = sm_file_open(resolved, &bytes, NULL);
    else if (!files->outside[0])
        snprintf(files->outside, sizeof files->outside, "%s", name);
    free(resolved);
    files->bytes += bytes;
    return file;
}

static struct aiFile *open_proc(struct aiFileIO *io, const char *name, const char *mode)
{
    SmMeshFiles *files = (SmMeshFiles *)(void *)io->UserData;
    FILE *opened;
    if (mode[0] != 'r' || strchr(mode, '+')) return NULL;
    if (strcmp(name, files->path) != 0)
        opened = open_beneath(files, name);
    else if (files->text)
        opened = fmemopen((void *)(uintptr_t)files->text, files->size, "rb");
    else
        opened = sm_file_open(name, NULL, NULL);
    if (!opened) return NULL;
    struct aiFile *file = calloc(1, sizeof *file);
    if (!file) {
        fclose(opened);
        return NULL;
    }
    *file = (struct aiFile){read_proc,
                            write_proc,
                            tell_proc,
                            size_proc,
                            seek_proc,
                            flush_proc,
                            (aiUserData)(void *)opened};
    return file;
}

static void close_proc(struct aiFileIO *io, struct aiFile *file)
{
    (void)io;
    fclose(stream(file));
    free(file);
}

void sm_mesh_files_init(const char *path, SmMeshFiles *files)
{
    const char *slash = strrchr(path, '/');
    char *name = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    char *folder = name ? realpath(name, NULL) : NULL;
    free(name);
    *files = (SmMeshFiles){.io = {open_proc, close_proc, (aiUserData)(void *)files}, .path = path};
    if (folder) {
        size_t length = strlen(folder);
        char *longer = realloc(folder, length + 2);
        if (longer && longer[length - 1] != '/') memcpy(longer + length, "/", 2);
        if (!longer) free(folder);
        files->folder = longer;
    }
    struct stat status;
    if (stat(path, &status) == 0) files->bytes = (double)status.st_size;
}
