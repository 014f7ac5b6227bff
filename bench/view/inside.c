#include "inside.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/vector.h"
#include "../../octree/surface/gradient.h"
#include "../../reference/meshless/motion/rotation.h"
#include "side.h"
#include "view.h"

/* Room that is used again. */
typedef struct {
    void *at;
    size_t bytes;
} Room;

/* What was found of a side last. */
static struct Inside {
    Room points, links, cells, members, boxes, rest_points, rest_normals, difference;
    long straight;
    double figure[VIEW_MARK_FIGURES], goal[3];
} inside[VIEW_SIDES];

static void *make_room(Room *room, long count, size_t size)
{
    size_t bytes = (size_t)(count > 0 ? count : 1) * size;
    if (bytes > room->bytes) {
        free(room->at);
        room->bytes = bytes + bytes / 4;
        room->at = sm_alloc(room->bytes, 1);
    }
    return room->at;
}

static void narrow(const double (*value)[3], long count, float *to)
{
    for (long i = 0; i < count; i++)
        for (int d = 0; d < 3; d++) to[3 * i + d] = (float)value[i][d];
}

/* A field of all particles of a group; the caller frees. */
static double (*get_field(const BenchGroup *group, SmField field))[3]
{
    const BenchRunner *runner = &group->runner;
    double(*value)[3] = sm_alloc((size_t)runner->particles, sizeof *value);
    runner->type->get(runner->engine, field, value);
    return value;
}

/* ---- particles and links */

/* Where a node of an elastic body is now. */
static void node_place(const ViewSide *side, const RefElastic *elastic, long node, double x[3])
{
    for (int d = 0; d < 3; d++)
        x[d] = elastic->body.nodes.position[node][d] + elastic->motion.moved[node][d] +
               side->play.body->pose[0][d][3];
}

/* Where a shell's surface is now at a place of its parameters, and half of its edges there, of a
 * piece so wide; at rest, and without edges, where it has no functions. */
static void shell_place(const ViewSide *side, const double theta[3], const double width[2],
                        RefShape *shape, double x[3], double half[2][3])
{
    const RefShell *shell = &view_side_shell(side)->sheet.shell;
    const RefWarp *warp = &view_side_shell(side)->sheet.warp;
    memset(half, 0, sizeof(double[2][3]));
    memset(x, 0, sizeof(double[3]));
    if (!ref_shell_shape(shell, theta, shape)) shell->chart.place(shell->chart.data, theta, x);
    for (int n = 0; n < shape->count; n++)
        for (int d = 0; d < 3; d++) {
            double at = warp->X[shape->node[n]][d] + warp->moved[shape->node[n]][d];
            x[d] += shape->value[n] * at;
            for (int k = 0; k < 2; k++) half[k][d] += width[k] / 2 * shape->gradient[n][k] * at;
        }
    for (int d = 0; d < 3; d++) x[d] += side->play.body->pose[0][d][3];
}

static void put_shell_nodes(const ViewSide *side, float *point)
{
    static const double still[2];
    const RefNodes *nodes = &view_side_shell(side)->sheet.shell.nodes;
    RefShape shape = ref_shape_create(nodes);
    for (long n = 0; n < nodes->count; n++) {
        double x[3], half[2][3];
        shell_place(side, nodes->position[n], still, &shape, x, half);
        narrow((const double(*)[3])x, 1, point + 3 * n);
    }
    ref_shape_free(&shape);
}

/* How many nodes an elastic body or a shell has; 0 of others. */
static long count_nodes(const ViewSide *side)
{
    const RefElastic *elastic = view_side_elastic(side);
    const RefShellBody *shell = view_side_shell(side);
    return elastic ? elastic->motion.nodes : shell ? shell->sheet.shell.nodes.count : 0;
}

int view_particles(int number)
{
    const ViewSide *side = view_side_of(number);
    if (!side) return 0;
    long nodes = count_nodes(side);
    return (int)(nodes > 0 ? nodes : bench_playback_particles(&side->play));
}

const float *view_particle_points(int number)
{
    const ViewSide *side = view_side_of(number);
    if (!side) return NULL;
    float *point = make_room(&inside[number].points, view_particles(number), 3 * sizeof *point);
    float *to = point;
    const RefElastic *elastic = view_side_elastic(side);
    const RefShellBody *shell = view_side_shell(side);
    if (shell) put_shell_nodes(side, point);
    for (long n = 0; elastic && n < elastic->motion.nodes; n++) {
        double x[3];
        node_place(side, elastic, n, x);
        narrow((const double(*)[3])x, 1, point + 3 * n);
    }
    for (int g = 0; !elastic && !shell && g < side->play.count; g++) {
        const BenchGroup *group = &side->play.group[g];
        double(*x)[3] = get_field(group, SM_POSITION);
        narrow((const double(*)[3])x, group->runner.particles, to);
        to += 3 * group->runner.particles;
        free(x);
    }
    return point;
}

int view_links(int number)
{
    const ViewSide *side = view_side_of(number);
    long links = 0;
    for (int g = 0; side && g < side->play.count; g++) {
        const BenchGroup *group = &side->play.group[g];
        const BenchRunner *runner = &group->runner;
        if (runner->type->links)
            links += group->body.instances * runner->type->links(runner->engine, NULL, 0);
    }
    return (int)links;
}

/* Do a link's ends differ along one axis only? */
static bool is_straight(const BenchRunner *runner, const int link[2])
{
    int axes = 0;
    double cell = runner->body->voxels.cell;
    for (int d = 0; d < 3; d++)
        axes += fabs(runner->x0[link[0]][d] - runner->x0[link[1]][d]) > cell / 2;
    return axes == 1;
}

/* Straight links of all instances are added at the front, others at the end. */
static void put_links(const BenchGroup *group, long first, int (**front)[2], int (**back)[2])
{
    const BenchRunner *runner = &group->runner;
    if (!runner->type->links) return;
    long count = runner->type->links(runner->engine, NULL, 0);
    int(*link)[2] = sm_alloc((size_t)count, sizeof *link);
    runner->type->links(runner->engine, link, count);
    for (long i = 0; i < count; i++) {
        bool straight = is_straight(runner, link[i]);
        for (long k = 0; k < group->body.instances; k++) {
            int *to = straight ? *(*front)++ : *--*back;
            for (int end = 0; end < 2; end++)
                to[end] = (int)(first + k * runner->count) + link[i][end];
        }
    }
    free(link);
}

const int *view_link_ends(int number)
{
    const ViewSide *side = view_side_of(number);
    long links = view_links(number), first = 0;
    if (!side) return NULL;
    int(*link)[2] = make_room(&inside[number].links, links, sizeof *link);
    int(*front)[2] = link, (*back)[2] = link + links;
    for (int g = 0; g < side->play.count; g++) {
        put_links(&side->play.group[g], first, &front, &back);
        first += side->play.group[g].runner.particles;
    }
    inside[number].straight = front - link;
    return link[0];
}

int view_straight_links(int number)
{
    return view_side_of(number) ? (int)inside[number].straight : 0;
}

/* ---- an octree's cells */

/* A body of an octree, with what carries its cells. */
typedef struct {
    const OctStructure *structure;
    const int *leaf; /* of each node */
    double (*x)[3];  /* [leaves] */
    OctReach search;
} Carried;

/* The body among whose nodes, at `node`, is number `first` of the group. */
static void carry(const BenchGroup *group, const double (*node)[3], long first, Carried *carried)
{
    const BenchRunner *runner = &group->runner;
    *carried = (Carried){.structure = oct_engine_structure(runner->engine),
                         .leaf = oct_engine_leaves(runner->engine)};
    carried->x = sm_alloc((size_t)carried->structure->tree.leaves, sizeof *carried->x);
    for (long p = 0; p < runner->count; p++)
        memcpy(carried->x[carried->leaf[p]], node[first / runner->count * runner->count + p],
               sizeof *carried->x);
}

static void carried_free(Carried *carried)
{
    oct_reach_free(&carried->search);
    free(carried->x);
}

static void find_gradient(Carried *carried, int leaf, double F[9])
{
    const OctStructure *s = carried->structure;
    oct_gradient_of(&s->tree, &s->graph, s->cell, &carried->search, leaf,
                    (const double(*)[3])carried->x, F);
}

static void put_cells(const BenchGroup *group, float *cell)
{
    const BenchRunner *runner = &group->runner;
    double(*place)[3] = get_field(group, SM_POSITION);
    for (long first = 0; first < runner->particles; first += runner->count) {
        Carried carried;
        carry(group, (const double(*)[3])place, first, &carried);
        const OctTree *tree = &carried.structure->tree;
        for (long p = 0; p < runner->count; p++, cell += VIEW_CELL_NUMBERS) {
            double F[9], half = 0.25 * carried.structure->cell; /* of half a finest cell */
            int leaf = carried.leaf[p], node = tree->node[leaf];
            find_gradient(&carried, leaf, F);
            for (int d = 0; d < 3; d++) cell[d] = (float)carried.x[leaf][d];
            for (int i = 0; i < 9; i++)
                cell[3 + 3 * (i % 3) + i / 3] = (float)(half * tree->size[node] * F[i]);
            cell[VIEW_CELL_NUMBERS - 1] = (float)oct_tree_level(tree, node);
        }
        carried_free(&carried);
    }
    free(place);
}

/* Cells of a shell as its functions have them now, as thick as it is; the largest are of level 0.
 */
static void put_shell_cells(const ViewSide *side, const RefShellBody *body, float *cell)
{
    const RefQuadtree *tree = &body->sheet.shell.tree;
    RefShape shape = ref_shape_create(&body->sheet.shell.nodes);
    int largest = 0;
    for (long c = 0; c < tree->count; c++)
        if (tree->cell[c].child < 0 && tree->cell[c].size > largest) largest = tree->cell[c].size;
    for (long c = 0; c < tree->count; c++) {
        double theta[3] = {0}, width[2], x[3], half[3][3];
        int level = 0;
        if (tree->cell[c].child >= 0) continue;
        ref_quadtree_cell(tree, tree->cell + c, theta, width);
        shell_place(side, theta, width, &shape, x, half);
        sm_cross(half[0], half[1], half[2]);
        sm_normalize(half[2]);
        for (int d = 0; d < 3; d++) half[2][d] *= body->sheet.options.shell.thickness / 2;
        narrow((const double(*)[3])x, 1, cell);
        narrow((const double(*)[3])half, 3, cell + 3);
        for (int size = tree->cell[c].size; size < largest; size *= 2) level++;
        cell[VIEW_CELL_NUMBERS - 1] = (float)level;
        cell += VIEW_CELL_NUMBERS;
    }
    ref_shape_free(&shape);
}

int view_cells(int number)
{
    const ViewSide *side = view_side_of(number);
    const RefShellBody *shell = side ? view_side_shell(side) : NULL;
    if (shell) return (int)shell->sheet.shell.tree.leaves;
    return side && side->play.group[0].skin.octree ? view_particles(number) : 0;
}

const float *view_cell_frames(int number)
{
    const ViewSide *side = view_side_of(number);
    if (!side || view_cells(number) == 0) return NULL;
    float *cell =
        make_room(&inside[number].cells, view_cells(number), VIEW_CELL_NUMBERS * sizeof *cell);
    float *to = cell;
    const RefShellBody *shell = view_side_shell(side);
    if (shell) put_shell_cells(side, shell, cell);
    for (int g = 0; !shell && g < side->play.count; g++) {
        put_cells(&side->play.group[g], to);
        to += VIEW_CELL_NUMBERS * side->play.group[g].runner.particles;
    }
    return cell;
}

/* ---- a particle's region */

/* The group that a particle is in, whose own first particle is number *first; NULL: none is. */
static const BenchGroup *group_of(const ViewSide *side, long particle, long *first)
{
    *first = 0;
    for (int g = 0; side && g < side->play.count && particle >= 0; g++) {
        const BenchGroup *group = &side->play.group[g];
        if (particle < *first + group->runner.particles) return group;
        *first += group->runner.particles;
    }
    return NULL;
}

static void mark_goal(struct Inside *in, const BenchGroup *group, long p)
{
    const BenchRunner *runner = &group->runner;
    runner->type->goals(runner->engine);
    double(*goal)[3] = get_field(group, SM_GOAL), (*x)[3] = get_field(group, SM_POSITION);
    memcpy(in->goal, goal[p], sizeof in->goal);
    in->figure[VIEW_GOAL_CELLS] =
        sqrt(sm_square_between(goal[p], x[p])) / runner->body->voxels.cell;
    free(goal);
    free(x);
}

static void mark_bars(struct Inside *in, const BenchGroup *group, long p, int (*member)[3],
                      long count)
{
    const BenchRunner *runner = &group->runner;
    int *bar = sm_alloc((size_t)count, sizeof *bar), *plate = sm_alloc((size_t)count, sizeof *bar);
    double bars = (double)runner->type->bars(runner->engine, p, bar, plate), plates = 0;
    for (long i = 0; bars > 0 && i < count; i++) {
        member[i][1] = bar[i];
        member[i][2] = plate[i];
        plates = fmax(plates, plate[i] + 1);
    }
    in->figure[VIEW_BARS] = bars;
    in->figure[VIEW_PLATES] = plates;
    free(bar);
    free(plate);
}

/* The leaf below a tree node whose middle is nearest to a corner of that node's cell. */
static int nearest_leaf(const OctTree *tree, int node, const int corner[3])
{
    OctStack stack;
    long least = 0;
    int found = -1;
    oct_stack_begin(&stack, node);
    while (stack.count) {
        int here = oct_stack_take(&stack);
        long square = 0;
        if (tree->children[here]) oct_stack_put(&stack, tree->child[here], tree->children[here]);
        if (tree->leaf[here] < 0) continue;
        for (int d = 0; d < 3; d++) {
            long off = tree->centre[here][d] - corner[d];
            square += off * off;
        }
        if (found >= 0 && square >= least) continue;
        least = square;
        found = tree->leaf[here];
    }
    return found;
}

/* Eight corners of a tree node's cell, and its level. */
static void put_box(Carried *carried, int node, float *box)
{
    const OctStructure *s = carried->structure;
    const OctTree *tree = &s->tree;
    for (int c = 0; c < 8; c++) {
        int corner[3];
        double F[9];
        for (int d = 0; d < 3; d++)
            corner[d] = tree->centre[node][d] + (c >> d & 1 ? 1 : -1) * tree->size[node] / 2;
        int leaf = nearest_leaf(tree, node, corner);
        const int *middle = tree->centre[tree->node[leaf]];
        find_gradient(carried, leaf, F);
        for (int d = 0; d < 3; d++) {
            double at = carried->x[leaf][d];
            for (int e = 0; e < 3; e++)
                at += F[3 * d + e] * 0.5 * s->cell * (corner[e] - middle[e]);
            box[3 * c + d] = (float)at;
        }
    }
    box[VIEW_BOX_NUMBERS - 1] = (float)oct_tree_level(tree, node);
}

/* Which of the region's summation nodes a leaf is below. */
static int find_summation_node(const OctTree *tree, const int *node, long nodes, int leaf)
{
    for (int at = tree->node[leaf]; at >= 0; at = tree->parent[at])
        for (long n = 0; n < nodes; n++)
            if (node[n] == at) return (int)n;
    return -1;
}

static void mark_summation_nodes(struct Inside *in, const BenchGroup *group, long p,
                                 int (*member)[3], long count, long first)
{
    Carried carried;
    double(*place)[3] = get_field(group, SM_POSITION);
    carry(group, (const double(*)[3])place, p, &carried);
    free(place);
    const OctStructure *s = carried.structure;
    const SmCsr *rows = &s->regions.members;
    long each = group->runner.count, leaf = carried.leaf[p % each];
    const int *node = rows->item + rows->first[leaf];
    long nodes = rows->end[leaf] - rows->first[leaf];
    float *box = make_room(&in->boxes, nodes, VIEW_BOX_NUMBERS * sizeof *box);
    for (long n = 0; n < nodes; n++) put_box(&carried, node[n], box + VIEW_BOX_NUMBERS * n);
    for (long i = 0; i < count; i++)
        member[i][1] =
            find_summation_node(&s->tree, node, nodes, carried.leaf[(member[i][0] - first) % each]);
    in->figure[VIEW_NODES] = (double)nodes;
    carried_free(&carried);
}

/* The cover of a node: the nodes that stand in it, and the cube as it is turned at the node. */
static int mark_cover(struct Inside *in, const ViewSide *side, const RefElastic *elastic, long p)
{
    const RefNodes *nodes = &elastic->body.nodes;
    double x[3], R[9], reach = nodes->reach[p];
    long count = 0;
    int(*member)[3] = make_room(&in->members, nodes->count, sizeof *member);
    for (long n = 0; n < nodes->count; n++) {
        double far = 0;
        for (int d = 0; d < 3; d++)
            far = fmax(far, fabs(nodes->position[n][d] - nodes->position[p][d]));
        if (far < reach) memcpy(member[count++], (int[3]){(int)n}, sizeof *member);
    }
    node_place(side, elastic, p, x);
    ref_rotation(elastic->motion.rotation[p], R);
    float *box = make_room(&in->boxes, 1, VIEW_BOX_NUMBERS * sizeof *box);
    for (int c = 0; c < 8; c++)
        for (int d = 0; d < 3; d++) {
            double at = x[d];
            for (int e = 0; e < 3; e++) at += R[3 * d + e] * (c >> e & 1 ? reach : -reach);
            box[3 * c + d] = (float)at;
        }
    box[VIEW_BOX_NUMBERS - 1] = 0;
    for (int d = 0; d < 3; d++) in->goal[d] = NAN;
    in->figure[VIEW_NODES] = 1;
    in->figure[VIEW_GOAL_CELLS] = NAN;
    return (int)count;
}

static int by_number(const void *a, const void *b)
{
    const int *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

/* A shell's node: the nodes that move the surface where it stands. */
static int mark_movers(struct Inside *in, const RefWarp *warp, long p)
{
    long count = 0, all = warp->near[p + 1] - warp->near[p];
    int *other = sm_alloc((size_t)all, sizeof *other);
    int(*member)[3] = make_room(&in->members, all, sizeof *member);
    memcpy(other, warp->other + warp->near[p], (size_t)all * sizeof *other);
    qsort(other, (size_t)all, sizeof *other, by_number);
    for (long k = 0; k < all; k++) /* one whose image beyond a seam moves it, too, is there twice */
        if (k == 0 || other[k] != other[k - 1])
            memcpy(member[count++], (int[3]){other[k]}, sizeof *member);
    free(other);
    for (int d = 0; d < 3; d++) in->goal[d] = NAN;
    in->figure[VIEW_GOAL_CELLS] = NAN;
    return (int)count;
}

int view_mark(int number, int particle)
{
    long first;
    const ViewSide *side = view_side_of(number);
    const RefElastic *elastic = side ? view_side_elastic(side) : NULL;
    const RefShellBody *shell = side ? view_side_shell(side) : NULL;
    if (number >= 0 && number < VIEW_SIDES)
        memset(inside[number].figure, 0, sizeof inside[number].figure);
    if (elastic || shell) {
        if (particle < 0 || particle >= count_nodes(side)) return 0;
        return elastic ? mark_cover(&inside[number], side, elastic, particle)
                       : mark_movers(&inside[number], &shell->sheet.warp, particle);
    }
    const BenchGroup *group = group_of(side, particle, &first);
    if (!group) return 0;
    struct Inside *in = &inside[number];
    const BenchRunner *runner = &group->runner;
    long count = runner->type->region(runner->engine, particle - first, NULL, 0);
    long *region = sm_alloc((size_t)count, sizeof *region);
    int(*member)[3] = make_room(&in->members, count, sizeof *member);
    runner->type->region(runner->engine, particle - first, region, count);
    for (long i = 0; i < count; i++)
        memcpy(member[i], (int[3]){(int)(first + region[i])}, sizeof *member);
    free(region);
    mark_goal(in, group, particle - first);
    if (runner->type->bars)
        mark_bars(in, group, particle - first, member, count);
    else
        mark_summation_nodes(in, group, particle - first, member, count, first);
    return (int)count;
}

const int *view_members(int side)
{
    return view_side_of(side) ? inside[side].members.at : NULL;
}

double view_mark_figure(int side, int figure)
{
    bool is = view_side_of(side) && figure >= 0 && figure < VIEW_MARK_FIGURES;
    return is ? inside[side].figure[figure] : NAN;
}

const double *view_goal(int side)
{
    return view_side_of(side) ? inside[side].goal : NULL;
}

const float *view_boxes(int side)
{
    return view_side_of(side) ? inside[side].boxes.at : NULL;
}

/* ---- surfaces */

/* A side whose surface has been found since it got other vertices, or NULL. */
static ViewSide *drawn_side(int number)
{
    ViewSide *side = view_side_of(number);
    if (side && !side->index) view_side_draw(side);
    return side;
}

static void carried_at_rest(BenchGroup *group, double (*point)[3], double (*normal)[3])
{
    double(*rest)[3] = get_field(group, SM_REST);
    sm_skin_points(&group->skin, (const double(*)[3])rest, point, normal);
    free(rest);
}

/* A surface that the engine draws is drawn at rest, without the pose of its body, which is alone.
 */
static void drawn_at_rest(const BenchGroup *group, double (*point)[3], double (*normal)[3])
{
    const SmMesh *surface = &group->skin.surface;
    double(*sums)[3] = sm_mesh_normals(surface, 1);
    for (long v = 0; v < surface->vertex_count; v++) {
        for (int d = 0; d < 3; d++)
            point[v][d] = surface->position[v][d] + group->body.pose[0][d][3];
        sm_normalize(sums[v]);
        memcpy(normal[v], sums[v], sizeof normal[v]);
    }
    free(sums);
}

const float *view_rest_points(int number)
{
    ViewSide *side = drawn_side(number);
    if (!side) return NULL;
    struct Inside *in = &inside[number];
    double(*point)[3] = sm_alloc((size_t)side->vertices, sizeof *point);
    double(*normal)[3] = sm_alloc((size_t)side->vertices, sizeof *normal);
    long first = 0;
    for (int g = 0; g < side->play.count; g++) {
        BenchGroup *group = &side->play.group[g];
        if (group->skin.drawn)
            drawn_at_rest(group, point, normal);
        else
            carried_at_rest(group, point + first, normal + first);
        first += group->body.instances * group->skin.surface.vertex_count;
    }
    float *to = make_room(&in->rest_points, side->vertices, 3 * sizeof *to);
    narrow((const double(*)[3])point, side->vertices, to);
    narrow((const double(*)[3])normal, side->vertices,
           make_room(&in->rest_normals, side->vertices, 3 * sizeof *to));
    free(point);
    free(normal);
    return to;
}

const float *view_rest_normals(int side)
{
    return view_side_of(side) ? inside[side].rest_normals.at : NULL;
}

const char *view_not_comparable(void)
{
    const ViewSide *lattice = view_side_of(VIEW_LATTICE), *other = view_side_of(VIEW_OTHER);
    if (!lattice || !other) return "One of the two engines is not there.";
    for (int s = 0; s < VIEW_SIDES; s++)
        for (int g = 0; g < view_side_of(s)->play.count; g++)
            if (sm_skin_cut_triangles(&view_side_of(s)->play.group[g].skin) > 0)
                return "The body has been cut: the two surfaces have other vertices.";
    if (lattice->vertices != other->vertices) return "The two surfaces have other vertices.";
    return "";
}

/* First vertex of each instance; the groups of the two sides need not be the same. The caller
 * frees. */
static long *first_vertices(const ViewSide *side)
{
    long instances = 0, vertex = 0;
    for (int g = 0; g < side->play.count; g++) instances += side->play.group[g].body.instances;
    long *first = sm_alloc((size_t)instances, sizeof *first);
    for (int g = 0; g < side->play.count; g++) {
        const BenchGroup *group = &side->play.group[g];
        for (long k = 0; k < group->body.instances; k++) {
            first[group->instance[k]] = vertex;
            vertex += group->skin.surface.vertex_count;
        }
    }
    return first;
}

const float *view_difference(int number)
{
    if (*view_not_comparable()) return NULL;
    const ViewSide *side = drawn_side(number), *other = drawn_side(1 - number);
    if (!side || !other) return NULL;
    const BenchBody *body = side->play.body;
    long *here = first_vertices(side), *there = first_vertices(other);
    long each = side->vertices / body->instances;
    float *apart = make_room(&inside[number].difference, side->vertices, sizeof *apart);
    for (long k = 0; k < body->instances; k++)
        for (long v = 0; v < each; v++)
            apart[here[k] + v] = (float)(sqrt(sm_square_between(side->place[here[k] + v],
                                                                other->place[there[k] + v])) /
                                         body->voxels.cell);
    free(here);
    free(there);
    return apart;
}
