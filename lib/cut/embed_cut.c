#include "embed_cut.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../box.h"
#include "../polar.h"
#include "../vector.h"
#include "../voxel/voxel.h"
#include "side_consistency.h"

enum { CARRIERS = 8, MOST_REACH = 2, MOST_SIDE = 2 * MOST_REACH + 2 };

typedef struct {
    SmEmbedding *embedding;
    const SmMesh *mesh;
    const SmSites *sites;
    const SmCut *cut;
    const int *piece;    /* [particles] */
    double (*normal)[3]; /* [vertices] of any length */
    int *flat;           /* [vertices] its number in embedding->flat, or -1 */
    long flat_room;
} EmbedCut;

/* Lengths are cells, places relative to the vertex. */
typedef struct {
    int count, particle[CARRIERS];
    double at[CARRIERS][3];
} Carriers;

typedef struct {
    double square, at[3];
    int particle;
} Candidate;

static void place_of(const SmSites *sites, int particle, double place[3])
{
    const SmVoxels *v = sites->voxels;
    for (int d = 0; d < 3; d++) place[d] = v->origin[d] + v->cell * sites->coordinate[particle][d];
}

static int compare(const void *a, const void *b)
{
    const Candidate *p = a, *q = b;
    if (p->square != q->square) return p->square < q->square ? -1 : 1;
    return (p->particle > q->particle) - (p->particle < q->particle);
}

/* Particles of the material within `reach` cells of that which holds a vertex, the nearest first.
 */
static int find_candidates(const SmSites *sites, const double X[3], int reach,
                           Candidate candidate[MOST_SIDE * MOST_SIDE * MOST_SIDE])
{
    const SmVoxels *v = sites->voxels;
    bool material[MOST_SIDE][MOST_SIDE][MOST_SIDE] = {{{false}}};
    double q[3];
    int cell[3], side = 2 * reach + 1, count = 0;
    for (int d = 0; d < 3; d++) q[d] = (X[d] - v->origin[d]) / v->cell;
    sm_nearest_cell(v, q, cell);
    for (int d = 0; d < 3; d++) cell[d] -= reach;
    for (int n = 0; n < side * side * side; n++) {
        int i = n % side, j = n / side % side, k = n / side / side;
        if (!sm_voxel_get(v, cell[0] + i, cell[1] + j, cell[2] + k)) continue;
        for (int c = 0; c < 8; c++) material[k + (c >> 2)][j + (c >> 1 & 1)][i + (c & 1)] = true;
    }
    side++;
    for (int n = 0; n < side * side * side; n++) {
        int place[3] = {n % side, n / side % side, n / side / side};
        if (!material[place[2]][place[1]][place[0]]) continue;
        Candidate *c = &candidate[count++];
        for (int d = 0; d < 3; d++) c->at[d] = (place[d] += cell[d]) - q[d];
        c->square = sm_dot(c->at, c->at);
        c->particle = sm_sites_find(sites, place[0], place[1], place[2]);
    }
    qsort(candidate, (size_t)count, sizeof *candidate, compare);
    return count;
}

/* Does `at` stick out of what the first `rank` vectors span? Then that is the next one. */
static bool widens(double basis[3][3], int rank, const double at[3])
{
    static const double least = 0.3; /* a lattice's places are in such a plane, or a third off it */
    double off[3] = {at[0], at[1], at[2]};
    for (int r = 0; r < rank; r++) {
        double along = sm_dot(off, basis[r]);
        for (int d = 0; d < 3; d++) off[d] -= along * basis[r][d];
    }
    if (!(sm_dot(off, off) > least * least)) return false;
    memcpy(basis[rank], off, sizeof off);
    return sm_normalize(basis[rank]);
}

/* Is a candidate seen from the eye, and from what is chosen already, and of one piece with it? From
 * where cuts meet, particles of several pieces are seen. */
static bool may_carry(const EmbedCut *t, const double eye[3], const Carriers *chosen,
                      const Candidate *c)
{
    double place[3], first[3];
    if (chosen->count > 0 && t->piece[c->particle] != t->piece[chosen->particle[0]]) return false;
    place_of(t->sites, c->particle, place);
    if (sm_cut_crosses(t->cut, 0, eye, place)) return false;
    if (chosen->count == 0) return true;
    place_of(t->sites, chosen->particle[0], first);
    return !sm_cut_crosses(t->cut, 0, first, place);
}

/* The nearest particles that are seen from `eye`, so many of them far enough away that they span
 * what all that are seen do. Returns how many dimensions. */
static int choose(const EmbedCut *t, const double X[3], const double eye[3], int reach,
                  Carriers *chosen)
{
    Candidate candidate[MOST_SIDE * MOST_SIDE * MOST_SIDE];
    int count = find_candidates(t->sites, X, reach, candidate), rank = 0;
    double basis[3][3];
    chosen->count = 0;
    for (int i = 0; i < count && chosen->count < CARRIERS; i++) {
        const Candidate *c = &candidate[i];
        if (!may_carry(t, eye, chosen, c)) continue;
        if (chosen->count > 0 && rank < 3) {
            double along[3];
            for (int d = 0; d < 3; d++) along[d] = c->at[d] - chosen->at[0][d];
            if (widens(basis, rank, along))
                rank++;
            else if (CARRIERS - chosen->count <= 3 - rank)
                continue;
        }
        memcpy(chosen->at[chosen->count], c->at, sizeof c->at);
        chosen->particle[chosen->count++] = c->particle;
    }
    return rank;
}

/* The same with a wider reach where the near ones span less than space. */
static int choose_any(const EmbedCut *t, const double X[3], const double eye[3], Carriers *chosen)
{
    int rank = 0;
    for (int reach = 1; reach <= MOST_REACH && rank < 3; reach++)
        rank = choose(t, X, eye, reach, chosen);
    return rank;
}

/* Moments of the carriers about their middle: `share` adds up to 1, `inverse` is on what they span,
 * `beyond` projects on the rest. Returns whether there is any. */
static bool find_moments(const Carriers *c, double share[CARRIERS], double middle[3],
                         double inverse[9], double beyond[9])
{
    double C[9] = {0}, V[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, sum = 0;
    bool flat = false;
    memset(middle, 0, 3 * sizeof *middle);
    memset(inverse, 0, 9 * sizeof *inverse);
    memset(beyond, 0, 9 * sizeof *beyond);
    for (int i = 0; i < c->count; i++) sum += share[i] = 1 / (0.1 + sm_dot(c->at[i], c->at[i]));
    for (int i = 0; i < c->count; i++) {
        share[i] /= sum;
        for (int d = 0; d < 3; d++) middle[d] += share[i] * c->at[i][d];
    }
    for (int i = 0; i < c->count; i++)
        for (int n = 0; n < 9; n++)
            C[n] +=
                share[i] * (c->at[i][n / 3] - middle[n / 3]) * (c->at[i][n % 3] - middle[n % 3]);
    sm_jacobi(3, C, V, 1e-14);
    for (int a = 0; a < 3; a++) {
        bool spanned = C[4 * a] > 1e-5; /* else it is 0: they are a lattice's places */
        flat |= !spanned;
        for (int n = 0; n < 9; n++)
            (spanned ? inverse : beyond)[n] +=
                V[n / 3 * 3 + a] * V[n % 3 * 3 + a] / (spanned ? C[4 * a] : 1);
    }
    return flat;
}

static void multiply(const double M[9], const double v[3], double result[3])
{
    for (int a = 0; a < 3; a++) result[a] = sm_dot(M + 3 * a, v);
}

static SmFlat *add_flat(EmbedCut *t, long v)
{
    SmEmbedding *e = t->embedding;
    sm_make_room(e->flat, t->flat_room, e->flat_count + 1);
    t->flat[v] = (int)e->flat_count;
    e->flat[e->flat_count] = (SmFlat){.vertex = v};
    return &e->flat[e->flat_count++];
}

static void drop_flat(EmbedCut *t, long v)
{
    SmEmbedding *e = t->embedding;
    int number = t->flat[v];
    if (number < 0) return;
    e->flat[number] = e->flat[--e->flat_count];
    t->flat[e->flat[number].vertex] = number;
    t->flat[v] = -1;
}

/* Vertex v is carried by these: the fit's value and slopes where it is, eqs. 15 and 17. */
static void weigh(EmbedCut *t, long v, const Carriers *c)
{
    SmEmbedding *e = t->embedding;
    double share[CARRIERS], middle[3], inverse[9], beyond[9], tangent[2][3];
    bool flat = find_moments(c, share, middle, inverse, beyond);
    drop_flat(t, v);
    SmFlat *off = flat ? add_flat(t, v) : NULL;
    sm_embed_tangents(t->normal[v], tangent[0], tangent[1]);
    for (int i = 0; i < CARRIERS; i++) {
        bool used = i < c->count;
        double from[3] = {0}, slope[3];
        for (int d = 0; d < 3 && used; d++) from[d] = share[i] * (c->at[i][d] - middle[d]);
        multiply(inverse, from, slope);
        e->corner[v][i] = c->particle[used ? i : 0];
        e->weight[v][i] = used ? (float)(share[i] - sm_dot(slope, middle)) : 0;
        e->tangent_u[v][i] = (float)sm_dot(slope, tangent[0]);
        e->tangent_v[v][i] = (float)sm_dot(slope, tangent[1]);
        if (off) memcpy(off->share[i], from, sizeof from);
    }
    if (!off) return;
    multiply(beyond, middle, off->offset);
    for (int d = 0; d < 3; d++) {
        off->offset[d] *= -t->sites->voxels->cell;
        off->normal[d] = t->normal[v][d];
    }
    sm_normalize(off->normal);
}

/* By particles that it sees; where it sees none, by those that the nearest particle sees. */
static void carry(EmbedCut *t, long v)
{
    const double *X = t->mesh->position[v];
    Carriers chosen;
    choose_any(t, X, X, &chosen);
    if (chosen.count == 0) {
        Candidate candidate[MOST_SIDE * MOST_SIDE * MOST_SIDE];
        double eye[3];
        find_candidates(t->sites, X, 1, candidate);
        place_of(t->sites, candidate[0].particle, eye);
        choose_any(t, X, eye, &chosen);
    }
    weigh(t, v, &chosen);
}

/* Around triangles, wider by what sm_cut_crosses() may move a segment by. */
static SmBox box_of(const SmCut *cut, long first, double margin)
{
    SmBox box = sm_no_box();
    for (long t = first; t < cut->triangles; t++)
        for (int c = 0; c < 3; c++) sm_box_add(&box, cut->vertex[cut->triangle[t][c]]);
    sm_box_widen(&box, margin);
    return box;
}

/* Do triangles from `first` on, all in the box, come between a vertex and what carries it, or has
 * that come apart? */
static bool is_parted(const EmbedCut *t, long v, long first, const SmBox *box)
{
    const double *X = t->mesh->position[v];
    const int *corner = t->embedding->corner[v];
    for (int i = 0; i < CARRIERS; i++) {
        double place[3];
        bool near = true;
        if (t->piece[corner[i]] != t->piece[corner[0]]) return true;
        place_of(t->sites, corner[i], place);
        for (int d = 0; d < 3; d++)
            near &= fmin(X[d], place[d]) <= box->high[d] && fmax(X[d], place[d]) >= box->low[d];
        if (near && sm_cut_crosses(t->cut, first, X, place)) return true;
    }
    return false;
}

static bool agree(void *carriers, long u, long v)
{
    const EmbedCut *t = carriers;
    const int *a = t->embedding->corner[u], *b = t->embedding->corner[v];
    double from[3], to[3];
    if (t->piece[a[0]] != t->piece[b[0]]) return false;
    if (a[0] == b[0]) return true;
    place_of(t->sites, a[0], from);
    place_of(t->sites, b[0], to);
    if (!sm_cut_crosses(t->cut, 0, from, to)) return true;
    for (int n = 0; n < CARRIERS * CARRIERS; n++)
        if (a[n / CARRIERS] == b[n % CARRIERS]) return true;
    return false;
}

/* Vertex v is carried by what the first particle of u sees near it, or else by all that carry u. */
static void follow(void *carriers, long v, long u)
{
    EmbedCut *t = carriers;
    const SmVoxels *voxels = t->sites->voxels;
    const double *X = t->mesh->position[v];
    const int *corner = t->embedding->corner[u];
    double eye[3];
    Carriers chosen;
    place_of(t->sites, corner[0], eye);
    if (choose_any(t, X, eye, &chosen) < 3) {
        chosen.count = 0;
        for (int i = 0; i < CARRIERS; i++) {
            if (i > 0 && corner[i] == corner[0]) break; /* beyond those in use */
            place_of(t->sites, corner[i], eye);
            for (int d = 0; d < 3; d++) chosen.at[chosen.count][d] = (eye[d] - X[d]) / voxels->cell;
            chosen.particle[chosen.count++] = corner[i];
        }
    }
    weigh(t, v, &chosen);
}

void sm_embed_cut(SmEmbedding *embedding, const SmMesh *mesh, const SmSites *sites,
                  const SmCut *cut, long first, const int *piece)
{
    EmbedCut t = {embedding, mesh, sites, cut, piece, .flat_room = embedding->flat_count};
    double margin = 1e-6 * sites->voxels->cell;
    SmBox fresh = box_of(cut, first, margin), all = box_of(cut, 0, margin);
    long before = embedding->vertex_count;
    t.normal = sm_mesh_normals(mesh, sites->voxels->cell);
    t.flat = sm_alloc((size_t)mesh->vertex_count, sizeof *t.flat);
    for (long v = 0; v < mesh->vertex_count; v++) t.flat[v] = -1;
    for (long n = 0; n < embedding->flat_count; n++) t.flat[embedding->flat[n].vertex] = (int)n;
    sm_embed_grow(embedding, mesh, sites, (const double(*)[3])t.normal);
    for (long v = 0; v < mesh->vertex_count; v++)
        if (is_parted(&t, v, v < before ? first : 0, v < before ? &fresh : &all)) carry(&t, v);
    sm_make_sides_consistent(mesh, agree, follow, &t);
    free(t.normal);
    free(t.flat);
}
