/* Fracture in double precision. */
#define SM_REAL_BITS 64

enum { TRIALS = 600 };
#include "test_fracture.h"
