#include "collide_rest.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"

#define SLACK SM_COLLIDE_SLACK

/* The flood's own: faces by number 6 cell + side. */
typedef struct {
    const SmCollideRest *rest;
    int *level; /* [cells] SM_COLLIDE_LAYERS for what was not reached */
    long *first;
    int *count, *face; /* [cells], [cells][SM_COLLIDE_FACES] */
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
static double to_face(const SmCollideFace *face, const double q[3], double way[3])
{
    double square = 0;
    for (int d = 0; d < 3; d++) {
        double off = q[d] - face->centre[d], half = d == face->side / 2 ? 0 : face->half;
        double nearest = off < -half ? -half : off > half ? half : off;
        way[d] = nearest - off;
        square += way[d] * way[d];
    }
    return sqrt(square);
}

/* Adds a face to the list of a cell that keeps the nearest ones. */
static void offer(Flood *flood, int cell, int number, double *nearest)
{
    SmCollideFace face;
    double way[3];
    int *list = flood->face + (long)cell * SM_COLLIDE_FACES;
    face_of(flood->rest, number, &face);
    double distance = to_face(&face, flood->rest->centre[cell], way);
    if (distance > *nearest + SLACK) return;
    if (distance < *nearest - SLACK) {
        flood->count[cell] = 0;
        *nearest = distance;
    }
    int at = flood->count[cell];
    for (int i = 0; i < at; i++)
        if (list[i] == number) return;
    bool full = at == SM_COLLIDE_FACES; /* then those of the lowest numbers stay */
    if (full && number > list[at - 1]) return;
    if (full)
        at--;
    else
        flood->count[cell]++;
    for (; at > 0 && list[at - 1] > number; at--) list[at] = list[at - 1];
    list[at] = number;
}

static void flood_layer(Flood *flood, int level)
{
    const SmCollideRest *rest = flood->rest;
    for (int cell = 0; cell < rest->cells; cell++) {
        double nearest = DBL_MAX;
        if (flood->level[cell] < level) continue;
        for (int side = 0; side < SM_COLLIDE_FACES; side++) {
            int other = rest->across[cell][side];
            if (other < 0 || flood->level[other] != level - 1) continue;
            flood->level[cell] = level;
            for (int i = 0; i < flood->count[other]; i++)
                offer(flood, cell, flood->face[(long)other * SM_COLLIDE_FACES + i], &nearest);
        }
    }
}

static void flood(const SmCollideRest *rest, Flood *result)
{
    size_t cells = (size_t)rest->cells;
    *result = (Flood){.rest = rest,
                      .level = sm_alloc(cells, sizeof(int)),
                      .count = sm_alloc(cells, sizeof(int)),
                      .face = sm_alloc(cells * SM_COLLIDE_FACES, sizeof(int))};
    for (int cell = 0; cell < rest->cells; cell++) {
        for (int side = 0; side < SM_COLLIDE_FACES; side++)
            if (rest->across[cell][side] < 0)
                result->face[(long)cell * SM_COLLIDE_FACES + result->count[cell]++] =
                    cell * SM_COLLIDE_FACES + side;
        result->level[cell] = result->count[cell] ? 0 : SM_COLLIDE_LAYERS;
    }
    for (int level = 1; level < SM_COLLIDE_LAYERS; level++) flood_layer(result, level);
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
            face_of(rest, flood->face[(long)k * SM_COLLIDE_FACES + i], &shape->face[faces++]);
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
    double best = DBL_MAX, way[3], half = cell->edge / 2;
    bool inside = true;
    for (int d = 0; d < 3; d++) inside &= fabs(q[d] - cell->centre[d]) <= half;
    if (!inside && (radius <= 0 || cell->level)) return false;
    for (long f = cell->face; f < cell->face_end; f++) {
        const SmCollideFace *face = &shape->face[f];
        int axis = face->side / 2;
        double sign = face->side % 2 ? 1 : -1, distance = to_face(face, q, way);
        if (!inside && !(sign * way[axis] < 0)) continue; /* not in front of it */
        if (!(distance < best)) continue;
        best = distance;
        for (int d = 0; d < 3; d++)
            out[d] = distance > SLACK ? (inside ? 1 : -1) * way[d] / distance : (d == axis) * sign;
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
    free(depths.level);
    free(depths.count);
    free(depths.face);
    keep_nodes(rest, shape);
    keep_surface(shape);
}

void sm_collide_shape_free(SmCollideShape *shape)
{
    void *all[] = {shape->cell, shape->face,   shape->surface,     shape->x0,
                   shape->size, shape->radius, shape->inverse_mass};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *shape = (SmCollideShape){0};
}

long sm_collide_shape_bytes(const SmCollideShape *shape)
{
    size_t bytes = (size_t)shape->cell_count * sizeof *shape->cell +
                   (size_t)shape->face_count * sizeof *shape->face +
                   (size_t)shape->surface_count * sizeof(int) +
                   (size_t)shape->nodes * 6 * sizeof(double);
    return (long)bytes;
}
