/* scene_field.h - the experiment "scene": one field of a measured row (row.h) as a curve.
 *
 * A field is any number of a row: by the name that a results file has for it (of a scene that
 * changes without "change."), that of its CSV column, or that of papers.cfg ("added", "most_ms").
 * Further ones: total_ms, fps (steps a second), frame_rate (frames a second, the scene's
 * steps_per_frame steps each), ns_per_particle_step, body_ms (a step by the number of bodies) and
 * fast_sum_ms, polar_ms and so on (a stage), with confidence intervals; stage_percent (a point for
 * every stage), thirds_percent (summation with matching, polar, damping), damping_by_matching
 * (damping by sums and matching); growth_percent (of the nodes of scenes that change and of shells
 * that break); of scenes that change cost_growth (last_ms / first_ms). */
#ifndef BENCH_SCENE_FIELD_H
#define BENCH_SCENE_FIELD_H

#include "experiment.h"

bool bench_scene_field_known(const char *name);

/* What fields there are, for people: the further ones, and where the others are listed. */
void bench_scene_field_names(size_t size, char *names);

/* "hand octree without nodes": the scene, and its engine and what it is without, where said. */
void bench_scene_field_row(const BenchMeasure *measure, size_t size, char *name);

/* The setting has its default, and the scene says so in its name. */
void bench_take_away(BenchScene *scene, BenchWithout without);

/* Measures the scene, unless the lab has its row. */
void bench_scene_field_measure(BenchLab *lab, const BenchMeasure *measure, BenchCurve *curve);

#endif
