/* region_search.h - the search for a region in rows of type Row, of windows SIDE wide at most
 * (region.c). */

/* Adds the ring of one particle at window place (a, b, c) to `next`. */
static void NAMED(add_ring)(uint32_t link, int a, long row, int side, Row *next)
{
    for (int ring = 0; ring < 9; ring++) {
        Row three = link >> (3 * ring) & 7;
        next[row + (ring / 3 - 1) * side + ring % 3 - 1] |= three << (a - 1);
    }
}

/* One breadth-first step from `front`, whose members lie within `reach` of the centre. Particles
 * linked to all of their ring spread word-parallel, also to where there is no particle; the others
 * link by link. */
static void NAMED(spread)(const LsmLattice *l, const uint64_t *complete, const int centre[3], int w,
                          int reach, const Row *front, Row *next)
{
    int side = 2 * w + 1;
    for (int c = -reach; c <= reach; c++)
        for (int b = -reach; b <= reach; b++) {
            long row = (long)(c + w) * side + b + w;
            if (!front[row]) continue;
            Row whole = front[row] &
                        (Row)lsm_window(l, complete, centre[0], centre[1] + b, centre[2] + c, w);
            if (whole)
                for (int ring = 0; ring < 9; ring++)
                    next[row + (ring / 3 - 1) * side + ring % 3 - 1] |=
                        whole << 1 | whole | whole >> 1;
            for (Row rest = front[row] & ~whole; rest; rest &= rest - 1) {
                int a = lsm_row_first(rest);
                long p = lsm_lattice_find(l, centre[0] + a - w, centre[1] + b, centre[2] + c);
                NAMED(add_ring)(l->link[p], a, row, side, next);
            }
        }
}

/* Is the material of the window one box without a broken or missing link? Then all of it is within
 * reach: this is the usual case at the faces, edges and corners of a solid. */
static bool NAMED(one_box)(const LsmLattice *l, const LsmInterior *interior, const int centre[3],
                           const Row *material)
{
    int w = interior->w, side = 2 * w + 1, low[2] = {side, side}, high[2] = {-1, -1}, filled = 0;
    Row run = material[w * side + w], ends = run & -run;
    if (run & (run + ends)) return false; /* more than one run */
    for (int row = 0; row < side * side; row++) {
        if (!material[row]) continue;
        int at[2] = {row % side, row / side};
        if (material[row] != run) return false;
        if (lsm_window(l, interior->complete, centre[0], centre[1] + at[0] - w,
                       centre[2] + at[1] - w, w) != run)
            return false;
        for (int d = 0; d < 2; d++) {
            low[d] = at[d] < low[d] ? at[d] : low[d];
            high[d] = at[d] > high[d] ? at[d] : high[d];
        }
        filled++;
    }
    return filled == (high[0] - low[0] + 1) * (high[1] - low[1] + 1);
}

static void NAMED(search)(const LsmLattice *l, const LsmInterior *interior, const int centre[3],
                          const Row *material, Row *rows)
{
    int w = interior->w, side = 2 * w + 1, area = side * side;
    Row front[SIDE * SIDE], next[SIDE * SIDE];
    memset(rows, 0, (size_t)area * sizeof *rows);
    memset(front, 0, (size_t)area * sizeof *front);
    front[w * side + w] = rows[w * side + w] = (Row)1 << w;
    for (int step = 0; step < w; step++) {
        memset(next, 0, (size_t)area * sizeof *next);
        NAMED(spread)(l, interior->complete, centre, w, step, front, next);
        for (int row = 0; row < area; row++) {
            front[row] = next[row] & material[row] & ~rows[row];
            rows[row] |= front[row];
        }
    }
}

/* The same as lsm_region_find(), of a region that is not the whole cube. */
static int NAMED(find)(const LsmLattice *l, const LsmInterior *interior, long r, LsmRow *rows,
                       bool *simple)
{
    int w = interior->w, side = 2 * w + 1, area = side * side, count = 0;
    const int *centre = l->coord[r];
    Row material[SIDE * SIDE], found[SIDE * SIDE];
    memset(material, 0, (size_t)area * sizeof *material);
    for (int row = 0; row < area; row++)
        material[row] = (Row)lsm_window(l, l->bits, centre[0], centre[1] + row % side - w,
                                        centre[2] + row / side - w, w);
    *simple = NAMED(one_box)(l, interior, centre, material);
    if (!*simple) NAMED(search)(l, interior, centre, material, found);
    for (int row = 0; row < area; row++) {
        rows[row] = *simple ? material[row] : found[row];
        count += lsm_row_count(rows[row]);
    }
    return count;
}
