/* triangulate.h - fills a plane outline, which may have holes, with triangles. */
#ifndef SM_TRIANGULATE_H
#define SM_TRIANGULATE_H

/* Rings of points: ring r is at[first[r]] .. at[first[r + 1] - 1], each point once. The first goes
 * round its outside counter-clockwise, the others are holes in it and go clockwise. */
typedef struct {
    int rings;
    const int *first; /* [rings + 1] */
    const double (*at)[2];
} SmOutline;

/* Triangles that an outline of that many points and rings is filled with, at most. */
static inline long sm_triangulate_most(int points, int rings)
{
    return (long)points + 2L * (rings - 1) - 2;
}

/* Fills the outline with triangles of three of its points, counter-clockwise, without others;
 * `triangle` has room for sm_triangulate_most(). Best shaped ears go first. What rounding has bent
 * by less than `slack` still counts as straight: of that some triangles may have no area, and where
 * rings touch there may be fewer of them. Their number, or -1, where rings
 * cross. O(points^2) and more where ears are rare; allocates. */
long sm_triangulate(const SmOutline *outline, double slack, int (*triangle)[3]);

#endif
