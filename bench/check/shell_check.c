#include "shell_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/box.h"
#include "../../lib/vector.h"
#include "../../reference/meshless/body/gauss_rule.h"
#include "../../reference/meshless/shell/foot.h"
#include "../../reference/meshless/solve/least_squares.h"
#include "../play/runner.h"

enum { SAMPLES = 2000, FREE_STEPS = 64, ORDER = 3, PARTS = 2 };

#define CONST(array) ((const double(*)[3])(array))

static double largest(long count, const double *vector)
{
    double most = 0;
    for (long n = 0; n < count; n++) most = fmax(most, fabs(vector[n]));
    return most;
}

static double size_of(const RefShellBody *body)
{
    SmBox box = sm_box_around(body->sheet.warp.nodes, CONST(body->sheet.warp.X));
    return sm_box_longest(&box);
}

/* ---- the body */

/* Functions and slopes sum up to 1 and 0 at points spread over the surface, and there are enough
 * but where cracks leave a point none. */
static void check_shapes(const RefShellBody *body, BenchElasticFound *found)
{
    const RefShell *shell = &body->sheet.shell;
    RefShape shape = ref_shape_create(&shell->nodes);
    for (long k = 0; k < SAMPLES; k++) {
        long p = k * body->map.vertices / SAMPLES;
        const double theta[3] = {body->map.theta[p][0], body->map.theta[p][1]};
        double sum[3] = {-1}, middle[2], edge[2];
        ref_quadtree_cell(&shell->tree, shell->tree.cell + ref_quadtree_at(&shell->tree, theta),
                          middle, edge);
        bool covered = ref_shell_shape(shell, theta, &shape);
        if (!covered && body->breaking) continue;
        for (int n = 0; n < shape.count; n++) {
            sum[0] += shape.value[n];
            for (int d = 0; d < 2; d++) sum[1 + d] += shape.gradient[n][d] * edge[d];
        }
        bench_elastic_note(found, BENCH_ELASTIC_UNITY, covered ? fabs(sum[0]) : NAN);
        for (int d = 0; d < 2; d++)
            bench_elastic_note(found, BENCH_ELASTIC_SLOPE, fabs(sum[1 + d]));
    }
    ref_shape_free(&shape);
}

/* The middle surface's area, by Gauss's rule in the quarters of cells. */
static double area_of(const RefShell *shell)
{
    double at[ORDER], weight[ORDER], area = 0;
    RefShape shape = ref_shape_create(&shell->nodes);
    ref_gauss_rule(ORDER, at, weight);
    for (long c = 0; c < shell->tree.count; c++) {
        double middle[2], edge[2];
        if (shell->tree.cell[c].child >= 0) continue;
        ref_quadtree_cell(&shell->tree, shell->tree.cell + c, middle, edge);
        for (int n = 0; n < PARTS * PARTS * ORDER * ORDER; n++) {
            double theta[3] = {0}, share = edge[0] * edge[1] / (PARTS * PARTS);
            for (int d = 0, rest = n; d < 2; d++, rest /= PARTS * ORDER) {
                int part = rest % PARTS, point = rest / PARTS % ORDER;
                theta[d] = middle[d] + edge[d] * ((part + 0.5 + at[point]) / PARTS - 0.5);
                share *= weight[point];
            }
            RefFrame frame;
            if (ref_shell_at(shell, theta, &shape, &frame)) area += share * frame.area;
        }
    }
    ref_shape_free(&shape);
    return area;
}

static void check_mass(const RefShellBody *body, BenchElasticFound *found)
{
    const RefShellOptions *options = &body->sheet.options.shell;
    const RefSparse *M = &body->sheet.shell.matrices.mass;
    double mass = 0, wanted = options->material.density * options->thickness;
    for (int c = 0; c < M->columns; c++)
        for (int e = M->start[c]; e < M->start[c + 1]; e++)
            mass += (M->row[e] == c ? 1 : 2) * M->value[e];
    bench_elastic_note(found, BENCH_ELASTIC_MASS,
                       fabs(mass / (wanted * area_of(&body->sheet.shell)) - 1));
}

/* Forces of six rigid motions by those of their parameters' absolute values; not on nodes that
 * nothing sees, which are tied. */
static void check_rigid(const RefShellBody *body, BenchElasticFound *found)
{
    const RefSparse *K = &body->sheet.shell.matrices.stiffness;
    RefSparse absolute = *K;
    size_t size = (size_t)K->columns, entries = (size_t)K->start[size];
    double *u = sm_alloc(size, sizeof *u), *f = sm_alloc(size, sizeof *f),
           *scale = sm_alloc(size, sizeof *scale);
    absolute.value = sm_alloc(entries, sizeof *absolute.value);
    for (size_t e = 0; e < entries; e++) absolute.value[e] = fabs(K->value[e]);
    for (int kind = 0; kind < 6; kind++) {
        double axis[3] = {kind % 3 == 0, kind % 3 == 1, kind % 3 == 2};
        for (size_t n = 0; n < size / 3; n++)
            if (kind < 3)
                memcpy(u + 3 * n, axis, sizeof axis);
            else
                sm_cross(axis, body->sheet.warp.X[n], u + 3 * n);
        ref_sparse_apply(K, 1, u, f);
        for (size_t n = 0; n < size; n++) u[n] = fabs(u[n]);
        ref_sparse_apply(&absolute, 1, u, scale);
        double least = 1e-6 * largest((long)size, scale);
        for (size_t n = 0; n < size; n++)
            if (!body->breaking || ref_cracked_seen(&body->breaking->cracked, (long)n / 3))
                bench_elastic_note(found, BENCH_ELASTIC_RIGID, fabs(f[n]) / fmax(scale[n], least));
    }
    sm_free_all(u, f, scale, absolute.value);
}

/* Small displacements are the surface's own: of a warp that nothing holds. */
static void check_pose(const RefShellBody *body, BenchElasticFound *found)
{
    RefWarp warp;
    bool made = ref_warp_create(&body->sheet.shell, &warp, NULL) == SM_OK;
    double small = 1e-9 * size_of(body), off = 0;
    for (long n = 0; made && n < warp.nodes; n++)
        for (int d = 0; d < 3; d++)
            warp.turned[n][d] = small * sin(3 * (double)d + 9 * sm_dot(warp.X[n], warp.X[n]) /
                                                                pow(size_of(body), 2));
    double(*u)[3] = sm_alloc((size_t)body->sheet.warp.nodes, sizeof *u);
    if (made) memcpy(u, warp.turned, (size_t)warp.nodes * sizeof *u);
    if (made) ref_warp_pose(&warp, CONST(u));
    for (long n = 0; made && n < warp.nodes; n++)
        for (int d = 0; d < 3; d++) off = fmax(off, fabs(warp.moved[n][d] - u[n][d]) / small);
    bench_elastic_note(found, BENCH_ELASTIC_POSE, made ? off : NAN);
    ref_warp_free(&warp);
    free(u);
}

void bench_shell_check_body(const RefShellBody *body, BenchElasticFound *found)
{
    check_shapes(body, found);
    check_mass(body, found);
    check_rigid(body, found);
    check_pose(body, found);
}

/* ---- a state of motion */

/* What M dv - h (F - C v - K u) is after a step, and how large its terms are. */
static double *residual_of(const RefSheet *sheet, const double *before, const double *force,
                           double *scale)
{
    const RefSteps *steps = &sheet->steps;
    const RefMatrices *matrices = &sheet->shell.matrices;
    size_t size = 3 * (size_t)sheet->warp.nodes;
    double a = steps->damping.mass_damping, b = steps->damping.stiffness_damping, h = steps->h;
    double *r = sm_alloc(size, sizeof *r), *x = sm_alloc(size, sizeof *x);
    double *y = sm_alloc(size, sizeof *y);
    for (size_t n = 0; n < size; n++) x[n] = steps->v[n] - before[size + n] + h * a * steps->v[n];
    ref_sparse_apply(&matrices->mass, 3, x, r);
    for (size_t n = 0; n < size; n++) x[n] = h * (steps->u[n] + b * steps->v[n]);
    ref_sparse_apply(&matrices->stiffness, 1, x, y);
    *scale = largest((long)size, r) + largest((long)size, y) + h * largest((long)size, force);
    for (size_t n = 0; n < size; n++) r[n] += y[n] - h * force[n];
    free(x);
    free(y);
    return r;
}

/* The residual where no row of a hold acts, less what forces along the slopes of others explain. */
static void check_step(const RefSheet *sheet, const double *before, const double *force,
                       const double *slope, BenchElasticFound *found)
{
    size_t size = 3 * (size_t)sheet->warp.nodes;
    int terms = 3 * sheet->followers;
    double scale, *r = residual_of(sheet, before, force, &scale), off = 0;
    bool *bound = sm_alloc(size, sizeof *bound);
    double *N = sm_alloc((size_t)(terms * terms), sizeof *N),
           *y = sm_alloc((size_t)terms, sizeof *y), *row = sm_alloc((size_t)terms, sizeof *row);
    for (long e = 0; sheet->rows.count && e < sheet->rows.start[sheet->rows.count]; e++)
        bound[sheet->rows.column[e]] = true;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t n = 0; n < size; n++) {
            double left = r[n];
            if (bound[n]) continue;
            for (int t = 0; t < terms; t++) row[t] = slope[(size_t)t * size + n];
            if (pass == 0) ref_least_squares_add(terms, row, r[n], 1, N, y);
            for (int t = 0; pass && t < terms; t++) left -= y[t] * row[t];
            if (pass) off = fmax(off, fabs(left));
        }
        if (pass == 0 && terms) ref_least_squares_solve(terms, 0, N, y);
    }
    bench_elastic_note(found, BENCH_ELASTIC_STEP, scale > 0 ? off / scale : off);
    sm_free_all(r, bound, N, y, row);
}

static void check_holds(const RefShellBody *body, BenchElasticFound *found)
{
    for (int k = 0; k < body->sheet.holds; k++) {
        double place, turn;
        ref_sheet_off(&body->sheet, k, &place, &turn);
        bench_elastic_note(found, BENCH_ELASTIC_HELD, fmax(place / size_of(body), turn));
    }
}

/* Carried points from functions that are computed anew. */
static void check_skin(const RefShellBody *body, BenchElasticFound *found)
{
    const RefSheet *sheet = &body->sheet;
    RefShape shape = ref_shape_create(&sheet->shell.nodes);
    for (long k = 0; k < SAMPLES; k++) {
        long s = k * body->skin.count / SAMPLES, p = body->skin.order[s];
        double lift = 0;
        bool covered = ref_foot_at(&sheet->shell, &sheet->warp, body->map.theta[p],
                                   body->skin.rest[s], &shape, &lift);
        for (int d = 0; d < 3; d++) {
            double wanted = body->skin.rest[s][d];
            for (int n = 0; n < shape.count; n++)
                wanted += shape.value[n] * (sheet->warp.moved[shape.node[n]][d] +
                                            lift * sheet->warp.turned[shape.node[n]][d]);
            double off = fabs(body->carried[s][d] - wanted) / size_of(body);
            if (covered) bench_elastic_note(found, BENCH_ELASTIC_SKIN, off);
        }
    }
    if (body->loose && !body->breaking) bench_elastic_note(found, BENCH_ELASTIC_SKIN, NAN);
    ref_shape_free(&shape);
}

/* What steps make of the energy when nothing acts on the shell. */
static void check_growth(const RefSheet *sheet, BenchElasticFound *found)
{
    RefSteps steps;
    size_t size = 3 * (size_t)sheet->warp.nodes;
    if (ref_steps_create(&sheet->shell.matrices, &sheet->steps.damping, sheet->steps.h, NULL, NULL,
                         &steps, NULL)) {
        bench_elastic_note(found, BENCH_ELASTIC_GROWTH, NAN);
        return;
    }
    memcpy(steps.u, sheet->steps.u, size * sizeof *steps.u);
    memcpy(steps.v, sheet->steps.v, size * sizeof *steps.v);
    double first = ref_steps_energy(&steps), before = first;
    for (int n = 0; n < FREE_STEPS; n++) {
        ref_steps_go(&steps);
        double now = ref_steps_energy(&steps);
        bench_elastic_note(found, BENCH_ELASTIC_GROWTH,
                           first > 0 ? fmax(0, now - before) / first : now);
        before = now;
    }
    ref_steps_free(&steps);
}

/* What acted is less by what tension held back. */
static void subtract_tension(const RefSteps *steps, double *force)
{
    size_t size = (size_t)steps->matrices->stiffness.columns;
    if (!steps->taut) return;
    double *back = sm_alloc(size, sizeof *back);
    ref_sparse_apply(&steps->tension, 3, steps->v, back);
    for (size_t n = 0; n < size; n++) force[n] -= steps->h * back[n];
    free(back);
}

void bench_shell_check_state(BenchRunner *runner, BenchElasticFound *found)
{
    RefShellBody *body = ref_shell_body(runner->engine);
    RefSheet *sheet = &body->sheet;
    size_t size = 3 * (size_t)sheet->warp.nodes;
    double *before =
        sm_alloc((size_t)runner->type->get_state(runner->engine, NULL), sizeof *before);
    double *force = sm_alloc(size, sizeof *force);
    double *slope = sm_alloc(3 * size * (size_t)sheet->followers, sizeof *slope);
    double time = runner->time;
    runner->type->get_state(runner->engine, before);
    runner->type->set_state(runner->engine, before);
    memcpy(force, sheet->warp.pulled, size * sizeof *force);
    if (sheet->followers)
        memcpy(slope, sheet->slope, 3 * size * (size_t)sheet->followers * sizeof *slope);
    bench_runner_step(runner);
    subtract_tension(&sheet->steps, force);
    check_step(sheet, before, force, slope, found);
    check_holds(body, found);
    check_skin(body, found);
    check_growth(sheet, found);
    runner->time = time;
    bench_runner_prepare(runner);
    runner->type->set_state(runner->engine, before);
    sm_free_all(before, force, slope);
}

void bench_shell_check_broken(const RefShellBody *body, BenchElasticFound *found)
{
    check_shapes(body, found);
    check_rigid(body, found);
    check_skin(body, found);
    check_growth(&body->sheet, found);
}
