/* Fracture in single precision. */
#define SM_REAL_BITS 32

enum { TRIALS = 600 };
#include "test_fracture.h"
