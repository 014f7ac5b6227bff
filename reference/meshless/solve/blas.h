/* blas.h - BLAS on one thread, where it has threads of its own (OpenBLAS): with more, sums are
 * split elsewhere and their last bits differ, by which cracks may take another way. */
#ifndef REF_BLAS_H
#define REF_BLAS_H

int openblas_get_num_threads(void) __attribute__((weak));
void openblas_set_num_threads(int threads) __attribute__((weak));

/* Returns how many it had, for ref_blas_again(): the caller's program may use it, too. The number
 * is the process's: of two bodies that are solved at once one may run on more. */
static inline int ref_blas_alone(void)
{
    int threads = openblas_get_num_threads ? openblas_get_num_threads() : 1;
    if (threads > 1) openblas_set_num_threads(1);
    return threads;
}

static inline void ref_blas_again(int threads)
{
    if (threads > 1) openblas_set_num_threads(threads);
}

#endif
