#include "full_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../engines.h"
#include "runner_check.h"

typedef struct {
    int threads, frame;
    char (*hash)[BENCH_HASH_TEXT]; /* [frames], of one thread */
    long checked;                  /* states held to brute force */
} Pass;

static SmCode play_frame(BenchPlayback *play, SmError *error)
{
    SmCode code = bench_playback_change(play, error);
    for (int s = 0; s < play->scene->steps_per_frame && !code; s++) {
        bench_playback_prepare(play);
        bench_playback_advance(play, NULL);
    }
    if (!code) bench_playback_follow(play);
    return code;
}

/* Bodies that have broken, each in its own way, have no twin in common. */
static bool has_twin(const BenchRunner *runner)
{
    SmCounts counts;
    runner->type->count(runner->engine, &counts);
    return bench_engine(runner->type->name)->twin &&
           !(counts.broken && runner->body->instances > 1);
}

static SmCode hold_to_brute(const BenchPlayback *play, Pass *pass, SmError *error)
{
    char reason[160];
    for (int g = 0; g < play->count; g++) {
        const BenchRunner *runner = &play->group[g].runner;
        if (!has_twin(runner)) continue;
        if (!bench_check_runner(runner, sizeof reason, reason))
            return sm_fail(error, SM_INVALID, "%s is INVALID after frame %d: %s", play->scene->name,
                           pass->frame + 1, reason);
        pass->checked++;
    }
    return SM_OK;
}

static SmCode hold_to_first(BenchPlayback *play, const Pass *pass, SmError *error)
{
    char hash[BENCH_HASH_TEXT];
    bench_playback_hash(play, hash);
    if (!strcmp(hash, pass->hash[pass->frame])) return SM_OK;
    return sm_fail(error, SM_INVALID,
                   "%s is INVALID: after frame %d its state has other bits by %d threads than by 1",
                   play->scene->name, pass->frame + 1, pass->threads);
}

SmCode bench_full_check(const BenchScene *scene, const BenchBody *body, const SmEngineType *type,
                        unsigned long seed, int cores, BenchProgress *progress, SmError *error)
{
    const int most = cores > 4 ? cores : 4;
    Pass pass = {.hash = sm_alloc((size_t)scene->frames, sizeof *pass.hash)};
    SmCode code = SM_OK;
    for (pass.threads = 1; pass.threads <= most && !code; pass.threads++) {
        BenchPlayback play;
        bench_progress_part(progress, pass.threads - 1, most);
        code = bench_playback_create(scene, body, type, pass.threads, seed, &play, error);
        if (code) break;
        for (pass.frame = 0; pass.frame < scene->frames && !code; pass.frame++) {
            bench_progress_show(progress, scene->name, (double)pass.frame / scene->frames);
            code = play_frame(&play, error);
            if (!code && pass.threads == 1) {
                bench_playback_hash(&play, pass.hash[pass.frame]);
                code = hold_to_brute(&play, &pass, error);
            } else if (!code) {
                code = hold_to_first(&play, &pass, error);
            }
        }
        bench_playback_free(&play);
    }
    bench_progress_stop(progress);
    free(pass.hash);
    if (!code)
        printf("check: %ld state%s held to brute force; the same bits after each of %d frames by 1 "
               "to %d threads\n",
               pass.checked, pass.checked == 1 ? "" : "s", scene->frames, most);
    return code;
}
