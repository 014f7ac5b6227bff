/* collide_sweep.h - which bodies' boxes overlap: sweep and prune along x. */
#ifndef SM_COLLIDE_SWEEP_H
#define SM_COLLIDE_SWEEP_H

#include <stdbool.h>

typedef struct {
    long bodies, pairs, room;
    double (*low)[3], (*high)[3]; /* [bodies] */
    int *order;                   /* [bodies] by rising low x; nearly right from the last time */
    int (*pair)[2];               /* [pairs] */
    long *first;                  /* [bodies + 1] */
    int *other;                   /* [2 pairs] bodies whose boxes overlap that of each */
} SmCollideSweep;

void sm_collide_sweep_init(SmCollideSweep *sweep, long bodies);
void sm_collide_sweep_free(SmCollideSweep *sweep);

/* Boxes of the positions x [bodies * nodes][3], wider by `margin` on every side, and who overlaps
 * whom. O(nodes + bodies + pairs that overlap along x). */
void sm_collide_sweep(SmCollideSweep *sweep, const double (*x)[3], long nodes, double margin);

/* Whether the box from low to high meets that of a body whose box overlaps body b's. */
bool sm_collide_sweep_meets(const SmCollideSweep *sweep, long b, const double low[3],
                            const double high[3]);

#endif
