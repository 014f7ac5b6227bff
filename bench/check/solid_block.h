/* solid_block.h - a solid block in an engine, whose goal positions are checked. */
#ifndef BENCH_SOLID_BLOCK_H
#define BENCH_SOLID_BLOCK_H

#include "../scene/body.h"

typedef struct {
    BenchBody body;
    const SmEngineType *type;
    SmEngine *engine;
    int size[3]; /* particles a side; cells are 1 wide. Particle (i, j, k) is
                  * number i + size[0] (j + size[1] k) */
    int w;
    long particles;
    bool brute;     /* goals are held to brute force; else they are to be finite and to keep
                     * momentum: where that would take more than 5e7 region members */
    double (*x)[3]; /* [particles] for the caller to move; at first where they rest, as body.x0 is
                     * if `brute` */
} BenchBlock;

/* An engine with these parameters. The caller frees; on an error `block` is zeroed. */
SmCode bench_block_create(const int size[3], const SmEngineType *type, const SmEngineParams *params,
                          BenchBlock *block, SmError *error);
void bench_block_free(BenchBlock *block);

/* Finds the goals of x, which the engine has then (SM_GOAL). False and a line where they are
 * wrong. */
bool bench_block_goals(BenchBlock *block, size_t room, char *reason);

#endif
