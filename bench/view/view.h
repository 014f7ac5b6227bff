/* view.h - what the page asks of the engines: one scene, simulated by FastLSM and by another engine
 * side by side, and pulled by hand in both.
 *
 * The page calls these by number and pointer (WebAssembly knows no structs): a side is 0, FastLSM,
 * or 1, the octree; of a scene for the engine meshless or shell 1 is that. Pointers stay valid
 * until the next call that steps, changes or opens. Nothing here aborts on what a user types:
 * view_open() says what is wrong. */
#ifndef BENCH_VIEW_H
#define BENCH_VIEW_H

enum { VIEW_LATTICE, VIEW_OTHER, VIEW_SIDES };

/* Built-in scenes that can be opened: names, number 0 and up, NULL past the last; and the text of a
 * scene's file. */
const char *view_scene_name(int number);
const char *view_scene_text(const char *name);

/* Room for `bytes` of text, which the page fills before view_open(). */
char *view_room(int bytes);
char *view_text(void); /* that room again */

/* Reads the text in that room as a scene file, and makes both sides anew, at rest and then
 * disturbed as it says. With `keep` positions and velocities go on where both sides' bodies are of
 * as many particles as before, and none is cut or broken. 0; or else nothing has changed, and
 * view_message() is the line that says why. */
int view_open(int bytes, int keep);
const char *view_message(void);

/* The name of the engine that a side is for, be it there or not; "" where nothing is open. */
const char *view_engine(int side);

/* The line that says why this side is not there; "" of one that is. At least one is. */
const char *view_absent(int side);

/* Steps, and what the scene does meanwhile. Does nothing on a side that is not there, as all below.
 */
void view_step(int side, int steps);

/* Figures of a side. */
enum {
    VIEW_PARTICLES, /* of the octree, of an elastic body and of a shell simulation nodes */
    VIEW_REGIONS,
    VIEW_LINKS, /* of FastLSM */
    VIEW_BROKEN,
    VIEW_CONTACTS,
    VIEW_SUMMATION_NODES, /* per region, of the octree */
    VIEW_BUILD_MS,        /* that making it took here */
    VIEW_TIME,            /* s simulated */
    VIEW_STEPS,
    VIEW_KINETIC,  /* energy, J for masses in kg */
    VIEW_MOMENTUM, /* length of it */
    VIEW_CELL,     /* edge of a finest cell */
    VIEW_H,        /* time step, s */
    VIEW_STEPS_PER_FRAME,
    VIEW_PIECES, /* that a shell was in when its surface was last found; NaN of others */
    VIEW_FIGURES
};
double view_figure(int side, int figure);

/* Milliseconds a step of each of the five stages (lib/engine/stage.h), of the first and of every
 * eighth step since view_clear_stages(); NaN: there was none. Less what reading the clock takes at
 * best, which a browser's coarse one does not say: there stages of many laps look longer. */
double view_stage_ms(int side, int stage);

/* What the side's engine calls the stage; NULL: it has no such. */
const char *view_stage_name(int side, int stage);

/* The percentage of a step that this engine's paper gives for the stage in the scene that is open;
 * NaN: none. */
double view_paper_percent(int side, int stage);
void view_clear_stages(int side);

/* The surface now: all instances, one after the other. view_surface() finds points and normals
 * anew, and returns a number that changes when vertices or triangles have. */
int view_surface(int side);
int view_vertices(int side); /* of all instances */
int view_triangles(int side);
const float *view_points(int side);  /* [vertices][3] */
const float *view_normals(int side); /* [vertices][3], unit */
const int *view_indices(int side);   /* [triangles][3] */

/* Bounding box of what is drawn at first, low and high corner: [6]. */
const double *view_bounds(void);

/* The scene's obstacles: 8 numbers each: kind (0 plane, 1 sphere, 2 box, 3 capsule), a, b, radius
 * as in lib/engine/boundary.h. */
int view_obstacles(void);
const double *view_obstacle(int number);

/* Takes hold of the material around vertex number `vertex` of a side within `radius` of it, of one
 * body, on both sides at the same place of the body; the grip's number, or -1 where nothing can be
 * held. Then moves it, in the steps that follow, by what has been dragged from where it was
 * grabbed; or lets it go. A grip that is not moved is a pin. */
int view_grab(int side, int vertex, double radius);
void view_drag(int grip, double x, double y, double z);
void view_release(int grip);
const double *view_grip(int side, int grip); /* where its middle is now, [3]; NULL: released */

/* What else hands do (tools.h). Bodies are made for it: what is allowed, a cut, or a touch of body
 * number `instance`, holds from the next view_open() on, in which motion goes on with `keep`, until
 * one without it. `view_may_...`: is it so now? Only of a body alone can be cut, only on an octree
 * touched. */
void view_allow_cut(void);
void view_allow_touch(int instance);
int view_may_cut(int side);
int view_may_touch(int side, int instance);

/* The blade of both sides, moved at once to the segment from a to b; then taken out. How many sides
 * it may cut: none of one that has been cut into so much that each cut would take seconds. */
int view_cut(double ax, double ay, double az, double bx, double by, double bz);
void view_lift(void);

/* The body that a vertex of a side belongs to, or -1. */
int view_body(int side, int vertex);

/* Touches the octree's body where the side's vertex is at rest, until another place is touched or
 * it is left. */
void view_touch(int side, int vertex, double radius);
void view_leave(void);

/* The wind on both sides: an acceleration, m/s^2. */
void view_blow(double x, double y, double z);

#endif
