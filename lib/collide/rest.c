#include "rest.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"

#define SLACK SM_COLLIDE_SLACK

/* The flood's own: faces by number 6 cell + side. */
/* Faces of the six cells beside one that may all be as near to its middle. */
enum { NEAREST = SM_COLLIDE_FACES * SM_COLLIDE_FACES };

typedef struct {
    const SmCollideRest *rest;
    int *level; /* [cells] SM_COLLIDE_LAYERS for what was not reached */
    long *first;
    int *count, *face; /* [cells], [faces] from first[cell] on */
    long faces, room;
} Flood;

static void face_of(const SmCollideRest *rest, int number, SmCollideFace *face)
{
    int cell = number / SM_COLLIDE_FACES, side = number % SM_COLLIDE_FACES;
    face->side = side;
    face->half = rest->edge[cell] / 2;
    memcpy(face->centre, rest->centre[cell], sizeof face->centre);
    face->centre[side / 2] += side % 2 ? face->half : -face->half;
}

/* From q to the nearest point of a face. */
static double to_face(const SmCollideFace *face, const double q[3], double offset[3])
{
    double square = 0;
    for (int d = 0; d < 3; d++) {
        double off = q[d] - face->centre[d], half = d == face->side / 2 ? 0 : face->half;
        double nearest = off < -half ? -half : off > half ? half : off;
        offset[d] = nearest - off;
        square += offset[d] * offset[d];
    }
    return sqrt(square);
}

/* Adds a face to the list of a cell that keeps the nearest ones, by rising number. */
static int offer(const SmCollideRest *rest, int cell, int number, double *nearest,
                 int list[NEAREST], int count)
{
    SmCollideFace face;
    double offset[3];
    face_of(rest, number, &face);
    double distance = to_face(&face, rest->centre[cell], offset);
    if (distance > *nearest + SLACK) return count;
    if (distance < *nearest - SLACK) {
        count = 0;
        *nearest = distance;
    }
    int at = count;
    for (; at > 0 && list[at - 1] > number; at--) list[at] = list[at - 1];
    list[at] = number;
    return count + 1;
}

static void keep_faces(Flood *flood, int cell, int level, int count, const int *list)
{
    flood->level[cell] = level;
    flood->first[cell] = flood->faces;
    flood->count[cell] = count;
    sm_make_room(flood->face, flood->room, flood->faces + count);
    memcpy(flood->face + flood->faces, list, (size_t)count * sizeof *list);
    flood->faces += count;
}

/* Of a cell without outer faces those of the cells across its own. */
static void flood_inwards(Flood *flood, int cell)
{
    double nearest = DBL_MAX;
    int list[NEAREST], count = 0;
    for (int side = 0; side < SM_COLLIDE_FACES; side++) {
        int other = flood->rest->across[cell][side];
        if (flood->level[other] > 0) continue;
        for (int i = 0; i < flood->count[other]; i++)
            count = offer(flood->rest, cell, flood->face[flood->first[other] + i], &nearest, list,
                          count);
    }
    if (count) keep_faces(flood, cell, 1, count, list);
}

_Static_assert(SM_COLLIDE_LAYERS == 2, "what is below the second layer is not flooded");
static void flood(const SmCollideRest *rest, Flood *result)
{
    size_t cells = (size_t)rest->cells;
    *result = (Flood){.rest = rest,
                      .level = sm_alloc(cells, sizeof(int)),
                      .first = sm_alloc(cells, sizeof(long)),
                      .count = sm_alloc(cells, sizeof(int))};
    for (int cell = 0; cell < rest->cells; cell++) {
        int list[SM_COLLIDE_FACES], count = 0;
        for (int side = 0; side < SM_COLLIDE_FACES; side++)
            if (rest->across[cell][side] < 0) list[count++] = cell * SM_COLLIDE_FACES + side;
        result->level[cell] = SM_COLLIDE_LAYERS;
        if (count) keep_faces(result, cell, 0, count, list);
    }
    for (int cell = 0; cell < rest->cells; cell++)
        if (result->level[cell] == SM_COLLIDE_LAYERS) flood_inwards(result, cell);
}

static void keep_cells(const Flood *flood, SmCollideShape *shape)
{
    const SmCollideRest *rest = flood->rest;
    for (int k = 0; k < rest->cells; k++) {
        shape->cell_count += flood->level[k] < SM_COLLIDE_LAYERS;
        shape->face_count += flood->count[k];
    }
    shape->cell = sm_alloc((size_t)shape->cell_count, sizeof *shape->cell);
    shape->face = sm_alloc((size_t)shape->face_count, sizeof *shape->face);
    long at = 0, faces = 0;
    for (int k = 0; k < rest->cells; k++) {
        if (flood->level[k] >= SM_COLLIDE_LAYERS) continue;
        SmCollideCell *cell = &shape->cell[at++];
        cell->number = k;
        cell->level = flood->level[k];
        cell->edge = rest->edge[k];
        memcpy(cell->centre, rest->centre[k], sizeof cell->centre);
        for (int c = 0; c < rest->carriers; c++)
            cell->carrier[c] = rest->carrier[(long)k * rest->carriers + c];
        cell->face = faces;
        for (int i = 0; i < flood->count[k]; i++)
            face_of(rest, flood->face[flood->first[k] + i], &shape->face[faces++]);
        cell->face_end = faces;
        shape->widest = fmax(shape->widest, cell->edge);
        shape->mean += cell->edge / (double)shape->cell_count;
    }
}

static void keep_nodes(const SmCollideRest *rest, SmCollideShape *shape)
{
    size_t nodes = (size_t)rest->nodes;
    shape->x0 = sm_alloc(nodes, sizeof *shape->x0);
    shape->size = sm_alloc(nodes, sizeof(double));
    shape->radius = sm_alloc(nodes, sizeof(double));
    shape->inverse_mass = sm_alloc(nodes, sizeof(double));
    memcpy(shape->x0, rest->x0, nodes * sizeof *shape->x0);
    for (size_t i = 0; i < nodes; i++) {
        shape->size[i] = rest->size ? rest->size[i] : 1;
        shape->radius[i] = rest->radius ? rest->radius[i] : 0;
        shape->inverse_mass[i] = rest->mass ? 1 / rest->mass[i] : 1;
        shape->thickest = fmax(shape->thickest, shape->radius[i]);
    }
}

/* Nodes at the corners of outer faces; of a cell with one carrier that. */
static void keep_surface(SmCollideShape *shape)
{
    char *outer = sm_alloc((size_t)shape->nodes, 1);
    for (long k = 0; k < shape->cell_count; k++) {
        const SmCollideCell *cell = &shape->cell[k];
        for (long f = cell->face; f < cell->face_end && !cell->level; f++)
            for (int c = 0; c < shape->carriers; c++) {
                int side = shape->face[f].side;
                if (shape->carriers == 1 || (c >> side / 2 & 1) == side % 2)
                    outer[cell->carrier[c]] = 1;
            }
    }
    for (long i = 0; i < shape->nodes; i++) shape->surface_count += outer[i];
    shape->surface = sm_alloc((size_t)shape->surface_count, sizeof(int));
    for (long i = 0, at = 0; i < shape->nodes; i++)
        if (outer[i]) shape->surface[at++] = (int)i;
    free(outer);
}

bool sm_collide_depth(const SmCollideShape *shape, const SmCollideCell *cell, const double q[3],
                      double radius, double *depth, double out[3])
{
    double best = DBL_MAX, offset[3], half = cell->edge / 2;
    bool inside = true;
    for (int d = 0; d < 3; d++) inside &= fabs(q[d] - cell->centre[d]) <= half;
    if (!inside && (radius <= 0 || cell->level)) return false;
    for (long f = cell->face; f < cell->face_end; f++) {
        const SmCollideFace *face = &shape->face[f];
        int axis = face->side / 2;
        double sign = face->side % 2 ? 1 : -1, distance = to_face(face, q, offset);
        if (!inside && !(sign * offset[axis] < 0)) continue; /* not in front of it */
        if (!(distance < best)) continue;
        best = distance;
        for (int d = 0; d < 3; d++)
            out[d] =
                distance > SLACK ? (inside ? 1 : -1) * offset[d] / distance : (d == axis) * sign;
    }
    *depth = inside ? radius + best : radius - best;
    return *depth > 0;
}

bool sm_collide_beside(const SmCollideShape *shape, int node, const SmCollideCell *cell)
{
    double most = 0;
    for (int d = 0; d < 3; d++) most = fmax(most, fabs(shape->x0[node][d] - cell->centre[d]));
    return most - cell->edge / 2 <= sm_collide_apart(shape->size[node], cell->edge) + SLACK;
}

void sm_collide_shape_build(const SmCollideRest *rest, SmCollideShape *shape)
{
    Flood depths;
    *shape = (SmCollideShape){.rest = *rest, .nodes = rest->nodes, .carriers = rest->carriers};
    flood(rest, &depths);
    keep_cells(&depths, shape);
    sm_free_all(depths.level, depths.first, depths.count, depths.face);
    keep_nodes(rest, shape);
    keep_surface(shape);
}

void sm_collide_shape_free(SmCollideShape *shape)
{
    sm_free_all(shape->cell, shape->face, shape->surface, shape->x0, shape->size, shape->radius,
                shape->inverse_mass);
    *shape = (SmCollideShape){0};
}

void sm_collide_paths_start(SmCollidePaths *paths, const SmCollideShape *shape)
{
    if (shape->nodes > paths->node_room) {
        sm_free_all(paths->distance, paths->queue, paths->queued, paths->reached);
        paths->node_room = shape->nodes + shape->nodes / 4;
        size_t room = (size_t)paths->node_room;
        paths->distance = sm_alloc(room, sizeof(int));
        paths->queue = sm_alloc(room, sizeof(int));
        paths->queued = sm_alloc(room, 1);
        paths->reached = sm_alloc(room, sizeof(int));
    }
    for (long i = 0; i < shape->nodes; i++) paths->distance[i] = INT32_MAX;
    if (paths->answers) memset(paths->answer, 0, (size_t)paths->room * sizeof *paths->answer);
    paths->answers = paths->reached_count = 0;
}

void sm_collide_paths_free(SmCollidePaths *paths)
{
    sm_free_all(paths->answer, paths->distance, paths->queue, paths->queued, paths->reached);
    *paths = (SmCollidePaths){0};
}

static double apart(const double a[3], const double b[3])
{
    double x = fabs(a[0] - b[0]), y = fabs(a[1] - b[1]), z = fabs(a[2] - b[2]);
    double most = x > y ? x : y;
    return most > z ? most : z;
}

/* A path in half cells that ends at a carrier of a cell. */
static double to_cell(const SmCollideShape *shape, const SmCollideCell *cell, int path)
{
    return 0.5 * path - (shape->carriers == 1 ? cell->edge / 2 : 0);
}

static bool touches(const SmCollideShape *shape, int node, const SmCollideCell *cell)
{
    double depth, out[3];
    return sm_collide_depth(shape, cell, shape->x0[node], shape->radius[node], &depth, out);
}

/* How long a path may be that holds a node and a cell together. */
static double longest(const SmCollideShape *shape, int node, const SmCollideCell *cell)
{
    return SM_COLLIDE_AROUND * (sm_collide_apart(shape->size[node], cell->edge) + SM_COLLIDE_SLACK);
}

/* What one search needs. */
typedef struct {
    const SmCollideShape *shape;
    const SmCollideCell *cell;
    int from;
    double window;  /* paths lead through nodes that near */
    double most;    /* longest path to a carrier that counts, half cells */
    double nearest; /* cells by which a carrier may be nearer than the cell's centre */
} Search;

static bool carries(const Search *s, int node)
{
    for (int c = 0; c < s->shape->carriers; c++)
        if (s->cell->carrier[c] == node) return true;
    return false;
}

/* Whether the path to a node is part of one that may be short enough. */
static bool leads(const Search *s, int node, int path)
{
    const double(*x)[3] = s->shape->rest.x0;
    return path + 2 * (apart(x[node], s->cell->centre) - s->nearest) <= s->most &&
           apart(x[s->from], x[node]) <= s->window;
}

static void forget(SmCollidePaths *paths)
{
    for (long i = 0; i < paths->reached_count; i++) {
        paths->distance[paths->reached[i]] = INT32_MAX;
        paths->queued[paths->reached[i]] = 0;
    }
    paths->reached_count = 0;
}

/* Whether a path is short enough. Label-correcting search: whether there is one does not depend on
 * the order. */
static bool find_path(SmCollidePaths *paths, const Search *s)
{
    const SmCollideRest *rest = &s->shape->rest;
    long head = 0, tail = 0, filled = 1;
    forget(paths);
    if (!leads(s, s->from, 0)) return false;
    paths->distance[s->from] = 0;
    paths->reached[paths->reached_count++] = paths->queue[tail++] = s->from;
    for (; filled; filled--) {
        int i = paths->queue[head];
        if (++head == rest->nodes) head = 0;
        paths->queued[i] = 0;
        for (long e = rest->first[i]; e < rest->first[i + 1]; e++) {
            int j = rest->to[e], d = paths->distance[i] + rest->length[e];
            if (d >= paths->distance[j] || !leads(s, j, d)) continue;
            if (carries(s, j)) return true;
            if (paths->distance[j] == INT32_MAX) paths->reached[paths->reached_count++] = j;
            paths->distance[j] = d;
            if (paths->queued[j]) continue;
            paths->queued[j] = 1;
            if (tail == rest->nodes) tail = 0;
            paths->queue[tail++] = j;
            filled++;
        }
    }
    return false;
}

/* Whether a node and a cell beside it, which it does not carry, may collide. */
static bool far_apart(SmCollidePaths *paths, const SmCollideShape *shape, int node,
                      const SmCollideCell *cell)
{
    double window = sm_collide_apart(shape->size[node], shape->widest) + SM_COLLIDE_SLACK;
    double least = to_cell(shape, cell, 0);
    Search s = {.shape = shape,
                .cell = cell,
                .from = node,
                .window = window + shape->widest,
                .most = 2 * (longest(shape, node, cell) - least),
                .nearest = shape->carriers == 1 ? 0 : cell->edge / 2};
    return !find_path(paths, &s) && !touches(shape, node, cell);
}

/* Where the answer about a node and a cell (from 1) is in the table, or would be. */
static SmCollideAnswer *look_up(const SmCollidePaths *paths, int node, int cell)
{
    uint64_t key = ((uint64_t)(uint32_t)node << 32 | (uint32_t)cell) * 0x9e3779b97f4a7c15u;
    long at = (long)(key >> 32) & (paths->room - 1);
    while (paths->answer[at].cell &&
           (paths->answer[at].cell != cell || paths->answer[at].node != node))
        at = (at + 1) & (paths->room - 1);
    return &paths->answer[at];
}

/* Makes room for another answer. */
static void make_room(SmCollidePaths *paths)
{
    SmCollideAnswer *old = paths->answer;
    long room = paths->room;
    if (2 * (paths->answers + 1) <= room) return;
    paths->room = room ? 2 * room : 256;
    paths->answer = sm_alloc((size_t)paths->room, sizeof *paths->answer);
    for (long i = 0; i < room; i++)
        if (old[i].cell) *look_up(paths, old[i].node, old[i].cell) = old[i];
    free(old);
}

SmCollideRelation sm_collide_relation(const SmCollideShape *shape, int node, long c)
{
    const SmCollideCell *cell = &shape->cell[c];
    const SmCollideRest *rest = &shape->rest;
    if (!sm_collide_beside(shape, node, cell)) return SM_COLLIDE_MAY;
    for (int i = 0; i < shape->carriers; i++)
        if (cell->carrier[i] == node) return SM_COLLIDE_MUST_NOT;
    for (long e = rest->first[node]; shape->carriers == 1 && e < rest->first[node + 1]; e++)
        if (rest->to[e] == cell->carrier[0] &&
            to_cell(shape, cell, rest->length[e]) <= longest(shape, node, cell))
            return SM_COLLIDE_MUST_NOT;
    return SM_COLLIDE_UNKNOWN;
}

bool sm_collide_may(SmCollidePaths *paths, const SmCollideShape *shape, int node, long c)
{
    SmCollideRelation known = sm_collide_relation(shape, node, c);
    if (known != SM_COLLIDE_UNKNOWN) return known == SM_COLLIDE_MAY;
    make_room(paths);
    SmCollideAnswer *answer = look_up(paths, node, (int)c + 1);
    if (!answer->cell) {
        *answer =
            (SmCollideAnswer){node, (int)c + 1, far_apart(paths, shape, node, &shape->cell[c])};
        paths->answers++;
    }
    return answer->may;
}
