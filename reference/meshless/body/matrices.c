#include "matrices.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/csr.h"
#include "../../../lib/vector.h"
#include "pairs.h"

/* Walls of a sliver that miss its volume by more than this are no use. */
static const double MOST_OPEN = 0.2;

/* One octant: the nodes whose covers reach into it, and their functions at its points. */
typedef struct {
    int count;
    int *node;   /* rising */
    int *number; /* [nodes] in `node`, or -1 */
    long points;
    double *weight;    /* [points] */
    double *value;     /* [count][4][points]: phi and its derivatives */
    double (*mean)[4]; /* [nodes] of `value` over the octant */
    double (*wall)[3]; /* [nodes] sums of phi over the octant's walls */
} Local;

void ref_sparse_free(RefSparse *sparse)
{
    sm_free_all(sparse->start, sparse->row, sparse->value);
    *sparse = (RefSparse){0};
}

void ref_matrices_free(RefMatrices *matrices)
{
    ref_sparse_free(&matrices->mass);
    ref_sparse_free(&matrices->stiffness);
}

void ref_sparse_apply(const RefSparse *sparse, int width, const double *x, double *y)
{
    memset(y, 0, (size_t)sparse->columns * (size_t)width * sizeof *y);
    for (int c = 0; c < sparse->columns; c++)
        for (int e = sparse->start[c]; e < sparse->start[c + 1]; e++) {
            int r = sparse->row[e];
            for (int k = 0; k < width; k++) {
                y[r * width + k] += sparse->value[e] * x[c * width + k];
                if (r != c) y[c * width + k] += sparse->value[e] * x[r * width + k];
            }
        }
}

void ref_sparse_sums(const RefSparse *sparse, double *sum)
{
    double *one = sm_alloc((size_t)sparse->columns, sizeof *one);
    for (int c = 0; c < sparse->columns; c++) one[c] = 1;
    ref_sparse_apply(sparse, 1, one, sum);
    free(one);
}

/* Whether the cover of node n reaches into the box, by more than rounding. */
static bool reaches(const RefNodes *nodes, int n, const double low[3], const double high[3])
{
    double reach = nodes->reach[n] * (1 - 1e-9);
    for (int d = 0; d < 3; d++) {
        double x = nodes->position[n][d];
        if (x + reach <= low[d] || x - reach >= high[d]) return false;
    }
    return true;
}

/* What of a bin's members reaches into an octant. */
typedef struct {
    const RefNodes *nodes;
    double low[3], high[3];
    Local *local;
} Search;

static void note_nodes(void *data, int count, const int *member)
{
    Search *search = data;
    Local *local = search->local;
    for (int n = 0; n < count; n++)
        if (local->number[member[n]] < 0 &&
            reaches(search->nodes, member[n], search->low, search->high)) {
            local->number[member[n]] = 0;
            local->node[local->count++] = member[n];
        }
}

/* Fills in the octant's nodes: those of the bins that it touches. `number` is -1 of all before. */
static void find_nodes(const RefOctants *tree, const RefOctant *octant, const RefNodes *nodes,
                       Local *local)
{
    Search search = {.nodes = nodes, .local = local};
    for (int d = 0; d < 3; d++) {
        search.low[d] = tree->origin[d] + tree->cell * octant->corner[d];
        search.high[d] = search.low[d] + tree->cell * octant->size;
    }
    local->count = 0;
    ref_nodes_each(nodes, search.low, search.high, note_nodes, &search);
    sm_sort_ints(local->node, local->count);
    for (int n = 0; n < local->count; n++) local->number[local->node[n]] = n;
}

static void forget_nodes(Local *local)
{
    for (int n = 0; n < local->count; n++) local->number[local->node[n]] = -1;
}

static long points_end(const RefOctants *tree, long o)
{
    return o + 1 < tree->count ? tree->octant[o + 1].first : tree->points;
}

static long walls_end(const RefOctants *tree, long o)
{
    return o + 1 < tree->count ? tree->octant[o + 1].first_wall : tree->walls;
}

/* Nodes are partners where an octant knows both. */
static void find_pairs(const RefOctants *tree, const RefNodes *nodes, Local *local, RefPairs *pairs)
{
    *pairs = ref_pairs_begin(nodes->count);
    for (long o = 0; o < tree->count; o++) {
        if (points_end(tree, o) == tree->octant[o].first) continue;
        find_nodes(tree, tree->octant + o, nodes, local);
        ref_pairs_meet(pairs, local->count, local->node);
        forget_nodes(local);
    }
    ref_pairs_end(pairs);
}

/* The shape functions at the octant's points; false, and where, if one is not defined. */
static bool evaluate(const RefOctants *tree, long o, const RefNodes *nodes, RefBasis basis,
                     RefShape *shape, Local *local, const double **where)
{
    const RefPoint *point = tree->point + tree->octant[o].first;
    local->points = points_end(tree, o) - tree->octant[o].first;
    size_t values = (size_t)local->count * 4 * (size_t)local->points;
    local->value = sm_realloc(local->value, values, sizeof(double));
    memset(local->value, 0, values * sizeof(double));
    local->weight = sm_realloc(local->weight, (size_t)local->points, sizeof(double));
    for (long q = 0; q < local->points; q++) {
        *where = point[q].x;
        local->weight[q] = point[q].weight;
        if (point[q].weight == 0) continue; /* a crack has left it no nodes */
        if (!ref_mls_at(nodes, basis, point[q].x, shape)) return false;
        for (int n = 0; n < shape->count; n++) {
            int at = local->number[shape->node[n]];
            if (at < 0) continue; /* rounding: it only touches the octant */
            double *value = local->value + 4 * at * local->points + q;
            value[0] = shape->value[n];
            for (int d = 0; d < 3; d++) value[(1 + d) * local->points] = shape->gradient[n][d];
        }
    }
    return true;
}

/* The means of all functions over the octant's points, and the points' middle; returns the volume.
 */
static double take_means(const RefPoint *point, Local *local, double middle[3])
{
    double volume = 0;
    memset(middle, 0, sizeof(double[3]));
    for (long q = 0; q < local->points; q++) volume += local->weight[q];
    if (volume == 0) return 0;
    for (long q = 0; q < local->points; q++)
        for (int d = 0; d < 3; d++) middle[d] += local->weight[q] / volume * point[q].x[d];
    for (int n = 0; n < local->count; n++)
        for (int k = 0; k < 4; k++) {
            const double *value = local->value + (4 * n + k) * local->points;
            double sum = 0;
            for (long q = 0; q < local->points; q++) sum += local->weight[q] * value[q];
            local->mean[n][k] = sum / volume;
        }
    return volume;
}

/* Sums over the walls of what bounds an octant's share, for its mean gradients. */
typedef struct {
    double area[3], first[3][3]; /* area, and area times place from the points' middle */
} Closure;

/* The functions at a wall that too few nodes cover, along their slopes at
 * the octant's point that is nearest: linear functions stay what they are. */
static void extend(const RefPoint *point, const RefWall *wall, Local *local)
{
    long near = 0;
    double least = INFINITY, way[3];
    for (long q = 0; q < local->points; q++) {
        for (int d = 0; d < 3; d++) way[d] = wall->x[d] - point[q].x[d];
        if (sm_dot(way, way) >= least) continue;
        least = sm_dot(way, way);
        near = q;
    }
    for (int n = 0; n < local->count; n++) {
        const double *value = local->value + 4 * n * local->points + near;
        double phi = value[0];
        for (int d = 0; d < 3; d++)
            phi += value[(1 + d) * local->points] * (wall->x[d] - point[near].x[d]);
        for (int d = 0; d < 3; d++) local->wall[n][d] += phi * wall->area[d];
    }
}

/* Where a place of an octant is seen from: a little nearer to its middle, so that what a crack
 * along a wall parts is on the octant's side of it. */
static void look(const double x[3], const double middle[3], double eye[3])
{
    for (int d = 0; d < 3; d++) eye[d] = x[d] + 1e-6 * (middle[d] - x[d]);
}

/* Whether a crack passes between the octant's middle and a place of it. */
static bool is_parted(const RefNodes *nodes, const double x[3], const double middle[3], double edge)
{
    double eye[3], part[6];
    look(x, middle, eye);
    return !nodes->cut.pass(nodes->cut.cracks, eye, middle, 1e-9 * edge, part) || part[0] < 1;
}

/* Whether a crack passes through the octant: functions jump in it. */
static bool is_cracked(const RefOctants *tree, long o, const RefNodes *nodes,
                       const double middle[3])
{
    const RefOctant *octant = tree->octant + o;
    double edge = tree->cell * octant->size;
    if (!nodes->cut.pass) return false;
    for (long p = octant->first; p < points_end(tree, o); p++)
        if (is_parted(nodes, tree->point[p].x, middle, edge)) return true;
    for (long s = octant->first_wall; s < walls_end(tree, o); s++)
        if (is_parted(nodes, tree->wall[s].x, middle, edge)) return true;
    return false;
}

static void sum_walls(const RefOctants *tree, long o, const RefNodes *nodes, RefBasis basis,
                      const double middle[3], RefShape *shape, Local *local, Closure *closure)
{
    memset(local->wall, 0, (size_t)local->count * sizeof *local->wall);
    for (long s = tree->octant[o].first_wall; s < walls_end(tree, o); s++) {
        const RefWall *wall = tree->wall + s;
        double eye[3];
        look(wall->x, middle, eye);
        if (!ref_mls_seen_from(nodes, basis, wall->x, nodes->cut.pass ? eye : wall->x, shape))
            extend(tree->point + tree->octant[o].first, wall, local);
        for (int n = 0; n < shape->count; n++) {
            int at = local->number[shape->node[n]];
            for (int d = 0; at >= 0 && d < 3; d++)
                local->wall[at][d] += shape->value[n] * wall->area[d];
        }
        for (int d = 0; d < 3; d++) {
            closure->area[d] += wall->area[d];
            for (int e = 0; e < 3; e++)
                closure->first[d][e] += wall->area[d] * (wall->x[e] - middle[e]);
        }
    }
}

/* Gives the gradients at the octant's points the mean that the walls say, so that what they do sums
 * up to the body's surface: then constant stress is in balance wherever shape functions are, and
 * the patch test is passed (Chen, Wu, Yoon and You 2001; here the gradients keep how they vary in
 * the octant, which leaves no soft modes). Where walls do not close, which is as well as the
 * surface is cut, the rest is taken out, so that linear functions have their gradients exactly.
 * Where a crack passes through an octant, it stays as it is. */
static void balance_gradients(const RefOctants *tree, long o, const RefNodes *nodes, RefBasis basis,
                              RefShape *shape, Local *local)
{
    Closure closure = {{0}, {{0}}};
    double middle[3], open[3][3], off = 0;
    double volume = take_means(tree->point + tree->octant[o].first, local, middle);
    if (volume == 0 || is_cracked(tree, o, nodes, middle)) return;
    sum_walls(tree, o, nodes, basis, middle, shape, local, &closure);
    for (int d = 0; d < 3; d++)
        for (int e = 0; e < 3; e++) {
            open[d][e] = (d == e) - closure.first[d][e] / volume;
            off = fmax(off, fabs(open[d][e]));
        }
    if (off > MOST_OPEN) return;
    for (int n = 0; n < local->count; n++)
        for (int d = 0; d < 3; d++) {
            const double *mean = local->mean[n];
            double *value = local->value + (4 * n + 1 + d) * local->points;
            double change = (local->wall[n][d] - closure.area[d] * mean[0]) / volume - mean[1 + d];
            for (int e = 0; e < 3; e++) change += open[d][e] * mean[1 + e];
            for (long q = 0; q < local->points; q++) value[q] += change;
        }
}

/* The ten products of functions i (times the points' weights) and j. */
static void products(long points, const double *i, const double *j, double *sum)
{
    double m = 0, xx = 0, xy = 0, xz = 0, yx = 0, yy = 0, yz = 0, zx = 0, zy = 0, zz = 0;
#pragma omp simd reduction(+ : m, xx, xy, xz, yx, yy, yz, zx, zy, zz)
    for (long q = 0; q < points; q++) {
        double x = j[points + q], y = j[2 * points + q], z = j[3 * points + q];
        m += i[q] * j[q];
        xx += i[points + q] * x;
        xy += i[points + q] * y;
        xz += i[points + q] * z;
        yx += i[2 * points + q] * x;
        yy += i[2 * points + q] * y;
        yz += i[2 * points + q] * z;
        zx += i[3 * points + q] * x;
        zy += i[3 * points + q] * y;
        zz += i[3 * points + q] * z;
    }
    const double all[10] = {m, xx, xy, xz, yx, yy, yz, zx, zy, zz};
    memcpy(sum, all, sizeof all);
}

static void add_pairs(const Local *local, double *weighted, RefPairs *pairs)
{
    for (int a = 0; a < local->count; a++) {
        const double *row = local->value + 4 * a * local->points;
        for (long n = 0; n < 4 * local->points; n++)
            weighted[n] = row[n] * local->weight[n % local->points];
        long at = pairs->start[local->node[a]];
        for (int b = a; b < local->count; b++) {
            double sum[10];
            while (pairs->partner[at] != local->node[b]) at++;
            products(local->points, weighted, local->value + 4 * b * local->points, sum);
            pairs->mass[at] += sum[0];
            for (int k = 0; k < 9; k++) pairs->block[at][k] += sum[1 + k];
        }
    }
}

/* K_IJ,ab = lambda G_ab + mu (G_ba + delta_ab tr G), G_ab = int phi_I,a phi_J,b, in G's place. */
static void turn_stiff(const RefMaterial *material, RefPairs *pairs)
{
    double mu = material->young / (2 * (1 + material->poisson));
    double lambda = 2 * mu * material->poisson / (1 - 2 * material->poisson);
    for (long e = 0; e < pairs->start[pairs->count]; e++) {
        double G[9];
        memcpy(G, pairs->block[e], sizeof G);
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) {
                double value = lambda * G[3 * a + b] + mu * G[3 * b + a];
                if (a == b) value += mu * (G[0] + G[4] + G[8]);
                pairs->block[e][3 * a + b] = value;
            }
    }
}

SmCode ref_material_check(const RefMaterial *material, SmError *error)
{
    if (!(material->young > 0 && isfinite(material->young)))
        return sm_fail(error, SM_USAGE, "Young's modulus is %g; give one above 0", material->young);
    if (!(material->poisson > -1 && material->poisson <= 0.4999))
        return sm_fail(error, SM_USAGE,
                       "Poisson's ratio is %g; give one above -1, up to 0.4999 (0.5 is material "
                       "that cannot be compressed)",
                       material->poisson);
    if (!(material->density > 0 && isfinite(material->density)))
        return sm_fail(error, SM_USAGE, "the density is %g; give one above 0", material->density);
    return SM_OK;
}

static void local_create(const RefNodes *nodes, Local *local)
{
    *local = (Local){0};
    local->node = sm_alloc((size_t)nodes->count, sizeof *local->node);
    local->number = sm_alloc((size_t)nodes->count, sizeof *local->number);
    local->mean = sm_alloc((size_t)nodes->count, sizeof *local->mean);
    local->wall = sm_alloc((size_t)nodes->count, sizeof *local->wall);
    for (long n = 0; n < nodes->count; n++) local->number[n] = -1;
}

static void local_free(Local *local)
{
    sm_free_all(local->node, local->number, local->weight, local->value, local->mean, local->wall);
}

/* Every octant's share of the pairs' products. */
static SmCode integrate(const RefOctants *tree, const RefNodes *nodes, RefBasis basis, Local *local,
                        RefPairs *pairs, SmError *error)
{
    RefShape shape = ref_shape_create(nodes);
    double *weighted = NULL;
    const double *where = NULL;
    bool defined = true;
    for (long o = 0; defined && o < tree->count; o++) {
        if (points_end(tree, o) == tree->octant[o].first) continue;
        find_nodes(tree, tree->octant + o, nodes, local);
        defined = evaluate(tree, o, nodes, basis, &shape, local, &where);
        if (defined) {
            balance_gradients(tree, o, nodes, basis, &shape, local);
            weighted = sm_realloc(weighted, 4 * (size_t)local->points, sizeof *weighted);
            add_pairs(local, weighted, pairs);
        }
        forget_nodes(local);
    }
    free(weighted);
    ref_shape_free(&shape);
    if (defined) return SM_OK;
    return sm_fail(error, SM_INPUT,
                   "too few nodes cover the point (%g, %g, %g): the body is too thin there for its "
                   "octants; give it more nodes, or larger covers",
                   where[0], where[1], where[2]);
}

SmCode ref_matrices_build(const RefOctants *tree, const RefNodes *nodes, RefBasis basis,
                          const RefMaterial *material, RefMatrices *matrices, SmError *error)
{
    Local local;
    RefPairs pairs;
    *matrices = (RefMatrices){0};
    SmCode code = ref_material_check(material, error);
    if (code != SM_OK) return code;
    local_create(nodes, &local);
    find_pairs(tree, nodes, &local, &pairs);
    for (long n = 0; code == SM_OK && n < nodes->count; n++)
        if (pairs.start[n + 1] == pairs.start[n])
            code = sm_fail(error, SM_INPUT,
                           "the cover of the node at (%g, %g, %g) holds none of the body",
                           nodes->position[n][0], nodes->position[n][1], nodes->position[n][2]);
    if (code == SM_OK) code = ref_pairs_check(&pairs, error);
    if (code == SM_OK) code = integrate(tree, nodes, basis, &local, &pairs, error);
    if (code == SM_OK) {
        turn_stiff(material, &pairs);
        ref_pairs_matrices(&pairs, material->density, matrices);
    }
    ref_pairs_free(&pairs);
    local_free(&local);
    return code;
}
