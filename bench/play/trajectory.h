/* trajectory.h - a moving surface in VTKHDF, with an XDMF sidecar; on request particles or nodes
 * too.
 *
 * Layout, and what opens it: results/README.md. The file grows frame by frame under a draft's name
 * (draft.h); a program that ends early leaves no trajectory, and one that is told to stop removes
 * the draft with bench_drafts_remove(). */
#ifndef BENCH_TRAJECTORY_H
#define BENCH_TRAJECTORY_H

#include "../system/machine.h"
#include "fields.h"
#include "step_record.h"

typedef struct BenchTrajectory BenchTrajectory;

typedef struct {
    const char *path;      /* "out.vtkhdf"; the sidecar is path + ".xdmf" */
    const SmMesh *surface; /* topology of the points written first; rest positions. Without
                            * triangles each point is a cell of its own */
    const BenchMachine *machine;
    const char *scene;     /* name; any bytes */
    BenchFields fields;    /* stored of every point */
    BenchStepSource steps; /* what is recorded beside the surface, and what it is made of */
} BenchTrajectoryParams;

/* `params` and all it points to may go after the call. SM_OUTPUT when the
 * file cannot be made; SM_USAGE when its name holds a colon, which XDMF cannot refer to. */
SmCode bench_trajectory_open(const BenchTrajectoryParams *params, BenchTrajectory **trajectory,
                             SmError *error);

/* About what the file takes with so many frames and no particles. */
double bench_trajectory_bytes(const BenchTrajectory *trajectory, double frames);

/* From the next frame on points have this surface's topology. On SM_OUTPUT from this and the next
 * two functions the draft is removed; what is left is to call abandon. */
SmCode bench_trajectory_topology(BenchTrajectory *trajectory, const SmMesh *surface,
                                 SmError *error);

/* One frame: time in s, surface points [vertex_count][3] in mesh units, and the fields' values
 * (fields.h); `value` may be NULL where there are none. */
SmCode bench_trajectory_frame(BenchTrajectory *trajectory, double time, const double (*point)[3],
                              const float *const value[BENCH_POINT_FIELDS], SmError *error);

/* One step of particles or nodes: number of the step, counted from 0; x and v before it,
 * with pushes applied; the goals in it; of a plastic octree also the rest shapes S before it
 * ([...][9], engine.h), else NULL. All [instances * particles or nodes of one][3]. After the
 * last step of a stretch, call it once more with the state after that step, the next number and `g`
 * NULL, so that the step's outcome is in the file. */
SmCode bench_trajectory_step(BenchTrajectory *trajectory, long step, const double (*x)[3],
                             const double (*v)[3], const double (*g)[3], const double (*S)[9],
                             SmError *error);

/* Completes, syncs and renames file and sidecar, and frees `trajectory`, also on failure; then no
 * draft is left. `hash`: of the state at the end (bench_playback_hash()). */
SmCode bench_trajectory_close(BenchTrajectory *trajectory, const char *hash, SmError *error);

/* Throws the unfinished file away and frees `trajectory`, which may be NULL. */
void bench_trajectory_abandon(BenchTrajectory *trajectory);

#endif
