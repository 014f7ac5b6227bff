/* breaking.h - a shell that moves and breaks: after every step cracks begin and go on by its
 * stresses (fracture.h), functions and matrices are made anew (cracked.h), and the motion goes on
 * with the new functions (sheet.h). */
#ifndef REF_BREAKING_H
#define REF_BREAKING_H

#include "fracture.h"
#include "sheet.h"

typedef struct {
    RefSheet *sheet; /* the caller's */
    RefCracked cracked;
    RefFractureOptions options;
} RefBreaking;

/* Of a sheet whose shell has no cracks. `breaking` must not move in memory. The caller frees it
 * before the sheet. Errors: SM_USAGE, a strength that is not above 0, a share out of 0..1, negative
 * numbers of splits or starts; solver.h's. */
SmCode ref_breaking_create(RefSheet *sheet, const RefCrackedOptions *cracked,
                           const RefFractureOptions *options, RefBreaking *breaking,
                           SmError *error);
void ref_breaking_free(RefBreaking *breaking);

/* One step, and what breaks by it. `changed` receives whether cracks did: nothing is held then.
 * Errors: solver.h's; the step was made then, but cracks are as they were before it. */
SmCode ref_breaking_step(RefBreaking *breaking, bool *changed, SmError *error);

/* What is left to be done after cracks were grown by the caller. Errors: as above, and what they
 * were grown by is gone. */
SmCode ref_breaking_update(RefBreaking *breaking, SmError *error);

#endif
