/* remark.h - remarks on standard error, which --quiet leaves out. */
#ifndef BENCH_REMARK_H
#define BENCH_REMARK_H

/* Prints "shapebench: " and the line. */
void bench_remark(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Prints no remark from now on. */
void bench_remarks_off(void);

#endif
