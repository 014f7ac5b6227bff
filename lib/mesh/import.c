#include "import.h"
#include "../system/child.h"
#include "../system/file.h"
#include "importer.h"
#include "reply.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const double default_seconds = 20, default_seconds_per_megabyte = 1;
static const double default_megabytes = 4096;

/* Suffixes of common point files, which Assimp does not know. */
static bool is_point_format(const char *path)
{
    static const char *const suffix[] = {".xyz", ".pts", ".txt", ".pcd", ".las", ".laz"};
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof suffix / sizeof *suffix; i++)
        if (strcasecmp(dot, suffix[i]) == 0) return true;
    return false;
}

/* Says also how many bytes the file has. */
static SmCode check_file(const char *path, double *bytes, SmError *error)
{
    FILE *file = sm_file_open(path, bytes, error);
    if (!file) return SM_INPUT;
    fclose(file);
    if (*bytes == 0) return sm_fail(error, SM_INPUT, "%s: the file is empty", path);
    if (is_point_format(path))
        return sm_fail(error, SM_INPUT,
                       "%s: a point format holds only points, no triangles; " SM_REPLY_POINTS,
                       path);
    return SM_OK;
}

static SmCode fail_child(const SmChildResult *result, const SmChildLimits *limits, const char *path,
                         SmError *error)
{
    switch (result->end) {
    case SM_CHILD_TOO_LONG:
        return sm_fail(error, SM_INPUT,
                       "%s: reading it took longer than %g s: it may be "
                       "damaged; save it anew as OBJ, PLY or STL",
                       path, limits->seconds);
    case SM_CHILD_TOO_LARGE:
        return sm_fail(error, SM_INPUT, "%s: reading it took more than %g MB", path,
                       limits->megabytes);
    case SM_CHILD_FAILED:
        return sm_fail(error, SM_INPUT, "%s: the importer could not be started: %s", path,
                       strerror(result->status));
    default:
        break;
    }
    if (result->signal)
        return sm_fail(error, SM_INPUT, "%s: the importer crashed on it (%s)", path,
                       strsignal(result->signal));
    return sm_fail(error, SM_INPUT, "%s: the importer gave up on it (status %d)", path,
                   result->status);
}

/* Runs the importer on the file; on SM_OK the caller frees result->reply. */
static SmCode run(SmChildBody body, const char *path, const SmImportLimits *limits,
                  SmChildResult *result, SmError *error)
{
    double bytes = 0;
    SmCode code = check_file(path, &bytes, error);
    if (code != SM_OK) return code;
    SmChildLimits child = {rint(default_seconds + default_seconds_per_megabyte * bytes / 1e6),
                           default_megabytes};
    if (limits && limits->seconds > 0) child.seconds = limits->seconds;
    if (limits && limits->megabytes > 0) child.megabytes = limits->megabytes;
    *result = sm_child_run(body, (void *)path, &child);
    if (result->end == SM_CHILD_REPLIED) return SM_OK;
    fail_child(result, &child, path, error);
    free(result->reply);
    return SM_INPUT;
}

SmCode sm_import(const char *path, const SmImportLimits *limits, SmMesh *mesh, SmError *error)
{
    SmChildResult result;
    *mesh = (SmMesh){0};
    SmCode code = run(sm_importer, path, limits, &result, error);
    if (code != SM_OK) return code;
    code = sm_reply_read(result.reply, result.size, path, mesh, error);
    free(result.reply);
    return code;
}

SmCode sm_import_points(const char *path, const SmImportLimits *limits, long *count,
                        double (**position)[3], double (**normal)[3], SmError *error)
{
    SmChildResult result;
    SmCode code = run(sm_importer_points, path, limits, &result, error);
    if (code != SM_OK) return code;
    code = sm_reply_points(result.reply, result.size, path, count, position, normal, error);
    free(result.reply);
    return code;
}
