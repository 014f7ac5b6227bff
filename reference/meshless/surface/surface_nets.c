#include "surface_nets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 8 };

typedef struct {
    const RefField *field;
    double low[3], cell;
    int size[3]; /* grid points a direction */
    float *value;
    int *vertex; /* of the cell above a grid point, or -1 */
} Grid;

static long grid_at(const Grid *grid, int i, int j, int k)
{
    return ((long)k * grid->size[1] + j) * grid->size[0] + i;
}

static void place(const Grid *grid, const double at[3], double x[3])
{
    for (int d = 0; d < 3; d++) x[d] = grid->low[d] + grid->cell * at[d];
}

/* Whether x is more than `slack` outside the field's box, where no body is: one whose points leave
 * a hole may bulge out of it there, and is cut off. */
static bool beyond(const RefField *field, const double x[3], double slack)
{
    for (int d = 0; d < 3; d++)
        if (x[d] < field->low[d] - slack || x[d] > field->high[d] + slack) return true;
    return false;
}

/* A block's values: all alike where its middle is far from the surface. */
static void sample_block(Grid *grid, const int first[3])
{
    double middle[3], x[3], at[3];
    for (int d = 0; d < 3; d++) middle[d] = first[d] + (BLOCK - 1) / 2.0;
    place(grid, middle, x);
    double value = ref_field_at(grid->field, x, NULL);
    bool far = fabs(value) > 1.2 * sqrt(3) / 2 * BLOCK * grid->cell;
    for (int n = 0; n < BLOCK * BLOCK * BLOCK; n++) {
        int i = first[0] + n % BLOCK, j = first[1] + n / BLOCK % BLOCK,
            k = first[2] + n / (BLOCK * BLOCK);
        if (i >= grid->size[0] || j >= grid->size[1] || k >= grid->size[2]) continue;
        at[0] = i, at[1] = j, at[2] = k;
        place(grid, at, x);
        double here = far ? value : ref_field_at(grid->field, x, NULL);
        if (beyond(grid->field, x, grid->cell)) here = fmax(here, grid->cell);
        grid->value[grid_at(grid, i, j, k)] = (float)here;
    }
}

static void sample(Grid *grid)
{
    for (int k = 0; k < grid->size[2]; k += BLOCK)
        for (int j = 0; j < grid->size[1]; j += BLOCK)
            for (int i = 0; i < grid->size[0]; i += BLOCK)
                sample_block(grid, (const int[3]){i, j, k});
}

static bool inside(const Grid *grid, int i, int j, int k)
{
    return grid->value[grid_at(grid, i, j, k)] < 0;
}

/* The cell's vertex: the middle of where its edges cross the surface, moved onto it. False: none.
 */
static bool cell_vertex(const Grid *grid, const int cell[3], double x[3])
{
    double sum[3] = {0}, at[3];
    int crossed = 0;
    for (int edge = 0; edge < 12; edge++) {
        int axis = edge / 4, a[3] = {cell[0], cell[1], cell[2]}, b[3];
        a[(axis + 1) % 3] += edge & 1;
        a[(axis + 2) % 3] += edge >> 1 & 1;
        memcpy(b, a, sizeof b);
        b[axis]++;
        double from = (double)grid->value[grid_at(grid, a[0], a[1], a[2])];
        double to = (double)grid->value[grid_at(grid, b[0], b[1], b[2])];
        if ((from < 0) == (to < 0)) continue;
        crossed++;
        for (int d = 0; d < 3; d++) sum[d] += a[d] + (d == axis ? from / (from - to) : 0);
    }
    if (crossed == 0) return false;
    for (int d = 0; d < 3; d++) at[d] = sum[d] / crossed;
    place(grid, at, x);
    ref_field_project(grid->field, grid->cell, 1e-4 * grid->cell, x);
    return true;
}

/* The square across the edge from grid point a along `axis`: two triangles of its four cells. */
static void square(const Grid *grid, const int a[3], int axis, bool up, SmMesh *mesh)
{
    int corner[4], p = (axis + 1) % 3, q = (axis + 2) % 3;
    for (int n = 0; n < 4; n++) {
        int cell[3] = {a[0], a[1], a[2]};
        cell[p] -= n == 1 || n == 2 ? 0 : 1;
        cell[q] -= n >= 2 ? 0 : 1;
        corner[n] = grid->vertex[grid_at(grid, cell[0], cell[1], cell[2])];
    }
    for (int half = 0; half < 2; half++) {
        int *t = mesh->triangle[mesh->triangle_count++];
        t[0] = corner[0];
        t[1] = corner[up ? 1 + half : 2 + half];
        t[2] = corner[up ? 2 + half : 1 + half];
    }
}

/* Vertices, then squares: the first pass over the grid counts, the second one fills. */
static void weave(Grid *grid, bool fill, SmMesh *mesh)
{
    long vertices = 0, squares = 0;
    for (int k = 0; k + 1 < grid->size[2]; k++)
        for (int j = 0; j + 1 < grid->size[1]; j++)
            for (int i = 0; i + 1 < grid->size[0]; i++) {
                double x[3];
                const int at[3] = {i, j, k};
                if (!fill && cell_vertex(grid, at, x))
                    grid->vertex[grid_at(grid, i, j, k)] = (int)vertices++;
                else if (fill && grid->vertex[grid_at(grid, i, j, k)] >= 0)
                    cell_vertex(grid, at, mesh->position[vertices++]);
                for (int axis = 0; axis < 3; axis++) {
                    bool here = inside(grid, i, j, k);
                    bool there = inside(grid, i + (axis == 0), j + (axis == 1), k + (axis == 2));
                    if (here == there) continue;
                    squares++;
                    if (fill) square(grid, at, axis, here, mesh);
                }
            }
    if (!fill) *mesh = sm_mesh_new(vertices, 2 * squares);
}

SmCode ref_surface_nets(const RefField *field, int cells, SmMesh *mesh, SmError *error)
{
    Grid grid = {.field = field};
    double longest = 0;
    *mesh = (SmMesh){0};
    for (int d = 0; d < 3; d++) longest = fmax(longest, field->high[d] - field->low[d]);
    grid.cell = longest / cells;
    size_t all = 1;
    for (int d = 0; d < 3; d++) { /* two cells to spare all round */
        grid.size[d] = (int)ceil((field->high[d] - field->low[d]) / grid.cell) + 5;
        grid.low[d] = field->low[d] - 2 * grid.cell;
        all *= (size_t)grid.size[d];
    }
    grid.value = sm_alloc(all, sizeof *grid.value);
    grid.vertex = sm_alloc(all, sizeof *grid.vertex);
    memset(grid.vertex, -1, all * sizeof *grid.vertex);
    sample(&grid);
    weave(&grid, false, mesh);
    if (mesh->triangle_count > 0) {
        mesh->triangle_count = 0; /* counted again as they are made */
        weave(&grid, true, mesh);
    }
    free(grid.value);
    free(grid.vertex);
    if (mesh->triangle_count > 0) return SM_OK;
    sm_mesh_free(mesh);
    return sm_fail(error, SM_INPUT, "the points' surface holds nothing to simulate");
}
