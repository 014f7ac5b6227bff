/* given.h - a mesh file that is given to the page, for the scene that it opens next.
 *
 * The page hands over bytes; lib/mesh/reader.h reads them, as in the program: the same bytes give
 * the same mesh, or the same line of error. */
#ifndef BENCH_GIVEN_H
#define BENCH_GIVEN_H

#include "../../lib/mesh/mesh.h"

/* Whether the page can read a file of this name: 1 or 0. */
int view_given_readable(const char *name);

/* Returns zeroed memory for `bytes` of the file `name`, without a folder, which the page fills
 * before it calls view_given_take(). Without memory the module ends. */
unsigned char *view_given_room(const char *name, int bytes);

/* Reads the mesh file `name` from that memory, with the other files there beside it, and frees
 * them all. Returns "", or the line of error; no mesh is given then. */
const char *view_given_take(const char *name);

/* Returns "", or the line that says what of the file is not in the mesh. */
const char *view_given_left_out(void);

/* What is known of that mesh: triangles, vertices, components, open, non-manifold and flipped
 * edges, triangles without area, duplicates, low and high corner of its box, volume: [15]. */
const double *view_given_facts(void);

/* The text of the scene file that drops that mesh on the ground, as `shapebench run NAME` does
 * (bench_scene_drop()); "" where none is given. */
const char *view_given_scene(void);

/* The mesh that a scene names: "shape:NAME", or a file of the name that was given, in whatever
 * folder. The caller frees it. Errors: SM_INPUT. */
SmCode view_given_load(const char *mesh, SmMesh *result, SmError *error);

#endif
