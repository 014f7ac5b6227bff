/* engine.h - meshless elastic bodies (Guo and Qin 2009) behind lib/engine.h.
 *
 * Its particles are the lattice's vertices, carried by the body as its surface would be (skin.h),
 * so that scenes, handles and surfaces are those of lattice engines; w, summation, polar and layout
 * mean nothing here. A goal is where a particle is, and a particle's region the particle alone.
 * create() refuses several instances, collisions and a strain limit; obstacles stop nothing, and
 * `unstopped` says so.
 *
 * A handle grips the body at some of its particles (grip.h), a little more than one for every
 * second node there: these move with it to 1e-6, and those between them as the body does, by a few
 * thousandths of its sag. Handles that are other ones than before cost a search for modes, as
 * create() does: bodies that are held have others than those that are free. A cantilever of 1,000
 * nodes and 64 modes sags within 2% of theory; one held by a slab of two layers of nodes,
 * within 3.5%. */
#ifndef REF_MESHLESS_ENGINE_H
#define REF_MESHLESS_ENGINE_H

#include "../../lib/engine.h"
#include "../../lib/mesh.h"
#include "matrices.h"

enum { REF_MESHLESS_POINTS = 12000, REF_MESHLESS_NODES = 1000, REF_MESHLESS_MODES = 64 };

struct RefMeshlessOptions {
    const SmMesh *mesh; /* the body's closed surface, read by create() only */
    long points;        /* on the surface, of which the field is made; 0: REF_MESHLESS_POINTS */
    long nodes;         /* wanted; 0: REF_MESHLESS_NODES */
    bool uniform;       /* octants are all of one size; false: inside they may be twice as large */
    int modes;          /* 0: REF_MESHLESS_MODES, or half of what there is */
    RefMaterial material;     /* mesh units, kg, s */
    double stiffness_damping; /* b of Rayleigh's a + b lambda, s; a loses the share params->damping
                               * of the speed in a step */
};

extern const SmEngineType ref_meshless_engine;

#endif
