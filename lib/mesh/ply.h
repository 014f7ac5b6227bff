/* ply.h - PLY files that declare their faces before their vertices.
 *
 * The format allows any order (Turk 1994), and libigl's tools write such files; Assimp 5.2 refuses
 * them with "Vertices should be declared before faces". */
#ifndef SM_PLY_H
#define SM_PLY_H

#include <stdbool.h>
#include <stddef.h>

/* A copy of the PLY file `text` (ASCII or binary of either byte order, with a NUL after its `size`
 * bytes) with its vertices, header and data, moved before the other elements. NULL when they are
 * first already, when the text is not what its header promises, with more than 16 elements or 32
 * properties of one, or without memory. The caller frees it. O(size). */
char *sm_ply_vertices_first(const char *text, size_t size, size_t *new_size);

/* Whether an ASCII PLY file has fewer lines behind its header than elements in it: a file cut off,
 * of which Assimp repeats the last numbers. */
bool sm_ply_lacks_lines(const char *text);

#endif
