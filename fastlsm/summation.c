#include "summation.h"

/* Each kernel is one body in which `side` is a constant for the usual widths. */
#define FOR_SIDE(side, call)                                                                       \
    switch (side) {                                                                                \
    case 3:                                                                                        \
        call(3);                                                                                   \
        break;                                                                                     \
    case 5:                                                                                        \
        call(5);                                                                                   \
        break;                                                                                     \
    case 7:                                                                                        \
        call(7);                                                                                   \
        break;                                                                                     \
    default:                                                                                       \
        call(side);                                                                                \
        break;                                                                                     \
    }

/* `v` in the first or last four lanes of sixteen, zero elsewhere; the compiler would go through
 * memory, and stall there. */
SM_INLINE vec16 widen_first(vec4 v)
{
#if defined(__AVX512F__) && SM_REAL_BITS == 32
    return (vec16)_mm512_zextps128_ps512((__m128)v);
#else
    return __builtin_shufflevector(v, (vec4){0}, 0, 1, 2, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4);
#endif
}

SM_INLINE vec16 widen_last(vec4 v)
{
#if defined(__AVX512F__) && SM_REAL_BITS == 32
    return (vec16)_mm512_maskz_broadcast_f32x4(0xf000, (__m128)v);
#else
    return __builtin_shufflevector(v, (vec4){0}, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 0, 1, 2, 3);
#endif
}

SM_INLINE vec4 first_four(vec16 v)
{
    return __builtin_shufflevector(v, v, 0, 1, 2, 3);
}

SM_INLINE void bars_up(const Lsm *lsm, long first, long last, int side)
{
    const real *p = lsm->rows.p;
    for (long bar = first; bar < last; bar++) {
        const int *id = lsm->sets.bar + bar * side;
        vec4 sum = {0}, moment = {0};
        for (int i = 0; i < side; i++) {
            vec4 member = load4(p + (long)id[i] * ROW_P);
            sum += member;
            moment += (real)(i - side / 2) * member;
        }
        real *out = lsm->rows.bar + bar * ROW_BAR;
        store8(out, __builtin_shufflevector(sum, moment, 0, 1, 2, 3, 4, 5, 6, 7));
    }
}

void lsm_bars_up(const Lsm *lsm, int first, int last){
#define CALL(side) bars_up(lsm, lsm->sets.bar_plane[first], lsm->sets.bar_end[last], side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE void plates_up(const Lsm *lsm, long first, long last, int side)
{
    const real *bar = lsm->rows.bar;
    for (long plate = first; plate < last; plate++) {
        const int *id = lsm->sets.plate + plate * side;
        vec8 sum = {0};
        vec4 moment = {0};
        for (int i = 0; i < side; i++) {
            const real *member = bar + (long)id[i] * ROW_BAR;
            vec8 value = load8(member);
            sum += value;
            moment += (real)(i - side / 2) * __builtin_shufflevector(value, value, 0, 1, 2, 3);
        }
        real *out = lsm->rows.plate + plate * ROW_PLATE;
        store8(out, sum);
        store4(out + 8, moment);
    }
}

void lsm_plates_up(const Lsm *lsm, int first, int last){
#define CALL(side) plates_up(lsm, lsm->sets.plate_plane[first], lsm->sets.plate_end[last], side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

/* The last four of a plate's row are never written: they stay zero. */
SM_INLINE vec16 region_up(const Lsm *lsm, int region, int side)
{
    const int *id = lsm->sets.region + (long)region * side;
    vec16 sum = {0};
    vec4 moment = {0};
    for (int i = 0; i < side; i++) {
        vec16 member = load16(lsm->rows.plate + (long)id[i] * ROW_PLATE);
        sum += member;
        moment += (real)(i - side / 2) * first_four(member);
    }
    return sum + widen_last(moment);
}

/* Without reuse, member by member: the O(w^3) form. Rows are summed on their own first, so that
 * single precision adds numbers of like size. */
static vec16 region_up_naive(const Lsm *lsm, int region)
{
    int side = lsm->side, w = lsm->w;
    const int *plates = lsm->sets.region + (long)region * side;
    vec4 C = {0}, X = {0}, Y = {0}, Z = {0};
    for (int c = -w; c <= w; c++)
        for (int b = -w; b <= w; b++) {
            const int *id =
                lsm->sets.bar + (long)lsm->sets.plate[(long)plates[c + w] * side + b + w] * side;
            vec4 sum[4] = {{0}, {0}, {0}, {0}};
            for (int a = -w; a <= w; a++) {
                vec4 p = load4(lsm->rows.p + (long)id[a + w] * ROW_P);
                sum[0] += p;
                sum[1] += (real)a * p;
                sum[2] += (real)b * p;
                sum[3] += (real)c * p;
            }
            C += sum[0];
            X += sum[1];
            Y += sum[2];
            Z += sum[3];
        }
    vec8 low = __builtin_shufflevector(C, X, 0, 1, 2, 3, 4, 5, 6, 7);
    vec8 high = __builtin_shufflevector(Y, Z, 0, 1, 2, 3, 4, 5, 6, 7);
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

SM_INLINE void regions_up(const Lsm *lsm, const int *region, vec16 *out, int side)
{
    for (int lane = 0; lane < SM_LANES; lane++)
        if (region[lane] >= 0) out[lane] = region_up(lsm, region[lane], side);
}

void lsm_regions_up(const Lsm *lsm, const int *region, vec16 *out)
{
    if (lsm->params.summation == SM_SUM_NAIVE) {
        for (int lane = 0; lane < SM_LANES; lane++)
            if (region[lane] >= 0) out[lane] = region_up_naive(lsm, region[lane]);
        return;
    }
#define CALL(side) regions_up(lsm, region, out, side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

/* A transform's row is (q, Rz, Ry, Rx): each pass uses the last vector up. What a pass leaves in
 * the last vector is not read again. */
SM_INLINE void bars_down(const Lsm *lsm, long first, long last, int side)
{
    for (long bar = first; bar < last; bar++) {
        const int *id = lsm->sets.bar + bar * side;
        vec16 sum = {0};
        vec4 moment = {0};
        for (int i = 0; i < side; i++) {
            const real *member = lsm->rows.transform + (long)id[i] * ROW_T;
            sum += load16(member);
            moment += (real)(i - side / 2) * load4(member + 12);
        }
        store16(lsm->rows.bar + bar * ROW_BAR, sum - widen_first(moment));
    }
}

void lsm_bars_down(const Lsm *lsm, int first, int last){
#define CALL(side) bars_down(lsm, lsm->sets.bar_plane[first], lsm->sets.bar_end[last], side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE void plates_down(const Lsm *lsm, long first, long last, int side)
{
    for (long plate = first; plate < last; plate++) {
        const int *id = lsm->sets.plate + plate * side;
        vec8 sum = {0};
        vec4 moment = {0};
        for (int i = 0; i < side; i++) {
            const real *member = lsm->rows.bar + (long)id[i] * ROW_BAR;
            sum += load8(member);
            moment += (real)(i - side / 2) * load4(member + 8);
        }
        store8(lsm->rows.plate_down + plate * ROW_PLATE_DOWN,
               sum - __builtin_shufflevector(moment, (vec4){0}, 0, 1, 2, 3, 4, 4, 4, 4));
    }
}

void lsm_plates_down(const Lsm *lsm, int first, int last){
#define CALL(side) plates_down(lsm, lsm->sets.plate_plane[first], lsm->sets.plate_end[last], side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE vec4 particle_down(const Lsm *lsm, int region, int side)
{
    const int *id = lsm->sets.region + (long)region * side;
    vec4 sum = {0};
    for (int i = 0; i < side; i++) {
        const real *member = lsm->rows.plate_down + (long)id[i] * ROW_PLATE_DOWN;
        sum += load4(member) - (real)(i - side / 2) * load4(member + 4);
    }
    return sum;
}

static vec4 particle_down_naive(const Lsm *lsm, int region)
{
    int side = lsm->side, w = lsm->w;
    const int *plates = lsm->sets.region + (long)region * side;
    vec4 sum = {0};
    for (int c = -w; c <= w; c++)
        for (int b = -w; b <= w; b++) {
            const int *id =
                lsm->sets.bar + (long)lsm->sets.plate[(long)plates[c + w] * side + b + w] * side;
            vec4 row = {0};
            for (int a = -w; a <= w; a++) {
                const real *T = lsm->rows.transform + (long)id[a + w] * ROW_T;
                row += load4(T) - (real)a * load4(T + 12) - (real)b * load4(T + 8) -
                       (real)c * load4(T + 4);
            }
            sum += row;
        }
    return sum;
}

SM_INLINE void particles_down(const Lsm *lsm, const int *region, real out[3][SM_LANES], int side)
{
    bool naive = lsm->params.summation == SM_SUM_NAIVE;
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (region[lane] < 0) continue;
        vec4 sum =
            naive ? particle_down_naive(lsm, region[lane]) : particle_down(lsm, region[lane], side);
        for (int d = 0; d < 3; d++) out[d][lane] = sum[d];
    }
}

void lsm_particles_down(const Lsm *lsm, const int *region, real out[3][SM_LANES]){
#define CALL(side) particles_down(lsm, region, out, side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE void plain_up(const int *list, long first, long last, int side, const real *in, real *out)
{
    for (long row = first; row < last; row++) {
        vec16 sum = {0};
        for (int i = 0; i < side; i++) sum += load16(in + (long)list[row * side + i] * 16);
        store16(out + row * 16, sum);
    }
}

SM_INLINE void plain_down(const int *list, long first, long last, int side, const real *in,
                          int in_width, real *out, int out_width)
{
    for (long row = first; row < last; row++) {
        vec8 sum = {0};
        for (int i = 0; i < side; i++) sum += load8(in + (long)list[row * side + i] * in_width);
        store8(out + row * out_width, sum);
    }
}

void lsm_bars_plain(const Lsm *lsm, int first, int last, bool up)
{
    const Rows *rows = &lsm->rows;
    const int *list = lsm->sets.bar;
    long from = lsm->sets.bar_plane[first], to = lsm->sets.bar_end[last];
#define CALL(side)                                                                                 \
    if (up)                                                                                        \
        plain_up(list, from, to, side, rows->transform, rows->bar);                                \
    else                                                                                           \
        plain_down(list, from, to, side, rows->transform, ROW_T, rows->bar, ROW_BAR)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

/* The last four values stay zero on the way up, as region_up() wants to find them. */
void lsm_plates_plain(const Lsm *lsm, int first, int last, bool up)
{
    const Rows *rows = &lsm->rows;
    const int *list = lsm->sets.plate;
    long from = lsm->sets.plate_plane[first], to = lsm->sets.plate_end[last];
#define CALL(side)                                                                                 \
    if (up)                                                                                        \
        plain_up(list, from, to, side, rows->bar, rows->plate);                                    \
    else                                                                                           \
        plain_down(list, from, to, side, rows->bar, ROW_BAR, rows->plate_down, ROW_PLATE_DOWN)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE void regions_plain(const Lsm *lsm, const int *region, vec16 *out, int side)
{
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (region[lane] < 0) continue;
        const int *id = lsm->sets.region + (long)region[lane] * side;
        vec16 sum = {0};
        for (int i = 0; i < side; i++) sum += load16(lsm->rows.plate + (long)id[i] * ROW_PLATE);
        out[lane] = sum;
    }
}

void lsm_regions_plain(const Lsm *lsm, const int *region, vec16 *out){
#define CALL(side) regions_plain(lsm, region, out, side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE void particles_plain(const Lsm *lsm, const int *region, real out[6][SM_LANES], int side)
{
    for (int lane = 0; lane < SM_LANES; lane++) {
        if (region[lane] < 0) continue;
        const int *id = lsm->sets.region + (long)region[lane] * side;
        vec8 sum = {0};
        for (int i = 0; i < side; i++)
            sum += load8(lsm->rows.plate_down + (long)id[i] * ROW_PLATE_DOWN);
        for (int i = 0; i < 6; i++) out[i][lane] = sum[i / 3 * 4 + i % 3];
    }
}

void lsm_particles_plain(const Lsm *lsm, const int *region, real out[6][SM_LANES])
{
#define CALL(side) particles_plain(lsm, region, out, side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}
