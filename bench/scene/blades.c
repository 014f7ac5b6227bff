#include "blades.h"

#include <math.h>

double bench_share_of(double time, double start, double stop)
{
    return stop > start ? fmin(fmax((time - start) / (stop - start), 0), 1) : 1;
}

void bench_between(const double from[3], const double to[3], double share, double at[3])
{
    for (int d = 0; d < 3; d++) at[d] = from[d] + share * (to[d] - from[d]);
}

bool bench_blade_moves(const BenchCut *cut, double from, double to, double blade[4][3])
{
    if (to < cut->start || from > cut->stop) return false;
    for (int end = 0; end < 2; end++) {
        double share = bench_share_of(end ? to : from, cut->start, cut->stop);
        bench_between(cut->base_from, cut->base_to, share, blade[2 * end]);
        bench_between(cut->tip_from, cut->tip_to, share, blade[2 * end + 1]);
    }
    return true;
}

bool bench_blades_move(const BenchScene *scene, double from, double to)
{
    for (int i = 0; i < scene->cut_count; i++)
        if (to >= scene->cut[i].start && from <= scene->cut[i].stop) return true;
    return false;
}
