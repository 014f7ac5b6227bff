/* test_rebuilt.h - a changed structure against one built from scratch. */
#ifndef OCT_TEST_REBUILT_H
#define OCT_TEST_REBUILT_H

#include "../../lib/csr.h"
#include "../../lib/test_frame.h"
#include "structure.h"

/* The node of another tree that is the same cell. */
static inline int same_node(const OctTree *from, int node, const OctTree *to)
{
    int at[3], level = oct_tree_level(from, node);
    for (int d = 0; d < 3; d++) at[d] = oct_tree_low(from, node, d);
    int found = oct_tree_at(to, level, at[0], at[1], at[2]);
    assert_true(found >= 0);
    assert_int_equal(to->size[found], from->size[node]);
    assert_memory_equal(to->centre[found], from->centre[node], sizeof *to->centre);
    return found;
}

static inline void check_edges(const OctStructure *s, long leaf, const OctStructure *want,
                               long twin)
{
    long count = s->graph.edges.end[leaf] - s->graph.edges.first[leaf];
    assert_int_equal(count, want->graph.edges.end[twin] - want->graph.edges.first[twin]);
    int(*edge)[2] = sm_alloc((size_t)count, sizeof *edge);
    for (long n = 0; n < count; n++) {
        long e = s->graph.edges.first[leaf] + n;
        edge[n][0] =
            want->tree.leaf[same_node(&s->tree, s->tree.node[s->graph.edges.item[e]], &want->tree)];
        edge[n][1] = oct_graph_length(&s->graph)[e];
        assert_true(edge[n][1] <= s->graph.longest);
    }
    qsort(edge, (size_t)count, sizeof *edge, sm_compare_pairs);
    for (long n = 0; n < count; n++) {
        long e = want->graph.edges.first[twin] + n;
        assert_int_equal(edge[n][0], want->graph.edges.item[e]);
        assert_int_equal(edge[n][1], oct_graph_length(&want->graph)[e]);
    }
    free(edge);
}

static inline void check_region(const OctStructure *s, long leaf, const OctStructure *want,
                                long twin)
{
    const OctRegions *r = &s->regions;
    long count = r->members.end[leaf] - r->members.first[leaf],
         first = want->regions.members.first[twin];
    assert_int_equal(count, want->regions.members.end[twin] - first);
    int *member = sm_alloc((size_t)count, sizeof *member);
    for (long n = 0; n < count; n++) {
        assert_true(n == 0 || r->members.item[r->members.first[leaf] + n] >
                                  r->members.item[r->members.first[leaf] + n - 1]);
        member[n] = same_node(&s->tree, r->members.item[r->members.first[leaf] + n], &want->tree);
    }
    qsort(member, (size_t)count, sizeof *member, sm_compare_ints);
    assert_memory_equal(member, want->regions.members.item + first, (size_t)count * sizeof *member);
    assert_int_equal(r->width[leaf], want->regions.width[twin]);
    assert_int_equal(r->size[leaf], want->regions.size[twin]);
    free(member);
}

/* Numbers in use are used once, deleted ones are marked as such. */
static inline void check_numbers(const OctTree *t)
{
    long live = 0;
    for (long l = 0; l < t->leaves; l++) {
        if (t->node[l] < 0) continue;
        live++;
        assert_int_equal(t->leaf[t->node[l]], l);
        assert_int_equal(t->children[t->node[l]], 0);
        assert_true(t->size[t->node[l]] > 0);
    }
    assert_int_equal(live, t->live);
    for (long n = 0; n < t->nodes; n++) {
        if (t->size[n] == 0 || t->children[n]) assert_int_equal(t->leaf[n], -1);
        for (int c = 0; t->size[n] > 0 && c < t->children[n]; c++)
            assert_int_equal(t->parent[t->child[n] + c], n);
    }
}

/* The same cells, edges, regions, widths and masses as in `want`, which is as it was built. */
static inline void check_equal(const OctStructure *s, const OctStructure *want)
{
    check_numbers(&s->tree);
    assert_int_equal(s->tree.live, want->tree.leaves);
    assert_int_equal(s->graph.edges.live, want->graph.edges.live);
    assert_int_equal(s->regions.members.live, want->regions.members.live);
    assert_int_equal(s->local_leaves, want->local_leaves);
    for (long twin = 0; twin < want->tree.leaves; twin++) {
        long leaf = s->tree.leaf[same_node(&want->tree, want->tree.node[twin], &s->tree)];
        assert_true(leaf >= 0);
        assert_int_equal(s->w[leaf], want->w[twin]);
        assert_true(s->mass[leaf] == want->mass[twin]);
        check_edges(s, leaf, want, twin);
        check_region(s, leaf, want, twin);
    }
}

/* A structure of the same split cells and the same cut, from scratch. */
static inline void rebuild(const OctStructure *s, const double *mass, OctStructure *want)
{
    int *leaf;
    assert_int_equal(oct_structure_rebuild(s, mass, want, &leaf, NULL), SM_OK);
    for (long i = 0; i < want->tree.leaves; i++)
        assert_int_equal(leaf[i],
                         s->tree.leaf[same_node(&want->tree, want->tree.node[i], &s->tree)]);
    free(leaf);
}

static inline void check(const OctStructure *s, const double *mass)
{
    OctStructure want;
    rebuild(s, mass, &want);
    check_equal(s, &want);
    assert_int_equal(oct_structure_parts(s), oct_structure_parts(&want));
    OctRegions measured = s->regions;
    oct_regions_measure(&measured);
    assert_int_equal(measured.members.live, want.regions.members.live);
    assert_int_equal(measured.most, want.regions.most);
    assert_int_equal(measured.most_width, want.regions.most_width);
    assert_true(fabs(measured.mean - want.regions.mean) < 1e-9);
    assert_true(fabs(measured.mean_width - want.regions.mean_width) <
                1e-9 * want.regions.most_width + 1e-9);
    oct_structure_free(&want);
}

#endif
