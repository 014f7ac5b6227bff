/* recording.h - a running scene into a trajectory file: its surface, and on request its particles
 * or nodes. */
#ifndef BENCH_RECORDING_H
#define BENCH_RECORDING_H

#include "../system/machine.h"
#include "fields.h"
#include "playback.h"
#include "trajectory.h"

typedef struct {
    BenchPlayback *play;              /* the caller's, kept */
    const BenchRunner *runner;        /* whose particles or nodes are recorded */
    SmMesh surface;                   /* of all instances, at rest */
    double (*point)[3];               /* [surface.vertex_count] where it is */
    BenchFields fields;               /* what else is stored of it, */
    float *value[BENCH_POINT_FIELDS]; /* [surface.vertex_count * components] of these */
    double (*x)[3], (*v)[3], (*g)[3]; /* [runner->particles]; only to record particles or nodes */
    double (*S)[9];                   /* [runner->particles] of a plastic body, or NULL */
    BenchTrajectory *trajectory;
    BenchRecord record;
} BenchRecording;

/* Opens the file. Errors: those of bench_trajectory_open(); SM_USAGE for particles of an octree,
 * for nodes of a lattice, and for either of bodies that change, and for fields that there are not.
 */
SmCode bench_recording_open(BenchPlayback *play, const char *path, BenchRecord record,
                            BenchFields fields, const BenchMachine *machine,
                            BenchRecording *recording, SmError *error);

/* About what the file will take with all of the scene's frames in it. */
double bench_recording_bytes(const BenchRecording *recording);

/* Writes the surface as it is now, with a new topology where the last change has split it. */
SmCode bench_recording_frame(BenchRecording *recording, SmError *error);

/* Records particles or nodes between bench_runner_prepare() and bench_runner_advance() of step
 * `step`; `before` false: after it, without goals. Computes the goals. */
SmCode bench_recording_step(BenchRecording *recording, long step, bool before, SmError *error);

/* Completes the file, or throws it away, and frees all. */
SmCode bench_recording_close(BenchRecording *recording, SmError *error);
void bench_recording_abandon(BenchRecording *recording);

#endif
