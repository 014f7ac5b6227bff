/* test_shell.h - shells over charts that are formulas, held along their sides, for the tests. */
#ifndef REF_TEST_SHELL_H
#define REF_TEST_SHELL_H

#include "../../../lib/pieces.h"
#include "../../../lib/vector.h"
#include "../test_solver.h"
#include "shell.h"

static inline double factor_one(const void *data __attribute__((unused)),
                                const double theta[2] __attribute__((unused)))
{
    return 1;
}

static inline void place_flat(const void *data __attribute__((unused)), const double theta[2],
                              double x[3])
{
    x[0] = theta[0];
    x[1] = theta[1];
    x[2] = 0;
}

/* Over the unit square. */
static inline RefChart square_chart(void)
{
    return (RefChart){.high = {1, 1}, .factor = factor_one, .place = place_flat};
}

/* Around z, of the radius that `data` is; theta1 is the arc from x, theta2 is z. */
static inline void place_round(const void *data, const double theta[2], double x[3])
{
    double R = *(const double *)data;
    x[0] = R * cos(theta[0] / R);
    x[1] = R * sin(theta[0] / R);
    x[2] = theta[1];
}

static inline RefChart cylinder_chart(const double *R, double arc, double length)
{
    return (RefChart){.high = {arc, length}, .factor = factor_one, .place = place_round, .data = R};
}

/* Mercator's map of a sphere: theta1 is the longitude. */
static inline double factor_of_mercator(const void *data, const double theta[2])
{
    return *(const double *)data / cosh(theta[1]);
}

static inline void place_mercator(const void *data, const double theta[2], double x[3])
{
    double R = *(const double *)data;
    x[0] = R * cos(theta[0]) / cosh(theta[1]);
    x[1] = R * sin(theta[0]) / cosh(theta[1]);
    x[2] = R * tanh(theta[1]);
}

static inline void shell_of(const RefChart *chart, const RefShellOptions *options, RefShell *shell)
{
    SmError error = {0};
    if (ref_shell_build(chart, options, shell, &error) != SM_OK) fail_msg("%s", error.text);
}

static inline double bending_of(const RefShellOptions *options)
{
    double t = options->thickness, nu = options->material.poisson;
    return options->material.young * t * t * t / (12 * (1 - nu * nu));
}

/* How a side is held: not at its normal, by rows as on planes of symmetry, or clamped. */
typedef enum { FREE_TO_LEAN, UPRIGHT, CLAMPED } Lean;

/* Appends a row: how far the normal leans along `direction` (of unit length) where functions and
 * frame were taken: -(a3 . u,k) a^k . direction, summed over k. */
static inline void append_lean(RefRows *rows, const RefShape *shape, const RefFrame *frame,
                               const double direction[3])
{
    const double *g = frame->inverse, (*a)[3] = frame->tangent;
    double along[2] = {sm_dot(a[0], direction), sm_dot(a[1], direction)};
    double up[2] = {g[0] * along[0] + g[2] * along[1], g[2] * along[0] + g[1] * along[1]};
    long at = ref_rows_begin(rows, 3 * shape->count);
    for (int n = 0; n < shape->count; n++)
        for (int d = 0; d < 3; d++, at++) {
            rows->column[at] = 3 * shape->node[n] + d;
            rows->value[at] =
                -frame->normal[d] * (shape->gradient[n][0] * up[0] + shape->gradient[n][1] * up[1]);
        }
}

/* Adds a spring along the only row to the stiffness. */
static inline void add_spring(const RefRows *row, double stiffness, const RefSparse *K)
{
    for (long e = row->start[0]; e < row->start[1]; e++)
        for (long f = row->start[0]; f < row->start[1]; f++) {
            int at = K->start[row->column[e]], end = K->start[row->column[e] + 1];
            if (row->column[f] < row->column[e]) continue;
            while (at < end && K->row[at] != row->column[f]) at++;
            assert_true(at < end);
            K->value[at] += stiffness * row->value[e] * row->value[f];
        }
}

/* In the middle of the side (low 1, high 1, low 2, high 2) of every cell there: holds the axes that
 * `axes` is the bits of, and the normal across the side, clamped by springs of 10 D over the cell's
 * width, D the bending stiffness. */
static inline void hold_side(RefShell *shell, const RefShellOptions *options, int side,
                             unsigned axes, Lean lean, RefRows *rows)
{
    RefShape shape = ref_shape_create(&shell->nodes);
    RefFrame frame;
    int axis = side / 2;
    double rim = side % 2 ? shell->chart.high[axis] : shell->chart.low[axis];
    for (long c = 0; c < shell->tree.count; c++) {
        double theta[3] = {0}, edge[2], across[3], *along = frame.tangent[!axis];
        RefRows slope = {0};
        if (shell->tree.cell[c].child >= 0) continue;
        ref_quadtree_cell(&shell->tree, shell->tree.cell + c, theta, edge);
        if (fabs(theta[axis] - rim) > 0.51 * edge[axis]) continue;
        theta[axis] = rim;
        assert_true(ref_shell_at(shell, theta, &shape, &frame));
        for (int d = 0; d < 3; d++)
            if (axes & 1u << d) ref_rows_displacement(rows, &shape, d);
        sm_cross(along, frame.normal, across);
        sm_normalize(across);
        if (lean == UPRIGHT) append_lean(rows, &shape, &frame, across);
        if (lean != CLAMPED) continue;
        double length = edge[!axis] * sqrt(sm_dot(along, along));
        double width = edge[axis] * fabs(sm_dot(frame.tangent[axis], across));
        double stiffness = 10 * bending_of(options) / width * length;
        append_lean(&slope, &shape, &frame, across);
        add_spring(&slope, stiffness, &shell->matrices.stiffness);
        ref_rows_free(&slope);
    }
    ref_shape_free(&shape);
}

/* Adds a force at a point to `load`. */
static inline void push_at(const RefShell *shell, double theta1, double theta2,
                           const double force[3], double *load)
{
    RefShape shape = ref_shape_create(&shell->nodes);
    assert_true(ref_mls_at(&shell->nodes, shell->basis, (double[]){theta1, theta2, 0}, &shape));
    for (int n = 0; n < shape.count; n++)
        for (int d = 0; d < 3; d++) load[3 * shape.node[n] + d] += shape.value[n] * force[d];
    ref_shape_free(&shape);
}

/* Adds a force per area. */
static inline void weigh_down(const RefShell *shell, const RefShellOptions *options,
                              const double force[3], double *load)
{
    size_t nodes = (size_t)shell->nodes.count;
    double *mass = sm_alloc(nodes, sizeof *mass);
    ref_sparse_sums(&shell->matrices.mass, mass);
    for (size_t n = 0; n < nodes; n++)
        for (int d = 0; d < 3; d++)
            load[3 * n + d] +=
                force[d] * mass[n] / (options->material.density * options->thickness);
    free(mass);
}

/* Where the load moves a point, along an axis. */
static inline double moved_by(const RefShell *shell, const RefRows *rows, const double *load,
                              double theta1, double theta2, int axis)
{
    RefShape shape = ref_shape_create(&shell->nodes);
    double *u = sm_alloc(3 * (size_t)shell->nodes.count, sizeof *u);
    RefRows seen = {0};
    RefSolver *solver;
    SmError error = {0};
    if (ref_solver_create(&shell->matrices, 0, rows, &solver, &error) != SM_OK)
        fail_msg("%s", error.text);
    ref_solver_solve(solver, load, NULL, u);
    assert_true(ref_mls_at(&shell->nodes, shell->basis, (double[]){theta1, theta2, 0}, &shape));
    ref_rows_displacement(&seen, &shape, axis);
    double found = ref_rows_apply(&seen, 0, u);
    ref_solver_destroy(solver);
    ref_rows_free(&seen);
    ref_shape_free(&shape);
    free(u);
    return found;
}

/* Nodes by what hangs together, over the pairs of the matrices. */
static inline SmPieces pieces_of(const RefShell *shell)
{
    SmPieces pieces;
    const RefSparse *M = &shell->matrices.mass;
    sm_pieces_init(M->columns, &pieces);
    for (int c = 0; c < M->columns; c++)
        for (int e = M->start[c]; e < M->start[c + 1]; e++) sm_pieces_link(&pieces, c, M->row[e]);
    sm_pieces_finish(&pieces, NULL, M->columns);
    return pieces;
}

#endif
