/* elastic_check.h - is the meshless body right that is timed? In double precision, on its very
 * matrices, modes and state, by what must hold whichever way they were computed; what was found,
 * and what of it is allowed. */
#ifndef BENCH_ELASTIC_CHECK_H
#define BENCH_ELASTIC_CHECK_H

#include <stdbool.h>
#include <stddef.h>

typedef struct RefElastic RefElastic;   /* reference/meshless/engine.h */
typedef struct BenchRunner BenchRunner; /* play/runner.h */

/* What can be wrong, in the order in which it is looked at. */
typedef enum {
    BENCH_ELASTIC_UNITY,  /* sum phi - 1, and sum phi x_I - x in cells, at points spread over the
                           * surface and the inside */
    BENCH_ELASTIC_SLOPE,  /* sum grad phi x_I - 1 there */
    BENCH_ELASTIC_MASS,   /* M's mass and second moments from those of the volume, relative */
    BENCH_ELASTIC_RIGID,  /* K's forces in rigid motions, by the entries that make them */
    BENCH_ELASTIC_STRAIN, /* K's energies of the six constant strains, with each other, from
                           * volume eps D eps, by the largest */
    BENCH_ELASTIC_ORTHOGONAL, /* Psi^T M Psi - 1 */
    BENCH_ELASTIC_RESIDUAL,   /* K x - lambda M x, by the highest lambda M x */
    BENCH_ELASTIC_ZERO,       /* the six rigid modes' lambda, by the seventh */
    BENCH_ELASTIC_MISSED,     /* how far below the highest lambda a mode lies that is not there */
    BENCH_ELASTIC_POSE,       /* displacement in the limit of small ones from Psi z, relative */
    BENCH_ELASTIC_STEP,       /* a step's modal velocities from a dense solution of eq. 33 whose
                               * constraints are differentiated numerically, by the largest
                               * of them or of what the forces alone would add */
    BENCH_ELASTIC_HELD,       /* constraints after the step, by the body's size */
    BENCH_ELASTIC_SKIN,       /* points from their shape functions, by the body's size */
    BENCH_ELASTIC_GROWTH,     /* of the energy in 64 steps without forces and constraints */
    BENCH_ELASTIC_CHECKS
} BenchElasticCheck;

typedef struct {
    double found[BENCH_ELASTIC_CHECKS]; /* NaN: not finite */
    unsigned looked;                    /* bits: at which of them was looked */
} BenchElasticFound;

/* Notes a finding if it is larger than the one there; what is not finite is NaN, and stays. */
void bench_elastic_note(BenchElasticFound *found, BenchElasticCheck check, double value);

/* Whether all is within the tolerances; if not `reason` says what is not. */
bool bench_elastic_verdict(const BenchElasticFound *found, size_t size, char *reason);

/* All that was found, for people: "shape functions 2e-14, their gradients 3e-12, ..." */
void bench_elastic_text(const BenchElasticFound *found, size_t size, char *text);

/* What stays while it moves: the first nine findings. O(modes^2 nodes), and one factorisation. */
void bench_elastic_check_body(const RefElastic *elastic, BenchElasticFound *found);

/* The others, of the present state of a runner of ref_meshless_frames; it is as it was afterwards.
 */
void bench_elastic_check_state(BenchRunner *runner, BenchElasticFound *found);

#endif
