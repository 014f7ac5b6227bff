/* runner.h - a scene in motion: an engine, and what holds, pushes and disturbs its body. */
#ifndef BENCH_RUNNER_H
#define BENCH_RUNNER_H

#include "../scene/body.h"

typedef struct BenchRunner {
    const SmEngineType *type;
    SmEngine *engine;
    const BenchScene *scene; /* the caller's, kept */
    const BenchBody *body;   /* the caller's, kept */
    long particles;          /* of all instances */
    long count;              /* of one */
    double (*x0)[3];         /* [count] rest positions, instance pose not applied */
    double time;             /* s since the start */
    int held; /* handles bound: one for every scene handle and instance, no empty ones */
    SmHandle *handle;
    int *handle_source;    /* [held] the scene's handle */
    long *handle_instance; /* [held] */
    long bytes;            /* that the engine took when it was made; 0: not known (heap.h) */
    int grips;             /* handles beside the scene's (bench_runner_grip()), */
    const SmHandle *grip;  /* the caller's, kept */
    SmHandle *bound;       /* [bound_count] those that still hold, as handed to the engine */
    int bound_count;
    long *push_count; /* [scene->force_count] particles pushed, of all instances */
    long **push_particle;
    double (**push_impulse)[3];
    long *push_first; /* [scene->force_count] particles of one body pushed at first */
} BenchRunner;

/* Is x, of the rest state, selected? */
bool bench_select_has(const BenchSelect *select, const BenchBody *body, const double x[3]);

/* Where the handle is at time t; `offset` is its instance's place. */
void bench_handle_pose(const BenchHandle *handle, double t, const double offset[3],
                       double pose[3][4]);

/* Engine parameters of the scene and body, which they point into. */
SmEngineParams bench_engine_params(const BenchScene *scene, const BenchBody *body, int threads);

/* The scene's meshless body: its mesh, and its material in mesh units. */
RefMeshlessOptions bench_meshless_options(const BenchScene *scene, const BenchBody *body);

/* Builds the engine at rest, with handles and obstacles. A selection without particles is an
 * error (SM_INPUT). */
SmCode bench_runner_create(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                           int threads, BenchRunner *runner, SmError *error);
void bench_runner_free(BenchRunner *runner);

/* The same with the engine that the scene names, in double precision and on one thread. */
SmCode bench_runner_exact(const BenchScene *scene, const BenchBody *body, BenchRunner *runner,
                          SmError *error);

/* Sets the scene's initial deformation and velocities (bend, twist, squash, kick). */
void bench_runner_disturb(BenchRunner *runner, unsigned long seed);

/* Handles beside the scene's, which a user holds; kept. They are at their poses from the next step
 * on, however the caller moves these. They must hold what no other does. */
void bench_runner_grip(BenchRunner *runner, int count, const SmHandle *grip);

/* After a change of the engine's particles (octree/engine.h): counts, rest positions, handles and
 * forces anew, and no grips. A force keeps what it was in all, shared out by mass. After an error,
 * that nothing is left to hold or push, it can go on without. O(particles). */
SmCode bench_runner_refresh(BenchRunner *runner, SmError *error);

/* What is bound to the engine now: handles that still hold, at their poses, and obstacles. Valid
 * until the next step. */
SmBoundary bench_runner_boundary(const BenchRunner *runner);

/* Moves the handles to where they are at the step's end and applies the forces: what comes before
 * engine->step(). */
void bench_runner_prepare(BenchRunner *runner);

/* The step itself, after bench_runner_prepare(). */
void bench_runner_advance(BenchRunner *runner, SmLaps *laps);

/* Both, without laps. */
void bench_runner_step(BenchRunner *runner);

#endif
