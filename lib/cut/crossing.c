#include "crossing.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../box.h"
#include "../predicates.h"

enum { CHUNK = 16 }; /* triangles of the solid whose common box is looked at first */

static SmBox box_of(const SmMesh *mesh, long from, long to)
{
    SmBox box = sm_no_box();
    for (long t = from; t < to; t++)
        for (int i = 0; i < 3; i++) sm_box_add(&box, mesh->position[mesh->triangle[t][i]]);
    return box;
}

/* Are all corners of a triangle beyond the same side of a box? */
static bool beyond(const SmMesh *mesh, const int triangle[3], const SmBox *box)
{
    const double *p = mesh->position[triangle[0]], *q = mesh->position[triangle[1]];
    const double *r = mesh->position[triangle[2]];
    for (int d = 0; d < 3; d++) {
        if (p[d] < box->low[d] && q[d] < box->low[d] && r[d] < box->low[d]) return true;
        if (p[d] > box->high[d] && q[d] > box->high[d] && r[d] > box->high[d]) return true;
    }
    return false;
}

void sm_crossing_corners(const SmCrossing *c, long face, int corner[3])
{
    if (face < c->candidates) {
        const int *t = c->surface->triangle[c->candidate[face]];
        for (int i = 0; i < 3; i++) corner[i] = t[c->inside_out ? (3 - i) % 3 : i];
    } else {
        const int *t = c->solid->triangle[face - c->candidates];
        for (int i = 0; i < 3; i++) corner[i] = t[i] + (int)c->surface->vertex_count;
    }
}

static void find_candidates(SmCrossing *c, const SmBox *whole)
{
    long room = 0;
    for (long t = 0; t < c->surface->triangle_count; t++) {
        if (beyond(c->surface, c->surface->triangle[t], whole)) continue;
        sm_make_room(c->candidate, room, c->candidates + 1);
        c->candidate[c->candidates++] = (int)t;
    }
    c->faces = c->candidates + c->solid->triangle_count;
}

/* Where the slot of an edge and a face is, or would be. */
static long find_slot(const SmCrossing *c, int low, int high, int face)
{
    uint32_t hash =
        (uint32_t)low * 73856093u ^ (uint32_t)high * 19349663u ^ (uint32_t)face * 83492791u;
    long slot = (long)((hash ^ hash >> 15) & (uint32_t)(c->slots - 1));
    for (; c->slot[slot] >= 0; slot = (slot + 1) & (c->slots - 1)) {
        const SmCrossingPoint *p = &c->point[c->slot[slot]];
        if (p->low == low && p->high == high && p->face == face) break;
    }
    return slot;
}

static void grow_points(SmCrossing *c)
{
    c->point_room = c->point_room ? 2 * c->point_room : 64;
    c->point = sm_realloc(c->point, (size_t)c->point_room, sizeof *c->point);
    c->slots = 2 * c->point_room;
    c->slot = sm_realloc(c->slot, (size_t)c->slots, sizeof *c->slot);
    memset(c->slot, -1, (size_t)c->slots * sizeof *c->slot);
    for (long i = 0; i < c->points; i++)
        c->slot[find_slot(c, c->point[i].low, c->point[i].high, c->point[i].face)] = (int)i;
}

/* Height of a point above a plane through p with that normal, of no matter what length. */
static long double height(const long double normal[3], const double p[3], const double x[3])
{
    long double sum = 0;
    for (int d = 0; d < 3; d++) sum += normal[d] * ((long double)x[d] - p[d]);
    return sum;
}

static void locate(const SmCrossing *c, SmCrossingPoint *point)
{
    int corner[3];
    long double u[3], v[3], normal[3];
    sm_crossing_corners(c, point->face, corner);
    const double *p = sm_crossing_at(c, corner[0]), *q = sm_crossing_at(c, corner[1]);
    const double *r = sm_crossing_at(c, corner[2]);
    const double *low = sm_crossing_at(c, point->low), *high = sm_crossing_at(c, point->high);
    for (int d = 0; d < 3; d++) {
        u[d] = (long double)q[d] - p[d];
        v[d] = (long double)r[d] - p[d];
    }
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        normal[d] = u[e] * v[f] - u[f] * v[e];
    }
    long double above = fabsl(height(normal, p, low)), below = fabsl(height(normal, p, high));
    long double along = above + below > 0 ? above / (above + below) : 0.5L;
    point->along = (double)along;
    for (int d = 0; d < 3; d++)
        point->at[d] = (double)(low[d] + along * ((long double)high[d] - low[d]));
}

static int add_point(SmCrossing *c, int u, int v, int face)
{
    if (2 * c->points >= c->point_room) grow_points(c);
    int low = u < v ? u : v, high = u < v ? v : u;
    long slot = find_slot(c, low, high, face);
    if (c->slot[slot] < 0) {
        c->slot[slot] = (int)c->points;
        c->point[c->points] = (SmCrossingPoint){.low = low, .high = high, .face = face};
        locate(c, &c->point[c->points++]);
    }
    return c->slot[slot];
}

/* Two faces: corners, places, and on which side of the other face's plane every corner is. */
typedef struct {
    int face[2], corner[2][3], side[2][3];
    const double *at[2][3];
} Pair;

/* Sides of one face's corners; false where one is in the plane, unless the plane is none: then all
 * count as above, and nothing passes through the face. */
static bool find_sides(Pair *pair, int of)
{
    const double *const *plane = pair->at[1 - of];
    int zeros = 0;
    for (int i = 0; i < 3; i++) {
        pair->side[of][i] = sm_orient3(plane[0], plane[1], plane[2], pair->at[of][i]);
        zeros += pair->side[of][i] == 0;
    }
    if (zeros == 3)
        for (int i = 0; i < 3; i++) pair->side[of][i] = 1;
    return zeros == 0 || zeros == 3;
}

static bool one_side(const int side[3])
{
    return side[0] == side[1] && side[1] == side[2];
}

/* 1 where edge i of face `of` passes through the other, 0 where it does not, -1 where it touches an
 * edge of it. */
static int passes(const Pair *pair, int of, int i)
{
    const double *u = pair->at[of][i], *v = pair->at[of][(i + 1) % 3];
    if (pair->side[of][i] == pair->side[of][(i + 1) % 3]) return 0;
    int way[3];
    for (int k = 0; k < 3; k++) {
        way[k] = sm_orient3(u, v, pair->at[1 - of][k], pair->at[1 - of][(k + 1) % 3]);
        if (way[k] == 0) return -1;
    }
    return one_side(way);
}

/* The segment in which two faces meet, if they do. Along it, left on the solid's face is above the
 * surface's: it starts where the round of a solid's face goes down through the surface's, or the
 * round of a surface's face comes up out of the solid's. */
static bool meet_faces(SmCrossing *c, Pair *pair)
{
    int end[2] = {-1, -1};
    if (!find_sides(pair, 0)) return false;
    if (one_side(pair->side[0])) return true;
    if (!find_sides(pair, 1)) return false;
    for (int n = 0; n < 6; n++) {
        int of = n / 3, i = n % 3, through = passes(pair, of, i);
        if (through < 0) return false;
        if (through == 0) continue;
        int which = (pair->side[of][i] > 0) == (of == 0);
        if (end[which] >= 0) return false;
        end[which] =
            add_point(c, pair->corner[of][i], pair->corner[of][(i + 1) % 3], pair->face[1 - of]);
    }
    if ((end[0] < 0) != (end[1] < 0)) return false;
    if (end[0] < 0) return true;
    sm_make_room(c->segment, c->segment_room, c->segments + 1);
    c->segment[c->segments++] = (SmCrossingSegment){{pair->face[0], pair->face[1]}, end[0], end[1]};
    return true;
}

static void take_face(const SmCrossing *c, Pair *pair, int which, long face)
{
    pair->face[which] = (int)face;
    sm_crossing_corners(c, face, pair->corner[which]);
    for (int i = 0; i < 3; i++) pair->at[which][i] = sm_crossing_at(c, pair->corner[which][i]);
}

static bool meet_all(SmCrossing *c, const SmBox *chunk, const SmBox *box)
{
    long count = c->solid->triangle_count;
    Pair pair;
    for (long f = 0; f < c->candidates; f++) {
        SmBox own = box_of(c->surface, c->candidate[f], c->candidate[f] + 1);
        take_face(c, &pair, 0, f);
        for (long t = 0; t < count; t++) {
            if (t % CHUNK == 0 && !sm_boxes_meet(&own, &chunk[t / CHUNK])) {
                t += CHUNK - 1;
                continue;
            }
            if (!sm_boxes_meet(&own, &box[t])) continue;
            take_face(c, &pair, 1, c->candidates + t);
            if (!meet_faces(c, &pair)) return false;
        }
    }
    return true;
}

bool sm_crossing_find(const SmMesh *surface, bool inside_out, const SmMesh *solid,
                      SmCrossing *crossing)
{
    long count = solid->triangle_count, chunks = (count + CHUNK - 1) / CHUNK;
    *crossing = (SmCrossing){.surface = surface, .solid = solid, .inside_out = inside_out};
    SmBox whole = box_of(solid, 0, count);
    SmBox *box = sm_alloc((size_t)(count + chunks), sizeof *box), *chunk = box + count;
    for (long t = 0; t < count; t++) box[t] = box_of(solid, t, t + 1);
    for (long k = 0; k < chunks; k++)
        chunk[k] = box_of(solid, k * CHUNK, (k + 1) * CHUNK < count ? (k + 1) * CHUNK : count);
    find_candidates(crossing, &whole);
    bool general = meet_all(crossing, chunk, box);
    free(box);
    if (!general) sm_crossing_free(crossing);
    return general;
}

void sm_crossing_free(SmCrossing *crossing)
{
    sm_free_all(crossing->candidate, crossing->point, crossing->segment, crossing->slot);
    *crossing = (SmCrossing){0};
}
