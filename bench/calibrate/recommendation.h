/* recommendation.h - what a calibration says in words, and which w and epsilon have a given
 * modulus in a scene. */
#ifndef BENCH_RECOMMENDATION_H
#define BENCH_RECOMMENDATION_H

#include "stiffness_fit.h"

enum { BENCH_FOUND = 3, BENCH_WORDS = 768, BENCH_MOST_ACROSS = 64 };

/* What the specimens and laws say, in BENCH_FOUND sentences: how far an elastic body is like them;
 * what its modulus follows from; how far it is no material's. Empty where nothing is known. */
void bench_recommendation_found(const BenchSpecimen *specimen, long count,
                                const BenchStiffnessFit *law, int laws,
                                char found[BENCH_FOUND][BENCH_WORDS]);

/* What is wished, for what cells, and what the specimens are of. */
typedef struct {
    double young, density; /* Pa, kg a cubic unit */
    double measured;       /* the specimens' density */
    double cell;           /* of the scene that is to have it */
} BenchYoung;

/* The specimen of the grid that comes nearest to the wished modulus, and a sentence about it: what
 * it has, and which time step hits the wish in the scene's cells (a body as many of them thick as
 * the specimen is as stiff at the same cell / h). Of those within 10% the one with the least spread
 * is taken. -1, and a sentence why, where no specimen is valid. */
long bench_recommendation_young(const BenchSpecimen *specimen, long count, const BenchYoung *wish,
                                char sentence[BENCH_WORDS]);

/* The scene's settings, each on a line of its own, that make its material the specimen's at the
 * time step that hits the wish, with the specimens' damping; its cells stay as they are. The
 * density is a part of it: where none is given particles of a lattice weigh 1 each, those at its
 * surface more than their share of the material, and bodies are up to a quarter stiffer. */
void bench_recommendation_settings(const BenchSpecimen *specimen, const BenchYoung *wish,
                                   double damping, char settings[BENCH_WORDS]);

#endif
