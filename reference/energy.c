#include "energy.h"

#include <stdlib.h>
#include <string.h>

#include "svd_polar.h"

typedef struct {
    long count;                    /* of one body */
    double *mass, *share, *region; /* m_i; m_i / M_i; m_r */
    long *start;
    long *member;
} Body;

static void regions(const SmEngineType *type, SmEngine *engine, Body *body)
{
    long none;
    body->start = sm_alloc((size_t)body->count + 1, sizeof(long));
    for (long r = 0; r < body->count; r++)
        body->start[r + 1] = body->start[r] + type->region(engine, r, &none, 0);
    body->member = sm_alloc((size_t)body->start[body->count], sizeof(long));
    for (long r = 0; r < body->count; r++)
        type->region(engine, r, body->member + body->start[r], body->start[r + 1] - body->start[r]);
}

static void weights(const SmEngineType *type, SmEngine *engine, Body *body)
{
    size_t count = (size_t)body->count;
    double *reach = sm_alloc(count, sizeof(double));
    body->mass = sm_alloc(count, sizeof(double));
    body->share = sm_alloc(count, sizeof(double));
    body->region = sm_alloc(count, sizeof(double));
    type->masses(engine, body->mass);
    for (long r = 0; r < body->count; r++) {
        body->region[r] = type->weighs_regions ? body->mass[r] : 1;
        for (long k = body->start[r]; k < body->start[r + 1]; k++)
            reach[body->member[k]] += body->region[r];
    }
    for (size_t i = 0; i < count; i++) body->share[i] = body->mass[i] / reach[i];
    free(reach);
}

/* sum over a region of share |x - T x0|^2 / 2. */
static double misfit(const Body *body, long r, const double (*x0)[3], const double (*x)[3])
{
    double M = 0, c[3] = {0}, c0[3] = {0}, A[9] = {0}, R[9], sum = 0;
    for (long k = body->start[r]; k < body->start[r + 1]; k++) {
        long i = body->member[k];
        M += body->share[i];
        for (int d = 0; d < 3; d++) {
            c[d] += body->share[i] * x[i][d];
            c0[d] += body->share[i] * x0[i][d];
        }
    }
    for (int d = 0; d < 3; d++) {
        c[d] /= M;
        c0[d] /= M;
    }
    for (long k = body->start[r]; k < body->start[r + 1]; k++) {
        long i = body->member[k];
        for (int a = 0; a < 9; a++)
            A[a] += body->share[i] * (x[i][a / 3] - c[a / 3]) * (x0[i][a % 3] - c0[a % 3]);
    }
    ref_polar(A, NULL, R);
    for (long k = body->start[r]; k < body->start[r + 1]; k++) {
        long i = body->member[k];
        for (int d = 0; d < 3; d++) {
            double off = x[i][d] - c[d];
            for (int b = 0; b < 3; b++) off -= R[3 * d + b] * (x0[i][b] - c0[b]);
            sum += 0.5 * body->share[i] * off * off;
        }
    }
    return sum;
}

static void add_body(const Body *body, const SmEngineParams *params, const double (*x0)[3],
                     const double (*x)[3], const double (*v)[3], const double (*g)[3],
                     RefEnergy *energy)
{
    double h = params->h;
    for (long r = 0; r < body->count; r++)
        energy->elastic += body->region[r] * misfit(body, r, x0, x) / (h * h);
    for (long i = 0; i < body->count; i++)
        for (int d = 0; d < 3; d++) {
            double m = body->mass[i], kick = (g[i][d] - x[i][d]) / h + h * params->gravity[d];
            energy->motion += 0.5 * m * v[i][d] * v[i][d];
            energy->gravity -= m * params->gravity[d] * x[i][d];
            energy->total += 0.5 * m * v[i][d] * (v[i][d] + kick);
        }
}

RefEnergy ref_energy(const SmEngineType *type, SmEngine *engine, const SmEngineParams *params)
{
    SmCounts counts;
    RefEnergy energy = {0};
    type->count(engine, &counts);
    long bodies = params->instances > 1 ? params->instances : 1;
    size_t all = (size_t)counts.particles;
    double(*field[4])[3];
    static const SmField fields[4] = {SM_REST, SM_POSITION, SM_VELOCITY, SM_GOAL};
    type->goals(engine);
    for (int f = 0; f < 4; f++) {
        field[f] = sm_alloc(all, sizeof *field[f]);
        type->get(engine, fields[f], field[f]);
    }
    Body body = {.count = counts.particles / bodies};
    regions(type, engine, &body);
    weights(type, engine, &body);
    for (long b = 0; b < bodies; b++) {
        long at = b * body.count;
        add_body(&body, params, (const double(*)[3])(field[0] + at),
                 (const double(*)[3])(field[1] + at), (const double(*)[3])(field[2] + at),
                 (const double(*)[3])(field[3] + at), &energy);
    }
    energy.total += energy.elastic + energy.gravity;
    for (int f = 0; f < 4; f++) free(field[f]);
    free(body.mass);
    free(body.share);
    free(body.region);
    free(body.start);
    free(body.member);
    return energy;
}
