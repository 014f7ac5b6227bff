#include "interrupt.h"

#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <unistd.h>

#include "../store/draft.h"

/* Two lines in turn, so that the handler always has a whole one. */
static char lines[2][288];
static size_t length[2];
static volatile sig_atomic_t present;

const int bench_interrupt_signals[BENCH_INTERRUPT_SIGNALS] = {SIGINT,  SIGTERM, SIGHUP,  SIGQUIT,
                                                              SIGALRM, SIGUSR1, SIGUSR2, SIGXCPU};

static void interrupt(int number)
{
    bench_drafts_remove();
    int which = present;
    ssize_t written = number == SIGPIPE ? 0 : write(STDERR_FILENO, lines[which], length[which]);
    (void)written;
    _exit(128 + number);
}

void bench_interrupt_handle(int number, void (*handler)(int))
{
    struct sigaction before, action = {.sa_handler = handler};
    sigfillset(&action.sa_mask);
    if (sigaction(number, NULL, &before) == 0 && before.sa_handler != SIG_IGN)
        sigaction(number, &action, NULL);
}

void bench_interrupt_say(const char *line)
{
    int next = !present;
    int used = snprintf(lines[next], sizeof lines[next], "\nshapebench: interrupted: %.240s\n",
                        line ? line : "no file was written");
    length[next] = (size_t)used;
    present = next;
}

void bench_interrupt_catch(void)
{
    bench_interrupt_say(NULL);
    for (int i = 0; i < BENCH_INTERRUPT_SIGNALS; i++)
        bench_interrupt_handle(bench_interrupt_signals[i], interrupt);
    bench_interrupt_handle(SIGPIPE, interrupt);
    bench_interrupt_handle(SIGXFSZ, SIG_IGN); /* a write beyond the limit fails, and is told */
}
