#include "warp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/csr.h"
#include "../../../lib/vector.h"
#include "../motion/rotation.h"

/* A place that functions leave less of its area by this share is none. */
static const double LEAST_AREA = 0.4;
/* How stiffly nodes of a cracked shell are tied to where u has them, beside the Laplacian, whose
 * diagonal is of the order of 1, but 0 where no place bears. */
static const double TIE = 1e-9;
enum { PLACES = REF_WARP_PLACES, LANES = REF_FRAME_SLOPES };

static void release(RefWarp *warp)
{
    ref_solver_destroy(warp->solver);
    ref_rows_free(&warp->rows);
    free(warp->target);
    free(warp->bound);
    warp->solver = NULL;
    warp->target = NULL;
    warp->bound = NULL;
}

void ref_warp_free(RefWarp *warp)
{
    release(warp);
    ref_matrices_free(&warp->laplacian);
    sm_free_all(warp->turn, warp->tug, warp->sum, warp->start, warp->node, warp->slope, warp->place,
                warp->near, warp->other, warp->lean, warp->X, warp->rest_normal, warp->tilt,
                warp->mass, warp->moved, warp->turned, warp->pulled, warp->right, warp->answer,
                warp->drawn, warp->column[0], warp->column[1], warp->piece, warp->held, warp->all);
    *warp = (RefWarp){.nodes = 0};
}

/* ---- at rest */

static void note_place(const RefFrame *frame, double area, RefWarpPlace *place)
{
    const double *g = frame->inverse, (*a)[3] = frame->tangent;
    memcpy(place->tangent, frame->tangent, sizeof place->tangent);
    memcpy(place->normal, frame->normal, sizeof place->normal);
    for (int k = 0; k < 2; k++) {
        double up[3];
        for (int d = 0; d < 3; d++) up[d] = g[2] * a[!k][d] + g[k] * a[k][d];
        sm_cross(frame->normal, up, place->across[k]);
    }
    place->area = area * frame->area;
    for (int m = 0; m < 3; m++) place->metric[m] = place->area * g[m];
}

/* The middles of a cell's quarters, where the shell was integrated, too: covers reach them. */
void ref_warp_place_at(const double middle[2], const double edge[2], int p, double theta[3])
{
    for (int d = 0; d < 2; d++) theta[d] = middle[d] + ((p >> d & 1) - 0.5) * edge[d] / 2;
    theta[2] = 0;
}

/* The functions at a place of a cell: the next one's slopes are `stride` numbers on. */
typedef struct {
    int count, stride;
    const int *node;
    const double *slope;
    RefFrame frame;
} Functions;

/* Those of place number p, or none: between cracks they may not leave the surface its area. */
static Functions functions_at(const RefShell *shell, long c, int p, RefShape *shape)
{
    const RefShellFunctions *kept = &shell->functions;
    Functions found = {.count = 0};
    if (kept->cell) {
        const RefSamples *samples = kept->cell(kept->kept, c);
        const int n = ref_samples_quarter(p);
        const long start = samples->start[n];
        const RefFrame *frame = samples->frame + n;
        if (frame->area > LEAST_AREA * samples->area[n] / samples->weight[n])
            found = (Functions){(int)(samples->start[n + 1] - start), 6, samples->node + start,
                                samples->part[start] + 1, *frame};
    } else {
        double middle[2], edge[2], theta[3];
        ref_quadtree_cell(&shell->tree, shell->tree.cell + c, middle, edge);
        ref_warp_place_at(middle, edge, p, theta);
        if (ref_shell_at(shell, theta, shape, &found.frame)) {
            found.count = shape->count;
            found.stride = 3;
            found.node = shape->node;
            found.slope = shape->gradient[0];
        }
    }
    return found;
}

/* The nodes of a cell's places, rising; `number` is -1 of all before and their place afterwards. */
static void list_nodes(const Functions at[PLACES], int *number, long *room, RefWarp *warp)
{
    const long from = warp->start[warp->cells];
    long end = from;
    for (int p = 0; p < PLACES; p++) {
        sm_make_room(warp->node, room[0], end + at[p].count);
        for (int n = 0; n < at[p].count; n++) {
            int node = at[p].node[n];
            if (number[node] < 0) warp->node[end++] = node;
            number[node] = 0;
        }
    }
    sm_sort_ints(warp->node + from, (int)(end - from));
    for (long e = from; e < end; e++) number[warp->node[e]] = (int)(e - from);
    sm_make_room(warp->slope, room[1], end);
    memset(warp->slope + from, 0, (size_t)(end - from) * sizeof *warp->slope);
    warp->start[warp->cells + 1] = end;
}

static void add_slopes(const Functions *at, int place, const int *number, RefWarp *warp)
{
    double(*to)[LANES] = warp->slope + warp->start[warp->cells];
    const double *slope = at->slope;
    for (int n = 0; n < at->count; n++, slope += at->stride)
        for (int k = 0; k < 2; k++) to[number[at->node[n]]][2 * place + k] += slope[k];
}

static void make_cells(const RefShell *shell, RefWarp *warp)
{
    RefShape shape[PLACES];
    int *number = sm_alloc((size_t)warp->nodes, sizeof *number);
    long room[2] = {0};
    for (int p = 0; p < PLACES; p++) shape[p] = ref_shape_create(&shell->nodes);
    size_t cells = (size_t)shell->tree.leaves;
    warp->start = sm_alloc(cells + 1, sizeof *warp->start);
    warp->place = sm_alloc(PLACES * cells, sizeof *warp->place);
    warp->turn = sm_alloc(PLACES * cells, sizeof *warp->turn);
    warp->tug = sm_alloc(PLACES * cells, sizeof *warp->tug);
    for (long n = 0; n < warp->nodes; n++) number[n] = -1;
    for (long c = 0; c < shell->tree.count; c++) {
        const RefShellFunctions *kept = &shell->functions;
        double middle[2], edge[2];
        if (kept->cell && c + 1 < shell->tree.count)
            ref_samples_fetch_quarters(kept->cell(kept->kept, c + 1));
        if (shell->tree.cell[c].child >= 0) continue;
        ref_quadtree_cell(&shell->tree, shell->tree.cell + c, middle, edge);
        Functions at[PLACES];
        for (int p = 0; p < PLACES; p++) at[p] = functions_at(shell, c, p, shape + p);
        list_nodes(at, number, room, warp);
        for (int p = 0; p < PLACES; p++) {
            if (at[p].count == 0) continue;
            note_place(&at[p].frame, edge[0] * edge[1] / PLACES,
                       warp->place + PLACES * warp->cells + p);
            add_slopes(at + p, p, number, warp);
        }
        for (long e = warp->start[warp->cells]; e < warp->start[warp->cells + 1]; e++)
            number[warp->node[e]] = -1;
        warp->cells++;
    }
    for (int p = 0; p < PLACES; p++) ref_shape_free(shape + p);
    free(number);
}

/* The surface's normal and a frame of right angles about it. */
static void frame_of(const double a[2][3], double frame[3][3])
{
    memcpy(frame[0], a[0], sizeof frame[0]);
    sm_cross(a[0], a[1], frame[2]);
    sm_normalize(frame[0]);
    sm_normalize(frame[2]);
    sm_cross(frame[2], frame[0], frame[1]);
}

/* That of a node is the one that it had without cracks, as this frame carries it; where there was
 * none, or is none now, it is the frame's. */
static void note_normal(const RefShell *shell, long n, const RefFrame *frame, RefWarp *warp)
{
    const double *up = shell->up ? shell->up[n] : frame->normal;
    double about[3][3];
    if (!(frame->area > 0) || !(sm_dot(up, up) > 0)) up = frame->normal;
    frame_of(frame->tangent, about);
    memcpy(warp->rest_normal[n], up, sizeof *warp->rest_normal);
    for (int k = 0; k < 3; k++) warp->tilt[n][k] = sm_dot(up, about[k]);
}

/* Normals at nodes; where functions are not defined there, at the middle of a quarter of the cell.
 */
static void make_normals(const RefShell *shell, RefWarp *warp)
{
    RefShape shape = ref_shape_create(&shell->nodes);
    long room = 0, lean_room = 0;
    for (long n = 0; n < warp->nodes; n++) {
        double theta[3], middle[2], edge[2];
        RefFrame frame;
        memcpy(theta, shell->nodes.position[n], sizeof theta);
        if (!ref_shell_at(shell, theta, &shape, &frame)) {
            int cell = ref_quadtree_at(&shell->tree, theta);
            ref_quadtree_cell(&shell->tree, shell->tree.cell + cell, middle, edge);
            ref_warp_place_at(middle, edge, (theta[0] > middle[0]) + 2 * (theta[1] > middle[1]),
                              theta);
            if (!ref_shell_at(shell, theta, &shape, &frame)) frame = (RefFrame){.area = 0};
        }
        long end = warp->near[n] + shape.count;
        sm_make_room(warp->other, room, end);
        sm_make_room(warp->lean, lean_room, end);
        for (int k = 0; k < shape.count; k++) {
            warp->other[warp->near[n] + k] = shape.node[k];
            memcpy(warp->lean[warp->near[n] + k], shape.gradient[k], sizeof *warp->lean);
        }
        warp->near[n + 1] = end;
        note_normal(shell, n, &frame, warp);
    }
    ref_shape_free(&shape);
}

/* Rows of a cell's functions whose squares are share g^kl phi_I,k phi_J,l summed over its places,
 * by the metric's root. */
static void root_rows(const RefWarp *warp, const double *share, long c, int columns, double *row)
{
    memset(row, 0, LANES * (size_t)columns * sizeof *row);
    for (int p = 0; p < PLACES; p++) {
        const double *q = warp->place[PLACES * c + p].metric;
        if (!(q[0] > 0)) continue; /* no place */
        double times = share ? sqrt(share[PLACES * c + p]) : 1;
        double first = sqrt(q[0]), beside = q[2] / first;
        double second = times * sqrt(fmax(q[1] - beside * beside, 0));
        for (long e = warp->start[c]; e < warp->start[c + 1]; e++) {
            const double *slope = warp->slope[e] + 2 * p;
            double *to = row + 2 * p * columns + (e - warp->start[c]);
            to[0] = times * (first * slope[0] + beside * slope[1]);
            to[columns] = second * slope[1];
        }
    }
}

void ref_warp_laplacian(const RefWarp *warp, const RefSparse *M, const double *share, RefSparse *L)
{
    size_t nodes = (size_t)warp->nodes, entries = (size_t)M->start[nodes];
    int *at = sm_alloc(nodes, sizeof *at); /* of a column's rows in L */
    long most = 0;
    *L = (RefSparse){.columns = M->columns,
                     .start = sm_copy(M->start, nodes + 1, sizeof *L->start),
                     .row = sm_copy(M->row, entries, sizeof *L->row),
                     .value = sm_alloc(entries, sizeof *L->value)};
    for (long c = 0; c < warp->cells; c++)
        if (warp->start[c + 1] - warp->start[c] > most) most = warp->start[c + 1] - warp->start[c];
    most = ref_frame_columns((int)most);
    double *row = sm_alloc(LANES * (size_t)most, sizeof *row);
    double *square = sm_alloc((size_t)(most * most), sizeof *square);
    for (long c = 0; c < warp->cells; c++) {
        int count = (int)(warp->start[c + 1] - warp->start[c]), columns = ref_frame_columns(count);
        const int *node = warp->node + warp->start[c];
        root_rows(warp, share, c, columns, row);
        ref_frame_sums.square(LANES, columns, row, square);
        for (int a = 0; a < count; a++) {
            int i = node[a];
            for (int k = L->start[i]; k < L->start[i + 1]; k++) at[L->row[k]] = k;
            for (int b = a; b < count; b++) {
                int k = at[node[b]];
                bool pair = k >= L->start[i] && k < L->start[i + 1] && L->row[k] == node[b];
                if (pair) L->value[k] += square[a * columns + b];
            }
        }
    }
    sm_free_all(at, row, square);
}

/* What hangs together, by the mass of pairs, and the nodes' shares of it. */
static void share_mass(const RefShell *shell, RefWarp *warp)
{
    const RefSparse *M = &shell->matrices.mass;
    SmPieces pieces;
    sm_pieces_init(warp->nodes, &pieces);
    for (int c = 0; c < M->columns; c++)
        for (int e = M->start[c]; e < M->start[c + 1]; e++) sm_pieces_link(&pieces, c, M->row[e]);
    sm_pieces_finish(&pieces, NULL, warp->nodes);
    warp->pieces = pieces.count;
    warp->piece = sm_alloc((size_t)warp->nodes, sizeof *warp->piece);
    memcpy(warp->piece, pieces.piece, (size_t)warp->nodes * sizeof *warp->piece);
    warp->held = sm_alloc((size_t)warp->pieces, sizeof *warp->held);
    warp->all = sm_alloc((size_t)warp->pieces, sizeof *warp->all);
    sm_pieces_free(&pieces);
    double *sum = sm_alloc((size_t)warp->pieces, sizeof *sum);
    ref_sparse_sums(M, warp->mass);
    for (long n = 0; n < warp->nodes; n++) sum[warp->piece[n]] += warp->mass[n];
    for (long n = 0; n < warp->nodes; n++) warp->mass[n] /= sum[warp->piece[n]];
    free(sum);
}

/* Pieces of a cracked shell would each be free to move, and between cracks a few nodes may hang on
 * the others by next to no slope. */
static void tie(RefWarp *warp)
{
    const RefSparse *L = &warp->laplacian.stiffness;
    for (long n = 0; n < warp->nodes; n++) L->value[L->start[n]] += TIE;
}

SmCode ref_warp_create(const RefShell *shell, RefWarp *warp, SmError *error)
{
    size_t nodes = (size_t)shell->nodes.count;
    *warp = (RefWarp){.nodes = shell->nodes.count};
    double(**field[])[3] = {&warp->X,     &warp->rest_normal, &warp->tilt,
                            &warp->moved, &warp->turned,      &warp->pulled,
                            &warp->right, &warp->answer,      &warp->drawn};
    for (size_t f = 0; f < sizeof field / sizeof *field; f++)
        *field[f] = sm_alloc(nodes, sizeof **field[f]);
    memcpy(warp->X, shell->X, nodes * sizeof *warp->X);
    warp->near = sm_alloc(nodes + 1, sizeof *warp->near);
    warp->mass = sm_alloc(nodes, sizeof *warp->mass);
    for (int k = 0; k < 2; k++) warp->column[k] = sm_alloc(3 * nodes, sizeof(double));
    warp->sum = sm_alloc(nodes, sizeof *warp->sum);
    make_cells(shell, warp);
    make_normals(shell, warp);
    ref_warp_laplacian(warp, &shell->matrices.mass, NULL, &warp->laplacian.stiffness);
    share_mass(shell, warp);
    warp->cut = shell->nodes.cut.pass;
    if (warp->cut) tie(warp);
    SmCode code = ref_warp_hold(warp, &(RefRows){0}, error);
    if (code != SM_OK) ref_warp_free(warp);
    return code;
}

SmCode ref_warp_solver(const RefWarp *warp, const RefRows *rows, RefSolver **solver, SmError *error)
{
    RefRows pin = {0};
    if (rows->count == 0 &&
        !warp->cut) { /* any constant may be added: the first node's parameter stays */
        long at = ref_rows_begin(&pin, 1);
        pin.column[at] = 0;
        pin.value[at] = 1;
    }
    SmCode code = ref_solver_create(&warp->laplacian, 0, pin.count ? &pin : rows, solver, error);
    ref_rows_free(&pin);
    return code;
}

SmCode ref_warp_hold(RefWarp *warp, const RefRows *rows, SmError *error)
{
    RefSolver *solver;
    SmCode code = ref_warp_solver(warp, rows, &solver, error);
    if (code != SM_OK) return code;
    release(warp);
    warp->solver = solver;
    warp->rows = ref_rows_copy(rows);
    warp->target = sm_alloc((size_t)rows->count, sizeof *warp->target);
    warp->bound = sm_alloc(3 * (size_t)rows->count, sizeof *warp->bound);
    for (long p = 0; p < warp->pieces; p++) warp->held[p] = false;
    for (long e = 0; rows->count && e < rows->start[rows->count]; e++)
        warp->held[warp->piece[rows->column[e]]] = true;
    return SM_OK;
}

/* ---- moved */

/* The solution that is nearest to what the right sides ask for, under the rows. */
static void solve(RefWarp *warp, const double (*right)[3], const double (*target)[3],
                  double (*left)[3])
{
    double *b = warp->column[0], *x = warp->column[1], *bound = warp->bound;
    long nodes = warp->nodes, rows = target ? warp->rows.count : 0;
    for (int d = 0; d < 3; d++) {
        for (long n = 0; n < nodes; n++) b[d * nodes + n] = right[n][d];
        for (long r = 0; r < rows; r++) bound[d * rows + r] = target[r][d];
    }
    ref_solver_solve_several(warp->solver, 3, b, rows ? bound : NULL, x);
    for (int d = 0; d < 3; d++)
        for (long n = 0; n < nodes; n++) left[n][d] = x[d * nodes + n];
}

/* The turn of a place, from the slopes of u there. */
static void turn_at(const RefWarpPlace *place, const double slope[2][3], double w[3])
{
    double spin = 0;
    memset(w, 0, 3 * sizeof *w);
    for (int k = 0; k < 2; k++) {
        double lean = sm_dot(place->normal, slope[k]);
        spin += sm_dot(slope[k], place->across[k]) / 2;
        for (int d = 0; d < 3; d++) w[d] -= lean * place->across[k][d];
    }
    for (int d = 0; d < 3; d++) w[d] += spin * place->normal[d];
}

static void slopes_at(const double sum[3][LANES], int p, double slope[2][3])
{
    for (int k = 0; k < 2; k++)
        for (int d = 0; d < 3; d++) slope[k][d] = sum[d][2 * p + k];
}

/* area g^kl times two vectors. */
static void lift(const double q[3], const double vector[2][3], double raised[2][3])
{
    for (int k = 0; k < 2; k++)
        for (int d = 0; d < 3; d++) raised[k][d] = q[k] * vector[k][d] + q[2] * vector[!k][d];
}

void ref_warp_pull(RefWarp *warp, const double (*force)[3])
{
    double(*all)[3] = warp->all;
    memset(all, 0, (size_t)warp->pieces * sizeof *all);
    for (long n = 0; n < warp->nodes; n++)
        for (int d = 0; d < 3; d++) all[warp->piece[n]][d] += force[n][d];
    for (long n = 0; n < warp->nodes; n++)
        for (int d = 0; d < 3; d++) {
            int p = warp->piece[n];
            warp->drawn[n][d] = warp->held[p] ? 0 : warp->mass[n] * all[p][d];
            warp->right[n][d] = force[n][d] - warp->drawn[n][d];
        }
    solve(warp, (const double(*)[3])warp->right, NULL, warp->answer);
    for (long c = 0; c < warp->cells; c++) {
        double sum[3][LANES], slope[2][3];
        ref_frame_sums.slopes((int)(warp->start[c + 1] - warp->start[c]),
                              warp->node + warp->start[c],
                              (const double(*)[LANES])(warp->slope + warp->start[c]),
                              (const double(*)[3])warp->answer, sum);
        for (int p = 0; p < PLACES; p++) {
            slopes_at((const double(*)[LANES])sum, p, slope);
            lift(warp->place[PLACES * c + p].metric, (const double(*)[3])slope,
                 warp->tug[PLACES * c + p]);
        }
    }
}

/* What the forces' work, sum f^k . tangent_k, is by the slopes of u. */
static void work_slope(const RefWarpPlace *place, const RefWarpTurn *turn, const double f[2][3],
                       double slope[2][3])
{
    const double *R = turn->R;
    double moment[3] = {0}, mean[3], back[2][3];
    for (int k = 0; k < 2; k++) {
        double about[3];
        for (int d = 0; d < 3; d++)
            back[k][d] = R[d] * f[k][0] + R[3 + d] * f[k][1] + R[6 + d] * f[k][2];
        sm_cross(turn->tangent[k], back[k], about);
        for (int d = 0; d < 3; d++) moment[d] += about[d];
    }
    ref_rotation_mean(turn->w, moment, mean); /* d exp(w) = exp(w) [Rt^T dw]x */
    for (int k = 0; k < 2; k++) {
        double about[3];
        sm_cross(place->tangent[k], back[k], about);
        for (int d = 0; d < 3; d++) mean[d] -= about[d];
    }
    double spin = sm_dot(place->normal, mean) / 2;
    for (int k = 0; k < 2; k++) {
        double lean = sm_dot(place->across[k], mean);
        for (int d = 0; d < 3; d++)
            slope[k][d] = back[k][d] - lean * place->normal[d] + spin * place->across[k][d];
    }
}

/* One place: how it turns, and what its tangents gain. */
static void turn_place(const RefWarpPlace *place, const double slope[2][3], RefWarpTurn *turn,
                       double gain[2][3])
{
    turn_at(place, slope, turn->w);
    ref_rotation(turn->w, turn->R);
    for (int k = 0; k < 2; k++) {
        const double *a = place->tangent[k], *R = turn->R;
        double *s = turn->tangent[k], about[3];
        sm_cross(turn->w, a, about);
        for (int d = 0; d < 3; d++) s[d] = a[d] + slope[k][d] - about[d];
        for (int d = 0; d < 3; d++)
            gain[k][d] = R[3 * d] * s[0] + R[3 * d + 1] * s[1] + R[3 * d + 2] * s[2] - a[d];
    }
}

/* Lanes of what is spread: three of the right side, and three of forces from the fourth on. */
enum { FORCE = 4 };

static void pose_cell(RefWarp *warp, long c, const double (*u)[3])
{
    int count = (int)(warp->start[c + 1] - warp->start[c]);
    const int *node = warp->node + warp->start[c];
    const double(*slope)[LANES] = (const double(*)[LANES])(warp->slope + warp->start[c]);
    double sum[3][LANES], spread[LANES][LANES] = {{0}};
    ref_frame_sums.slopes(count, node, slope, u, sum);
    for (int p = 0; p < PLACES; p++) {
        const RefWarpPlace *place = warp->place + PLACES * c + p;
        RefWarpTurn *turn = warp->turn + PLACES * c + p;
        double at[2][3], gain[2][3], raised[2][3], force[2][3];
        slopes_at((const double(*)[LANES])sum, p, at);
        turn_place(place, (const double(*)[3])at, turn, gain);
        lift(place->metric, (const double(*)[3])gain, raised);
        work_slope(place, turn, (const double(*)[3])warp->tug[PLACES * c + p], force);
        for (int k = 0; k < 2; k++)
            for (int d = 0; d < 3; d++) {
                spread[2 * p + k][d] = raised[k][d];
                spread[2 * p + k][FORCE + d] = force[k][d];
            }
    }
    ref_frame_sums.spread(count, node, slope, (const double(*)[LANES])spread, warp->sum);
}

void ref_warp_flux(const RefWarp *warp, const double *reach, double (*flux)[2])
{
    double(*field)[3] = sm_alloc((size_t)warp->nodes, sizeof *field), sum[3][LANES];
    for (long n = 0; n < warp->nodes; n++) field[n][0] = reach[n];
    for (long c = 0; c < warp->cells; c++) {
        ref_frame_sums.slopes(
            (int)(warp->start[c + 1] - warp->start[c]), warp->node + warp->start[c],
            (const double(*)[LANES])(warp->slope + warp->start[c]), (const double(*)[3])field, sum);
        for (int p = 0; p < PLACES; p++) {
            const double *q = warp->place[PLACES * c + p].metric, *slope = sum[0] + 2 * p;
            for (int k = 0; k < 2; k++)
                flux[PLACES * c + p][k] = q[k] * slope[k] + q[2] * slope[!k];
        }
    }
    free(field);
}

void ref_warp_slope(RefWarp *warp, const double (*flux)[2], int axis, double (*force)[3])
{
    memset(warp->sum, 0, (size_t)warp->nodes * sizeof *warp->sum);
    for (long c = 0; c < warp->cells; c++) {
        double spread[LANES][LANES] = {{0}};
        for (int p = 0; p < PLACES; p++) {
            long at = PLACES * c + p;
            double f[2][3] = {{0}}, slope[2][3];
            for (int k = 0; k < 2; k++) f[k][axis] = flux[at][k];
            work_slope(warp->place + at, warp->turn + at, (const double(*)[3])f, slope);
            for (int k = 0; k < 2; k++) memcpy(spread[2 * p + k], slope[k], sizeof slope[k]);
        }
        ref_frame_sums.spread((int)(warp->start[c + 1] - warp->start[c]),
                              warp->node + warp->start[c],
                              (const double(*)[LANES])(warp->slope + warp->start[c]),
                              (const double(*)[LANES])spread, warp->sum);
    }
    for (long n = 0; n < warp->nodes; n++) memcpy(force[n], warp->sum[n], sizeof *force);
}

/* What a normal has become by the surface's slopes there, less the one at rest. */
static void turn_normal(RefWarp *warp, long n)
{
    const double *tilt = warp->tilt[n];
    double a[2][3] = {{0}}, frame[3][3];
    for (long e = warp->near[n]; e < warp->near[n + 1]; e++) {
        const double *x = warp->X[warp->other[e]], *moved = warp->moved[warp->other[e]];
        for (int k = 0; k < 2; k++)
            for (int d = 0; d < 3; d++) a[k][d] += warp->lean[e][k] * (x[d] + moved[d]);
    }
    frame_of((const double(*)[3])a, frame);
    for (int d = 0; d < 3; d++)
        warp->turned[n][d] = tilt[0] * frame[0][d] + tilt[1] * frame[1][d] + tilt[2] * frame[2][d] -
                             warp->rest_normal[n][d];
}

void ref_warp_match(RefWarp *warp, const double (*model)[3], double (*field)[3])
{
    double(*shift)[3] = warp->all;
    memset(shift, 0, (size_t)warp->pieces * sizeof *shift);
    for (long n = 0; n < warp->nodes; n++)
        for (int d = 0; d < 3 && !warp->held[warp->piece[n]]; d++)
            shift[warp->piece[n]][d] += warp->mass[n] * (model[n][d] - field[n][d]);
    for (long n = 0; n < warp->nodes; n++)
        for (int d = 0; d < 3; d++) field[n][d] += shift[warp->piece[n]][d];
}

void ref_warp_pose(RefWarp *warp, const double (*u)[3])
{
    double tied = warp->cut ? TIE : 0;
    memset(warp->sum, 0, (size_t)warp->nodes * sizeof *warp->sum);
    for (long c = 0; c < warp->cells; c++) pose_cell(warp, c, u);
    for (long n = 0; n < warp->nodes; n++)
        for (int d = 0; d < 3; d++) {
            warp->right[n][d] = warp->sum[n][d] + tied * u[n][d];
            warp->pulled[n][d] =
                warp->drawn[n][d] + warp->sum[n][FORCE + d] + tied * warp->answer[n][d];
        }
    solve(warp, (const double(*)[3])warp->right, (const double(*)[3])warp->target, warp->moved);
    ref_warp_match(warp, u, warp->moved);
    for (long n = 0; n < warp->nodes; n++) turn_normal(warp, n);
}

void ref_warp_turn(const RefWarp *warp, long cell, const double (*u)[3], double w[3])
{
    double sum[3][LANES];
    memset(w, 0, 3 * sizeof *w);
    ref_frame_sums.slopes((int)(warp->start[cell + 1] - warp->start[cell]),
                          warp->node + warp->start[cell],
                          (const double(*)[LANES])(warp->slope + warp->start[cell]), u, sum);
    for (int p = 0; p < PLACES; p++) {
        double at[2][3], turn[3];
        slopes_at((const double(*)[LANES])sum, p, at);
        turn_at(warp->place + PLACES * cell + p, (const double(*)[3])at, turn);
        for (int d = 0; d < 3; d++) w[d] += turn[d] / PLACES;
    }
}
