/* interrupt.h - what a program that a signal ends (Ctrl-C, a closed terminal, a batch system, a
 * closed pipe) leaves behind and says: no draft, one line (none for the pipe), exit code 128 + the
 * signal's number. */
#ifndef BENCH_INTERRUPT_H
#define BENCH_INTERRUPT_H

enum { BENCH_INTERRUPT_SIGNALS = 8 };
extern const int bench_interrupt_signals[BENCH_INTERRUPT_SIGNALS]; /* all but the pipe's */

/* Installs a handler; a signal that is ignored (nohup) stays so. */
void bench_interrupt_handle(int number, void (*handler)(int));

/* From now on. The line says that no file was written, until another one is set. */
void bench_interrupt_catch(void);

/* The line to say from now on, without the program's name and an end of line; it is copied, and cut
 * at 240 bytes. NULL: the first one again. */
void bench_interrupt_say(const char *line);

#endif
