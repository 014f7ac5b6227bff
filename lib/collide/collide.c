#include "collide.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"
#include "../system/team.h"
#include "../vector.h"
#include "pairs.h"
#include "rest.h"

/* What one thread found. */
typedef struct {
    SmCollideContact *contact;
    long count, room;
} Found;

struct SmCollideWork {
    SmCollidePatches patches;
    SmCollidePaths paths;
    SmCollidePairs pairs;
    SmBox *cell_box, *node_box; /* [bodies * patches] of those in pairs */
    SmBox *box;                 /* [bodies * cells of the shape] of their cells */
    Found *found;               /* [threads] */
    int *place;                 /* [bodies * nodes] in SmCollide.node, or -1 */
    unsigned char *fixed;       /* [bodies * nodes] */
    long *fixed_node;           /* [fixed_count] */
    long fixed_count, contact_room, node_room;
    double *inverse_mass; /* [node_room] of the nodes that contacts change; 0: fixed */
    double (*before)[3];  /* [node_room] */
    long cells;           /* of a body as described */
};

/* Where a cell is: its middle and, by columns, what its axes have become. `frame` NULL: from its
 * eight corners. */
static void find_frame(const SmCollideCell *cell, const double (*x)[3], const double (*frame)[9],
                       double middle[3], double F[9])
{
    if (frame) {
        memcpy(middle, x[cell->carrier[0]], 3 * sizeof(double));
        memcpy(F, frame[cell->carrier[0]], 9 * sizeof(double));
        return;
    }
    for (int i = 0; i < 3; i++) {
        double corner[8];
        for (int c = 0; c < SM_COLLIDE_CORNERS; c++) corner[c] = x[cell->carrier[c]][i];
        double a = corner[0] + corner[1], b = corner[2] + corner[3], c = corner[4] + corner[5],
               d = corner[6] + corner[7], scale = 0.25 / cell->edge;
        middle[i] = ((a + b) + (c + d)) / 8;
        F[3 * i] = scale * ((corner[1] - corner[0]) + (corner[3] - corner[2]) +
                            (corner[5] - corner[4]) + (corner[7] - corner[6]));
        F[3 * i + 1] = scale * ((b - a) + (d - c));
        F[3 * i + 2] = scale * ((c - a) + (d - b));
    }
}

/* Rows of the inverse of F; false where the cell has no inside. */
static bool invert(const double F[9], double inverse[9])
{
    double column[3][3], row[3][3];
    for (int i = 0; i < 3; i++)
        for (int d = 0; d < 3; d++) column[d][i] = F[3 * i + d];
    for (int d = 0; d < 3; d++) sm_cross(column[(d + 1) % 3], column[(d + 2) % 3], row[d]);
    double determinant = sm_dot(column[0], row[0]);
    if (!(determinant > SM_COLLIDE_FLATTEST)) return false;
    for (int d = 0; d < 3; d++)
        for (int i = 0; i < 3; i++) inverse[3 * d + i] = row[d][i] / determinant;
    return true;
}

static void weigh(const SmCollideShape *shape, const SmCollideCell *cell, const double q[3],
                  double weight[SM_COLLIDE_CORNERS])
{
    if (shape->carriers == 1) {
        weight[0] = 1;
        return;
    }
    double share[3];
    for (int d = 0; d < 3; d++)
        share[d] = fmin(fmax((q[d] - cell->centre[d]) / cell->edge + 0.5, 0), 1);
    for (int c = 0; c < SM_COLLIDE_CORNERS; c++) {
        weight[c] = 1;
        for (int d = 0; d < 3; d++) weight[c] *= c >> d & 1 ? share[d] : 1 - share[d];
    }
}

/* Contact of node `node`, which is at p, with a cell in that place: fills depth, out, weight. A
 * cell that is flat or turned inside out has no inside. */
static bool meet(const SmCollideShape *shape, const SmCollideCell *cell, int node,
                 const double p[3], const double middle[3], const double F[9],
                 SmCollideContact *contact)
{
    double inverse[9], off[3], q[3], out[3], radius = shape->radius[node];
    if (!invert(F, inverse)) return false;
    sm_subtract(p, middle, off);
    for (int d = 0; d < 3; d++) q[d] = cell->centre[d] + sm_dot(inverse + 3 * d, off);
    if (!sm_collide_depth(shape, cell, q, radius, &contact->depth, out)) return false;
    for (int i = 0; i < 3; i++) { /* normals turn by the inverse transposed */
        contact->out[i] = 0;
        for (int d = 0; d < 3; d++) contact->out[i] += inverse[3 * d + i] * out[d];
    }
    weigh(shape, cell, q, contact->weight);
    return sm_normalize(contact->out);
}

/* Half extents of a cell's box, with the solid round of nodes; false: too large to be one. */
static bool extents(const SmCollide *c, const SmCollideCell *cell, const double F[9],
                    double half[3])
{
    for (int i = 0; i < 3; i++) {
        double sum = fabs(F[3 * i]) + fabs(F[3 * i + 1]) + fabs(F[3 * i + 2]);
        if (!(sum < SM_COLLIDE_LONGEST)) return false;
        half[i] = sum * cell->edge / 2 + c->shape.thickest;
    }
    return true;
}

/* Whether a node may collide with a cell of body b, as far as it is known. */
static SmCollideRelation relation(const SmCollide *c, int number, long b, long k)
{
    long nodes = c->shape.nodes, first = b * nodes;
    if (number < first || number >= first + nodes)
        return c->params.bodies ? SM_COLLIDE_MAY : SM_COLLIDE_MUST_NOT;
    if (!c->params.self) return SM_COLLIDE_MUST_NOT;
    return sm_collide_relation(&c->shape, (int)(number - first), k);
}

static SmCollideContact *next_contact(Found *found)
{
    sm_make_room(found->contact, found->room, found->count + 1);
    return &found->contact[found->count];
}

/* Boxes of a patch's cells, with the solid round of nodes, and of its nodes. */
static void find_boxes(SmCollide *c, const double (*x)[3], const double (*frame)[9], long patch)
{
    SmCollideWork *work = c->work;
    const SmCollidePatches *patches = &work->patches;
    long b = patch / patches->count, p = patch % patches->count, first = b * c->shape.nodes;
    double middle[3], F[9], half[3];
    SmBox cells = sm_no_box(), nodes = sm_no_box();
    for (long i = patches->cell_first[p]; i < patches->cell_first[p + 1]; i++) {
        const SmCollideCell *cell = &c->shape.cell[patches->cell[i]];
        SmBox *box = &work->box[b * c->shape.cell_count + patches->cell[i]];
        *box = sm_no_box();
        find_frame(cell, x + first, frame ? frame + first : NULL, middle, F);
        if (!extents(c, cell, F, half)) continue;
        for (int d = 0; d < 3; d++) {
            box->low[d] = middle[d] - half[d];
            box->high[d] = middle[d] + half[d];
        }
        sm_box_join(&cells, box->low, box->high);
    }
    for (long i = patches->node_first[p]; i < patches->node_first[p + 1]; i++)
        sm_box_add(&nodes, x[first + patches->node[i]]);
    work->cell_box[patch] = cells;
    work->node_box[patch] = nodes;
}

/* A node in the box of the cell at place k of body b. */
static void test_node(const SmCollide *c, const double (*x)[3], const double (*frame)[9],
                      int number, long b, long k, Found *found)
{
    const SmCollideCell *cell = &c->shape.cell[k];
    double middle[3], F[9];
    long nodes = c->shape.nodes, first = b * nodes;
    SmCollideRelation known = relation(c, number, b, k);
    if (known == SM_COLLIDE_MUST_NOT) return;
    SmCollideContact *contact = next_contact(found);
    find_frame(cell, x + first, frame ? frame + first : NULL, middle, F);
    if (!meet(&c->shape, cell, (int)(number % nodes), x[number], middle, F, contact)) return;
    contact->node = number;
    contact->place = known == SM_COLLIDE_UNKNOWN;       /* until it is known */
    contact->cell = (int)(b * c->shape.cell_count + k); /* its place, until it is numbered */
    found->count++;
}

/* The cells of one patch against the nodes of another. */
static void test_patches(const SmCollide *c, const double (*x)[3], const double (*frame)[9],
                         long with_cells, long with_nodes, Found *found)
{
    const SmCollideWork *work = c->work;
    const SmCollidePatches *patches = &work->patches;
    const SmBox *nodes = &work->node_box[with_nodes];
    long b = with_cells / patches->count, p = with_cells % patches->count;
    long q = with_nodes % patches->count, first = with_nodes / patches->count * c->shape.nodes;
    if (!sm_boxes_meet(&work->cell_box[with_cells], nodes)) return;
    for (long i = patches->cell_first[p]; i < patches->cell_first[p + 1]; i++) {
        const SmBox *box = &work->box[b * c->shape.cell_count + patches->cell[i]];
        if (!sm_boxes_meet(box, nodes)) continue;
        for (long n = patches->node_first[q]; n < patches->node_first[q + 1]; n++)
            if (sm_box_holds(box, x[first + patches->node[n]]))
                test_node(c, x, frame, (int)(first + patches->node[n]), b, patches->cell[i], found);
    }
}

static int place_of(SmCollide *c, long number)
{
    SmCollideWork *work = c->work;
    if (work->place[number] >= 0) return work->place[number];
    if (c->node_count == work->node_room) {
        work->node_room = 2 * work->node_room + 64;
        c->node = sm_realloc(c->node, (size_t)work->node_room, sizeof *c->node);
        c->v = sm_realloc(c->v, (size_t)work->node_room, sizeof *c->v);
        work->before = sm_realloc(work->before, (size_t)work->node_room, sizeof *c->v);
        work->inverse_mass =
            sm_realloc(work->inverse_mass, (size_t)work->node_room, sizeof(double));
    }
    c->node[c->node_count] = (int)number;
    work->inverse_mass[c->node_count] =
        work->fixed[number] ? 0 : c->shape.inverse_mass[number % c->shape.nodes];
    return work->place[number] = (int)c->node_count++;
}

/* Places, and the mass mu. */
static void complete(SmCollide *c, SmCollideContact *contact)
{
    const SmCollideShape *shape = &c->shape;
    const SmCollideWork *work = c->work;
    long b = contact->cell / shape->cell_count, first = b * shape->nodes;
    const SmCollideCell *cell = &shape->cell[contact->cell % shape->cell_count];
    contact->place = place_of(c, contact->node);
    double inverse = work->inverse_mass[contact->place];
    for (int i = 0; i < shape->carriers; i++) {
        contact->carrier[i] = place_of(c, first + cell->carrier[i]);
        inverse +=
            contact->weight[i] * contact->weight[i] * work->inverse_mass[contact->carrier[i]];
    }
    contact->mass = inverse > 0 ? 1 / inverse : 0;
    contact->cell = (int)(b * work->cells + cell->number);
}

static void join(SmCollide *c)
{
    SmCollideWork *work = c->work;
    for (long i = 0; i < c->node_count; i++) work->place[c->node[i]] = -1;
    c->node_count = c->contact_count = 0;
    long count = 0;
    for (int t = 0; t < c->threads; t++) count += work->found[t].count;
    if (count > work->contact_room) {
        work->contact_room = 2 * count;
        c->contact = sm_realloc(c->contact, (size_t)work->contact_room, sizeof *c->contact);
    }
    for (int t = 0; t < c->threads; t++)
        for (long i = 0; i < work->found[t].count; i++) {
            const SmCollideContact *contact = &work->found[t].contact[i];
            if (contact->place &&
                !sm_collide_may(&work->paths, &c->shape, contact->node % (int)c->shape.nodes,
                                contact->cell % c->shape.cell_count))
                continue;
            c->contact[c->contact_count] = *contact;
            complete(c, &c->contact[c->contact_count++]);
        }
}

void sm_collide_find(SmCollide *c, const double (*x)[3], const double (*frame)[9])
{
    SmCollideWork *work = c->work;
    const SmCollidePairs *pairs = &work->pairs;
    sm_collide_pairs_find(&work->pairs, c->shape.nodes, x);
#pragma omp parallel for schedule(static) num_threads(c->threads) if (c->threads > 1)
    for (long i = 0; i < pairs->patch_count; i++) find_boxes(c, x, frame, pairs->patch[i]);
#pragma omp parallel for schedule(static) num_threads(c->threads) if (c->threads > 1)
    for (int t = 0; t < c->threads; t++) {
        work->found[t].count = 0;
        for (long i = pairs->count * t / c->threads; i < pairs->count * (t + 1) / c->threads; i++) {
            int a = pairs->pair[i][0], b = pairs->pair[i][1];
            test_patches(c, x, frame, a, b, &work->found[t]);
            if (a != b) test_patches(c, x, frame, b, a, &work->found[t]);
        }
    }
    join(c);
}

static void relative(const SmCollide *c, const SmCollideContact *contact, double u[3])
{
    memcpy(u, c->v[contact->place], 3 * sizeof(double));
    for (int i = 0; i < c->shape.carriers; i++)
        for (int d = 0; d < 3; d++) u[d] -= contact->weight[i] * c->v[contact->carrier[i]][d];
}

void sm_collide_begin(SmCollide *c)
{
    for (long i = 0; i < c->contact_count; i++) relative(c, &c->contact[i], c->contact[i].bias);
}

static void add_impulse(SmCollide *c, int place, double share, const double impulse[3])
{
    double scale = share * c->work->inverse_mass[place];
    for (int d = 0; d < 3; d++) c->v[place][d] += scale * impulse[d];
}

static void push(SmCollide *c, const SmCollideContact *contact, const double impulse[3])
{
    add_impulse(c, contact->place, 1, impulse);
    for (int i = 0; i < c->shape.carriers; i++)
        add_impulse(c, contact->carrier[i], -contact->weight[i], impulse);
}

/* u at the positions; returns its component outwards. */
static double outwards(const SmCollide *c, const SmCollideContact *contact, double u[3])
{
    relative(c, contact, u);
    for (int d = 0; d < 3; d++) u[d] -= contact->bias[d];
    return sm_dot(u, contact->out);
}

/* Takes the speed inwards and the share `friction` of the tangential one, and the energy. */
static void stop(SmCollide *c, const SmCollideContact *contact, double friction)
{
    double u[3], after[3], impulse[3], speed = outwards(c, contact, u);
    if (!(speed < -contact->noise)) return;
    for (int d = 0; d < 3; d++) {
        after[d] = (1 - friction) * (u[d] - speed * contact->out[d]);
        impulse[d] = contact->mass * (after[d] - u[d]);
    }
    push(c, contact, impulse);
    c->reserve += 0.5 * contact->mass * (sm_dot(u, u) - sm_dot(after, after));
}

/* What it would take to push a contact out as fast as its depth asks for. */
static double cost_of(const SmCollide *c, const SmCollideContact *contact, double *speed)
{
    double u[3], wanted = SM_COLLIDE_PUSH * contact->depth;
    *speed = fmax(outwards(c, contact, u), 0);
    return wanted > *speed ? 0.5 * contact->mass * (wanted * wanted - *speed * *speed) : 0;
}

/* Spends the reserve on pushing outwards: each contact gets the same share of its cost. */
static void push_out(SmCollide *c)
{
    double total = 0, speed, impulse[3];
    for (long i = 0; i < c->contact_count; i++) total += cost_of(c, &c->contact[i], &speed);
    double share = total > c->reserve ? c->reserve / total : 1;
    for (long i = 0; i < c->contact_count; i++) {
        const SmCollideContact *contact = &c->contact[i];
        stop(c, contact, 0);
        double cost = fmin(share * cost_of(c, contact, &speed), c->reserve);
        if (!(cost > 0)) continue;
        double more = sqrt(speed * speed + 2 * cost / contact->mass) - speed;
        for (int d = 0; d < 3; d++) impulse[d] = contact->mass * more * contact->out[d];
        push(c, contact, impulse);
        c->reserve -= cost;
    }
}

static bool same_bodies(const SmCollide *c, const SmCollideContact *a, const SmCollideContact *b)
{
    long nodes = c->shape.nodes, cells = c->work->cells;
    return a->node / nodes == b->node / nodes && a->cell / cells == b->cell / cells;
}

/* The biases of contacts of the same two bodies that follow each other, and their noise, if none
 * of them approaches faster; where the next ones begin. */
static long prepare(SmCollide *c, long first)
{
    SmCollideContact *of = c->contact;
    double fastest = 0, u[3];
    long end = first;
    do {
        relative(c, &of[end], u);
        for (int d = 0; d < 3; d++) {
            of[end].bias[d] = 0.5 * (u[d] - of[end].bias[d]);
            u[d] -= of[end].bias[d];
        }
        fastest = fmax(fastest, -sm_dot(u, of[end].out));
    } while (++end < c->contact_count && same_bodies(c, &of[first], &of[end]));
    for (long i = first; i < end; i++)
        of[i].noise = fastest <= c->rounding && of[i].depth < SM_COLLIDE_DEEP ? c->rounding : 0;
    return end;
}

void sm_collide_respond(SmCollide *c)
{
    double(*before)[3] = c->work->before;
    if (!c->contact_count) return;
    for (long next = 0; next < c->contact_count;) next = prepare(c, next);
    memcpy(before, c->v, (size_t)c->node_count * sizeof *before);
    for (int sweep = 0; sweep < SM_COLLIDE_SWEEPS; sweep++)
        for (long i = 0; i < c->contact_count; i++)
            stop(c, &c->contact[i], sweep ? 0 : c->params.friction);
    push_out(c);
    for (long i = 0; i < c->node_count; i++)
        for (int d = 0; d < 3; d++) c->v[i][d] -= before[i][d];
}

static void build(SmCollide *c, const SmCollideRest *rest)
{
    SmCollideWork *work = c->work = sm_alloc(1, sizeof *work);
    sm_collide_shape_build(rest, &c->shape);
    work->cells = rest->cells;
    size_t all = (size_t)(c->bodies * c->shape.nodes);
    work->found = sm_alloc((size_t)c->threads, sizeof *work->found);
    work->place = sm_alloc(all, sizeof *work->place);
    work->fixed = sm_alloc(all, 1);
    sm_collide_patches_build(&c->shape, &work->patches);
    sm_collide_paths_start(&work->paths, &c->shape);
    size_t patches = (size_t)(c->bodies * work->patches.count);
    work->cell_box = sm_alloc(patches, sizeof *work->cell_box);
    work->node_box = sm_alloc(patches, sizeof *work->node_box);
    work->box = sm_alloc((size_t)(c->bodies * c->shape.cell_count), sizeof *work->box);
    memset(work->place, -1, all * sizeof *work->place);
    sm_collide_pairs_init(&work->pairs, &work->patches, &c->params, c->bodies);
}

/* All but what sm_collide_build() is told. */
static void clear(SmCollide *c)
{
    SmCollideWork *work = c->work;
    for (int t = 0; t < c->threads; t++) free(work->found[t].contact);
    sm_collide_pairs_free(&work->pairs);
    sm_collide_patches_free(&work->patches);
    sm_collide_paths_free(&work->paths);
    sm_free_all(work->found, work->place, work->fixed, work->fixed_node, work->box, work->before,
                work->inverse_mass, work->cell_box, work->node_box, work);
    sm_collide_shape_free(&c->shape);
    sm_free_all(c->contact, c->node, c->v);
}

SmCollide *sm_collide_build(const SmCollideRest *rest, const SmCollideParams *params, long bodies,
                            double rounding, int threads)
{
    SmCollide *c = sm_alloc(1, sizeof *c);
    c->params = *params;
    c->bodies = bodies;
    c->rounding = rounding;
    c->threads = sm_team(threads);
    build(c, rest);
    return c;
}

void sm_collide_free(SmCollide *c)
{
    if (!c) return;
    clear(c);
    free(c);
}

void sm_collide_describe(SmCollide *c, const SmCollideRest *rest)
{
    clear(c);
    c->node_count = c->contact_count = 0;
    c->node = NULL;
    c->v = NULL;
    c->contact = NULL;
    build(c, rest);
}

void sm_collide_fix(SmCollide *c, long count, const long *node)
{
    SmCollideWork *work = c->work;
    for (long i = 0; i < work->fixed_count; i++) work->fixed[work->fixed_node[i]] = 0;
    work->fixed_node = sm_realloc(work->fixed_node, (size_t)count + 1, sizeof *node);
    work->fixed_count = count;
    for (long i = 0; i < count; i++) work->fixed[work->fixed_node[i] = node[i]] = 1;
}

long sm_collide_list(const SmCollide *c, double cell, SmContact **contact)
{
    *contact = sm_alloc((size_t)c->contact_count, sizeof **contact);
    for (long i = 0; i < c->contact_count; i++) {
        const SmCollideContact *from = &c->contact[i];
        SmContact *to = &(*contact)[i];
        to->particle = from->node;
        to->cell = c->node[from->carrier[0]];
        to->depth = cell * from->depth;
        memcpy(to->out, from->out, sizeof to->out);
        memcpy(to->weight, from->weight, (size_t)c->shape.carriers * sizeof *to->weight);
    }
    return c->contact_count;
}
