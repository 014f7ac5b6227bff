#include "sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/engine/boundary.h"
#include "../../../lib/vector.h"
#include "../motion/rotation.h"
#include "../solve/least_squares.h"
#include "projection.h"

#define CONST(array) ((const double(*)[3])(array))

static void forget_holds(RefSheet *sheet)
{
    sheet->hold = NULL;
    sheet->follower = NULL;
    sheet->aim = sheet->slope = sheet->answer = sheet->gap = sheet->need = sheet->yield = NULL;
    sheet->judged = NULL;
    sheet->tug = NULL;
    sheet->rows = (RefRows){0};
    sheet->holds = sheet->followers = 0;
}

static void release(RefSheet *sheet)
{
    for (int k = 0; k < sheet->holds; k++)
        sm_free_all(sheet->hold[k].x, sheet->hold[k].reach, sheet->hold[k].flux);
    ref_rows_free(&sheet->rows);
    sm_free_all(sheet->hold, sheet->follower, sheet->aim, sheet->slope, sheet->answer, sheet->gap,
                sheet->need, sheet->judged, sheet->yield, sheet->tug);
    forget_holds(sheet);
}

void ref_sheet_free(RefSheet *sheet)
{
    release(sheet);
    ref_tension_free(&sheet->tension);
    ref_steps_free(&sheet->steps);
    ref_warp_free(&sheet->warp);
    ref_shell_free(&sheet->shell);
    sm_free_all(sheet->weight, sheet->force, sheet->impulse);
    *sheet = (RefSheet){.holds = 0};
}

static void weigh(RefSheet *sheet)
{
    size_t nodes = (size_t)sheet->shell.nodes.count;
    double *mass = sm_alloc(nodes, sizeof *mass);
    ref_sparse_sums(&sheet->shell.matrices.mass, mass);
    for (size_t n = 0; n < nodes; n++)
        for (int d = 0; d < 3; d++) sheet->weight[n][d] = mass[n] * sheet->options.gravity[d];
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

/* Adds to the tugs of other forces what holds need. */
static void pull_holds(RefSheet *sheet)
{
    const RefWarp *warp = &sheet->warp;
    size_t places = REF_WARP_PLACES * (size_t)warp->cells;
    if (sheet->followers) memcpy(warp->tug, sheet->tug, places * sizeof *sheet->tug);
    for (int c = 0; c < 3 * sheet->followers; c++) {
        const double(*flux)[2] = (const double(*)[2])sheet->hold[sheet->follower[c / 3]].flux;
        for (size_t at = 0; at < places; at++)
            for (int k = 0; k < 2; k++) warp->tug[at][k][c % 3] += sheet->need[c] * flux[at][k];
    }
}

/* From the next pose on these forces act, and what holds need. */
static void pull(RefSheet *sheet, const double (*force)[3])
{
    size_t places = REF_WARP_PLACES * (size_t)sheet->warp.cells;
    ref_warp_pull(&sheet->warp, force);
    if (sheet->followers) memcpy(sheet->tug, sheet->warp.tug, places * sizeof *sheet->tug);
    pull_holds(sheet);
    sheet->changed = true;
}

SmCode ref_sheet_create(const RefChart *chart, const RefSheetOptions *options, RefSheet *sheet,
                        SmError *error)
{
    *sheet = (RefSheet){.options = *options};
    SmCode code = ref_shell_build(chart, &options->shell, &sheet->shell, error);
    if (code == SM_OK) code = ref_warp_create(&sheet->shell, &sheet->warp, error);
    if (code == SM_OK)
        code = ref_steps_create(&sheet->shell.matrices, &options->damping, options->h, NULL, NULL,
                                &sheet->steps, error);
    if (code != SM_OK) {
        ref_sheet_free(sheet);
        return code;
    }
    make_forces(sheet);
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
        ref_shell_shape(&sheet->shell, grip->theta[p], &shape);
        add_row(&shape, shape.value, 1, rows);
    }
    if (covered && !grip->loose) {
        ref_shell_shape(&sheet->shell, grip->theta[0], &shape);
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

static int piece_at(const RefWarp *warp, const RefRows *rows, long row)
{
    return warp->piece[rows->column[rows->start[row]]];
}

/* Which holds lead, and room for what follows them. */
static void find_leads(RefSheet *sheet, const RefRows *rows)
{
    sheet->follower = sm_alloc((size_t)sheet->holds, sizeof *sheet->follower);
    for (int k = 0; rows->start && k < sheet->holds; k++) {
        int lead = 0, piece = piece_at(&sheet->warp, rows, sheet->hold[k].row);
        while (piece_at(&sheet->warp, rows, sheet->hold[lead].row) != piece) lead++;
        sheet->hold[k].lead = lead;
        if (lead < k) sheet->follower[sheet->followers++] = k;
    }
    size_t count = 3 * (size_t)sheet->followers, size = 3 * (size_t)sheet->warp.nodes;
    sheet->slope = sm_alloc(count * size, sizeof *sheet->slope);
    sheet->answer = sm_alloc(count * size, sizeof *sheet->answer);
    sheet->gap = sm_alloc(count, sizeof *sheet->gap);
    sheet->need = sm_alloc(count, sizeof *sheet->need);
    sheet->judged = sm_alloc(count, sizeof *sheet->judged);
    sheet->yield = sm_alloc(count * count, sizeof *sheet->yield);
    sheet->tug = sm_alloc(REF_WARP_PLACES * (size_t)sheet->warp.cells, sizeof *sheet->tug);
}

/* Rows of the parameters: all of a leading hold's, of others the points' but for the first one's
 * displacement, and the slopes. */
static RefRows bind_rows(const RefRows *rows, const RefSheetHold *hold, int holds)
{
    RefRows bound = {0};
    for (int k = 0; rows->start && k < holds; k++) {
        long first = hold[k].row, count = hold[k].points + (hold[k].loose ? 0 : 2);
        bool leads = hold[k].lead == k;
        for (long r = leads ? 0 : 1; r < count; r++)
            bind_row(rows, first + r, !leads && r < hold[k].points ? first : -1, &bound);
    }
    return bound;
}

/* How far a hold's first point and its leader's move apart by what tangents gain: a solve for each
 * of the surface that nothing holds. */
static SmCode find_reaches(RefSheet *sheet, const RefRows *rows, SmError *error)
{
    size_t nodes = (size_t)sheet->warp.nodes;
    RefSolver *solver;
    if (sheet->followers == 0) return SM_OK;
    SmCode code = ref_warp_solver(&sheet->warp, &(RefRows){0}, &solver, error);
    if (code != SM_OK) return code;
    double *b = sm_alloc(nodes, sizeof *b);
    for (int f = 0; f < sheet->followers; f++) {
        RefSheetHold *hold = sheet->hold + sheet->follower[f];
        long row = hold->row, lead = sheet->hold[hold->lead].row;
        memset(b, 0, nodes * sizeof *b);
        for (long e = rows->start[row]; e < rows->start[row + 1]; e++)
            b[rows->column[e]] += rows->value[e];
        for (long e = rows->start[lead]; e < rows->start[lead + 1]; e++)
            b[rows->column[e]] -= rows->value[e];
        hold->reach = sm_alloc(nodes, sizeof *hold->reach);
        ref_solver_solve(solver, b, NULL, hold->reach);
        hold->flux = sm_alloc(REF_WARP_PLACES * (size_t)sheet->warp.cells, sizeof *hold->flux);
        ref_warp_flux(&sheet->warp, hold->reach, hold->flux);
    }
    ref_solver_destroy(solver);
    free(b);
    return SM_OK;
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
        bool leads = hold->lead == k;
        for (int p = 0; p < hold->points; p++) {
            double way[3], turn[3];
            for (int d = 0; d < 3; d++) way[d] = hold->x[p][d] - hold->x[0][d];
            sm_cross(hold->turn, way, turn);
            displace(pose, hold->x[p], target[p]);
            for (int d = 0; d < 3 && (leads || p > 0); d++)
                *aim++ = turn[d] + (leads ? target[0][d] : 0);
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

/* The constants that u may be more by make u what moves at a piece's first hold, or of a free piece
 * on average. */
static void shift_pieces(RefSheet *sheet, double (*u)[3])
{
    const RefWarp *warp = &sheet->warp;
    double(*shift)[3] = warp->all;
    ref_warp_match(&sheet->warp, CONST(warp->moved), u);
    memset(shift, 0, (size_t)warp->pieces * sizeof *shift);
    for (int k = sheet->holds - 1; k >= 0; k--) {
        const RefSheetHold *hold = sheet->hold + k;
        long lead = sheet->hold[hold->lead].row;
        for (int p = hold->points - 1; p >= 0; p--)
            for (int d = 0; d < 3; d++)
                shift[piece_at(warp, &warp->rows, hold->row + p)][d] =
                    row_of(&warp->rows, lead, CONST(warp->moved), d) -
                    row_of(&warp->rows, lead, CONST(u), d);
    }
    for (long n = 0; n < warp->nodes; n++)
        for (int d = 0; d < 3; d++) u[n][d] += shift[warp->piece[n]][d];
}

/* Where what is held is at present becomes where it is held. */
static void start_holds(RefSheet *sheet)
{
    double(*u)[3] = (double(*)[3])sheet->steps.u;
    const RefWarp *warp = &sheet->warp;
    shift_pieces(sheet, u);
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

/* All grips' holds and rows. */
static SmCode take_holds(RefSheet *sheet, int grips, const RefSheetGrip *grip, RefRows *rows,
                         SmError *error)
{
    sheet->hold = sm_alloc((size_t)grips, sizeof *sheet->hold);
    while (sheet->holds < grips) {
        int k = sheet->holds++;
        if (!take_hold(sheet, grip + k, rows, sheet->hold + k))
            return sm_fail(error, SM_INPUT,
                           "a handle holds a point that the shell's nodes do not cover");
    }
    find_leads(sheet, rows);
    return SM_OK;
}

/* Steps under other rows, from the same state. */
static SmCode change_steps(const RefSheet *sheet, const RefRows *rows, RefSteps *steps,
                           SmError *error)
{
    SmCode code = ref_steps_create(&sheet->shell.matrices, &sheet->options.damping,
                                   sheet->options.h, rows, NULL, steps, error);
    if (code != SM_OK) return code;
    size_t size = 3 * (size_t)sheet->shell.nodes.count * sizeof(double);
    memcpy(steps->u, sheet->steps.u, size);
    memcpy(steps->v, sheet->steps.v, size);
    return SM_OK;
}

SmCode ref_sheet_hold(RefSheet *sheet, int grips, const RefSheetGrip *grip, SmError *error)
{
    RefSheet next = *sheet;
    RefRows rows = {0};
    RefSteps steps = {.solver = NULL};
    forget_holds(&next);
    SmCode code = take_holds(&next, grips, grip, &rows, error);
    if (code == SM_OK) code = find_reaches(&next, &rows, error);
    if (code == SM_OK) {
        next.rows = bind_rows(&rows, next.hold, next.holds);
        next.aim = sm_alloc((size_t)next.rows.count, sizeof *next.aim);
        code = change_steps(sheet, &next.rows, &steps, error);
    }
    if (code == SM_OK) code = ref_warp_hold(&next.warp, &rows, error);
    ref_rows_free(&rows);
    if (code != SM_OK) {
        ref_steps_free(&steps);
        release(&next);
        return code;
    }
    release(sheet);
    ref_steps_free(&sheet->steps);
    next.steps = steps;
    *sheet = next;
    ref_sheet_anchor(sheet);
    return SM_OK;
}

SmCode ref_sheet_renew(RefSheet *sheet, double *u, double *v, const double *moved,
                       double *const residual[2], SmError *error)
{
    size_t size = 3 * (size_t)sheet->shell.nodes.count * sizeof(double);
    RefWarp warp;
    RefSteps steps = {.solver = NULL};
    SmCode code = ref_warp_create(&sheet->shell, &warp, error);
    if (code != SM_OK) return code;
    code = ref_steps_create(&sheet->shell.matrices, &sheet->options.damping, sheet->options.h, NULL,
                            warp.solver, &steps, error);
    if (code == SM_OK) code = ref_project_fields(&steps, &warp, residual, u, v, error);
    if (code != SM_OK) {
        ref_steps_free(&steps);
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

void ref_sheet_anchor(RefSheet *sheet)
{
    start_holds(sheet);
    ref_tension_drop(&sheet->tension, &sheet->steps);
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
    size_t size = 3 * (size_t)sheet->warp.nodes, from = (size_t)(axis * sheet->followers) * size;
    if (sheet->followers == 0) return;
    for (int f = 0; f < sheet->followers; f++)
        ref_warp_slope(&sheet->warp, (const double(*)[2])sheet->hold[sheet->follower[f]].flux, axis,
                       (double(*)[3])(sheet->slope + from + (size_t)f * size));
    ref_solver_solve_several(ref_steps_solver(&sheet->steps), sheet->followers, sheet->slope + from,
                             NULL, sheet->answer + from);
}

static void find_all_slopes(RefSheet *sheet)
{
    for (int axis = 0; axis < 3; axis++) find_slopes(sheet, axis);
}

/* Where slopes and answers of coordinate number c of all followers' begin. */
static size_t of_coordinate(const RefSheet *sheet, size_t c)
{
    return (c % 3 * (size_t)sheet->followers + c / 3) * 3 * (size_t)sheet->warp.nodes;
}

void ref_sheet_pose(RefSheet *sheet)
{
    for (int c = 0; c < 3 * sheet->followers; c++) sheet->need[c] = 0;
    sheet->next = 0;
    pull(sheet, CONST(sheet->weight));
    set_targets(sheet);
    ref_warp_pose(&sheet->warp, CONST(sheet->steps.u));
    find_all_slopes(sheet);
}

/* By how much the holds that others lead are to move, less what these speeds make them. */
static void find_gaps(RefSheet *sheet)
{
    const RefWarp *warp = &sheet->warp;
    size_t size = 3 * (size_t)warp->nodes;
    for (size_t c = 0; c < 3 * (size_t)sheet->followers; c++) {
        const RefSheetHold *hold = sheet->hold + sheet->follower[c / 3];
        const double *slope = sheet->slope + of_coordinate(sheet, c);
        double *gap = sheet->gap + c;
        size_t d = c % 3;
        *gap = warp->target[hold->row][d] - warp->target[sheet->hold[hold->lead].row][d];
        for (long n = 0; n < warp->nodes; n++) *gap -= hold->reach[n] * warp->right[n][d];
        for (size_t n = 0; n < size; n++) *gap -= slope[n] * sheet->steps.h * sheet->steps.v[n];
    }
}

/* The forces, by h / (b + h), whose answers the holds see as these, which they replace. A trace of
 * regularisation makes holds harmless that contradict each other. */
static void find_forces(RefSheet *sheet, double *seen)
{
    size_t size = 3 * (size_t)sheet->warp.nodes, count = 3 * (size_t)sheet->followers;
    double *S = sheet->yield, trace = 0;
    for (size_t c = 0; c < count; c++) {
        const double *answer = sheet->answer + of_coordinate(sheet, c);
        for (size_t r = 0; r < count; r++) {
            const double *slope = sheet->slope + of_coordinate(sheet, r);
            S[r * count + c] = 0;
            for (size_t n = 0; n < size; n++) S[r * count + c] += slope[n] * answer[n];
        }
        trace += S[c * count + c];
    }
    for (size_t c = 0; c < count; c++) S[c * count + c] += 1e-12 * trace;
    ref_least_squares_solve((int)count, 0, S, seen);
}

/* Moves by the forces that close the gaps, which holds need beside what they did. */
static void close_gaps(RefSheet *sheet)
{
    RefSteps *steps = &sheet->steps;
    size_t size = 3 * (size_t)sheet->warp.nodes, count = 3 * (size_t)sheet->followers;
    double *gap = sheet->gap;
    find_gaps(sheet);
    find_forces(sheet, gap);
    for (size_t c = 0; c < count; c++) {
        const double *answer = sheet->answer + of_coordinate(sheet, c);
        sheet->need[c] += (1 + steps->damping.stiffness_damping / steps->h) * gap[c];
        for (size_t n = 0; n < size; n++) {
            steps->u[n] += gap[c] * answer[n];
            steps->v[n] += gap[c] * answer[n] / steps->h;
        }
    }
}

/* What holds needed against h G v is no tension: it ends with the step. */
static void forget_drag(RefSheet *sheet)
{
    RefSteps *steps = &sheet->steps;
    size_t size = 3 * (size_t)sheet->warp.nodes, count = 3 * (size_t)sheet->followers;
    double *drag = steps->other, *seen = sheet->gap;
    ref_sparse_apply(&steps->tension, 3, steps->v, drag);
    for (size_t c = 0; c < count; c++) {
        const double *answer = sheet->answer + of_coordinate(sheet, c);
        seen[c] = 0;
        for (size_t n = 0; n < size; n++) seen[c] += steps->h * answer[n] * drag[n];
    }
    find_forces(sheet, seen);
    for (size_t c = 0; c < count; c++) sheet->need[c] -= seen[c];
}

static void take_pushes(RefSheet *sheet)
{
    for (long n = 0; n < sheet->warp.nodes; n++)
        for (int d = 0; d < 3; d++)
            sheet->force[n][d] = sheet->weight[n][d] + sheet->impulse[n][d] / sheet->options.h;
    pull(sheet, CONST(sheet->force));
    ref_warp_pose(&sheet->warp, CONST(sheet->steps.u));
    memset(sheet->impulse, 0, (size_t)sheet->warp.nodes * sizeof *sheet->impulse);
}

/* Tension is found where forces are no longer, by a quarter, those that it was found for. */
static void bear_tension(RefSheet *sheet)
{
    size_t count = 3 * (size_t)sheet->followers;
    double off = 0, all = 0;
    for (size_t c = 0; c < count; c++) {
        off += fabs(sheet->need[c] - sheet->judged[c]);
        all += fabs(sheet->judged[c]);
    }
    if (sheet->changed || off > all / 4) {
        ref_tension_find(&sheet->tension, &sheet->warp, &sheet->options.shell, &sheet->steps,
                         sheet->pushed);
        if (count) memcpy(sheet->judged, sheet->need, count * sizeof *sheet->judged);
        sheet->changed = false;
    }
    if (ref_tension_bear(&sheet->tension, &sheet->warp, &sheet->steps)) find_all_slopes(sheet);
}

void ref_sheet_step(RefSheet *sheet)
{
    RefSteps *steps = &sheet->steps;
    const RefWarp *warp = &sheet->warp;
    if (sheet->pushed) take_pushes(sheet);
    bear_tension(sheet);
    set_targets(sheet);
    for (long r = 0; r < sheet->rows.count; r++)
        steps->speed[r] = (sheet->aim[r] - ref_rows_apply(&sheet->rows, r, steps->u)) / steps->h;
    memcpy(steps->force, warp->pulled, (size_t)warp->nodes * sizeof *warp->pulled);
    ref_steps_go(steps);
    if (sheet->followers) close_gaps(sheet);
    if (sheet->followers && steps->taut) forget_drag(sheet);
    if (sheet->pushed)
        pull(sheet, CONST(sheet->weight));
    else
        pull_holds(sheet);
    sheet->pushed = false;
    ref_warp_pose(&sheet->warp, CONST(steps->u));
    find_slopes(sheet, sheet->next);
    sheet->next = (sheet->next + 1) % 3;
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
