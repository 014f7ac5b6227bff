/* engines.h - the engines that there are, and what each says of itself to commands, checks and
 * tables: nothing else asks for an engine's name.
 *
 * A new engine is its folder and a line of bench/registry.inc. What a program that links the
 * library needs to know of an engine stands in its SmEngineType (lib/engine/engine.h), the rest
 * here, in terms of the subjects that use it: each gives its own record, and this header needs
 * none. */
#ifndef BENCH_ENGINES_H
#define BENCH_ENGINES_H

#include <stdio.h>

#include "../lib/engine/engine.h"
#include "../lib/mesh/mesh.h"

typedef struct OctStructure OctStructure; /* octree/change/structure.h */
typedef struct BenchScene BenchScene;     /* scene/scene.h */
typedef struct BenchBody BenchBody;       /* scene/body.h */
typedef struct BenchRunner BenchRunner;   /* play/runner.h */
typedef struct BenchCarrier BenchCarrier; /* play/body_group.h */
typedef struct BenchTwin BenchTwin;       /* check/check.h */
typedef struct BenchChecker BenchChecker; /* measure/checker.h */
typedef struct BenchRow BenchRow;         /* measure/row.h */
typedef struct BenchModes BenchModes;     /* play/mode.h */

enum { BENCH_MOST_ENGINES = 16, BENCH_MOST_PLANNED = 4, BENCH_ENGINES_TEXT = 128 };

/* carrier, checker and memory must be there; and set, goals, push, bound, masses and region of the
 * types of an engine that has a twin or is planned, which is moved, held and weighed by it. */
typedef struct {
    const SmEngineType *type[2]; /* one a precision, the default first; NULL: there is no other */

    /* Its regions are as wide as w edges of each node's own cell, or w finest cells, and may be
     * wider by the share epsilon (octree section 4). Otherwise w is a whole number of cells. */
    bool sampled;
    bool yardstick; /* what others' speed is set beside (bench_row_measures()) */

    unsigned own;      /* BENCH_OF_...: of the scene's settings, which no other engine takes, */
    const char *whose; /* and how messages name them: "the octree's" */

    /* The scene's w and epsilon; `cells`: of a sampled engine w is in finest cells, else in edges.
     * Sweep and calibrate plan points of the engines that have it. */
    void (*set_width)(BenchScene *scene, double w, double epsilon, bool cells);

    long *(*nodes)(BenchScene *scene); /* how many are wanted; NULL: that cannot be chosen */

    /* Makes the scene of a mesh alone (bench_scene_drop()) its own. NULL: it is good as it is. */
    void (*adapt)(const SmMesh *mesh, BenchScene *scene);

    const BenchCarrier *carrier;                              /* of the surface */
    const OctStructure *(*structure)(const SmEngine *engine); /* its tree, to record; NULL: none */

    const BenchTwin *twin; /* of its goals; NULL: they are not those of shape matching */
    bool reference;        /* then: it is one itself, with nothing to compare it with */

    const BenchChecker *checker; /* of what bench_measure() measures */

    const SmEngineType *frames; /* what bench_measure() takes in its place, of the same name; NULL:
                                 * the engine itself */

    const BenchModes *modes; /* natural ones, to be shown; NULL: it has none */

    /* The row's own columns, of an engine at rest, and more of a row for people. NULL: nothing. */
    void (*fill)(const BenchRunner *runner, BenchRow *row);
    void (*explain)(FILE *file, const BenchRow *row);

    /* What `run` says of it; NULL: its particles, regions and w, where it has such. */
    void (*describe)(const BenchRunner *runner, const SmCounts *counts);

    /* Bytes that the engine takes for so many particles of the scene, about. */
    double (*memory)(const BenchScene *scene, double particles);
} BenchEngine;

#define ENGINE(name) extern const BenchEngine bench_##name;
#include "registry.inc"
#undef ENGINE

/* All engines, NULL at the end: the program's (engine_list.c), there before its main(). */
extern const BenchEngine *const *bench_engine_list;

/* The engine of this name; one without a name, of which nothing is true, if there is none. */
const BenchEngine *bench_engine(const char *name);

/* Its type in "single" or "double" precision; NULL precision: the first that the engine has.
 * SM_USAGE lists what there is. */
SmCode bench_engine_find(const char *name, const char *precision, const SmEngineType **type,
                         SmError *error);

/* The stage that any engine calls so; SM_STAGES if none does. */
SmStage bench_stage_find(const char *name);

/* The one with `yardstick`. */
const BenchEngine *bench_engine_yardstick(void);

/* Their names, NULL-terminated. */
const char *const *bench_engine_names(void);

/* The names of those that are such, "fastlsm or octree". Returns `text`. */
const char *bench_engines_that(bool (*are)(const BenchEngine *engine),
                               char text[BENCH_ENGINES_TEXT]);

/* Do sweep and calibrate plan points of it? */
bool bench_engine_is_planned(const BenchEngine *engine);

/* Planned engine number i of those that a plan's word stands for, "both" or one's name; NULL behind
 * the last. And the words, NULL-terminated; and why another word is none, or NULL: it is no
 * engine's. */
const BenchEngine *bench_engine_planned(const char *engines, int i);
const char *const *bench_engine_choices(void);
const char *bench_engine_unplanned(const char *word);

#endif
