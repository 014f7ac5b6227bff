/* play.h - a scene played frame by frame: its bodies, what changes them, and their surfaces. */
#ifndef BENCH_PLAY_H
#define BENCH_PLAY_H

#include "changes.h"

typedef struct {
    BenchCast cast;
    BenchChanges *changes; /* [cast.count] */
    double time;           /* s since the start */
} BenchPlay;

/* At rest, with handles and obstacles, then disturbed. The scene and the body are kept. */
SmCode bench_play_create(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                         int threads, unsigned long seed, BenchPlay *play, SmError *error);
void bench_play_free(BenchPlay *play);

/* Does anything change the bodies while they run? */
bool bench_play_changes(const BenchPlay *play);

/* What the scene changes before the steps of the next frame. */
SmCode bench_play_change(BenchPlay *play, SmError *error);

/* One step of all bodies: first what moves handles and pushes, then the engines. */
void bench_play_prepare(BenchPlay *play);
void bench_play_advance(BenchPlay *play, SmLaps *laps);

/* All surfaces as one mesh of rest positions; the caller frees it. And where its vertices are now,
 * [vertices][3]. */
SmMesh bench_play_surface(const BenchPlay *play);
void bench_play_points(BenchPlay *play, double (*point)[3]);

/* Has the last change given a surface new vertices or triangles? */
bool bench_play_split(const BenchPlay *play);

/* The part that is described and recorded: the only one, or the last that is touched. */
BenchRunner *bench_play_runner(BenchPlay *play);

#endif
