/* scene_check.h - what a scene's settings must say beyond each one's own range. */
#ifndef BENCH_SCENE_CHECK_H
#define BENCH_SCENE_CHECK_H

#include "scene.h"

/* Refuses what is missing, contradicts itself, or would be passed over in silence (SM_INPUT, with
 * the file's name), and completes the rest: axes get unit length, what has a default of its own
 * gets it. */
SmCode bench_scene_check(BenchScene *scene, SmError *error);

#endif
