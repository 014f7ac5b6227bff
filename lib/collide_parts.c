#include "collide_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "collide_hash.h"
#include "error.h"

#define LOOSE 0.1 /* edges: how far a cell's axes reach beyond its bent corners */

/* A cell and the cube that it is in. */
typedef struct {
    int cube[3], cell;
} Place;

static int compare_places(const void *a, const void *b)
{
    const Place *x = a, *y = b;
    for (int d = 3; d-- > 0;)
        if (x->cube[d] != y->cube[d]) return x->cube[d] < y->cube[d] ? -1 : 1;
    return (x->cell > y->cell) - (x->cell < y->cell);
}

static bool same_cube(const Place *a, const Place *b)
{
    return !memcmp(a->cube, b->cube, sizeof a->cube);
}

static void split(const SmCollideShape *shape, SmCollideParts *parts)
{
    long cells = shape->cell_count;
    Place *place = sm_alloc((size_t)cells, sizeof *place);
    for (long k = 0; k < cells; k++) {
        place[k].cell = (int)k;
        for (int d = 0; d < 3; d++)
            place[k].cube[d] = (int)floor(shape->cell[k].centre[d] / (2 * shape->mean));
    }
    qsort(place, (size_t)cells, sizeof *place, compare_places);
    parts->cell = sm_alloc((size_t)cells, sizeof *parts->cell);
    parts->cell_first = sm_alloc((size_t)cells + 1, sizeof *parts->cell_first);
    for (long k = 0; k < cells; k++) {
        if (k == 0 || !same_cube(&place[k], &place[k - 1])) parts->cell_first[parts->count++] = k;
        parts->cell[k] = place[k].cell;
    }
    parts->cell_first[parts->count] = cells;
    free(place);
}

/* Carriers, and the surface nodes among them that no part before has. */
static void list_nodes(const SmCollideShape *shape, SmCollideParts *parts)
{
    size_t most = (size_t)(shape->cell_count * shape->carriers), count = (size_t)parts->count;
    long *seen = sm_alloc((size_t)shape->nodes, sizeof *seen); /* part that has it, from 1 */
    char *wanted = sm_alloc((size_t)shape->nodes, 1);
    for (long i = 0; i < shape->surface_count; i++) wanted[shape->surface[i]] = 1;
    parts->carrier = sm_alloc(most, sizeof *parts->carrier);
    parts->node = sm_alloc((size_t)shape->surface_count, sizeof *parts->node);
    parts->carrier_first = sm_alloc(count + 1, sizeof(long));
    parts->node_first = sm_alloc(count + 1, sizeof(long));
    parts->margin = sm_alloc(count, sizeof *parts->margin);
    long carriers = 0, nodes = 0;
    for (long p = 0; p < parts->count; p++) {
        for (long i = parts->cell_first[p]; i < parts->cell_first[p + 1]; i++) {
            const SmCollideCell *cell = &shape->cell[parts->cell[i]];
            double out = shape->carriers == 1 ? sqrt(0.75) : LOOSE;
            parts->margin[p] = fmax(parts->margin[p], out * cell->edge);
            for (int c = 0; c < shape->carriers; c++) {
                int node = cell->carrier[c];
                if (seen[node] == p + 1) continue;
                seen[node] = p + 1;
                parts->carrier[carriers++] = node;
                if (wanted[node]) parts->node[nodes++] = node;
                wanted[node] = 0;
            }
        }
        parts->loosest = fmax(parts->loosest, parts->margin[p]);
        parts->carrier_first[p + 1] = carriers;
        parts->node_first[p + 1] = nodes;
    }
    free(seen);
    free(wanted);
}

double sm_collide_parts_ball(const SmCollideParts *parts, const double (*x)[3], long p,
                             double centre[3])
{
    long first = parts->carrier_first[p], end = parts->carrier_first[p + 1];
    double sum[3] = {0}, most = 0;
    for (long i = first; i < end; i++)
        for (int d = 0; d < 3; d++) sum[d] += x[parts->carrier[i]][d];
    for (int d = 0; d < 3; d++) centre[d] = sum[d] / (double)(end - first);
    for (long i = first; i < end; i++) {
        const double *at = x[parts->carrier[i]];
        double a = at[0] - centre[0], b = at[1] - centre[1], c = at[2] - centre[2];
        double square = a * a + b * b + c * c;
        most = square > most ? square : most;
    }
    return sqrt(most) + parts->margin[p];
}

/* Whether every node of a is near every cell of b. */
static bool all_near(const SmCollideShape *shape, const SmCollideParts *parts, long a, long b)
{
    for (long i = parts->node_first[a]; i < parts->node_first[a + 1]; i++)
        for (long k = parts->cell_first[b]; k < parts->cell_first[b + 1]; k++)
            if (!sm_collide_near(shape, parts->node[i], parts->cell[k])) return false;
    return true;
}

static int compare(const void *a, const void *b)
{
    const int *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static void list_joined(const SmCollideShape *shape, SmCollideParts *parts)
{
    SmCollideHash hash = {0};
    long count = 0, room = 0;
    double centre[3], low[3], high[3];
    sm_collide_hash_start(&hash, parts->count, 4 * shape->mean);
    for (long p = 0; p < parts->count; p++) {
        double radius = sm_collide_parts_ball(parts, (const double(*)[3])shape->x0, p, centre);
        parts->widest = fmax(parts->widest, radius);
        sm_collide_hash_add(&hash, p, centre);
    }
    sm_collide_hash_finish(&hash);
    parts->joined_first = sm_alloc((size_t)parts->count + 1, sizeof(long));
    for (long p = 0; p < parts->count; p++) {
        long first = count;
        sm_collide_parts_ball(parts, (const double(*)[3])shape->x0, p, centre);
        for (int d = 0; d < 3; d++) { /* parts farther off are not in each other's way at rest */
            low[d] = centre[d] - 2.5 * parts->widest;
            high[d] = centre[d] + 2.5 * parts->widest;
        }
        const SmCollideEntry *entry;
        SmCollideQuery query;
        for (sm_collide_hash_query(&hash, low, high, &query);
             (entry = sm_collide_hash_next(&hash, &query));) {
            if (!all_near(shape, parts, p, entry->item) || !all_near(shape, parts, entry->item, p))
                continue;
            if (count == room) {
                room = 2 * room + 64;
                parts->joined = sm_realloc(parts->joined, (size_t)room, sizeof(int));
            }
            parts->joined[count++] = entry->item;
        }
        parts->joined_first[p + 1] = count;
        if (count > first)
            qsort(parts->joined + first, (size_t)(count - first), sizeof(int), compare);
    }
    sm_collide_hash_free(&hash);
}

bool sm_collide_parts_joined(const SmCollideParts *parts, long a, long b)
{
    long low = parts->joined_first[a], high = parts->joined_first[a + 1];
    while (low < high) {
        long middle = (low + high) / 2;
        if (parts->joined[middle] < b)
            low = middle + 1;
        else
            high = middle;
    }
    return low < parts->joined_first[a + 1] && parts->joined[low] == b;
}

void sm_collide_parts_build(const SmCollideShape *shape, SmCollideParts *parts)
{
    *parts = (SmCollideParts){0};
    split(shape, parts);
    list_nodes(shape, parts);
    list_joined(shape, parts);
}

void sm_collide_parts_free(SmCollideParts *parts)
{
    void *all[] = {parts->cell_first,   parts->node_first, parts->carrier_first,
                   parts->joined_first, parts->cell,       parts->node,
                   parts->carrier,      parts->joined,     parts->margin};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *parts = (SmCollideParts){0};
}

long sm_collide_parts_bytes(const SmCollideParts *parts)
{
    long n = parts->count;
    long ints = parts->cell_first[n] + parts->node_first[n] + parts->carrier_first[n] +
                parts->joined_first[n];
    return ints * (long)sizeof(int) + n * (long)(4 * sizeof(long) + sizeof(double));
}
