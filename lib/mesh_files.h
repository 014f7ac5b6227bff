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

typedef struct {
    struct aiFileIO io; /* for Assimp; its UserData is this */
    const char *path;   /* the mesh, the caller's */
    char *folder;       /* resolved, ends in '/' */
    const char *text;   /* read in place of the mesh's file, the caller's; NULL: none */
    size_t size;
    double bytes;      /* of all files opened, once for each opening of another than the mesh */
    char outside[256]; /* the first name that led out of the folder, or "" */
    char
        altered[400]; /* for the importer: what it says of numbers that it did not believe, or "" */
} SmMeshFiles;

/* The caller calls sm_mesh_files_free(), and may set text and size in between. Assimp gets
 * &files->io, so that it does not move. folder is NULL where there is none. */
void sm_mesh_files_init(const char *path, SmMeshFiles *files);
void sm_mesh_files_free(SmMeshFiles *files);

#endif
