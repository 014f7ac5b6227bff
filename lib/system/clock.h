/* clock.h - time that only moves forward. */
#ifndef SM_CLOCK_H
#define SM_CLOCK_H

#include <time.h>

/* Monotonic seconds (clock_gettime, served without a system call). */
static inline double sm_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
