#include "decimate.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "../vector.h"

enum { RING = 64 };    /* most neighbours that a vertex may get */
enum { CHILDREN = 4 }; /* of a place in the heap: in one or two lines of the cache */

/* x' A x + 2 b' x + c with symmetric A (xx, xy, xz, yy, yz, zz). */
typedef struct {
    double a[6], b[3], c;
} Quadric;

typedef struct {
    float cost;
    int u, v;
    unsigned versions; /* the sum of u's and v's: as long as both are there it only rises */
} Candidate;

/* Corners (3 * triangle + corner) of one vertex form a list: head[vertex], then next[corner]. */
typedef struct {
    SmMesh *mesh;
    Quadric *quadric;
    unsigned *version; /* of each vertex; rises when it moves */
    int *head, *next;  /* -1: it is gone */
    Candidate *heap;
    long heap_count, heap_room;
} Collapse;

static void quadric_add(Quadric *q, const Quadric *other)
{
    for (int i = 0; i < 6; i++) q->a[i] += other->a[i];
    for (int i = 0; i < 3; i++) q->b[i] += other->b[i];
    q->c += other->c;
}

/* weight * (n . (x - p))^2 */
static void quadric_add_plane(Quadric *q, double weight, const double n[3], const double p[3])
{
    double d = -sm_dot(n, p);
    Quadric plane = {{n[0] * n[0], n[0] * n[1], n[0] * n[2], n[1] * n[1], n[1] * n[2], n[2] * n[2]},
                     {d * n[0], d * n[1], d * n[2]},
                     d * d};
    for (int i = 0; i < 6; i++) q->a[i] += weight * plane.a[i];
    for (int i = 0; i < 3; i++) q->b[i] += weight * plane.b[i];
    q->c += weight * plane.c;
}

/* weight * |x - p|^2: keeps every system solvable and the spacing even. */
static void quadric_add_point(Quadric *q, double weight, const double p[3])
{
    q->a[0] += weight, q->a[3] += weight, q->a[5] += weight;
    for (int i = 0; i < 3; i++) q->b[i] -= weight * p[i];
    q->c += weight * sm_dot(p, p);
}

static double quadric_at(const Quadric *q, const double x[3])
{
    const double *a = q->a;
    return a[0] * x[0] * x[0] + a[3] * x[1] * x[1] + a[5] * x[2] * x[2] +
           2 * (a[1] * x[0] * x[1] + a[2] * x[0] * x[2] + a[4] * x[1] * x[2] + sm_dot(q->b, x)) +
           q->c;
}

/* The minimiser, by Cramer's rule; `fallback` when the system is singular. */
static void quadric_minimum(const Quadric *q, const double fallback[3], double x[3])
{
    const double *a = q->a, *b = q->b;
    double m[6] = {a[3] * a[5] - a[4] * a[4], a[2] * a[4] - a[1] * a[5], a[1] * a[4] - a[2] * a[3],
                   a[0] * a[5] - a[2] * a[2], a[1] * a[2] - a[0] * a[4], a[0] * a[3] - a[1] * a[1]};
    double determinant = a[0] * m[0] + a[1] * m[1] + a[2] * m[2];
    if (!(determinant > 0)) {
        memcpy(x, fallback, 3 * sizeof *x);
        return;
    }
    x[0] = -(m[0] * b[0] + m[1] * b[1] + m[2] * b[2]) / determinant;
    x[1] = -(m[1] * b[0] + m[3] * b[1] + m[4] * b[2]) / determinant;
    x[2] = -(m[2] * b[0] + m[4] * b[1] + m[5] * b[2]) / determinant;
}

static bool cheaper(const Candidate *a, const Candidate *b)
{
    if (a->cost != b->cost) return a->cost < b->cost;
    return a->u != b->u ? a->u < b->u : a->v < b->v;
}

static void heap_sink(Collapse *c, long i)
{
    Candidate moved = c->heap[i];
    for (long child; (child = CHILDREN * i + 1) < c->heap_count; i = child) {
        long end = child + CHILDREN < c->heap_count ? child + CHILDREN : c->heap_count;
        for (long other = child + 1; other < end; other++)
            if (cheaper(&c->heap[other], &c->heap[child])) child = other;
        if (!cheaper(&c->heap[child], &moved)) break;
        c->heap[i] = c->heap[child];
    }
    c->heap[i] = moved;
}

static void heap_rise(Collapse *c, long i)
{
    Candidate moved = c->heap[i];
    for (long parent; i > 0 && cheaper(&moved, &c->heap[parent = (i - 1) / CHILDREN]); i = parent)
        c->heap[i] = c->heap[parent];
    c->heap[i] = moved;
}

static Candidate heap_pop(Collapse *c)
{
    Candidate top = c->heap[0];
    c->heap[0] = c->heap[--c->heap_count];
    if (c->heap_count) heap_sink(c, 0);
    return top;
}

/* Where edge u-v collapses to, and the cost of that. */
static double collapse_point(const Collapse *c, int u, int v, double x[3])
{
    Quadric sum = c->quadric[u];
    double middle[3];
    quadric_add(&sum, &c->quadric[v]);
    for (int i = 0; i < 3; i++)
        middle[i] = 0.5 * (c->mesh->position[u][i] + c->mesh->position[v][i]);
    quadric_minimum(&sum, middle, x);
    return fmax(0, quadric_at(&sum, x));
}

static Candidate candidate(const Collapse *c, int u, int v)
{
    double x[3];
    int a = u < v ? u : v, b = u < v ? v : u;
    return (Candidate){(float)collapse_point(c, a, b, x), a, b, c->version[a] + c->version[b]};
}

static void heap_append(Collapse *c, Candidate added)
{
    sm_make_room(c->heap, c->heap_room, c->heap_count + 1);
    c->heap[c->heap_count++] = added;
}

/* Neighbours of v in `ring`; RING + 1 when there are more. */
static int neighbours(const Collapse *c, int v, int ring[RING])
{
    int count = 0; /* in a closed fan every neighbour follows v in exactly one triangle */
    for (int corner = c->head[v]; corner >= 0; corner = c->next[corner]) {
        if (count == RING) return RING + 1;
        ring[count++] = c->mesh->triangle[corner / 3][(corner % 3 + 1) % 3];
    }
    return count;
}

/* Link condition: u and v have exactly the two wings of their edge in common, and the merged vertex
 * keeps at least three neighbours. */
static bool linked_well(const Collapse *c, int u, int v)
{
    int ring_u[RING], ring_v[RING], common = 0;
    int nu = neighbours(c, u, ring_u), nv = neighbours(c, v, ring_v);
    if (nu > RING || nv > RING || nu + nv - 4 > RING || nu + nv - 4 < 3) return false;
    for (int i = 0; i < nu; i++)
        for (int j = 0; j < nv; j++) common += ring_u[i] == ring_v[j];
    return common == 2;
}

/* Adds the area vectors of the triangles around v to `sum`. */
static void add_normal(const Collapse *c, int v, double sum[3])
{
    for (int corner = c->head[v]; corner >= 0; corner = c->next[corner]) {
        const int *t = c->mesh->triangle[corner / 3];
        double n[3];
        sm_area_vector(c->mesh->position[t[0]], c->mesh->position[t[1]], c->mesh->position[t[2]],
                       n);
        for (int i = 0; i < 3; i++) sum[i] += n[i];
    }
}

/* Whether the triangles of u that stay (those without v) keep their sides when u moves to x. A
 * sliver's own normal is mostly rounding: it is compared with `normal`, that of the neighbourhood.
 */
static bool moves_well(const Collapse *c, int u, int v, const double x[3], const double normal[3])
{
    const SmMesh *m = c->mesh;
    for (int corner = c->head[u]; corner >= 0; corner = c->next[corner]) {
        const int *t = m->triangle[corner / 3];
        int a = t[(corner % 3 + 1) % 3], b = t[(corner % 3 + 2) % 3];
        if (a == v || b == v) continue;
        double before[3], after[3], side[3];
        sm_area_vector(m->position[u], m->position[a], m->position[b], before);
        sm_area_vector(x, m->position[a], m->position[b], after);
        sm_subtract(m->position[a], m->position[b], side);
        double old = sqrt(sm_dot(before, before)), new = sqrt(sm_dot(after, after));
        double flat = 0.05 * sm_dot(side, side);
        const double *reference = old > flat ? before : normal;
        if (sm_dot(reference, after) < 0.2 * sqrt(sm_dot(reference, reference)) * new) return false;
        if (new < flat &&new <= old) return false;
    }
    return true;
}

/* Finds a place for the merged vertex that turns no triangle over: the best one, the middle, or an
 * end. */
static bool place_merged(const Collapse *c, int u, int v, double x[3])
{
    const double *p = c->mesh->position[u], *q = c->mesh->position[v];
    double normal[3] = {0, 0, 0};
    add_normal(c, u, normal);
    add_normal(c, v, normal);
    collapse_point(c, u, v, x);
    for (int attempt = 0; attempt < 4; attempt++) {
        if (moves_well(c, u, v, x, normal) && moves_well(c, v, u, x, normal)) return true;
        for (int i = 0; i < 3; i++)
            x[i] = attempt == 0 ? 0.5 * (p[i] + q[i]) : attempt == 1 ? p[i] : q[i];
    }
    return false;
}

static void merge(Collapse *c, int u, int v, const double x[3])
{
    SmMesh *m = c->mesh;
    int *link = &c->head[u], tail = -1, joined = -1;
    for (int list = 0; list < 2; list++) {
        int corner = list ? c->head[v] : *link;
        for (int next; corner >= 0; corner = next) {
            int *t = m->triangle[corner / 3];
            next = c->next[corner];
            bool dies = list ? t[0] < 0 : t[0] == v || t[1] == v || t[2] == v;
            if (dies) {
                /* Wings leave the lists of u and v here, and of the third corner below. */
                if (list) continue;
                for (int k = 0; k < 3; k++) {
                    if (t[k] == u || t[k] == v) continue;
                    int *from = &c->head[t[k]], gone = corner - corner % 3 + k;
                    while (*from != gone) from = &c->next[*from];
                    *from = c->next[gone];
                }
                t[0] = t[1] = t[2] = -1;
                continue;
            }
            t[corner % 3] = u;
            if (tail < 0)
                joined = corner;
            else
                c->next[tail] = corner;
            tail = corner;
        }
    }
    c->next[tail] = -1;
    c->head[u] = joined;
    c->head[v] = -1;
    quadric_add(&c->quadric[u], &c->quadric[v]);
    memcpy(m->position[u], x, sizeof m->position[u]);
    c->version[u]++;
}

static bool is_current(const Collapse *c, Candidate e)
{
    return c->head[e.u] >= 0 && c->head[e.v] >= 0 &&
           c->version[e.u] + c->version[e.v] == e.versions;
}

static void heap_order(Collapse *c)
{
    for (long i = (c->heap_count + CHILDREN - 2) / CHILDREN; i-- > 0;) heap_sink(c, i);
}

/* Each costs a way through the whole heap when it comes to the top. */
static void drop_outdated(Collapse *c)
{
    long kept = 0;
    for (long i = 0; i < c->heap_count; i++)
        if (is_current(c, c->heap[i])) c->heap[kept++] = c->heap[i];
    c->heap_count = kept;
    heap_order(c);
}

static void collapse_until(Collapse *c, long live, long wanted)
{
    while (live > wanted && c->heap_count) {
        Candidate e = heap_pop(c);
        double x[3];
        if (!is_current(c, e)) continue;
        if (!linked_well(c, e.u, e.v) || !place_merged(c, e.u, e.v, x)) continue;
        merge(c, e.u, e.v, x);
        live -= 2;
        int ring[RING], count = neighbours(c, e.u, ring);
        for (int i = 0; i < count; i++) {
            heap_append(c, candidate(c, e.u, ring[i]));
            heap_rise(c, c->heap_count - 1);
        }
        if (c->heap_count > 2 * live) drop_outdated(c); /* edges are 1.5 times the triangles */
    }
}

static void prepare(Collapse *c)
{
    SmMesh *m = c->mesh;
    for (long v = 0; v < m->vertex_count; v++) c->head[v] = -1;
    for (long t = 0; t < m->triangle_count; t++) {
        const int *corner = m->triangle[t];
        double n[3];
        sm_area_vector(m->position[corner[0]], m->position[corner[1]], m->position[corner[2]], n);
        double area = sqrt(sm_dot(n, n));
        for (int i = 0; i < 3 && area > 0; i++) n[i] /= area;
        for (int k = 0; k < 3; k++) {
            Quadric *q = &c->quadric[corner[k]];
            quadric_add_plane(q, area, n, m->position[corner[0]]);
            quadric_add_point(q, 0.01 * area, m->position[corner[k]]);
            c->next[3 * t + k] = c->head[corner[k]];
            c->head[corner[k]] = (int)(3 * t + k);
        }
    }
    for (long t = 0; t < m->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            int u = m->triangle[t][k], v = m->triangle[t][(k + 1) % 3];
            if (u < v) heap_append(c, candidate(c, u, v));
        }
    heap_order(c);
}

/* Drops triangles and vertices that are gone; what stays keeps its order. */
static void compact(Collapse *c)
{
    SmMesh *m = c->mesh;
    long vertices = 0, triangles = 0;
    for (long v = 0; v < m->vertex_count; v++) {
        if (c->head[v] < 0) continue;
        memcpy(m->position[vertices], m->position[v], sizeof m->position[v]);
        c->head[v] = (int)vertices++;
    }
    for (long t = 0; t < m->triangle_count; t++) {
        if (m->triangle[t][0] < 0) continue;
        for (int k = 0; k < 3; k++) m->triangle[triangles][k] = c->head[m->triangle[t][k]];
        triangles++;
    }
    m->vertex_count = vertices;
    m->triangle_count = triangles;
}

void sm_decimate(SmMesh *mesh, long triangles)
{
    Collapse c = {.mesh = mesh, .heap_room = 3 * mesh->triangle_count};
    size_t vertices = (size_t)mesh->vertex_count;
    c.quadric = sm_alloc(vertices, sizeof *c.quadric);
    c.version = sm_alloc(vertices, sizeof *c.version);
    c.head = sm_alloc(vertices, sizeof *c.head);
    c.next = sm_alloc(3 * (size_t)mesh->triangle_count, sizeof *c.next);
    c.heap = sm_alloc((size_t)c.heap_room, sizeof *c.heap);
    prepare(&c);
    collapse_until(&c, mesh->triangle_count, triangles);
    compact(&c);
    sm_free_all(c.quadric, c.version, c.head, c.next, c.heap);
}
