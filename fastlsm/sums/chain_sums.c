#include "chain_sums.h"

#include <stdlib.h>

enum { CHAIN_LEAST_W = 4, WIDTH = 16 }; /* measured: at w = 3 the lists are as fast */

/* Where a kind of row takes its moments from and adds them to, in vectors of four. */
typedef enum { NONE, UP, DOWN } Moments;
typedef struct {
    const real *in;
    int in_width, vectors; /* values apart, and vectors of four to read */
    real *out;
    Moments moments;
    int from, to;
} Level;

/* `v` as the first or second half of eight values, zero elsewhere. */
SM_INLINE vec8 half(vec4 v, int second)
{
    return second ? __builtin_shufflevector(v, (vec4){0}, 4, 4, 4, 4, 0, 1, 2, 3)
                  : __builtin_shufflevector(v, (vec4){0}, 0, 1, 2, 3, 4, 4, 4, 4);
}

/* One row of a chain, in two halves, into `out`: its base, moved on, and its terms. */
SM_INLINE void chain_row(const Lsm *lsm, const LsmChain *chain, long row, Level level, real *out)
{
    const real *base = level.out + (long)(chain->base[row] / 2) * WIDTH;
    vec8 sum[2] = {{0}, {0}};
    vec4 moment = {0};
    if (level.moments != NONE)
        moment -= (real)(chain->base[row] & 1) * load4(base + 4 * level.from);
    const LsmTerm *term = chain->term + chain->first[row],
                  *end = chain->term + chain->first[row + 1];
    do {
        for (int i = 0; i < 2; i++, term++) {
            const real *member = level.in + (long)term->row * level.in_width,
                       *factor = lsm->chain_factor[term->factor];
            sum[0] += factor[0] * (level.vectors == 1 ? half(load4(member), 0) : load8(member));
            if (level.vectors == 4) sum[1] += factor[0] * load8(member + 8);
            if (level.moments != NONE) moment += factor[1] * load4(member + 4 * level.from);
        }
    } while (term < end);
    if (level.moments == UP) sum[level.to / 2] += half(moment, level.to % 2);
    if (level.moments == DOWN) sum[level.to / 2] -= half(moment, level.to % 2);
    /* what is large last: it is rounded once */
    store8(out, load8(base) + sum[0]);
    store8(out + 8, load8(base + 8) + sum[1]);
}

/* Bars or plates `first` .. `last` - 1. */
SM_INLINE void chain_rows(const Lsm *lsm, const LsmChain *chain, long first, long last, Level level)
{
    for (long row = first; row < last; row++)
        chain_row(lsm, chain, row, level, level.out + row * WIDTH);
}

/* Regions around, or sums over, the particles of a layer. */
SM_INLINE void chain_slots(const Lsm *lsm, int layer, Level level)
{
    const LsmChain *chain = &lsm->chains->region;
    for (long slot = lsm->layer_block[layer] * SM_LANES;
         slot < lsm->layer_block[layer + 1] * SM_LANES && lsm->particle[slot] >= 0; slot++) {
        chain_row(lsm, chain, lsm->particle[slot] + 1, level, level.out + (slot + 1) * WIDTH);
    }
}

void lsm_chain_sets_up(const Lsm *lsm, int layer, bool damping)
{
    const LsmSets *sets = &lsm->sets;
    const Rows *r = &lsm->rows;
    int first = lsm->layer_plane[layer], last = lsm->layer_plane[layer + 1];
    long bar = sets->bar_plane[first], bars = sets->bar_end[last];
    long plate = sets->plate_plane[first], plates = sets->plate_end[last];
    if (damping) {
        chain_rows(lsm, &lsm->chains->bar, bar, bars,
                   (Level){r->transform, ROW_T, 4, r->bar, NONE, 0, 0});
        chain_rows(lsm, &lsm->chains->plate, plate, plates,
                   (Level){r->bar, ROW_BAR, 4, r->plate, NONE, 0, 0});
    } else {
        chain_rows(lsm, &lsm->chains->bar, bar, bars, (Level){r->p, ROW_P, 1, r->bar, UP, 0, 1});
        chain_rows(lsm, &lsm->chains->plate, plate, plates,
                   (Level){r->bar, ROW_BAR, 2, r->plate, UP, 0, 2});
    }
}

void lsm_chain_regions_up(const Lsm *lsm, int layer, bool damping)
{
    const Rows *r = &lsm->rows;
    if (damping)
        chain_slots(lsm, layer, (Level){r->plate, ROW_PLATE, 4, r->transform, NONE, 0, 0});
    else
        chain_slots(lsm, layer, (Level){r->plate, ROW_PLATE, 4, r->transform, UP, 0, 3});
}

void lsm_chain_sets_down(const Lsm *lsm, int layer, bool damping)
{
    const LsmSets *sets = &lsm->sets;
    const Rows *r = &lsm->rows;
    int first = lsm->layer_plane[layer], last = lsm->layer_plane[layer + 1];
    long bar = sets->bar_plane[first], bars = sets->bar_end[last];
    long plate = sets->plate_plane[first], plates = sets->plate_end[last];
    if (damping) {
        chain_rows(lsm, &lsm->chains->bar, bar, bars,
                   (Level){r->transform, ROW_T, 2, r->bar, NONE, 0, 0});
        chain_rows(lsm, &lsm->chains->plate, plate, plates,
                   (Level){r->bar, ROW_BAR, 2, r->plate_down, NONE, 0, 0});
    } else {
        chain_rows(lsm, &lsm->chains->bar, bar, bars,
                   (Level){r->transform, ROW_T, 4, r->bar, DOWN, 3, 0});
        chain_rows(lsm, &lsm->chains->plate, plate, plates,
                   (Level){r->bar, ROW_BAR, 4, r->plate_down, DOWN, 2, 0});
    }
}

void lsm_chain_particles(const Lsm *lsm, int layer, bool damping)
{
    const Rows *r = &lsm->rows;
    if (damping)
        chain_slots(lsm, layer,
                    (Level){r->plate_down, ROW_PLATE_CHAIN, 2, r->transform, NONE, 0, 0});
    else
        chain_slots(lsm, layer,
                    (Level){r->plate_down, ROW_PLATE_CHAIN, 2, r->transform, DOWN, 1, 0});
}

bool lsm_chained(const Lsm *lsm)
{
    const double like = 16; /* a heavy particle that leaves a sum leaves its rounding behind */
    double least = 1, most = 1;
    for (long p = 0; p < lsm->lattice.count && lsm->mass; p++) {
        least = lsm->mass[p] < least ? lsm->mass[p] : least;
        most = lsm->mass[p] > most ? lsm->mass[p] : most;
    }
    return lsm->w >= CHAIN_LEAST_W && lsm->params.summation == SM_SUM_FAST &&
           lsm->params.strain_limit == 0 && lsm->params.instances <= 1 && most <= like * least;
}

void lsm_chain_open(Lsm *lsm)
{
    double factor[LSM_FACTORS][2];
    lsm->chains = sm_alloc(1, sizeof *lsm->chains);
    lsm_chains_build(&lsm->lattice, &lsm->sets, lsm->layers, lsm->layer_plane, lsm->chains);
    LsmChain *region = &lsm->chains->region;
    for (long r = 1; r < region->rows; r++)
        if (region->base[r]) region->base[r] = 2 * (lsm->slot[region->base[r] / 2 - 1] + 1) + 1;
    lsm_chain_factors(lsm->w, factor);
    lsm->chain_factor = sm_alloc(LSM_FACTORS, sizeof *lsm->chain_factor);
    for (int i = 0; i < 4 * lsm->w + 4; i++)
        for (int k = 0; k < 2; k++) lsm->chain_factor[i][k] = (real)factor[i][k];
    int **list[3] = {&lsm->sets.bar, &lsm->sets.plate, &lsm->sets.region};
    for (int i = 0; i < 3; i++) {
        free(*list[i]);
        *list[i] = NULL;
    }
}
