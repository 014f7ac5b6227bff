#include "body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "covers.h"
#include "cracked_body.h"

enum { MOST_ATTEMPTS = 16 };

void ref_body_free(RefBody *body)
{
    ref_octants_free(&body->octants);
    ref_nodes_free(&body->nodes);
    ref_matrices_free(&body->matrices);
    ref_body_cracks_free(body->cracks);
    sm_pieces_free(&body->pieces);
    body->cracks = NULL;
}

double ref_body_covers(RefBasis basis)
{
    return basis == REF_MLS_LINEAR ? 3 : 6;
}

/* The nodes that octants of that edge give; 0 where they cannot be built. */
static long nodes_of(const RefField *field, const RefBodyOptions *options, double cell)
{
    RefOctants octants;
    RefNodes nodes;
    RefOctantOptions rough = {
        .cell = cell, .coarser = options->coarser, .gauss = 1, .clip = 1, .rough = true};
    if (ref_octants_build(field, &rough, &octants, NULL) != SM_OK) return 0;
    ref_nodes_place(field, &octants, ref_body_covers(options->basis), &nodes);
    long count = nodes.count;
    ref_nodes_free(&nodes);
    ref_octants_free(&octants);
    return count;
}

/* Nodes go about as 1 / cell^3, but by leaps, of whole layers where a body is flat: the cell is
 * sought between the last that gave too many and the last that gave too few. A body's box is taken
 * for a start. */
static double find_cell(const RefField *field, const RefBodyOptions *options)
{
    double volume = 1, best = INFINITY, found = 0, fine = 0, coarse = INFINITY;
    double within = options->within > 0 ? options->within : 0.05;
    for (int d = 0; d < 3; d++) volume *= field->high[d] - field->low[d];
    double cell = cbrt(volume / (double)options->nodes);
    for (int attempt = 0; attempt < MOST_ATTEMPTS; attempt++) {
        long count = nodes_of(field, options, cell);
        double off = log((double)(count > 0 ? count : 1) / (double)options->nodes);
        if (fabs(off) < best) {
            best = fabs(off);
            found = cell;
        }
        if (best < within) break;
        if (off > 0)
            fine = fmax(fine, cell);
        else
            coarse = fmin(coarse, cell);
        cell *= exp(off / 3);
        if (!(cell > fine && cell < coarse))
            cell = isfinite(coarse) ? sqrt(fine * coarse) : 2 * fine;
    }
    return found;
}

static SmCode cover(long count, const double (*shown)[3], RefBody *body, SmError *error)
{
    size_t points = (size_t)body->octants.points, all = points + (size_t)count;
    double(*x)[3] = sm_alloc(all, sizeof *x);
    for (size_t p = 0; p < points; p++) memcpy(x[p], body->octants.point[p].x, sizeof x[p]);
    if (count) memcpy(x + points, shown, (size_t)count * sizeof *x);
    long bad = ref_mls_cover(&body->nodes, body->basis, (long)all, (const double(*)[3])x);
    free(x);
    if (bad == 0) return SM_OK;
    return sm_fail(
        error, SM_INPUT,
        "%ld of the body's %zu points are covered by too few of its %ld nodes, or by nodes "
        "in a plane: take more (run --nodes, or nodes in a scene's group meshless)",
        bad, all, body->nodes.count);
}

SmCode ref_body_build(const RefField *field, const RefBodyOptions *options, long count,
                      const double (*shown)[3], RefBody *body, SmError *error)
{
    *body = (RefBody){.basis = options->basis};
    RefOctantOptions fine = {.cell = options->cell > 0 ? options->cell : find_cell(field, options),
                             .coarser = options->coarser,
                             .split = options->split > 0 ? options->split : 1,
                             .gauss = options->basis == REF_MLS_LINEAR ? 1 : 3,
                             .clip = 2};
    SmCode code = ref_octants_build(field, &fine, &body->octants, error);
    if (code != SM_OK) return code;
    ref_nodes_place(field, &body->octants, ref_body_covers(options->basis), &body->nodes);
    if (body->nodes.count < REF_LEAST_NODES)
        code = sm_fail(error, SM_INPUT, "the body has only %ld nodes; give it %d or more",
                       body->nodes.count, REF_LEAST_NODES);
    if (code == SM_OK) code = cover(count, shown, body, error);
    if (code == SM_OK)
        code = ref_matrices_build(&body->octants, &body->nodes, body->basis, &options->material,
                                  &body->matrices, error);
    if (code != SM_OK) ref_body_free(body);
    return code;
}
