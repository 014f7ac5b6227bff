/* The octree engine in double precision. */
#ifndef SM_REAL_BITS
#define SM_REAL_BITS 64
#endif
#include "test_octree.h"
