/* skin.h - the surface of a body that an engine simulates: carried by the lattice's particles or
 * the octree's nodes, and kept up to date with what cuts and resampling do to them. */
#ifndef SM_SKIN_H
#define SM_SKIN_H

#include "../../octree/engine.h"
#include "../../octree/surface/surface.h"
#include "../cut/blade.h"
#include "../cut/tear.h"
#include "../voxel/embed.h"

typedef struct {
    /* the caller's, kept */
    const SmEngineType *type;
    SmEngine *engine;
    const SmVoxels *voxels;
    long instances;
    const double (*x0)[3]; /* [particles] at rest, of a lattice that can be cut */

    bool octree;           /* nodes carry it, not particles */
    SmMesh surface;        /* of one body at rest, with all cuts; without vertices: none */
    OctSurface carried;    /* what carries it: an octree's nodes, */
    SmEmbedding embedding; /* or a lattice's particles; none where particles are its vertices */
    SmCut cut;             /* of a lattice; an octree's structure has its own */
    SmSites sites;         /* of a lattice that can be cut */
    bool breaks;           /* its links break by strain, too: */
    long links;            /* as many were left when it was last looked, */
    SmTear tear;           /* and these */
    bool drawn;            /* the engine makes the surface (engine.h, surface()) */
    bool incomplete;       /* a cut did not split the surface: it could not be done cleanly */
    /* scratch: nodes as the engine counts them; by leaf or particle number */
    double (*node)[3];
    double (*rest)[3], (*x)[3], (*F)[9];
    unsigned char *found, *absent;
    long room;
    OctReach search;
} SmSkin;

/* Ties `surface`, which becomes the skin's, to the engine's body, which is as it was created. `x0`
 * are a lattice's particles at rest, before the pose of any instance, if it is to be cut or to
 * break by `strain_limit` (engine.h); else NULL. O(vertices). */
void sm_skin_create(const SmEngineType *type, SmEngine *engine, const SmVoxels *voxels,
                    long instances, const double (*x0)[3], double strain_limit, SmMesh surface,
                    SmSkin *skin);
void sm_skin_free(SmSkin *skin);

/* What carries the material near a blade whose ends move from blade[0], blade[1] to blade[2],
 * blade[3], for sm_blade_sweep(). Of a lattice, gradients are the least-squares fit to the
 * neighbours that no cut parts; one instance. Valid until the body changes or the next call here;
 * sm_skin_carried() ends its search. O(nodes) for a look at each. */
SmCarriers sm_skin_carriers(SmSkin *skin, const double blade[4][3]);
void sm_skin_carried(SmSkin *skin);

/* Triangles of the body's cut so far. */
long sm_skin_cut_triangles(const SmSkin *skin);

/* The surface after an octree has changed, with the cut's triangles from number `first` on new. */
void sm_skin_follow(SmSkin *skin, const OctChange *change, long first);

/* Adds to skin->cut what a lattice's strain has torn since the last call here or after a cut
 * (tear.h); comes before a cut. Returns whether any link has broken: then sm_skin_follow_cut() is
 * to follow, whether or not the cut has grown. O(particles), and O(links) where some have. */
bool sm_skin_tear(SmSkin *skin);

/* The same as sm_skin_follow() after a lattice has been torn or cut by the triangles of skin->cut
 * from number `first` on. */
void sm_skin_follow_cut(SmSkin *skin, long first);

/* The surface as the engine draws it now; false where it is what it was. */
bool sm_skin_draw(SmSkin *skin);

/* The surfaces of all instances, and unit normals unless NULL: [instances * vertices]. `node` are
 * places of what carries them, as the engine counts them; NULL: where these are now. */
void sm_skin_points(SmSkin *skin, const double (*node)[3], double (*point)[3], double (*normal)[3]);

/* Pieces of one body's material by particle, of an octree by leaf. The caller frees. */
void sm_skin_pieces(const SmSkin *skin, SmPieces *pieces);

/* The leaf or particle that a vertex belongs to. */
int sm_skin_carrier(const SmSkin *skin, long vertex);

#endif
