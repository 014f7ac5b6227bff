/* test_cracked.h - shells that crack, and what their fields have, for the tests. */
#ifndef REF_TEST_CRACKED_H
#define REF_TEST_CRACKED_H

#include "../map/surface_map.h"
#include "../map/test_surfaces.h"
#include "cracked.h"
#include "projection.h"
#include "test_charts.h"
#include "test_cracks.h"
#include "test_shell.h"

typedef struct {
    Waves waves;       /* of one whose chart is a formula, or */
    RefSurfaceMap map; /* of one that is mapped */
    RefChart chart;
    RefShell shell;
    RefCracked cracked;
} Sheet;

static inline void sheet_of(const RefChart *chart, const RefShellOptions *options,
                            double least_share, Sheet *sheet)
{
    RefCrackedOptions how = {.least_share = least_share, .most_splits = 2};
    shell_of(chart, options, &sheet->shell);
    ref_cracked_create(&sheet->shell, options, &how, &sheet->cracked);
}

/* The chart of a mesh, which is freed: of several cylinders. */
static inline void map_sheet(SmMesh mesh, Sheet *sheet)
{
    SmError error = {0};
    sm_mesh_merge(&mesh);
    if (ref_surface_map_create(&mesh, false, "mesh", &sheet->map, &error) != SM_OK)
        fail_msg("%s", error.text);
    sm_mesh_free(&mesh);
    sheet->chart = sheet->map.chart;
    assert_non_null(sheet->chart.cylinders);
}

static inline void sheet_free(Sheet *sheet)
{
    ref_cracked_free(&sheet->cracked);
    ref_shell_free(&sheet->shell);
    ref_surface_map_free(&sheet->map);
}

/* Half of what cells' edges are on average. */
static inline double half_cell(const Sheet *sheet)
{
    const RefQuadtree *tree = &sheet->shell.tree;
    double area = 0;
    for (int g = 0; g < tree->grids; g++) {
        const RefRootGrid *grid = tree->grid + g;
        area += ldexp(grid->unit[0] * grid->unit[1] * grid->roots[0] * grid->roots[1],
                      2 * REF_QUADTREE_LEVELS);
    }
    return 0.5 * sqrt(area / (double)tree->leaves);
}

/* The number in `other` of every node. */
static inline int *numbers_in(const RefNodes *nodes, const RefNodes *other)
{
    int *number = sm_alloc((size_t)nodes->count, sizeof *number);
    for (long n = 0; n < nodes->count; n++) {
        long m = 0;
        while (m < other->count &&
               memcmp(nodes->position[n], other->position[m], sizeof(double[3])) != 0)
            m++;
        assert_true(m < other->count && nodes->reach[n] == other->reach[m]);
        number[n] = (int)m;
    }
    return number;
}

static inline double *dense_of(const RefSparse *sparse, int width, const int *number)
{
    size_t size = (size_t)sparse->columns;
    double *dense = sm_alloc(size * size, sizeof *dense);
    for (int c = 0; c < sparse->columns; c++)
        for (int e = sparse->start[c]; e < sparse->start[c + 1]; e++) {
            size_t at[2] = {(size_t)c, (size_t)sparse->row[e]};
            for (int k = 0; number && k < 2; k++)
                at[k] = (size_t)(width * number[at[k] / (size_t)width]) + at[k] % (size_t)width;
            dense[at[0] * size + at[1]] = dense[at[1] * size + at[0]] = sparse->value[e];
        }
    return dense;
}

static inline void assert_near(const RefSparse *a, const RefSparse *b, int width, const int *number)
{
    assert_int_equal(a->columns, b->columns);
    size_t all = (size_t)a->columns * (size_t)a->columns;
    double *left = dense_of(a, width, number), *right = dense_of(b, width, NULL);
    double largest = 0, off = 0;
    for (size_t e = 0; e < all; e++) {
        largest = fmax(largest, fabs(right[e]));
        off = fmax(off, fabs(left[e] - right[e]));
    }
    assert_true(off < 1e-9 * largest);
    free(left);
    free(right);
}

/* x . (K + m M) x / 2, or of one of both. */
static inline double energy_of(const RefShell *shell, double stiff, double massive, const double *x)
{
    size_t size = 3 * (size_t)shell->nodes.count;
    double *y = sm_alloc(size, sizeof *y), sum = 0;
    ref_sparse_apply(&shell->matrices.stiffness, 1, x, y);
    for (size_t n = 0; n < size; n++) sum += stiff * x[n] * y[n] / 2;
    ref_sparse_apply(&shell->matrices.mass, 3, x, y);
    for (size_t n = 0; n < size; n++) sum += massive * x[n] * y[n] / 2;
    free(y);
    return sum;
}

static inline void momentum_of(const RefShell *shell, const double *v, double momentum[3])
{
    double *y = sm_alloc(3 * (size_t)shell->nodes.count, sizeof *y);
    ref_sparse_apply(&shell->matrices.mass, 3, v, y);
    memset(momentum, 0, sizeof(double[3]));
    for (long n = 0; n < 3 * shell->nodes.count; n++) momentum[n % 3] += y[n];
    free(y);
}

/* Updates the shell and projects displacements u and velocities v onto its new functions. */
static inline void update(Sheet *sheet, double m, double **u, double **v)
{
    double *field[2] = {*u, *v}, *residual[2] = {NULL, NULL};
    const RefCrackedFields fields = {.count = 2, .field = field, .residual = residual};
    const RefDamping none = {0};
    RefWarp warp;
    RefSteps steps;
    SmError error = {0};
    ref_cracked_update(&sheet->cracked, &fields);
    if (ref_warp_create(&sheet->shell, &warp, &error) != SM_OK ||
        ref_steps_create(&sheet->shell.matrices, &none, sqrt(1 / m), NULL, NULL, &steps, &error) !=
            SM_OK ||
        ref_project_fields(&steps, &warp, residual, field[0], field[1], &error) != SM_OK)
        fail_msg("%s", error.text);
    *u = field[0];
    *v = field[1];
    ref_warp_free(&warp);
    ref_steps_free(&steps);
    sm_free_all(residual[0], residual[1]);
}

/* Waves over the shell's place in rest. */
static inline double *wavy_field(unsigned *seed, const RefShell *shell)
{
    double *field = sm_alloc(3 * (size_t)shell->nodes.count, sizeof *field), wave[3][4];
    for (int d = 0; d < 3; d++)
        for (int k = 0; k < 4; k++) wave[d][k] = random_between(seed, -4, 4);
    for (long n = 0; n < 3 * shell->nodes.count; n++)
        field[n] = sin(sm_dot(wave[n % 3], shell->X[n / 3]) + wave[n % 3][3]);
    return field;
}

#endif
