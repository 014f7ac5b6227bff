/* mesh_files.h - the files that Assimp may read: the mesh's own, and such beneath its folder.
 *
 * Formats name others: glTF its buffers (.bin), MD5, OGRE and MD3 their parts. A mesh from
 * elsewhere names what it likes, "../../.ssh/id_rsa" as well. Names are followed through links, so
 * that a link that leads out of the folder is refused, too; .mtl files and pictures are not needed
 * for triangles, and opened only where a format asks for them beneath the folder. */
#ifndef SM_MESH_FILES_H
#define SM_MESH_FILES_H

#include <assimp/cfileio.h>
#include <stddef.h>

#include "reply.h"

typedef struct {
    struct aiFileIO io; /* for Assimp; its UserData is this */
    const char *path;   /* the mesh, the caller's */
    char *folder;       /* resolved, ends in '/' */
    const char *text;   /* read in place of the mesh's file, the caller's; NULL: none */
    size_t size;
    double bytes;      /* of all files opened, once for each opening of another than the mesh */
    char outside[256]; /* the first name that led out of the folder, or "" */
    char altered[SM_REPLY_TEXT]; /* what Assimp says of numbers that it altered, or "" */
} SmMeshFiles;

/* The caller may set text and size afterwards, and frees the folder, which is NULL where there is
 * none. Assimp gets &files->io: the struct stays where it is. */
void sm_mesh_files_init(const char *path, SmMeshFiles *files);

#endif
