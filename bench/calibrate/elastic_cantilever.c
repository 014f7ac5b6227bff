#include "elastic_cantilever.h"

#include <math.h>
#include <stdlib.h>

#include "../../reference/meshless/solve/modes.h"

enum { ACROSS = 6, MODES = 18 };

/* Points of the clamped end, in the middle of every octant's face, and the middle of the tip. */
typedef struct {
    int held;
    double x[BENCH_MOST_OCTANTS * BENCH_MOST_OCTANTS + 1][3];
} Ends;

static Ends find_ends(double aspect, int across)
{
    Ends ends = {.held = across * across};
    for (int n = 0; n < ends.held; n++) {
        ends.x[n][0] = 0;
        ends.x[n][1] = (n % across + 0.5) / across;
        ends.x[n][2] = ((double)(n / across) + 0.5) / across;
    }
    ends.x[ends.held][0] = aspect;
    ends.x[ends.held][1] = ends.x[ends.held][2] = 0.5;
    return ends;
}

/* A beam, what holds its end, and where its tip's middle goes. */
typedef struct {
    RefBody body;
    RefRows rows, tip;
} Beam;

static void clamp(Beam *beam, const Ends *ends)
{
    const RefBody *body = &beam->body;
    RefShape shape = ref_shape_create(&body->nodes);
    for (int n = 0; n < ends->held; n++) {
        ref_mls_at(&body->nodes, body->basis, ends->x[n], &shape);
        for (int d = 0; d < 3; d++) ref_rows_displacement(&beam->rows, &shape, d);
    }
    ref_mls_at(&body->nodes, body->basis, ends->x[ends->held], &shape);
    for (int d = 0; d < 3; d++) ref_rows_displacement(&beam->tip, &shape, d);
    ref_shape_free(&shape);
}

/* After an error nothing is to be freed. */
static SmCode make_beam(double aspect, double poisson, int across, RefBasis basis, Beam *beam,
                        SmError *error)
{
    Ends ends = find_ends(aspect, across);
    RefBrick brick = {{0, 0, 0}, {aspect, 1, 1}};
    RefField field = ref_field_brick(&brick);
    RefBodyOptions options = {.cell = 1.0 / across, .basis = basis, .material = {1, poisson, 1}};
    *beam = (Beam){0};
    SmCode code = ref_body_build(&field, &options, ends.held + 1, ends.x, &beam->body, error);
    if (!code) clamp(beam, &ends);
    return code;
}

static void free_beam(Beam *beam)
{
    ref_rows_free(&beam->rows);
    ref_rows_free(&beam->tip);
    ref_body_free(&beam->body);
}

/* Under an acceleration along y: the mass matrix times 1, since shape functions add up to 1. */
static SmCode find_sag(const Beam *beam, double *sag, SmError *error)
{
    RefSolver *solver;
    const RefBody *body = &beam->body;
    SmCode code = ref_solver_create(&body->matrices, 0, &beam->rows, &solver, error);
    if (code) return code;
    size_t nodes = (size_t)body->nodes.count;
    double *one = sm_alloc(nodes, sizeof *one), *weight = sm_alloc(nodes, sizeof *weight);
    double *load = sm_alloc(3 * nodes, sizeof *load), *u = sm_alloc(3 * nodes, sizeof *u);
    for (size_t n = 0; n < nodes; n++) one[n] = 1;
    ref_sparse_apply(&body->matrices.mass, 1, one, weight);
    for (size_t n = 0; n < nodes; n++) load[3 * n + 1] = weight[n];
    ref_solver_solve(solver, load, NULL, u);
    *sag = ref_rows_apply(&beam->tip, 1, u);
    ref_solver_destroy(solver);
    free(one);
    free(weight);
    free(load);
    free(u);
    return SM_OK;
}

/* Bending modes come in pairs, along y and z; those that leave the tip's middle where it is twist
 * or stretch the beam. */
static SmCode find_frequencies(const Beam *beam, double mass, double square[REF_BEAM_MODES],
                               SmError *error)
{
    RefModes modes;
    SmCode code = ref_modes_find(&beam->body.matrices, &beam->rows, MODES, &modes, error);
    if (code) return code;
    size_t size = 3 * (size_t)modes.nodes;
    double *u = sm_alloc(size, sizeof *u);
    int bending = 0;
    for (int k = 0; k < modes.count; k++) {
        for (size_t i = 0; i < size; i++) u[i] = modes.shape[i * (size_t)modes.count + (size_t)k];
        double side = hypot(ref_rows_apply(&beam->tip, 1, u), ref_rows_apply(&beam->tip, 2, u));
        if (side * sqrt(mass) < 1) continue; /* 2 of a mode that bends */
        if (bending % 2 == 0 && bending / 2 < REF_BEAM_MODES) square[bending / 2] = modes.lambda[k];
        bending++;
    }
    free(u);
    ref_modes_free(&modes);
    if (bending >= 2 * REF_BEAM_MODES) return SM_OK;
    return sm_fail(error, SM_INPUT, "the meshless beam has only %d modes of bending among its %d",
                   bending, MODES);
}

static SmCode find_meshless(double aspect, double poisson, BenchElasticCantilever *cantilever,
                            SmError *error)
{
    Beam beam;
    SmCode code = make_beam(aspect, poisson, ACROSS, REF_MLS_LINEAR, &beam, error);
    if (code) return code;
    code = find_sag(&beam, &cantilever->sag, error);
    if (!code) code = find_frequencies(&beam, aspect, cantilever->square, error);
    cantilever->there = !code;
    free_beam(&beam);
    return code;
}

SmCode bench_elastic_sag(double aspect, double poisson, int across, RefBasis basis, long *nodes,
                         double *sag, SmError *error)
{
    Beam beam;
    SmCode code = make_beam(aspect, poisson, across, basis, &beam, error);
    if (code) return code;
    *nodes = beam.body.nodes.count;
    code = find_sag(&beam, sag, error);
    free_beam(&beam);
    return code;
}

SmCode bench_elastic_cantilever(BenchModel model, double aspect, double poisson,
                                BenchElasticCantilever *cantilever, SmError *error)
{
    *cantilever = (BenchElasticCantilever){0};
    if (model == BENCH_MESHLESS)
        return ref_solver_built ? find_meshless(aspect, poisson, cantilever, error) : SM_OK;
    RefBeam beam = {aspect, 1, poisson};
    RefBeamTheory theory = model == BENCH_EULER ? REF_EULER : REF_TIMOSHENKO;
    cantilever->there = true;
    cantilever->sag = ref_beam_sag(&beam, theory);
    ref_beam_frequencies(&beam, theory, cantilever->square);
    return SM_OK;
}
