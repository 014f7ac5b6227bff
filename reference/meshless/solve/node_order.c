#include "node_order.h"

#include <stdlib.h>

bool ref_node_order_fits(const RefMatrices *matrices)
{
    const RefSparse *K = &matrices->stiffness, *M = &matrices->mass;
    if (K->columns != 3 * M->columns || M->columns == 0) return false;
    for (int i = 0; i < M->columns; i++)
        for (int a = 0; a < 3; a++) { /* of the first of its columns the diagonal's two others */
            int column = 3 * i + a, count = 3 * (M->start[i + 1] - M->start[i]) - a;
            if (K->start[column + 1] - K->start[column] != count) return false;
            for (int e = M->start[i], at = K->start[column] - a; e < M->start[i + 1]; e++, at += 3)
                if (K->row[at + 2] != 3 * M->row[e] + 2) return false;
        }
    return true;
}

int *ref_node_order(const RefSparse *mass, cholmod_common *common)
{
    size_t nodes = (size_t)mass->columns;
    cholmod_sparse graph = {.nrow = nodes,
                            .ncol = nodes,
                            .nzmax = (size_t)mass->start[nodes],
                            .p = mass->start,
                            .i = mass->row,
                            .stype = -1,
                            .itype = CHOLMOD_INT,
                            .xtype = CHOLMOD_PATTERN,
                            .sorted = 1,
                            .packed = 1};
    common->nmethods = 1;
    common->method[0].ordering = CHOLMOD_AMD;
    cholmod_factor *symbolic = cholmod_analyze(&graph, common);
    if (!symbolic) return NULL;
    int *place = sm_alloc(nodes, sizeof *place);
    for (size_t n = 0; n < nodes; n++) place[((int *)symbolic->Perm)[n]] = (int)n;
    cholmod_free_factor(&symbolic, common);
    return place;
}

/* Where the columns of the matrix begin, by how many blocks each node's columns have: the
 * diagonal's of six entries, and others of nine. */
static void begin_columns(const RefSparse *M, const int *place, int *start)
{
    int *blocks = sm_alloc((size_t)M->columns, sizeof *blocks);
    for (int i = 0; i < M->columns; i++)
        for (int e = M->start[i]; e < M->start[i + 1]; e++) {
            int p = place[i], q = place[M->row[e]];
            blocks[p < q ? p : q]++;
        }
    for (int c = 0; c < 3 * M->columns; c++) start[c + 1] = start[c] + 3 * blocks[c / 3] - c % 3;
    free(blocks);
}

cholmod_sparse *ref_node_ordered(const RefMatrices *matrices, double shift, const int *place,
                                 cholmod_common *common)
{
    const RefSparse *K = &matrices->stiffness, *M = &matrices->mass;
    size_t size = (size_t)K->columns, entries = (size_t)K->start[size];
    cholmod_sparse *matrix =
        cholmod_allocate_sparse(size, size, entries, 0, 1, -1, CHOLMOD_REAL, common);
    if (!matrix) return NULL;
    int *start = matrix->p, *row = matrix->i;
    double *value = matrix->x;
    start[0] = 0;
    begin_columns(M, place, start);
    int *end = sm_copy(start, size, sizeof *end); /* of what is there of each column */
    for (int i = 0; i < M->columns; i++)
        for (int e = M->start[i]; e < M->start[i + 1]; e++) {
            int p = 3 * place[i], q = 3 * place[M->row[e]];
            const double *from[3], less = shift * M->value[e];
            for (int a = 0; a < 3; a++)
                from[a] = K->value + K->start[3 * i + a] + 3 * (e - M->start[i]) - a;
            for (int c = 0; c < 3; c++) { /* three columns, or the diagonal's lower half */
                const int column = (p < q ? p : q) + c, skip = p == q ? c : 0;
                const int begin = end[column] - skip; /* where its row 0 would be */
                end[column] += 3 - skip;
                for (int r = skip; r < 3; r++) {
                    row[begin + r] = (p < q ? q : p) + r;
                    value[begin + r] = (p <= q ? from[c][r] : from[r][c]) - (r == c ? less : 0);
                }
            }
        }
    free(end);
    return matrix;
}
