/* operations.h - the least that a kernel has to do, counted by hand beside the kernel: what
 * `shapebench kernels` turns into a bound on its time (bench/kernels/machine_peak.h).
 *
 * Counts are for one item (particle, node, matrix, triangle, vertex). Flops: an addition,
 * multiplication, division or root is one, a multiply-add two. Near: values that every stage has to
 * read and write once, at best in the L1 cache. Far: what streams from where the whole state lies.
 */
#ifndef SM_OPERATIONS_H
#define SM_OPERATIONS_H

typedef struct {
    double flops;
    double near_values; /* values of the kernel's precision */
    double near_bytes;  /* further bytes that are not values of the precision */
    double far_values;  /* values of the precision */
    double far_bytes;   /* further bytes */
} SmOperations;

/* Of `a` once and of `b` so many times. */
static inline SmOperations sm_operations_add(SmOperations a, double times, SmOperations b)
{
    return (SmOperations){a.flops + times * b.flops, a.near_values + times * b.near_values,
                          a.near_bytes + times * b.near_bytes, a.far_values + times * b.far_values,
                          a.far_bytes + times * b.far_bytes};
}

#endif
