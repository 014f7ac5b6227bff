/* body.h - a meshless elastic body: octants, nodes, covers and matrices of a field (meshless
 * section 4.1). */
#ifndef REF_MESHLESS_BODY_H
#define REF_MESHLESS_BODY_H

#include "../../../lib/pieces.h"
#include "matrices.h"

typedef struct RefBodyCracks RefBodyCracks; /* cracked_body.h */

typedef struct {
    double cell;    /* edge of the finest octants; 0: one that gives about `nodes` nodes */
    long nodes;     /* wanted where cell is 0, */
    double within;  /* by this share; 0: 0.05 */
    int coarser;    /* octants.h */
    RefBasis basis; /* covers are 3 edges of their octants wide, of the quadratic one 6 */
    int split;      /* octants.h; 0: 1 */
    RefMaterial material;
} RefBodyOptions;

typedef struct {
    RefOctants octants;
    RefNodes nodes;
    RefBasis basis;
    RefMatrices matrices;
    RefBodyCracks *cracks; /* NULL: none */
    SmPieces pieces;       /* of the nodes of a cracked body; else none, and it counts as one */
} RefBody;

/* How many pieces a body is in, and which one a node is of. */
static inline int ref_body_pieces(const RefBody *body)
{
    return body->pieces.count ? (int)body->pieces.count : 1;
}

static inline int ref_body_piece(const RefBody *body, long node)
{
    return body->pieces.count ? body->pieces.piece[node] : 0;
}

/* Edge of a cover in edges of its octant. */
double ref_body_covers(RefBasis basis);

enum { REF_LEAST_NODES = 8 };

/* Builds a body. The `count` points `shown` (a surface, handles; may be none) are covered as the
 * integration points are. The number of nodes is met as well as 16 attempts can.
 * The caller frees. Errors: octants.h's, matrices.h's; SM_INPUT, fewer than 8 nodes, or points that
 * stay uncovered: a body of one layer of octants, or `shown` points far outside. */
SmCode ref_body_build(const RefField *field, const RefBodyOptions *options, long count,
                      const double (*shown)[3], RefBody *body, SmError *error);
void ref_body_free(RefBody *body);

#endif
