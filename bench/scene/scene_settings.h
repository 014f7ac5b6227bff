/* scene_settings.h - every setting of a scene: its key in a scene file, its option, its range and
 * its help, one line each (settings/setting.h). */
#ifndef BENCH_SCENE_SETTINGS_H
#define BENCH_SCENE_SETTINGS_H

#include "scene.h"

/* What a file says, before the four kinds of obstacle become one array. */
typedef struct {
    BenchScene scene; /* first: the settings' members are as far from the record's beginning */
    SmObstacle plane[BENCH_MAX], ball[BENCH_MAX], box[BENCH_MAX], capsule[BENCH_MAX];
    int planes, balls, boxes, capsules;
} BenchSceneFile;

/* Everything that a scene file can say, and the options that replace some of it. Of a
 * BenchSceneFile, and of a scene, which is its first member. */
extern const BenchSetting bench_scene_settings[];

#endif
