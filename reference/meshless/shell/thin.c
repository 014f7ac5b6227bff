#include "thin.h"

#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"
#include "../motion/frame_sums.h"

/* Functions that leave a surface less than this share of its area, or more than so many times the
 * trace of its inverse metric, are none that say how it bends; nor are any where the trace, times
 * the area, was above the last, 2 of a conformal map. */
static const double LEAST_AREA = 0.6, MOST_TRACE = 2.5, MOST_DRAWN = 1000;

void ref_thin_law(const double g[3], double nu, double H[3][3])
{
    H[0][0] = g[0] * g[0];
    H[1][1] = g[1] * g[1];
    H[2][2] = ((1 - nu) * g[0] * g[1] + (1 + nu) * g[2] * g[2]) / 2;
    H[0][1] = H[1][0] = nu * g[0] * g[1] + (1 - nu) * g[2] * g[2];
    H[0][2] = H[2][0] = g[0] * g[2];
    H[1][2] = H[2][1] = g[1] * g[2];
}

void ref_thin_weights(double area, double thickness, const RefMaterial *material, double weight[2])
{
    double nu = material->poisson, membrane = area * material->young * thickness / (1 - nu * nu);
    weight[0] = sqrt(membrane);
    weight[1] = sqrt(membrane / 12) * thickness;
}

void ref_thin_factor(const double g[3], double nu, double G[3][3])
{
    double H[3][3];
    ref_thin_law(g, nu, H);
    memset(G, 0, sizeof(double[3][3]));
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            double sum = H[i][j];
            for (int k = 0; k < i; k++) sum -= G[k][i] * G[k][j];
            G[i][j] = i == j ? sqrt(sum) : sum / G[i][i];
        }
}

bool ref_thin_is_stiff(const RefFrame *frame, double area, double trace)
{
    return trace * area < MOST_DRAWN && frame->area > LEAST_AREA * area &&
           frame->inverse[0] + frame->inverse[1] < MOST_TRACE * trace;
}

double ref_thin_principal(const double mixed[2][2])
{
    double half = (mixed[0][0] + mixed[1][1]) / 2, off = (mixed[0][0] - mixed[1][1]) / 2;
    return half + sqrt(fmax(off * off + mixed[0][1] * mixed[1][0], 0));
}

/* Of the strains 11, 22, and 12 twice. */
static const double times[3] = {1, 1, 2};

void ref_thin_strains(const RefFrame *frame, const double sum[3][6], double strain[6])
{
    const double(*a)[3] = frame->tangent;
    double up[6] = {0};
    for (int k = 0; k < 3; k++) strain[k] = 0;
    for (int d = 0; d < 3; d++) {
        strain[0] += sum[d][1] * a[0][d];
        strain[1] += sum[d][2] * a[1][d];
        strain[2] += sum[d][1] * a[1][d] + sum[d][2] * a[0][d];
        for (int m = 1; m < 6; m++) up[m] += sum[d][m] * frame->normal[d];
    }
    for (int m = 0; m < 3; m++) {
        const double *symbol = frame->symbol[m];
        strain[3 + m] = -times[m] * (up[3 + m] - symbol[0] * up[1] - symbol[1] * up[2]);
    }
}

void ref_thin_pull(const RefFrame *frame, const double stress[6], double pull[6][3])
{
    const double(*a)[3] = frame->tangent;
    double up[6] = {0};
    for (int m = 0; m < 3; m++) {
        up[3 + m] = -times[m] * stress[3 + m];
        for (int k = 0; k < 2; k++) up[1 + k] -= up[3 + m] * frame->symbol[m][k];
    }
    for (int m = 0; m < 6; m++)
        for (int d = 0; d < 3; d++) pull[m][d] = up[m] * frame->normal[d];
    for (int d = 0; d < 3; d++) {
        pull[1][d] += stress[0] * a[0][d] + stress[2] * a[1][d];
        pull[2][d] += stress[1] * a[1][d] + stress[2] * a[0][d];
    }
}

/* G times the strains of ref_thin_strains(), of a function alone. */
static RefFrameRoot find_root(const RefFrame *frame, const double weight[2], double poisson)
{
    const double(*a)[3] = frame->tangent;
    RefFrameRoot root = {.normal = {frame->normal[0], frame->normal[1], frame->normal[2]}};
    double G[3][3];
    ref_thin_factor(frame->inverse, poisson, G);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 2; k++)
            for (int d = 0; d < 3; d++)
                root.membrane[i][k][d] = weight[0] * (G[i][k] * a[k][d] + G[i][2] * a[!k][d]);
        for (int m = i; m < 3; m++) {
            double bent = weight[1] * G[i][m] * times[m];
            for (int k = 0; k < 2; k++) root.bending[i][k] += bent * frame->symbol[m][k];
            root.bending[i][2 + m] = -bent;
        }
    }
    return root;
}

/* Writes a sample's row of the mass, and behind those of others its rows of the stiffness, if it
 * has any. A node that is there twice has both its functions in its columns. */
static void write_sample(const RefSamples *samples, long p, double t, const RefMaterial *material,
                         int nodes, double *shape, RefThinWork *work)
{
    long from = samples->start[p], columns = ref_frame_columns(3 * nodes);
    int count = (int)(samples->start[p + 1] - from);
    double *strain = work->strain + 6 * work->stiff * columns;
    const int *node = samples->node + from;
    const double(*part)[6] = (const double(*)[6])(samples->part + from);
    const RefFrame *frame = samples->frame + p;
    double weight[2], area = samples->area[p], root_of_mass = sqrt(area * t);
    ref_thin_weights(area, t, material, weight);
    bool stiff = ref_thin_is_stiff(frame, area / samples->weight[p], samples->trace[p]);
    for (int e = 0; e < count; e++) shape[work->number[node[e]]] += root_of_mass * part[e][0];
    if (!stiff) return;
    RefFrameRoot root = find_root(frame, weight, material->poisson);
    ref_frame_sums.root(count, node, work->number, part, &root, nodes, work->part, strain);
    work->stiff++;
}

RefThinWork ref_thin_work(long nodes)
{
    RefThinWork work = {.node = sm_alloc((size_t)nodes, sizeof(int)),
                        .number = sm_alloc((size_t)nodes, sizeof(int))};
    for (long n = 0; n < nodes; n++) work.number[n] = -1;
    return work;
}

void ref_thin_work_free(RefThinWork *work)
{
    sm_free_all(work->node, work->number, work->strain, work->shape, work->part, work->square);
    *work = (RefThinWork){.node = NULL};
}

void ref_element_free(RefElement *element)
{
    sm_free_all(element->node, element->sum);
    *element = (RefElement){.count = 0};
}

/* Squares of what was written, as pairs of nodes have them. */
static void square_rows(const RefThinWork *work, RefElement *element)
{
    int count = element->count, columns = ref_frame_columns(count);
    double(*sum)[10] = element->sum;
    ref_frame_sums.square(REF_SAMPLES_PER_CELL, columns, work->shape, work->square);
    for (int a = 0; a < count; a++)
        for (int b = a; b < count; b++) (*sum++)[0] = work->square[(long)a * columns + b];
    columns = ref_frame_columns(3 * count);
    ref_frame_sums.square(6 * work->stiff, columns, work->strain, work->square);
    sum = element->sum;
    for (int a = 0; a < count; a++)
        for (int b = a; b < count; b++, sum++)
            for (int k = 0; k < 9; k++) {
                int i = k / 3 * count + a, j = k % 3 * count + b;
                int low = i < j ? i : j, high = i + j - low;
                (*sum)[1 + k] = work->square[(long)low * columns + high];
            }
}

/* Room for rows of so many columns, where vectors like them. */
static void make_rows(long columns, RefThinWork *work)
{
    if (columns <= work->columns) return;
    size_t size = REF_SAMPLES_PER_CELL * (size_t)columns;
    sm_free_all(work->strain, work->shape, work->part, work->square);
    work->columns = columns;
    work->strain = sm_alloc(6 * size + REF_FRAME_TILE, sizeof *work->strain);
    work->part = sm_alloc(6 * (size_t)columns, sizeof *work->part);
    work->shape = sm_alloc(size, sizeof *work->shape);
    work->square = sm_alloc((size_t)(columns * columns), sizeof *work->square);
}

int ref_thin_element(const RefSamples *samples, long cell, double thickness,
                     const RefMaterial *material, RefThinWork *work, RefElement *element)
{
    int count = ref_samples_nodes(samples, cell, work->node, work->number);
    long wide = ref_frame_columns(3 * count), narrow = ref_frame_columns(count);
    if (count > element->room || !element->node) {
        element->room = count;
        element->node = sm_realloc(element->node, (size_t)count, sizeof *element->node);
        free(element->sum);
        element->sum = sm_alloc((size_t)count * ((size_t)count + 1) / 2, sizeof *element->sum);
    }
    element->count = count;
    memcpy(element->node, work->node, (size_t)count * sizeof *work->node);
    make_rows(wide, work);
    work->stiff = 0;
    memset(work->shape, 0, (size_t)(REF_SAMPLES_PER_CELL * narrow) * sizeof(double));
    for (int n = 0; n < REF_SAMPLES_PER_CELL; n++)
        write_sample(samples, cell * REF_SAMPLES_PER_CELL + n, thickness, material, count,
                     work->shape + n * narrow, work);
    square_rows(work, element);
    for (int n = 0; n < count; n++) work->number[element->node[n]] = -1;
    return REF_SAMPLES_PER_CELL - work->stiff;
}

void ref_element_meet(const RefElement *element, RefPairs *pairs)
{
    int *partner = sm_alloc((size_t)element->count, sizeof *partner);
    for (int a = 0; a < element->count; a++) {
        int count = 0;
        for (int b = a; b < element->count; b++)
            if (ref_element_sum(element, a, b)[0] != 0) partner[count++] = element->node[b];
        ref_pairs_add(pairs, element->node[a], count, partner);
    }
    free(partner);
}

void ref_element_add(const RefElement *element, RefPairs *pairs)
{
    for (int a = 0; a < element->count; a++) {
        long at = pairs->start[element->node[a]];
        for (int b = a; b < element->count; b++) {
            const double *sum = ref_element_sum(element, a, b);
            if (sum[0] == 0) continue;
            while (pairs->partner[at] != element->node[b]) at++;
            pairs->mass[at] += sum[0];
            for (int k = 0; k < 9; k++) pairs->block[at][k] += sum[1 + k];
        }
    }
}

/* Returns how many samples have no stiffness. */
static long integrate_all(const RefSamples *samples, double thickness, const RefMaterial *material,
                          RefPairs *pairs)
{
    RefThinWork work = ref_thin_work(pairs->count);
    RefElement element = {.count = 0};
    long soft = 0;
    for (long c = 0; c < samples->count / REF_SAMPLES_PER_CELL; c++) {
        soft += ref_thin_element(samples, c, thickness, material, &work, &element);
        ref_element_add(&element, pairs);
    }
    ref_element_free(&element);
    ref_thin_work_free(&work);
    return soft;
}

SmCode ref_thin_build(const double (*X)[3], RefSamples *samples, long nodes, double thickness,
                      const RefMaterial *material, RefMatrices *matrices, long *soft,
                      SmError *error)
{
    *matrices = (RefMatrices){0};
    SmCode code = ref_material_check(material, error);
    if (code == SM_OK && !(thickness > 0 && isfinite(thickness)))
        code = sm_fail(error, SM_USAGE, "a shell's thickness is %g; give one above 0", thickness);
    if (code != SM_OK) return code;
    RefPairs pairs = ref_samples_pairs(samples, nodes);
    code = ref_pairs_check(&pairs, error);
    if (code == SM_OK && !(ref_middle_areas(X, samples) > 0))
        code = sm_fail(error, SM_INPUT, "the shell's middle surface has no area");
    if (code == SM_OK) *soft = integrate_all(samples, thickness, material, &pairs);
    if (code == SM_OK) ref_pairs_matrices(&pairs, material->density, matrices);
    ref_pairs_free(&pairs);
    return code;
}
