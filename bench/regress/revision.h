/* revision.h - another git revision of this program, built by scripts/build_revision with the
 * compiler and options of the running program's own build folder, and kept:
 * build/regress/COMMIT-OPTIONS of the repository that the current folder is in. */
#ifndef BENCH_REVISION_H
#define BENCH_REVISION_H

#include "../store/draft.h"
#include "../system/progress.h"

typedef struct {
    char commit[64];
    char program[BENCH_DRAFT_PATH]; /* the built one */
} BenchRevision;

/* `folder` is for scratch files. Nothing is left behind but the program, or the log of a build that
 * failed. SM_INPUT: no git, not in a repository, no such revision, it does not configure or build
 * (the line names its log), interrupted. SM_OUTPUT: build/regress cannot be written. */
SmCode bench_revision_build(const char *name, const char *folder, BenchProgress *progress,
                            BenchRevision *revision, SmError *error);

#endif
