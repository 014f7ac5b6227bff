#include "interrupt.h"

#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <unistd.h>

#include "draft.h"

/* Two lines in turn, so that the handler always has a whole one. */
static char lines[2][288];
static size_t length[2];
static volatile sig_atomic_t present;

static void interrupt(int number)
{
    bench_drafts_remove();
    int which = present;
    ssize_t written = write(STDERR_FILENO, lines[which], length[which]);
    (void)written;
    _exit(128 + number);
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
    struct sigaction action = {.sa_handler = interrupt};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}
