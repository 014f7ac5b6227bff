/* handles.h - an engine's own copy of the handles that it was given (boundary.h). */
#ifndef SM_HANDLES_H
#define SM_HANDLES_H

#include "boundary.h"

typedef struct {
    int count;
    SmHandle *handle; /* [count] */
    long held;        /* particles of all handles */
    /* [held] for the engine: where they were before the step, handle by handle */
    double (*before)[3];
} SmHandles;

/* Copies the boundary's handles; their particles must be 0 .. particles - 1. Where they hold the
 * same particles as before, only the poses are copied: O(held), and nothing is allocated. Returns
 * whether they hold others. `own` begins zeroed; sm_handles_free() ends it. */
bool sm_handles_set(SmHandles *own, const SmBoundary *boundary, long particles);
void sm_handles_free(SmHandles *own);

/* to = pose * (from, 1). */
void sm_pose_apply(const double pose[3][4], const double from[3], double to[3]);

#endif
