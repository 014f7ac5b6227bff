#include "tension.h"

#include <math.h>
#include <string.h>

#include "../../../lib/vector.h"

enum { PLACES = REF_WARP_PLACES, LANES = REF_FRAME_SLOPES, MOST_ROUNDS = 32 };
/* What is left of the residual's energy when rounds end, of the first one's. */
static const double LEFT = 1e-6;

/* How large the tug at a place is, N/m. */
static double tension_at(const RefWarpPlace *place, const double f[2][3])
{
    const double(*a)[3] = place->tangent;
    double square = 0;
    for (int k = 0; k < 2; k++)
        for (int l = 0; l < 2; l++) square += sm_dot(a[k], a[l]) * sm_dot(f[k], f[l]);
    return place->area > 0 ? sqrt(square) / place->area : 0;
}

bool ref_tension_matters(const RefWarp *warp, const double (*tug)[2][3],
                         const RefShellOptions *shell, const RefDamping *damping, double h)
{
    const RefMaterial *material = &shell->material;
    double t = shell->thickness, nu = material->poisson, mass = 4 * material->density * t;
    double bending = material->young * t * t * t / (12 * (1 - nu * nu)) *
                     (h * h + 2 * h * damping->stiffness_damping);
    double room = 0; /* for waves, in squares of their lengths */
    for (long at = 0; at < PLACES * warp->cells; at++) {
        const RefWarpPlace *place = warp->place + at;
        /* k^2 of the wave that bears least, or of the shortest that there is */
        double square = fmin(sqrt(mass / bending), M_PI * M_PI / (4 * place->area));
        double tension = tension_at(place, tug[at]);
        if (h * h * tension * square > mass + bending * square * square)
            room += place->area * square / (4 * M_PI * M_PI);
    }
    return room > 1;
}

/* The sum of the squares of a place's two stretches, and their product. */
static void stretches_at(const RefWarp *warp, long at, double *squares, double *product)
{
    const double *q = warp->place[at].metric, (*s)[3] = warp->turn[at].tangent;
    double area = warp->place[at].area, S[3];
    for (int k = 0; k < 2; k++) S[k] = sm_dot(s[k], s[k]);
    S[2] = sm_dot(s[0], s[1]);
    *squares = *product = 0;
    if (!(area > 0)) return;
    *squares = (q[0] * S[0] + q[1] * S[1] + 2 * q[2] * S[2]) / area;
    *product = sqrt(fmax(0, (q[0] * q[1] - q[2] * q[2]) * (S[0] * S[1] - S[2] * S[2]))) / area;
}

/* T' of all places; returns the largest stretch. */
static double find_stiffness(const RefWarp *warp, const double (*tug)[2][3], double *stiffness)
{
    double most = 0;
    for (long at = 0; at < PLACES * warp->cells; at++) {
        double squares, product;
        stretches_at(warp, at, &squares, &product);
        stiffness[at] =
            tension_at(warp->place + at, tug[at]) * (sqrt(squares) + sqrt(squares + 4)) / 4;
        double both = sqrt(squares + 2 * product), apart = sqrt(fmax(0, squares - 2 * product));
        most = fmax(most, (both + apart) / 2);
    }
    return most;
}

/* G v, of [nodes][3]. */
static void apply(RefWarp *warp, const double *stiffness, const double *v, double *force)
{
    memset(warp->sum, 0, (size_t)warp->nodes * sizeof *warp->sum);
    for (long c = 0; c < warp->cells; c++) {
        int count = (int)(warp->start[c + 1] - warp->start[c]);
        const int *node = warp->node + warp->start[c];
        const double(*slope)[LANES] = (const double(*)[LANES])(warp->slope + warp->start[c]);
        double sum[3][LANES], spread[LANES][LANES] = {{0}};
        ref_frame_sums.slopes(count, node, slope, (const double(*)[3])v, sum);
        for (int p = 0; p < PLACES; p++) {
            long at = PLACES * c + p;
            const double *q = warp->place[at].metric;
            for (int k = 0; k < 2; k++)
                for (int d = 0; d < 3; d++)
                    spread[2 * p + k][d] =
                        stiffness[at] * (q[k] * sum[d][2 * p + k] + q[2] * sum[d][2 * p + !k]);
        }
        ref_frame_sums.spread(count, node, slope, (const double(*)[LANES])spread, warp->sum);
    }
    for (long n = 0; n < warp->nodes; n++) memcpy(force + 3 * n, warp->sum[n], 3 * sizeof *force);
}

static double product(long size, const double *a, const double *b)
{
    double sum = 0;
    for (long n = 0; n < size; n++) sum += a[n] * b[n];
    return sum;
}

/* (K + m M) (v - x), K + m M the matrix that steps are solved with. */
static void balance(RefSteps *steps, const double *x, double *force)
{
    int size = steps->matrices->stiffness.columns;
    double m = ref_steps_mass_share(&steps->damping, steps->h);
    double *way = steps->right, *inertia = steps->other;
    for (int n = 0; n < size; n++) way[n] = steps->v[n] - x[n];
    ref_sparse_apply(&steps->matrices->stiffness, 1, way, force);
    ref_sparse_apply(&steps->matrices->mass, 3, way, inertia);
    for (int n = 0; n < size; n++) force[n] += m * inertia[n];
}

/* x of (K + m M + times G) x = (K + m M) v, from x on; `room` is for four more vectors. */
static void solve(RefWarp *warp, RefSteps *steps, const double *stiffness, double times, double *x,
                  double *room)
{
    long size = 3 * warp->nodes;
    double *r = room, *z = r + size, *p = z + size, *q = p + size, *Gp = steps->other;
    double first = 0, before = INFINITY;
    memset(p, 0, 2 * (size_t)size * sizeof *p); /* and q */
    balance(steps, x, r);
    apply(warp, stiffness, x, Gp);
    for (long n = 0; n < size; n++) r[n] -= times * Gp[n];
    for (int round = 0; round <= MOST_ROUNDS; round++) {
        ref_solver_solve(steps->solver, r, NULL, z);
        double left = product(size, r, z);
        if (round == 0) first = left;
        if (!(left > LEFT * first) || round == MOST_ROUNDS) break;
        for (long n = 0; n < size; n++) {
            p[n] = z[n] + left / before * p[n];
            q[n] = r[n] + left / before * q[n]; /* (K + m M) p, but for what the rows do */
        }
        apply(warp, stiffness, p, Gp);
        for (long n = 0; n < size; n++) Gp[n] = q[n] + times * Gp[n];
        double step = left / product(size, p, Gp);
        for (long n = 0; n < size; n++) {
            x[n] += step * p[n];
            r[n] -= step * Gp[n];
        }
        before = left;
    }
}

size_t ref_tension_room(const RefWarp *warp)
{
    return 5 * 3 * (size_t)warp->nodes + PLACES * (size_t)warp->cells;
}

double ref_tension_bear(RefWarp *warp, const double (*tug)[2][3], RefSteps *steps, double *room)
{
    long size = 3 * warp->nodes;
    double h = steps->h, lead = steps->damping.stiffness_damping + h;
    double *x = room, *stiffness = x + 5 * size;
    double stretch = find_stiffness(warp, tug, stiffness);
    room += size;
    ref_solver_solve(steps->solver, NULL, steps->speed, x);
    ref_warp_match(warp, (const double(*)[3])steps->v, (double(*)[3])x);
    solve(warp, steps, stiffness, h / lead, x, room);
    balance(steps, x, room);
    for (long n = 0; n < size; n++) {
        steps->force[n] -= lead * room[n];
        steps->u[n] += h * (x[n] - steps->v[n]);
        steps->v[n] = x[n];
    }
    return stretch;
}
