/* playback.h - a scene played frame by frame: all its bodies, what changes them, and their
 * surfaces. */
#ifndef BENCH_PLAYBACK_H
#define BENCH_PLAYBACK_H

#include "body_group.h"

typedef struct {
    const BenchScene *scene; /* the caller's, kept, as is the body */
    const BenchBody *body;
    int count;
    BenchGroup *group; /* [count] */
    double time;       /* s since the start */
} BenchPlayback;

/* At rest, with handles and obstacles, then disturbed. The scene and the body are kept. Errors:
 * those of bench_group_create(). */
SmCode bench_playback_create(const BenchScene *scene, const BenchBody *body,
                             const SmEngineType *type, int threads, unsigned long seed,
                             BenchPlayback *play, SmError *error);
void bench_playback_free(BenchPlayback *play);

/* Particles of all groups. */
long bench_playback_particles(const BenchPlayback *play);

/* Does anything change the bodies while they run? */
bool bench_playback_changes(const BenchPlayback *play);

/* What the scene changes before the steps of the next frame. */
SmCode bench_playback_change(BenchPlayback *play, SmError *error);

/* The same of what is due at this moment alone, between two frames. */
SmCode bench_playback_change_now(BenchPlayback *play, SmError *error);

/* After the steps of a frame: surfaces come apart where engines have broken bodies in it, which
 * change() does else before the next. Whether any has. */
bool bench_playback_follow(BenchPlayback *play);

/* One step of all bodies: first what moves handles and pushes, then the engines. */
void bench_playback_prepare(BenchPlayback *play);
void bench_playback_advance(BenchPlayback *play, SmLaps *laps);

/* Vertices and triangles of all surfaces. */
void bench_playback_size(const BenchPlayback *play, long *vertices, long *triangles);

/* All surfaces as one mesh of rest positions; the caller frees it. And where its vertices are now,
 * [vertices][3]. */
SmMesh bench_playback_surface(const BenchPlayback *play);
void bench_playback_points(BenchPlayback *play, double (*point)[3]);

/* FNV-1a of all bodies' positions and velocities, as sixteen hexadecimal digits: in the order of
 * groups and particles, as doubles, which hold every engine's numbers whole. The same for any
 * number of threads; another instruction set (lib/isa.h) or precision rounds otherwise. */
enum { BENCH_HASH_TEXT = 17 };
void bench_playback_hash(const BenchPlayback *play, char text[BENCH_HASH_TEXT]);

/* Has a surface got new vertices or triangles since the last change began? */
bool bench_playback_split(const BenchPlayback *play);

/* The group that is described and recorded: the only one, or the last that is touched. */
BenchRunner *bench_playback_runner(BenchPlayback *play);

#endif
