/* frame_sums.c - compiled as the kernels are, for each instruction set: compilers make vectors of
 * these loops. */
#include "frame_sums.h"

#include <stdbool.h>
#include <string.h>

#include "../../../lib/simd/real.h"

enum { LANES = REF_SKIN_LANES };

static void apply(int modes, int rows, const double *row, const double *z, double *sums)
{
    for (int r = 0; r < rows; r++, row += modes) {
        double sum = 0;
#pragma omp simd reduction(+ : sum)
        for (int k = 0; k < modes; k++) sum += row[k] * z[k];
        sums[r] = sum;
    }
}

static void add(int modes, const double f[3], const double *row, double *modal)
{
    const double x = f[0], y = f[1], z = f[2];
#pragma omp simd
    for (int k = 0; k < modes; k++)
        modal[k] += x * row[k] + y * row[modes + k] + z * row[2 * modes + k];
}

/* Points whose sums, three of solids and six of shells, stay in registers. */
enum { PART = SM_VECTOR_BYTES < 32 ? LANES / 2 : LANES };

/* Into sum, three rows of LANES. */
static void place_part(int nodes, const float *weight, const float (*moved)[3], float *sum)
{
    float x[PART] = {0}, y[PART] = {0}, z[PART] = {0};
    for (int n = 0; n < nodes; n++)
        for (int p = 0; p < PART; p++) {
            x[p] += weight[n * LANES + p] * moved[n][0];
            y[p] += weight[n * LANES + p] * moved[n][1];
            z[p] += weight[n * LANES + p] * moved[n][2];
        }
    memcpy(sum, x, sizeof x);
    memcpy(sum + LANES, y, sizeof y);
    memcpy(sum + 2 * LANES, z, sizeof z);
}

/* The same and `lift` times the turns of normals, in one pass over the weights. */
static void lift_part(int nodes, const float *weight, const float (*moved)[3],
                      const float (*turned)[3], const float *lift, float *sum)
{
    float x[PART] = {0}, y[PART] = {0}, z[PART] = {0};
    float u[PART] = {0}, v[PART] = {0}, w[PART] = {0};
    for (int n = 0; n < nodes; n++)
        for (int p = 0; p < PART; p++) {
            x[p] += weight[n * LANES + p] * moved[n][0];
            y[p] += weight[n * LANES + p] * moved[n][1];
            z[p] += weight[n * LANES + p] * moved[n][2];
            u[p] += weight[n * LANES + p] * turned[n][0];
            v[p] += weight[n * LANES + p] * turned[n][1];
            w[p] += weight[n * LANES + p] * turned[n][2];
        }
    for (int p = 0; p < PART; p++) {
        sum[p] = x[p] + lift[p] * u[p];
        sum[LANES + p] = y[p] + lift[p] * v[p];
        sum[2 * LANES + p] = z[p] + lift[p] * w[p];
    }
}

static void gather(const RefSkin *skin, const RefSkinBlock *block, const double (*from)[3],
                   float (*near)[3])
{
    for (int n = 0; n < block->nodes; n++)
        for (int d = 0; d < 3; d++) near[n][d] = (float)from[skin->node[block->node + n]][d];
}

static void place(const RefSkin *skin, const RefSkinBlock *block, const double (*moved)[3],
                  const double (*turned)[3], double (*position)[3])
{
    const float *weight = skin->weight + block->weight;
    float(*near)[3] = skin->near, (*normal)[3] = skin->near + block->nodes;
    gather(skin, block, moved, near);
    if (turned) gather(skin, block, turned, normal);
    for (int begin = 0; begin < block->points; begin += LANES, weight += LANES * block->nodes) {
        float sum[3 * LANES];
        long first = block->first + begin;
        int end = block->points - begin < LANES ? block->points - begin : LANES;
        for (int p = 0; p < end; p += PART) {
            if (turned)
                lift_part(block->nodes, weight + p, (const float(*)[3])near,
                          (const float(*)[3])normal, skin->lift + first + p, sum + p);
            else
                place_part(block->nodes, weight + p, (const float(*)[3])near, sum + p);
        }
        for (int p = 0; p < end; p++)
            for (int d = 0; d < 3; d++)
                position[first + p][d] = skin->rest[first + p][d] + (double)sum[d * LANES + p];
    }
}

/* As many doubles as sums of stay in registers, anywhere where doubles may be: the compiler takes
 * wider vectors than the processor's through memory. */
enum { WIDE = SM_VECTOR_BYTES / sizeof(double) };
typedef double Wide __attribute__((vector_size(SM_VECTOR_BYTES), aligned(sizeof(double))));
_Static_assert(REF_FRAME_SLOPES % WIDE == 0, "whole vectors");

/* Parts side by side, four and two. */
typedef double Four __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double))));
typedef double Two __attribute__((vector_size(2 * sizeof(double)), aligned(sizeof(double))));

static void derive(int count, const int *node, const double (*part)[6], const double (*u)[3],
                   double sum[3][6])
{
    Four four[2][3] = {{{0}}};
    Two two[2][3] = {{{0}}};
    for (int n = 0; n < count; n += 2)
        for (int k = 0; k < 2 && n + k < count; k++) { /* each waits for the one before the other */
            const Four first = *(const Four *)part[n + k];
            const Two second = *(const Two *)(part[n + k] + 4);
            const double *at = u[node[n + k]];
            for (int d = 0; d < 3; d++) {
                four[k][d] += first * at[d];
                two[k][d] += second * at[d];
            }
        }
    for (int d = 0; d < 3; d++) {
        *(Four *)sum[d] = four[0][d] + four[1][d];
        *(Two *)(sum[d] + 4) = two[0][d] + two[1][d];
    }
}

static void pull(int count, const int *node, const double (*part)[6], const double times[6][3],
                 double (*force)[3])
{
    Four by[6];
    for (int m = 0; m < 6; m++) by[m] = (Four){times[m][0], times[m][1], times[m][2]};
    for (int n = 0; n < count; n++) {
        Four even = by[0] * part[n][0], odd = by[1] * part[n][1];
        for (int m = 2; m < 6; m += 2) {
            even += by[m] * part[n][m];
            odd += by[m + 1] * part[n][m + 1];
        }
        even += odd;
        for (int d = 0; d < 3; d++) force[node[n]][d] += even[d];
    }
}

/* Parts 1 to 5 of all nodes, node by node. */
static void gather_parts(int count, const int *node, const int *place, const double (*part)[6],
                         int nodes, double *at)
{
    const int stride = ref_frame_columns(nodes);
    memset(at, 0, 5 * (size_t)stride * sizeof *at);
    for (int n = 0; n < count; n++)
        for (int m = 0; m < 5; m++) at[m * stride + place[node[n]]] += part[n][1 + m];
}

/* What is written beyond the last node, nothing, is where what follows is written. */
static void root(int count, const int *node, const int *place, const double (*part)[6],
                 const RefFrameRoot *root, int nodes, double *work, double *row)
{
    const int stride = ref_frame_columns(nodes), columns = ref_frame_columns(3 * nodes);
    double *bent = work + 5 * stride;
    gather_parts(count, node, place, part, nodes, work);
    for (int i = 0; i < 3; i++, row += columns)
        for (int d = 0; d < 3; d++)
            for (int n = 0; n < nodes; n += WIDE)
                *(Wide *)(row + d * nodes + n) =
                    root->membrane[i][0][d] * *(const Wide *)(work + n) +
                    root->membrane[i][1][d] * *(const Wide *)(work + stride + n);
    for (int i = 0; i < 3; i++, row += columns) {
        for (int n = 0; n < nodes; n += WIDE) {
            Wide sum = {0};
            for (int m = 0; m < 5; m++)
                sum += root->bending[i][m] * *(const Wide *)(work + m * stride + n);
            *(Wide *)(bent + n) = sum;
        }
        for (int d = 0; d < 3; d++)
            for (int n = 0; n < nodes; n += WIDE)
                *(Wide *)(row + d * nodes + n) = root->normal[d] * *(const Wide *)(bent + n);
    }
}

/* Points that are weighed at once. */
typedef double Points
    __attribute__((vector_size(REF_SKIN_SHARED * sizeof(double)), aligned(sizeof(double))));
typedef long long PointBits __attribute__((vector_size(REF_SKIN_SHARED * sizeof(double))));
typedef float PointFloats
    __attribute__((vector_size(REF_SKIN_SHARED * sizeof(float)), aligned(sizeof(float))));

_Static_assert(REF_SKIN_SHARED == 8, "lanes are numbered below");

static void weigh(const RefSkinShare *share, const double (*times)[REF_SKIN_ROOM],
                  const int *number, float *row)
{
    const int end = share->first + share->points;
    for (int first = share->first; first < end; first += REF_SKIN_SHARED) {
        const PointBits in = (PointBits){0, 1, 2, 3, 4, 5, 6, 7} < end - first - (PointBits){0};
        Points here[6]; /* what follows the last point gets nothing */
        for (int m = 0; m < 6; m++)
            here[m] = (Points)((PointBits) * (const Points *)(times[m] + first) & in);
        for (int n = 0; n < share->nodes; n++) {
            const double *part = share->part[n];
            float *to = row + number[share->node[n]] * REF_SKIN_BLOCK + first;
            Points even = here[0] * part[0], odd = here[1] * part[1];
            for (int m = 2; m < 6; m += 2) {
                even += here[m] * part[m];
                odd += here[m + 1] * part[m + 1];
            }
            *(PointFloats *)to += __builtin_convertvector(even + odd, PointFloats);
        }
    }
}

static void parts(int count, const int *node, const double (*part)[6],
                  const double (*field)[REF_FRAME_SLOPES], double sum[6][REF_FRAME_SLOPES])
{
    for (int first = 0; first < REF_FRAME_SLOPES; first += WIDE) {
        Wide at[6] = {{0}};
        for (int n = 0; n < count; n++) {
            const Wide here = *(const Wide *)(field[node[n]] + first);
            for (int m = 0; m < 6; m++) at[m] += here * part[n][m];
        }
        for (int m = 0; m < 6; m++) *(Wide *)(sum[m] + first) = at[m];
    }
}

static void slopes(int count, const int *node, const double (*slope)[REF_FRAME_SLOPES],
                   const double (*u)[3], double sum[3][REF_FRAME_SLOPES])
{
    for (int first = 0; first < REF_FRAME_SLOPES; first += WIDE) {
        Wide x = {0}, y = {0}, z = {0};
        for (int n = 0; n < count; n++) {
            const Wide here = *(const Wide *)(slope[n] + first);
            const double *at = u[node[n]];
            x += here * at[0];
            y += here * at[1];
            z += here * at[2];
        }
        *(Wide *)(sum[0] + first) = x;
        *(Wide *)(sum[1] + first) = y;
        *(Wide *)(sum[2] + first) = z;
    }
}

static void spread(int count, const int *node, const double (*slope)[REF_FRAME_SLOPES],
                   const double gain[REF_FRAME_SLOPES][REF_FRAME_SLOPES],
                   double (*to)[REF_FRAME_SLOPES])
{
    for (int first = 0; first < REF_FRAME_SLOPES; first += WIDE) {
        Wide from[REF_FRAME_SLOPES];
        for (int j = 0; j < REF_FRAME_SLOPES; j++) from[j] = *(const Wide *)(gain[j] + first);
        for (int n = 0; n < count; n++) {
            Wide *at = (Wide *)(to[node[n]] + first), even = *at, odd = {0};
            for (int j = 0; j < REF_FRAME_SLOPES; j += 2) {
                even += from[j] * slope[n][j];
                odd += from[j + 1] * slope[n][j + 1];
            }
            *at = even + odd;
        }
    }
}

/* Sums that stay in registers: some rows of them, one or two vectors wide. */
enum { HIGH = SM_VECTOR_BYTES < 64 ? 4 : 8 };
_Static_assert(REF_FRAME_TILE % HIGH == 0 && REF_FRAME_TILE % WIDE == 0, "whole blocks");

static inline __attribute__((always_inline)) void square_block(int vectors, int rows, int columns,
                                                               const double *left,
                                                               const double *right, double *sum)
{
    Wide at[HIGH][2] = {{{0}}};
    for (int r = 0; r < rows; r++, left += columns, right += columns)
        for (int k = 0; k < vectors; k++) {
            const Wide here = *(const Wide *)(right + k * WIDE);
            for (int i = 0; i < HIGH; i++) at[i][k] += here * left[i];
        }
    for (int i = 0; i < HIGH; i++, sum += columns)
        for (int k = 0; k < vectors; k++) *(Wide *)(sum + k * WIDE) = at[i][k];
}

/* Two vectors of columns, and where they meet the diagonal or the last column, one. */
static void square(int rows, int columns, const double *row, double *sum)
{
    for (int j = 0, next; j < columns; j = next) { /* these columns stay near */
        bool two = j + 2 * WIDE <= columns;
        next = j + (two ? 2 : 1) * WIDE;
        for (int i = 0; i < next; i += HIGH) {
            if (two && i < j + WIDE)
                square_block(2, rows, columns, row + i, row + j, sum + i * columns + j);
            else
                square_block(1, rows, columns, row + i, row + next - WIDE,
                             sum + i * columns + next - WIDE);
        }
    }
}

const RefFrameSums SM_ISA_NAME(ref_frame_sums) = {apply, add,   place,  weigh,  derive, pull,
                                                  root,  parts, slopes, spread, square};
