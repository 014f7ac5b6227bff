/* sine.h - sine and cosine with the same bits on every machine.
 *
 * The C library's choose at run time between versions for processors with and without fused
 * multiplication, whose last bits differ, and what the procedural models decide by them (which edge
 * collapses first) then differs, too. */
#ifndef SM_SINE_H
#define SM_SINE_H

/* Of an angle in radians, up to 10^6 of either sign; to 2e-16. */
double sm_sin(double angle);
double sm_cos(double angle);

#endif
