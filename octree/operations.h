/* operations.h - what the passes of a step have to do for a simulation node, counted
 * (lib/operations.h): of sum.h, octree.c and damping.c. What a sum adds up is counted where the
 * engine's own lists say so: shorter lists would be another method. */
#ifndef OCT_OPERATIONS_H
#define OCT_OPERATIONS_H

#include "../fastlsm/operations.h"
#include "region/sum_lists.h"

/* Of a body, for each of its simulation nodes. */
typedef struct {
    double inners;                        /* tree nodes with children */
    double leaf_children, inner_children; /* of those */
    double leaf_entries, inner_entries;   /* lists of regions: what they name; prefixes are inner */
    double prefixes;
    double goal_entries, goal_prefix_entries, goal_prefixes; /* lists of goal positions */
} OctStepCounts;

/* Rows of the lists first .. last - 1: those of leaves, and those of inner nodes and prefixes. */
static inline void oct_count_rows(const OctTree *tree, const OctSumLists *lists, long first,
                                  long last, double *leaf, double *inner)
{
    for (long t = first; t < last; t++)
        for (long at = lists->rows.first[t]; at < lists->rows.end[t]; at++) {
            long row = lists->rows.item[at], node = row - lists->base;
            if (row == OCT_ZERO_ROW) continue; /* fills up groups */
            if (node >= 0 && tree->child[node] < 0)
                *leaf += 1;
            else
                *inner += 1;
        }
}

/* `lists` sum over regions, `goals` over what contains a node. O(entries). */
static inline OctStepCounts oct_step_counts(const OctTree *tree, const OctSumLists *lists,
                                            const OctSumLists *goals)
{
    double n = (double)tree->leaves, leaves[3] = {0}, inners[3] = {0}, leaf_children = 0;
    oct_count_rows(tree, lists, 0, lists->prefixes + lists->leaves, &leaves[0], &inners[0]);
    oct_count_rows(tree, goals, 0, goals->prefixes, &leaves[1], &inners[1]);
    oct_count_rows(tree, goals, goals->prefixes, goals->prefixes + goals->leaves, &leaves[2],
                   &inners[2]);
    for (long l = 0; l < tree->leaves; l++) leaf_children += tree->parent[tree->node[l]] >= 0;
    double children = (double)(tree->nodes - tree->roots);
    return (OctStepCounts){.inners = (double)(tree->nodes - tree->leaves) / n,
                           .leaf_children = leaf_children / n,
                           .inner_children = (children - leaf_children) / n,
                           .leaf_entries = leaves[0] / n,
                           .inner_entries = inners[0] / n,
                           .prefixes = (double)lists->prefixes / n,
                           .goal_prefix_entries = (leaves[1] + inners[1]) / n,
                           .goal_entries = (leaves[2] + inners[2]) / n,
                           .goal_prefixes = (double)goals->prefixes / n};
}

/* A sum of moments takes 12 additions, 9 multiply-adds that shift it, and 3 differences of centres;
 * of a simulation node, which has no moments about itself, 3 additions. It reads 12 values, or 3,
 * and the centre. A transform takes 9 additions of its linear part, and for its value 3 additions,
 * 9 multiply-adds and 3 differences; where only the value is wanted, the 9 are spared. */
enum {
    OCT_INNER_FLOPS = 12 + 18 + 3,
    OCT_LEAF_FLOPS = 3 + 18 + 3,
    OCT_TRANSFORM_FLOPS = 9 + 3 + 18 + 3,
    OCT_VALUE_FLOPS = 3 + 18 + 3,
    OCT_ROW_VALUES = 12,
    OCT_CENTRE_VALUES = 3
};

/* What reading the lists takes: 4 bytes an entry, and 8 for where each list begins. */
static inline double oct_region_list_bytes(const OctStepCounts *c)
{
    return 4 * (c->leaf_entries + c->inner_entries) + 8 * (1 + c->prefixes);
}

static inline double oct_goal_list_bytes(const OctStepCounts *c)
{
    return 4 * (c->goal_entries + c->goal_prefix_entries) + 8 * (1 + c->goal_prefixes);
}

/* A node's lists, and its state, moments and transforms, some fifty values of `real` bytes. */
static inline double oct_node_bytes(const OctStepCounts *c, double real)
{
    return oct_region_list_bytes(c) + oct_goal_list_bytes(c) + 50 * real;
}

/* Moments of the tree's nodes. First m~ x: reads x and m~, writes 3. */
static inline SmOperations oct_depth_operations(const OctStepCounts *c)
{
    double rows = OCT_ROW_VALUES, centre = OCT_CENTRE_VALUES;
    return (SmOperations){.flops = 3 + OCT_LEAF_FLOPS * c->leaf_children +
                                   OCT_INNER_FLOPS * c->inner_children,
                          .near_values = 4 + 3 + (3 + centre) * c->leaf_children +
                                         (rows + centre) * c->inner_children + rows * c->inners,
                          .far_values = 3};
}

/* Regions' sums, which stay in registers for the matching; prefixes' are written. */
static inline SmOperations oct_breadth_operations(const OctStepCounts *c)
{
    double rows = OCT_ROW_VALUES, centre = OCT_CENTRE_VALUES;
    return (SmOperations){.flops =
                              OCT_LEAF_FLOPS * c->leaf_entries + OCT_INNER_FLOPS * c->inner_entries,
                          .near_values = (3 + centre) * c->leaf_entries +
                                         (rows + centre) * c->inner_entries + rows * c->prefixes,
                          .far_bytes = oct_region_list_bytes(c)};
}

/* Transforms of the tree's nodes, and goal positions. */
static inline SmOperations oct_goal_operations(const OctStepCounts *c)
{
    double whole = c->leaf_children + c->inner_children + c->goal_prefix_entries;
    double read = OCT_ROW_VALUES + OCT_CENTRE_VALUES;
    return (SmOperations){.flops =
                              OCT_TRANSFORM_FLOPS * whole + OCT_VALUE_FLOPS * c->goal_entries + 3,
                          .near_values = read * (whole + c->goal_entries) +
                                         OCT_ROW_VALUES * (c->inners + c->goal_prefixes) + 1 + 3,
                          .far_bytes = oct_goal_list_bytes(c)};
}

/* Products 18; 12 additions a child and entry on the way to regions, 6 on the way back; omega and v
 * - omega x c as in a lattice 96, times the mass 6; the node 24. Reads x, v and m~, writes 12;
 * reads c, writes 6; reads and writes x and v. */
static inline SmOperations oct_damping_operations(const OctStepCounts *c)
{
    double children = c->leaf_children + c->inner_children;
    double up = children + c->leaf_entries + c->inner_entries;
    double down = children + c->goal_entries + c->goal_prefix_entries;
    return (SmOperations){.flops = 18 + 96 + 6 + 24 + 12 * up + 6 * down,
                          .near_values = 7 + 12 + 3 + 6 + 12 + 12 * (up + c->inners + c->prefixes) +
                                         6 * (down + c->inners + c->goal_prefixes),
                          .far_values = 12,
                          .far_bytes = oct_region_list_bytes(c) + oct_goal_list_bytes(c)};
}

/* All of a step, damping included. Of the polar decomposition matrices come in registers, the
 * transform is written; the last rotation, 12 bytes, is read and written. */
static inline SmOperations oct_step_operations(const OctStepCounts *c)
{
    SmOperations step = {.near_values = OCT_ROW_VALUES, .far_bytes = 24};
    step.flops = sm_polar_batch_operations().flops;
    step = sm_operations_add(step, 1, oct_depth_operations(c));
    step = sm_operations_add(step, 1, oct_breadth_operations(c));
    step = sm_operations_add(step, 1, lsm_match_operations());
    step = sm_operations_add(step, 1, oct_goal_operations(c));
    step = sm_operations_add(step, 1, lsm_integrate_operations());
    return sm_operations_add(step, 1, oct_damping_operations(c));
}

#endif
