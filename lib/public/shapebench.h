/* shapebench.h - shape-matching bodies for a program that links libshapebench.
 *
 * The engines are fast lattice shape matching (Rivers and James 2007, "FastLSM") and octree shape
 * matching (Steinemann, Otaduy and Gross 2008). A program makes a mesh, voxelises it, creates a
 * body of the voxels, and steps it:
 *
 *     sb_mesh_shape("penguin", &mesh, &error);
 *     sb_voxel_params_init(&how), how.particles = 2000;
 *     sb_voxels_of_mesh(mesh, &how, &voxels, &error);
 *     sb_body_params_init(&params), params.gravity[1] = -9.81;
 *     sb_body_create(voxels, mesh, &params, &body, &error);
 *     sb_body_step(body, 100, &error);
 *     sb_body_read(body, SB_POSITION, x, room, &error);
 *
 * Conventions, which hold for every function:
 *
 * Units. Lengths are the mesh's, whatever they are; seconds, kilograms, radians. y has no special
 * meaning: gravity is what the parameters say.
 *
 * Arrays are flat and row-major: three doubles x, y, z a point, three ints a triangle, nine doubles
 * a 3 x 3 matrix, twelve a rigid motion (3 x 4: rotation and translation). What is passed in is
 * copied, and may be freed after the call. Where an array is filled, `room` says how many entries
 * (points, triangles, particles; not numbers) it has space for; with less than are needed nothing
 * is written and the call fails. sb_body_count() and the like say how many are needed.
 *
 * Errors. A function that can fail returns SB_OK, which is 0, or another SB_ code, and takes as its
 * last argument an sb_error for one line of text, which may be NULL. After a failure nothing has
 * changed, unless the function says otherwise, and what was to be created is NULL. NULL for another
 * pointer, and numbers that are not finite or out of range, are errors (SB_USAGE); a handle that
 * was freed is not noticed. Two things end the program: when memory runs out, status 70 and a line
 * that says where; and in debugging, a failed assertion, an error of ours.
 *
 * Threads. There is no global state. Different bodies may be used by different threads at once; one
 * body by one thread at a time. A mesh or voxels may be read by several. A body's work is shared by
 * sb_body_params.threads threads of OpenMP; any number gives the same bits.
 *
 * Versions. Structs, constants and functions stay as they are within a major version; what is added
 * has names of its own. A program may ask sb_version() which one it has.
 *
 * Costs are given where they are more than O(what is copied).
 *
 * Engines. Two are fast, in single and double precision: "fastlsm" (Rivers and James 2007) and
 * "octree" (Steinemann, Otaduy and Gross 2008). Three are references, in double precision: "brute",
 * shape matching without fast sums, to check others by, and "meshless" and "shell", elastic solids
 * and thin shells (Guo and Qin 2009), which a library that was built without CHOLMOD and ARPACK has
 * not. One that is the core alone (SHAPEBENCH_CORE) has no reference. What an engine does not do is
 * refused with a line. */
#ifndef SHAPEBENCH_H
#define SHAPEBENCH_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SHAPEBENCH_VERSION_MAJOR 1
#define SHAPEBENCH_VERSION_MINOR 0
#define SHAPEBENCH_VERSION_PATCH 0
#define SHAPEBENCH_VERSION                                                                         \
    (SHAPEBENCH_VERSION_MAJOR * 10000 + SHAPEBENCH_VERSION_MINOR * 100 + SHAPEBENCH_VERSION_PATCH)

typedef struct sb_mesh sb_mesh;
typedef struct sb_voxels sb_voxels;
typedef struct sb_body sb_body;

enum {
    SB_OK = 0,
    SB_USAGE = 2,   /* an argument is missing or out of range, or the call is not possible now */
    SB_INPUT = 3,   /* a file, a mesh or the parameters of a body cannot be used */
    SB_MEMORY = 70, /* the program's exit status when memory runs out */
};

typedef struct {
    int code;
    char text[512]; /* one line: what is wrong, and what to do; empty after SB_OK */
} sb_error;

/* ---- the library */

/* SHAPEBENCH_VERSION of the library that the program runs with, and as text, "1.0.0". */
int sb_version(void);
const char *sb_version_text(void);

enum { SB_FASTLSM, SB_OCTREE, SB_BRUTE, SB_MESHLESS, SB_THIN_SHELL }; /* engines */

/* "fastlsm", "octree", "brute", "meshless", "shell"; NULL of any other number. */
const char *sb_engine_name(int engine);

/* 1 if sb_body_create() can make bodies of this engine, else 0. */
int sb_engine_available(int engine);

/* ---- meshes: triangles, closed or not */

typedef struct {
    double seconds;   /* Assimp's limit of time; 0: 20 s, and one more for each MB of the file */
    double megabytes; /* Assimp's limit of memory; 0: 4096 */
} sb_load_params;

typedef struct {
    int64_t vertices, triangles;
    int64_t components;        /* connected through shared vertices */
    int64_t open_edges;        /* used by one triangle */
    int64_t nonmanifold_edges; /* used by more than two */
    int64_t flipped_edges;     /* used by two triangles of opposite orientation */
    int64_t degenerate;        /* triangles without area */
    int64_t duplicates;        /* triangles whose corners an earlier one has, too */
    int watertight;            /* 1: no open and no non-manifold edge */
    double low[3], high[3];    /* bounding box */
    double volume;             /* below 0 if inside out; NaN of a mesh that bounds none */
    int64_t left_out; /* points, lines, curves and further scenes of its file, which it lacks */
} sb_mesh_facts;

void sb_load_params_init(sb_load_params *params);

/* Reads a mesh file: OBJ, PLY, STL, OFF, glTF or GLB, also compressed (.gz), in double precision;
 * and, where the library has Assimp, its formats, in a child process within the limits (`params`
 * may be NULL: the defaults). Polygons are triangulated, equal positions merged; points and lines
 * are left out, and counted. A damaged file is an error (SB_INPUT). */
int sb_mesh_load(const char *path, const sb_load_params *params, sb_mesh **mesh, sb_error *error);

/* A mesh of the caller's `vertices` points and of triangles that name three of them each,
 * counter-clockwise seen from outside. Equal positions are merged, and triangles that then repeat a
 * vertex dropped, so numbers may differ from the caller's. SB_INPUT: no triangle, a vertex that is
 * not there, coordinates that are not finite, or a size outside 1e-30 to 1e30. */
int sb_mesh_make(int64_t vertices, const double *position, int64_t triangles, const int *triangle,
                 sb_mesh **mesh, sb_error *error);

/* A procedural model, "penguin" for instance: closed, one unit a metre, y up. Up to a second. */
int sb_mesh_shape(const char *name, sb_mesh **mesh, sb_error *error);

/* Names of the procedural models, number 0 and up; NULL past the last. */
const char *sb_shape_name(int number);

/* Fills `facts`. O(triangles). */
int sb_mesh_measure(const sb_mesh *mesh, sb_mesh_facts *facts, sb_error *error);

int sb_mesh_read_vertices(const sb_mesh *mesh, double *position, int64_t room, sb_error *error);
int sb_mesh_read_triangles(const sb_mesh *mesh, int *triangle, int64_t room, sb_error *error);

/* NULL is allowed. */
void sb_mesh_free(sb_mesh *mesh);

/* ---- voxels: material on a lattice of cubic cells (fastlsm section 2) */

enum { SB_SOLID, SB_SHELL };

typedef struct {
    int fill;          /* SB_SOLID: what a triangle touches and what that encloses; SB_SHELL: only
                        * what a triangle touches */
    double cell;       /* edge of a cell; used if `particles` is 0 */
    int64_t particles; /* wanted vertices of material cells: the cell is searched for; 0: not */
    int fewer;         /* 1: fewer particles will do where so many take too large a lattice */
} sb_voxel_params;

/* How the inside of a solid was found. */
enum {
    SB_INSIDE_NONE,   /* a shell, or a sheet that encloses nothing */
    SB_INSIDE_CLOSED, /* the mesh is closed: exact */
    SB_INSIDE_TIGHT,  /* it is open, but its holes are narrower than a cell */
    SB_INSIDE_VOTED,  /* its holes are wider: rays have decided */
};

typedef struct {
    int cells[3];          /* along x, y, z */
    int inside;            /* SB_INSIDE_... */
    double origin[3];      /* corner of cell (0, 0, 0) */
    double cell;           /* edge of a cell */
    int64_t material;      /* cells with material */
    int64_t particles;     /* vertices of these */
    int64_t shell_cells;   /* that a triangle touches */
    int64_t flooded_cells; /* that the outside cannot reach */
    int64_t voted_cells;   /* that rays have added */
} sb_voxel_facts;

/* Solid, and no size: one of `cell` and `particles` must be given. */
void sb_voxel_params_init(sb_voxel_params *params);

/* Voxelises a mesh conservatively: every cell that a triangle touches is material. SB_INPUT: loose
 * triangles without an inside for a solid, or more than 2^31 cells. O(triangles + cells / 64), up
 * to 60 times that when particles are wanted. */
int sb_voxels_of_mesh(const sb_mesh *mesh, const sb_voxel_params *params, sb_voxels **voxels,
                      sb_error *error);

/* Material where `filled`, cells[0] * cells[1] * cells[2] bytes with x fastest, is not 0; NULL: in
 * every cell. `origin` is the corner of cell (0, 0, 0); NULL: the origin. SB_INPUT: no material, or
 * more than 2^31 cells. */
int sb_voxels_make(const int cells[3], double cell, const double origin[3], const uint8_t *filled,
                   sb_voxels **voxels, sb_error *error);

int sb_voxels_measure(const sb_voxels *voxels, sb_voxel_facts *facts, sb_error *error);

/* One byte a cell of the lattice, x fastest: 1 where there is material. */
int sb_voxels_read_cells(const sb_voxels *voxels, uint8_t *filled, int64_t room, sb_error *error);

/* Rest positions of the lattice's vertices at material, in the order z, y, x with x fastest: the
 * particles of FastLSM, and what sb_body_params.mass is given for. */
int sb_voxels_read_particles(const sb_voxels *voxels, double *position, int64_t room,
                             sb_error *error);

/* What these particles weigh if each has an eighth of every material cell at it, kg; `density` is
 * in kg per unit of volume. */
int sb_voxels_weigh(const sb_voxels *voxels, double density, double *mass, int64_t room,
                    sb_error *error);

void sb_voxels_free(sb_voxels *voxels);

/* ---- bodies */

enum { SB_SINGLE, SB_DOUBLE }; /* precision */
enum {
    SB_SUM_FAST,
    SB_SUM_BARS,
    SB_SUM_NAIVE
};                                       /* fastlsm section 3: the paper's, prefix sums
                                          * along bars only, and none */
enum { SB_POLAR_FAST, SB_POLAR_JACOBI }; /* polar decomposition of 3 x 3 matrices */
enum { SB_LAYOUT_AUTO, SB_LAYOUT_LISTS, SB_LAYOUT_BLOCKS }; /* same results, to rounding */

enum { SB_CELLS_ALL, SB_CELLS_FEATURES, SB_CELLS_SURFACE, SB_CELLS_BOX, SB_CELLS_SPHERE };
enum { SB_MASS_MATERIAL, SB_MASS_VOLUME };
enum { SB_SYMMETRY_UNION, SB_SYMMETRY_INTERSECTION, SB_SYMMETRY_NONE };
enum { SB_WEIGHT_CONSERVING, SB_WEIGHT_PLAIN };
enum { SB_GOALS_GATHER, SB_GOALS_ADJOINT };

enum { SB_MOST_CRITERIA = 16, SB_MOST_WIDTHS = 16 };

/* Which cells of an octree are split (octree section 4.1). */
typedef struct {
    int kind;  /* SB_CELLS_: all; where a coarse cell would weld what is apart; at the surface;
                * that meet a box; that meet a ball */
    int level; /* the deepest to split to: 1 to levels; 0: the deepest there is */
    double low[3], high[3];   /* box */
    double centre[3], radius; /* ball */
} sb_criterion;

/* The width of regions of nodes in a box, or in a ball if radius > 0. */
typedef struct {
    double cells, edges; /* as in sb_octree_params */
    double low[3], high[3];
    double centre[3], radius;
} sb_local_width;

/* What the octree asks beyond what all engines do. All zero: the defaults. */
typedef struct {
    int levels;    /* a base cell is 2^levels finest cells wide, 1 to 12; 0: chosen by the size */
    int balance;   /* 1: cells that touch differ by one level at most */
    int64_t nodes; /* wanted simulation nodes; 0: what the criteria give */
    int64_t bases; /* wanted base cells; 0: what the corner gives */
    int corner[3]; /* of the base lattice, finest cells; not used with `bases` */
    int criteria_count;
    sb_criterion criteria[SB_MOST_CRITERIA]; /* none: SB_CELLS_FEATURES */
    double epsilon;                          /* octree section 4.3: 0 or more */
    double width_cells, width_edges; /* w_i = cells + edges * (the node's own edge), in finest
                                      * cells; both 0: one edge */
    double summation_nodes; /* wanted per region on average: edges are searched for; 0: not */
    int width_count;
    sb_local_width widths[SB_MOST_WIDTHS]; /* the last that holds a node's centre counts */
    int mass_rule;       /* SB_MASS_: a node weighs its material, or its cell's volume */
    int symmetry;        /* SB_SYMMETRY_: of regions; none only with SB_GOALS_ADJOINT */
    int weighting;       /* SB_WEIGHT_: keeps momentum; or as octree eqs. 6 and 7 print it */
    int goals;           /* SB_GOALS_ */
    double yield, creep; /* plasticity (octree eq. 9): from this strain on; rate, 0 (elastic) to
                          * 1 / h per second */
    double most;         /* largest plastic strain; 0: 1 */
} sb_octree_params;

/* What the meshless engine asks beyond what all do. Units are the mesh's, kg and s: pascals where
 * it is in metres. Defaults: 1e5, 0.3 and 1000, and else 0. */
typedef struct {
    double young, poisson, density; /* Young's modulus; Poisson's ratio, -0.99 to 0.49 */
    double stiffness_damping;       /* Rayleigh's b, s */
    int64_t points;                 /* on the surface, of which the body is made; 0: 12000, of thin
                                     * bodies more */
    int64_t nodes;                  /* wanted; 0: 1000 */
    int modes;                      /* natural ones, 7 to 1000; 0: 64 */
} sb_meshless_params;

/* What a thin shell asks beyond what all do. Units are the mesh's, kg and s: pascals where it is in
 * metres. Defaults: 1e5, 0.3 and 1000, and else 0.
 *
 * The body is its surface, closed, with rims, or a plate; its particles are the mesh's vertices,
 * carried by nodes. With a strength it cracks, and then its surface is two sheets a thickness
 * apart, the outer one's vertices before the inner one's, which come apart along cracks: after each
 * call of sb_body_step() in which any grew it has other vertices, and triangles of them. Steps
 * allocate where cracks grow. */
typedef struct {
    double young, poisson, density; /* Young's modulus; Poisson's ratio, -0.99 to 0.49 */
    double stiffness_damping;       /* Rayleigh's b, s */
    int64_t nodes;                  /* wanted; 0: 450 */
    double thickness;               /* 0: a hundredth of the mesh's longest extent */
    double covers;    /* how wide nodes' linear functions are, in edges of their cells, to 12 (3 in
                       * the paper); 0: quadratic ones, six edges wide */
    double strength;  /* it cracks where its largest principal stress is above this; 0: never */
    double branching; /* times the strength from which on a crack goes on in two; 0: never */
    double pressure;  /* inside a closed one; it acts along the normals at rest */
    double pulse;     /* seconds from the beginning in which the pressure acts */
} sb_shell_params;

typedef struct {
    int engine;    /* SB_FASTLSM, SB_OCTREE, SB_BRUTE, SB_MESHLESS, SB_THIN_SHELL */
    int precision; /* SB_SINGLE (twice as fast) or SB_DOUBLE */
    int w;         /* half-width of FastLSM's regions in cells, 1 to 32: larger is stiffer */
    int threads;   /* 0: OpenMP's number, at most the cores of affinity and container's quota */
    double h;      /* time step, s */
    double gravity[3];
    double damping;      /* of regions' motion relative to rigid, 0 to 1 (fastlsm eq. 14) */
    int damping_every;   /* n: in every n-th step; 0 means 1 */
    int cuttable;        /* 1: sb_body_cut() and blades work. The octree's bodies always are;
                          * FastLSM's cost some memory more, and must be one instance; a meshless
                          * one's modes are found anew at every cut */
    double strain_limit; /* FastLSM: a link longer than this times its rest length breaks, above 1;
                          * 0: never. The surface comes apart with the links, after each call of
                          * sb_body_step() in which any broke: it has other vertices then */
    int summation, polar, layout;        /* SB_SUM_ and SB_LAYOUT_ of FastLSM; SB_POLAR_ */
    int collide_self, collide_instances; /* 1: the body with itself; instances with each other */
    double collide_friction;             /* share of tangential velocity lost on contact, 0 to 1 */
    int64_t instances;  /* bodies of the same voxels, which share memory; 0 means 1 */
    const double *pose; /* [instances][12], from rest to where each starts; NULL: at rest. Of
                         * meshless bodies and shells a translation; others: SB_INPUT */
    const double *mass; /* [particles of the voxels] kg; NULL: 1 each; of the octree, 1 a cell.
                         * Meshless bodies and shells have a density instead; not NULL: SB_INPUT */
    const sb_octree_params *octree;     /* SB_OCTREE; NULL: the defaults */
    const sb_meshless_params *meshless; /* SB_MESHLESS; NULL: the defaults */
    const sb_shell_params *shell;       /* SB_THIN_SHELL; NULL: the defaults */
} sb_body_params;

/* FastLSM in single precision, w 2, h 0.01 s, no gravity, one instance, threads 0. */
void sb_body_params_init(sb_body_params *params);
void sb_octree_params_init(sb_octree_params *params);
void sb_meshless_params_init(sb_meshless_params *params);
void sb_shell_params_init(sb_shell_params *params);

/* Creates a body, at rest. `surface` is a mesh that it carries, usually that of the voxels, or
 * NULL; a meshless body is made of it, closed, and a shell, of one component, which has no part of
 * the voxels. SB_INPUT: an engine that is not here, or parameters that it refuses; SB_USAGE: others
 * out of range, or the environment variable SHAPEBENCH_ISA names an instruction set that this
 * processor lacks (unset: its best is taken). The line says which. O(particles), up to a few
 * microseconds each. */
int sb_body_create(const sb_voxels *voxels, const sb_mesh *surface, const sb_body_params *params,
                   sb_body **body, sb_error *error);
void sb_body_free(sb_body *body);

/* Steps of h seconds (fastlsm eqs. 1 and 2). Allocates nothing, but where handles or obstacles have
 * come or gone since the last one. 20 to 200 ns a particle, step and thread. SB_INPUT: the steps
 * are made, and the last took a body of single precision beyond 1e5 cells: its shape is lost. */
int sb_body_step(sb_body *body, int64_t steps, sb_error *error);

typedef struct {
    int64_t particles; /* of all instances; particle p of instance k is number k * n + p, where n
                        * is particles / instances */
    int64_t instances;
    int64_t steps;   /* done so far */
    double time;     /* steps * h */
    int64_t regions; /* different ones of one instance; of meshless bodies and shells nodes */
    int64_t links;   /* between neighbours, unbroken, of one instance */
    int64_t broken;
    int64_t contacts; /* of the last step, but those with obstacles */
    int64_t bytes;    /* of memory that all threads took while the engine was made; 0: not known */
    double build_seconds;                        /* that creation took */
    double summation_nodes;                      /* mean per region; octree */
    int64_t cut_triangles;                       /* that its cut consists of */
    int64_t surface_vertices, surface_triangles; /* of one instance; both 0 without a surface */
    int surface_incomplete; /* 1: some of a cut could not be made in the surface, which crosses
                             * itself there; the material is cut all the same */
    int stopped;            /* 1: a crack of a shell could not be followed: it stands still */
} sb_body_counts;

/* Fills `counts`. Octree and cuts: numbers change with resampling. */
int sb_body_count(const sb_body *body, sb_body_counts *counts, sb_error *error);

enum { SB_REST, SB_POSITION, SB_VELOCITY, SB_GOAL };

/* Three numbers a particle, `room` particles at least. FastLSM's particles are the lattice's
 * vertices (sb_voxels_read_particles()), the octree's are simulation nodes, in the middle of their
 * cells at rest. SB_REST has the instances' poses in it. SB_GOAL are goal positions (fastlsm eq.
 * 12) of the present positions, which costs a match, about half a step; of a shell, whose particles
 * are its mesh's vertices, SB_USAGE. */
int sb_body_read(sb_body *body, int field, double *values, int64_t room, sb_error *error);

/* Sets SB_POSITION or SB_VELOCITY of all particles; `count` must be their number. Positions must be
 * within 1e9 cells of the body's rest, velocities within 1e9 cells a step. SB_USAGE of a shell,
 * which handles and pushes move. */
int sb_body_write(sb_body *body, int field, const double *values, int64_t count, sb_error *error);

/* Adds impulse / mass to the velocities of some particles, N s: a force f over the next step is the
 * impulse f * h. */
int sb_body_push(sb_body *body, int64_t count, const int64_t *particle, const double *impulse,
                 sb_error *error);

/* Masses of one instance's particles, kg. */
int sb_body_read_masses(sb_body *body, double *mass, int64_t room, sb_error *error);

/* Members of a particle's region, rising. `count` receives how many there are; at most `room` are
 * written, and fewer than there are is no error. SB_USAGE of a shell, which has none. */
int sb_body_read_region(sb_body *body, int64_t particle, int64_t *member, int64_t room,
                        int64_t *count, sb_error *error);

/* Rest shapes of all particles' regions, 3 x 3 each: what a plastic body has kept (octree eq. 9).
 * SB_USAGE: the body is elastic. */
int sb_body_read_shapes(sb_body *body, double *shape, int64_t room, sb_error *error);
int sb_body_write_shapes(sb_body *body, const double *shape, int64_t count, sb_error *error);

/* Particles whose rest position, SB_REST, lies in a box or a ball, faces included: their numbers,
 * rising; for handles and impulses. `count` receives how many; at most `room` are written. */
int sb_body_select_box(sb_body *body, const double low[3], const double high[3], int64_t *particle,
                       int64_t room, int64_t *count, sb_error *error);
int sb_body_select_ball(sb_body *body, const double centre[3], double radius, int64_t *particle,
                        int64_t room, int64_t *count, sb_error *error);

/* ---- handles: particles that follow a rigid motion */

/* Holds particles where they rest; *handle receives the handle's number. SB_USAGE: none, one that
 * is not there, or one that is held already. When an octree is resampled, cells split or merged of
 * held ones are held. */
int sb_body_add_handle(sb_body *body, int64_t count, const int64_t *particle, int *handle,
                       sb_error *error);

/* Where the handle's particles are from the next step on: pose * (SB_REST, 1). `pose` is [12], a
 * rigid motion to 1e-6; one step goes all the way. */
int sb_body_move_handle(sb_body *body, int handle, const double pose[12], sb_error *error);

/* Lets its particles go. The number is not given out again. */
int sb_body_remove_handle(sb_body *body, int handle, sb_error *error);

/* ---- obstacles, which do not move; `friction` is the share of tangential velocity lost on
 * contact, 0 to 1. Thin ones stop only what moves by less than half their thickness in a step.
 * SB_USAGE of meshless bodies and shells, which nothing stops. */

/* `normal` leads towards the free side; its length does not matter. */
int sb_body_add_plane(sb_body *body, const double point[3], const double normal[3], double friction,
                      int *obstacle, sb_error *error);
int sb_body_add_sphere(sb_body *body, const double centre[3], double radius, double friction,
                       int *obstacle, sb_error *error);
int sb_body_add_box(sb_body *body, const double low[3], const double high[3], double friction,
                    int *obstacle, sb_error *error);
/* What is within `radius` of the segment from `a` to `b`. */
int sb_body_add_capsule(sb_body *body, const double a[3], const double b[3], double radius,
                        double friction, int *obstacle, sb_error *error);
int sb_body_remove_obstacle(sb_body *body, int obstacle, sb_error *error);

/* ---- collisions of bodies with themselves and of instances (octree section 6) */

typedef struct {
    int64_t particle; /* it is inside */
    int64_t cell;  /* FastLSM: the cell whose lowest corner this particle is; octree: the node's */
    double depth;  /* of the cell at rest */
    double out[3]; /* unit vector, the way out */
    double weight[8]; /* of the cell's corners, bit d of one's place: high along d; of the octree
                       * weight[0] alone */
} sb_contact;

/* Contacts of the present positions, in any order. `count` receives how many; at most `room` are
 * written. None of a body whose parameters ask for no collisions. */
int sb_body_read_contacts(sb_body *body, sb_contact *contact, int64_t room, int64_t *count,
                          sb_error *error);

/* ---- cuts. Of a body of one instance that is `cuttable`, or an octree. Surface and numbers of an
 * octree's particles change; read counts again. */

/* Cuts material and surface where the triangles pass, which are given in the rest position, before
 * any pose; they may reach beyond it. O(triangles), and what is near them; of a meshless body all
 * is made anew, in seconds, and SB_INPUT says that a cut parts what a handle holds. */
int sb_body_cut(sb_body *body, int64_t vertices, const double *position, int64_t triangles,
                const int *triangle, sb_error *error);

/* A blade, nowhere yet; *blade receives its number. An octree's cells within `reach` of its cut are
 * split down to `level`; 0: none. */
int sb_body_add_blade(sb_body *body, int level, double reach, int *blade, sb_error *error);

/* Moves the blade straight to the segment from `a` to `b`, in the world, and cuts what it sweeps
 * over; the first time it is only put there. *triangles (or NULL) receives how many the cut has
 * gained: none while the blade has moved less than half a cell through material since it last cut.
 * The cut is closed from one call to the next, however the body moves meanwhile (octree section
 * 5). O(particles) for a look at each. */
int sb_body_sweep_blade(sb_body *body, int blade, const double a[3], const double b[3],
                        int64_t *triangles, sb_error *error);

/* Takes the blade out: where it is moved next, it is only put. */
int sb_body_lift_blade(sb_body *body, int blade, sb_error *error);

/* The piece, numbered from 0, that every particle of one instance is in; *count receives how many
 * there are. SB_USAGE of a shell that cracks. */
int sb_body_read_pieces(sb_body *body, int *piece, int64_t room, int64_t *count, sb_error *error);

/* ---- resampling an octree while it runs (octree section 5). Of a body of one instance with
 * SB_SYMMETRY_UNION and SB_GOALS_GATHER, else SB_USAGE. Particles are numbered anew, handles
 * follow. The first call costs O(body), others what they change. */

/* A detail is what was split for one reason, and is merged again when that is gone; *detail
 * receives its number. */
int sb_body_add_detail(sb_body *body, int *detail, sb_error *error);

/* Splits cells that meet the ball, given at rest, down to `level`, 1 to levels (beyond: levels).
 * What the detail has split before and is not in the ball is merged once `hold` seconds have passed
 * since it last was; radius 0: the detail ends. *changed (or NULL) receives how many cells were
 * split and merged. To be called before every step or every few. */
int sb_body_detail_ball(sb_body *body, int detail, const double centre[3], double radius, int level,
                        double hold, int64_t *changed, sb_error *error);

/* The same of cells nearer than `near_distance` to an eye, down to `level`, and to a level less
 * with every doubling of the distance; cells that are split stay so until farther by the share
 * `slack`. */
int sb_body_detail_eye(sb_body *body, int detail, const double eye[3], double near_distance,
                       double slack, int level, double hold, int64_t *changed, sb_error *error);

/* Level of every particle's cell of one instance, 0 of a base cell. SB_USAGE: not an octree. */
int sb_body_read_levels(sb_body *body, int *level, int64_t room, sb_error *error);

/* ---- the surface (fastlsm section 4, octree section 7). SB_USAGE of a body created without. */

/* Positions, and unit normals unless NULL, of all instances' vertices now, one instance after the
 * other. A normal that has none is 0. O(vertices). */
int sb_body_read_surface(sb_body *body, double *position, double *normal, int64_t room,
                         sb_error *error);

/* Triangles of one instance; the numbers of vertices stay through cuts, new ones follow (but for
 * a shell that cracks: sb_shell_params). */
int sb_body_read_surface_triangles(const sb_body *body, int *triangle, int64_t room,
                                   sb_error *error);

/* One instance's vertices at rest, before any pose: for textures, and for what cuts have added. */
int sb_body_read_surface_rest(const sb_body *body, double *position, int64_t room, sb_error *error);

#ifdef __cplusplus
}
#endif

#endif
