#include "import.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "../system/file.h"

/* Reads all of a file. False: `error`, if not NULL, says why. The caller frees. */
static bool read_whole_file(const char *path, unsigned char **bytes, size_t *size, SmError *error)
{
    double length = 0;
    FILE *file = sm_file_open(path, &length, error);
    if (!file) return false;
    *size = (size_t)length;
    /* Where the system promises more memory than it has, a file with a hole in it would fill it. */
    double most = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    *bytes = length < most ? malloc(*size + 1) : NULL;
    bool good = *bytes && fread(*bytes, 1, *size, file) == *size;
    fclose(file);
    if (good) return true;
    sm_fail(error, SM_INPUT, "%s: %s", path,
            *bytes ? "cannot be read to its end" : "there is no memory for it");
    free(*bytes);
    *bytes = NULL;
    return false;
}

#ifdef __wasm__
static const SmMeshBeside read_file_beside; /* there are no files */
#else
/* An SmMeshBeside of the mesh's path. Links are followed before the folder is compared. */
static bool read_file_beside(void *of, const char *name, unsigned char **bytes, size_t *size)
{
    const char *path = of, *slash = strrchr(path, '/');
    size_t length = slash ? (size_t)(slash - path) + 1 : 0;
    char *joined = sm_alloc(length + strlen(name) + 3, 1);
    memcpy(joined, length ? path : "./", length ? length : 2);
    char *folder = realpath(joined, NULL), *resolved = NULL;
    strcat(joined, name);
    if (folder && *name != '/') resolved = realpath(joined, NULL);
    size_t depth = folder ? strlen(folder) : 0;
    bool beneath =
        resolved && !strncmp(resolved, folder, depth) && (resolved[depth] == '/' || depth == 1);
    bool good = beneath && read_whole_file(resolved, bytes, size, NULL);
    sm_free_all(joined, folder, resolved);
    return good;
}
#endif

static bool open_mesh(const char *path, SmMeshFile *file, unsigned char **bytes, SmError *error)
{
    *file = (SmMeshFile){.name = path, .beside = read_file_beside, .of = (void *)path};
    bool good = read_whole_file(path, bytes, &file->size, error);
    file->bytes = *bytes;
    return good;
}

/* Point formats that are not read. */
static bool is_point_format(const char *path)
{
    static const char *const suffix[] = {".pcd", ".las", ".laz"};
    const char *dot = strrchr(path, '.');
    for (int i = 0; dot && i < 3; i++)
        if (!strcasecmp(dot, suffix[i])) return true;
    return false;
}

SmCode sm_import(const char *path, const SmImportLimits *limits, SmMesh *mesh,
                 SmMeshLeftOut *left_out, SmError *error)
{
    SmMeshFile file;
    unsigned char *bytes = NULL;
    *mesh = (SmMesh){0};
    if (!open_mesh(path, &file, &bytes, error)) return SM_INPUT;
    SmCode code;
    if (is_point_format(path))
        code = sm_fail(error, SM_INPUT,
                       "%s: a point format that is not read; save it as PLY or XYZ", path);
    else if (sm_mesh_readable(path))
        code = sm_mesh_read(&file, mesh, left_out, error);
    else
        code = sm_import_other(&file, limits, mesh, left_out, error);
    free(bytes);
    return code;
}

SmCode sm_import_points(const char *path, long *count, double (**position)[3], double (**normal)[3],
                        SmError *error)
{
    SmMeshFile file;
    unsigned char *bytes = NULL;
    if (!open_mesh(path, &file, &bytes, error)) return SM_INPUT;
    SmCode code = sm_mesh_read_points(&file, count, position, normal, error);
    free(bytes);
    return code;
}
