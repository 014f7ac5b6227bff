/* engine.h - meshless elastic bodies (Guo and Qin 2009) behind lib/engine/engine.h.
 *
 * Its particles are the lattice's vertices, carried by the body as its surface would be (skin.h),
 * so that scenes, handles and surfaces are those of lattice engines; w, summation, polar and layout
 * mean nothing here. A goal is where a particle is, and a particle's region the particle alone.
 * create() refuses several instances, collisions and a finite strain limit; obstacles stop nothing,
 * and `unstopped` says so.
 *
 * A body that was created to be cut (a strain limit of INFINITY) is: a cut is a crack
 * (body/crack_surface.h), and what it changes is made again: nodes, matrices and modes, in seconds
 * a cut of a body of 1,000 nodes. Particles beside it move with what is on their side. A stored
 * body is not cut, as its modes are those that it was stored with; nor is what a handle holds
 * parted, or left without nodes (SM_INPUT). A handle of later holds what is on the piece of its
 * first particle.
 *
 * A handle grips the body at some of its particles (grip.h), a little more than one for every
 * second node there: these move with it to 1e-6, and those between them as the body does, by a few
 * thousandths of its sag. Handles that are other ones than before cost a search for modes, as
 * create() does: bodies that are held have others than those that are free. A stored body keeps its
 * modes, whatever holds it, and is turned four times about at most. A cantilever of 1,000
 * nodes and 64 modes sags within 2% of theory; one held by a slab of two layers of nodes,
 * within 3.5%. */
#ifndef REF_MESHLESS_ENGINE_H
#define REF_MESHLESS_ENGINE_H

#include "../../lib/engine/engine.h"
#include "../../lib/mesh/mesh.h"
#include "motion/motion.h"
#include "motion/skin.h"
#include "surface/mpu.h"

enum {
    REF_MESHLESS_POINTS = 12000,
    REF_MESHLESS_MOST_POINTS = 400000,
    REF_MESHLESS_NODES = 1000,
    REF_MESHLESS_MODES = 64
};

typedef struct RefStored RefStored; /* stored.h */
/* USUAL: of solids linear, of shells quadratic, or linear where they have `covers`. */
typedef enum { REF_MESHLESS_USUAL, REF_MESHLESS_LINEAR, REF_MESHLESS_QUADRATIC } RefMeshlessBasis;

struct RefMeshlessOptions {
    const SmMesh *mesh;      /* the body's closed surface, read by create() only */
    const RefMpu *given;     /* NULL, or of a solid the field of points that were given: they are
                              * carried, too; the caller's, and kept of a body that may be cut */
    bool of_points;          /* a shell's mesh is of triangles between points (local_triangles.h) */
    const RefStored *stored; /* NULL, or the body and its modes (stored.h): none are sought then */
    long points;  /* on the mesh's surface, of which the field is made without `given`; 0:
                   * REF_MESHLESS_POINTS, of thin bodies more, to REF_MESHLESS_MOST_POINTS */
    long nodes;   /* wanted; 0: REF_MESHLESS_NODES */
    bool uniform; /* octants are all of one size; false: inside they may be twice as large */
    int modes;    /* 0: REF_MESHLESS_MODES, or half of what there is */
    RefMeshlessBasis basis; /* of the shape functions (meshless eq. 11); a solid's covers of the
                             * quadratic one are twice as wide */
    double thickness;       /* of a shell, mesh units; 0: REF_SHELL_THIN (shell_engine.h) of its
                             * longest extent */
    double covers;    /* of a shell: how wide they are, in edges of their cells; 0: 4 of the linear
                       * basis, 6 of the quadratic one */
    double strength;  /* of a shell that breaks, Pa as `material` has it; 0: it does not */
    double branching; /* times the strength from which on a crack goes on in two; 0: never */
    double pressure;  /* inside a closed shell, along its normals at rest, for */
    double pulse;     /* s from the beginning */
    RefMaterial material;     /* mesh units, kg, s */
    double stiffness_damping; /* b of Rayleigh's a + b lambda, s; a loses the share params->damping
                               * of the speed in a step */
};

/* The field of a mesh's points, as many as the options say. The caller frees. Errors (SM_INPUT):
 * those of making it, of thin bodies with how many points would do. */
SmCode ref_meshless_field(const RefMeshlessOptions *options, RefMpu *mpu, SmError *error);

/* How many points options->given has (RefPoints, as_given), and unless `x` is NULL where they are
 * now, in their order; 0 of a mesh. */
long ref_meshless_points(const SmEngine *engine, double (*x)[3]);

/* How many natural modes were found that deform the body when nothing holds it: those of its modes
 * but the six rigid ones of each piece, rising in frequency. */
int ref_meshless_shapes(const SmEngine *engine);

/* Puts the particles of a lattice, and points that were given, where that body's mode `mode`, from
 * 0, has them at such an amplitude that the node that moves most, were the motion small, is `far`
 * mesh units from rest, warped as all motion is; below 0: the other way. Returns its frequency, Hz.
 * The motion itself stays: the next step goes on from it. O((nodes + particles) modes). */
double ref_meshless_show(SmEngine *engine, int mode, double far);

extern const SmEngineType ref_meshless_engine;

/* What create() asks of bodies and parameters, of shells, too; and the stages of a step. */
SmCode ref_meshless_check(const SmVoxels *voxels, const SmEngineParams *params, SmError *error);
extern const SmStages ref_meshless_stages;

/* The same body as Table 1 of Guo and Qin times it. Its particles are the points of the field,
 * carried as they are; a step is one implicit step and all points' new positions. Each handle binds
 * position and orientation of one of its points, the nearest to their middle (meshless section
 * 5.3.3), and the modes are the free body's. The lattice plays no part, nor have its particles any
 * other state than their modes': set() is NULL. bytes are those that a step reads or writes. */
extern const SmEngineType ref_meshless_frames;

/* What an engine of either type is made of, for checks of it, and the seconds of its making. */
typedef struct RefElastic {
    RefMaterial material; /* in mesh units */
    RefBody body;
    RefModes modes; /* of the body that nothing holds */
    RefMotion motion;
    RefSkin skin;
    double (*carried)[3]; /* [skin.count] the points now, in the skin's order */
    int holds;
    double (*held)[3]; /* [holds] what each handle binds, at rest; of frames */
    RefField field;    /* of a body that may be cut, */
    RefMpu mpu;        /* and what it is of, unless points were given */
    double field_seconds, matrix_seconds, mode_seconds, skin_seconds;
} RefElastic;

RefElastic *ref_meshless_elastic(SmEngine *engine);

/* Takes over where the same body is, and how fast it goes, from another engine of the first type,
 * as well as set() cannot: turns of any size go on. */
void ref_meshless_go_on(SmEngine *engine, SmEngine *from);

#endif
