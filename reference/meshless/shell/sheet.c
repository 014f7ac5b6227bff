#include "sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/engine/boundary.h"
#include "../../../lib/vector.h"
#include "../motion/rotation.h"
#include "../solve/least_squares.h"

#define CONST(array) ((const double(*)[3])(array))

static void release(RefSheet *sheet)
{
    for (int k = 0; k < sheet->holds; k++)
        sm_free_all(sheet->hold[k].x, sheet->hold[k].reach, sheet->hold[k].slope,
                    sheet->hold[k].answer, sheet->hold[k].flux);
    ref_rows_free(&sheet->rows);
    sm_free_all(sheet->hold, sheet->aim);
    sheet->hold = NULL;
    sheet->aim = NULL;
    sheet->holds = 0;
}

void ref_sheet_free(RefSheet *sheet)
{
    release(sheet);
    ref_steps_free(&sheet->steps);
    ref_warp_free(&sheet->warp);
    ref_shell_free(&sheet->shell);
    sm_free_all(sheet->weight, sheet->force, sheet->impulse);
    *sheet = (RefSheet){.holds = 0};
}

static void weigh(RefSheet *sheet)
{
    size_t nodes = (size_t)sheet->shell.nodes.count;
    double *one = sm_alloc(nodes, sizeof *one), *mass = sm_alloc(nodes, sizeof *mass);
    for (size_t n = 0; n < nodes; n++) one[n] = 1;
    ref_sparse_apply(&sheet->shell.matrices.mass, 1, one, mass);
    for (size_t n = 0; n < nodes; n++)
        for (int d = 0; d < 3; d++) sheet->weight[n][d] = mass[n] * sheet->options.gravity[d];
    free(one);
    free(mass);
}

/* Makes room for the nodes' forces, and the weight. */
static void make_forces(RefSheet *sheet)
{
    size_t nodes = (size_t)sheet->shell.nodes.count;
    sm_free_all(sheet->weight, sheet->force, sheet->impulse);
    sheet->weight = sm_alloc(nodes, sizeof *sheet->weight);
    sheet->force = sm_alloc(nodes, sizeof *sheet->force);
    sheet->impulse = sm_alloc(nodes, sizeof *sheet->impulse);
    weigh(sheet);
}

SmCode ref_sheet_create(const RefChart *chart, const RefSheetOptions *options, RefSheet *sheet,
                        SmError *error)
{
    *sheet = (RefSheet){.options = *options};
    SmCode code = ref_shell_build(chart, &options->shell, &sheet->shell, error);
    if (code == SM_OK) code = ref_warp_create(&sheet->shell, &sheet->warp, error);
    if (code == SM_OK)
        code = ref_steps_create(&sheet->shell.matrices, &options->damping, options->h, NULL,
                                &sheet->steps, error);
    if (code != SM_OK) {
        ref_sheet_free(sheet);
        return code;
    }
    make_forces(sheet);
    ref_warp_pull(&sheet->warp, CONST(sheet->weight));
    ref_sheet_pose(sheet);
    return SM_OK;
}

/* ---- holds */

/* A row of the nodes, the parts of shape functions; those of a node that is there twice as one. */
static void add_row(const RefShape *shape, const double *part, size_t stride, RefRows *rows)
{
    long at = ref_rows_begin(rows, shape->count), end = at;
    for (int n = 0; n < shape->count; n++) {
        long same = at;
        while (same < end && rows->column[same] != shape->node[n]) same++;
        if (same == end) rows->value[end++] = 0;
        rows->column[same] = shape->node[n];
        rows->value[same] += part[(size_t)n * stride];
    }
    rows->start[rows->count] = end;
}

/* Which of the terminal cells is at a place. */
static long leaf_at(const RefQuadtree *tree, const double theta[2])
{
    long leaf = 0;
    int cell = ref_quadtree_at(tree, theta);
    for (int c = 0; c < cell; c++) leaf += tree->cell[c].child < 0;
    return leaf;
}

/* The rows of one grip; false where functions do not cover a point. */
static bool take_hold(const RefSheet *sheet, const RefSheetGrip *grip, RefRows *rows,
                      RefSheetHold *hold)
{
    RefShape shape = ref_shape_create(&sheet->shell.nodes);
    bool covered = true;
    *hold = (RefSheetHold){.loose = grip->loose, .points = grip->count, .row = rows->count};
    hold->x = sm_alloc((size_t)grip->count, sizeof *hold->x);
    for (int d = 0; d < 3; d++) hold->pose[d][d] = 1;
    for (int p = grip->count - 1; p >= 0; p--) {
        RefFrame frame;
        covered = covered && ref_shell_at(&sheet->shell, grip->theta[p], &shape, &frame);
        if (!covered) break;
        memcpy(hold->x[p], frame.x, sizeof hold->x[p]);
        memcpy(hold->tangent, frame.tangent, sizeof hold->tangent);
    }
    for (int p = 0; covered && p < grip->count; p++) {
        ref_mls_at(&sheet->shell.nodes, sheet->shell.basis, grip->theta[p], &shape);
        add_row(&shape, shape.value, 1, rows);
    }
    if (covered && !grip->loose) {
        ref_mls_at(&sheet->shell.nodes, sheet->shell.basis, grip->theta[0], &shape);
        for (int k = 0; k < 2; k++) add_row(&shape, &shape.gradient[0][k], 3, rows);
    }
    hold->cell = leaf_at(&sheet->shell.tree, grip->theta[0]);
    ref_shape_free(&shape);
    return covered;
}

static double row_of(const RefRows *rows, long row, const double (*field)[3], int axis)
{
    double sum = 0;
    for (long e = rows->start[row]; e < rows->start[row + 1]; e++)
        sum += rows->value[e] * field[rows->column[e]][axis];
    return sum;
}

/* Appends a row of the nodes, or its difference from another (-1: none), for all three axes. */
static void bind_row(const RefRows *rows, long row, long less, RefRows *bound)
{
    for (int d = 0; d < 3; d++) {
        long ends[2][2] = {{rows->start[row], rows->start[row + 1]}};
        if (less >= 0) memcpy(ends[1], rows->start + less, sizeof ends[1]);
        long at = ref_rows_begin(bound, (int)(ends[0][1] - ends[0][0] + ends[1][1] - ends[1][0]));
        for (int side = 0; side < 2; side++)
            for (long e = ends[side][0]; e < ends[side][1]; e++, at++) {
                bound->column[at] = 3 * rows->column[e] + d;
                bound->value[at] = side ? -rows->value[e] : rows->value[e];
            }
    }
}

/* Rows of the parameters: all of the first hold's, of others the points' but for the first one's
 * displacement, and the slopes. */
static RefRows bind_rows(const RefRows *rows, const RefSheetHold *hold, int holds)
{
    RefRows bound = {0};
    for (int k = 0; rows->start && k < holds; k++) {
        long first = hold[k].row, count = hold[k].points + (hold[k].loose ? 0 : 2);
        for (long r = k == 0 ? 0 : 1; r < count; r++)
            bind_row(rows, first + r, k > 0 && r < hold[k].points ? first : -1, &bound);
    }
    return bound;
}

/* How far a hold's first point and the first hold's move apart by what tangents gain: a solve for
 * each, before anything is held. */
static void find_reaches(RefSheet *sheet, const RefRows *rows, RefSheetHold *hold, int holds)
{
    size_t size = 9 * (size_t)sheet->warp.nodes;
    double *b = sm_alloc((size_t)sheet->warp.nodes, sizeof *b);
    for (int k = 1; rows->start && k < holds; k++) {
        memset(b, 0, (size_t)sheet->warp.nodes * sizeof *b);
        for (long e = rows->start[hold[k].row]; e < rows->start[hold[k].row + 1]; e++)
            b[rows->column[e]] += rows->value[e];
        for (long e = rows->start[0]; e < rows->start[1]; e++) b[rows->column[e]] -= rows->value[e];
        hold[k].reach = sm_alloc((size_t)sheet->warp.nodes, sizeof *hold[k].reach);
        ref_solver_solve(sheet->warp.solver, b, NULL, hold[k].reach);
        hold[k].slope = sm_alloc(size, sizeof *hold[k].slope);
        hold[k].answer = sm_alloc(size, sizeof *hold[k].answer);
        hold[k].flux = sm_alloc(REF_WARP_PLACES * (size_t)sheet->warp.cells, sizeof *hold[k].flux);
        ref_warp_flux(&sheet->warp, hold[k].reach, hold[k].flux);
    }
    free(b);
}

static void displace(const double pose[3][4], const double x[3], double way[3])
{
    double to[3];
    sm_pose_apply(pose, x, to);
    for (int d = 0; d < 3; d++) way[d] = to[d] - x[d];
}

/* All rows' values, of the linear displacements and of the surface's. */
static void set_targets(RefSheet *sheet)
{
    double *aim = sheet->aim;
    for (int k = 0; k < sheet->holds; k++) {
        const RefSheetHold *hold = sheet->hold + k;
        const double(*pose)[4] = (const double(*)[4])hold->pose;
        double(*target)[3] = sheet->warp.target + hold->row;
        for (int p = 0; p < hold->points; p++) {
            double way[3], turn[3];
            for (int d = 0; d < 3; d++) way[d] = hold->x[p][d] - hold->x[0][d];
            sm_cross(hold->turn, way, turn);
            displace(pose, hold->x[p], target[p]);
            for (int d = 0; d < 3 && (k == 0 || p > 0); d++)
                *aim++ = turn[d] + (k == 0 ? target[0][d] : 0);
        }
        for (int a = 0; !hold->loose && a < 2; a++) {
            sm_cross(hold->turn, hold->tangent[a], aim);
            for (int d = 0; d < 3; d++)
                target[hold->points + a][d] =
                    sm_dot(pose[d], hold->tangent[a]) - hold->tangent[a][d];
            aim += 3;
        }
    }
}

/* Where what is held is at present becomes where it is held. The constant that u may be more by
 * makes u what moves at the first hold, or of a free piece on average. */
static void start_holds(RefSheet *sheet)
{
    double(*u)[3] = (double(*)[3])sheet->steps.u, shift[3] = {0};
    const RefWarp *warp = &sheet->warp;
    ref_warp_anchor(&sheet->warp, u);
    for (int d = 0; d < 3 && sheet->holds; d++)
        shift[d] =
            row_of(&warp->rows, 0, CONST(warp->moved), d) - row_of(&warp->rows, 0, CONST(u), d);
    for (long n = 0; n < warp->nodes; n++)
        for (int d = 0; d < 3 && warp->held[warp->piece[n]]; d++) u[n][d] += shift[d];
    for (int k = 0; k < sheet->holds; k++) {
        RefSheetHold *hold = sheet->hold + k;
        double R[9];
        ref_warp_turn(warp, hold->cell, CONST(u), hold->turn);
        ref_rotation(hold->turn, R);
        for (int d = 0; d < 3; d++) {
            memcpy(hold->pose[d], R + 3 * d, 3 * sizeof *R);
            hold->pose[d][3] = hold->x[0][d] - sm_dot(R + 3 * d, hold->x[0]) +
                               row_of(&warp->rows, hold->row, CONST(warp->moved), d);
        }
    }
}

/* Steps under other rows, from the same state. */
static SmCode change_steps(RefSheet *sheet, const RefRows *rows, SmError *error)
{
    RefSteps steps;
    SmCode code = ref_steps_create(&sheet->shell.matrices, &sheet->options.damping,
                                   sheet->options.h, rows, &steps, error);
    if (code != SM_OK) return code;
    size_t size = 3 * (size_t)sheet->shell.nodes.count * sizeof(double);
    memcpy(steps.u, sheet->steps.u, size);
    memcpy(steps.v, sheet->steps.v, size);
    ref_steps_free(&sheet->steps);
    sheet->steps = steps;
    return SM_OK;
}

SmCode ref_sheet_hold(RefSheet *sheet, int grips, const RefSheetGrip *grip, SmError *error)
{
    RefRows rows = {0};
    bool covered = true;
    RefSheetHold *hold = sm_alloc((size_t)grips, sizeof *hold);
    int holds = 0;
    release(sheet);
    SmCode code = ref_warp_hold(&sheet->warp, &rows, error);
    while (covered && holds < grips) {
        covered = take_hold(sheet, grip + holds, &rows, hold + holds);
        holds++;
    }
    if (code == SM_OK && !covered)
        code =
            sm_fail(error, SM_INPUT, "a handle holds a point that the shell's nodes do not cover");
    if (code == SM_OK) find_reaches(sheet, &rows, hold, holds);
    if (code == SM_OK) {
        sheet->rows = bind_rows(&rows, hold, holds);
        code = change_steps(sheet, &sheet->rows, error);
    }
    if (code == SM_OK && holds) code = ref_warp_hold(&sheet->warp, &rows, error);
    sheet->hold = hold;
    sheet->holds = holds;
    sheet->aim = sm_alloc((size_t)sheet->rows.count, sizeof *sheet->aim);
    if (code != SM_OK)
        release(sheet);
    else {
        start_holds(sheet);
        ref_warp_pull(&sheet->warp, CONST(sheet->weight));
        ref_sheet_pose(sheet);
    }
    ref_rows_free(&rows);
    return code;
}

SmCode ref_sheet_renew(RefSheet *sheet, const double *u, const double *v, const double *moved,
                       SmError *error)
{
    size_t size = 3 * (size_t)sheet->shell.nodes.count * sizeof(double);
    RefWarp warp;
    RefSteps steps;
    SmCode code = ref_warp_create(&sheet->shell, &warp, error);
    if (code != SM_OK) return code;
    code = ref_steps_create(&sheet->shell.matrices, &sheet->options.damping, sheet->options.h, NULL,
                            &steps, error);
    if (code != SM_OK) {
        ref_warp_free(&warp);
        return code;
    }
    release(sheet);
    ref_warp_free(&sheet->warp);
    ref_steps_free(&sheet->steps);
    sheet->warp = warp;
    sheet->steps = steps;
    memcpy(sheet->warp.moved, moved, size);
    memcpy(sheet->steps.u, u, size);
    memcpy(sheet->steps.v, v, size);
    make_forces(sheet);
    return SM_OK;
}

void ref_sheet_settle(RefSheet *sheet)
{
    start_holds(sheet);
    ref_warp_pull(&sheet->warp, CONST(sheet->weight));
    ref_sheet_pose(sheet);
}

void ref_sheet_aim(RefSheet *sheet, int k, const double pose[3][4])
{
    RefSheetHold *hold = sheet->hold + k;
    double R[9];
    memcpy(hold->pose, pose, sizeof hold->pose);
    for (int n = 0; n < 9; n++) R[n] = pose[n / 3][n % 3];
    if (!hold->loose) ref_rotation_vector(R, hold->turn, hold->turn);
}

/* ---- steps */

/* The slopes of one coordinate of the places that are held, and the answers. */
static void find_slopes(RefSheet *sheet, int axis)
{
    size_t from = 3 * (size_t)sheet->warp.nodes * (size_t)axis;
    for (int k = 1; k < sheet->holds; k++) {
        const RefSheetHold *hold = sheet->hold + k;
        ref_warp_slope(&sheet->warp, (const double(*)[2])hold->flux, axis,
                       (double(*)[3])(hold->slope + from));
        ref_solver_solve(sheet->steps.solver, hold->slope + from, NULL, hold->answer + from);
    }
}

void ref_sheet_pose(RefSheet *sheet)
{
    set_targets(sheet);
    ref_warp_pose(&sheet->warp, CONST(sheet->steps.u));
    for (int axis = 0; axis < 3; axis++) find_slopes(sheet, axis);
}

/* By how much the holds beyond the first are to move, less what these speeds make them. */
static void find_gaps(const RefSheet *sheet, double *gap)
{
    const RefWarp *warp = &sheet->warp;
    size_t size = 3 * (size_t)warp->nodes;
    for (int k = 1; k < sheet->holds; k++)
        for (size_t d = 0; d < 3; d++, gap++) {
            const RefSheetHold *hold = sheet->hold + k;
            *gap = warp->target[hold->row][d] - warp->target[0][d];
            for (long n = 0; n < warp->nodes; n++) *gap -= hold->reach[n] * warp->right[n][d];
            for (size_t n = 0; n < size; n++)
                *gap -= hold->slope[d * size + n] * sheet->steps.h * sheet->steps.v[n];
        }
}

/* Moves by the forces that close the gaps. A trace of regularisation makes holds harmless that
 * contradict each other. */
static void close_gaps(RefSheet *sheet)
{
    size_t size = 3 * (size_t)sheet->warp.nodes, count = 3 * ((size_t)sheet->holds - 1);
    double *S = sm_alloc(count * count, sizeof *S), *gap = sm_alloc(count, sizeof *gap), trace = 0;
    find_gaps(sheet, gap);
    for (size_t c = 0; c < count; c++) {
        const RefSheetHold *hold = sheet->hold + 1 + c / 3;
        const double *answer = hold->answer + c % 3 * size;
        for (size_t r = 0; r < count; r++) {
            const double *slope = sheet->hold[1 + r / 3].slope + r % 3 * size;
            for (size_t n = 0; n < size; n++) S[r * count + c] += slope[n] * answer[n];
        }
        trace += S[c * count + c];
    }
    for (size_t c = 0; c < count; c++) S[c * count + c] += 1e-12 * trace;
    ref_least_squares_solve((int)count, 0, S, gap);
    for (size_t c = 0; c < count; c++) {
        const double *answer = sheet->hold[1 + c / 3].answer + c % 3 * size;
        for (size_t n = 0; n < size; n++) {
            sheet->steps.u[n] += gap[c] * answer[n];
            sheet->steps.v[n] += gap[c] * answer[n] / sheet->steps.h;
        }
    }
    free(S);
    free(gap);
}

static void take_pushes(RefSheet *sheet)
{
    for (long n = 0; n < sheet->warp.nodes; n++)
        for (int d = 0; d < 3; d++)
            sheet->force[n][d] = sheet->weight[n][d] + sheet->impulse[n][d] / sheet->options.h;
    ref_warp_pull(&sheet->warp, CONST(sheet->force));
    ref_warp_pose(&sheet->warp, CONST(sheet->steps.u));
    memset(sheet->impulse, 0, (size_t)sheet->warp.nodes * sizeof *sheet->impulse);
}

void ref_sheet_step(RefSheet *sheet)
{
    RefSteps *steps = &sheet->steps;
    const RefWarp *warp = &sheet->warp;
    if (sheet->pushed) take_pushes(sheet);
    set_targets(sheet);
    for (long r = 0; r < sheet->rows.count; r++)
        steps->speed[r] = (sheet->aim[r] - ref_rows_apply(&sheet->rows, r, steps->u)) / steps->h;
    memcpy(steps->force, warp->pulled, (size_t)warp->nodes * sizeof *warp->pulled);
    ref_steps_go(steps);
    if (sheet->holds > 1) close_gaps(sheet);
    if (sheet->pushed) ref_warp_pull(&sheet->warp, CONST(sheet->weight));
    sheet->pushed = false;
    ref_warp_pose(&sheet->warp, CONST(steps->u));
    find_slopes(sheet, sheet->axis);
    sheet->axis = (sheet->axis + 1) % 3;
}

void ref_sheet_off(const RefSheet *sheet, int k, double *place, double *turn)
{
    const RefWarp *warp = &sheet->warp;
    const RefSheetHold *hold = sheet->hold + k;
    *place = *turn = 0;
    for (int p = 0; p < hold->points; p++) {
        double way[3];
        displace((const double(*)[4])hold->pose, hold->x[p], way);
        for (int d = 0; d < 3; d++)
            *place = fmax(*place,
                          fabs(way[d] - row_of(&warp->rows, hold->row + p, CONST(warp->moved), d)));
    }
    for (int a = 0; !hold->loose && a < 2; a++)
        for (int d = 0; d < 3; d++) {
            double wanted = sm_dot(hold->pose[d], hold->tangent[a]) - hold->tangent[a][d];
            double is = row_of(&warp->rows, hold->row + hold->points + a, CONST(warp->moved), d);
            *turn =
                fmax(*turn, fabs(is - wanted) / sqrt(sm_dot(hold->tangent[a], hold->tangent[a])));
        }
}
