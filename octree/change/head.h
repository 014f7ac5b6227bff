/* head.h - how an octree engine begins, in either precision. */
#ifndef OCT_HEAD_H
#define OCT_HEAD_H

#include "resample.h"

typedef struct {
    OctStructure structure; /* first: oct_engine_structure() */
    SmCode (*begin)(SmEngine *engine, SmError *error);
    const OctChange *(*end)(SmEngine *engine);
    const int *(*leaves)(SmEngine *engine);
    SmCode (*rebuild)(SmEngine *engine, const SmEngineParams *params, SmEngine **copy, long *order,
                      SmError *error);
} OctHead;

#endif
