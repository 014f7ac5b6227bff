#include "contacts.h"

#include <stdlib.h>
#include <string.h>

#include "../lib/collide/collide.h"
#include "../lib/simd/rotate_lanes.h"
#include "surface/outline.h"

struct OctContacts {
    Oct *oct;
    SmCollide *collide;
    OctOutline outline;
    long nodes;         /* of one body */
    const int *leaf;    /* [nodes] the outline's */
    double (*x)[3];     /* [instances * nodes] finest cells */
    double (*frame)[9]; /* [instances * nodes] rotations of the nodes' regions */
};

static void make_room(OctContacts *k)
{
    size_t all = (size_t)(k->oct->instances * k->outline.rest.nodes);
    free(k->x);
    free(k->frame);
    k->x = sm_alloc(all, sizeof *k->x);
    k->frame = sm_alloc(all, sizeof *k->frame);
    k->nodes = k->outline.rest.nodes;
    k->leaf = k->outline.leaf;
}

OctContacts *oct_contacts_build(Oct *oct, const OctStructure *structure,
                                const SmCollideParams *params)
{
    if (!params->self && !(params->bodies && oct->instances > 1)) return NULL;
    OctContacts *k = sm_alloc(1, sizeof *k);
    k->oct = oct;
    oct_outline_build(structure, &k->outline);
    k->collide = sm_collide_build(&k->outline.rest, params, oct->instances,
                                  contact_rounding(oct->at_rest), oct->params.threads);
    make_room(k);
    return k;
}

void oct_contacts_rebuild(OctContacts *k, const OctStructure *structure)
{
    oct_outline_free(&k->outline);
    oct_outline_build(structure, &k->outline);
    sm_collide_describe(k->collide, &k->outline.rest);
    make_room(k);
}

void oct_contacts_free(OctContacts *k)
{
    if (!k) return;
    sm_collide_free(k->collide);
    oct_outline_free(&k->outline);
    sm_free_all(k->x, k->frame, k);
}

static void read_body(const OctContacts *k, const OctState *body, double (*x)[3],
                      double (*frame)[9])
{
    long block = -1;
    vec R[9];
    for (long n = 0; n < k->nodes; n++) {
        long leaf = k->leaf[n], lane = leaf % SM_LANES;
        if (leaf / SM_LANES != block) {
            block = leaf / SM_LANES;
            last_load(body->last + block * 6 * SM_LANES, R);
        }
        for (int d = 0; d < 3; d++)
            x[n][d] = oct_origin(k->oct, body, leaf)[d] + (double)body->x[oct_index(leaf, d)];
        for (int i = 0; i < 9; i++) frame[n][i] = (double)R[i][lane];
    }
}

static void read_velocities(const OctContacts *k)
{
    SmCollide *c = k->collide;
    for (long i = 0; i < c->node_count; i++) {
        const OctState *body = &k->oct->body[c->node[i] / k->nodes];
        for (int d = 0; d < 3; d++)
            c->v[i][d] = (double)body->v[oct_index(k->leaf[c->node[i] % k->nodes], d)];
    }
}

static void find(OctContacts *k)
{
    for (long b = 0; b < k->oct->instances; b++)
        read_body(k, &k->oct->body[b], k->x + b * k->nodes, k->frame + b * k->nodes);
    sm_collide_find(k->collide, (const double(*)[3])k->x, (const double(*)[9])k->frame);
}

long oct_contacts_list(OctContacts *k, double cell, double (*turn)[9], SmContact **contact)
{
    find(k);
    if (turn) memcpy(turn, k->frame, (size_t)(k->oct->instances * k->nodes) * sizeof *turn);
    return sm_collide_list(k->collide, cell, contact);
}

void oct_contacts_before(OctContacts *k)
{
    find(k);
    read_velocities(k);
    sm_collide_begin(k->collide);
}

void oct_contacts_after(OctContacts *k, Momentum *momentum)
{
    SmCollide *c = k->collide;
    read_velocities(k);
    sm_collide_respond(c);
    for (long i = 0; i < c->node_count; i++) {
        OctState *body = &k->oct->body[c->node[i] / k->nodes];
        long leaf = k->leaf[c->node[i] % k->nodes];
        MomentumChange change;
        oct_moved_from(k->oct, body, leaf, &change);
        for (int d = 0; d < 3; d++) {
            long at = oct_index(leaf, d);
            change.dx[d] = change.dv[d] = c->v[i][d];
            body->v[at] += (real)c->v[i][d];
            body->x[at] += (real)c->v[i][d];
        }
        momentum_pushed(momentum, body - k->oct->body, leaf, &change, k->oct->gravity, 1);
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
