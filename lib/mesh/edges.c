#include "edges.h"

#include <stdlib.h>
#include <string.h>

/* Pairs of numbers in buckets by vertex: the lower end of an edge, the lowest corner of a
 * triangle. Buckets are short, so sorting each is linear in all. */
typedef struct {
    size_t *start; /* [vertex_count + 1] */
    int (*pair)[2];
} Buckets;

static int compare_pairs(const void *left, const void *right)
{
    const int *a = left, *b = right;
    int first = (a[0] > b[0]) - (a[0] < b[0]);
    return first ? first : (a[1] > b[1]) - (a[1] < b[1]);
}

static void sort_pairs(int (*pair)[2], size_t count)
{
    if (count > 24) {
        qsort(pair, count, sizeof *pair, compare_pairs);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        int moved[2] = {pair[i][0], pair[i][1]};
        size_t j = i;
        for (; j > 0 && compare_pairs(pair[j - 1], moved) > 0; j--)
            memcpy(pair[j], pair[j - 1], sizeof moved);
        memcpy(pair[j], moved, sizeof moved);
    }
}

/* start[v] holds the count of bucket v; makes it the end of the bucket, so that filling
 * backwards leaves it at the beginning. */
static void open_buckets(Buckets *buckets, long vertex_count)
{
    size_t sum = 0;
    for (long v = 0; v < vertex_count; v++) {
        sum += buckets->start[v];
        buckets->start[v] = sum;
    }
    buckets->start[vertex_count] = sum;
    buckets->pair = sm_alloc(sum, sizeof *buckets->pair);
}

static void sort_buckets(Buckets *buckets, long vertex_count)
{
    for (long v = 0; v < vertex_count; v++)
        sort_pairs(buckets->pair + buckets->start[v], buckets->start[v + 1] - buckets->start[v]);
}

static void free_buckets(Buckets *buckets)
{
    free(buckets->start);
    free(buckets->pair);
}

/* Edges in the bucket of their lower end as (higher end, direction). */
static Buckets bucket_edges(const SmMesh *mesh)
{
    Buckets buckets = {.start = sm_alloc((size_t)mesh->vertex_count + 1, sizeof(size_t))};
    for (int filling = 0; filling < 2; filling++) {
        for (long t = 0; t < mesh->triangle_count; t++) {
            for (int c = 0; c < 3; c++) {
                int a = mesh->triangle[t][c], b = mesh->triangle[t][(c + 1) % 3];
                if (a == b) continue;
                int low = a < b ? a : b;
                if (!filling) {
                    buckets.start[low]++;
                    continue;
                }
                int *pair = buckets.pair[--buckets.start[low]];
                pair[0] = a < b ? b : a;
                pair[1] = a < b;
            }
        }
        if (!filling) open_buckets(&buckets, mesh->vertex_count);
    }
    sort_buckets(&buckets, mesh->vertex_count);
    return buckets;
}

SmEdgeCounts sm_edges_count(const SmMesh *mesh, bool *boundary)
{
    SmEdgeCounts counts = {0};
    Buckets buckets = bucket_edges(mesh);
    for (long v = 0; v < mesh->vertex_count; v++) {
        size_t end = buckets.start[v + 1];
        for (size_t i = buckets.start[v], next; i < end; i = next) {
            const int *pair = buckets.pair[i];
            long up = pair[1]; /* how often from the lower end to the higher */
            for (next = i + 1; next < end && buckets.pair[next][0] == pair[0];)
                up += buckets.pair[next++][1];
            if (next - i == 1) {
                counts.open++;
                if (boundary) boundary[v] = boundary[pair[0]] = true;
            }
            counts.nonmanifold += next - i > 2;
            counts.unbalanced += 2 * up != (long)(next - i);
            counts.flipped += next - i == 2 && pair[1] == buckets.pair[i + 1][1];
        }
    }
    free_buckets(&buckets);
    return counts;
}

static void sort_corners(const int triangle[3], int corner[3])
{
    int a = triangle[0], b = triangle[1], c = triangle[2];
    corner[0] = a < b ? (a < c ? a : c) : (b < c ? b : c);
    corner[2] = a > b ? (a > c ? a : c) : (b > c ? b : c);
    corner[1] = (int)((long)a + b + c - corner[0] - corner[2]);
}

long sm_edges_duplicates(const SmMesh *mesh)
{
    Buckets buckets = {.start = sm_alloc((size_t)mesh->vertex_count + 1, sizeof(size_t))};
    int corner[3];
    for (long t = 0; t < mesh->triangle_count; t++) {
        sort_corners(mesh->triangle[t], corner);
        buckets.start[corner[0]]++;
    }
    open_buckets(&buckets, mesh->vertex_count);
    for (long t = 0; t < mesh->triangle_count; t++) {
        sort_corners(mesh->triangle[t], corner);
        memcpy(buckets.pair[--buckets.start[corner[0]]], corner + 1, 2 * sizeof(int));
    }
    sort_buckets(&buckets, mesh->vertex_count);
    long duplicates = 0;
    for (long v = 0; v < mesh->vertex_count; v++)
        for (size_t i = buckets.start[v] + 1; i < buckets.start[v + 1]; i++)
            duplicates += compare_pairs(buckets.pair[i - 1], buckets.pair[i]) == 0;
    free_buckets(&buckets);
    return duplicates;
}
