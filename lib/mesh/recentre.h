/* recentre.h - keeps the digits of meshes far from the origin.
 *
 * Debian's Assimp holds coordinates in single precision, 24 bits: steps of 0.03 at 447,600 and of
 * 0.5 at 5e6. Of shared/meshes/bad_huge_coordinates_city.obj (84,800, 447,600; 524 wide) that fuses
 * 18 of 14,760 vertices, drops 31 triangles and flattens 90. The remedy is to move the numbers in
 * the file's text to the origin before Assimp sees them and to move the result back in double
 * precision; what remains is 1e-7 of the mesh's own size. Done for OBJ, ASCII STL, ASCII PLY and
 * OFF. Binary STL and glTF hold single precision themselves; binary PLY in doubles, COLLADA and
 * rarer formats do lose digits. */
#ifndef SM_RECENTRE_H
#define SM_RECENTRE_H

#include <stddef.h>

/* A copy of the mesh file `text` (with a NUL after its `size` bytes) whose vertices are moved by
 * -offset, when they lie further from the origin than eight times their box's longest side. NULL
 * when they do not, when `suffix` (without dot, any case) is not one of the formats above, when the
 * text is not what that format promises, or without memory. The caller frees it. O(size). */
char *sm_recentre(const char *text, size_t size, const char *suffix, size_t *new_size,
                  double offset[3]);

#endif
