#include "mesh.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "../box.h"
#include "../csr.h"
#include "../edge.h"
#include "../system/hash.h"

static const double rounding_gap = 1e-7; /* of the box's longest side */
static const double no_height = 1e-14;   /* of a triangle's longest edge */

SmMesh sm_mesh_new(long vertices, long triangles)
{
    SmMesh mesh = {.vertex_count = vertices, .triangle_count = triangles};
    mesh.position = sm_alloc((size_t)vertices, sizeof *mesh.position);
    mesh.triangle = sm_alloc((size_t)triangles, sizeof *mesh.triangle);
    return mesh;
}

void sm_mesh_free(SmMesh *mesh)
{
    free(mesh->position);
    free(mesh->triangle);
    *mesh = (SmMesh){0};
}

static SmBox bounding_box(const SmMesh *mesh)
{
    const SmBox none = {{0}, {0}};
    return mesh->vertex_count
               ? sm_box_around(mesh->vertex_count, (const double(*)[3])mesh->position)
               : none;
}

/* ---- how triangles meet along edges */

/* Edges around one vertex are few: sorting them by insertion is linear in all of them. */
static void sort_pairs(int (*pair)[2], size_t count)
{
    if (count > 24) {
        qsort(pair, count, sizeof *pair, sm_compare_pairs);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        int moved[2] = {pair[i][0], pair[i][1]};
        size_t j = i;
        for (; j > 0 && sm_compare_pairs(pair[j - 1], moved) > 0; j--)
            memcpy(pair[j], pair[j - 1], sizeof moved);
        memcpy(pair[j], moved, sizeof moved);
    }
}

/* Returns all edges as (higher end, direction), sorted, by their lower end v: from start[v] to
 * start[v + 1], of [vertex_count + 2] zeros. The caller frees. */
static int (*sort_edges(const SmMesh *mesh, size_t *start))[2]
{
    int(*pair)[2] = sm_alloc(3 * (size_t)mesh->triangle_count, sizeof *pair);
    for (long t = 0; t < mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++) start[sm_edge(mesh->triangle[t], c, 0).low + 2]++;
    for (long v = 0; v < mesh->vertex_count; v++) start[v + 2] += start[v + 1];
    for (long t = 0; t < mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            SmEdge edge = sm_edge(mesh->triangle[t], c, 0);
            size_t at = start[edge.low + 1]++;
            pair[at][0] = edge.high;
            pair[at][1] = edge.forth;
        }
    for (long v = 0; v < mesh->vertex_count; v++)
        sort_pairs(pair + start[v], start[v + 1] - start[v]);
    return pair;
}

/* Counts the edges of each kind; an edge from a vertex to itself is not counted. The volume is NaN
 * where an edge is used more often one way than the other, and 0 where the triangles bound one.
 * `boundary` ([vertex_count], or NULL) gets true for the ends of open edges and is left alone
 * elsewhere. O(triangles), but n log n in the triangles around one vertex. */
static SmMeshInfo count_edges(const SmMesh *mesh, bool *boundary)
{
    SmMeshInfo info = {.triangles = mesh->triangle_count, .vertices = mesh->vertex_count};
    size_t *start = sm_alloc((size_t)mesh->vertex_count + 2, sizeof *start);
    int(*edge)[2] = sort_edges(mesh, start);
    for (long v = 0; v < mesh->vertex_count; v++)
        for (size_t i = start[v], next; i < start[v + 1]; i = next) {
            long up = edge[i][1]; /* how often from the lower end to the higher */
            for (next = i + 1; next < start[v + 1] && edge[next][0] == edge[i][0];)
                up += edge[next++][1];
            long uses = (long)(next - i);
            if (edge[i][0] == v) continue;
            if (uses == 1 && boundary) boundary[v] = boundary[edge[i][0]] = true;
            info.open_edges += uses == 1;
            info.nonmanifold_edges += uses > 2;
            info.flipped_edges += uses == 2 && up != 1;
            if (2 * up != uses) info.volume = NAN;
        }
    sm_free_all(start, edge);
    return info;
}

/* ---- merging of vertices */

static uint64_t hash_words(const uint64_t word[3])
{
    uint64_t hash = 0x9e3779b97f4a7c15u;
    for (int a = 0; a < 3; a++) {
        hash = (hash ^ word[a]) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 32;
    }
    return hash;
}

static uint64_t table_mask(long entries)
{
    uint64_t size = 16;
    while (size < 2 * (uint64_t)entries) size *= 2;
    return size - 1;
}

/* Lets each of `count` items of three words stand for the first one that is equal to it. */
static SmPieces equal_items(long count, const void *items)
{
    const char(*item)[3 * sizeof(uint64_t)] = items;
    SmPieces same;
    sm_pieces_init(count, &same);
    uint64_t mask = table_mask(count);
    int *table = sm_alloc(mask + 1, sizeof *table); /* item + 1, or 0 */
    for (long i = 0; i < count; i++) {
        uint64_t word[3];
        memcpy(word, item[i], sizeof word);
        uint64_t slot = hash_words(word) & mask;
        while (table[slot] && memcmp(item[table[slot] - 1], word, sizeof word) != 0)
            slot = (slot + 1) & mask;
        if (table[slot])
            sm_pieces_link(&same, i, table[slot] - 1);
        else
            table[slot] = (int)i + 1;
    }
    free(table);
    return same;
}

/* Triangles whose three corners an earlier one has too, in any order. */
static long count_duplicates(const SmMesh *mesh)
{
    uint64_t(*corners)[3] = sm_alloc((size_t)mesh->triangle_count, sizeof *corners);
    for (long t = 0; t < mesh->triangle_count; t++) {
        int corner[3];
        memcpy(corner, mesh->triangle[t], sizeof corner);
        sm_sort_ints(corner, 3);
        for (int c = 0; c < 3; c++) corners[t][c] = (uint64_t)corner[c];
    }
    SmPieces same = equal_items(mesh->triangle_count, corners);
    long duplicates = 0;
    for (long t = 0; t < mesh->triangle_count; t++) duplicates += sm_pieces_first(&same, t) != t;
    sm_pieces_free(&same);
    free(corners);
    return duplicates;
}

/* Replaces vertices by the first of their piece, then drops what sm_mesh_merge() says. */
static void collapse(SmMesh *mesh, SmPieces *same)
{
    int *number = sm_alloc((size_t)mesh->vertex_count, sizeof *number);
    long triangles = 0, vertices = 0;
    for (long t = 0; t < mesh->triangle_count; t++) {
        int corner[3];
        for (int c = 0; c < 3; c++) corner[c] = sm_pieces_first(same, mesh->triangle[t][c]);
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
        for (int c = 0; c < 3; c++) number[corner[c]] = 1;
        memcpy(mesh->triangle[triangles++], corner, sizeof corner);
    }
    for (long v = 0; v < mesh->vertex_count; v++) {
        if (!number[v]) continue;
        memmove(mesh->position[vertices], mesh->position[v], sizeof *mesh->position);
        number[v] = (int)vertices++;
    }
    for (long t = 0; t < triangles; t++)
        for (int c = 0; c < 3; c++) mesh->triangle[t][c] = number[mesh->triangle[t][c]];
    free(number);
    mesh->triangle_count = triangles;
    mesh->vertex_count = vertices;
    mesh->position = sm_realloc(mesh->position, (size_t)vertices, sizeof *mesh->position);
    mesh->triangle = sm_realloc(mesh->triangle, (size_t)triangles, sizeof *mesh->triangle);
}

/* Boundary vertices hashed by grid cell, for neighbours nearer than a cell's side. */
typedef struct {
    const SmMesh *mesh;
    double low[3], side;
    uint64_t mask;
    int *head, *next; /* vertex + 1, or 0: chains of one slot */
} Grid;

static uint64_t grid_slot(const Grid *grid, const double position[3], const int step[3])
{
    uint64_t word[3];
    for (int a = 0; a < 3; a++)
        word[a] = (uint64_t)((int64_t)((position[a] - grid->low[a]) / grid->side) + step[a]);
    return hash_words(word) & grid->mask;
}

static void unite_near(const Grid *grid, int v, SmPieces *same)
{
    enum { LONGEST_CHAIN = 64 }; /* bounds the cost where thousands crowd into one cell */
    const double *p = grid->mesh->position[v];
    for (int n = 0; n < 27; n++) {
        int step[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        int other = grid->head[grid_slot(grid, p, step)];
        for (int k = 0; other && k < LONGEST_CHAIN; k++, other = grid->next[other - 1]) {
            const double *q = grid->mesh->position[other - 1];
            if (sm_square_between(p, q) <= grid->side * grid->side)
                sm_pieces_link(same, v, other - 1);
        }
    }
}

static SmPieces near_positions(const SmMesh *mesh, const bool *boundary)
{
    SmPieces same;
    sm_pieces_init(mesh->vertex_count, &same);
    SmBox box = bounding_box(mesh);
    Grid grid = {.mesh = mesh, .mask = table_mask(mesh->vertex_count)};
    memcpy(grid.low, box.low, sizeof grid.low);
    grid.side = rounding_gap * sm_box_longest(&box);
    grid.head = sm_alloc(grid.mask + 1, sizeof *grid.head);
    grid.next = sm_alloc((size_t)mesh->vertex_count, sizeof *grid.next);
    for (int v = 0; v < mesh->vertex_count; v++) {
        if (!boundary[v]) continue;
        unite_near(&grid, v, &same);
        uint64_t slot = grid_slot(&grid, mesh->position[v], (int[3]){0, 0, 0});
        grid.next[v] = grid.head[slot];
        grid.head[slot] = v + 1;
    }
    free(grid.head);
    free(grid.next);
    return same;
}

SmMesh sm_mesh_copy(const SmMesh *mesh)
{
    SmMesh copy = sm_mesh_new(mesh->vertex_count, mesh->triangle_count);
    memcpy(copy.position, mesh->position, (size_t)mesh->vertex_count * sizeof *copy.position);
    memcpy(copy.triangle, mesh->triangle, (size_t)mesh->triangle_count * sizeof *copy.triangle);
    return copy;
}

static void close_rounding_gaps(SmMesh *mesh)
{
    if (!mesh->triangle_count) return;
    bool *boundary = sm_alloc((size_t)mesh->vertex_count, sizeof *boundary);
    SmMeshInfo before = count_edges(mesh, boundary);
    if (before.open_edges) {
        SmMesh closed = sm_mesh_copy(mesh);
        SmPieces same = near_positions(mesh, boundary);
        collapse(&closed, &same);
        sm_pieces_free(&same);
        SmMeshInfo after = count_edges(&closed, NULL);
        if (after.triangles && !after.open_edges &&
            after.nonmanifold_edges <= before.nonmanifold_edges) {
            SmMesh old = *mesh;
            *mesh = closed;
            closed = old;
        }
        sm_mesh_free(&closed);
    }
    free(boundary);
}

void sm_mesh_merge(SmMesh *mesh)
{
    for (long v = 0; v < mesh->vertex_count; v++)
        for (int a = 0; a < 3; a++) mesh->position[v][a] += 0.0; /* -0 becomes 0 */
    SmPieces same = equal_items(mesh->vertex_count, mesh->position);
    collapse(mesh, &same);
    sm_pieces_free(&same);
    close_rounding_gaps(mesh);
}

void sm_mesh_pieces(const SmMesh *mesh, SmPieces *pieces)
{
    int *first = sm_alloc((size_t)mesh->vertex_count, sizeof *first); /* triangle at it, + 1 */
    sm_pieces_init(mesh->triangle_count, pieces);
    for (long t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            int *triangle = &first[mesh->triangle[t][i]];
            if (*triangle > 0)
                sm_pieces_link(pieces, *triangle - 1, t);
            else
                *triangle = (int)t + 1;
        }
    free(first);
    sm_pieces_finish(pieces, NULL, mesh->triangle_count);
}

static bool is_degenerate(double edge[3][3])
{
    double normal[3];
    sm_cross(edge[0], edge[1], normal);
    double longest =
        fmax(sm_dot(edge[0], edge[0]), fmax(sm_dot(edge[1], edge[1]), sm_dot(edge[2], edge[2])));
    return sqrt(sm_dot(normal, normal)) <= no_height * longest;
}

typedef struct {
    double six_volumes;
    SmBox box;
} Component;

/* Components inside out, as the whole is not, in the box of the largest; not rounding's sign. */
static void count_cavities(long count, const Component *part, SmMeshInfo *info)
{
    const Component *largest = part;
    for (long c = 1; c < count; c++)
        if (fabs(part[c].six_volumes) > fabs(largest->six_volumes)) largest = part + c;
    for (long c = 0; c < count; c++)
        if (part[c].six_volumes / info->volume < -1e-9 &&
            sm_box_holds(&largest->box, part[c].box.low) &&
            sm_box_holds(&largest->box, part[c].box.high)) {
            info->cavities++;
            info->cavity_volume += fabs(part[c].six_volumes) / 6;
        }
}

/* Adds the volume about the box's centre, where a mesh far from the origin loses no digits. */
static void measure_triangles(const SmMesh *mesh, const SmPieces *pieces, SmMeshInfo *info)
{
    double six_volumes = 0, middle[3];
    Component *part = sm_alloc((size_t)pieces->count, sizeof *part);
    for (long c = 0; c < pieces->count; c++) part[c].box = sm_no_box();
    for (int a = 0; a < 3; a++) middle[a] = 0.5 * info->low[a] + 0.5 * info->high[a];
    for (long t = 0; t < mesh->triangle_count; t++) {
        Component *of = part + pieces->piece[t];
        double p[3][3], edge[3][3], normal[3];
        for (int c = 0; c < 3; c++) sm_subtract(mesh->position[mesh->triangle[t][c]], middle, p[c]);
        for (int c = 0; c < 3; c++) sm_subtract(p[(c + 1) % 3], p[c], edge[c]);
        for (int c = 0; c < 3; c++) sm_box_add(&of->box, p[c]);
        info->degenerate += is_degenerate(edge);
        sm_cross(p[1], p[2], normal);
        of->six_volumes += sm_dot(p[0], normal);
        six_volumes += sm_dot(p[0], normal);
    }
    info->volume += six_volumes / 6;
    count_cavities(pieces->count, part, info);
    free(part);
}

SmMeshInfo sm_mesh_info(const SmMesh *mesh)
{
    SmMeshInfo info = count_edges(mesh, NULL);
    info.watertight = info.triangles && !info.open_edges && !info.nonmanifold_edges;
    SmBox box = bounding_box(mesh);
    memcpy(info.low, box.low, sizeof info.low);
    memcpy(info.high, box.high, sizeof info.high);
    info.duplicates = count_duplicates(mesh);
    SmPieces pieces;
    sm_mesh_pieces(mesh, &pieces);
    info.components = pieces.count;
    measure_triangles(mesh, &pieces, &info);
    sm_pieces_free(&pieces);
    return info;
}

SmCode sm_mesh_check(const SmMesh *mesh, const char *name, SmError *error)
{
    if (mesh->triangle_count < 1) return sm_fail(error, SM_INPUT, "%s: no triangles", name);
    if (mesh->vertex_count > INT_MAX)
        return sm_fail(error, SM_INPUT, "%s: %ld vertices are more than %d", name,
                       mesh->vertex_count, INT_MAX);
    for (long v = 0; v < mesh->vertex_count; v++)
        for (int a = 0; a < 3; a++)
            if (!isfinite(mesh->position[v][a]))
                return sm_fail(error, SM_INPUT,
                               "%s: the %c of a vertex is not a finite number (nan, inf or too "
                               "large); correct it, or export the mesh again",
                               name, "xyz"[a]);
    for (long t = 0; t < mesh->triangle_count; t++)
        for (int c = 0; c < 3; c++)
            if (mesh->triangle[t][c] < 0 || mesh->triangle[t][c] >= mesh->vertex_count)
                return sm_fail(error, SM_INPUT,
                               "%s: a triangle names a vertex that is not there; export the mesh "
                               "again",
                               name);
    SmBox box = bounding_box(mesh);
    double side = sm_box_longest(&box);
    if (side == 0) return sm_fail(error, SM_INPUT, "%s: all vertices are at one point", name);
    if (side < 1e-30 || side > 1e30)
        return sm_fail(error, SM_INPUT, "%s: its size of %g is outside 1e-30 to 1e30; scale it",
                       name, side);
    return SM_OK;
}

SmCode sm_mesh_prepare(SmMesh *mesh, const char *name, SmError *error)
{
    SmCode code = sm_mesh_check(mesh, name, error);
    if (!code) {
        sm_mesh_merge(mesh);
        code =
            mesh->triangle_count > 0
                ? sm_mesh_check(mesh, name, error)
                : sm_fail(error, SM_INPUT, "%s: every triangle has two corners in one place", name);
    }
    if (code) sm_mesh_free(mesh);
    return code;
}

unsigned long long sm_mesh_hash(const SmMesh *mesh)
{
    size_t vertices = (size_t)mesh->vertex_count, triangles = (size_t)mesh->triangle_count;
    unsigned long long hash =
        sm_hash_bytes(SM_HASH_START, mesh->position, vertices * sizeof *mesh->position);
    return sm_hash_bytes(hash, mesh->triangle, triangles * sizeof *mesh->triangle);
}

void sm_mesh_print_obj(const SmMesh *mesh, FILE *file)
{
    for (long v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->position[v];
        fprintf(file, "v %.17g %.17g %.17g\n", p[0], p[1], p[2]);
    }
    for (long t = 0; t < mesh->triangle_count; t++) {
        const int *corner = mesh->triangle[t];
        fprintf(file, "f %ld %ld %ld\n", corner[0] + 1L, corner[1] + 1L, corner[2] + 1L);
    }
}

double (*sm_mesh_normals(const SmMesh *mesh, double unit))[3]
{
    double(*normal)[3] = sm_alloc((size_t)mesh->vertex_count, sizeof *normal);
    for (long t = 0; t < mesh->triangle_count; t++) {
        const int *corner = mesh->triangle[t];
        double u[3], v[3], n[3];
        for (int a = 0; a < 3; a++) {
            double origin = mesh->position[corner[0]][a];
            u[a] = (mesh->position[corner[1]][a] - origin) / unit;
            v[a] = (mesh->position[corner[2]][a] - origin) / unit;
        }
        sm_cross(u, v, n);
        for (int c = 0; c < 3; c++)
            for (int a = 0; a < 3; a++) normal[corner[c]][a] += n[a];
    }
    return normal;
}
