#include "progress.h"

#include <stdio.h>
#include <unistd.h>

#include "../../lib/system/clock.h"

void bench_progress_start(BenchProgress *progress, bool quiet)
{
    *progress = (BenchProgress){.shown = !quiet && isatty(STDERR_FILENO)};
}

void bench_progress_show(BenchProgress *progress, const char *what, double share)
{
    static const char full[] = "##############################";
    double now = sm_now();
    if (!progress->shown || now - progress->last < 0.1) return;
    progress->last = now;
    int done = share < 0 ? 0 : share > 1 ? 30 : (int)(30 * share);
    fprintf(stderr, "\r\033[K%-24.40s [%.*s%*s] %3.0f%%", what, done, full, 30 - done, "",
            100 * share);
    fflush(stderr);
}

void bench_progress_stop(BenchProgress *progress)
{
    if (progress->shown && progress->last > 0) fputs("\r\033[K", stderr);
    progress->last = 0;
}
