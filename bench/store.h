/* store.h - results and trajectories in HDF5, written to a temporary name and renamed. */
#ifndef BENCH_STORE_H
#define BENCH_STORE_H

#include "row.h"

/* What an environment was: provenance of every result. Strings are "unknown" where unknown. */
typedef struct {
    char git_commit[48], compiler[128], flags[512], cpu[128], governor[32], kernel[128];
    char libraries[256], hostname[64], utc[32], command[1024], version[32];
    long l1_bytes, l2_bytes, l3_bytes;
    int cores, threads;
    bool git_dirty;
} BenchMachine;

void bench_machine_read(int argc, char **argv, int threads, BenchMachine *machine);

/* Writes one results file with all rows: every repeat's samples, counts, validity, provenance.
 * Schema: results/README.md. SM_OUTPUT: nothing is left behind. */
SmCode bench_store_rows(const char *path, const BenchRow *rows, int count,
                        const BenchMachine *machine, SmError *error);

/* A trajectory being written: VTKHDF unstructured grid or poly data with fixed topology, and an
 * XDMF sidecar; see results/README.md. */
typedef struct BenchTrajectory BenchTrajectory;

typedef struct {
    const char *path;            /* "out.vtkhdf" or "out.h5"; the sidecar is path + ".xdmf" */
    const SmMesh *surface;       /* topology of the points written each frame */
    const SmVoxels *voxels;      /* for record_particles */
    const SmEngineParams *params;
    const double *mass;          /* [particle_count] */
    const BenchMachine *machine;
    bool record_particles;
    const char *scene;           /* name */
} BenchTrajectoryParams;

SmCode bench_trajectory_open(const BenchTrajectoryParams *params, BenchTrajectory **trajectory,
                             SmError *error);
/* One frame: time in s, surface points [vertex_count][3]. */
SmCode bench_trajectory_frame(BenchTrajectory *trajectory, double time, const double (*point)[3],
                              SmError *error);
/* One recorded step (record_particles): state before the step and goal positions in it. */
SmCode bench_trajectory_step(BenchTrajectory *trajectory, long step, const double (*x)[3],
                             const double (*v)[3], const double (*g)[3], SmError *error);
/* Completes, syncs and renames; on failure removes the temporary file. */
SmCode bench_trajectory_close(BenchTrajectory *trajectory, SmError *error);
/* Throws the unfinished file away. */
void bench_trajectory_abandon(BenchTrajectory *trajectory);

#endif
