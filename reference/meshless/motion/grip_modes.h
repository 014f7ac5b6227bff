/* grip_modes.h - a body's modes while grips hold it: those that all grips leave at rest, and what
 * grips that move and gravity do while nothing swings (Craig and Bampton 1968). */
#ifndef REF_GRIP_MODES_H
#define REF_GRIP_MODES_H

#include "grip.h"

/* `count` modes of the body, the six rigid ones among them, for motions under the grips: lowest
 * modes of what all grips leave free, so many that half or more of them are; the static answers to
 * grips that are moved and turned, one at a time, and to gravity; orthonormal by Rayleigh and Ritz.
 * Errors: as ref_modes_find(). The caller frees. */
SmCode ref_grip_modes(const RefBody *body, int grips, const RefGrip *grip, int count,
                      RefModes *modes, SmError *error);

#endif
