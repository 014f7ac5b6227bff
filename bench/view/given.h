/* given.h - a mesh that the page has read from a file, for the scene that it opens next.
 *
 * Assimp is not in WebAssembly: the page reads files itself (scripts/view/mesh_files.js) and hands
 * over plain polygons. Of them becomes what sm_import() would make. */
#ifndef BENCH_GIVEN_H
#define BENCH_GIVEN_H

#include "../../lib/mesh/mesh.h"

/* Lets go of the mesh that was given before, and makes room of zeros for a new one, whose sizes are
 * at least 0. The page fills it through the pointers that follow, which hold until it is taken.
 * Without memory the module ends. */
void view_given_room(int vertices, int polygons, int corners);
double *view_given_points(void); /* [vertices][3], the file's unit */
int *view_given_sizes(void);     /* [polygons]: how many corners each has; of two or less: none */
int *view_given_corners(void);   /* [corners]: vertices, a polygon's after those of another */

/* Makes the mesh file `name`, without a folder, of what is in that room: "", or the line that says
 * what is wrong with it, and then none is given. O(vertices + triangles), and the square of a
 * polygon's corners. */
const char *view_given_take(const char *name);

/* The text of the scene file that drops that mesh on the ground, as `shapebench run NAME` does
 * (bench_scene_drop()); "" where none is given. */
const char *view_given_scene(void);

/* The mesh that a scene names: "shape:NAME", or a file of the name that was given, in whatever
 * folder. The caller frees it. Errors: SM_INPUT. */
SmCode view_given_load(const char *mesh, SmMesh *result, SmError *error);

#endif
