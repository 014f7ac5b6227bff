/* side.h - one of the two bodies that the page shows: a scene played by one engine, what of it is
 * drawn, and what is held of it. */
#ifndef BENCH_SIDE_H
#define BENCH_SIDE_H

#include "../../reference/meshless/shell_engine.h"
#include "grips.h"
#include "tools.h"

typedef struct {
    BenchScene scene;
    BenchPlayback play; /* group NULL: the side is not there, as `absent` says */
    SmError absent;
    ViewGrips grips;
    ViewTools tools;
    long steps; /* in all */
    long timed,
        untimed; /* since the laps were cleared, and how many come before the next that is */
    double lap[SM_STAGES]; /* seconds of those timed */
    long laps[SM_STAGES];
    double build_seconds;

    int generation;                   /* of vertices and triangles */
    long vertices, triangles, pieces; /* of a shell alone it is asked in how many it is */
    double (*place)[3], (*normal)[3]; /* [vertices] scratch */
    float *point32, *normal32;        /* [vertices][3] */
    int *index;                       /* [triangles][3] */
} ViewSide;

/* Plays the scene with `engine` on the body, as near to what it says as that engine can: what it
 * does not do is left out (touches, creep, a strain limit), and of what hands are `allowed`, too.
 * The scene is copied, the body kept. Where the engine refuses, the side is absent. */
void view_side_create(const BenchScene *scene, const BenchBody *body, const char *engine,
                      const ViewAllowed *allowed, ViewSide *side);
void view_side_free(ViewSide *side);

/* Pushes each body as hard in all as `own` does, the side of the engine that the scene is for: its
 * forces are newtons a particle, of that engine's. Nothing where either is absent. */
void view_side_push_as(ViewSide *side, const ViewSide *own);

bool view_side_is_there(const ViewSide *side);

/* The elastic body or the shell that the side plays; NULL: it plays no such. */
RefElastic *view_side_elastic(const ViewSide *side);
RefShellBody *view_side_shell(const ViewSide *side);

/* The side of this number (view.h) if it is open and there, or NULL. */
ViewSide *view_side_of(int number);

/* May another side go on where this one is? Not where material has been cut or has broken. */
bool view_side_is_whole(const ViewSide *side);

/* Has it bodies of as many particles and nodes as another side, of the same engine? A shell that
 * may break is like no other: where it is cannot be told to one. */
bool view_side_is_like(const ViewSide *side, const ViewSide *other);

/* Positions, velocities and time of another side that it is like. */
void view_side_go_on(ViewSide *side, const ViewSide *from);

/* Steps, with the scene's changes before those of each frame. What is held follows the hands in
 * even parts, so that it has their velocity when it is let go. */
void view_side_step(ViewSide *side, int steps, const ViewHand *hand);

/* Moves the blade, at once (tools.h), and finds what hands hold again; false: it may not cut, or
 * has made so many triangles already that it would take seconds. */
bool view_side_cut(ViewSide *side, const double a[3], const double b[3], const ViewHand *hand);

/* The body and the place at rest of a vertex that is drawn; false: there is none such. */
bool view_side_vertex(const ViewSide *side, long vertex, long *instance, double rest[3]);

/* Points and normals as they are now. */
void view_side_draw(ViewSide *side);

/* Kinetic energy and the length of the momentum. O(particles). */
void view_side_motion(const ViewSide *side, double *energy, double *momentum);

#endif
