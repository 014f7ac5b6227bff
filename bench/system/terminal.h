/* terminal.h - may what is written be coloured? */
#ifndef BENCH_TERMINAL_H
#define BENCH_TERMINAL_H

#include <stdbool.h>
#include <stdio.h>

/* On a terminal that knows colours, unless the environment has NO_COLOR (no-color.org). */
bool bench_colours(FILE *file);

#endif
