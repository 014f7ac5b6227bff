/* foot_search.h - the feet of a block's points at once (foot.h), of the instruction set in use
 * (lib/isa.h): points are what vectors hold. */
#ifndef REF_FOOT_SEARCH_H
#define REF_FOOT_SEARCH_H

#include "../motion/frame_sums.h"

enum { REF_FOOT_MOST_STEPS = 12 /* of Newton's */ };

/* How near offsets lead to a point, as a share of twice a cell's length. */
#define REF_FOOT_NEAR 1e-7

/* How much of the reach offsets may be: where they are all of it, they are within, however that was
 * rounded. */
#define REF_FOOT_WITHIN (1 + 1e-9)

/* Points beside a surface. */
typedef struct {
    double x[3][REF_SKIN_ROOM];
    double from[2][REF_SKIN_ROOM];      /* their parameters, from those of a sample */
    double edge[2][REF_SKIN_ROOM];      /* of their cells: the most that offsets are */
    double place[3][3][REF_SKIN_ROOM];  /* there, and its two slopes, */
    double normal[3][3][REF_SKIN_ROOM]; /* and of normals */
    double offset[3][REF_SKIN_ROOM];    /* to the foot: along the parameters and up the normal */
} RefFootPoints;

typedef struct {
    /* Places and normals of `count` points from `first` on, by Taylor's series from a sample: sums
     * with its functions' parts, of places, then of normals. Of points that follow, fewer than
     * REF_SKIN_SHARED, places and normals are undefined then. */
    void (*expand)(const double sum[6][REF_FRAME_SLOPES], int first, int count,
                   RefFootPoints *points);

    /* The offsets of the first `count` points, as ref_foot_offsets() has them; what is undefined
     * of others does not matter. */
    void (*find)(int count, RefFootPoints *points);

    /* What a sample's parts are to be multiplied by for the functions that move these points. */
    void (*series)(int count, const RefFootPoints *points, double times[6][REF_SKIN_ROOM]);
} RefFootSearch;
extern RefFootSearch ref_foot_search;

#endif
