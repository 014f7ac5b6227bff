/* importer.h - what runs in the importer's child process: Assimp, which reads nothing but the
 * mesh and what lies beneath its folder (mesh_files.h). */
#ifndef SM_IMPORTER_H
#define SM_IMPORTER_H

/* An SmChildBody: reads the file that `path` (a const char *) names and writes the reply that
 * reply.h describes to descriptor `reply`. A file whose parts, used again and again, make more
 * triangles than two million and one for each of its bytes gets a message in place of a mesh, and
 * so do numbers that Assimp replaces by others. */
int sm_importer(void *path, int reply);

/* The same of a file's points: parts without triangles, as sm_reply_points() reads them. */
int sm_importer_points(void *path, int reply);

#endif
