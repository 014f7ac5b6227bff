#include "fracture.h"

#include <stdlib.h>
#include <string.h>

#include "build.h"

static real component(const Lsm *lsm, long slot, int d)
{
    return lsm->x[(slot / SM_LANES * 3 + d) * SM_LANES + slot % SM_LANES];
}

static bool too_long(const Lsm *lsm, long p, long q)
{
    double square = 0, rest = 0;
    for (int d = 0; d < 3; d++) {
        double stretch =
            (double)component(lsm, lsm->slot[p], d) - (double)component(lsm, lsm->slot[q], d);
        int cells = lsm->lattice.coord[p][d] - lsm->lattice.coord[q][d];
        square += stretch * stretch;
        rest += cells * cells;
    }
    return square > lsm->params.strain_limit * lsm->params.strain_limit * rest;
}

void lsm_fracture(Lsm *lsm)
{
    LsmLattice *l = &lsm->lattice;
    long before = lsm->broken;
    for (long p = 0; p < l->count; p++)
        for (uint32_t rest = l->link[p] >> (LSM_SELF + 1) << (LSM_SELF + 1); rest;
             rest &= rest - 1) {
            int bit = __builtin_ctz(rest);
            const int *c = l->coord[p];
            long q =
                lsm_lattice_find(l, c[0] + bit % 3 - 1, c[1] + bit / 3 % 3 - 1, c[2] + bit / 9 - 1);
            if (!too_long(lsm, p, q)) continue;
            lsm_lattice_break(l, p, bit);
            lsm->broken++;
        }
    if (lsm->broken > before) lsm_rebuild_regions(lsm);
}

bool lsm_recentre(Lsm *lsm)
{
    double sum[3] = {0, 0, 0};
    for (long block = 0; block < lsm->blocks; block++)
        for (int d = 0; d < 3; d++) {
            const real *x = lsm->x + (block * 3 + d) * SM_LANES;
            real part = 0;
            for (int lane = 0; lane < SM_LANES; lane++) part += x[lane];
            sum[d] += (double)part;
        }
    double middle[3];
    bool far = false;
    for (int d = 0; d < 3; d++) {
        middle[d] = rint(sum[d] / (double)lsm->lattice.count);
        far |= fabs(middle[d]) > 4;
    }
    if (!far) return false;
    for (int d = 0; d < 3; d++) lsm->origin[d] += middle[d] * lsm->cell;
    for (long slot = 0; slot < lsm->blocks * SM_LANES; slot++)
        for (int d = 0; d < 3 && lsm->particle[slot] >= 0; d++)
            lsm->x[(slot / SM_LANES * 3 + d) * SM_LANES + slot % SM_LANES] -= (real)middle[d];
    return true;
}
