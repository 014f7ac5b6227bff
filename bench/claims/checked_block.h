/* checked_block.h - a solid block in an engine, whose goal positions are checked by brute force. */
#ifndef BENCH_CHECKED_BLOCK_H
#define BENCH_CHECKED_BLOCK_H

#include "../check/check.h"

typedef struct {
    BenchBody body;
    const SmEngineType *type;
    SmEngine *engine;
    BenchCheck check;
    int size[3]; /* particles a side; cells are 1 wide. Particle (i, j, k) is
                  * number i + size[0] (j + size[1] k) */
    long particles;
    double (*x0)[3], (*x)[3], (*g)[3]; /* [particles] at rest; the caller's; goals of x */
} BenchBlock;

/* At rest: x is x0. The caller frees; on an error `block` is zeroed. */
SmCode bench_block_create(const int size[3], const SmEngineType *type, int w, BenchBlock *block,
                          SmError *error);
void bench_block_free(BenchBlock *block);

/* Fills g. False and a line where the engine's goals are not those of brute force. */
bool bench_block_goals(BenchBlock *block, size_t room, char *reason);

#endif
