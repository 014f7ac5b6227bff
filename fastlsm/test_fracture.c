/* Fracture in single precision. */
#define SM_REAL_BITS 32
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { TRIALS = 600 };
#include "test_fracture.h"

int main(void)
{
    return test_all("fastlsm_fracture");
}
