/* heap.h - how much memory the program has allocated. */
#ifndef SM_HEAP_H
#define SM_HEAP_H

#include <stdlib.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

/* Bytes, of all threads; 0 where the C library does not say. What something takes is by how much
 * it is more afterwards. */
static inline long sm_heap_used(void)
{
#if __GLIBC__ > 2 || __GLIBC_MINOR__ >= 33
    struct mallinfo2 heap = mallinfo2();
    return (long)(heap.uordblks + heap.hblkhd);
#else
    return 0;
#endif
}

#endif
