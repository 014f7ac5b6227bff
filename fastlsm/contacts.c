#include "contacts.h"

#include <stdlib.h>
#include <string.h>

#include "../lib/collide/collide.h"
#include "lattice/outline.h"

struct LsmContacts {
    Lsm *lsm;
    SmCollide *collide;
    LsmOutline outline;
    double (*x)[3]; /* [bodies * particles] cells */
    long broken;    /* links, in the present description */
    long *fixed, fixed_count;
};

/* Where coordinate 0 of a particle is in x and v; the others follow at SM_LANES. */
static long index_of(const LsmContacts *k, long number)
{
    return place_of(k->lsm, number / k->lsm->lattice.count, number % k->lsm->lattice.count);
}

LsmContacts *lsm_contacts_build(Lsm *lsm, real rounding)
{
    const SmCollideParams *params = &lsm->params.collide;
    long bodies = lsm->bodies;
    if (!params->self && !(params->bodies && bodies > 1)) return NULL;
    LsmContacts *k = sm_alloc(1, sizeof *k);
    *k = (LsmContacts){.lsm = lsm};
    k->x = sm_alloc((size_t)(bodies * lsm->lattice.count), sizeof *k->x);
    lsm_outline_build(&lsm->lattice, lsm->mass, &k->outline);
    k->collide = sm_collide_build(&k->outline.rest, params, bodies, contact_rounding(rounding),
                                  lsm->params.threads);
    return k;
}

void lsm_contacts_free(LsmContacts *k)
{
    if (!k) return;
    sm_collide_free(k->collide);
    lsm_outline_free(&k->outline);
    free(k->x);
    free(k->fixed);
    free(k);
}

static void fix(LsmContacts *k)
{
    if (k->fixed) sm_collide_fix(k->collide, k->fixed_count, k->fixed);
}

static void describe(LsmContacts *k)
{
    lsm_outline_free(&k->outline);
    lsm_outline_build(&k->lsm->lattice, k->lsm->mass, &k->outline);
    sm_collide_describe(k->collide, &k->outline.rest);
    fix(k);
    k->broken = k->lsm->broken;
}

/* Of one body from its own origin, of instances from where all are at home. */
static void read_positions(LsmContacts *k)
{
    const Lsm *lsm = k->lsm;
    long count = lsm->lattice.count;
    for (long body = 0; body < lsm->bodies; body++) {
        double shift[3] = {0};
        for (int d = 0; d < 3 && lsm->bodies > 1; d++)
            shift[d] = (lsm->origin[body][d] - lsm->home[d]) / lsm->cell;
        for (long p = 0; p < count; p++) {
            const real *from = lsm->x + place_of(lsm, body, p);
            for (int d = 0; d < 3; d++)
                k->x[body * count + p][d] = shift[d] + (double)from[d * SM_LANES];
        }
    }
}

static void read_velocities(LsmContacts *k)
{
    SmCollide *c = k->collide;
    const real *v = k->lsm->v;
    for (long i = 0; i < c->node_count; i++) {
        const real *from = v + index_of(k, c->node[i]);
        for (int d = 0; d < 3; d++) c->v[i][d] = (double)from[d * SM_LANES];
    }
}

static void find(LsmContacts *k)
{
    if (k->broken != k->lsm->broken) describe(k);
    read_positions(k);
    sm_collide_find(k->collide, (const double(*)[3])k->x, NULL);
}

long lsm_contacts_list(LsmContacts *k, SmContact **contact)
{
    find(k);
    return sm_collide_list(k->collide, k->lsm->cell, contact);
}

void lsm_contacts_before(LsmContacts *k)
{
    find(k);
    read_velocities(k);
    sm_collide_begin(k->collide);
}

void lsm_contacts_after(LsmContacts *k, Momentum *momentum)
{
    SmCollide *c = k->collide;
    const Lsm *lsm = k->lsm;
    real *v = lsm->v, *x = lsm->x;
    read_velocities(k);
    sm_collide_respond(c);
    for (long i = 0; i < c->node_count; i++) {
        long at = index_of(k, c->node[i]), count = lsm->lattice.count;
        MomentumChange change;
        lsm_moved_from(lsm, at, &change);
        for (int d = 0; d < 3; d++, at += SM_LANES) {
            change.dx[d] = change.dv[d] = c->v[i][d];
            v[at] += (real)c->v[i][d];
            x[at] += (real)c->v[i][d];
        }
        momentum_pushed(momentum, c->node[i] / count, lsm->slot[c->node[i] % count], &change,
                        lsm->gravity, 1);
    }
}

void lsm_contacts_fix(LsmContacts *k, long count, const long *particle)
{
    k->fixed = sm_realloc(k->fixed, (size_t)count + 1, sizeof *k->fixed);
    memcpy(k->fixed, particle, (size_t)count * sizeof *particle);
    k->fixed_count = count;
    fix(k);
}

long lsm_contacts_count(const LsmContacts *k)
{
    return k->collide->contact_count;
}
