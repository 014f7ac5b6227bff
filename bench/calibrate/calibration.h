/* calibration.h - what a calibration is of, and its specimens.
 *
 * Of the scene only a beam is taken: its body must fill its box, which is square across its longest
 * axis and at least three times as long; that box, its cells and its time step. The grid is of all
 * w and epsilon on this beam. Beside it, one thing at a time differs, at the first epsilon alone:
 * the cells through the beam, for all w; the length, and the time step, for the first, middle and
 * last w. */
#ifndef BENCH_CALIBRATION_H
#define BENCH_CALIBRATION_H

#include "../system/machine.h"
#include "advice.h"
#include "specimen.h"

enum { BENCH_CALIBRATION_VALUES = 64, BENCH_CALIBRATION_SPECIMENS = 4096 };

typedef struct {
    char file[1024]; /* the scene's name or file as given; not stored */
    char scene[64], engines[12];
    char build[768];    /* as of a sweep (plan.h) */
    int across, aspect; /* of the scene's beam */
    double thickness, h, density, poisson, damping;
    bool meshless; /* the reference is there */
    int specimens, ws, epsilons, acrosses, aspects, steps;
    double w[BENCH_CALIBRATION_VALUES], epsilon[BENCH_CALIBRATION_VALUES];
    double other_across[BENCH_CALIBRATION_VALUES], other_aspect[BENCH_CALIBRATION_VALUES];
    double step[BENCH_CALIBRATION_VALUES]; /* times the scene's */
} BenchCalibrationPlan;

typedef struct {
    BenchCalibrationPlan plan;
    BenchMachine machine; /* where it was begun */
    long count;
    BenchSpecimen *specimen; /* [count] by rising index */
    int laws;
    BenchLaw law[BENCH_LAWS];             /* of these specimens */
    char found[BENCH_FOUND][BENCH_WORDS]; /* what they say, in sentences */
} BenchCalibration;

const BenchField *bench_calibration_fields(int *count);

/* Reads the beam from the scene that the plan's `file` names. SM_INPUT: the scene's body is no
 * beam; SM_USAGE: no such scene. */
SmCode bench_calibration_beam(BenchCalibrationPlan *plan, SmError *error);

/* Its lists of numbers, by name: the option that gives one, and what its numbers may be. */
enum { BENCH_CALIBRATION_LISTS = 5 };
typedef struct {
    const char *name, *option;
    double low, high;
    double *value;
    int *count;
} BenchCalibrationList;
void bench_calibration_lists(BenchCalibrationPlan *plan,
                             BenchCalibrationList list[BENCH_CALIBRATION_LISTS]);

/* Counts the specimens and, unless `specimen` is NULL, writes them to it, which has room for
 * BENCH_CALIBRATION_SPECIMENS, with their settings and without figures. SM_USAGE: a w that is no
 * whole number or wider than fastlsm's may be, too many of them. */
SmCode bench_calibration_plan(BenchCalibrationPlan *plan, BenchSpecimen *specimen, SmError *error);

/* Is `theirs` the same as `mine`? If not, `what` says in what they differ first. */
bool bench_calibration_same(const BenchCalibrationPlan *mine, const BenchCalibrationPlan *theirs,
                            size_t size, char *what);

/* Adds a specimen, and finds laws and sentences anew. */
void bench_calibration_add(BenchCalibration *calibration, const BenchSpecimen *specimen);

/* Finds laws and sentences of the specimens that there are. */
void bench_calibration_conclude(BenchCalibration *calibration);
void bench_calibration_free(BenchCalibration *calibration);

#endif
