/* Octree bodies that are resampled, in single precision. */
#define SM_REAL_BITS 32
#include "test_change.h"
