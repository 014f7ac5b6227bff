#include "contacts.h"

#include <stdlib.h>

#include "../lib/collide.h"
#include "../lib/rotate_lanes.h"
#include "outline.h"

struct OctContacts {
    Oct *oct;
    SmCollide *collide;
    double (*x)[3];     /* [instances * leaves] finest cells */
    double (*frame)[9]; /* [instances * leaves] rotations of the leaves' regions */
};

static void make_room(OctContacts *k)
{
    size_t all = (size_t)(k->oct->instances * k->oct->leaves);
    free(k->x);
    free(k->frame);
    k->x = sm_alloc(all, sizeof *k->x);
    k->frame = sm_alloc(all, sizeof *k->frame);
}

OctContacts *oct_contacts_build(Oct *oct, const OctStructure *structure,
                                const SmCollideParams *params)
{
    if (!params->self && !(params->bodies && oct->instances > 1)) return NULL;
    OctContacts *k = sm_alloc(1, sizeof *k);
    OctOutline outline;
    k->oct = oct;
    make_room(k);
    oct_outline_build(structure, &outline);
    k->collide = sm_collide_build(&outline.rest, params, oct->instances, oct->params.threads);
    oct_outline_free(&outline);
    return k;
}

void oct_contacts_rebuild(OctContacts *k, const OctStructure *structure)
{
    OctOutline outline;
    make_room(k);
    oct_outline_build(structure, &outline);
    sm_collide_describe(k->collide, &outline.rest);
    oct_outline_free(&outline);
}

void oct_contacts_free(OctContacts *k)
{
    if (!k) return;
    sm_collide_free(k->collide);
    free(k->x);
    free(k->frame);
    free(k);
}

static void read_body(const OctContacts *k, const OctState *body, double (*x)[3],
                      double (*frame)[9])
{
    long leaves = k->oct->leaves;
    for (long first = 0; first < leaves; first += SM_LANES) {
        vec R[9];
        const real *from = body->x + first * 3;
        last_load(body->last + first * 6, R);
        for (long lane = 0; lane < SM_LANES && first + lane < leaves; lane++) {
            for (int d = 0; d < 3; d++)
                x[first + lane][d] = body->origin[d] + (double)from[d * SM_LANES + lane];
            for (int i = 0; i < 9; i++) frame[first + lane][i] = (double)R[i][lane];
        }
    }
}

static void read_velocities(const OctContacts *k)
{
    SmCollide *c = k->collide;
    for (long i = 0; i < c->node_count; i++) {
        const OctState *body = &k->oct->body[c->node[i] / k->oct->leaves];
        for (int d = 0; d < 3; d++)
            c->v[i][d] = (double)body->v[oct_index(c->node[i] % k->oct->leaves, d)];
    }
}

void oct_contacts_before(OctContacts *k)
{
    long leaves = k->oct->leaves;
    for (long b = 0; b < k->oct->instances; b++)
        read_body(k, &k->oct->body[b], k->x + b * leaves, k->frame + b * leaves);
    sm_collide_find(k->collide, (const double(*)[3])k->x, (const double(*)[9])k->frame);
    read_velocities(k);
    sm_collide_begin(k->collide);
}

void oct_contacts_after(OctContacts *k)
{
    SmCollide *c = k->collide;
    read_velocities(k);
    sm_collide_respond(c);
    for (long i = 0; i < c->node_count; i++) {
        OctState *body = &k->oct->body[c->node[i] / k->oct->leaves];
        for (int d = 0; d < 3; d++) {
            long at = oct_index(c->node[i] % k->oct->leaves, d);
            body->v[at] += (real)c->v[i][d];
            body->x[at] += (real)c->v[i][d];
        }
    }
}

void oct_contacts_fix(OctContacts *k, long count, const long *node)
{
    sm_collide_fix(k->collide, count, node);
}

long oct_contacts_count(const OctContacts *k)
{
    return k->collide->contact_count;
}

long oct_contacts_bytes(const OctContacts *k)
{
    long all = k->oct->instances * k->oct->leaves;
    return sm_collide_bytes(k->collide) + all * (long)(sizeof *k->x + sizeof *k->frame);
}
