#include "tree_work.h"

/* A sum of moments takes 12 additions, 9 multiply-adds that shift it, and 3 differences of centres;
 * of a simulation node, which has no moments about itself, 3 additions. It reads 12 values, or 3,
 * and the centre. A transform takes 9 additions of its linear part, and for its value 3 additions,
 * 9 multiply-adds and 3 differences; where only the value is wanted, the 9 are spared. */
enum { INNER = 12 + 18 + 3, LEAF = 3 + 18 + 3, TRANSFORM = 9 + 3 + 18 + 3, VALUE = 3 + 18 + 3 };
enum { ROW = 12, CENTRE = 3 };

/* Rows of a range of lists: those of leaves, and those of inner nodes and prefixes. */
static void count_rows(const OctTree *tree, const OctSumLists *lists, long first, long last,
                       double *leaf, double *inner)
{
    for (long t = first; t < last; t++)
        for (int i = 0; i < lists->span[t].count; i++) {
            long row = lists->row[lists->span[t].first + i], node = row - lists->base;
            if (row == OCT_ZERO_ROW) continue; /* fills up groups */
            if (node >= 0 && tree->child[node] < 0)
                *leaf += 1;
            else
                *inner += 1;
        }
}

BenchTreeCounts bench_tree_counts(const OctTree *tree, const OctSumLists *lists,
                                  const OctSumLists *goals)
{
    double n = (double)tree->leaves, leaves[3] = {0}, inners[3] = {0}, leaf_children = 0;
    count_rows(tree, lists, 0, lists->prefixes + lists->leaves, &leaves[0], &inners[0]);
    count_rows(tree, goals, 0, goals->prefixes, &leaves[1], &inners[1]);
    count_rows(tree, goals, goals->prefixes, goals->prefixes + goals->leaves, &leaves[2],
               &inners[2]);
    for (long l = 0; l < tree->leaves; l++) leaf_children += tree->parent[tree->node[l]] >= 0;
    double children = (double)(tree->nodes - tree->roots);
    return (BenchTreeCounts){.inners = (double)(tree->nodes - tree->leaves) / n,
                             .leaf_children = leaf_children / n,
                             .inner_children = (children - leaf_children) / n,
                             .leaf_entries = leaves[0] / n,
                             .inner_entries = inners[0] / n,
                             .prefixes = (double)lists->prefixes / n,
                             .goal_prefix_entries = (leaves[1] + inners[1]) / n,
                             .goal_entries = (leaves[2] + inners[2]) / n,
                             .goal_prefixes = (double)goals->prefixes / n};
}

/* What reading the lists takes: an entry is 4 bytes, where a list is 16. */
static double region_list_bytes(const BenchTreeCounts *c)
{
    return 4 * (c->leaf_entries + c->inner_entries) + 16 * (1 + c->prefixes);
}

static double goal_list_bytes(const BenchTreeCounts *c)
{
    return 4 * (c->goal_entries + c->goal_prefix_entries) + 16 * (1 + c->goal_prefixes);
}

BenchWork bench_work_depth(const BenchTreeCounts *c)
{
    /* First m~ x: reads x and m~, writes 3. */
    return (BenchWork){.flops = 3 + LEAF * c->leaf_children + INNER * c->inner_children,
                       .near_values = 4 + 3 + (3 + CENTRE) * c->leaf_children +
                                      (ROW + CENTRE) * c->inner_children + ROW * c->inners,
                       .far_values = 3};
}

BenchWork bench_work_breadth(const BenchTreeCounts *c)
{
    /* Regions' sums stay in registers for the matching; prefixes' are written. */
    return (BenchWork){.flops = LEAF * c->leaf_entries + INNER * c->inner_entries,
                       .near_values = (3 + CENTRE) * c->leaf_entries +
                                      (ROW + CENTRE) * c->inner_entries + ROW * c->prefixes,
                       .far_bytes = region_list_bytes(c)};
}

BenchWork bench_work_tree_goals(const BenchTreeCounts *c)
{
    double children = c->leaf_children + c->inner_children;
    double whole = children + c->goal_prefix_entries;
    return (BenchWork){.flops = TRANSFORM * whole + VALUE * c->goal_entries + 3,
                       .near_values = (ROW + CENTRE) * (whole + c->goal_entries) +
                                      ROW * (c->inners + c->goal_prefixes) + 1 + 3,
                       .far_bytes = goal_list_bytes(c)};
}

BenchWork bench_work_tree_damping(const BenchTreeCounts *c)
{
    /* Products 18; 12 additions a child and entry on the way to regions, 6 on the way back; omega
     * and v - omega x c as in work.c 96, times the mass 6; the node 24. Reads x, v and m~, writes
     * 12; reads c, writes 6; reads and writes x and v. */
    double children = c->leaf_children + c->inner_children;
    double up = children + c->leaf_entries + c->inner_entries;
    double down = children + c->goal_entries + c->goal_prefix_entries;
    return (BenchWork){.flops = 18 + 96 + 6 + 24 + 12 * up + 6 * down,
                       .near_values = 7 + 12 + 3 + 6 + 12 + 12 * (up + c->inners + c->prefixes) +
                                      6 * (down + c->inners + c->goal_prefixes),
                       .far_values = 12,
                       .far_bytes = region_list_bytes(c) + goal_list_bytes(c)};
}

BenchWork bench_work_tree_step(const BenchTreeCounts *c)
{
    BenchWork polar = bench_work_polar();
    polar.near_values = ROW; /* matrices come in registers; the transform is written */
    polar.far_bytes = 24;    /* the last rotation, 12 bytes, read and written */
    BenchWork step = bench_work_together(bench_work_depth(c), bench_work_breadth(c));
    step = bench_work_together(bench_work_together(step, bench_work_match()), polar);
    step = bench_work_together(step, bench_work_tree_goals(c));
    return bench_work_together(bench_work_together(step, bench_work_integrate()),
                               bench_work_tree_damping(c));
}

BenchWork bench_work_graph(const OctTree *tree, double edges)
{
    /* A tree node's centre, size, parent, first child and leaf number; a leaf's 26 neighbouring
     * cells, each found by a number at least; an edge's end and length. */
    return (BenchWork){.near_bytes = 26 * 4,
                       .far_bytes = 28 * (double)tree->nodes / (double)tree->leaves + 8 * edges};
}

BenchWork bench_work_distances(double edges, double reached)
{
    /* An edge's end and length, and the end's distance, are read; of a leaf reached its edges are
     * found and its distance and place in the order written. */
    return (BenchWork){.near_bytes = 12 * edges + 24 * reached};
}

BenchWork bench_work_regions(double edges, double reached, double summation_nodes)
{
    /* Beyond the search the tree's leaf number and parent of what it reached are read. */
    BenchWork work = bench_work_distances(edges, reached);
    work.near_bytes += 8 * reached;
    work.far_bytes = 4 * summation_nodes + 16;
    return work;
}
