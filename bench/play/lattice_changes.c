/* What changes a lattice's body: blades; by particle number. */
#include <stdlib.h>
#include <string.h>

#include "../../lib/cut/embed_cut.h"
#include "../../lib/cut/sever.h"
#include "../../octree/region/fit.h"
#include "../scene/blades.h"
#include "changes.h"

static void tie(BenchChanges *changes)
{
    BenchPart *part = changes->part;
    sm_embed_create(&changes->surface, &part->body.voxels, &changes->embedding);
    if (part->runner.scene->cut_count == 0) return;
    sm_sites_init(&part->body.voxels, &changes->sites);
    part->body.cut = &changes->cut;
}

/* F about a particle from itself and its neighbours: the node's place is the origin. */
static void find_gradient(const BenchChanges *changes, long p, double F[9])
{
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, still[3] = {0};
    const double(*rest)[3] = (const double(*)[3])changes->rest;
    const double(*x)[3] = (const double(*)[3])changes->x;
    int neighbour[SM_RING], count = sm_sites_ring(&changes->sites, p, neighbour);
    double least = 0.25 * changes->part->body.voxels.cell, L[9];
    OctFit fit = {0};
    oct_fit_add(&fit, 1, still, still, still);
    for (int n = 0; n < count; n++) {
        int q = neighbour[n];
        if (sm_cut_crosses(&changes->cut, 0, rest[p], rest[q])) continue;
        double X[3], at[3];
        for (int d = 0; d < 3; d++) {
            X[d] = rest[q][d] - rest[p][d];
            at[d] = x[q][d] - x[p][d];
        }
        oct_fit_add(&fit, 1, X, at, still);
    }
    oct_fit_solve(&fit, least, identity, F, L);
}

/* The particles near a blade, which is between two places in this frame (blades.h). Their gradients
 * are the least-squares fit to the neighbours that no cut parts them from. Valid until the next
 * call. O(particles) for a look at each. */
static SmCarriers carriers_near(BenchChanges *changes, const double blade[4][3])
{
    BenchRunner *runner = &changes->part->runner;
    double cell = changes->part->body.voxels.cell, reach = 3 * cell; /* a cell's middle is 0.87 */
    double far = bench_blade_stroke(blade) + 2 * reach;
    bench_changes_room(changes, runner->count);
    memcpy(changes->rest, runner->x0, (size_t)runner->count * sizeof *changes->rest);
    runner->type->get(runner->engine, SM_POSITION, changes->x);
    for (long p = 0; p < runner->count; p++) {
        double square = bench_blade_square(changes->x[p], blade[2], blade[3]);
        changes->absent[p] = !(square < far * far);
        if (!changes->absent[p]) find_gradient(changes, p, changes->F[p]);
    }
    return (SmCarriers){.nodes = runner->count,
                        .rest = (const double(*)[3])changes->rest,
                        .position = (const double(*)[3])changes->x,
                        .F = (const double(*)[9])changes->F,
                        .absent = changes->absent,
                        .cell = cell,
                        .reach = reach};
}

/* Where material has come apart the surface does too. */
static bool sever(BenchChanges *changes, const SmPieces *pieces)
{
    const SmEmbedding *e = &changes->embedding;
    if (pieces->count < 2) return false;
    int *piece = sm_alloc((size_t)e->vertex_count, sizeof *piece);
    for (long v = 0; v < e->vertex_count; v++) piece[v] = pieces->piece[e->corner[v][0]];
    long gone = sm_sever(&changes->surface, piece);
    free(piece);
    return gone > 0;
}

/* Splits the surface by the cut's triangles from `first` on; it follows the engine's pieces. */
static void split_surface(BenchChanges *changes, long first)
{
    const BenchPart *part = changes->part;
    const SmCut *cut = &changes->cut;
    SmMesh *surface = &changes->surface;
    SmPieces pieces;
    part->runner.type->pieces(part->runner.engine, &pieces);
    SmSlitResult result = sm_slit(surface, cut, first, part->body.voxels.cell);
    sm_embed_cut(&changes->embedding, surface, &changes->sites, cut, first, pieces.piece);
    if (sever(changes, &pieces))
        sm_embed_cut(&changes->embedding, surface, &changes->sites, cut, cut->triangles,
                     pieces.piece);
    sm_pieces_free(&pieces);
    changes->left |= result == SM_SLIT_LEFT;
}

/* Cuts the engine's body and the surface by the triangles of changes->cut from number `first` on,
 * of which there are some; fills changes->last. `start` is when the frame's change began. */
static SmCode cut_body(BenchChanges *changes, long first, double start, SmError *error)
{
    const BenchRunner *runner = &changes->part->runner;
    SmCode code = runner->type->cut(runner->engine, &changes->cut, first, error);
    if (code) return code;
    double cut = sm_now();
    split_surface(changes, first);
    changes->last = (BenchChanged){
        .resampled = true, .resample_seconds = cut - start, .follow_seconds = sm_now() - cut};
    return SM_OK;
}

static SmCode change_frame(BenchChanges *changes, double from, double to, SmError *error)
{
    double start = sm_now();
    long first = changes->cut.triangles;
    if (!bench_blades_move(changes->part->runner.scene, from, to)) return SM_OK;
    bench_changes_sweep(changes, from, to, &changes->cut);
    if (changes->cut.triangles == first) return SM_OK;
    return cut_body(changes, first, start, error);
}

static void move(BenchChanges *changes, long instance, double (*point)[3])
{
    const double(*node)[3] = (const double(*)[3])changes->node;
    sm_embed_apply(&changes->embedding, node + instance * changes->part->runner.count, point, NULL);
}

/* The corner of the vertex's cell that counts most. */
static int particle_at(const BenchChanges *changes, long vertex)
{
    const float *weight = changes->embedding.weight[vertex];
    int most = 0;
    for (int i = 1; i < 8; i++)
        if (weight[i] > weight[most]) most = i;
    return changes->embedding.corner[vertex][most];
}

static void find_pieces(const BenchRunner *runner, SmPieces *pieces)
{
    if (runner->type->pieces) runner->type->pieces(runner->engine, pieces);
}

const BenchCarrier bench_lattice_carrier = {
    tie, carriers_near, change_frame, move, particle_at, find_pieces, NULL, NULL,
};
