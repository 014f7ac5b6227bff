#include "progress.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "../../lib/system/clock.h"

void bench_progress_start(BenchProgress *progress, bool quiet)
{
    *progress = (BenchProgress){.shown = !quiet && isatty(STDERR_FILENO)};
}

void bench_progress_part(BenchProgress *progress, int part, int parts)
{
    progress->part = part;
    progress->parts = parts;
}

void bench_progress_left(double seconds, char text[24])
{
    *text = '\0';
    if (!(seconds >= 0 && seconds < 1e8)) return;
    if (seconds < 90)
        snprintf(text, 24, "%.0f s left", seconds);
    else if (seconds < 5400)
        snprintf(text, 24, "%.0f min left", seconds / 60);
    else
        snprintf(text, 24, "%d h %d min left", (int)(seconds / 3600), (int)(seconds / 60) % 60);
}

/* Seconds until all is done, by those that it took so far; NaN: too early to say. */
static double seconds_left(BenchProgress *progress, double share, double now)
{
    if (share < progress->at || progress->since == 0) {
        progress->since = now;
        progress->of = share;
    }
    progress->at = share;
    double took = now - progress->since, done = share - progress->of;
    return took < 2 || done <= 0 ? NAN : took * (1 - share) / done;
}

void bench_progress_show(BenchProgress *progress, const char *what, double share)
{
    static const char full[] = "####################";
    const int width = sizeof full - 1;
    double now = sm_now();
    if (!progress->shown || now - progress->last < 0.1) return;
    progress->last = now;
    char time[24];
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    if (progress->parts) share = (progress->part + share) / progress->parts;
    int done = (int)(width * share);
    bench_progress_left(seconds_left(progress, share, now), time);
    fprintf(stderr, "\r\033[K%-24.30s [%.*s%*s] %3.0f%%  %s", what, done, full, width - done, "",
            100 * share, time);
    fflush(stderr);
}

void bench_progress_stop(BenchProgress *progress)
{
    if (progress->shown && progress->last > 0) fputs("\r\033[K", stderr);
    progress->last = 0;
}
