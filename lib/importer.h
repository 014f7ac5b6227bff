/* importer.h - what runs in the importer's child process: Assimp. */
#ifndef SM_IMPORTER_H
#define SM_IMPORTER_H

/* An SmChildBody: reads the file that `path` (a const char *) names and writes the reply that
 * reply.h describes to descriptor `reply`. */
int sm_importer(void *path, int reply);

/* The same of a file's points: parts without triangles, as sm_reply_points() reads them. */
int sm_importer_points(void *path, int reply);

#endif
