/* grips.h - what hands hold of a scene that is played: material that follows them. */
#ifndef BENCH_GRIPS_H
#define BENCH_GRIPS_H

#include "../play/playback.h"

enum { VIEW_HANDS = 64 };

/* A hand, which holds the same of every body that is shown beside another. */
typedef struct {
    bool holds;
    long instance;          /* of which body, */
    double rest[3], radius; /* what is so near to a place of it before its pose; mesh units */
    double moved[3];        /* how far the hand has moved since */
} ViewHand;

/* What one group's engine holds for them. */
typedef struct {
    int count;
    SmHandle handle[VIEW_HANDS];
    int hand[VIEW_HANDS];        /* each handle's */
    double start[VIEW_HANDS][3]; /* its pose's translation before the hand moved */
} ViewHeld;

/* What a playback holds. */
typedef struct {
    int groups;
    ViewHeld *held;                 /* [groups] */
    double followed[VIEW_HANDS][3]; /* how far the material has followed each hand */
} ViewGrips;

/* Nothing is held. The playback is passed again with each call. */
void view_grips_create(const BenchPlayback *play, ViewGrips *grips);
void view_grips_free(ViewGrips *grips);

/* Holds what `hand`, [VIEW_HANDS], does; those that stay hold what they held, unless particles are
 * `anew`. O(particles). */
void view_grips_hold(ViewGrips *grips, BenchPlayback *play, const ViewHand *hand, bool anew);

/* Have particles been numbered anew, and so nothing is held? */
bool view_grips_are_lost(const ViewGrips *grips, const BenchPlayback *play);

/* Moves what is held by `share` of what it is behind its hand, in the next step. */
void view_grips_follow(ViewGrips *grips, const ViewHand *hand, double share);

/* Where the middle of a hand's material is; false: none is held. */
bool view_grips_middle(const ViewGrips *grips, const BenchPlayback *play, int hand,
                       double middle[3]);

#endif
