#include "split_components.h"

#include <stdlib.h>
#include <string.h>

/* From a corner to the next, in a triangle that goes. */
typedef struct {
    int from, to;
    bool shared, used; /* with another that goes; in a fan already */
} Side;

typedef struct {
    SmMesh *mesh;
    Side *side;  /* [count] by `from`, then `to` */
    Side **path; /* [count] scratch */
    long count;
    int (*triangle)[3]; /* [made] of the fans */
    long made, room;
} Hole;

static bool parted(const SmMesh *mesh, const int *piece, long t)
{
    const int *corner = mesh->triangle[t];
    return piece[corner[0]] != piece[corner[1]] || piece[corner[0]] != piece[corner[2]];
}

static int compare(const void *a, const void *b)
{
    const Side *x = a, *y = b;
    if (x->from != y->from) return (x->from > y->from) - (x->from < y->from);
    return (x->to > y->to) - (x->to < y->to);
}

static Side *find(const Hole *hole, int from, int to)
{
    Side wanted = {.from = from, .to = to};
    return bsearch(&wanted, hole->side, (size_t)hole->count, sizeof wanted, compare);
}

/* The sides of all triangles that go, and which of them border on none that stays. */
static void find_sides(Hole *hole, const int *piece, long gone)
{
    const SmMesh *mesh = hole->mesh;
    hole->side = sm_alloc(3 * (size_t)gone, sizeof *hole->side);
    for (long t = 0; t < mesh->triangle_count; t++)
        for (int c = 0; c < 3 && parted(mesh, piece, t); c++)
            hole->side[hole->count++] =
                (Side){mesh->triangle[t][c], mesh->triangle[t][(c + 1) % 3], true, false};
    qsort(hole->side, (size_t)hole->count, sizeof *hole->side, compare);
    for (long t = 0; t < mesh->triangle_count; t++)
        for (int c = 0; c < 3 && !parted(mesh, piece, t); c++) {
            Side *side = find(hole, mesh->triangle[t][(c + 1) % 3], mesh->triangle[t][c]);
            if (side) side->shared = false;
        }
}

static void add_triangle(Hole *hole, int a, int b, int c)
{
    sm_make_room(hole->triangle, hole->room, hole->made + 1);
    hole->triangle[hole->made][0] = a;
    hole->triangle[hole->made][1] = b;
    hole->triangle[hole->made++][2] = c;
}

/* The next side round a hole, from `vertex` on, or NULL. */
static Side *next_side(const Hole *hole, int vertex)
{
    long low = 0, high = hole->count;
    while (low < high) {
        long middle = (low + high) / 2;
        if (hole->side[middle].from < vertex)
            low = middle + 1;
        else
            high = middle;
    }
    for (; low < hole->count && hole->side[low].from == vertex; low++)
        if (!hole->side[low].shared && !hole->side[low].used) return &hole->side[low];
    return NULL;
}

static int add_vertex(SmMesh *mesh, const double at[3])
{
    long n = mesh->vertex_count++;
    mesh->position = sm_realloc(mesh->position, (size_t)mesh->vertex_count, sizeof *mesh->position);
    memcpy(mesh->position[n], at, sizeof *mesh->position);
    return (int)n;
}

/* A fan over the sides of a loop. */
static void close_loop(Hole *hole, long count, Side *const *side)
{
    double middle[3] = {0};
    for (long n = 0; n < count; n++)
        for (int d = 0; d < 3; d++)
            middle[d] += hole->mesh->position[side[n]->from][d] / (double)count;
    int vertex = add_vertex(hole->mesh, middle);
    for (long n = 0; n < count; n++) add_triangle(hole, side[n]->from, side[n]->to, vertex);
}

/* Closes the hole that begins with a side. Where it comes by a vertex again that is a loop of its
 * own: one fan would have an edge to that vertex twice. */
static void fill(Hole *hole, Side *first)
{
    long count = 0;
    for (Side *side = first; side; side = next_side(hole, side->to)) {
        side->used = true;
        hole->path[count++] = side;
        long from = count - 1;
        while (from >= 0 && hole->path[from]->from != side->to) from--;
        if (from < 0) continue;
        close_loop(hole, count - from, hole->path + from);
        count = from;
    }
    if (count > 0) close_loop(hole, count, hole->path);
}

/* New triangles take the places of those that go; what follows moves up. */
static void replace(Hole *hole, const unsigned char *goes)
{
    SmMesh *mesh = hole->mesh;
    long used = 0, kept = 0;
    for (long t = 0; t < mesh->triangle_count; t++) {
        if (goes[t] && used < hole->made) {
            memcpy(mesh->triangle[kept++], hole->triangle[used++], sizeof *mesh->triangle);
        } else if (!goes[t]) {
            if (kept != t) memcpy(mesh->triangle[kept], mesh->triangle[t], sizeof *mesh->triangle);
            kept++;
        }
    }
    long all = kept + hole->made - used;
    mesh->triangle = sm_realloc(mesh->triangle, (size_t)all, sizeof *mesh->triangle);
    memcpy(mesh->triangle + kept, hole->triangle + used,
           (size_t)(hole->made - used) * sizeof *mesh->triangle);
    mesh->triangle_count = all;
}

long sm_split_components(SmMesh *mesh, const int *piece)
{
    Hole hole = {.mesh = mesh};
    unsigned char *goes = sm_alloc((size_t)mesh->triangle_count, 1);
    long gone = 0;
    for (long t = 0; t < mesh->triangle_count; t++) gone += goes[t] = parted(mesh, piece, t);
    if (gone > 0) {
        find_sides(&hole, piece, gone);
        hole.path = sm_alloc((size_t)hole.count, sizeof(Side *));
        for (long n = 0; n < hole.count; n++)
            if (!hole.side[n].shared && !hole.side[n].used) fill(&hole, &hole.side[n]);
        replace(&hole, goes);
    }
    sm_free_all(goes, hole.side, hole.path, hole.triangle);
    return gone;
}
