/* damping.h - damping of regions, the end of a step. */
#ifndef OCT_DAMPING_H
#define OCT_DAMPING_H

#include "state.h"

#define oct_damp SM_NAME(oct_damp)

/* Region damping of one body (fastlsm eq. 14 by HF), then x += v. All threads of the step call
 * it. */
void oct_damp(OctTask *task);

#endif
