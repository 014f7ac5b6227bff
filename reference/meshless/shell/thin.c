#include "thin.h"

#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"

/* One terminal cell: its nodes, and the sums of their pairs. */
typedef struct {
    int count;
    int *node, *number;
    double (*sum)[10]; /* [count][count] mass and block, of the upper half */
    double (*row)[18]; /* [covers of a sample] the strains' rows, weighted */
} Cell;

/* The upper factor G of H = G^T G, H the constitutive matrix for vectors (11, 22, 2 x 12), of the
 * inverse metric (11, 22, 12). */
static void factor_of(const double g[3], double nu, double G[3][3])
{
    double H[3][3] = {{g[0] * g[0], nu * g[0] * g[1] + (1 - nu) * g[2] * g[2], g[0] * g[2]},
                      {0, g[1] * g[1], g[1] * g[2]},
                      {0, 0, ((1 - nu) * g[0] * g[1] + (1 + nu) * g[2] * g[2]) / 2}};
    memset(G, 0, sizeof(double[3][3]));
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            double sum = H[i][j];
            for (int k = 0; k < i; k++) sum -= G[k][i] * G[k][j];
            G[i][j] = i == j ? sqrt(sum) : sum / G[i][i];
        }
}

/* What a node's parameters do to the strains: B, three rows of membrane, three of bending. */
static void strains(const RefFrame *frame, const double part[6], double B[6][3])
{
    static const double times[3] = {1, 1, 2};
    const double(*a)[3] = frame->tangent;
    for (int d = 0; d < 3; d++) {
        B[0][d] = part[1] * a[0][d];
        B[1][d] = part[2] * a[1][d];
        B[2][d] = part[1] * a[1][d] + part[2] * a[0][d];
        for (int m = 0; m < 3; m++) {
            const double *symbol = frame->symbol[m];
            double D = part[3 + m] - symbol[0] * part[1] - symbol[1] * part[2];
            B[3 + m][d] = -times[m] * D * frame->normal[d];
        }
    }
}

/* Rows whose products are the blocks of the stiffness. */
static void weigh_rows(const double B[6][3], const double G[3][3], const double weight[2],
                       double row[18])
{
    for (int kind = 0; kind < 2; kind++)
        for (int i = 0; i < 3; i++)
            for (int d = 0; d < 3; d++) {
                double sum = 0;
                for (int j = i; j < 3; j++) sum += G[i][j] * B[3 * kind + j][d];
                row[9 * kind + 3 * i + d] = weight[kind] * sum;
            }
}

/* All pairs I <= J of a sample's functions; a node that is there twice meets itself, both ways. */
static void add_sample(const RefSamples *samples, long p, double mass, Cell *cell)
{
    const int *node = samples->node + samples->start[p];
    const double(*part)[6] = (const double(*)[6])(samples->part + samples->start[p]);
    int count = (int)(samples->start[p + 1] - samples->start[p]);
    for (int e = 0; e < count; e++)
        for (int f = 0; f < count; f++) {
            if (node[e] > node[f]) continue;
            const double *left = cell->row[e], *right = cell->row[f];
            double *sum =
                cell->sum[(long)cell->number[node[e]] * cell->count + cell->number[node[f]]];
            sum[0] += mass * part[e][0] * part[f][0];
            for (int i = 0; i < 6; i++)
                for (int a = 0; a < 3; a++)
                    for (int b = 0; b < 3; b++)
                        sum[1 + 3 * a + b] += left[3 * i + a] * right[3 * i + b];
        }
}

/* Adds a sample's share; false where the surface has no area. */
static bool integrate(const double (*X)[3], const RefSamples *samples, long p, double t,
                      const RefMaterial *material, Cell *cell)
{
    long from = samples->start[p];
    int count = (int)(samples->start[p + 1] - from);
    const double(*part)[6] = (const double(*)[6])(samples->part + from);
    RefFrame frame = ref_middle_at(X, count, samples->node + from, part);
    double nu = material->poisson, G[3][3], B[6][3], area = frame.area * samples->weight[p];
    double membrane = area * material->young * t / (1 - nu * nu);
    double weight[2] = {sqrt(membrane), sqrt(membrane / 12) * t};
    if (!(frame.area > 0)) return false;
    factor_of(frame.inverse, nu, G);
    for (int e = 0; e < count; e++) {
        strains(&frame, part[e], B);
        weigh_rows((const double(*)[3])B, (const double(*)[3])G, weight, cell->row[e]);
    }
    add_sample(samples, p, area * t, cell);
    return true;
}

static void add_cell(const Cell *cell, RefPairs *pairs)
{
    for (int a = 0; a < cell->count; a++) {
        long at = pairs->start[cell->node[a]];
        for (int b = a; b < cell->count; b++) {
            const double *sum = cell->sum[(long)a * cell->count + b];
            while (pairs->partner[at] != cell->node[b]) at++;
            pairs->mass[at] += sum[0];
            for (int k = 0; k < 9; k++) pairs->block[at][k] += sum[1 + k];
        }
    }
}

/* All cells; returns the first sample at which the surface has no area, or -1. */
static long integrate_all(const double (*X)[3], const RefSamples *samples, double thickness,
                          const RefMaterial *material, RefPairs *pairs)
{
    size_t nodes = (size_t)pairs->count;
    Cell cell = {.node = sm_alloc(nodes, sizeof(int)), .number = sm_alloc(nodes, sizeof(int))};
    long bad = -1, most = 0;
    for (size_t n = 0; n < nodes; n++) cell.number[n] = -1;
    for (long p = 0; p < samples->count; p++)
        most = samples->start[p + 1] - samples->start[p] > most
                   ? samples->start[p + 1] - samples->start[p]
                   : most;
    cell.row = sm_alloc((size_t)most, sizeof *cell.row);
    for (long c = 0; bad < 0 && c < samples->count / REF_SAMPLES_PER_CELL; c++) {
        cell.count = ref_samples_nodes(samples, c, cell.node, cell.number);
        size_t all = (size_t)cell.count * (size_t)cell.count;
        cell.sum = sm_realloc(cell.sum, all, sizeof *cell.sum);
        memset(cell.sum, 0, all * sizeof *cell.sum);
        for (long p = c * REF_SAMPLES_PER_CELL; bad < 0 && p < (c + 1) * REF_SAMPLES_PER_CELL; p++)
            if (!integrate(X, samples, p, thickness, material, &cell)) bad = p;
        add_cell(&cell, pairs);
        for (int n = 0; n < cell.count; n++) cell.number[cell.node[n]] = -1;
    }
    sm_free_all(cell.node, cell.number, cell.sum, cell.row);
    return bad;
}

SmCode ref_thin_build(const double (*X)[3], const RefSamples *samples, long nodes, double thickness,
                      const RefMaterial *material, RefMatrices *matrices, SmError *error)
{
    *matrices = (RefMatrices){0};
    SmCode code = ref_material_check(material, error);
    if (code == SM_OK && !(thickness > 0 && isfinite(thickness)))
        code = sm_fail(error, SM_USAGE, "a shell's thickness is %g; give one above 0", thickness);
    if (code != SM_OK) return code;
    RefPairs pairs = ref_samples_pairs(samples, nodes);
    code = ref_pairs_check(&pairs, error);
    long bad = code == SM_OK ? integrate_all(X, samples, thickness, material, &pairs) : -1;
    if (bad >= 0)
        code = sm_fail(error, SM_INPUT,
                       "the shell's middle surface has no area at the parameters (%g, %g)",
                       samples->theta[bad][0], samples->theta[bad][1]);
    if (code == SM_OK) ref_pairs_matrices(&pairs, material->density, matrices);
    ref_pairs_free(&pairs);
    return code;
}
