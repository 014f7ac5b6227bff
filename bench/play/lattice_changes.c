/* What changes a lattice's body: blades; by particle number. */
#include "../scene/blades.h"
#include "changes.h"

static SmCode change_frame(BenchChanges *changes, double from, double to, SmError *error)
{
    const BenchRunner *runner = &changes->part->runner;
    SmCut *cut = &changes->skin.cut;
    double start = sm_now();
    long first = cut->triangles;
    if (!bench_blades_move(runner->scene, from, to)) return SM_OK;
    bench_changes_sweep(changes, from, to, cut);
    if (cut->triangles == first) return SM_OK;
    SmCode code = runner->type->cut(runner->engine, cut, first, error);
    if (code) return code;
    double done = sm_now();
    sm_skin_follow_cut(&changes->skin, first);
    changes->last = (BenchChanged){
        .resampled = true, .resample_seconds = done - start, .follow_seconds = sm_now() - done};
    return SM_OK;
}

const BenchCarrier bench_lattice_carrier = {change_frame, NULL, NULL};
