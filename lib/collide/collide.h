/* collide.h - bodies collide with each other and with themselves.
 *
 * Method (octree section on collisions; Teschner et al. 2003): every cell near the surface has
 * distances to the outer faces at rest (rest.h) and finds the surface's nodes in its box. In place
 * of a spatial hash, patches of the surface are tested in pairs (pairs.h), which leaves out nearly
 * all that a hash finds: neighbours in the material. A
 * node inside a cell is at a rest position there, which says how deep it is and which way is out.
 * It makes one contact with every cell that holds it. A node and a cell that the material joins by
 * a short path never collide (rest.h).
 *
 * Engines call, in every step:
 *     sm_collide_find(c, x, frame)                    contacts of the positions before the step
 *     fill c->v of the nodes c->node; sm_collide_begin(c)     their velocities before
 *     ... the step: velocities, positions ...
 *     fill c->v again; sm_collide_respond(c)                  their velocities after
 *     v += c->v and x += c->v of these nodes                  what collisions change
 * with v in cells per step, so that the change of v is also that of the place just moved to.
 *
 * The response gains no energy. Without it the step is v+ = v- + f(x), x+ = x + v+, symplectic
 * Euler, which keeps H = sum m |v|^2 / 2 + V(x) - sum m |f|^2 / 8 at v = (v- + v+) / 2 exactly
 * while f is linear in x (fastlsm eqs. 1 and 2: f = g - x, and gravity; reference/test_energy.c).
 * Impulses at time x change v and v+ alike and nothing else in H, so H changes as sum m |v|^2 / 2
 * does. Every impulse acts between a node and the nodes that carry the cell, with their weights w
 * (sum 1): the node's velocity relative to the cell is u = v_i - sum w_c v_c, an impulse p on the
 * node and -w_c p on the carriers keeps the momentum, changes u by p / mu, 1 / mu = 1 / m_i + sum
 * w_c^2 / m_c, and the kinetic energy by mu (|u'|^2 - |u|^2) / 2. First all contacts, a few times
 * in turn, lose the part of u that leads deeper and the share `friction` of the tangential one:
 * |u'| <= |u|. The energy they lose is added to a reserve, from which each contact gets the same
 * share of the energy that it takes to push it out at SM_COLLIDE_PUSH x depth; the reserve is never
 * negative. So H + reserve never grows, and H never exceeds what it was when the reserve was 0. It
 * lasts: a body that lies on another sinks in every step, and what that sets free raises it again.
 * What overlaps and rests stays as it is while the reserve is 0, but for rounding, which goes
 * either way: were only what leads deeper stopped, bodies would creep apart. So it is left alone
 * (`rounding`) between bodies of which nothing approaches faster, where they are not deep in each
 * other.
 *
 * Speed limit: a node that moves, relative to the cells that it meets, by less than half the
 * thickness of what they are part of in a step is found before it is nearer to the far side, and
 * does not get through. The pull of the body behind it counts: a body of regions up to 3 cells wide
 * may fly at 0.15 times that thickness a step (SM_COLLIDE_SPEED), so at 0.15 cells against a wall
 * one cell thick. The same holds for obstacles (obstacle.h), but for planes, which have no limit.
 *
 * Only patches of surfaces (patches.h) whose boxes meet, of bodies whose boxes meet or of one
 * body where the material does not hold them together, look for contacts. A cell counts as the
 * parallelepiped of its axes; where its corners are so bent that this reaches beyond them by more
 * than a tenth of an edge, contacts in what reaches beyond may be missed.
 *
 * Results do not depend on the number of threads. A step costs O(1) for every particle that is
 * looked at (all, for boxes), O(1) for every pair of patches whose boxes meet or, of one body, soon
 * may, for their nodes and cells where the material does not hold them together, and O(carriers)
 * for each contact; once for every node and cell of one body that meet and are neither far apart at
 * rest nor neighbours, a search of the material between them. It allocates nothing once
 * its arrays have grown. Twin: reference/brute_collide.c. */
#ifndef SM_COLLIDE_H
#define SM_COLLIDE_H

#include "../engine/engine.h"
#include "rest.h"

#define SM_COLLIDE_PUSH 0.25 /* share of the depth that is pushed out in a step, at most */
#define SM_COLLIDE_DEEP 0.25 /* cells, from where on rounding is stopped, too */

#define SM_COLLIDE_SPEED    0.15 /* of the thickness of a wall, that a body may fly at in a step */
#define SM_COLLIDE_FLATTEST 0.1  /* a cell with less of its volume has no inside, */
#define SM_COLLIDE_LONGEST  4.0  /* nor has one stretched to about this many times its edge */

enum { SM_COLLIDE_SWEEPS = 4 }; /* over all contacts in a step */

/* Node p of body b has number b * nodes + p; a cell's has the same form. */
typedef struct {
    int node, cell; /* numbers; of the cell as described */
    double depth, out[3];
    double weight[SM_COLLIDE_CORNERS];
    int carrier[SM_COLLIDE_CORNERS]; /* places in SmCollide.node, and that of the node itself */
    int place;
    double mass;    /* mu */
    double noise;   /* approach that is not stopped */
    double bias[3]; /* takes u of the velocities after the step to that at the positions */
} SmCollideContact;

typedef struct SmCollideWork SmCollideWork;

typedef struct {
    SmCollideShape shape;
    SmCollideParams params;
    long bodies, contact_count, node_count;
    int threads;
    double rounding; /* cells per step by which rounding moves nodes at rest */
    double reserve; /* energy taken from contacts and not yet returned, in the masses' unit x (cells
                       / step)^2 */
    SmCollideContact *contact; /* [contact_count] in an order that positions decide */
    int *node;                 /* [node_count] nodes that contacts change, each once */
    double (*v)[3];            /* [node_count] */
    SmCollideWork *work;
} SmCollide;

/* For `bodies` instances of the body; `rounding`: see above; threads 0: OpenMP's number. The
 * description is not copied: what it points to stays where it is until the next one. Free with
 * sm_collide_free(). */
SmCollide *sm_collide_build(const SmCollideRest *rest, const SmCollideParams *params, long bodies,
                            double rounding, int threads);
void sm_collide_free(SmCollide *collide);

/* The body has changed (broken links, cut or refined cells): its new description. Node numbers may
 * change; what was fixed is fixed no more. O(description): about 0.5 us a node, most of it for the
 * patches. Which nodes and cells are far apart in the material is found when it is first needed. */
void sm_collide_describe(SmCollide *collide, const SmCollideRest *rest);

/* Nodes that impulses do not move (held by handles), in place of those named before. O(count). */
void sm_collide_fix(SmCollide *collide, long count, const long *node);

/* Contacts of positions x [bodies * nodes][3], in cells. Where cells hang on one node each,
 * `frame` [bodies * nodes][9] holds the rotations by rows; otherwise NULL. */
void sm_collide_find(SmCollide *collide, const double (*x)[3], const double (*frame)[9]);

/* See above. */
void sm_collide_begin(SmCollide *collide);
void sm_collide_respond(SmCollide *collide);

/* The contacts found last, of cells this long, numbered by nodes: a cell is its first carrier. The
 * caller frees; returns how many. */
long sm_collide_list(const SmCollide *collide, double cell, SmContact **contact);

#endif
