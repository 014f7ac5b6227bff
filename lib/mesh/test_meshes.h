/* test_meshes.h - mesh files as tests read them. */
#ifndef SM_TEST_MESHES_H
#define SM_TEST_MESHES_H

#include "../test_folder.h"
#include "import.h"

/* cmocka's assert_float_equal() compares in single precision. */
static inline void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance)) fail_msg("%.17g is not %.17g", value, expected);
}

static inline SmMeshInfo import_info(const char *path)
{
    SmMesh mesh;
    SmError error = {0};
    if (sm_import(path, NULL, &mesh, NULL, &error) != SM_OK) fail_msg("%s", error.text);
    SmMeshInfo info = sm_mesh_info(&mesh);
    sm_mesh_free(&mesh);
    return info;
}

/* The file is refused by a line that begins with its name and has this part. */
static inline void expect_error(const char *path, const SmImportLimits *limits, const char *part)
{
    SmMesh mesh;
    SmError error = {0};
    assert_int_equal(sm_import(path, limits, &mesh, NULL, &error), SM_INPUT);
    assert_int_equal(strncmp(error.text, path, strlen(path)), 0);
    if (!strstr(error.text, part)) fail_msg("\"%s\" lacks \"%s\"", error.text, part);
    assert_null(mesh.position);
}

#endif
