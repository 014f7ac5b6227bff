/* points.h - oriented points: what a meshless body is made of. */
#ifndef REF_POINTS_H
#define REF_POINTS_H

#include "../../../lib/mesh/mesh.h"

enum { REF_LEAST_POINTS = 50, REF_MOST_POINTS = 10000000 };

typedef struct {
    long count;
    double (*position)[3]; /* [count], all different */
    double (*normal)[3];   /* [count] outwards, unit length */
    long merged;           /* points dropped at a position that was there already */
    long given;            /* points as they were given: all of them, in their order */
    double (*as_given)[3]; /* [given] */
} RefPoints;

/* Copies points, also as they were given; of the others such at one position become one, whose
 * normal is the mean, and those without a normal (of length zero) are dropped. `name` is for
 * messages. The caller frees. Errors (SM_INPUT): numbers that are not finite or beyond 1e30,
 * normals whose length is not 1 to within a half (columns that are colours, say), fewer than
 * REF_LEAST_POINTS that are left, and such that span less than 1e-30. O(n log n). */
SmCode ref_points_create(long count, const double (*position)[3], const double (*normal)[3],
                         const char *name, RefPoints *points, SmError *error);
void ref_points_free(RefPoints *points);

/* Reads the points of a PLY file, or of another mesh file without triangles; or text: a point a
 * line, x y z nx ny nz and perhaps more, which is not read; empty lines and lines that begin with #
 * are skipped, and the first line may be their count. Text is what ends in .xyz, .pts, .pwn, .asc
 * or .txt. Errors (SM_INPUT): those above; those of reading (lib/mesh/reader.h). */
SmCode ref_points_read(const char *path, RefPoints *points, SmError *error);

/* All rows of such a file, a position and a normal each, for the caller to free. With `bare`
 * they may have no normals: theirs are zero. Errors:
 * reading's, and ref_points_create()'s of numbers and normals; SM_INPUT, without `bare`, where no
 * point has a normal. */
SmCode ref_points_rows(const char *path, bool bare, long *count, double (**position)[3],
                       double (**normal)[3], SmError *error);

/* Whether ref_points_read() takes the file for text. */
bool ref_points_text(const char *path);

/* About `count` points spread evenly over a mesh's triangles, with their normals. The mesh has
 * passed sm_mesh_check() and is closed and oriented, or nearly. Deterministic. Errors: those of
 * creating. */
SmCode ref_points_of_mesh(const SmMesh *mesh, long count, RefPoints *points, SmError *error);

#endif
