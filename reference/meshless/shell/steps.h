/* steps.h - implicit steps of a shell in time (meshless section 5.2, eqs. 24 and 31 without modes):
 * M u'' + C u' + K u = F, C = a M + b K. Strains are linear: large turns need more. */
#ifndef REF_STEPS_H
#define REF_STEPS_H

#include "../motion/motion.h"

typedef struct {
    const RefMatrices *matrices; /* the caller's */
    RefDamping damping;
    double h; /* the step */
    RefSolver *solver;
    RefRows rows;
    RefSolver *taut; /* with G = `tension`, of the nodes as M is; or NULL */
    RefSparse tension;
    double *u, *v;         /* [3 nodes] displacements' parameters and velocities */
    double *force;         /* [3 nodes] the caller's to fill in; kept from step to step */
    double *speed;         /* [rows] of what they bind, the caller's to fill in; 0 at first */
    double *right, *other; /* [3 nodes] of a step */
    double *value;         /* [rows] */
} RefSteps;

/* At rest. Factorises M + h C + h^2 K once for all steps, under `rows` (NULL: none), which are
 * copied; without rows in the order of `like` (NULL: its own; see solver.h). The caller frees.
 * Errors: SM_USAGE, a step that is not above 0 or a negative damping; solver.h's. */
SmCode ref_steps_create(const RefMatrices *matrices, const RefDamping *damping, double h,
                        const RefRows *rows, const RefSolver *like, RefSteps *steps,
                        SmError *error);
void ref_steps_free(RefSteps *steps);

/* m of the matrix K + m M that steps are solved with. */
double ref_steps_mass_share(const RefDamping *damping, double h);

/* From now on steps are (M + h C + h^2 (K + G)) v = M v' + h (F - K u'), G = `tension`, which has
 * M's pattern and is taken over. Factorises that. Errors, and nothing changed: solver.h's. */
SmCode ref_steps_bear(RefSteps *steps, RefSparse *tension, SmError *error);
void ref_steps_slacken(RefSteps *steps); /* without G again */

/* What steps are solved with: K + m M, with tension + h / (b + h) G. */
RefSolver *ref_steps_solver(const RefSteps *steps);

/* (M + h C + h^2 K) v = M v' + h (F - K u'), u = u' + h v, v' and u' from the step before. Solved
 * for v + u' / (b + h), of which the right side needs no K: 1 / h (M (v' + (1 + h a) / (b + h) u')
 * + h F). O(entries of the factors). */
void ref_steps_go(RefSteps *steps);

/* v . M v / 2 + u . K u / 2, which never grows where nothing pulls. */
double ref_steps_energy(RefSteps *steps);

#endif
