/* skin.h - surface points carried by a meshless body: their shape functions, computed once.
 *
 * Points are grouped by octant or by a shell's cell into blocks that share their nodes, so that a
 * block's weights are a dense matrix and a frame reads nothing but weights. They are single
 * precision: positions are good to 1e-6 of the displacements. */
#ifndef REF_SKIN_H
#define REF_SKIN_H

#include "../body/body.h"

enum {
    REF_SKIN_LANES = 16,                             /* points that are placed at once */
    REF_SKIN_BLOCK = 64,                             /* points of a block at most */
    REF_SKIN_SHARED = 8,                             /* points that are weighed at once */
    REF_SKIN_ROOM = REF_SKIN_BLOCK + REF_SKIN_SHARED /* where whole vectors may begin anywhere */
};

typedef struct {
    int points, room; /* room: points rounded up to whole vectors */
    int nodes;
    long first, node, weight; /* where its points, nodes and weights begin */
} RefSkinBlock;

typedef struct {
    long count;        /* points */
    long *order;       /* [count] the caller's number of each, in the skin's order */
    double (*rest)[3]; /* [count] in the skin's order */
    long blocks;
    RefSkinBlock *block;
    int *node;
    float *weight; /* block by block, [room / REF_SKIN_LANES][nodes][REF_SKIN_LANES] */
    float *lift;   /* [count + REF_SKIN_LANES] how far points are off a shell's surface along its
                      normal; or NULL */
    long nodes, node_room, weights, weight_room; /* how many there are */
    float (*near)[3]; /* scratch: displacements of a block's nodes, and how their normals turn */
} RefSkin;

/* Weights of points one after the other which are sums of the same parts: at point p, node n has
 * the sum over m of times[m][p] part[n][m]. */
typedef struct {
    int first, points, nodes;
    const int *node;
    const double (*part)[6];
} RefSkinShare;

/* Those of a block, rising; points may be in none. */
typedef struct {
    int count;
    RefSkinShare share[REF_SKIN_BLOCK];
    double times[6][REF_SKIN_ROOM];
    double lift[REF_SKIN_ROOM];
} RefSkinShares;

/* What carries points: their cells, and the weights of the nodes that move each of them; false
 * where there are too few. */
typedef struct {
    const void *data;
    const RefNodes *nodes;
    long (*cell)(const void *data, long point);
    bool (*weigh)(const void *data, long point, RefShape *shape, double *lift);
    int (*nearest)(const void *data, long point); /* the node that moves a point then */
    /* May be NULL, as may be the next: where in its cell a point is, by which points are sorted
     * that share parts. */
    int (*place)(const void *data, long point);
    /* The weights of those of a block's points, which are at x, that share parts; others are
     * weighed alone. */
    void (*share)(const void *data, int count, const long *point, const double (*x)[3],
                  RefSkinShares *shares);
} RefSkinCarrier;

/* `lifted`: points of a shell. */
void ref_skin_build(const RefSkinCarrier *carrier, bool lifted, long count, const double (*x)[3],
                    RefSkin *skin, long *loose);

/* Weighs all points again, in the same blocks. `loose` as below. */
void ref_skin_renew(const RefSkinCarrier *carrier, RefSkin *skin, long *loose);

/* Points that too few nodes cover move with the node nearest to them, if there is one on their side
 * of cracks with that; `loose` (may be NULL) receives how many there are: none of those that
 * ref_body_build() was shown. */
void ref_skin_create(const RefBody *body, long count, const double (*x)[3], RefSkin *skin,
                     long *loose);
void ref_skin_free(RefSkin *skin);

/* The points' positions, in the skin's order, from the nodes' displacements (motion.h, moved), and
 * of lifted points from how the normals there have changed (warp.h, turned); else NULL. */
void ref_skin_place(const RefSkin *skin, const double (*moved)[3], const double (*turned)[3],
                    double (*position)[3]);

/* Adds to the nodes what a push at the skin's point `place` does to them. O(log blocks + nodes). */
void ref_skin_push(const RefSkin *skin, long place, const double push[3], double (*nodes)[3]);

#endif
