/* engine.h - what every engine offers: FastLSM, the octree, and the references.
 *
 * An engine owns the state of one body, or of many instances of one body that share its lattice.
 * What its particles are is the engine's: those of lattice engines are the lattice's vertices,
 * numbered canonically (voxel.h), the octree's are its simulation nodes. count() says how many
 * there are, SM_REST where; instance k's particle p has number k * (particles / instances) + p.
 * Everything crosses this interface in double precision and mesh units, whatever the engine uses
 * inside. create allocates, step never does, destroy frees. */
#ifndef SM_ENGINE_H
#define SM_ENGINE_H

#include <stdbool.h>

#include "../cut/cut.h"
#include "../error.h"
#include "../mesh/mesh.h"
#include "../pieces.h"
#include "../voxel/voxel.h"
#include "boundary.h"
#include "stage.h"

typedef enum { SM_SUM_FAST, SM_SUM_BARS, SM_SUM_NAIVE } SmSummation;
typedef enum { SM_POLAR_FAST, SM_POLAR_JACOBI } SmPolarMethod;

/* How an engine lays its sums out: lists for any shape, blocks of lanes for solid ones. */
typedef enum { SM_LAYOUT_AUTO, SM_LAYOUT_LISTS, SM_LAYOUT_BLOCKS } SmLayout;

typedef struct OctOptions OctOptions;                 /* octree/engine.h */
typedef struct RefMeshlessOptions RefMeshlessOptions; /* reference/meshless/engine.h */

/* What collides with what, beside the boundary's obstacles (collide.h). All zero: nothing does. */
typedef struct {
    bool self;       /* a body with itself, but for what its material holds close together */
    bool bodies;     /* instances with each other */
    double friction; /* share of the tangential velocity lost on contact, 0..1 */
} SmCollideParams;

/* Damping sums moments about the body's middle, so the inertia of a region at distance D from it is
 * known to about 8 epsilon D^2. Single precision resolves it to a 64th for D up to about 130 times
 * the region's radius of gyration (w = 1: 150 cells in a solid, 90 in a stick of one cell). Regions
 * farther out get less angular velocity than eq. 14 says, and from ten times that distance on
 * hardly any: there damping also slows the body's own rotation, and its deformation less
 * (lib/simd/rigid_lanes.h). In double precision that begins at some 10^6 cells. */
typedef struct {
    int w;               /* region half-width in cells, 1 or more; not the octree's */
    double h;            /* time step, s */
    double damping;      /* k in [0,1]; 0: none (fastlsm eq. 14); see above */
    int damping_every;   /* run it every n-th step; 0 means 1 */
    double gravity[3];   /* mesh units / s^2 */
    double strain_limit; /* a link breaks beyond this times its rest length, > 1; 0: never;
                          * INFINITY: only where it is cut */
    SmSummation summation;
    SmPolarMethod polar;
    SmLayout layout;                     /* AUTO picks the faster one; results agree to rounding */
    int threads;                         /* of all it does; 0: OpenMP's number, all cores */
    const double *mass;                  /* of the lattice's vertices, [voxels->particle_count] kg;
                                          * or NULL: 1 each, of the octree 1 a finest cell */
    long instances;                      /* bodies that share the lattice; 0 means 1 */
    const double (*instance_pose)[3][4]; /* [instances] rest to initial position, or NULL */
    const OctOptions *octree;            /* of the octree only; NULL: its defaults */
    const RefMeshlessOptions *meshless;  /* of meshless bodies and shells, which need it */
    SmCollideParams collide;
} SmEngineParams;

typedef struct {
    long particles;         /* of all instances */
    long regions;           /* unique regions of one instance */
    long links;             /* one-ring neighbour pairs of one instance, unbroken */
    long broken;            /* links broken so far */
    double build_seconds;   /* time that create() took */
    double jacobi_sweeps;   /* mean sweeps a decomposition in the last step: lattices, by Jacobi */
    double summation_nodes; /* mean per region; octree only */
    long contacts;          /* of the last step or contacts(), but those with obstacles */
    bool stopped;           /* steps could not be made any more: the body stands still since then */
} SmCounts;

typedef enum {
    SM_REST,     /* x0 (with the instance's pose applied) */
    SM_POSITION, /* x */
    SM_VELOCITY, /* v */
    SM_GOAL,     /* g of the last step */
} SmField;

/* What every engine asks of a body and its parameters: particles, w, h, damping, strain limit,
 * gravity and masses in range. SM_INPUT says what is wrong and what to give. O(particles). */
SmCode sm_engine_check(const SmVoxels *voxels, const SmEngineParams *params, SmError *error);

/* Where an instance starts: its pose, or the identity where none are given. */
void sm_engine_pose(const SmEngineParams *params, long instance, double pose[3][4]);

/* A contact of a particle with a cell of its own body or another (collide.h): of a lattice engine
 * the cell whose lowest corner is particle `cell`, of the octree that of node `cell`. */
typedef struct {
    long particle, cell;
    double depth;     /* mesh units of the cell at rest */
    double out[3];    /* unit; the way out */
    double weight[8]; /* of the cell's corners, bit d of one's place: high along d; the octree's is
                       * weight[0] alone */
} SmContact;

typedef struct SmEngine SmEngine;

/* The largest half-width of regions that are counted in cells. */
enum { SM_MOST_W = 32 };

/* One engine in one precision. name, precision, create, destroy, step, get, count and either set or
 * get_state and set_state must be there. Any other member may be NULL, of an
 * engine that has nothing of the kind: callers refuse what needs it, or leave it out, as is said
 * there. */
typedef struct {
    const char *name;      /* "fastlsm", "octree", "brute" */
    const char *precision; /* "single" or "double" */
    bool by_cells;         /* params.w is the half-width of its regions, to SM_MOST_W */
    bool unstopped;        /* obstacles do not stop its bodies: callers refuse them */
    bool refines;          /* particles are split, merged and cut while it runs (octree/engine.h) */
    bool vertices;         /* its particles are the surface's vertices or points */
    bool weighs_regions;   /* a region's misfit counts by its own particle's mass, not by 1 */
    const SmStages *stages; /* NULL: those of shape matching (stage.h) */

    /* Builds an engine at rest on `voxels` (copied; may be freed after). SM_INPUT when the body
     * or the parameters are beyond what the engine does. */
    SmCode (*create)(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **engine,
                     SmError *error);
    void (*destroy)(SmEngine *engine);

    /* One time step. `laps` NULL: not instrumented, the form to time. Otherwise laps run through
     * the step without gaps (the caller starts them), at some cost. */
    void (*step)(SmEngine *engine, SmLaps *laps);

    /* Goal positions of the present state only: no velocity or position changes. Fills SM_GOAL.
     * NULL of engines without goals, which are neither recorded nor compared. */
    void (*goals)(SmEngine *engine);

    /* The field of every particle; `values` is [particles][3]. SM_GOAL after
     * step() may cost a recomputation-free copy only if the last call was goals(). */
    void (*get)(SmEngine *engine, SmField field, double (*values)[3]);
    /* The same of `count` particles only, in O(count). NULL of engines without single precision. */
    void (*get_some)(SmEngine *engine, SmField field, long count, const long *number,
                     double (*values)[3]);
    void (*set)(SmEngine *engine, SmField field,
                const double (*values)[3]); /* POSITION, VELOCITY; or NULL, see set_state */

    /* v += impulse / m on the particles named: external forces over one step. NULL of engines that
     * cannot be pushed: callers refuse forces. */
    void (*push)(SmEngine *engine, long count, const long *particle, const double (*impulse)[3]);

    /* Handles and obstacles, copied. Poses may change every step by calling it again with the same
     * handles (cheap then). NULL of engines that cannot be held: callers refuse handles, and
     * obstacles as of those that are `unstopped`. */
    void (*bound)(SmEngine *engine, const SmBoundary *boundary);

    /* Rest shapes S of all particles' regions, by rows: what a plastic body has kept (octree eq.
     * 9). `S` is [particles][9]. NULL of engines whose bodies are all elastic; false, and nothing
     * read or written, of an elastic body. */
    bool (*get_shapes)(SmEngine *engine, double (*S)[9]);
    bool (*set_shapes)(SmEngine *engine, const double (*S)[9]);

    /* The state of an engine whose particles follow from other numbers, which set() could not put
     * back: returns how many, and fills `state` unless it is NULL. NULL of others. */
    long (*get_state)(SmEngine *engine, double *state);
    void (*set_state)(SmEngine *engine, const double *state);

    /* Masses m_i of one body's particles, kg; `mass` is [particles / instances]. NULL only of
     * engines that do not refine, have no goals to compare and are not swept. */
    void (*masses)(SmEngine *engine, double *mass);

    void (*count)(SmEngine *engine, SmCounts *counts);

    /* An engine at rest as `engine` would be built now. Its particle p is particle order[p] of
     * `engine`; `order` is [particles]. `params` are those of create(), but may differ in what
     * structures do not depend on. *copy is NULL where create() builds it. NULL of engines that
     * stay as they were created. */
    SmCode (*rebuild)(SmEngine *engine, const SmEngineParams *params, SmEngine **copy, long *order,
                      SmError *error);

    /* Breaks what holds the body together across the cut's triangles from number `first` on, which
     * are in the rest position of the voxels, before any instance's pose. Allocates. SM_USAGE: the
     * body was not created to be cut; SM_INPUT, of elastic ones: what is left is none that moves,
     * or a handle's particles would be parted. NULL of engines that cannot cut any. */
    SmCode (*cut)(SmEngine *engine, const SmCut *cut, long first, SmError *error);

    /* Breaks these links of one body, pairs of neighbours at rest in either order, broken or not,
     * as strain would have. Allocates. SM_USAGE: the body was created without a strain_limit. NULL
     * of engines whose particles have none. */
    SmCode (*break_links)(SmEngine *engine, long count, const int (*pair)[2], SmError *error);

    /* Contacts of the present positions, but those with obstacles, in any order; returns how many.
     * The caller frees them. The octree's cells are turned as its regions are in the present state:
     * `turn`, [particles][9] by rows or NULL; lattice engines leave it alone. Only
     * `contacts` of count() change. NULL of engines whose bodies do not collide. */
    long (*contacts)(SmEngine *engine, double (*turn)[9], SmContact **contact);

    /* What hangs together: the pieces that one body's particles are in. The caller frees. NULL of
     * engines whose bodies stay in one piece. */
    void (*pieces)(SmEngine *engine, SmPieces *pieces);

    /* Members of particle p's region in rising order. Returns how many; writes at most `room`. NULL
     * of engines without regions, which have no goals to compare. */
    long (*region)(SmEngine *engine, long p, long *member, long room);

    /* Of a body whose surface, as it is drawn, is not the mesh that its particles are the vertices
     * of: where it has changed since the last call `surface` is freed and made anew, with places at
     * rest; else false. surface_points() are where its vertices are, [vertex_count], and
     * surface_particle() says which particle's side one is on. All three NULL of other engines. */
    bool (*surface)(SmEngine *engine, SmMesh *surface);
    void (*surface_points)(SmEngine *engine, double (*point)[3]);
    int (*surface_particle)(const SmEngine *engine, long vertex);

    /* How the sum over particle p's region is made of sums (fastlsm section 3.1): of each member,
     * in region()'s order, the bar that it is in, and the plate that this is in; both numbered from
     * 0. `bar` and `plate` are [members]. Returns how many bars; 0, and nothing is written, where
     * members are summed one by one. O(particles). NULL of engines without bars. */
    long (*bars)(SmEngine *engine, long p, int *bar, int *plate);

    /* One body's unbroken links, the lower number first. Returns how many; writes at most `room`.
     * O(links), with no room O(particles). NULL of engines whose particles have none. */
    long (*links)(SmEngine *engine, int (*link)[2], long room);
} SmEngineType;

/* Its stages; and its name of one, NULL if it has no such. */
const SmStages *sm_engine_stages(const SmEngineType *type);
const char *sm_engine_stage(const SmEngineType *type, SmStage stage);

#endif
