#include "nodes.h"

#include <stdlib.h>

static void write_parameters(BenchH5 *h5, hid_t group, const BenchTrajectoryParams *all)
{
    static const BenchField options[] = {
        BENCH_FIELD(OctOptions, BENCH_DOUBLE, epsilon),
        BENCH_FIELD(OctOptions, BENCH_DOUBLE, yield),
        BENCH_FIELD(OctOptions, BENCH_DOUBLE, creep),
        BENCH_FIELD(OctOptions, BENCH_DOUBLE, most),
    };
    static const BenchField body[] = {
        BENCH_FIELD(OctStructure, BENCH_DOUBLE, origin),
        BENCH_FIELD(OctStructure, BENCH_DOUBLE, cell),
    };
    OctOptions o = *all->params->octree;
    if (!(o.most > 0)) o.most = 1;
    const OctTree *tree = &all->structure->tree;
    bench_h5_fields(h5, group, options, 4, &o);
    bench_h5_fields(h5, group, body, 2, all->structure);
    static const char *const symmetries[] = {"union", "intersection", "none"};
    bench_h5_text(h5, group, "masses", o.masses == OCT_VOLUME ? "volume" : "material");
    bench_h5_text(h5, group, "symmetry", symmetries[o.symmetry]);
    bench_h5_text(h5, group, "weighting", o.weighting == OCT_PLAIN ? "plain" : "conserving");
    bench_h5_text(h5, group, "goals", o.form == OCT_ADJOINT ? "adjoint" : "gather");
    bench_h5_numbers(h5, group, "levels", H5T_STD_I32LE, 0, &tree->levels);
    bench_h5_numbers(h5, group, "corner", H5T_STD_I32LE, 3, tree->corner);
}

static void write_tree(BenchH5 *h5, hid_t parent, const OctTree *tree)
{
    hid_t group = bench_h5_group(h5, parent, "tree"), whole = H5T_STD_I32LE;
    hsize_t size[] = {(hsize_t)tree->nodes, 3};
    bench_h5_dataset(h5, group, "centre", whole, 2, size, tree->centre);
    bench_h5_dataset(h5, group, "size", whole, 1, size, tree->size);
    bench_h5_dataset(h5, group, "parent", whole, 1, size, tree->parent);
    bench_h5_dataset(h5, group, "leaf", whole, 1, size, tree->leaf);
    bench_h5_dataset(h5, group, "material", H5T_STD_I64LE, 1, size, tree->material);
}

static void write_leaves(BenchH5 *h5, hid_t group, const OctStructure *s)
{
    size_t count = (size_t)s->tree.leaves;
    double(*rest)[3] = sm_alloc(count, sizeof *rest), *edge = sm_alloc(count, sizeof *edge);
    for (long leaf = 0; leaf < s->tree.leaves; leaf++) {
        oct_structure_centre(s, leaf, rest[leaf]);
        edge[leaf] = 0.5 * s->cell * s->tree.size[s->tree.node[leaf]];
    }
    hsize_t size[] = {count, 3};
    bench_h5_dataset(h5, group, "node", H5T_STD_I32LE, 1, size, s->tree.node);
    bench_h5_dataset(h5, group, "rest", H5T_IEEE_F64LE, 2, size, rest);
    bench_h5_dataset(h5, group, "size", H5T_IEEE_F64LE, 1, size, edge);
    bench_h5_dataset(h5, group, "mass", H5T_IEEE_F64LE, 1, size, s->mass);
    bench_h5_dataset(h5, group, "w", H5T_STD_I32LE, 1, size, s->w);
    bench_h5_dataset(h5, group, "reached", H5T_STD_I32LE, 1, size, s->regions.width);
    free(rest);
    free(edge);
}

/* Every edge once, from the lower leaf. */
static void write_edges(BenchH5 *h5, hid_t group, const OctGraph *graph)
{
    size_t count = (size_t)graph->first[graph->leaves] / 2;
    int(*edge)[2] = sm_alloc(count, sizeof *edge), *length = sm_alloc(count, sizeof *length);
    size_t at = 0;
    for (long i = 0; i < graph->leaves; i++)
        for (long e = graph->first[i]; e < graph->first[i + 1]; e++) {
            if (graph->to[e] < i) continue;
            edge[at][0] = (int)i;
            edge[at][1] = graph->to[e];
            length[at++] = graph->length[e];
        }
    hsize_t size[] = {count, 2};
    bench_h5_dataset(h5, group, "edge", H5T_STD_I32LE, 2, size, edge);
    bench_h5_dataset(h5, group, "length", H5T_STD_I32LE, 1, size, length);
    free(edge);
    free(length);
}

void bench_nodes_write(BenchH5 *h5, hid_t group, const BenchTrajectoryParams *params)
{
    const OctStructure *s = params->structure;
    write_parameters(h5, group, params);
    write_tree(h5, group, &s->tree);
    write_leaves(h5, group, s);
    write_edges(h5, group, &s->graph);
    hsize_t ends = (hsize_t)s->regions.leaves + 1;
    hsize_t members = (hsize_t)s->regions.first[s->regions.leaves];
    bench_h5_dataset(h5, group, "region_first", H5T_STD_I64LE, 1, &ends, s->regions.first);
    bench_h5_dataset(h5, group, "summation", H5T_STD_I32LE, 1, &members, s->regions.member);
}
