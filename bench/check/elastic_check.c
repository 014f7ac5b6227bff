#include "elastic_check.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../../reference/meshless/engine.h"
#include "../../reference/meshless/solve/solver.h"
#include "../play/runner.h"

enum { SAMPLES = 4000, INVERSE_STEPS = 12, FREE_STEPS = 64, POINTS = 2000 };

/* ---- findings */

static const struct {
    const char *name;
    double tolerance;
} checks[BENCH_ELASTIC_CHECKS] = {
    {"shape functions", 1e-9},
    {"their gradients", 1e-8},
    {"mass", 1e-9},
    {"rigid motions", 1e-8},
    {"constant strains", 1e-8},
    {"orthogonality", 1e-8},
    {"modes' residuals", 1e-7},
    {"rigid modes", 1e-6},
    {"modes missed", 1e-6},
    {"small displacements", 1e-5},
    {"step", 1e-5},
    {"constraints", 1e-6},
    {"points", 1e-5},
    {"energy's growth", 1e-10},
};

void bench_elastic_note(BenchElasticFound *found, BenchElasticCheck check, double value)
{
    double *most = &found->found[check];
    found->looked |= 1u << check;
    if (!(value <= *most)) *most = isnan(*most) ? NAN : value;
    if (!isfinite(*most)) *most = NAN;
}

bool bench_elastic_verdict(const BenchElasticFound *found, size_t size, char *reason)
{
    for (int c = 0; c < BENCH_ELASTIC_CHECKS; c++) {
        if (found->found[c] <= checks[c].tolerance) continue;
        if (isnan(found->found[c]))
            snprintf(reason, size, "%s: not finite", checks[c].name);
        else
            snprintf(reason, size, "%s: %.3g off; at most %g allowed", checks[c].name,
                     found->found[c], checks[c].tolerance);
        return false;
    }
    return true;
}

void bench_elastic_text(const BenchElasticFound *found, size_t size, char *text)
{
    text[0] = '\0';
    for (int c = 0; c < BENCH_ELASTIC_CHECKS; c++)
        if (found->looked >> c & 1)
            sm_append(text, size, "%s%s %.1e", *text ? ", " : "off by: ", checks[c].name,
                      found->found[c]);
}

/* ---- the body */

/* Reproduction of 1 and x, and of their derivatives, at one point. */
static void reproduce(const RefElastic *elastic, const double x[3], RefShape *shape,
                      BenchElasticFound *found)
{
    const RefNodes *nodes = &elastic->body.nodes;
    double one = -1, linear[3] = {0}, slope[3] = {0}, slopes[3][3] = {{0}};
    if (!ref_mls_at(nodes, elastic->body.basis, x, shape)) {
        bench_elastic_note(found, BENCH_ELASTIC_UNITY, NAN);
        return;
    }
    double cell = elastic->body.octants.cell;
    for (int n = 0; n < shape->count; n++) {
        one += shape->value[n];
        for (int d = 0; d < 3; d++) {
            double away = (nodes->position[shape->node[n]][d] - x[d]) / cell;
            linear[d] += shape->value[n] * away;
            slope[d] += shape->gradient[n][d] * cell;
            for (int e = 0; e < 3; e++) slopes[d][e] += shape->gradient[n][e] * cell * away;
        }
    }
    bench_elastic_note(found, BENCH_ELASTIC_UNITY, fabs(one));
    for (int d = 0; d < 3; d++) {
        bench_elastic_note(found, BENCH_ELASTIC_UNITY, fabs(linear[d]));
        bench_elastic_note(found, BENCH_ELASTIC_SLOPE, fabs(slope[d]));
        for (int e = 0; e < 3; e++)
            bench_elastic_note(found, BENCH_ELASTIC_SLOPE, fabs(slopes[d][e] - (d == e)));
    }
}

static void check_shapes(const RefElastic *elastic, BenchElasticFound *found)
{
    const RefOctants *octants = &elastic->body.octants;
    RefShape shape = ref_shape_create(&elastic->body.nodes);
    for (long k = 0; k < SAMPLES / 2; k++) {
        long p = k * octants->points / (SAMPLES / 2), s = k * elastic->skin.count / (SAMPLES / 2);
        reproduce(elastic, octants->point[p].x, &shape, found);
        reproduce(elastic, elastic->skin.rest[s], &shape, found);
    }
    ref_shape_free(&shape);
}

/* 1, x, y and z about the body's middle, in cells, at the nodes: [nodes][4]. */
static double (*linear_fields(const RefElastic *elastic))[4]
{
    const RefNodes *nodes = &elastic->body.nodes;
    double(*field)[4] = sm_alloc((size_t)nodes->count, sizeof *field), middle[3] = {0};
    for (long n = 0; n < nodes->count; n++)
        for (int d = 0; d < 3; d++) middle[d] += nodes->position[n][d] / (double)nodes->count;
    for (long n = 0; n < nodes->count; n++) {
        field[n][0] = 1;
        for (int d = 0; d < 3; d++)
            field[n][1 + d] = (nodes->position[n][d] - middle[d]) / elastic->body.octants.cell;
    }
    return field;
}

static double dot(long count, const double *a, const double *b)
{
    double sum = 0;
    for (long n = 0; n < count; n++) sum += a[n] * b[n];
    return sum;
}

/* M's mass and second moments beside the integration points' own. Linear functions are exact, so
 * these are equal whatever the points are. */
static void check_mass(const RefElastic *elastic, const double (*field)[4],
                       BenchElasticFound *found)
{
    const RefBody *body = &elastic->body;
    size_t nodes = (size_t)body->nodes.count;
    double *product = sm_alloc(4 * nodes, sizeof *product), wanted[4][4] = {{0}};
    double density = elastic->material.density;
    ref_sparse_apply(&body->matrices.mass, 4, field[0], product);
    for (long p = 0; p < body->octants.points; p++) {
        const RefPoint *point = body->octants.point + p;
        double value[4] = {1};
        for (int d = 0; d < 3; d++) /* the field at node 0, and from there */
            value[1 + d] =
                field[0][1 + d] + (point->x[d] - body->nodes.position[0][d]) / body->octants.cell;
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < 4; b++)
                wanted[a][b] += density * point->weight * value[a] * value[b];
    }
    for (int a = 0; a < 4; a++)
        for (int b = 0; b < 4; b++) {
            double have = 0;
            for (size_t n = 0; n < nodes; n++) have += field[n][a] * product[4 * n + (size_t)b];
            bench_elastic_note(found, BENCH_ELASTIC_MASS,
                               fabs(have - wanted[a][b]) / sqrt(wanted[a][a] * wanted[b][b]));
        }
    free(product);
}

/* |K| |u|, which says how large the sums are that cancel in K u. */
static void apply_absolute(const RefSparse *K, const double *u, double *sum)
{
    memset(sum, 0, (size_t)K->columns * sizeof *sum);
    for (int c = 0; c < K->columns; c++)
        for (int e = K->start[c]; e < K->start[c + 1]; e++) {
            sum[K->row[e]] += fabs(K->value[e] * u[c]);
            if (K->row[e] != c) sum[c] += fabs(K->value[e] * u[K->row[e]]);
        }
}

/* Motion `number` of twelve at the nodes: three translations, three turns, six strains (xx yy zz yz
 * zx xy, the shears with gamma = 1). */
static void motion_field(const double (*field)[4], long nodes, int number, double *u)
{
    memset(u, 0, 3 * (size_t)nodes * sizeof *u);
    int axis = number % 3, b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (long n = 0; n < nodes; n++) {
        double *at = u + 3 * n;
        if (number < 3) at[axis] = 1;
        if (number >= 3 && number < 6) at[b] = -field[n][1 + c], at[c] = field[n][1 + b];
        if (number >= 6 && number < 9) at[axis] = field[n][1 + axis];
        if (number >= 9) at[b] = field[n][1 + c] / 2, at[c] = field[n][1 + b] / 2;
    }
}

static void check_stiffness(const RefElastic *elastic, const double (*field)[4],
                            BenchElasticFound *found)
{
    const RefSparse *K = &elastic->body.matrices.stiffness;
    long nodes = elastic->body.nodes.count;
    size_t size = (size_t)K->columns;
    double *u = sm_alloc(12 * size, sizeof *u), *f = sm_alloc(size, sizeof *f);
    double *scale = sm_alloc(size, sizeof *scale);
    RefMaterial m = elastic->material;
    double cell = elastic->body.octants.cell, volume = ref_octants_volume(&elastic->body.octants);
    double mu = m.young / (2 * (1 + m.poisson)), lambda = 2 * mu * m.poisson / (1 - 2 * m.poisson);
    double unit = volume / (cell * cell), most = (lambda + 2 * mu) * unit;
    for (int k = 0; k < 12; k++) motion_field(field, nodes, k, u + (size_t)k * size);
    for (int k = 0; k < 12; k++) {
        ref_sparse_apply(K, 1, u + (size_t)k * size, f);
        if (k < 6) apply_absolute(K, u + (size_t)k * size, scale);
        for (size_t n = 0; k < 6 && n < size; n++)
            bench_elastic_note(found, BENCH_ELASTIC_RIGID, fabs(f[n]) / scale[n]);
        for (int j = 6; k >= 6 && j < 12; j++) {
            double wanted = j < 9 && k < 9 ? lambda + 2 * mu * (j == k) : j == k ? mu : 0;
            double have = dot((long)size, u + (size_t)j * size, f);
            bench_elastic_note(found, BENCH_ELASTIC_STRAIN, fabs(have - wanted * unit) / most);
        }
    }
    free(u);
    free(f);
    free(scale);
}

/* Orthogonality, residuals and the rigid modes. */
static void check_modes(const RefElastic *elastic, BenchElasticFound *found)
{
    const RefModes *modes = &elastic->modes;
    size_t count = (size_t)modes->count, size = 3 * (size_t)modes->nodes;
    double *Mx = sm_alloc(size * count, sizeof *Mx), *Kx = sm_alloc(size * count, sizeof *Kx);
    double highest = modes->lambda[count - 1];
    ref_sparse_apply(&elastic->body.matrices.mass, 3 * (int)count, modes->shape, Mx);
    ref_sparse_apply(&elastic->body.matrices.stiffness, (int)count, modes->shape, Kx);
    for (size_t a = 0; a < count; a++) {
        double off = 0, all = 0;
        for (size_t n = 0; n < size; n++) {
            double r = Kx[n * count + a] - modes->lambda[a] * Mx[n * count + a];
            off += r * r;
            all += highest * highest * Mx[n * count + a] * Mx[n * count + a];
        }
        bench_elastic_note(found, BENCH_ELASTIC_RESIDUAL, sqrt(off / all));
        for (size_t b = 0; b <= a; b++) {
            double product = 0;
            for (size_t n = 0; n < size; n++)
                product += modes->shape[n * count + a] * Mx[n * count + b];
            bench_elastic_note(found, BENCH_ELASTIC_ORTHOGONAL, fabs(product - (a == b)));
        }
    }
    for (size_t a = 0; a < 6 && count > 6; a++)
        bench_elastic_note(found, BENCH_ELASTIC_ZERO,
                           fabs(modes->lambda[a]) / fabs(modes->lambda[6]));
    free(Mx);
    free(Kx);
}

/* Takes the modes' share out of x, by M; then makes x^T M x = 1. */
static void deflate(const RefElastic *elastic, double *x, double *Mx)
{
    const RefModes *modes = &elastic->modes;
    size_t count = (size_t)modes->count, size = 3 * (size_t)modes->nodes;
    double *share = sm_alloc(count, sizeof *share);
    ref_sparse_apply(&elastic->body.matrices.mass, 3, x, Mx);
    for (size_t n = 0; n < size; n++)
        for (size_t k = 0; k < count; k++) share[k] += modes->shape[n * count + k] * Mx[n];
    for (size_t n = 0; n < size; n++)
        for (size_t k = 0; k < count; k++) x[n] -= share[k] * modes->shape[n * count + k];
    ref_sparse_apply(&elastic->body.matrices.mass, 3, x, Mx);
    double length = sqrt(dot((long)size, x, Mx));
    for (size_t n = 0; n < size; n++) x[n] /= length, Mx[n] /= length;
    free(share);
}

/* Inverse iteration in what the modes leave finds the lowest mode there, which must not lie below
 * the highest of those that were found. */
static void check_missed(const RefElastic *elastic, BenchElasticFound *found)
{
    const RefModes *modes = &elastic->modes;
    const RefMatrices *matrices = &elastic->body.matrices;
    size_t size = 3 * (size_t)modes->nodes;
    double highest = modes->lambda[modes->count - 1];
    RefSolver *solver;
    if (ref_solver_create(matrices, -1e-3 * fabs(highest), NULL, &solver, NULL)) {
        bench_elastic_note(found, BENCH_ELASTIC_MISSED, NAN);
        return;
    }
    double *x = sm_alloc(size, sizeof *x), *Mx = sm_alloc(size, sizeof *Mx);
    unsigned random = 2;
    for (size_t n = 0; n < size; n++) {
        random = random * 1664525U + 1013904223U;
        x[n] = random / 4294967296.0 - 0.5;
    }
    deflate(elastic, x, Mx);
    for (int k = 0; k < INVERSE_STEPS; k++) {
        ref_solver_solve(solver, Mx, NULL, x);
        deflate(elastic, x, Mx);
    }
    ref_sparse_apply(&matrices->stiffness, 1, x, Mx);
    bench_elastic_note(found, BENCH_ELASTIC_MISSED, fmax(0, 1 - dot((long)size, x, Mx) / highest));
    ref_solver_destroy(solver);
    free(x);
    free(Mx);
}

void bench_elastic_check_body(const RefElastic *elastic, BenchElasticFound *found)
{
    double(*field)[4] = linear_fields(elastic);
    check_shapes(elastic, found);
    check_mass(elastic, (const double(*)[4])field, found);
    check_stiffness(elastic, (const double(*)[4])field, found);
    check_modes(elastic, found);
    free(field);
    check_missed(elastic, found);
}

/* ---- a state of motion */

/* The modes' amplitudes and then their velocities; the caller frees. */
static double *state_of(const BenchRunner *runner)
{
    long size = runner->type->get_state(runner->engine, NULL);
    double *state = sm_alloc((size_t)size, sizeof *state);
    runner->type->get_state(runner->engine, state);
    return state;
}

/* Where the displacements are small, warping turns nothing. */
static void check_pose(RefElastic *elastic, BenchElasticFound *found)
{
    static const double small = 1e-6;
    RefMotion *motion = &elastic->motion;
    size_t modes = (size_t)motion->modes, size = 3 * (size_t)motion->nodes;
    double most = 0, off = 0;
    for (size_t k = 0; k < modes; k++) motion->z[k] *= small;
    ref_motion_pose(motion);
    for (size_t n = 0; n < size; n++) {
        double wanted = 0;
        for (size_t k = 0; k < modes; k++)
            wanted += elastic->modes.shape[n * modes + k] * motion->z[k];
        most = fmax(most, fabs(wanted));
        off = fmax(off, fabs(motion->moved[n / 3][n % 3] - wanted));
    }
    bench_elastic_note(found, BENCH_ELASTIC_POSE, most > 0 ? off / most : off);
}

/* d C / d z of all constraints by central differences, [3 holds][modes]. */
static double *slopes(RefMotion *motion, double step)
{
    size_t modes = (size_t)motion->modes;
    double *J = sm_alloc(3 * (size_t)motion->holds * modes, sizeof *J);
    for (size_t k = 0; k < modes; k++) {
        double z = motion->z[k];
        for (int side = 1; side >= -1; side -= 2) {
            motion->z[k] = z + side * step;
            for (int c = 0; c < motion->holds; c++) {
                double off[3];
                ref_motion_off(motion, c, off);
                for (size_t d = 0; d < 3; d++)
                    J[(3 * (size_t)c + d) * modes + k] += side * off[d] / (2 * step);
            }
        }
        motion->z[k] = z;
    }
    return J;
}

/* Eq. 33 as a dense system of the changes of the modes' velocities and the multipliers, by LU:
 * right becomes them. */
static void fill_system(const RefElastic *elastic, double h, const double *J, gsl_matrix *system,
                        gsl_vector *right)
{
    const RefMotion *motion = &elastic->motion;
    size_t modes = (size_t)motion->modes, rows = 3 * (size_t)motion->holds;
    for (size_t k = 0; k < modes; k++) {
        double lambda = fmax(elastic->modes.lambda[k], 0);
        double damping = motion->damping.mass_damping + motion->damping.stiffness_damping * lambda;
        gsl_matrix_set(system, k, k, 1 + h * damping + h * h * lambda);
        gsl_vector_set(right, k,
                       h * (motion->load[k] - lambda * motion->z[k] -
                            (damping + h * lambda) * motion->speed[k]));
        for (size_t r = 0; r < rows; r++) {
            gsl_matrix_set(system, k, modes + r, J[r * modes + k]);
            gsl_matrix_set(system, modes + r, k, J[r * modes + k]);
        }
    }
    for (size_t r = 0; r < rows; r++) {
        double off[3], rate = 0;
        ref_motion_off(motion, (int)(r / 3), off);
        for (size_t k = 0; k < modes; k++) rate += J[r * modes + k] * motion->speed[k];
        gsl_vector_set(right, modes + r, -off[r % 3] / h - rate);
    }
}

/* The step's velocities `after` from those that a dense solution gives, by the largest of them, or
 * by what the forces alone would add to them: of a stiff body at rest nothing but rounding is left.
 * `motion` is as it was before the step, with the step's targets. */
static void compare_step(RefElastic *elastic, double h, double step, const double *after,
                         BenchElasticFound *found)
{
    RefMotion *motion = &elastic->motion;
    size_t modes = (size_t)motion->modes, all = modes + 3 * (size_t)motion->holds;
    double *J = slopes(motion, step), off = 0, most = 0;
    int sign;
    gsl_matrix *system = gsl_matrix_calloc(all, all);
    gsl_vector *right = gsl_vector_calloc(all), *change = gsl_vector_calloc(all);
    gsl_permutation *order = gsl_permutation_alloc(all);
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    fill_system(elastic, h, J, system, right);
    bool solved = gsl_linalg_LU_decomp(system, order, &sign) == GSL_SUCCESS &&
                  gsl_linalg_LU_solve(system, order, right, change) == GSL_SUCCESS;
    gsl_set_error_handler(handler);
    for (size_t k = 0; k < modes; k++) {
        double wanted = motion->speed[k] + gsl_vector_get(change, k);
        most = fmax(most, fmax(fabs(wanted), h * fabs(motion->load[k])));
        off = fmax(off, fabs(after[k] - wanted));
    }
    bench_elastic_note(found, BENCH_ELASTIC_STEP, !solved ? NAN : most > 0 ? off / most : off);
    gsl_matrix_free(system);
    gsl_vector_free(right);
    gsl_vector_free(change);
    gsl_permutation_free(order);
    free(J);
}

static void check_held(const RefMotion *motion, BenchElasticFound *found)
{
    for (int c = 0; c < motion->holds; c++) {
        double off[3], unit = motion->hold[c].kind == REF_HOLD_POSITION ? motion->size : 1;
        ref_motion_off(motion, c, off);
        for (int d = 0; d < 3; d++)
            bench_elastic_note(found, BENCH_ELASTIC_HELD, fabs(off[d]) / unit);
    }
}

/* Carried points from shape functions that are computed anew. */
static void check_skin(const RefElastic *elastic, BenchElasticFound *found)
{
    const RefSkin *skin = &elastic->skin;
    RefShape shape = ref_shape_create(&elastic->body.nodes);
    for (long k = 0; k < POINTS; k++) {
        long p = k * skin->count / POINTS;
        bool covered = ref_mls_at(&elastic->body.nodes, elastic->body.basis, skin->rest[p], &shape);
        for (int d = 0; d < 3; d++) {
            double wanted = skin->rest[p][d];
            for (int n = 0; n < shape.count; n++)
                wanted += shape.value[n] * elastic->motion.moved[shape.node[n]][d];
            double off = fabs(elastic->carried[p][d] - wanted) / elastic->motion.size;
            bench_elastic_note(found, BENCH_ELASTIC_SKIN, covered ? off : NAN);
        }
    }
    ref_shape_free(&shape);
}

/* What the implicit step makes of the energy when nothing acts on the body. */
static void check_growth(RefElastic *elastic, double h, BenchElasticFound *found)
{
    RefMotion *motion = &elastic->motion;
    size_t nodes = (size_t)motion->nodes;
    double(*force)[3] = sm_alloc(nodes, sizeof *force);
    int holds = motion->holds;
    memcpy(force, motion->force, nodes * sizeof *force);
    memset(motion->force, 0, nodes * sizeof *force);
    motion->holds = 0;
    ref_motion_pose(motion);
    for (int n = 0; n < FREE_STEPS; n++) {
        double before = ref_motion_energy(motion);
        ref_motion_step(motion, h);
        double grown = ref_motion_energy(motion) - before;
        bench_elastic_note(found, BENCH_ELASTIC_GROWTH,
                           before > 0 ? fmax(0, grown / before) : grown);
    }
    motion->holds = holds;
    memcpy(motion->force, force, nodes * sizeof *force);
    free(force);
}

void bench_elastic_check_state(BenchRunner *runner, BenchElasticFound *found)
{
    RefElastic *elastic = ref_meshless_elastic(runner->engine);
    RefMotion *motion = &elastic->motion;
    double *before = state_of(runner),
           (*target)[3] = sm_alloc((size_t)motion->holds, sizeof *target);
    double time = runner->time, h = runner->scene->params.h, mass = 0;
    for (int c = 0; c < motion->holds; c++)
        memcpy(target[c], motion->hold[c].target, sizeof *target);
    for (int c = 0; c < elastic->body.matrices.mass.columns; c++)
        mass += elastic->body.matrices.mass.value[elastic->body.matrices.mass.start[c]];
    check_pose(elastic, found);
    runner->type->set_state(runner->engine, before);
    bench_runner_step(runner);
    check_held(motion, found);
    check_skin(elastic, found);
    double *after = state_of(runner);
    runner->type->set_state(runner->engine, before); /* with the step's targets */
    compare_step(elastic, h, 1e-5 * motion->size * sqrt(mass), after + motion->modes, found);
    check_growth(elastic, h, found);
    for (int c = 0; c < motion->holds; c++)
        memcpy(motion->hold[c].target, target[c], sizeof *target);
    runner->type->set_state(runner->engine, before);
    runner->time = time;
    free(before);
    free(after);
    free(target);
}
