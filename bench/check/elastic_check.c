#include "elastic_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../reference/meshless/solve/solver.h"

enum { SAMPLES = 4000, INVERSE_STEPS = 12 };

/* Reproduction of 1 and x, and of their derivatives, at one point. */
static void reproduce(const BenchElastic *elastic, const double x[3], RefShape *shape,
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

static void check_shapes(const BenchElastic *elastic, BenchElasticFound *found)
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
static double (*linear_fields(const BenchElastic *elastic))[4]
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
static void check_mass(const BenchElastic *elastic, const double (*field)[4],
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

static void check_stiffness(const BenchElastic *elastic, const double (*field)[4],
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
static void check_modes(const BenchElastic *elastic, BenchElasticFound *found)
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
static void deflate(const BenchElastic *elastic, double *x, double *Mx)
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
static SmCode check_missed(const BenchElastic *elastic, BenchElasticFound *found, SmError *error)
{
    const RefModes *modes = &elastic->modes;
    const RefMatrices *matrices = &elastic->body.matrices;
    size_t size = 3 * (size_t)modes->nodes;
    double highest = modes->lambda[modes->count - 1];
    RefSolver *solver;
    SmCode code = ref_solver_create(matrices, -1e-3 * fabs(highest), NULL, &solver, error);
    if (code) return code;
    double *x = sm_alloc(size, sizeof *x), *Mx = sm_alloc(size, sizeof *Mx);
    unsigned state = 2;
    for (size_t n = 0; n < size; n++) {
        state = state * 1664525U + 1013904223U;
        x[n] = state / 4294967296.0 - 0.5;
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
    return SM_OK;
}

SmCode bench_elastic_check_body(const BenchElastic *elastic, BenchElasticFound *found,
                                SmError *error)
{
    double(*field)[4] = linear_fields(elastic);
    check_shapes(elastic, found);
    check_mass(elastic, (const double(*)[4])field, found);
    check_stiffness(elastic, (const double(*)[4])field, found);
    check_modes(elastic, found);
    free(field);
    return check_missed(elastic, found, error);
}
