/* calibration.h - a calibration: what it is of, its specimens, and how they are measured.
 *
 * Of the scene only a beam is taken: its body must fill its box, which is square across its longest
 * axis and at least three times as long; that box, its cells and its time step. The grid is of all
 * w and epsilon on this beam. Beside it, one thing at a time differs, at the first epsilon alone:
 * the cells through the beam, for all w; the length, and the time step, for the first, middle and
 * last w. */
#ifndef BENCH_CALIBRATION_H
#define BENCH_CALIBRATION_H

#include "../campaign/campaign.h"
#include "recommendation.h"
#include "specimen.h"

enum { BENCH_CALIBRATION_VALUES = 64, BENCH_CALIBRATION_SPECIMENS = 4096 };

/* What the members are is said in calibration.c. */
typedef struct {
    char file[1024]; /* the scene's name or file as given; not stored */
    char scene[64], engines[12], build[BENCH_CAMPAIGN_BUILD];
    int across, aspect; /* of the scene's beam */
    double thickness, h, density, poisson, damping;
    bool meshless;
    int specimens, ws, epsilons, acrosses, aspects, steps;
    double w[BENCH_CALIBRATION_VALUES], epsilon[BENCH_CALIBRATION_VALUES];
    double other_across[BENCH_CALIBRATION_VALUES], other_aspect[BENCH_CALIBRATION_VALUES];
    double step[BENCH_CALIBRATION_VALUES]; /* times the scene's */
} BenchCalibrationPlan;

/* The campaign, whose plan is a BenchCalibrationPlan and whose points are BenchSpecimens: each
 * one's beam is built, and checked against brute force as it sags. Some are also looked at for how
 * far sags are in proportion. The file's schema: results/README.md. Its lists are w, epsilon,
 * across, aspect and step.
 *
 * In its table a specimen that is not valid is INVALID; its quantities are "-", empty or null. The
 * text form also has the laws, what was found in sentences, and the reasons; markdown and latex
 * have the laws as a second table, JSON has the members "laws" and "found". */
extern const BenchCampaignType bench_calibration_type;

/* What follows from its specimens. */
typedef struct {
    int laws;
    BenchStiffnessFit law[BENCH_STIFFNESS_FITS];
    char found[BENCH_FOUND][BENCH_WORDS]; /* in sentences */
} BenchConclusion;

BenchConclusion bench_calibration_conclude(const BenchCampaign *calibration);

/* Reads the beam from the scene that the plan's `file` names. SM_INPUT: the scene's body is no
 * beam; SM_USAGE: no such scene. */
SmCode bench_calibration_beam(BenchCalibrationPlan *plan, SmError *error);

#endif
