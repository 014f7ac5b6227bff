/* team.h - how many threads a parallel loop runs on.
 *
 * Every parallel region names its number by sm_team(), so that one number holds everywhere: that
 * of the engine it belongs to (SmEngineParams.threads), else OpenMP's of the calling thread
 * (omp_set_num_threads(), OMP_NUM_THREADS, or all cores), which the program sets to its --threads.
 * system/cores.h knows a container's quota, which OpenMP does not.
 */
#ifndef SM_TEAM_H
#define SM_TEAM_H

#ifdef _OPENMP
#include <omp.h>
#else /* one thread */
static inline int omp_get_num_procs(void)
{
    return 1;
}

static inline int omp_get_max_threads(void)
{
    return 1;
}

static inline int omp_get_num_threads(void)
{
    return 1;
}

static inline int omp_get_thread_num(void)
{
    return 0;
}

static inline int omp_in_parallel(void)
{
    return 0;
}

static inline void omp_set_num_threads(int threads)
{
    (void)threads;
}
#endif

enum { SM_MOST_THREADS = 1024 }; /* OpenMP's runtimes crash some way beyond */

/* The number that was asked for, where it is 0 OpenMP's; never too many. */
static inline int sm_team(int wanted)
{
    int threads = wanted > 0 ? wanted : omp_get_max_threads();
    return threads < SM_MOST_THREADS ? threads : SM_MOST_THREADS;
}

/* OpenMP's number, or as many as have some ten microseconds' work each where an item, a particle or
 * a word of bits, takes a nanosecond or more. */
static inline int sm_team_for(long items)
{
    const long worth = 1 << 14;
    int threads = sm_team(0);
    return threads <= items / worth ? threads : 1 + (int)(items / worth);
}

/* Makes that the number for what the calling thread calls from here to sm_team_leave(), which takes
 * what this returns: the number before. */
static inline int sm_team_enter(int wanted)
{
    int before = omp_get_max_threads();
    omp_set_num_threads(sm_team(wanted));
    return before;
}

static inline void sm_team_leave(int before)
{
    omp_set_num_threads(before);
}

#endif
