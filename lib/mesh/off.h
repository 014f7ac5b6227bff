/* off.h - OFF files whose faces name vertices that are not there. */
#ifndef SM_OFF_H
#define SM_OFF_H

#include <stdbool.h>

/* Whether a face of the OFF file names a vertex below 0 or beyond its count of vertices: Assimp
 * reads -1 as 0, and what 32 bits cannot hold as what is left of it. False for text that is not
 * laid out a vertex or face a line. */
bool sm_off_astray(const char *text);

#endif
