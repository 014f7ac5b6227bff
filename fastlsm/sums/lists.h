/* lists.h - the phases of a pass over lists (sums.h): of the forms naive, lists and running, and of
 * boxes for the regions that have lists. */
#ifndef LSM_LISTS_H
#define LSM_LISTS_H

#include "../../lib/simd/momentum.h"
#include "sums.h"

#define lsm_lists_build_layers   SM_NAME(lsm_lists_build_layers)
#define lsm_rows_place           SM_NAME(lsm_rows_place)
#define lsm_rows_free            SM_NAME(lsm_rows_free)
#define lsm_rows_of              SM_NAME(lsm_rows_of)
#define lsm_running_free         SM_NAME(lsm_running_free)
#define lsm_lists_lay_out        SM_NAME(lsm_lists_lay_out)
#define lsm_lists_subsums        SM_NAME(lsm_lists_subsums)
#define lsm_lists_solve          SM_NAME(lsm_lists_solve)
#define lsm_lists_end            SM_NAME(lsm_lists_end)
#define lsm_lists_keep_down      SM_NAME(lsm_lists_keep_down)
#define lsm_list_kernels         SM_NAME(lsm_list_kernels)
#define lsm_list_kernels_regions SM_NAME(lsm_list_kernels_regions)

/* The first slot of a layer that begins behind `slot` others: of a vector, of any set's, since
 * momenta are summed by slots. Tiles begin alike: in a body that can break tile t is block t. */
SM_INLINE long lsm_layer_begin(long slot)
{
    return (slot + MOMENTUM_WAYS - 1) / MOMENTUM_WAYS * MOMENTUM_WAYS;
}

/* A slot's row of p and transform. */
SM_INLINE long slot_row(const Rows *rows, long slot)
{
    return slot + rows->shift;
}

/* Groups planes into layers of some hundred particles at least and finds how far a region reaches.
 */
void lsm_lists_build_layers(Lsm *lsm);

/* Particles in canonical order, in slots without holes but at the ends of layers. */
void lsm_lists_lay_out(Lsm *lsm);

/* Memory for the rows of lists, which are named by their places in it (lsm_lists_place);
 * region_plane[region_count]. Again where lsm->sums has changed. */
void lsm_rows_place(Lsm *lsm, const int *region_plane);
void lsm_rows_free(Lsm *lsm);

/* Those of a layer, for a thread. */
Rows lsm_rows_of(const Lsm *lsm, int layer, int thread);

void lsm_running_free(LsmRunning *running);

/* The three phases: bars and plates; regions, and bars and plates down; particles. */
LsmPhase lsm_lists_subsums, lsm_lists_solve, lsm_lists_end;

/* Puts what the regions of a tile bring down (LsmPass) into their rows of rows->transform. */
void lsm_lists_keep_down(const Lsm *lsm, const Rows *rows, long tile, const real *down);

/* Through bars and plates (list_sums.c), and its sums of the regions listed in rows region[lane],
 * zero where that is negative. */
extern const LsmListKernels lsm_list_kernels;
void lsm_list_kernels_regions(const Lsm *lsm, const Rows *rows, const int *region, bool plain,
                              vec sum[12]);

#endif
