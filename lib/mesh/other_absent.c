/* Other formats in a library without Assimp. */
#include "import.h"

SmCode sm_import_other(const SmMeshFile *file, const SmImportLimits *limits, SmMesh *mesh,
                       SmMeshLeftOut *left_out, SmError *error)
{
    (void)limits;
    (void)left_out;
    *mesh = (SmMesh){0};
    return sm_fail(error, SM_INPUT,
                   "%s: formats other than OBJ, PLY, STL, OFF and glTF are read with Assimp, which "
                   "this program was built without; save it as one of these",
                   file->name);
}
