/* memory.h - whether a body's engine will fit into memory, asked before minutes go into making it.
 * The system would otherwise end the program without a word. */
#ifndef BENCH_MEMORY_H
#define BENCH_MEMORY_H

#include "scene.h"

/* About the bytes that the scene's engine and instances take for a body of so many particles
 * (octree: vertices of the finest lattice): what solid boxes were measured to take. */
double bench_memory_wanted(const BenchScene *scene, double particles);
double bench_memory_lattice(const BenchScene *scene, double particles);
double bench_memory_octree(const BenchScene *scene, double particles);
double bench_memory_brute(const BenchScene *scene, double particles);

/* Bytes that this process may still take: what Linux says is available, or what its control group
 * leaves, its cache of files given back, if that is less. INFINITY where neither is known. */
double bench_memory_available(void);

/* SM_MEMORY, with a line, when the first is more than four fifths of the second. */
SmCode bench_memory_check(const BenchScene *scene, double particles, SmError *error);

/* The same of a cube of side^3 particles that takes so many bytes for `each`. */
SmCode bench_memory_cube(int side, const char *engine, double each, SmError *error);

#endif
