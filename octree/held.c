#include "held.h"

#include <stdlib.h>
#include <string.h>

void oct_held_free(OctHeld *held)
{
    sm_handles_free(&held->handles);
    free(held->node);
    free(held->by);
    *held = (OctHeld){0};
}

void oct_held_add(OctHeld *held, long body, int leaf, int handle)
{
    if (held->count == held->room) {
        held->room = held->room ? 2 * held->room : 64;
        held->node = sm_realloc(held->node, (size_t)held->room, sizeof *held->node);
    }
    held->node[held->count++] = (struct OctHeldNode){.body = body, .leaf = leaf, .handle = handle};
}

/* Into `by`: 1 + the handle that holds a leaf, or 0. */
static void mark(OctHeld *held, long leaves)
{
    if (leaves > held->by_room) {
        held->by = oct_plots_widen(held->by, held->by_room, 2 * leaves, sizeof *held->by, 0);
        held->by_room = 2 * leaves;
    }
    for (long i = 0; i < held->count; i++) held->by[held->node[i].leaf] = 1 + held->node[i].handle;
}

void oct_held_inherit(OctHeld *held, const OctTree *tree, const OctChange *change)
{
    if (!held->count) return;
    mark(held, tree->leaves);
    for (long n = 0; n < change->removed_count; n++) {
        int handle = held->by[change->removed[n].leaf], into = change->removed[n].into;
        if (!handle || into < 0 || held->by[into]) continue;
        held->by[into] = handle;
        oct_held_add(held, 0, into, handle - 1);
    }
    for (long n = 0; n < change->added_count; n++) {
        const OctAdded *added = &change->added[n];
        if (added->from >= 0 && held->by[added->from])
            oct_held_add(held, 0, added->leaf, held->by[added->from] - 1);
    }
    long kept = 0;
    for (long i = 0; i < held->count; i++) {
        held->by[held->node[i].leaf] = 0;
        if (tree->node[held->node[i].leaf] >= 0) held->node[kept++] = held->node[i];
    }
    held->count = kept;
}

void oct_held_note(OctHeld *held, const Oct *oct)
{
    for (struct OctHeldNode *node = held->node; node < held->node + held->count; node++) {
        const OctState *body = &oct->body[node->body];
        for (int d = 0; d < 3; d++)
            node->before[d] =
                oct_origin(oct, body, node->leaf)[d] + (double)body->x[oct_index(node->leaf, d)];
    }
}

void oct_held_move(const OctHeld *held, Oct *oct, const OctStructure *structure,
                   const double (*pose)[3][4])
{
    for (const struct OctHeldNode *node = held->node; node < held->node + held->count; node++) {
        OctState *body = &oct->body[node->body];
        double rest[3], x0[3], to[3];
        oct_structure_centre(structure, node->leaf, rest);
        sm_pose_apply((const double(*)[4])pose[node->body], rest, x0);
        sm_pose_apply((const double(*)[4])held->handles.handle[node->handle].pose, x0, to);
        for (int d = 0; d < 3; d++) {
            long index = oct_index(node->leaf, d);
            double x = (to[d] - structure->origin[d]) / structure->cell;
            body->x[index] = (real)(x - oct_origin(oct, body, node->leaf)[d]);
            body->v[index] = (real)(x - node->before[d]);
        }
    }
}
