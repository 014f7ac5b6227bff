/* The octree engine in single precision. */
#define SM_REAL_BITS 32
#include "test_octree.h"
