/* What import.h is in a library that is the core alone. */
#include "import.h"

SmCode sm_import(const char *path, const SmImportLimits *limits, SmMesh *mesh, SmError *error)
{
    (void)limits;
    *mesh = (SmMesh){0};
    return sm_fail(error, SM_INPUT, "%s: this library was built without Assimp and reads no files",
                   path);
}

SmCode sm_import_points(const char *path, const SmImportLimits *limits, long *count,
                        double (**position)[3], double (**normal)[3], SmError *error)
{
    SmMesh mesh;
    *count = 0;
    *position = *normal = NULL;
    return sm_import(path, limits, &mesh, error);
}
