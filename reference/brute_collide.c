#include "brute_collide.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/error.h"
#include "../lib/vector.h"

/* Where a cell is: its middle and, by columns, its axes. */
typedef struct {
    double middle[3], F[9];
} Place;

struct RefCollide {
    const SmCollideRest *rest;
    const SmCollideParams *params;
    long bodies;
    const double (*x)[3], (*frame)[9];
    int *level;    /* [cells] */
    bool *surface; /* [nodes] carries an outer face */
    double widest; /* edge of a cell that nodes are tested against */
    Place *place;  /* [bodies * cells] */
    int from;      /* node that ways are known from; -1: none */
    double *way;   /* [nodes] */
    int *around;   /* [nodes] those that ways may lead through */
};

/* How many cells lie between a cell and one with an outer face, by faces: 0 for these;
 * SM_COLLIDE_LAYERS for all that are deeper. */
static int *find_levels(const SmCollideRest *rest)
{
    int *level = sm_alloc((size_t)rest->cells, sizeof *level);
    for (long k = 0; k < rest->cells; k++) level[k] = SM_COLLIDE_LAYERS;
    for (int l = 0; l < SM_COLLIDE_LAYERS; l++)
        for (long k = 0; k < rest->cells; k++)
            for (int side = 0; side < SM_COLLIDE_FACES; side++) {
                int other = rest->across[k][side];
                bool reached = l == 0 ? other < 0 : other >= 0 && level[other] == l - 1;
                if (reached && level[k] > l) level[k] = l;
            }
    return level;
}

/* Nearest point of an outer face of cell k. */
static double face_distance(const SmCollideRest *rest, long k, int side, const double q[3],
                            double point[3])
{
    double half = rest->edge[k] / 2;
    for (int d = 0; d < 3; d++)
        point[d] = fmin(fmax(q[d], rest->centre[k][d] - half), rest->centre[k][d] + half);
    point[side / 2] = rest->centre[k][side / 2] + (side % 2 ? half : -half);
    double off[3] = {point[0] - q[0], point[1] - q[1], point[2] - q[2]};
    return sqrt(sm_dot(off, off));
}

enum { NEAREST = SM_COLLIDE_FACES * SM_COLLIDE_FACES };

/* The outer faces, as 6 cell + side, that the depth in cell k is measured to: its own, or of those
 * of the cells across its faces one level up, the nearest to its centre. Returns how many. */
static int faces_of(const RefCollide *twin, long k, int face[NEAREST])
{
    const SmCollideRest *rest = twin->rest;
    int count = 0, all = 0, any[NEAREST];
    double nearest = DBL_MAX, point[3];
    for (int side = 0; side < SM_COLLIDE_FACES; side++) {
        int other = rest->across[k][side];
        if (twin->level[k] == 0) {
            if (other < 0) face[count++] = (int)(6 * k) + side;
        } else if (other >= 0 && twin->level[other] == twin->level[k] - 1) {
            all += faces_of(twin, other, any + all);
        }
    }
    for (int i = 0; i < all; i++)
        nearest =
            fmin(nearest, face_distance(rest, any[i] / 6, any[i] % 6, rest->centre[k], point));
    for (int last = -1, next = 0; next != INT_MAX; last = next) {
        next = INT_MAX; /* the nearest ones by rising number */
        for (int i = 0; i < all; i++)
            if (any[i] > last && any[i] < next &&
                face_distance(rest, any[i] / 6, any[i] % 6, rest->centre[k], point) <=
                    nearest + 1e-9)
                next = any[i];
        if (next != INT_MAX) face[count++] = next;
    }
    return count;
}

static bool depth_at(const RefCollide *twin, long k, const double q[3], double radius,
                     double *depth, double out[3])
{
    const SmCollideRest *rest = twin->rest;
    int face[NEAREST], count = faces_of(twin, k, face);
    double best = DBL_MAX, point[3];
    bool inside = true;
    for (int d = 0; d < 3; d++) inside &= fabs(q[d] - rest->centre[k][d]) <= rest->edge[k] / 2;
    if (!inside && twin->level[k] > 0) return false;
    for (int i = 0; i < count; i++) {
        int axis = face[i] % 6 / 2;
        double sign = face[i] % 2 ? 1 : -1;
        double distance = face_distance(rest, face[i] / 6, face[i] % 6, q, point);
        bool before = sign * (q[axis] - point[axis]) > 0;
        if ((!inside && !before) || distance >= best) continue;
        best = distance;
        for (int d = 0; d < 3; d++)
            out[d] = distance > 1e-9 ? (inside ? point[d] - q[d] : q[d] - point[d]) / distance
                     : d == axis     ? sign
                                     : 0;
    }
    *depth = inside ? radius + best : radius - best;
    return *depth > 0;
}

static double size_of(const SmCollideRest *rest, int node)
{
    return rest->size ? rest->size[node] : 1;
}

static double radius_of(const SmCollideRest *rest, int node)
{
    return rest->radius ? rest->radius[node] : 0;
}

static double max_norm(const double a[3], const double b[3])
{
    return fmax(fmax(fabs(a[0] - b[0]), fabs(a[1] - b[1])), fabs(a[2] - b[2]));
}

/* Shortest ways from a node, half cells, through nodes that are as near to it as a cell may be:
 * Bellman and Ford. */
static void search_ways(RefCollide *twin, int node)
{
    const SmCollideRest *rest = twin->rest;
    double window = sm_collide_apart(size_of(rest, node), twin->widest) + 1e-9 + twin->widest;
    long count = 0;
    if (twin->from == node) return;
    twin->from = node;
    for (int i = 0; i < rest->nodes; i++) {
        twin->way[i] = i == node ? 0 : DBL_MAX;
        if (max_norm(rest->x0[node], rest->x0[i]) <= window) twin->around[count++] = i;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (const int *i = twin->around; i < twin->around + count; i++)
            for (long e = rest->first[*i]; e < rest->first[*i + 1]; e++) {
                int to = rest->to[e];
                if (twin->way[*i] + rest->length[e] >= twin->way[to] ||
                    max_norm(rest->x0[node], rest->x0[to]) > window)
                    continue;
                twin->way[to] = twin->way[*i] + rest->length[e];
                changed = true;
            }
    }
}

static bool near(RefCollide *twin, int node, long k)
{
    const SmCollideRest *rest = twin->rest;
    double apart = sm_collide_apart(size_of(rest, node), rest->edge[k]), least = DBL_MAX, depth,
           out[3];
    if (max_norm(rest->x0[node], rest->centre[k]) - rest->edge[k] / 2 > apart + 1e-9) return false;
    search_ways(twin, node);
    for (int c = 0; c < rest->carriers; c++)
        least = fmin(least, twin->way[rest->carrier[k * rest->carriers + c]]);
    double through = least / 2 - (rest->carriers == 1 ? rest->edge[k] / 2 : 0);
    if (through <= SM_COLLIDE_AROUND * (apart + 1e-9)) return true;
    return depth_at(twin, k, rest->x0[node], radius_of(rest, node), &depth, out);
}

static void place_cell(const SmCollideRest *rest, long k, const double (*x)[3],
                       const double (*frame)[9], double middle[3], double F[9])
{
    const int *carrier = rest->carrier + k * rest->carriers;
    for (int i = 0; i < 3; i++) {
        middle[i] = 0;
        for (int d = 0; d < 3; d++) {
            F[3 * i + d] = frame ? frame[carrier[0]][3 * i + d] : 0;
            for (int c = 0; c < rest->carriers && !frame; c++)
                F[3 * i + d] += (c >> d & 1 ? 0.25 : -0.25) * x[carrier[c]][i] / rest->edge[k];
        }
        for (int c = 0; c < rest->carriers; c++) middle[i] += x[carrier[c]][i] / rest->carriers;
    }
}

/* Solves F y = b by Cramer's rule; false for a cell without an inside. */
static bool solve(const double F[9], const double b[3], double y[3])
{
    double column[3][3], cross[3];
    for (int i = 0; i < 3; i++)
        for (int d = 0; d < 3; d++) column[d][i] = F[3 * i + d];
    sm_cross(column[1], column[2], cross);
    double determinant = sm_dot(column[0], cross);
    for (int d = 0; d < 3; d++) {
        sm_cross(column[(d + 1) % 3], column[(d + 2) % 3], cross);
        y[d] = sm_dot(b, cross) / determinant;
    }
    return determinant > SM_COLLIDE_FLATTEST;
}

static bool meet(const RefCollide *twin, long b, long k, int node, const double p[3],
                 RefContact *contact)
{
    const SmCollideRest *rest = twin->rest;
    const Place *place = &twin->place[b * rest->cells + k];
    double off[3], y[3], q[3], out[3], transposed[9];
    double most = rest->edge[k] / 2 + radius_of(rest, node) + 1e-9; /* of |y| along an axis */
    for (int i = 0; i < 3; i++) {
        const double *row = place->F + 3 * i;
        double sum = fabs(row[0]) + fabs(row[1]) + fabs(row[2]);
        if (sum >= SM_COLLIDE_LONGEST) return false;
        off[i] = p[i] - place->middle[i];
        if (fabs(off[i]) > sum * most) return false; /* nowhere near: no need to solve */
        for (int d = 0; d < 3; d++) transposed[3 * d + i] = row[d];
    }
    if (!solve(place->F, off, y)) return false;
    for (int d = 0; d < 3; d++) q[d] = rest->centre[k][d] + y[d];
    if (!depth_at(twin, k, q, radius_of(rest, node), &contact->depth, out)) return false;
    solve(transposed, out, contact->out);
    for (int c = 0; c < rest->carriers; c++) {
        contact->weight[c] = 1;
        for (int d = 0; d < 3 && rest->carriers > 1; d++) {
            double share = fmin(fmax(y[d] / rest->edge[k] + 0.5, 0), 1);
            contact->weight[c] *= c >> d & 1 ? share : 1 - share;
        }
    }
    return sm_normalize(contact->out);
}

/* Is p out of the box of the corners of a cell of body b? */
static bool beyond(const RefCollide *twin, long b, long k, const double p[3])
{
    const SmCollideRest *rest = twin->rest;
    for (int d = 0; d < 3 && rest->carriers > 1; d++) {
        double low = INFINITY, high = -INFINITY;
        for (int c = 0; c < rest->carriers; c++) {
            double at = twin->x[b * rest->nodes + rest->carrier[k * rest->carriers + c]][d];
            low = fmin(low, at);
            high = fmax(high, at);
        }
        if (p[d] < low || p[d] > high) return true;
    }
    return false;
}

static void find_surface(RefCollide *twin)
{
    const SmCollideRest *rest = twin->rest;
    for (long k = 0; k < rest->cells; k++) {
        if (twin->level[k] < SM_COLLIDE_LAYERS) twin->widest = fmax(twin->widest, rest->edge[k]);
        for (int side = 0; side < SM_COLLIDE_FACES; side++)
            for (int c = 0; c < rest->carriers; c++)
                if (rest->across[k][side] < 0 &&
                    (rest->carriers == 1 || (c >> side / 2 & 1) == side % 2))
                    twin->surface[rest->carrier[k * rest->carriers + c]] = true;
    }
}

RefCollide *ref_collide_start(const SmCollideRest *rest, const SmCollideParams *params, long bodies,
                              const double (*x)[3], const double (*frame)[9])
{
    RefCollide *twin = sm_alloc(1, sizeof *twin);
    size_t nodes = (size_t)rest->nodes;
    *twin = (RefCollide){.rest = rest,
                         .params = params,
                         .bodies = bodies,
                         .x = x,
                         .frame = frame,
                         .level = find_levels(rest),
                         .surface = sm_alloc(nodes, sizeof(bool)),
                         .place = sm_alloc((size_t)(bodies * rest->cells), sizeof(Place)),
                         .from = -1,
                         .way = sm_alloc(nodes, sizeof(double)),
                         .around = sm_alloc(nodes, sizeof(int))};
    find_surface(twin);
    for (long cell = 0; cell < bodies * rest->cells; cell++) {
        long first = cell / rest->cells * rest->nodes;
        place_cell(rest, cell % rest->cells, x + first, frame ? frame + first : NULL,
                   twin->place[cell].middle, twin->place[cell].F);
    }
    return twin;
}

void ref_collide_free(RefCollide *twin)
{
    sm_free_all(twin->level, twin->surface, twin->place, twin->way, twin->around, twin);
}

bool ref_collide_outer(const RefCollide *twin, long number)
{
    return twin->surface[number % twin->rest->nodes];
}

bool ref_collide_at(RefCollide *twin, long number, const double p[3], long cell,
                    RefContact *contact)
{
    const SmCollideRest *rest = twin->rest;
    int node = (int)(number % rest->nodes);
    long b = cell / rest->cells, k = cell % rest->cells;
    bool same = number / rest->nodes == b;
    if (twin->level[k] >= SM_COLLIDE_LAYERS || !twin->surface[node]) return false;
    if (!(same ? twin->params->self : twin->params->bodies)) return false;
    if (!meet(twin, b, k, node, p, contact) || (same && near(twin, node, k))) return false;
    contact->node = (int)number;
    contact->cell = (int)cell;
    contact->beyond = beyond(twin, b, k, p);
    return true;
}

long ref_collide_node(RefCollide *twin, long number, RefContact **contact, long count)
{
    for (long cell = 0; cell < twin->bodies * twin->rest->cells; cell++) {
        RefContact next = {0};
        if (!ref_collide_at(twin, number, twin->x[number], cell, &next)) continue;
        *contact = sm_realloc(*contact, (size_t)count + 1, sizeof **contact);
        (*contact)[count++] = next;
    }
    return count;
}

bool ref_collide_near(const SmCollideRest *rest, int node, int cell)
{
    static const SmCollideParams none;
    RefCollide *twin = ref_collide_start(rest, &none, 0, NULL, NULL);
    bool result = near(twin, node, cell);
    ref_collide_free(twin);
    return result;
}
