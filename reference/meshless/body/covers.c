#include "covers.h"

#include <math.h>
#include <stdlib.h>

#include "../../../lib/vector.h"

/* The numbers of the `wanted` smallest of so many values, at least as many, rising. */
static void smallest(size_t wanted, const double *value, size_t count, size_t *number)
{
    size_t found = 0;
    for (size_t n = 0; n < count; n++) {
        if (found == wanted && !(value[n] < value[number[wanted - 1]])) continue;
        size_t at = found < wanted ? found++ : wanted - 1;
        for (; at > 0 && !(value[n] > value[number[at - 1]]); at--) number[at] = number[at - 1];
        number[at] = n;
    }
}

/* Makes the covers of the `wanted` nodes nearest to x, of those that it sees, hold it well. */
static void enlarge(RefNodes *nodes, size_t wanted, const double x[3], double *distance,
                    size_t *nearest)
{
    size_t count = (size_t)(nodes->count + nodes->images);
    if (wanted > count) wanted = count;
    for (size_t n = 0; n < count; n++) {
        distance[n] = 0;
        for (int d = 0; d < 3; d++)
            distance[n] = fmax(distance[n], fabs(nodes->position[n][d] - x[d]));
        if (!ref_mls_sees(nodes, (long)n, x)) distance[n] = INFINITY;
    }
    smallest(wanted, distance, count, nearest);
    for (size_t k = 0; k < wanted; k++) {
        if (!isfinite(distance[nearest[k]])) break;
        size_t owner = nodes->owner ? (size_t)nodes->owner[nearest[k]] : nearest[k];
        double *reach = nodes->reach + owner;
        *reach = fmax(*reach, 1.25 * distance[nearest[k]]);
    }
}

/* Enlarges covers where `shape` is not defined; returns at how many points that was. */
static long enlarge_all(RefNodes *nodes, RefBasis basis, size_t wanted, long count,
                        const double (*x)[3])
{
    RefShape shape = ref_shape_create(nodes);
    size_t entries = (size_t)(nodes->count + nodes->images);
    double *distance = sm_alloc(entries, sizeof *distance);
    size_t *nearest = sm_alloc(entries, sizeof *nearest);
    long bad = 0;
    for (long p = 0; p < count; p++)
        if (!ref_mls_at(nodes, basis, x[p], &shape)) {
            bad++;
            if (wanted) enlarge(nodes, wanted, x[p], distance, nearest);
        }
    free(distance);
    free(nearest);
    ref_shape_free(&shape);
    return bad;
}

long ref_mls_cover(RefNodes *nodes, RefBasis basis, long count, const double (*x)[3])
{
    long bad = count;
    for (size_t round = 1; round <= 8; round++) {
        bad = enlarge_all(nodes, basis, 2 * round * (size_t)basis, count, x);
        if (bad == 0) return 0;
        ref_nodes_bin(nodes);
    }
    return enlarge_all(nodes, basis, 0, count, x);
}
