/* mls.h - moving least squares shape functions and their derivatives (meshless section 3), in space
 * and in the plane of a shell's parameters. */
#ifndef REF_MLS_H
#define REF_MLS_H

#include "nodes.h"

typedef enum { /* the number of its terms */
               REF_MLS_LINEAR = 4,
               REF_MLS_QUADRATIC = 10,
               REF_MLS_PLANE_CONSTANT = 1, /* for nodes in a plane */
               REF_MLS_PLANE_LINEAR = 3,
               REF_MLS_PLANE_QUADRATIC = 6
} RefBasis;

/* The shape functions that are not zero at one point. */
typedef struct {
    int count;
    int *node;             /* [count] rising, but for those of images, which come last */
    double *value;         /* [count] phi */
    double (*gradient)[3]; /* [count] */
    double (*second)[3];   /* [count] in a plane: phi,11, phi,22, phi,12 */
    double *scratch;
} RefShape;

/* For up to nodes->most functions. The caller frees. */
RefShape ref_shape_create(const RefNodes *nodes);
void ref_shape_free(RefShape *shape);

/* phi_I = p^T A^-1 w_I p_I and its derivatives (meshless eqs. 1-13) at x, the basis p taken about x
 * and scaled by the covers' size. False, and count 0, where too few nodes cover x or they are close
 * to a plane (a conic, for the quadratic basis): where a pivot of the moment matrix, scaled to ones
 * on its diagonal, is below REF_LEAST_PIVOT: from there on
 * reproduction is good to 1e-10. Second derivatives jump where the weights' do, at a half and the
 * whole of a reach. A node whose image covers x, too, is there twice. O(nodes covering x). */
bool ref_mls_at(const RefNodes *nodes, RefBasis basis, const double x[3], RefShape *shape);

#define REF_LEAST_PIVOT 1e-3

/* With cracks: at x as `eye` sees the nodes, which is a place beside x, maybe on the
 * other side of a crack. What cracks let through is a constant then, unless `eye` is x itself, the
 * same array: that is ref_mls_at(). */
bool ref_mls_seen_from(const RefNodes *nodes, RefBasis basis, const double x[3],
                       const double eye[3], RefShape *shape);

/* Whether no crack takes most of what node n's weight is at x. */
bool ref_mls_sees(const RefNodes *nodes, long n, const double x[3]);

/* The node nearest to x, of those that it sees if there are such. O(nodes). */
long ref_mls_nearest(const RefNodes *nodes, const double x[3]);

/* Second derivatives of weights jump at the ends of covers and half-way to them, and covers of
 * whole numbers of edges have both on integration points of larger cells. A weight's outer parts
 * begin this little farther in, so that such points are always in those, however they are rounded.
 */
#define REF_MLS_INSIDE (1 - 1e-9)

/* meshless eq. 13, the spline of the weights, by the signed s; the slopes are its first and second
 * derivative, which jumps at a half, less a billionth: that is its outer part's. */
double ref_mls_spline(double s, double slope[2]);

/* part *= f, each a value, two slopes and the second derivatives 11, 22, 12 in a plane. */
void ref_mls_multiply(const double f[6], double part[6]);

/* Linear functions of the nodal parameters: what constraints bind (meshless section 5.3.3). MLS
 * shape functions are no Kronecker delta, so a displacement at a point is a sum over the nodes that
 * cover it. Parameter 3 I + d is node I's along axis d. */
typedef struct {
    long count;    /* rows */
    long *start;   /* [count + 1] */
    int *column;   /* [start[count]] parameter */
    double *value; /* [start[count]] */
} RefRows;

/* Appends a row of so many entries to `rows` (zeroed: empty); returns where they begin, for the
 * caller to fill in. */
long ref_rows_begin(RefRows *rows, int entries);

/* Appends a row: the displacement along an axis where the shape functions
 * were taken. */
void ref_rows_displacement(RefRows *rows, const RefShape *shape, int axis);

/* The caller frees. */
RefRows ref_rows_copy(const RefRows *rows);
void ref_rows_free(RefRows *rows);

/* Row `row` applied to u. */
static inline double ref_rows_apply(const RefRows *rows, long row, const double *u)
{
    double sum = 0;
    for (long e = rows->start[row]; e < rows->start[row + 1]; e++)
        sum += rows->value[e] * u[rows->column[e]];
    return sum;
}

#endif
