/* mesh_text.h - mesh files that Assimp reads wrongly, or not at all.
 *
 * PLY files may declare their faces before their vertices, or not give each a line: the format
 * allows any order (Turk 1994), and libigl's tools write such files; Assimp 5.2 refuses them with
 * "Vertices should be declared before faces". Of ASCII files it reads one vertex or face of each
 * line, whatever else is in it. */
#ifndef SM_MESH_TEXT_H
#define SM_MESH_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* A copy of the PLY file `text` (ASCII or binary of either byte order, with a NUL after its `size`
 * bytes) with its vertices, header and data, moved before the other elements, and of ASCII data of
 * just as many words as the header says a line of each. NULL when they are so already, when the
 * text is not what its header promises, with more than 16 elements or 32
 * properties of one, or without memory. The caller frees it. O(size). */
char *sm_ply_ordered(const char *text, size_t size, size_t *new_size);

/* Whether an ASCII PLY file has fewer lines behind its header than elements in it: a file cut off,
 * of which Assimp repeats the last numbers. */
bool sm_ply_lacks_lines(const char *text);

/* Whether a face of the OFF file names a vertex below 0 or beyond its count of vertices: Assimp
 * reads -1 as 0, and what 32 bits cannot hold as what is left of it. False for text that is not
 * laid out a vertex or face a line. */
bool sm_off_out_of_range(const char *text);

#endif
