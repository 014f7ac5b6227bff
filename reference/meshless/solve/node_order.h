/* node_order.h - matrices of three parameters a node in the order in which their nodes are
 * eliminated: what CHOLMOD factorises as it is, where it would turn others over twice each time. */
#ifndef REF_NODE_ORDER_H
#define REF_NODE_ORDER_H

#include <cholmod.h>

#include "../body/matrices.h"

/* Whether the stiffness has all nine entries of each pair of nodes that the mass has, and no
 * others. */
bool ref_node_order_fits(const RefMatrices *matrices);

/* The places of nodes in an order of little fill, [nodes], of a mass's pattern: a ninth of the
 * entries. The caller frees. NULL where there is no memory, which `common` says. */
int *ref_node_order(const RefSparse *mass, cholmod_common *common);

/* K - shift M, M spread over the three axes, in that order, its lower half. NULL as above. */
cholmod_sparse *ref_node_ordered(const RefMatrices *matrices, double shift, const int *place,
                                 cholmod_common *common);

#endif
