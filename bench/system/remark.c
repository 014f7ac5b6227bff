#include "remark.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>

#include "../../lib/error.h"

static bool off;

void bench_remarks_off(void)
{
    off = true;
}

void bench_remark(const char *format, ...)
{
    char line[512];
    if (off) return;
    va_list arguments;
    va_start(arguments, format);
    sm_write_line(line, sizeof line, format, arguments);
    va_end(arguments);
    fprintf(stderr, "shapebench: %s\n", line);
}
