#include "quadtree.h"

#include <math.h>
#include <stdlib.h>

enum { MOST_ACROSS = 32, CELLS_OF_ROOT = 16 };
/* Fewer roots are preferred where more make cells no squarer than by this share of an edge; other
 * roots are tried for a tree of more nodes or fewer than by that share, if they make cells longer
 * by no more than the last. */
static const double SQUARER = 0.01, NEAR = 0.05, LONGER = 1.1;

void ref_quadtree_free(RefQuadtree *tree)
{
    sm_free_all(tree->cell, tree->grid);
    *tree = (RefQuadtree){0};
}

void ref_quadtree_cell(const RefQuadtree *tree, const RefCell *cell, double middle[2],
                       double edge[2])
{
    const RefRootGrid *grid = tree->grid + cell->grid;
    for (int d = 0; d < 2; d++) {
        edge[d] = grid->unit[d] * cell->size;
        middle[d] = grid->low[d] + grid->unit[d] * (cell->corner[d] + 0.5 * cell->size);
    }
}

double ref_quadtree_edge(const RefQuadtree *tree, const RefCell *cell)
{
    const RefRootGrid *grid = tree->grid + cell->grid;
    return cell->size * fmax(grid->unit[0], grid->unit[1]);
}

int ref_quadtree_at(const RefQuadtree *tree, const double theta[2])
{
    int place[2], at = 0, whole = 1 << REF_QUADTREE_LEVELS;
    const RefCylinders *cylinders = tree->chart->cylinders;
    const RefRootGrid *grid = tree->grid + (cylinders ? ref_cylinders_at(cylinders, theta) : 0);
    for (int d = 0; d < 2; d++) {
        double cells = floor((theta[d] - grid->low[d]) / grid->unit[d]);
        place[d] = (int)fmin(fmax(cells, 0), (double)grid->roots[d] * whole - 1);
    }
    at = grid->first + place[1] / whole * grid->roots[0] + place[0] / whole;
    while (tree->cell[at].child >= 0) {
        int half = tree->cell[at].size / 2, which = 0;
        for (int d = 0; d < 2; d++)
            if (place[d] >= tree->cell[at].corner[d] + half) which |= 1 << d;
        at = tree->cell[at].child + which;
    }
    return at;
}

static void split(RefQuadtree *tree, long at)
{
    sm_make_room(tree->cell, tree->room, tree->count + 4);
    RefCell parent = tree->cell[at];
    int half = parent.size / 2;
    tree->cell[at].child = (int)tree->count;
    tree->leaves += 3;
    for (int which = 0; which < 4; which++)
        tree->cell[tree->count++] = (RefCell){
            {parent.corner[0] + half * (which & 1), parent.corner[1] + half * (which >> 1)},
            half,
            -1,
            parent.grid};
}

/* At a zero of the chart's form functions are rough: as if cells there were so many times as large
 * they are split, once more for each factor of root 2. */
static const double FINER_AT_ZEROS = 2;

/* The longer edge on the surface. */
static double edge_on_surface(const RefQuadtree *tree, const RefCell *cell)
{
    double middle[2], edge[2], low[2], high[2], largest = 0, finer = 1;
    const RefChart *chart = tree->chart;
    ref_quadtree_cell(tree, cell, middle, edge);
    for (int d = 0; d < 2; d++) {
        low[d] = middle[d] - edge[d] / 2;
        high[d] = middle[d] + edge[d] / 2;
    }
    if (chart->mean) largest = chart->mean(chart->data, low, high);
    if (chart->cylinders && ref_cylinders_zero(chart->cylinders, low, high)) finer = FINER_AT_ZEROS;
    for (int n = 0; n < 25 && !chart->mean; n++) {
        double theta[2] = {middle[0] + edge[0] * (n % 5 - 2) / 4.0,
                           middle[1] + edge[1] * (n / 5 - 2) / 4.0};
        largest = fmax(largest, chart->factor(chart->data, theta));
    }
    return finer * largest * fmax(edge[0], edge[1]);
}

static bool refine(RefQuadtree *tree, double threshold)
{
    for (long at = 0; at < tree->count; at++) {
        if (tree->cell[at].size == 1 || !(edge_on_surface(tree, tree->cell + at) > threshold))
            continue;
        if (tree->count + 4 > REF_MOST_CELLS) return false;
        split(tree, at);
    }
    return true;
}

/* Whether a cell is so much larger than another one that it has to be split. */
static bool exceeds(const RefQuadtree *tree, const RefCell *cell, const RefCell *fine)
{
    if (cell->grid == fine->grid) return cell->size > 2 * fine->size;
    return cell->size > 1 &&
           ref_quadtree_edge(tree, cell) > (2 + 1e-6) * ref_quadtree_edge(tree, fine);
}

/* Splits what lies across side `side` of a cell that is two levels finer. Where the plane goes on
 * with a shift, cells' corners do not meet: both ends of the side are looked at. */
static bool relieve(RefQuadtree *tree, RefCell fine, int side)
{
    double middle[2], edge[2];
    const double *unit = tree->grid[fine.grid].unit;
    int axis = side / 2;
    bool changed = false;
    ref_quadtree_cell(tree, &fine, middle, edge);
    middle[axis] += (side % 2 ? 0.5 : -0.5) * (edge[axis] + unit[axis]);
    for (int end = -1; end <= 1; end += 2) {
        double beyond[2] = {middle[0], middle[1]};
        beyond[!axis] += end * 0.5 * (edge[!axis] - unit[!axis]);
        if (!ref_chart_enter(tree->chart, beyond)) continue;
        int at = ref_quadtree_at(tree, beyond);
        if (!exceeds(tree, tree->cell + at, &fine)) continue;
        split(tree, at);
        changed = true;
    }
    return changed;
}

/* One-level adjustment about cells from number `from` on, those that are new; splitting may call
 * for more splitting. */
static void balance(RefQuadtree *tree, long from)
{
    bool changed = true;
    while (changed) {
        changed = false;
        for (long at = from; at < tree->count; at++)
            for (int side = 0; side < 4 && tree->cell[at].child < 0; side++)
                changed |= relieve(tree, tree->cell[at], side);
    }
}

bool ref_quadtree_split(RefQuadtree *tree, long cell)
{
    if (tree->cell[cell].size == 1 || tree->count + 4 > REF_MOST_CELLS) return false;
    long from = tree->count;
    split(tree, cell);
    balance(tree, from);
    return true;
}

/* The sides of a chart's rectangle number n. */
static void sides_of(const RefChart *chart, int n, double low[2], double side[2])
{
    const RefCylinder *in = chart->cylinders ? chart->cylinders->cylinder + n : NULL;
    for (int d = 0; d < 2; d++) {
        low[d] = in ? in->low[d] : chart->low[d];
        side[d] = (in ? in->high[d] : chart->high[d]) - low[d];
    }
}

static int rectangles_of(const RefChart *chart)
{
    return chart->cylinders ? chart->cylinders->count : 1;
}

/* Along both sides of a rectangle; returns how much longer cells are one way than the other. */
static double roots_along(const double side[2], int across, int roots[2])
{
    double shorter = fmin(side[0], side[1]);
    for (int d = 0; d < 2; d++) roots[d] = (int)fmax(rint(across * side[d] / shorter), 1);
    double share = side[0] / roots[0] / (side[1] / roots[1]);
    return fmax(share, 1 / share);
}

/* How much longer the roots' cells are one way than the other, and how many there are. */
static double shape_of_roots(const RefChart *chart, int across, double *cells)
{
    double longest = 1;
    *cells = 0;
    for (int g = 0; g < rectangles_of(chart); g++) {
        double low[2], side[2];
        int roots[2];
        sides_of(chart, g, low, side);
        longest = fmax(longest, roots_along(side, across, roots));
        *cells += roots[0] * (double)roots[1];
    }
    return longest;
}

int ref_quadtree_across(const RefChart *chart, long wanted)
{
    double least = INFINITY, cells;
    int best = 1;
    for (int across = 1; across <= MOST_ACROSS; across++) {
        double longest = shape_of_roots(chart, across, &cells);
        if (across > 1 && cells * CELLS_OF_ROOT > (double)wanted) break;
        if (!(longest < least - SQUARER)) continue;
        least = longest;
        best = across;
    }
    return best;
}

static void plant(const RefChart *chart, int across, RefQuadtree *tree)
{
    int whole = 1 << REF_QUADTREE_LEVELS;
    *tree = (RefQuadtree){.chart = chart, .grids = rectangles_of(chart)};
    tree->grid = sm_alloc((size_t)tree->grids, sizeof *tree->grid);
    for (int g = 0; g < tree->grids; g++) {
        RefRootGrid *grid = tree->grid + g;
        double side[2];
        sides_of(chart, g, grid->low, side);
        roots_along(side, across, grid->roots);
        for (int d = 0; d < 2; d++) grid->unit[d] = side[d] / grid->roots[d] / whole;
        grid->first = (int)tree->count;
        tree->count += (long)grid->roots[0] * grid->roots[1];
    }
    tree->leaves = tree->room = tree->count;
    tree->cell = sm_alloc((size_t)tree->count, sizeof *tree->cell);
    for (int g = 0; g < tree->grids; g++) {
        const RefRootGrid *grid = tree->grid + g;
        for (int n = 0; n < grid->roots[0] * grid->roots[1]; n++)
            tree->cell[grid->first + n] =
                (RefCell){{n % grid->roots[0] * whole, n / grid->roots[0] * whole}, whole, -1, g};
    }
}

static SmCode check(const RefChart *chart, int across, SmError *error)
{
    double cells = 0, low[2], side[2] = {0};
    for (int n = 0; n < rectangles_of(chart); n++) {
        sides_of(chart, n, low, side);
        if (!(side[0] > 0 && side[1] > 0 && across > 0))
            return sm_fail(error, SM_USAGE,
                           "a chart of %g by %g with %d cells across: give it an area and a cell",
                           side[0], side[1], across);
        cells += across * (double)across * fmax(side[0] / side[1], side[1] / side[0]);
    }
    if (cells < REF_MOST_CELLS) return SM_OK;
    return sm_fail(
        error, SM_INPUT,
        "a chart of %g by %g with %d cells across needs more than %d: give it fewer, or a less "
        "slender surface",
        side[0], side[1], across, REF_MOST_CELLS);
}

SmCode ref_quadtree_build(const RefChart *chart, int across, double threshold, RefQuadtree *tree,
                          SmError *error)
{
    *tree = (RefQuadtree){0};
    SmCode code = check(chart, across, error);
    if (code != SM_OK) return code;
    plant(chart, across, tree);
    if (refine(tree, threshold)) {
        balance(tree, 0);
        return SM_OK;
    }
    ref_quadtree_free(tree);
    return sm_fail(error, SM_INPUT, "the shell needs more than %d cells: give it fewer nodes",
                   REF_MOST_CELLS);
}

/* Its own, and those on rims: in the middle of its sides there, and in the rectangle's corners. */
void ref_quadtree_add_nodes(const RefQuadtree *tree, const RefCell *cell, double eta,
                            RefNodes *nodes)
{
    double middle[2], edge[2];
    ref_quadtree_cell(tree, cell, middle, edge);
    for (int n = 0; n < REF_MOST_CELL_NODES; n++) {
        int place = (n + 4) % REF_MOST_CELL_NODES, step[2] = {place % 3 - 1, place / 3 - 1};
        double *theta = nodes->position[nodes->count];
        bool rim = true;
        for (int d = 0; d < 2; d++) {
            double beyond[2] = {middle[0], middle[1]};
            beyond[d] += 0.5 * step[d] * (edge[d] + tree->grid[cell->grid].unit[d]);
            theta[d] = middle[d] + 0.5 * step[d] * edge[d];
            rim = rim && (step[d] == 0 || !ref_chart_enter(tree->chart, beyond));
        }
        if (rim) nodes->reach[nodes->count++] = eta / 2 * ref_quadtree_edge(tree, cell);
    }
}

/* How many ref_quadtree_nodes() makes. */
static long count_nodes(const RefQuadtree *tree)
{
    long count = 0;
    for (long c = 0; c < tree->count; c++) {
        double position[REF_MOST_CELL_NODES][3], reach[REF_MOST_CELL_NODES];
        RefNodes own = {.position = position, .reach = reach};
        if (tree->cell[c].child < 0) ref_quadtree_add_nodes(tree, tree->cell + c, 1, &own);
        count += own.count;
    }
    return count;
}

/* How many by threshold: infinite where there are too many cells. */
static double nodes_of(const RefChart *chart, int across, double threshold)
{
    RefQuadtree tree;
    if (ref_quadtree_build(chart, across, threshold, &tree, NULL) != SM_OK) return INFINITY;
    double nodes = (double)count_nodes(&tree);
    ref_quadtree_free(&tree);
    return nodes;
}

/* The threshold that makes of such roots as nearly so many nodes as bisection finds, which fall as
 * it grows, by leaps; and by which factor they miss, as its logarithm. A bracket is found from
 * above, where trees are small. */
static double find_threshold(const RefChart *chart, int across, long wanted, double *off)
{
    RefQuadtree tree;
    double high = 0, found = 0;
    plant(chart, across, &tree);
    for (long n = 0; n < tree.count; n++) high = fmax(high, edge_on_surface(&tree, tree.cell + n));
    ref_quadtree_free(&tree);
    double low = high, least = high / (1 << REF_QUADTREE_LEVELS);
    while (low > least && !(nodes_of(chart, across, low) > (double)wanted)) {
        high = low;
        low /= 2;
    }
    *off = INFINITY;
    for (int n = 0; n < 16; n++) {
        double threshold = n == 0 ? high : sqrt(low * high);
        double nodes = nodes_of(chart, across, threshold), far = fabs(log(nodes / (double)wanted));
        if (far < *off) {
            *off = far;
            found = threshold;
        }
        *(nodes > (double)wanted ? &low : &high) = threshold;
    }
    return found;
}

SmCode ref_quadtree_of(const RefChart *chart, int across, long wanted, RefQuadtree *tree,
                       SmError *error)
{
    *tree = (RefQuadtree){0};
    SmCode code = check(chart, across ? across : 1, error);
    if (code != SM_OK) return code;
    int first = across ? across : ref_quadtree_across(chart, wanted), best = first;
    double cells, squarest = shape_of_roots(chart, first, &cells), least;
    double threshold = find_threshold(chart, first, wanted, &least);
    for (int other = first + 1; !across && other <= MOST_ACROSS && least > NEAR; other++) {
        double off, longer = shape_of_roots(chart, other, &cells) / squarest;
        if (longer > LONGER || cells > (double)wanted) continue;
        double found = find_threshold(chart, other, wanted, &off);
        if (!(off < least)) continue;
        threshold = found;
        least = off;
        best = other;
    }
    return ref_quadtree_build(chart, best, threshold, tree, error);
}

void ref_quadtree_nodes(const RefQuadtree *tree, double eta, RefNodes *nodes)
{
    size_t most = REF_MOST_CELL_NODES * (size_t)tree->leaves;
    *nodes = (RefNodes){.plane = true,
                        .seams = tree->chart->seams,
                        .seam = tree->chart->seam,
                        .cylinders = tree->chart->cylinders};
    nodes->position = sm_alloc(most, sizeof *nodes->position);
    nodes->reach = sm_alloc(most, sizeof *nodes->reach);
    for (long c = 0; c < tree->count; c++)
        if (tree->cell[c].child < 0) ref_quadtree_add_nodes(tree, tree->cell + c, eta, nodes);
    ref_nodes_bin(nodes);
}
