/* face_clip.h - what is left of a face that others cut: its parts right of all segments. */
#ifndef SM_FACE_CLIP_H
#define SM_FACE_CLIP_H

#include "crossing.h"

/* The segments of every face, and working space. */
typedef struct {
    const SmCrossing *crossing;
    long *first;  /* [faces + 1] */
    int *segment; /* [first[faces]] */
    int *next;    /* [points] along the face in hand, or -1 */
    unsigned char *visited;
    double slack;
    /* outlines of the face in hand: rings of points in the shared numbering */
    int rings, ring_points, ring_room;
    int *ring_first, *ring_point;
    double (*at)[2]; /* [ring_points] seen along the face's largest normal component */
    bool *hole;
    long triangles, triangle_room;
    int (*triangle)[3]; /* what is left, of all faces so far, in the shared numbering */
} SmFaceClip;

typedef enum {
    SM_FACE_FILLED,
    SM_FACE_TORN,   /* segments end within the face, or meet more than two at a point */
    SM_FACE_FAILED, /* they cross, or rounding mixed up their order */
} SmFaceClipResult;

void sm_face_clip_init(const SmCrossing *crossing, double slack, SmFaceClip *clip);
void sm_face_clip_free(SmFaceClip *clip);

static inline bool sm_face_clip_crossed(const SmFaceClip *clip, long face)
{
    return clip->first[face] < clip->first[face + 1];
}

/* Appends the triangles that fill what is left of a crossed face, and says which of its corners
 * are left: kept[i]. */
SmFaceClipResult sm_face_clip_fill(SmFaceClip *clip, long face, bool kept[3]);

#endif
