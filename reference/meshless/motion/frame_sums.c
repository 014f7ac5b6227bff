/* frame_sums.c - compiled as the kernels are, for each instruction set: compilers make vectors of
 * these loops. */
#include "frame_sums.h"

#include <string.h>

#include "../../../lib/simd/real.h"

enum { LANES = REF_SKIN_LANES, TILE = REF_FRAME_TILE };

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

static void weigh(const RefSkinShare *share, const int *column, float *row)
{
    enum { AT_ONCE = REF_SKIN_SHARED };
    for (int first = 0; first < share->points; first += AT_ONCE)
        for (int n = 0; n < share->nodes; n++) {
            const double *part = share->part[n];
            float *to = row + column[n] + first;
            for (int p = 0; p < AT_ONCE; p++) {
                double sum = 0;
                for (int m = 0; m < 6; m++) sum += share->times[m][first + p] * part[m];
                to[p] += (float)sum;
            }
        }
}

/* Slopes side by side, anywhere where doubles may be. */
typedef double Slopes
    __attribute__((vector_size(REF_FRAME_SLOPES * sizeof(double)), aligned(sizeof(double))));

static void parts(int count, const int *node, const double (*part)[6],
                  const double (*field)[REF_FRAME_SLOPES], double sum[6][REF_FRAME_SLOPES])
{
    Slopes at[6] = {{0}};
    for (int n = 0; n < count; n++) {
        const Slopes *here = (const Slopes *)field[node[n]];
        for (int m = 0; m < 6; m++) at[m] += *here * part[n][m];
    }
    for (int m = 0; m < 6; m++) *(Slopes *)sum[m] = at[m];
}

static void slopes(int count, const int *node, const double (*slope)[REF_FRAME_SLOPES],
                   const double (*u)[3], double sum[3][REF_FRAME_SLOPES])
{
    Slopes x = {0}, y = {0}, z = {0};
    for (int n = 0; n < count; n++) {
        const Slopes *here = (const Slopes *)slope[n];
        const double *at = u[node[n]];
        x += *here * at[0];
        y += *here * at[1];
        z += *here * at[2];
    }
    *(Slopes *)sum[0] = x;
    *(Slopes *)sum[1] = y;
    *(Slopes *)sum[2] = z;
}

static void spread(int count, const int *node, const double (*slope)[REF_FRAME_SLOPES],
                   const double gain[REF_FRAME_SLOPES][REF_FRAME_SLOPES],
                   double (*to)[REF_FRAME_SLOPES])
{
    Slopes from[REF_FRAME_SLOPES];
    memcpy(from, gain, sizeof from);
    for (int n = 0; n < count; n++) {
        Slopes *at = (Slopes *)to[node[n]], even = *at, odd = {0};
        for (int j = 0; j < REF_FRAME_SLOPES; j += 2) {
            even += from[j] * slope[n][j];
            odd += from[j + 1] * slope[n][j + 1];
        }
        *at = even + odd;
    }
}

/* As many doubles as a vector of the processor's has, anywhere where doubles may be. */
typedef double Part __attribute__((vector_size(SM_VECTOR_BYTES), aligned(sizeof(double))));

/* Four rows of sums, a tile wide, which stay in registers. */
static void square_tile(int rows, int columns, const double *left, const double *right, double *sum)
{
    enum { PARTS = TILE * sizeof(double) / sizeof(Part) };
    Part w[PARTS] = {{0}}, x[PARTS] = {{0}}, y[PARTS] = {{0}}, z[PARTS] = {{0}};
    for (int r = 0; r < rows; r++, left += columns, right += columns)
#pragma GCC unroll 16
        for (int k = 0; k < PARTS; k++) {
            const Part here = ((const Part *)right)[k];
            w[k] += left[0] * here;
            x[k] += left[1] * here;
            y[k] += left[2] * here;
            z[k] += left[3] * here;
        }
    memcpy(sum, w, sizeof w);
    memcpy(sum + columns, x, sizeof x);
    memcpy(sum + 2 * columns, y, sizeof y);
    memcpy(sum + 3 * columns, z, sizeof z);
}

static void square(int rows, int columns, const double *row, double *sum)
{
    for (int i = 0; i < columns; i += 4)
        for (int j = i / TILE * TILE; j < columns; j += TILE)
            square_tile(rows, columns, row + i, row + j, sum + i * columns + j);
}

const RefFrameSums SM_ISA_NAME(ref_frame_sums) = {apply, add,    place,  weigh,
                                                  parts, slopes, spread, square};
