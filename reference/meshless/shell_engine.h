/* shell_engine.h - meshless thin shells (Guo and Qin 2009, sections 4.2 and 5.2) behind
 * lib/engine/engine.h.
 *
 * The body is its surface: a closed one, one with rims, or a plate. It is mapped to a rectangle of
 * conformal parameters (map/surface_map.h), which says what surfaces can be; nodes are put there,
 * and what is simulated moves as sheet.h says. Its particles are the mesh's vertices, or the points
 * that were given, carried; the lattice plays no part; w, summation, polar and layout mean nothing.
 * create() refuses what the meshless engine refuses. Its state is get_state()'s, and set() is NULL.
 *
 * With a strength it cracks (shell/breaking.h); its points then move with what is on their side,
 * and it has no state that could be put back: get_state() says 0. A pressure inside pushes it apart
 * along its normals, as it is at rest, for the first seconds.
 *
 * A handle holds the surface at some of its particles, apart from each other by a cell at least,
 * and turns its tangents in their middle; one whose particles are all in a line holds places alone.
 * Particles where functions are not defined hold nothing; where holds cannot be made, nothing does.
 */
#ifndef REF_SHELL_ENGINE_H
#define REF_SHELL_ENGINE_H

#include "engine.h"
#include "map/surface_map.h"
#include "shell/breaking.h"
#include "shell/torn_surface.h"
#include "solve/modes.h"

/* Thickness where none is given: this share of the mesh's longest extent. */
#define REF_SHELL_THIN 0.01

enum { REF_SHELL_NODES = 450 };

extern const SmEngineType ref_shell_engine;

/* What the engine builds of a surface so long, from options. */
RefShellOptions ref_shell_options(const RefMeshlessOptions *options, double longest);

/* What an engine is made of, for checks of it, and the seconds of its making. */
typedef struct {
    RefSurfaceMap map;
    RefSheet sheet;
    RefBreaking *breaking; /* NULL: it does not break */
    RefTornSurface torn;   /* what is drawn of one that does */
    bool broke;            /* a crack could not be followed: it stands still from then on */
    RefSkin skin;
    double (*carried)[3]; /* [skin.count] the points now, in the skin's order */
    long loose;           /* points that too few nodes cover */
    double matrix_seconds, skin_seconds;
} RefShellBody;

RefShellBody *ref_shell_body(SmEngine *engine);

/* The lowest natural modes of a shell that has no cracks yet, when nothing holds it: at least the
 * first six, which are rigid, and `shapes` that deform it. The engine keeps them. Errors: those of
 * modes.h and warp.h. */
SmCode ref_shell_find_modes(SmEngine *engine, int shapes, const RefModes **modes, SmError *error);

/* Puts the particles where one of these modes, from 0 of those that deform it, has them at such an
 * amplitude that the particle that moves most, were the motion small, is `far` mesh units from
 * rest; below 0: the other way. Velocities are 0. Returns its frequency, Hz. The motion stays.
 * O((nodes + particles) covers), and six solves. */
double ref_shell_show(SmEngine *engine, int mode, double far);

#endif
