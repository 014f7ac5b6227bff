/* collide_sweep.h - which bodies' boxes overlap: sweep and prune along x. */
#ifndef SM_COLLIDE_SWEEP_H
#define SM_COLLIDE_SWEEP_H

#include <stdbool.h>

typedef struct {
    long bodies, pairs, room;
    double (*low)[3], (*high)[3]; /* [bodies] */
    int *order;                   /* [bodies] by rising low x; nearly right from the last time */
    int (*pair)[2];               /* [pairs] */
    bool *meets;                  /* [bodies] is in a pair */
} SmCollideSweep;

void sm_collide_sweep_init(SmCollideSweep *sweep, long bodies);
void sm_collide_sweep_free(SmCollideSweep *sweep);

/* Boxes of the positions x [bodies * nodes][3], wider by `margin` on every side, and who overlaps
 * whom. O(nodes + bodies + pairs that overlap along x). */
void sm_collide_sweep(SmCollideSweep *sweep, const double (*x)[3], long nodes, double margin);

#endif
