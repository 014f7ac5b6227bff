/* interrupt.h - what an interrupted program (SIGINT, SIGTERM) leaves behind and says: no draft, one
 * line, exit code 128 + the signal's number. */
#ifndef BENCH_INTERRUPT_H
#define BENCH_INTERRUPT_H

/* From now on. The line says that no file was written, until another one is set. */
void bench_interrupt_catch(void);

/* The line to say from now on, without the program's name and an end of line; it is copied, and cut
 * at 240 bytes. NULL: the first one again. */
void bench_interrupt_say(const char *line);

#endif
