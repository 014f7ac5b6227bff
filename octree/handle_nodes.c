#include "handle_nodes.h"

#include <stdlib.h>
#include <string.h>

void oct_handle_nodes_free(OctHandleNodes *nodes)
{
    sm_handles_free(&nodes->handles);
    free(nodes->node);
    free(nodes->by);
    *nodes = (OctHandleNodes){0};
}

void oct_handle_nodes_add(OctHandleNodes *nodes, long body, int leaf, int handle)
{
    sm_make_room(nodes->node, nodes->room, nodes->count + 1);
    nodes->node[nodes->count++] =
        (struct OctHandleNode){.body = body, .leaf = leaf, .handle = handle};
}

/* Into `by`: 1 + the handle that holds a leaf, or 0. */
static void mark(OctHandleNodes *nodes, long leaves)
{
    if (leaves > nodes->by_room) {
        nodes->by = sm_widen(nodes->by, nodes->by_room, 2 * leaves, sizeof *nodes->by, 0);
        nodes->by_room = 2 * leaves;
    }
    for (long i = 0; i < nodes->count; i++)
        nodes->by[nodes->node[i].leaf] = 1 + nodes->node[i].handle;
}

void oct_handle_nodes_transfer(OctHandleNodes *nodes, const OctTree *tree, const OctChange *change)
{
    if (!nodes->count) return;
    mark(nodes, tree->leaves);
    for (long n = 0; n < change->removed_count; n++) {
        int handle = nodes->by[change->removed[n].leaf], into = change->removed[n].into;
        if (!handle || into < 0 || nodes->by[into]) continue;
        nodes->by[into] = handle;
        oct_handle_nodes_add(nodes, 0, into, handle - 1);
    }
    for (long n = 0; n < change->added_count; n++) {
        const OctAdded *added = &change->added[n];
        if (added->from >= 0 && nodes->by[added->from])
            oct_handle_nodes_add(nodes, 0, added->leaf, nodes->by[added->from] - 1);
    }
    long kept = 0;
    for (long i = 0; i < nodes->count; i++) {
        nodes->by[nodes->node[i].leaf] = 0;
        if (tree->node[nodes->node[i].leaf] >= 0) nodes->node[kept++] = nodes->node[i];
    }
    nodes->count = kept;
}

void oct_handle_nodes_note(OctHandleNodes *nodes, const Oct *oct)
{
    for (long i = 0; i < nodes->count; i++) {
        struct OctHandleNode *node = &nodes->node[i];
        const OctState *body = &oct->body[node->body];
        for (int d = 0; d < 3; d++)
            node->before[d] =
                oct_origin(oct, body, node->leaf)[d] + (double)body->x[oct_index(node->leaf, d)];
    }
}

void oct_handle_nodes_move(const OctHandleNodes *nodes, Oct *oct, const OctStructure *structure,
                           const double (*pose)[3][4], Momentum *momentum)
{
    for (long i = 0; i < nodes->count; i++) {
        const struct OctHandleNode *node = &nodes->node[i];
        OctState *body = &oct->body[node->body];
        double rest[3], x0[3], to[3];
        MomentumChange change;
        oct_moved_from(oct, body, node->leaf, &change);
        oct_structure_centre(structure, node->leaf, rest);
        sm_pose_apply((const double(*)[4])pose[node->body], rest, x0);
        sm_pose_apply((const double(*)[4])nodes->handles.handle[node->handle].pose, x0, to);
        for (int d = 0; d < 3; d++) {
            long index = oct_index(node->leaf, d);
            double x = (to[d] - structure->origin[d]) / structure->cell;
            body->x[index] = (real)(x - oct_origin(oct, body, node->leaf)[d]);
            body->v[index] = (real)(x - node->before[d]);
            change.dx[d] =
                oct_origin(oct, body, node->leaf)[d] + (double)body->x[index] - change.x[d];
            change.dv[d] = (double)body->v[index] - change.v[d];
        }
        momentum_pushed(momentum, node->body, node->leaf, &change, oct->gravity, 1);
    }
}
