/* reader.h - reads meshes and points from bytes in memory, in double precision.
 *
 * Formats, by the name's suffix: OBJ, PLY, STL, OFF, glTF and GLB; points alone: XYZ, PTS, PWN, ASC
 * and TXT; each also compressed (.gz). Program, library, wheel and page all read with these
 * functions: the same bytes give the same arrays, or the same line of error. Nothing in a file is
 * trusted. Errors (SM_INPUT) name the file, the line (text) or the byte (binary), and the remedy.
 */
#ifndef SM_READER_H
#define SM_READER_H

#include "mesh.h"

/* Gives the bytes of a file beside the mesh, a glTF's buffer for instance; `name` is relative to
 * the mesh's folder and comes from the mesh. The caller frees `bytes`. False where there is no
 * `name` in the folder: nothing outside of it may be read. */
typedef bool (*SmMeshBeside)(void *of, const char *name, unsigned char **bytes, size_t *size);

typedef struct {
    const char *name; /* for its suffix and for messages */
    const unsigned char *bytes;
    size_t size;
    SmMeshBeside beside; /* NULL: there are no other files */
    void *of;
} SmMeshFile;

/* Counts what a file has that bounds no volume and is not in the mesh. */
typedef struct {
    long points, lines; /* also faces of one corner or two */
    long curves;        /* free-form curves and surfaces of OBJ */
    long scenes;        /* of glTF, in addition to its default scene */
} SmMeshLeftOut;

enum { SM_LEFT_OUT_TEXT = 160 };

/* Returns `text`: "3 lines and 1 point are left out", or "" where nothing was. */
const char *sm_mesh_left_out(const SmMeshLeftOut *left_out, char text[SM_LEFT_OUT_TEXT]);

/* Whether the suffix is one of those above. */
bool sm_mesh_readable(const char *name);

/* Reads a mesh and prepares it (sm_mesh_prepare()). Polygons are cut into triangles; transforms of
 * nodes are applied, and a mirrored part keeps its outside. `left_out` may be NULL. The caller
 * frees `mesh`, which is zeroed where reading fails. */
SmCode sm_mesh_read(const SmMeshFile *file, SmMesh *mesh, SmMeshLeftOut *left_out, SmError *error);

/* Reads a file of points without triangles: their positions and normals, which are zero where the
 * file has none. The caller frees both arrays. */
SmCode sm_mesh_read_points(const SmMeshFile *file, long *count, double (**position)[3],
                           double (**normal)[3], SmError *error);

#endif
