#include "collide.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/error.h"
#include "../lib/vector.h"

typedef struct {
    const SmCollideRest *rest;
    int *level;    /* [cells] */
    bool *surface; /* [nodes] carries an outer face */
    char *near;    /* [nodes][cells] */
} Known;

int *ref_collide_levels(const SmCollideRest *rest)
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

/* The outer faces, as 6 cell + side, that the depth in cell k is measured to: its own, or of those
 * of the cells across its faces one level up, the nearest to its centre. Returns how many. */
static int faces_of(const Known *known, long k, int face[SM_COLLIDE_FACES])
{
    const SmCollideRest *rest = known->rest;
    int count = 0, all = 0, any[SM_COLLIDE_FACES * SM_COLLIDE_FACES];
    double nearest = DBL_MAX, point[3];
    for (int side = 0; side < SM_COLLIDE_FACES; side++) {
        int other = rest->across[k][side];
        if (known->level[k] == 0) {
            if (other < 0) face[count++] = (int)(6 * k) + side;
        } else if (other >= 0 && known->level[other] == known->level[k] - 1) {
            all += faces_of(known, other, any + all);
        }
    }
    for (int i = 0; i < all; i++)
        nearest =
            fmin(nearest, face_distance(rest, any[i] / 6, any[i] % 6, rest->centre[k], point));
    for (int last = -1, next = 0; next != INT_MAX && count < SM_COLLIDE_FACES; last = next) {
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

static bool depth_at(const Known *known, long k, const double q[3], double radius, double *depth,
                     double out[3])
{
    const SmCollideRest *rest = known->rest;
    int face[SM_COLLIDE_FACES], count = faces_of(known, k, face);
    double best = DBL_MAX, point[3];
    bool inside = true;
    for (int d = 0; d < 3; d++) inside &= fabs(q[d] - rest->centre[k][d]) <= rest->edge[k] / 2;
    if (!inside && known->level[k] > 0) return false;
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

/* Shortest ways from a node, half cells, through nodes that are not farther off than `window`:
 * Bellman and Ford. */
static void ways_from(const SmCollideRest *rest, int node, double window, double *way)
{
    for (long i = 0; i < rest->nodes; i++) way[i] = i == node ? 0 : DBL_MAX;
    for (bool changed = true; changed;) {
        changed = false;
        for (long i = 0; i < rest->nodes; i++)
            for (long e = rest->first[i]; e < rest->first[i + 1]; e++) {
                int to = rest->to[e];
                if (way[i] + rest->length[e] >= way[to] ||
                    max_norm(rest->x0[node], rest->x0[to]) > window)
                    continue;
                way[to] = way[i] + rest->length[e];
                changed = true;
            }
    }
}

static double widest_of(const Known *known)
{
    double widest = 0;
    for (long k = 0; k < known->rest->cells; k++)
        if (known->level[k] < SM_COLLIDE_LAYERS) widest = fmax(widest, known->rest->edge[k]);
    return widest;
}

static bool near(const Known *known, int node, long k, const double *way)
{
    const SmCollideRest *rest = known->rest;
    double apart = sm_collide_apart(size_of(rest, node), rest->edge[k]), least = DBL_MAX, depth,
           out[3];
    if (max_norm(rest->x0[node], rest->centre[k]) - rest->edge[k] / 2 > apart + 1e-9) return false;
    for (int c = 0; c < rest->carriers; c++)
        least = fmin(least, way[rest->carrier[k * rest->carriers + c]]);
    double through = least / 2 - (rest->carriers == 1 ? rest->edge[k] / 2 : 0);
    if (through <= SM_COLLIDE_AROUND * (apart + 1e-9)) return true;
    return depth_at(known, k, rest->x0[node], radius_of(rest, node), &depth, out);
}

static void know(const SmCollideRest *rest, Known *known)
{
    *known = (Known){.rest = rest,
                     .level = ref_collide_levels(rest),
                     .surface = sm_alloc((size_t)rest->nodes, sizeof(bool)),
                     .near = sm_alloc((size_t)(rest->nodes * rest->cells), 1)};
    for (long k = 0; k < rest->cells; k++)
        for (int side = 0; side < SM_COLLIDE_FACES; side++)
            for (int c = 0; c < rest->carriers; c++)
                if (rest->across[k][side] < 0 &&
                    (rest->carriers == 1 || (c >> side / 2 & 1) == side % 2))
                    known->surface[rest->carrier[k * rest->carriers + c]] = true;
    double widest = widest_of(known), *way = sm_alloc((size_t)rest->nodes, sizeof *way);
    for (int i = 0; i < rest->nodes; i++) {
        double most = sm_collide_apart(size_of(rest, i), widest) + 1e-9;
        ways_from(rest, i, most + widest, way);
        for (long k = 0; k < rest->cells; k++)
            known->near[i * rest->cells + k] = near(known, i, k, way);
    }
    free(way);
}

static void forget(Known *known)
{
    free(known->level);
    free(known->surface);
    free(known->near);
}

bool ref_collide_near(const SmCollideRest *rest, int node, int cell)
{
    Known known;
    know(rest, &known);
    bool result = known.near[node * rest->cells + cell];
    forget(&known);
    return result;
}

/* Middle and axes of a cell, by columns. */
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

static bool meet(const Known *known, long k, int node, const double p[3], const double (*x)[3],
                 const double (*frame)[9], RefContact *contact)
{
    const SmCollideRest *rest = known->rest;
    double middle[3], F[9], off[3], y[3], q[3], out[3], transposed[9];
    place_cell(rest, k, x, frame, middle, F);
    for (int i = 0; i < 3; i++) {
        if (fabs(F[3 * i]) + fabs(F[3 * i + 1]) + fabs(F[3 * i + 2]) >= SM_COLLIDE_LONGEST)
            return false;
        off[i] = p[i] - middle[i];
        for (int d = 0; d < 3; d++) transposed[3 * d + i] = F[3 * i + d];
    }
    if (!solve(F, off, y)) return false;
    for (int d = 0; d < 3; d++) q[d] = rest->centre[k][d] + y[d];
    if (!depth_at(known, k, q, radius_of(rest, node), &contact->depth, out)) return false;
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

long ref_collide_find(const SmCollideRest *rest, const SmCollideParams *params, long bodies,
                      const double (*x)[3], const double (*frame)[9], RefContact **contact)
{
    Known known;
    long count = 0, room = 0;
    know(rest, &known);
    *contact = NULL;
    for (long cell = 0; cell < bodies * rest->cells; cell++)
        for (long number = 0; number < bodies * rest->nodes; number++) {
            long b = cell / rest->cells, k = cell % rest->cells, node = number % rest->nodes;
            bool same = number / rest->nodes == b;
            if (known.level[k] >= SM_COLLIDE_LAYERS || !known.surface[node]) continue;
            if (same ? !params->self || known.near[node * rest->cells + k] : !params->bodies)
                continue;
            if (count == room) {
                room = 2 * room + 16;
                *contact = sm_realloc(*contact, (size_t)room, sizeof **contact);
            }
            RefContact *next = *contact + count;
            if (!meet(&known, k, (int)node, x[number], x + b * rest->nodes,
                      frame ? frame + b * rest->nodes : NULL, next))
                continue;
            next->node = (int)number;
            next->cell = (int)cell;
            count++;
        }
    forget(&known);
    return count;
}
