/* torn_surface.h - the triangles of a surface that a cracked shell carries. They come apart where a
 * crack passes between two of them, and where they move with different pieces: a vertex that is on
 * several sides then has a copy for each but the one it lies on. Where cracks leave no node,
 * triangles are crumbs, which are left out. What is drawn are two sheets, a thickness apart, closed
 * along edges where the surface has come apart or ends (meshless section 4.2 says that surface
 * points are split, too). */
#ifndef REF_TORN_SURFACE_H
#define REF_TORN_SURFACE_H

#include "../../../lib/mesh/mesh.h"
#include "cracked.h"
#include "foot.h"

typedef struct {
    long vertices, triangles;
    const int (*whole)[3];    /* [triangles] the caller's, as are */
    const double (*theta)[2]; /* [vertices] their parameters, in the chart's rectangle, */
    const double (*rest)[3];  /* [vertices] and their places at rest */
    int (*beside)[3];         /* [triangles] the triangle across the edge from corner k on, or -1 */
    double (*middle)[2];      /* [triangles] where a triangle is, */
    double (*place)[3][2];    /* [triangles] and where its corners and the middles of those beside
                                 it are in the plane of that */
    double (*next)[3][2]; /* themselves; its own place of one behind a zero, or farther than ways
                             are followed: pieces alone part it from that */
    int (*corner)[3];     /* [triangles] vertices, and behind them copies */
    bool (*open)[3];      /* [triangles] edges from corner k on along which nothing is */
    bool *crumb;          /* [triangles] no node moves it: it is not drawn */
    long copies, room, eye_room, seen_room;
    int *of;           /* [copies] the vertex */
    double (*eye)[2];  /* [copies] where it is seen from, */
    double (*seen)[2]; /* [copies] and where it is in the plane of that */
    long open_edges, crumbs;
} RefTornSurface;

/* Whole at first. The arrays have to live as long. The caller frees. O(triangles log triangles). */
void ref_torn_create(const RefChart *chart, long vertices, long triangles, const int (*triangle)[3],
                     const double (*theta)[2], const double (*rest)[3], RefTornSurface *torn);
void ref_torn_free(RefTornSurface *torn);

/* As the cracks are now; returns whether there are other copies than before. O(triangles * cracks
 * near them). */
bool ref_torn_update(RefTornSurface *torn, const RefCracked *cracked);

/* What is drawn: the outer sheet's vertices, its copies, then the same of the inner sheet; all
 * places are zero. The caller frees. */
SmMesh ref_torn_mesh(const RefTornSurface *torn);

/* Their places, [2 (vertices + copies)], `outer` those of the vertices: copies move with the
 * functions on their side, or without `warp` are at rest, and the inner sheet is a thickness below
 * the outer one. O(triangles + copies * covers). */
void ref_torn_place(const RefTornSurface *torn, const RefCracked *cracked, const RefWarp *warp,
                    const double (*outer)[3], double thickness, double (*point)[3]);

#endif
