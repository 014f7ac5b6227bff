/* collide_hash.h - a spatial hash of points (Teschner et al. 2003): cubes of one width, by a hash
 * of their coordinates.
 *
 * Filled anew each time: points are noted, then sorted by their cube. Cubes that share a place in
 * the table are told apart by their coordinates, so a query meets every point of its box's cubes
 * once and no other, in an order that depends only on the order in which points were added. */
#ifndef SM_COLLIDE_HASH_H
#define SM_COLLIDE_HASH_H

typedef struct {
    double x[3];
    int cube[3];
    int item;
} SmCollideEntry;

/* Zeroed to begin with. Nothing is allocated once it has held as many points. */
typedef struct {
    double inverse; /* 1 / width of a cube */
    long count, room;
    unsigned mask;         /* table's size less 1 */
    int *start;            /* [mask + 2] first entry of every place */
    unsigned *place;       /* [room] */
    SmCollideEntry *noted; /* [room] in the order of adding */
    SmCollideEntry *entry; /* [room] by place */
    unsigned table_room;
} SmCollideHash;

/* A walk over rows of cubes along x. */
typedef struct {
    int low[3], high[3]; /* cubes of the box */
    int x, row[2];       /* where in it */
    int from, to;        /* cubes of the row whose places are looked at together */
    int at, end;         /* their entries */
} SmCollideQuery;

/* Empties it, for at most `most` points in cubes of that width. */
void sm_collide_hash_start(SmCollideHash *hash, long most, double width);
/* Coordinates are within some 10^9 widths; one that is not finite goes into no query's box. */
void sm_collide_hash_add(SmCollideHash *hash, long item, const double x[3]);
void sm_collide_hash_finish(SmCollideHash *hash);
void sm_collide_hash_free(SmCollideHash *hash);
long sm_collide_hash_bytes(const SmCollideHash *hash);

/* Walks over the points of all cubes that the box from low to high meets. */
void sm_collide_hash_query(const SmCollideHash *hash, const double low[3], const double high[3],
                           SmCollideQuery *query);

/* The next point, or NULL. */
const SmCollideEntry *sm_collide_hash_next(const SmCollideHash *hash, SmCollideQuery *query);

#endif
