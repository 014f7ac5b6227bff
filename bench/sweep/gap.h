/* gap.h - how far one way to simulate a scene is from another: in goal positions, and in motion.
 * All in double precision and on one thread, and so deterministic. Engines are held to brute force
 * in the states that are compared, paths at their last frame (bench_check_runner()): a wrong one
 * gives no figure but `invalid`. Types are those of the scene's engine in double precision. */
#ifndef BENCH_GAP_H
#define BENCH_GAP_H

#include "../scene/body.h"
#include "point.h"

typedef struct {
    double rms, most;    /* NaN: `why` */
    bool invalid;        /* a check failed */
    char why[BENCH_WHY]; /* empty where they could be had */
} BenchGap;

/* An octree's goal positions with the scene's epsilon from those with epsilon 0, whose regions have
 * exactly the width asked for, on one state: the body, held nowhere, in the scene's deformation at
 * the start (bend, twist, squash) or, where it has none, bent by 0.7 rad. In finest cells; the mean
 * is by mass. */
void bench_gap_goals(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                     BenchGap *gap);

/* Acceleration that each force of a scene gives to what it pushes: what the force of all particles
 * is on the scene's own engine, divided by their mass. Other engines and samplings have other
 * particles and are pushed to the same acceleration. */
typedef struct {
    int count;
    double acceleration[BENCH_MAX][3]; /* mesh units / s^2 */
} BenchPush;

SmCode bench_push_find(const BenchScene *scene, const BenchBody *body, BenchPush *push,
                       SmError *error);

/* Where the scene's surface goes: at most BENCH_PATH_POINTS of its vertices, evenly by number, at
 * the end of every frame. */
enum { BENCH_PATH_POINTS = 4096 };
typedef struct {
    int frames;
    long points;
    double (*point)[3]; /* [frames * points] */
    bool invalid;       /* a check failed */
    char why[BENCH_WHY];
} BenchPath;

/* Plays the scene; a path without points where it could not be. The caller frees it. */
void bench_path_record(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                       const BenchPush *push, int frames, unsigned long seed, BenchPath *path);
void bench_path_free(BenchPath *path);

/* Root mean square and largest distance of the points over all frames, of `size`. */
void bench_gap_path(const BenchPath *path, const BenchPath *full, double size, BenchGap *gap);

/* The half-width with which a lattice's regions hold as much of the body as the octree's: mean over
 * the body by mass, in finest cells. A node whose cell has the edge e is held with floor(w / e)
 * rings of such cells, which reach (floor(w / e) + 1/2) e to each side, and a lattice of half-width
 * w' reaches w' + 1/2. Of a regular sampling in finest cells it is w. */
SmCode bench_width_mean(const BenchScene *scene, const BenchBody *body, double *cells,
                        SmError *error);

#endif
