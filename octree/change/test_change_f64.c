/* Octree bodies that are resampled, in double precision. */
#define SM_REAL_BITS 64
#include "test_change.h"
