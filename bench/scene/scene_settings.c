/* scene_settings.c - the table of a scene's settings. */
#include "../engines.h"
#include "scene.h"

#define FAR 1e12 /* a length, speed or force beyond this is a mistake */

const char *const bench_precisions[] = {"single", "double", NULL};
const char *const bench_widths[] = {"edges", "cells", NULL};
const char *const bench_summations[] = {"fast", "bars", "naive", NULL};
const char *const bench_polars[] = {"fast", "jacobi", NULL};
const char *const bench_layouts[] = {"auto", "lists", "blocks", NULL};
const char *const bench_masses[] = {"material", "volume", NULL};
const char *const bench_symmetries[] = {"union", "intersection", "none", NULL};
const char *const bench_weightings[] = {"conserving", "plain", NULL};
const char *const bench_goal_forms[] = {"gather", "adjoint", NULL};

#define SAYS(words) .help = words
/* A member of the same name; one that is a place or direction, a length, up to 10^6, a level of the
 * octree, a share. */
#define MEMBER(record, member, words) RANGED(record, member, 0, 0, words)
#define RANGED(record, member, least, most, words)                                                 \
    {                                                                                              \
#member, BENCH_IN(record, member), least, most, SAYS(words)                                \
    }
#define PLACE(record, member, words)  RANGED(record, member, -FAR, FAR, words)
#define LENGTH(record, member, words) RANGED(record, member, 0, FAR, words)
#define UPTO(record, member, words)   RANGED(record, member, 0, 1e6, words)
#define LEVEL(record, member, words)  RANGED(record, member, 1, OCT_MAX_LEVELS, words)
#define SHARE(record, member, words)  RANGED(record, member, 0, 1, words)
#define SELECT(type)                                                                               \
    {"box_low", BENCH_IN(type, select.low), -FAR, FAR,                                             \
     SAYS("Selects particles by their rest position: low corner of a box, in shares of the "       \
          "mesh's box")},                                                                          \
        {"box_high", BENCH_IN(type, select.high), -FAR, FAR, SAYS("its high corner")},             \
        {"sphere_centre", BENCH_IN(type, select.centre), -FAR, FAR,                                \
         SAYS("Or those in a sphere, in the mesh's units: its centre")},                           \
    {                                                                                              \
        "sphere_radius", BENCH_IN(type, select.radius), 0, FAR, SAYS("and its radius")             \
    }

static const BenchSetting handle_table[] = {
    SELECT(BenchHandle),
    PLACE(BenchHandle, velocity, "Steady motion, units a second"),
    PLACE(BenchHandle, axis, "Axis of its turn"),
    PLACE(BenchHandle, centre, "A point on the axis"),
    RANGED(BenchHandle, rate, -1e4, 1e4, "Steady turn, radians a second"),
    RANGED(BenchHandle, amplitude, -1e4, 1e4,
           "Turn to and fro, radians: amplitude sin(2 pi t / period)"),
    UPTO(BenchHandle, period, "Its period, s; 0: none"),
    UPTO(BenchHandle, start, "When it begins to move, s"),
    UPTO(BenchHandle, stop, "When it stops, s; 0: never"),
    MEMBER(BenchHandle, release, "Let go at `stop`; false: stay there"),
    {0},
};

static const BenchSetting force_table[] = {
    SELECT(BenchForce),
    PLACE(BenchForce, force, "On every selected particle, newtons"),
    UPTO(BenchForce, start, "From this time on, s"),
    UPTO(BenchForce, stop, "To this time, s"),
    {0},
};

static const BenchSetting cut_table[] = {
    PLACE(BenchCut, base_from, "One end of the blade at `start`"),
    PLACE(BenchCut, tip_from, "The other end"),
    PLACE(BenchCut, base_to, "The first end at `stop`"),
    PLACE(BenchCut, tip_to, "The other end"),
    UPTO(BenchCut, start, "When the blade begins to move, s"),
    UPTO(BenchCut, stop, "When it has arrived, s"),
    LEVEL(BenchCut, level,
          "Octree: leaves near the cut are split down to this level; without it they are not"),
    UPTO(BenchCut, reach, "How near, in finest cells; 0: 1"),
    {0},
};

static const BenchSetting touch_table[] = {
    RANGED(BenchTouch, instance, 1, 1000000, "Which one is touched, from 1"),
    PLACE(BenchTouch, centre,
          "Centre of a ball, where the body is at rest: leaves that meet it are split"),
    LENGTH(BenchTouch, radius, "Its radius"),
    LEVEL(BenchTouch, level, "The level that they are split down to"),
    UPTO(BenchTouch, start, "When it begins, s"),
    UPTO(BenchTouch, stop, "When it ends, s; 0: never"),
    UPTO(BenchTouch, hold, "How long after it they are merged again, s"),
    {0},
};

static const BenchSetting view_table[] = {
    PLACE(BenchView, eye_from, "Where the eye is at `start`"),
    PLACE(BenchView, eye_to, "Where it is at `stop`"),
    UPTO(BenchView, start, "When it begins to move, s"),
    UPTO(BenchView, stop, "When it stops, s"),
    LENGTH(BenchView, near,
           "Leaves nearer than this are split down to `level`, to one less with every doubling"),
    UPTO(BenchView, slack, "They are merged where they are farther by this share"),
    LEVEL(BenchView, level, "The deepest level; without it there is no eye"),
    {0},
};

#define CORNER(name, member, words)                                                                \
    {                                                                                              \
        name, BENCH_IN(SmObstacle, member), -FAR, FAR, SAYS(words)                                 \
    }
static const BenchSetting plane_table[] = {
    CORNER("point", a, "A point on it"),
    CORNER("normal", b, "Its normal, to the side that is free"),
    SHARE(SmObstacle, friction, "Share of tangential velocity lost"),
    {0},
};
static const BenchSetting ball_table[] = {
    CORNER("centre", a, "Its centre"),
    LENGTH(SmObstacle, radius, "Its radius"),
    SHARE(SmObstacle, friction, "Share of tangential velocity lost"),
    {0},
};
static const BenchSetting box_table[] = {
    CORNER("low", a, "Its low corner"),
    CORNER("high", b, "Its high corner"),
    SHARE(SmObstacle, friction, "Share of tangential velocity lost"),
    {0},
};
static const BenchSetting capsule_table[] = {
    CORNER("from", a, "One end of the segment"),
    CORNER("to", b, "The other end"),
    LENGTH(SmObstacle, radius, "Its radius"),
    SHARE(SmObstacle, friction, "Share of tangential velocity lost"),
    {0},
};

static const BenchSetting criterion_table[] = {
    {"kind", BENCH_IN(OctCriterion, kind),
     BENCH_ONE_OF("uniform", "features", "surface", "box", "sphere"), .needed = true,
     SAYS("All cells, those that would weld what is not connected, those at the surface, or those "
          "that meet a place")},
    LEVEL(OctCriterion, level, "The deepest that it splits to; without it the octree's `levels`"),
    PLACE(OctCriterion, low, "Low corner of a box"),
    PLACE(OctCriterion, high, "Its high corner"),
    PLACE(OctCriterion, centre, "Centre of a sphere"),
    LENGTH(OctCriterion, radius, "Its radius"),
    {0},
};

static const BenchSetting width_table[] = {
    {"w", BENCH_IN(OctLocalWidth, width.cells), 0, 1e6,
     SAYS("Half-width in finest cells, to which is added")},
    {"edges", BENCH_IN(OctLocalWidth, width.edges), 0, 1e6, SAYS("this times the node's own edge")},
    PLACE(OctLocalWidth, low, "Of nodes whose centre is in a box: its low corner"),
    PLACE(OctLocalWidth, high, "Its high corner"),
    PLACE(OctLocalWidth, centre, "Or in a sphere: its centre"),
    LENGTH(OctLocalWidth, radius, "Its radius"),
    {0},
};

static const BenchSetting collide_table[] = {
    MEMBER(SmCollideParams, self, "The body with itself, fastlsm and octree"),
    MEMBER(SmCollideParams, bodies, "Its instances with each other"),
    SHARE(SmCollideParams, friction, "Share of tangential velocity lost"),
    {0},
};

/* Options of `run`: those of the first section of its --help, and those of one engine alone. */
#define RUN(name, value, words)      BENCH_OPTION(name, value, 1, words), .who = BENCH_BY_RUN
#define OCTREE(name, value, words)   RUN(name, value, "Octree: " words), .of = BENCH_OF_SAMPLED
#define MESHLESS(name, value, words) RUN(name, value, "Meshless: " words), .of = BENCH_OF_ELASTIC
#define SHELL(name, value, words)    RUN(name, value, "Shell: " words), .of = BENCH_OF_SHELL
#define BOTH(name, value, words)                                                                   \
    RUN(name, value, "Meshless, shell: " words), .of = BENCH_OF_ELASTIC | BENCH_OF_SHELL

static const BenchSetting octree_table[] = {
    {"levels", BENCH_IN(OctOptions, sampling.levels), 1, OCT_MAX_LEVELS,
     OCTREE("levels", "N",
            "a base cell is 2^N finest cells wide, 1 to 12 (default: up to 4, with at least eight "
            "base cells along the body)")},
    {"bases", BENCH_IN(OctOptions, sampling.bases), 0, 1e9,
     SAYS("Wanted base cells: the base lattice is put where there are nearest to as many; 0: "
          "anywhere")},
    {"nodes", BENCH_IN(OctOptions, sampling.nodes), 0, 1e9,
     SAYS("Wanted simulation nodes; 0: as many as the criteria give")},
    {"balance", BENCH_IN(OctOptions, sampling.balance),
     SAYS("Cells of leaves that touch differ by one level at most")},
    {"criteria",
     BENCH_ITEMS(OctOptions, sampling.criteria, sampling.criteria_count, OCT_MAX_CRITERIA),
     .table = criterion_table,
     SAYS("A cell is split where one of these asks for it; none: features")},
    {"w", BENCH_IN(OctOptions, width.cells), 0, 1e6,
     SAYS("Half-width of regions in finest cells, to which is added")},
    {"edges", BENCH_IN(OctOptions, width.edges), 0, 1e6,
     SAYS("this times each node's own edge; where both are 0, one edge")},
    UPTO(OctOptions, summation_nodes,
         "Or edges are searched that give as many summation nodes a region on average"),
    {"widths", BENCH_ITEMS(OctOptions, local, local_count, OCT_MAX_WIDTHS), .table = width_table,
     SAYS("Other widths at some places, where wide is stiff and narrow soft; the last one counts")},
    {"masses", BENCH_IN(OctOptions, masses), BENCH_CHOICES(bench_masses),
     SAYS("A node weighs as much as its material, or as its cell were it full (octree section "
          "4.1): then mass changes where cells are split, and stiffness with the place of the base "
          "lattice (1.56 times from the softest to the stiffest of a beam of four nodes across, by "
          "material 1.18)")},
    {"symmetry", BENCH_IN(OctOptions, symmetry), BENCH_CHOICES(bench_symmetries),
     SAYS(
         "Of two nodes of which one alone reaches the other both are taken in (some are then "
         "beyond (1 + epsilon) w), neither (bodies can fall apart), or just the one (the fewest "
         "summation nodes; needs goals = adjoint). Only a union can be cut, touched or looked at")},
    {"weighting", BENCH_IN(OctOptions, weighting), BENCH_CHOICES(bench_weightings),
     SAYS("Goals keep momentum, or are as octree eqs. 6 and 7 print them")},
    {"goals", BENCH_IN(OctOptions, form), BENCH_CHOICES(bench_goal_forms),
     SAYS("Averages over regions, or the transpose of their sums; the same where symmetric")},
    UPTO(OctOptions, yield, "A region's stretch beyond this is plastic"),
    UPTO(OctOptions, creep, "at this rate, 1/s, at most 1/h; 0: elastic"),
    UPTO(OctOptions, most, "and stays up to this; 0: 1"),
    {0},
};

static const BenchSetting meshless_table[] = {
    {"young", BENCH_IN(BenchScene, meshless.material.young), 1e-30, 1e30,
     BOTH("young", "E", "Young's modulus, Pa (default: 1e5)")},
    {"poisson", BENCH_IN(BenchScene, meshless.material.poisson), -0.99, 0.49,
     BOTH("poisson", "NU", "Poisson's ratio, above -1 to 0.49 (default: 0.3)")},
    {"density", BENCH_IN(BenchScene, meshless.material.density), 1e-30, 1e30,
     BOTH("density", "RHO", "kg/m^3 (default: 1000)")},
    {"basis", BENCH_IN(BenchScene, meshless.basis), BENCH_ONE_OF("usual", "linear", "quadratic"),
     BOTH("basis", "WHICH",
          "the functions that nodes' shape functions reproduce: %s; quadratic ones cost far more a "
          "node (usual: linear, of shells quadratic unless the scene says covers)")},
    {"modes", BENCH_IN(BenchScene, meshless.modes), 7, 1000,
     MESHLESS("modes", "N", "natural modes, 7 to 1000 (default: 64)")},
    {"points", BENCH_IN(BenchScene, meshless.points), REF_LEAST_POINTS, REF_MOST_POINTS,
     MESHLESS("points", "N",
              "points on the mesh, of which its field is made and which `tables` carries (default: "
              "12000, of thin bodies up to 400000)")},
    {"thickness", BENCH_IN(BenchScene, meshless.thickness), 0, FAR,
     SHELL("thickness", "T", "in the mesh's units (default: a hundredth of its longest extent)")},
    {"covers", BENCH_IN(BenchScene, meshless.covers), 0, 100,
     SAYS("A shell's covers, in edges of their cells (3 in the paper), usually with the linear "
          "basis; 0: 4 with that, 6 with the quadratic one")},
    {"strength", BENCH_IN(BenchScene, meshless.strength), 0, 1e30,
     SHELL("strength", "S",
           "it cracks where its largest principal stress is above S Pa (default: "
           "never)")},
    {"branching", BENCH_IN(BenchScene, meshless.branching), 0, 1e6,
     SAYS("A crack of a shell goes on in two from this many times the strength on; 0: never")},
    {"pressure", BENCH_IN(BenchScene, meshless.pressure), -1e30, 1e30,
     SAYS("Pa, inside a closed shell, along its normals at rest")},
    {"pulse", BENCH_IN(BenchScene, meshless.pulse), 0, 1e9, SAYS("for so many seconds at first")},
    {"stiffness_damping", BENCH_IN(BenchScene, meshless.stiffness_damping), 0, 1e6,
     SAYS("Rayleigh's b, s: a mode of angular frequency f has the loss factor b f")},
    {"nodes", BENCH_IN(BenchScene, meshless.nodes), 8, 1e6,
     SAYS("Wanted simulation nodes, met as well as octants can; not given: 1000, of a shell 450")},
    {"uniform", BENCH_IN(BenchScene, meshless.uniform),
     SAYS("Octants are all of one size; or those inside may be twice as large")},
    RANGED(BenchScene, metre, 1e-30, 1e30, "Mesh units in a metre"),
    {0},
};

#define LIST(items, number) BENCH_ITEMS(BenchSceneFile, items, number, BENCH_MAX)

const BenchSetting bench_scene_settings[] = {
    MEMBER(BenchScene, title, "What the scene is"),
    MEMBER(BenchScene, paper, "The paper beside whose row `tables` sets it"),
    MEMBER(BenchScene, row, "That row; empty: none"),
    MEMBER(BenchScene, mesh,
           "shape:NAME, or a mesh file's path relative to this file; it must be given"),
    {"fill", BENCH_IN(BenchScene, voxel.fill), BENCH_ONE_OF("solid", "shell"),
     RUN("shell", NULL, "Surface cells only, not the interior")},
    {"particles", BENCH_IN(BenchScene, voxel.particles), 8, 1e9,
     RUN("particles", "N",
         "Wanted particle count; of an octree, vertices of its finest cells; of a meshless body, "
         "of the lattice that carries its surface")},
    {"cell", BENCH_IN(BenchScene, voxel.cell), 1e-30, 1e30,
     RUN("cell", "SIZE", "Edge of a cell, in the mesh's units")},
    RANGED(BenchScene, cells, 1, 1e9,
           "Wanted cells of material; one of particles, cell and cells must be given"),
    {"engine", BENCH_IN(BenchScene, engine), .choices_of = bench_engine_names,
     SAYS("What simulates the body")},
    {"w", BENCH_IN(BenchScene, params.w), 1, SM_MOST_W,
     SAYS("Half-width of a lattice's regions, in cells")},
    {"h", BENCH_IN(BenchScene, params.h), 1e-9, 10, RUN("h", "S", "Time step, seconds")},
    {"damping", BENCH_IN(BenchScene, params.damping), 0, 1,
     RUN("damping", "K",
         "Region damping, 0 to 1 (fastlsm eq. 14); of a meshless body the share of its speed that "
         "a step takes, below 1")},
    {"damping_every", BENCH_IN(BenchScene, params.damping_every), 1, 1000000,
     SAYS("Damp in every n-th step only")},
    {"gravity", BENCH_IN(BenchScene, params.gravity), -FAR, FAR,
     RUN("gravity", "X,Y,Z", "Mesh units per second squared")},
    {"strain_limit", BENCH_IN(BenchScene, params.strain_limit), 0, 1e6,
     RUN("strain-limit", "S",
         "Links break beyond this times their length, above 1; 0: never. The surface comes apart "
         "with them, except of the engine brute")},
    {"summation", BENCH_IN(BenchScene, params.summation), BENCH_CHOICES(bench_summations),
     RUN("summation", "HOW", "Sums over regions: %s")},
    {"polar", BENCH_IN(BenchScene, params.polar), BENCH_CHOICES(bench_polars),
     RUN("polar", "HOW", "Rotations of regions: %s")},
    {"layout", BENCH_IN(BenchScene, params.layout), BENCH_CHOICES(bench_layouts),
     BENCH_OPTION("layout", "HOW", 1, BENCH_LAYOUT_HELP " (default: as the scene says)")},
    {"epsilon", BENCH_IN(BenchScene, octree.epsilon), 0, 1e6,
     OCTREE("epsilon", "E",
            "regions hold all that is within w of their node, and none beyond (1 + E) w (default "
            "for a mesh: 0.5)")},
    {"octree", BENCH_IN(BenchScene, octree), .table = octree_table,
     SAYS("The octree's own settings. Finest cells are those that particles, cell or cells ask "
          "for")},
    {"meshless", .kind = BENCH_SET_GROUP, .table = meshless_table,
     SAYS("Settings of the engines meshless and shell")},
    {"collide", BENCH_IN(BenchScene, params.collide), .table = collide_table,
     SAYS("Collisions beside those with obstacles")},
    LENGTH(BenchScene, density,
           "Kg a cubic unit; 0: every particle has mass 1, those at a lattice's surface, too, "
           "which makes it stiffer than with a density (`calibrate --help`)"),
    MEMBER(BenchScene, vertex_mass,
           "Text file with a mass in kg for each mesh vertex, one a line; the nearest vertex wins"),
    RANGED(BenchScene, instances, 1, 1000000,
           "Copies of the body, in rows on the ground, that share the lattice"),
    UPTO(BenchScene, spacing, "Distance between them, in widths of the body"),
    {"steps_per_frame", BENCH_IN(BenchScene, steps_per_frame), 1, 1000000,
     BENCH_OPTION("steps", "N", 2, "Steps in a frame"), .who = BENCH_BY_RUN},
    {"frames", BENCH_IN(BenchScene, frames), 0, 10000000,
     BENCH_OPTION("frames", "N", 2, "Frames after the first"), .who = BENCH_BY_RUN},
    RANGED(BenchScene, settle, 0, 1000000, "Steps before the state that `tables` times"),
    RANGED(BenchScene, bend, -100, 100,
           "Initial deformation: bent about z by this angle from foot to head, radians"),
    RANGED(BenchScene, twist, -100, 100, "Turned about y by this angle, radians"),
    RANGED(BenchScene, squash, -10, 10, "Shortened by this share of its height"),
    RANGED(BenchScene, kick, 0, 100,
           "Random initial velocity of each particle, cells a step, from --seed"),
    {"handles", LIST(scene.handle, scene.handle_count), .table = handle_table,
     SAYS("Particles that follow a rigid motion; without any they are pinned. Of a meshless body, "
          "`tables` binds position and orientation of the point in their middle")},
    {"forces", LIST(scene.force, scene.force_count), .table = force_table,
     SAYS("Forces on particles")},
    {"cuts", LIST(scene.cut, scene.cut_count), .table = cut_table,
     SAYS("A blade, a segment, moves evenly and cuts what it crosses; a meshless body in seconds a "
          "frame, and not through what a handle holds. With 'start' 0 and a 'stop' that is shorter "
          "than a "
          "step it leaves a crack that was there")},
    {"touches", LIST(scene.touch, scene.touch_count), .table = touch_table,
     SAYS("Octree: a finger on an instance, around which it is refined")},
    {"view", BENCH_IN(BenchScene, view), .table = view_table,
     SAYS("Octree: an eye, near which it is refined")},
    {"planes", LIST(plane, planes), .table = plane_table,
     SAYS("Obstacles: material stays outside. Friction is the share of tangential velocity lost")},
    {"spheres", LIST(ball, balls), .table = ball_table, SAYS("The same: balls")},
    {"boxes", LIST(box, boxes), .table = box_table, SAYS("Boxes along the axes")},
    {"capsules", LIST(capsule, capsules), .table = capsule_table,
     SAYS("Balls swept along a segment")},
    {0},
};
