/* list_sums.h - sums over regions through bars and plates (fastlsm section 3.1), in list form.
 *
 * The moment chain: instead of x x0^T against a global origin, sum p = m~ x and its moments about
 * the region's own centre. With lattice offsets (a, b, c) from the centre
 *     bar    B = sum p,   Bx = sum a p
 *     plate  P = sum B,   Px = sum Bx,  Py = sum b B
 *     region C = sum P,   Cx = sum Px,  Cy = sum Py,  Cz = sum c P.
 * The adjoint brings region transforms down to particles: with T = (q, Rx, Ry, Rz)
 *     |R_i| g_i = sum_r q_r + R_r (x0_i - x0_r) = sum q - a Rx - b Ry - c Rz,
 * where (a, b, c) is r's offset from i. All sums run over fixed places in a fixed order. */
#ifndef LSM_LIST_SUMS_H
#define LSM_LIST_SUMS_H

#include "../state.h"

#define lsm_bars_up         SM_NAME(lsm_bars_up)
#define lsm_plates_up       SM_NAME(lsm_plates_up)
#define lsm_regions_up      SM_NAME(lsm_regions_up)
#define lsm_bars_down       SM_NAME(lsm_bars_down)
#define lsm_plates_down     SM_NAME(lsm_plates_down)
#define lsm_particles_down  SM_NAME(lsm_particles_down)
#define lsm_bars_plain      SM_NAME(lsm_bars_plain)
#define lsm_plates_plain    SM_NAME(lsm_plates_plain)
#define lsm_regions_plain   SM_NAME(lsm_regions_plain)
#define lsm_particles_plain SM_NAME(lsm_particles_plain)

/* Bars and plates of the planes first .. last-1, from rows.p. */
void lsm_bars_up(const Lsm *lsm, int first, int last);
void lsm_plates_up(const Lsm *lsm, int first, int last);

/* The last stage for the rows region[lane] of the lists, SM_LANES of them (-1: none, its sums are
 * zero): out[lane] = (C, Cx, Cy, Cz), each padded to four. */
void lsm_regions_up(const Lsm *lsm, const int *region, vec16 *out);

/* The adjoint, from rows.transform: out[d][lane] = component d of |R_i| g_i. */
void lsm_bars_down(const Lsm *lsm, int first, int last);
void lsm_plates_down(const Lsm *lsm, int first, int last);
void lsm_particles_down(const Lsm *lsm, const int *region, real out[3][SM_LANES]);

/* Plain sums without moments, for damping: `up` sums 12 values of rows.transform through bar and
 * plate; else 8 values of it go down through bar and plate_down. */
void lsm_bars_plain(const Lsm *lsm, int first, int last, bool up);
void lsm_plates_plain(const Lsm *lsm, int first, int last, bool up);
void lsm_regions_plain(const Lsm *lsm, const int *region, vec16 *out);
void lsm_particles_plain(const Lsm *lsm, const int *region, real out[6][SM_LANES]);

#endif
