/* damping.h - damping of regions, a part of the step. */
#ifndef OCT_DAMPING_H
#define OCT_DAMPING_H

#include "state.h"

#define oct_damp SM_NAME(oct_damp)

/* Region damping of one body (fastlsm eq. 14 by HF), then x += v; part of the step. */
void oct_damp(OctTask *task);

#endif
