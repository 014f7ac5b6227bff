/* positions.h - where bodies are, and the origins that their coordinates count from. */
#ifndef OCT_POSITIONS_H
#define OCT_POSITIONS_H

#include "state.h"

#define oct_set_positions SM_NAME(oct_set_positions)
#define oct_recentre      SM_NAME(oct_recentre)

/* Puts every node of a body: `x` is [leaves][3], finest cells. Origins go to the whole cells next
 * to their frames' middles. */
void oct_set_positions(Oct *oct, long body, const double (*x)[3]);

/* Moves the origin of each frame to its middle by whole cells: single precision is best near zero.
 * The next time is due in 16 steps, or before the fastest frame has moved by 8 cells. */
void oct_recentre(Oct *oct);

#endif
