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
        store4(out, sum);
        store4(out + 4, moment);
    }
}

void lsm_bars_up(const Lsm *lsm, int first, int last){
#define CALL(side) bars_up(lsm, lsm->sets.bar_plane[first], lsm->sets.bar_plane[last], side)
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
            sum += load8(member);
            moment += (real)(i - side / 2) * load4(member);
        }
        real *out = lsm->rows.plate + plate * ROW_PLATE;
        store8(out, sum);
        store4(out + 8, moment);
    }
}

void lsm_plates_up(const Lsm *lsm, int first, int last){
#define CALL(side) plates_up(lsm, lsm->sets.plate_plane[first], lsm->sets.plate_plane[last], side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE void region_up(const Lsm *lsm, int region, int side, real out[16])
{
    const int *id = lsm->sets.region + (long)region * side;
    vec8 sum = {0};
    vec4 third = {0}, moment = {0};
    for (int i = 0; i < side; i++) {
        const real *member = lsm->rows.plate + (long)id[i] * ROW_PLATE;
        sum += load8(member);
        third += load4(member + 8);
        moment += (real)(i - side / 2) * load4(member);
    }
    store8(out, sum);
    store4(out + 8, third);
    store4(out + 12, moment);
}

/* Without reuse, member by member: the O(w^3) form. */
static void region_up_naive(const Lsm *lsm, int region, real out[16])
{
    int side = lsm->side, w = lsm->w;
    const int *plates = lsm->sets.region + (long)region * side;
    vec4 C = {0}, X = {0}, Y = {0}, Z = {0};
    for (int c = -w; c <= w; c++)
        for (int b = -w; b <= w; b++) {
            const int *id =
                lsm->sets.bar + (long)lsm->sets.plate[(long)plates[c + w] * side + b + w] * side;
            for (int a = -w; a <= w; a++) {
                vec4 p = load4(lsm->rows.p + (long)id[a + w] * ROW_P);
                C += p;
                X += (real)a * p;
                Y += (real)b * p;
                Z += (real)c * p;
            }
        }
    store4(out, C);
    store4(out + 4, X);
    store4(out + 8, Y);
    store4(out + 12, Z);
}

void lsm_region_up(const Lsm *lsm, int region, real out[16])
{
    if (lsm->params.summation == SM_SUM_NAIVE) {
        region_up_naive(lsm, region, out);
        return;
    }
#define CALL(side) region_up(lsm, region, side, out)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

/* A transform's row is (q, Rz, Ry, Rx): each pass uses the last vector up. */
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
        real *out = lsm->rows.bar_down + bar * ROW_BAR_DOWN, all[16];
        store16(all, sum);
        store4(out, load4(all) - moment);
        store8(out + 4, load8(all + 4));
    }
}

void lsm_bars_down(const Lsm *lsm, int first, int last){
#define CALL(side) bars_down(lsm, lsm->sets.bar_plane[first], lsm->sets.bar_plane[last], side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE void plates_down(const Lsm *lsm, long first, long last, int side)
{
    for (long plate = first; plate < last; plate++) {
        const int *id = lsm->sets.plate + plate * side;
        vec4 sum = {0}, z = {0}, moment = {0};
        for (int i = 0; i < side; i++) {
            const real *member = lsm->rows.bar_down + (long)id[i] * ROW_BAR_DOWN;
            sum += load4(member);
            z += load4(member + 4);
            moment += (real)(i - side / 2) * load4(member + 8);
        }
        real *out = lsm->rows.plate_down + plate * ROW_PLATE_DOWN;
        store4(out, sum - moment);
        store4(out + 4, z);
    }
}

void lsm_plates_down(const Lsm *lsm, int first, int last){
#define CALL(side) plates_down(lsm, lsm->sets.plate_plane[first], lsm->sets.plate_plane[last], side)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

SM_INLINE void particle_down(const Lsm *lsm, int region, int side, real out[4])
{
    const int *id = lsm->sets.region + (long)region * side;
    vec4 sum = {0};
    for (int i = 0; i < side; i++) {
        const real *member = lsm->rows.plate_down + (long)id[i] * ROW_PLATE_DOWN;
        sum += load4(member) - (real)(i - side / 2) * load4(member + 4);
    }
    store4(out, sum);
}

static void particle_down_naive(const Lsm *lsm, int region, real out[4])
{
    int side = lsm->side, w = lsm->w;
    const int *plates = lsm->sets.region + (long)region * side;
    vec4 sum = {0};
    for (int c = -w; c <= w; c++)
        for (int b = -w; b <= w; b++) {
            const int *id =
                lsm->sets.bar + (long)lsm->sets.plate[(long)plates[c + w] * side + b + w] * side;
            for (int a = -w; a <= w; a++) {
                const real *T = lsm->rows.transform + (long)id[a + w] * ROW_T;
                sum += load4(T) - (real)a * load4(T + 12) - (real)b * load4(T + 8) -
                       (real)c * load4(T + 4);
            }
        }
    store4(out, sum);
}

void lsm_particle_down(const Lsm *lsm, int region, real out[4])
{
    if (lsm->params.summation == SM_SUM_NAIVE) {
        particle_down_naive(lsm, region, out);
        return;
    }
#define CALL(side) particle_down(lsm, region, side, out)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}

/* out[row] = sum of the rows that `list` names; `parts` vectors of four each. */
SM_INLINE void plain(const int *list, int side, int parts, const real *in, int in_width, real *out)
{
    vec4 sum[4] = {{0}, {0}, {0}, {0}};
    for (int i = 0; i < side; i++)
        for (int part = 0; part < parts; part++)
            sum[part] += load4(in + (long)list[i] * in_width + 4 * part);
    for (int part = 0; part < parts; part++) store4(out + 4 * part, sum[part]);
}

void lsm_bars_plain(const Lsm *lsm, int first, int last, bool up)
{
    const Rows *rows = &lsm->rows;
    for (long bar = lsm->sets.bar_plane[first]; bar < lsm->sets.bar_plane[last]; bar++) {
        const int *id = lsm->sets.bar + bar * lsm->side;
        real *out = up ? rows->bar + bar * ROW_BAR : rows->bar_down + bar * ROW_BAR_DOWN;
#define CALL(side)                                                                                 \
    if (up)                                                                                        \
        plain(id, side, 3, rows->transform, ROW_T, out);                                           \
    else                                                                                           \
        plain(id, side, 2, rows->p, ROW_P, out)
        FOR_SIDE(lsm->side, CALL)
#undef CALL
    }
}

void lsm_plates_plain(const Lsm *lsm, int first, int last, bool up)
{
    const Rows *rows = &lsm->rows;
    for (long plate = lsm->sets.plate_plane[first]; plate < lsm->sets.plate_plane[last]; plate++) {
        const int *id = lsm->sets.plate + plate * lsm->side;
        real *out =
            up ? rows->plate + plate * ROW_PLATE : rows->plate_down + plate * ROW_PLATE_DOWN;
#define CALL(side)                                                                                 \
    if (up)                                                                                        \
        plain(id, side, 3, rows->bar, ROW_BAR, out);                                               \
    else                                                                                           \
        plain(id, side, 2, rows->bar_down, ROW_BAR_DOWN, out)
        FOR_SIDE(lsm->side, CALL)
#undef CALL
    }
}

void lsm_region_plain(const Lsm *lsm, int region, bool up, real out[16])
{
    const Rows *rows = &lsm->rows;
    const int *id = lsm->sets.region + (long)region * lsm->side;
#define CALL(side)                                                                                 \
    if (up)                                                                                        \
        plain(id, side, 3, rows->plate, ROW_PLATE, out);                                           \
    else                                                                                           \
        plain(id, side, 2, rows->plate_down, ROW_PLATE_DOWN, out)
    FOR_SIDE(lsm->side, CALL)
#undef CALL
}
