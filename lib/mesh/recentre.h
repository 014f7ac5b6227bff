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

#include "../box.h"

/* Does what is in the box lie further from the origin than eight times the box's longest side?
 * `middle` is the box's. Not where a number is not finite. */
static inline bool sm_is_far(const SmBox *box, double middle[3])
{
    double distance = 0;
    for (int d = 0; d < 3; d++) {
        middle[d] = 0.5 * box->low[d] + 0.5 * box->high[d];
        distance = fmax(distance, fabs(middle[d]));
    }
    return box->low[0] <= box->high[0] && distance > 8 * sm_box_longest(box) && isfinite(distance);
}

/* A copy of the mesh file `text` (with a NUL after its `size` bytes) whose vertices are moved by
 * -offset, when they lie far from the origin. NULL when they do not, when `suffix` (without dot,
 * any case) is not one of the formats above, when the text is not what that format promises, or
 * without memory. The caller frees it. O(size). */
char *sm_recentre(const char *text, size_t size, const char *suffix, size_t *new_size,
                  double offset[3]);

#endif
