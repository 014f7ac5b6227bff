#include "harmonic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/csr.h"
#include "../solve/solver.h"

double *ref_harmonic_weights(const RefTriangulation *surface, double least)
{
    long corners = 3 * surface->triangles;
    double *weight = sm_alloc((size_t)corners, sizeof *weight);
    double *cotangent = sm_alloc((size_t)corners, sizeof *cotangent);
    for (long t = 0; t < surface->triangles; t++)
        ref_triangle_shape(surface->length + 3 * t, cotangent + 3 * t);
    for (int c = 0; c < corners; c++) {
        int twin = surface->twin[c];
        double sum = cotangent[ref_corner_last(c)];
        if (twin >= 0) sum += cotangent[ref_corner_last(twin)];
        weight[c] = least > 0 ? fmax(sum / 2, least) : sum / 2;
    }
    free(cotangent);
    return weight;
}

/* Numbers vertices that are not held; returns how many. Where none is held, the first one is. */
static int number_free(const RefTriangulation *surface, const bool *held, int *number)
{
    int count = 0;
    for (long v = 0; v < surface->vertices; v++)
        number[v] = (held ? held[v] : v == 0) ? -1 : count++;
    return count;
}

/* Every edge once: by the greater of its corners. */
static inline bool first_corner(const RefTriangulation *surface, int corner)
{
    return surface->twin[corner] < corner;
}

typedef struct {
    int row;
    double value;
} Entry;

/* Puts a column's entries in order, adding up those of one row; returns how many are left. */
static int tidy_column(Entry *entry, int count)
{
    int kept = 0;
    for (int n = 0; n < count; n++) {
        Entry one = entry[n];
        int at = kept;
        while (at > 0 && entry[at - 1].row > one.row) at--;
        if (at > 0 && entry[at - 1].row == one.row) {
            entry[at - 1].value += one.value;
            continue;
        }
        memmove(entry + at + 1, entry + at, (size_t)(kept - at) * sizeof *entry);
        entry[at] = one;
        kept++;
    }
    return kept;
}

/* The matrix of sum_ij w_ij (f_j - f_i)^2 over numbered vertices, its lower half. */
static RefSparse laplacian(const RefTriangulation *surface, const double *weight, const int *number,
                           int columns)
{
    long corners = 3 * surface->triangles;
    RefSparse matrix = {.columns = columns};
    long *begin = sm_alloc((size_t)columns + 2, sizeof *begin);
    for (int c = 0; c < corners; c++) {
        int i = number[surface->vertex[c]], j = number[surface->vertex[ref_corner_next(c)]];
        if (first_corner(surface, c) && i >= 0 && j >= 0) begin[(i < j ? i : j) + 2]++;
    }
    for (int j = 0; j < columns; j++) begin[j + 2] += begin[j + 1] + 1;
    Entry *entry = sm_alloc((size_t)begin[columns + 1], sizeof *entry);
    double *diagonal = sm_alloc((size_t)columns, sizeof *diagonal);
    for (int c = 0; c < corners; c++) {
        int i = number[surface->vertex[c]], j = number[surface->vertex[ref_corner_next(c)]];
        if (!first_corner(surface, c)) continue;
        if (i >= 0) diagonal[i] += weight[c];
        if (j >= 0) diagonal[j] += weight[c];
        if (i >= 0 && j >= 0)
            entry[begin[(i < j ? i : j) + 1]++] = (Entry){i < j ? j : i, -weight[c]};
    }
    for (int j = 0; j < columns; j++) entry[begin[j + 1]++] = (Entry){j, diagonal[j]};
    matrix.start = sm_alloc((size_t)columns + 1, sizeof *matrix.start);
    matrix.row = sm_alloc((size_t)begin[columns], sizeof *matrix.row);
    matrix.value = sm_alloc((size_t)begin[columns], sizeof *matrix.value);
    for (int j = 0; j < columns; j++) {
        int kept = tidy_column(entry + begin[j], (int)(begin[j + 1] - begin[j]));
        matrix.start[j + 1] = matrix.start[j] + kept;
        for (int n = 0; n < kept; n++) {
            matrix.row[matrix.start[j] + n] = entry[begin[j] + n].row;
            matrix.value[matrix.start[j] + n] = entry[begin[j] + n].value;
        }
    }
    sm_free_all(begin, entry, diagonal);
    return matrix;
}

/* Adds to a form the differences of the function that makes it harmonic: the solution of
 * sum_j w_ij (f_i - f_j) = sum_j w_ij form_ij. */
static void correct(const RefTriangulation *surface, const double *weight, const int *number,
                    int columns, RefSolver *solver, double *form)
{
    long corners = 3 * surface->triangles;
    double *right = sm_alloc((size_t)columns, sizeof *right);
    double *f = sm_alloc((size_t)columns, sizeof *f);
    for (int c = 0; c < corners; c++) {
        int i = number[surface->vertex[c]], j = number[surface->vertex[ref_corner_next(c)]];
        if (!first_corner(surface, c)) continue;
        if (i >= 0) right[i] += weight[c] * form[c];
        if (j >= 0) right[j] -= weight[c] * form[c];
    }
    ref_solver_solve(solver, right, NULL, f);
    for (int c = 0; c < corners; c++) {
        int i = number[surface->vertex[c]], j = number[surface->vertex[ref_corner_next(c)]];
        form[c] += (j >= 0 ? f[j] : 0) - (i >= 0 ? f[i] : 0);
    }
    sm_free_all(right, f);
}

SmCode ref_harmonic_solve(const RefTriangulation *surface, const double *weight, const bool *held,
                          int count, double *const *form, SmError *error)
{
    RefSolver *solver;
    int *number = sm_alloc((size_t)surface->vertices, sizeof *number);
    int columns = number_free(surface, held, number);
    RefMatrices sums = {.stiffness = laplacian(surface, weight, number, columns)};
    SmCode code = columns ? ref_solver_create(&sums, 0, NULL, &solver, error) : SM_OK;
    ref_matrices_free(&sums);
    if (code == SM_OK && columns) {
        for (int n = 0; n < count; n++) correct(surface, weight, number, columns, solver, form[n]);
        ref_solver_destroy(solver);
    }
    free(number);
    return code;
}

SmCode ref_harmonic_potentials(const RefTriangulation *surface, const double *weight, int count,
                               double *const *source, double *const *u, SmError *error)
{
    RefSolver *solver;
    int *number = sm_alloc((size_t)surface->vertices, sizeof *number);
    int columns = number_free(surface, NULL, number);
    RefMatrices sums = {.stiffness = laplacian(surface, weight, number, columns)};
    SmCode code = ref_solver_create(&sums, 0, NULL, &solver, error);
    ref_matrices_free(&sums);
    free(number);
    if (code != SM_OK) return code;
    for (int n = 0; n < count; n++) {
        ref_solver_solve(solver, source[n] + 1, NULL, u[n] + 1);
        u[n][0] = 0;
    }
    ref_solver_destroy(solver);
    return SM_OK;
}

double ref_harmonic_product(const RefTriangulation *surface, const double *weight, const double *a,
                            const double *b)
{
    double sum = 0;
    for (int c = 0; c < 3 * surface->triangles; c++)
        if (first_corner(surface, c)) sum += weight[c] * a[c] * b[c];
    return sum;
}

double ref_harmonic_wedge(const RefTriangulation *surface, const double *a, const double *b)
{
    double sum = 0;
    for (long c = 0; c < 3 * surface->triangles; c += 3)
        sum += (a[c] * b[c + 1] - a[c + 1] * b[c]) / 2;
    return sum;
}

/* Adds a vertex to the tree, and with it, where rims are followed, all of its rim. */
static long reach(const RefTriangulation *surface, int vertex, int by, bool rims, int *from,
                  int *order, long end)
{
    int at = surface->corner[vertex];
    from[vertex] = by;
    order[end++] = vertex;
    if (!rims || surface->rim[at] < 0) return end;
    for (int next = surface->vertex[ref_corner_next(at)]; next != vertex;
         next = surface->vertex[ref_corner_next(at)]) {
        from[next] = at;
        order[end++] = next;
        at = surface->corner[next];
    }
    return end;
}

/* A tree of edges from a vertex: [vertices] the corner whose edge leads to each, -1 for the root;
 * and the order in which they were reached. With `rims` all edges but one of each rim are in it. */
static int *edge_tree(const RefTriangulation *surface, int root, bool rims, int *order)
{
    enum { UNSEEN = -2 };
    int *from = sm_alloc((size_t)surface->vertices, sizeof *from);
    for (long v = 0; v < surface->vertices; v++) from[v] = UNSEEN;
    long end = reach(surface, root, -1, rims, from, order, 0);
    for (long n = 0; n < end; n++) {
        int first = surface->corner[order[n]], at = first;
        do {
            int other = surface->vertex[ref_corner_next(at)];
            if (from[other] == UNSEEN) end = reach(surface, other, at, rims, from, order, end);
            at = ref_corner_left(surface, at);
        } while (at >= 0 && at != first);
    }
    return from;
}

/* A tree of triangles from one, across edges that are not barred (NULL: none is): [triangles] the
 * corner whose edge leads back, -1 for the root. */
static int *triangle_tree(const RefTriangulation *surface, int root, const bool *barred)
{
    int *back = sm_alloc((size_t)surface->triangles, sizeof *back);
    int *queue = sm_alloc((size_t)surface->triangles, sizeof *queue);
    long end = 1;
    for (long t = 0; t < surface->triangles; t++) back[t] = -1;
    queue[0] = root;
    for (long n = 0; n < end; n++)
        for (int c = 3 * queue[n]; c < 3 * queue[n] + 3; c++) {
            int twin = surface->twin[c];
            if (twin < 0 || (barred && barred[c])) continue;
            if (twin / 3 == root || back[twin / 3] >= 0) continue;
            back[twin / 3] = twin;
            queue[end++] = twin / 3;
        }
    free(queue);
    return back;
}

/* Adds `sign` to the form at edges on the way from a triangle to the tree's root. */
static void cross_back(const RefTriangulation *surface, const int *back, int triangle, double sign,
                       double *form)
{
    for (int c = back[triangle]; c >= 0; c = back[surface->twin[c] / 3]) {
        form[c] += sign;
        form[surface->twin[c]] -= sign;
    }
}

void ref_harmonic_loops(const RefTriangulation *surface, double **form)
{
    size_t corners = 3 * (size_t)surface->triangles;
    bool *barred = sm_alloc(corners, sizeof *barred);
    int *order = sm_alloc((size_t)surface->vertices, sizeof *order), found = 0;
    int *from = edge_tree(surface, 0, true, order);
    for (long v = 0; v < surface->vertices; v++) {
        if (from[v] < 0) continue;
        barred[from[v]] = true;
        if (surface->twin[from[v]] >= 0) barred[surface->twin[from[v]]] = true;
    }
    int *back = triangle_tree(surface, 0, barred);
    for (int c = 0; c < (int)corners; c++) {
        int twin = surface->twin[c];
        if (twin < 0 || twin > c || barred[c] || back[c / 3] == c || back[twin / 3] == twin)
            continue;
        double *loop = form[found++] = sm_alloc(corners, sizeof *loop);
        loop[c] += 1;
        loop[twin] -= 1;
        cross_back(surface, back, twin / 3, 1, loop);
        cross_back(surface, back, c / 3, -1, loop);
    }
    sm_free_all(barred, order, from, back);
}

double *ref_harmonic_crossing(const RefTriangulation *surface, int from, int to)
{
    long corners = 3 * surface->triangles;
    int end[2] = {-1, -1};
    double *form = sm_alloc((size_t)corners, sizeof *form);
    for (int c = 0; c < corners; c++)
        if (surface->rim[c] == from || surface->rim[c] == to) end[surface->rim[c] == to] = c;
    int *back = triangle_tree(surface, end[0] / 3, NULL);
    form[end[1]] -= 1;
    cross_back(surface, back, end[1] / 3, 1, form);
    form[end[0]] += 1;
    free(back);
    return form;
}

double *ref_harmonic_integral(const RefTriangulation *surface, int root, const double *form)
{
    int *order = sm_alloc((size_t)surface->vertices, sizeof *order);
    int *from = edge_tree(surface, root, false, order);
    double *sum = sm_alloc((size_t)surface->vertices, sizeof *sum);
    for (long n = 1; n < surface->vertices; n++) {
        int v = order[n];
        sum[v] = sum[surface->vertex[from[v]]] + form[from[v]];
    }
    sm_free_all(order, from);
    return sum;
}
