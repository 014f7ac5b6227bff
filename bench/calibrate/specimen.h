/* specimen.h - one point of a calibration: an engine, w, epsilon, spacing and time step on one
 * beam, what was measured of it, and the elastic body that behaves alike. `shapebench calibrate`
 * prints it and the calibration's file stores it. What the members are, with their units, is said
 * in specimen.c once, for all of these and for results/README.md. */
#ifndef BENCH_SPECIMEN_H
#define BENCH_SPECIMEN_H

#include "../../lib/error.h"
#include "../beam/clamped_beam.h"
#include "../campaign/campaign.h"
#include "elastic_cantilever.h"

enum { BENCH_YOUNGS = 1 + BENCH_TONES }; /* by sag, and by each frequency */

/* Quantities that could not be had are NaN. */
typedef struct {
    int index;
    char engine[12]; /* a planned one (engines.h) */
    int w;
    double epsilon;
    int across, aspect;
    double spacing, h;
    char set[12];
    bool wide, valid;
    char reason[160];
    long particles;
    double frequency[BENCH_TONES], loss[BENCH_TONES]; /* stiffness.h, as all up to linear_to */
    double load, sag, unrest, linear_to;
    double young, spread;
    double young_euler[BENCH_YOUNGS], young_timoshenko[BENCH_YOUNGS], young_meshless[BENCH_YOUNGS];
    BenchStamp stamp;
} BenchSpecimen;

extern const BenchField bench_specimen_fields[];
extern const int bench_specimen_field_count;

/* The moduli by the reference: the meshless one, or without it Timoshenko's. */
const double *bench_specimen_youngs(const BenchSpecimen *specimen);

/* Fills in the moduli from what was measured on a beam `thickness` thick, of that density. */
void bench_specimen_judge(const BenchElasticCantilever elastic[BENCH_MODELS], double thickness,
                          double density, BenchSpecimen *specimen);

#endif
