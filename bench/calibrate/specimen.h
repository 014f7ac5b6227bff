/* specimen.h - one point of a calibration: an engine, w, epsilon, spacing and time step on one
 * beam, what was measured of it, and the elastic body that behaves alike. `shapebench calibrate`
 * prints it and the calibration's file stores it (results/README.md). */
#ifndef BENCH_SPECIMEN_H
#define BENCH_SPECIMEN_H

#include "../beam/stiffness.h"
#include "../store/h5.h"
#include "ideal.h"

enum { BENCH_YOUNGS = 1 + BENCH_TONES }; /* by sag, and by each frequency */

/* Quantities that could not be had are NaN. */
typedef struct {
    int index;          /* in the plan, from 0 */
    char engine[12];    /* a planned one (engines.h) */
    int w;              /* half-width of regions, cells */
    double epsilon;     /* of a lattice 0 */
    int across, aspect; /* cells through the beam; its length over its thickness */
    double spacing, h;  /* edge of a cell, mesh units; time step, s */
    char
        set[12]; /* why it is there: "grid", or what differs from it: "spacing", "aspect", "step" */
    bool wide;   /* regions are wider than the beam is thick: 2 w + 1 particles */
    bool valid;  /* checked against brute force, and at rest; otherwise nothing is known */
    char reason[160]; /* why not */
    long particles;
    double frequency[BENCH_TONES], loss[BENCH_TONES]; /* stiffness.h, as all up to linear_to */
    double load, sag, unrest, linear_to;              /* linear_to NaN: not looked for */
    double young;  /* Pa where lengths are m: of the elastic body that behaves alike, the geometric
                    * mean  of what the sag and the first frequency say, by the reference, which is
                    * the  meshless one, or without it Timoshenko's */
    double spread; /* largest over least of what sag and frequencies say, less 1 */
    double young_euler[BENCH_YOUNGS], young_timoshenko[BENCH_YOUNGS], young_meshless[BENCH_YOUNGS];
    double wall; /* seconds that it took */
} BenchSpecimen;

const BenchField *bench_specimen_fields(int *count);

/* With its settings zeroed and every quantity NaN. */
BenchSpecimen bench_specimen_none(void);

/* Fills in the moduli from what was measured on a beam `thickness` thick, of that density. */
void bench_specimen_judge(const BenchIdeal ideal[BENCH_MODELS], double thickness, double density,
                          BenchSpecimen *specimen);

#endif
