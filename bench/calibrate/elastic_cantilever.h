/* elastic_cantilever.h - what an elastic cantilever does, to which calibration.h compares engines:
 * by theory (reference/beam_theory.h) and by the meshless reference (reference/meshless). */
#ifndef BENCH_ELASTIC_CANTILEVER_H
#define BENCH_ELASTIC_CANTILEVER_H

#include <stdbool.h>

#include "../../lib/error.h"
#include "../../reference/beam_theory.h"
#include "../../reference/meshless/body/body.h"

typedef enum { BENCH_EULER, BENCH_TIMOSHENKO, BENCH_MESHLESS, BENCH_MODELS } BenchModel;

/* Of a square cantilever 1 thick, of Young's modulus and density 1. One `t` thick sags t^2 as far,
 * and its squares of frequencies are 1 / t^2 of these. */
typedef struct {
    bool there;
    double sag;                    /* of the tip, under an acceleration of 1 */
    double square[REF_BEAM_MODES]; /* squares of angular frequencies of bending */
} BenchElasticCantilever;

/* `aspect`: length over thickness, 3 or more. The meshless body is six octants thick, its end is
 * held at as many points as octants end there; it is not `there` where the program was built
 * without its libraries. SM_INPUT: the meshless body cannot be had. About 1 s for a meshless one of
 * aspect 5, 2 s of 8, or it is free. */
SmCode bench_elastic_cantilever(BenchModel model, double aspect, double poisson,
                                BenchElasticCantilever *cantilever, SmError *error);

/* The meshless body's sag alone, `across` octants thick, from 1 to BENCH_MOST_OCTANTS, by shape
 * functions of either basis; and how many nodes it has. Errors as above, and SM_INPUT where the
 * program was built without its libraries. With 320 nodes about 0.2 s, of the quadratic basis 2 s.
 */
enum { BENCH_MOST_OCTANTS = 8 };
SmCode bench_elastic_sag(double aspect, double poisson, int across, RefBasis basis, long *nodes,
                         double *sag, SmError *error);

#endif
