/* scene_field.h - the experiment "scene": one field of a measured row (row.h) as a curve.
 *
 * Fields: particles, regions, triangles, bases, parts, splits, unasked_splits, summation_nodes,
 * bytes; total_ms, fps (steps a second), frame_rate (frames a second, the scene's steps_per_frame
 * steps each), ns_per_particle_step; stage_percent (a point for every stage), thirds_percent
 * (summation with matching, polar, damping); of scenes that change last_particles, added,
 * growth_percent (of particles), pieces, first_ms, last_ms, cost_growth (last_ms / first_ms),
 * least_ms, most_ms (resampling), surface_ms. */
#ifndef BENCH_SCENE_FIELD_H
#define BENCH_SCENE_FIELD_H

#include "experiment.h"

bool bench_scene_field_known(const char *name);

/* All names, separated by |. */
void bench_scene_field_names(size_t size, char *names);

/* "hand octree without nodes": the scene, and its engine and what it is without, where said. */
void bench_scene_field_row(const BenchMeasure *measure, size_t size, char *name);

/* Measures the scene, unless the lab has its row. */
void bench_scene_field_measure(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);

#endif
