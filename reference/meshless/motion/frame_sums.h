/* frame_sums.h - the sums that a frame consists of (meshless section 5.3), of the instruction set
 * in use (lib/isa.h): they stream the modes' rows and the skin's weights, which are all that a
 * frame reads; and, of a shell that breaks, the squares that its elements are, and the weights. */
#ifndef REF_FRAME_SUMS_H
#define REF_FRAME_SUMS_H

#include "skin.h"

enum { REF_FRAME_SLOPES = 8 /* of a shell's cell, at once */, REF_FRAME_TILE = 8 };

/* What a shell's strains at a sample are, as rows whose squares are its energy: of membrane what
 * slopes along both parameters are multiplied by, of bending what all parts but the value are,
 * and that by the normal. */
typedef struct {
    double membrane[3][2][3], bending[3][5], normal[3];
} RefFrameRoot;

typedef struct {
    /* sum[r] = row[r] . z, of `rows` rows of `modes`. */
    void (*apply)(int modes, int rows, const double *row, const double *z, double *sum);

    /* modal += f[0] row[0] + f[1] row[1] + f[2] row[2], rows of `modes`. */
    void (*add)(int modes, const double f[3], const double *row, double *modal);

    /* ref_skin_place() of one block. */
    void (*place)(const RefSkin *skin, const RefSkinBlock *block, const double (*moved)[3],
                  const double (*turned)[3], double (*position)[3]);

    /* Adds the weights that points share to rows of REF_SKIN_BLOCK, of node n the row number[n];
     * there is room for one more. */
    void (*weigh)(const RefSkinShare *share, const double (*times)[REF_SKIN_ROOM],
                  const int *number, float *row);

    /* sum[d][m] = sum over the functions of part[n][m] u[node[n]][d]. */
    void (*derive)(int count, const int *node, const double (*part)[6], const double (*u)[3],
                   double sum[3][6]);

    /* The transpose: force[node[n]][d] += sum over m of part[n][m] times[m][d]. */
    void (*pull)(int count, const int *node, const double (*part)[6], const double times[6][3],
                 double (*force)[3]);

    /* Six rows of ref_frame_columns(3 nodes), at d nodes + place[node[n]] along axis d; functions
     * of the same node add up. What is in columns beyond is undefined, and so are as many behind
     * the last row. `work`: six rows of ref_frame_columns(nodes). */
    void (*root)(int count, const int *node, const int *place, const double (*part)[6],
                 const RefFrameRoot *root, int nodes, double *work, double *row);

    /* sum[m][l] = sum over the functions of part[n][m] field[node[n]][l], of eight fields. */
    void (*parts)(int count, const int *node, const double (*part)[6],
                  const double (*field)[REF_FRAME_SLOPES], double sum[6][REF_FRAME_SLOPES]);

    /* sum[d][j] = sum over the nodes of slope[n][j] u[node[n]][d]; and what that is the transpose
     * of, of eight fields: to[node[n]][l] += sum over j of slope[n][j] gain[j][l]. */
    void (*slopes)(int count, const int *node, const double (*slope)[REF_FRAME_SLOPES],
                   const double (*u)[3], double sum[3][REF_FRAME_SLOPES]);
    void (*spread)(int count, const int *node, const double (*slope)[REF_FRAME_SLOPES],
                   const double gain[REF_FRAME_SLOPES][REF_FRAME_SLOPES],
                   double (*to)[REF_FRAME_SLOPES]);

    /* sum[i][j] = sum over the rows of row[r][i] row[r][j] for j >= i; others are undefined. A
     * whole number of REF_FRAME_TILE columns. */
    void (*square)(int rows, int columns, const double *row, double *sum);
} RefFrameSums;
extern RefFrameSums ref_frame_sums;

/* Columns of a matrix that is squared and has so many that count. */
static inline int ref_frame_columns(int count)
{
    return (count + REF_FRAME_TILE - 1) / REF_FRAME_TILE * REF_FRAME_TILE;
}

#endif
