#include "points_file.h"

#include <string.h>
#include <strings.h>

#include "body.h"

SmCode bench_points_or_mesh(const char *path, RefPoints *points, SmMesh *mesh, SmError *error)
{
    const char *dot = strrchr(path, '.');
    bool ply = dot && !strcasecmp(dot, ".ply");
    *points = (RefPoints){0};
    *mesh = (SmMesh){0};
    if (ref_points_text(path)) return ref_points_read(path, points, error);
    if (!ply) return bench_mesh_load(path, mesh, error);
    if (!bench_mesh_load(path, mesh, NULL)) return SM_OK;
    *mesh = (SmMesh){0};
    return ref_points_read(path, points, error);
}
