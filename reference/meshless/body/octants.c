#include "octants.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clip.h"
#include "walls.h"

void ref_octants_free(RefOctants *tree)
{
    free(tree->octant);
    free(tree->point);
    free(tree->wall);
    *tree = (RefOctants){0};
}

void ref_octants_centre(const RefOctants *tree, const RefOctant *octant, double centre[3])
{
    for (int d = 0; d < 3; d++)
        centre[d] = tree->origin[d] + tree->cell * (octant->corner[d] + 0.5 * octant->size);
}

int ref_octants_at(const RefOctants *tree, const int place[3])
{
    int at = 0, size = tree->octant[0].size;
    for (int d = 0; d < 3; d++)
        if (place[d] < 0 || place[d] >= size) return -1;
    while (tree->octant[at].child >= 0) {
        int half = tree->octant[at].size / 2, which = 0;
        for (int d = 0; d < 3; d++)
            if (place[d] >= tree->octant[at].corner[d] + half) which |= 1 << d;
        at = tree->octant[at].child + which;
    }
    return at;
}

double ref_octants_volume(const RefOctants *tree)
{
    double volume = 0;
    for (long p = 0; p < tree->points; p++) volume += tree->point[p].weight;
    return volume;
}

static void split(RefOctants *tree, long at)
{
    if (tree->count + 8 > tree->room) {
        tree->room = 2 * tree->room + 8;
        tree->octant = sm_realloc(tree->octant, (size_t)tree->room, sizeof *tree->octant);
    }
    RefOctant *parent = tree->octant + at;
    parent->child = (int)tree->count;
    int half = parent->size / 2;
    for (int which = 0; which < 8; which++) {
        RefOctant *child = tree->octant + tree->count++;
        *child = (RefOctant){.size = half, .child = -1};
        for (int d = 0; d < 3; d++) child->corner[d] = parent->corner[d] + (which >> d & 1) * half;
    }
}

/* Whether the octant lies outside the field's box. */
static bool outside_box(const RefField *field, const RefOctants *tree, const RefOctant *octant)
{
    for (int d = 0; d < 3; d++) {
        double low = tree->origin[d] + tree->cell * octant->corner[d];
        double high = low + tree->cell * octant->size, slack = 1e-9 * tree->cell;
        if (high <= field->low[d] + slack || low >= field->high[d] - slack) return true;
    }
    return false;
}

/* The root, and splits until octants that may be cut are finest ones and the others small enough.
 */
static bool refine(const RefField *field, const RefOctantOptions *options, RefOctants *tree)
{
    for (long at = 0; at < tree->count; at++) {
        RefOctant octant = tree->octant[at];
        double centre[3];
        if (octant.size == 1 || outside_box(field, tree, &octant)) continue;
        ref_octants_centre(tree, &octant, centre);
        double edge = tree->cell * octant.size;
        bool cut = ref_clip_side(field, centre, edge) == 0;
        bool inside = ref_field_at(field, centre, NULL) < 0;
        if (!cut && (!inside || octant.size <= 1 << options->coarser)) continue;
        if (tree->count + 8 > REF_MOST_OCTANTS) return false;
        split(tree, at);
    }
    return true;
}

/* Splits the octant across the face or edge `step` of one that is two levels finer. */
static bool relieve(RefOctants *tree, const RefOctant *fine, const int step[3])
{
    int place[3];
    for (int d = 0; d < 3; d++)
        place[d] = fine->corner[d] + (step[d] > 0 ? fine->size : step[d] < 0 ? -1 : 0);
    int size = fine->size, at = ref_octants_at(tree, place);
    if (at < 0 || tree->octant[at].size <= 2 * size) return false;
    split(tree, at);
    return true;
}

/* One-level adjustment across faces and edges; splitting may call for more splitting. */
static void balance(RefOctants *tree)
{
    bool changed = true;
    while (changed) {
        changed = false;
        for (long at = 0; at < tree->count; at++)
            for (int n = 0; n < 27 && tree->octant[at].child < 0; n++) {
                int step[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
                int axes = abs(step[0]) + abs(step[1]) + abs(step[2]);
                RefOctant fine = tree->octant[at];
                if (axes == 1 || axes == 2) changed |= relieve(tree, &fine, step);
            }
    }
}

static void classify(const RefField *field, const RefOctantOptions *options, RefOctants *tree)
{
    for (long at = 0; at < tree->count; at++) {
        RefOctant *octant = tree->octant + at;
        double centre[3], edge = tree->cell * octant->size;
        octant->first = tree->points;
        octant->first_wall = tree->walls;
        octant->kind = REF_EXTERIOR;
        if (octant->child >= 0 || outside_box(field, tree, octant)) continue;
        ref_octants_centre(tree, octant, centre);
        double volume = ref_clip_cell(field, options, centre, edge, tree);
        octant->share = volume / (edge * edge * edge);
        if (!options->rough && tree->points > octant->first)
            ref_walls_of_faces(field, options, at, tree);
        if (octant->share > 1 - 1e-9)
            octant->kind = REF_INTERIOR;
        else if (octant->share > 0)
            octant->kind =
                ref_field_at(field, centre, NULL) < 0 ? REF_BOUNDARY_IN : REF_BOUNDARY_OUT;
    }
}

SmCode ref_octants_build(const RefField *field, const RefOctantOptions *options, RefOctants *tree,
                         SmError *error)
{
    int most = 1;
    *tree = (RefOctants){.cell = options->cell, .count = 1, .room = 1};
    for (int d = 0; d < 3; d++) {
        double cells = (field->high[d] - field->low[d]) / options->cell;
        if (!(cells < 1 << 20))
            return sm_fail(error, SM_INPUT,
                           "a body %g long in octants of %g is too fine to simulate: give it fewer "
                           "nodes",
                           field->high[d] - field->low[d], options->cell);
        int whole = (int)ceil(cells - 1e-6);
        tree->origin[d] = (field->low[d] + field->high[d] - whole * options->cell) / 2;
        while (most < whole) most *= 2;
    }
    tree->octant = sm_alloc(1, sizeof *tree->octant);
    tree->octant[0] = (RefOctant){.size = most, .child = -1};
    if (!refine(field, options, tree)) {
        ref_octants_free(tree);
        return sm_fail(error, SM_INPUT, "the body needs more than %d octants: give it fewer nodes",
                       REF_MOST_OCTANTS);
    }
    balance(tree);
    classify(field, options, tree);
    if (tree->points > 0) return SM_OK;
    ref_octants_free(tree);
    return sm_fail(error, SM_INPUT,
                   "nothing is inside the body's surface: its normals must point outwards");
}
