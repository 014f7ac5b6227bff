/* fields.h - what a trajectory stores of every point of the moving surface beside its place. */
#ifndef BENCH_FIELDS_H
#define BENCH_FIELDS_H

#include "playback.h"

typedef enum {
    BENCH_DISPLACEMENT, /* from the place at rest: a vector, mesh units */
    BENCH_SPEED,        /* of the surface as the last step's velocities carry it, mesh units/s */
    BENCH_STRAIN,       /* see bench_strain() */
    BENCH_PIECE,        /* number, from 0, of the piece of material that carries it */
    BENCH_LEVEL,        /* of the octree's leaf that it belongs to; 0: a base cell */
    BENCH_POINT_FIELDS
} BenchPointField;

/* Names, in the order above, with NULL at the end; and numbers a point. */
extern const char *const bench_field_names[];
extern const int bench_field_components[];

/* A set of fields: bit f is field f. */
typedef unsigned BenchFields;

/* SM_USAGE where the play has none of them: levels without an octree, and of points without
 * triangles anything but their displacement. */
SmCode bench_fields_check(const BenchPlayback *play, BenchFields fields, SmError *error);

/* The fields in question now, into value[f], [vertices * components]; `rest` is
 * bench_playback_surface(), `point` bench_playback_points(). */
void bench_fields_find(BenchPlayback *play, BenchFields fields, const SmMesh *rest,
                       const double (*point)[3], float *const value[BENCH_POINT_FIELDS]);

/* The largest share by which a triangle is longer or shorter than at rest, of all directions in its
 * plane, as the mean of a vertex's triangles by their area at rest. */
void bench_strain(const SmMesh *rest, const double (*point)[3], float *strain);

#endif
