/* interpolation.h - what sm_embed_apply() does for most vertices, of the instruction set in use
 * (lib/isa.h): all but what stands off beside a cut. */
#ifndef SM_INTERPOLATION_H
#define SM_INTERPOLATION_H

#include "embed.h"

typedef struct {
    void (*vertices)(const SmEmbedding *embedding, const double (*x)[3], double (*position)[3],
                     double (*normal)[3]);
} SmInterpolation;
extern SmInterpolation sm_interpolation;

#endif
