/* mode.h - natural modes that are shown in place of a body's motion, of the engines that have such
 * (BenchEngine.modes). */
#ifndef BENCH_MODE_H
#define BENCH_MODE_H

#include "recording.h"

typedef struct BenchModes {
    /* Finds the mode of this number, from 1, of those that deform the free body. Errors: SM_USAGE,
     * there is none; SM_INPUT, it could not be found. */
    SmCode (*find)(SmEngine *engine, int mode, SmError *error);

    /* Puts the body where the mode has it when, were the motion small, the node, or of a shell the
     * particle, that moves most is `far` mesh units from rest. Returns its frequency, Hz. */
    double (*show)(SmEngine *engine, int mode, double far);

    long (*nodes)(SmEngine *engine); /* of the body, which its shapes are of */
} BenchModes;

extern const BenchModes bench_elastic_modes, bench_shell_modes;

/* The frequency of the same mode in the same body with half the nodes, Hz; NaN: that has none. A
 * body of too few nodes bends less easily than what it is of, so that frequencies fall with more:
 * where they do not fall any further, they are the body's own. Costs what making that body does. */
double bench_mode_of_half(const BenchPlayback *play, int mode);

/* One period of the mode in the scene's frames, the largest displacement a tenth of the body's
 * longest extent; or with none, the moment of that. `recording` may be NULL. Says the frequency on
 * standard output, and that with half the nodes. Errors: those of find() and of recording. */
SmCode bench_mode_record(BenchPlayback *play, BenchRecording *recording, int mode, SmError *error);

#endif
