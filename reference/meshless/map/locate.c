#include "locate.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "../../../lib/error.h"

enum { LEAF = 4 };

void ref_locator_free(RefLocator *locator)
{
    sm_free_all(locator->placed, locator->node);
    *locator = (RefLocator){0};
}

static double middle_of(const RefPlaced *placed, int axis)
{
    return placed->corner[0][axis] + placed->corner[1][axis] + placed->corner[2][axis];
}

/* Puts the lesser half along an axis before the others (Hoare's selection). */
static void halve(RefPlaced *placed, int count, int axis)
{
    int low = 0, high = count - 1, half = count / 2;
    while (low < high) {
        double pivot = middle_of(placed + (low + high) / 2, axis);
        int i = low, j = high;
        while (i <= j) {
            while (middle_of(placed + i, axis) < pivot) i++;
            while (middle_of(placed + j, axis) > pivot) j--;
            if (i > j) break;
            RefPlaced other = placed[i];
            placed[i++] = placed[j];
            placed[j--] = other;
        }
        if (j < half) low = i;
        if (i > half) high = j;
    }
}

static void fit_box(const RefPlaced *placed, RefLocatorNode *node)
{
    for (int n = node->first; n < node->first + node->count; n++) node->sum += placed[n].value;
    for (int d = 0; d < 2; d++) {
        node->low[d] = INFINITY;
        node->high[d] = -INFINITY;
        for (int n = node->first; n < node->first + node->count; n++)
            for (int i = 0; i < 3; i++) {
                node->low[d] = fmin(node->low[d], placed[n].corner[i][d]);
                node->high[d] = fmax(node->high[d], placed[n].corner[i][d]);
            }
    }
}

void ref_locator_create(int count, RefPlaced *placed, RefLocator *locator)
{
    *locator = (RefLocator){.placed = placed, .nodes = 1};
    locator->node = sm_alloc(2 * (size_t)count + 1, sizeof *locator->node);
    locator->node[0] = (RefLocatorNode){.count = count};
    for (int at = 0; at < locator->nodes; at++) {
        RefLocatorNode *node = locator->node + at;
        fit_box(placed, node);
        node->child = -1;
        if (node->count <= LEAF) continue;
        int axis = node->high[1] - node->low[1] > node->high[0] - node->low[0];
        int half = node->count / 2;
        halve(placed + node->first, node->count, axis);
        node->child = locator->nodes;
        locator->node[locator->nodes++] = (RefLocatorNode){.first = node->first, .count = half};
        locator->node[locator->nodes++] =
            (RefLocatorNode){.first = node->first + half, .count = node->count - half};
    }
}

/* The weights of the corners at a place; returns the least of them. */
static double weigh(const RefPlaced *placed, const double theta[2], double weight[3])
{
    double way[3][2], sum = 0, least = INFINITY;
    for (int i = 0; i < 3; i++)
        for (int d = 0; d < 2; d++) way[i][d] = placed->corner[i][d] - theta[d];
    for (int i = 0; i < 3; i++) {
        const double *a = way[(i + 1) % 3], *b = way[(i + 2) % 3];
        weight[i] = a[0] * b[1] - a[1] * b[0];
        sum += weight[i];
    }
    for (int i = 0; i < 3; i++) {
        weight[i] /= sum;
        least = fmin(least, weight[i]);
    }
    return isfinite(least) ? least : -INFINITY;
}

typedef struct {
    const double *theta;
    double margin; /* by which boxes are larger */
    const RefPlaced *best;
    double least, weight[3];
} Search;

static void search(const RefLocator *locator, int at, Search *s)
{
    const RefLocatorNode *node = locator->node + at;
    for (int d = 0; d < 2; d++)
        if (!(s->theta[d] >= node->low[d] - s->margin && s->theta[d] <= node->high[d] + s->margin))
            return;
    if (node->child >= 0) {
        search(locator, node->child, s);
        if (!(s->least >= 0)) search(locator, node->child + 1, s);
        return;
    }
    for (int n = node->first; n < node->first + node->count; n++) {
        double weight[3], least = weigh(locator->placed + n, s->theta, weight);
        if (s->best && !(least > s->least)) continue;
        s->best = locator->placed + n;
        s->least = least;
        for (int i = 0; i < 3; i++) s->weight[i] = weight[i];
    }
}

const RefPlaced *ref_locator_at(const RefLocator *locator, const double theta[2], double weight[3])
{
    const RefLocatorNode *root = locator->node;
    double size = fmax(root->high[0] - root->low[0], root->high[1] - root->low[1]), sum = 0;
    Search s = {.theta = theta, .margin = 1e-14 * size, .least = -INFINITY};
    for (; !s.best && s.margin < 1e3 * size; s.margin *= 100) search(locator, 0, &s);
    if (!s.best) s.best = locator->placed;
    for (int i = 0; i < 3; i++) {
        weight[i] = isfinite(s.weight[i]) ? fmax(s.weight[i], 0) : 0;
        sum += weight[i];
    }
    for (int i = 0; i < 3; i++) weight[i] = sum > 0 ? weight[i] / sum : 1.0 / 3;
    return s.best;
}

static double add_up(const RefLocator *locator, int at, const double low[2], const double high[2])
{
    const RefLocatorNode *node = locator->node + at;
    bool inside = true;
    double sum = 0;
    for (int d = 0; d < 2; d++) {
        if (node->high[d] < low[d] || node->low[d] > high[d]) return 0;
        inside = inside && node->low[d] >= low[d] && node->high[d] <= high[d];
    }
    if (inside) return node->sum;
    if (node->child >= 0)
        return add_up(locator, node->child, low, high) +
               add_up(locator, node->child + 1, low, high);
    for (int n = node->first; n < node->first + node->count; n++) {
        const RefPlaced *placed = locator->placed + n;
        bool holds = true;
        for (int d = 0; d < 2; d++) {
            double middle = middle_of(placed, d) / 3;
            holds = holds && middle >= low[d] && middle < high[d];
        }
        if (holds) sum += placed->value;
    }
    return sum;
}

double ref_locator_sum(const RefLocator *locator, const double low[2], const double high[2])
{
    return add_up(locator, 0, low, high);
}
