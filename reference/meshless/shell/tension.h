/* tension.h - tension that a shell is under, and steps that bear it.
 *
 * A surface under a tension T (N/m) is stiff like a string: its waves of number k push back with
 * T k^2, which is in the forces' pull at the parameters (warp.h) and not in K. Taken as it is where
 * steps begin it lets waves grow where h^2 T k^2 is above 4 rho t + (h^2 + 2 h b) D k^4, D the
 * bending stiffness: they wind the surface up, and energy comes out of nothing.
 *
 * Where that can be, steps are solved with tension's stiffness as well:
 *     (M + h C + h^2 (K + G)) v = M v' + h (F - K u'),  v . G v = sum over places of T' |grad v|^2
 * With tangents exp(w) s and a tug of size T the second derivative of the forces' work is
 * T (|s| dw^2 + 2 dw de) at most, whatever the pose, and T' is half of that bound: half is what it
 * takes for the energy never to gain more than the forces' work. Forces are what pushes, and what
 * holds beyond a piece's first need, but for what they need against h G v, which would feed itself.
 * Where this rises suddenly, by tens of a strip's weight within a step, the step or the next may
 * gain energy, and ones after them do not. G is of twice the
 * tension that it is made for, so that steps are seldom factorised anew: where tension has doubled
 * somewhere, and where for 10 steps there was next to none of what they bear. */
#ifndef REF_TENSION_H
#define REF_TENSION_H

#include "steps.h"
#include "warp.h"

typedef struct {
    double *now, *felt; /* [4 cells] T', and what of it waves feel; or NULL */
    double *borne;      /* [4 cells] for what T' steps were made last; or NULL */
    bool matters;       /* to steps that bear none; */
    bool lacks, idle;   /* these bear too little, or far more than there is: */
    int slack;          /* since so many steps */
    double stretch;     /* the largest of the surface since it was made, where forces were found */
} RefTension;

void ref_tension_free(RefTension *tension);

/* Finds the tension of all forces, whose tugs are the warp's, as it is posed. Where nothing pushed,
 * what is felt is the tension along waves alone, so that holds which turn a surface by a little do
 * not cost factors; else no step is to gain energy. O(cells). */
void ref_tension_find(RefTension *tension, const RefWarp *warp, const RefShellOptions *shell,
                      const RefSteps *steps, bool pushed);

/* Before a step: has it bear what was found last. Returns whether steps were factorised anew. */
bool ref_tension_bear(RefTension *tension, const RefWarp *warp, RefSteps *steps);

/* Has steps bear so much from now on, [4 cells], that once was `borne`: bit by bit as then. */
void ref_tension_set(RefTension *tension, const double *borne, const RefWarp *warp,
                     RefSteps *steps);

/* Steps bear none from now on, as at first. */
void ref_tension_drop(RefTension *tension, RefSteps *steps);

#endif
