/* inner.h - what is behind the handles of shapebench.h, and how their functions check arguments. */
#ifndef SM_INNER_H
#define SM_INNER_H

#include "../../octree/change/refinement.h"
#include "../cut/blade.h"
#include "../mesh/reader.h"
#include "../voxel/voxelise.h"
#include "shapebench.h"
#include "skin.h"

struct sb_mesh {
    SmMesh mesh;
    SmMeshLeftOut left_out; /* of its file */
};

struct sb_voxels {
    SmVoxels voxels;
    SmVoxelReport report;
};

/* A blade, and down to which level an octree's cells within reach of its cut are split. */
typedef struct {
    SmBlade blade;
    int level;
    double reach;
} SbBlade;

typedef struct {
    bool gone; /* was removed */
    SmObstacle obstacle;
} SbObstacle;

#define SB_FAR 1e9 /* cells: farther off, or faster in a step, is a mistake */

struct sb_body {
    const SmEngineType *type;
    SmEngine *engine;
    long bytes; /* that it took when it was made */
    SmVoxels voxels;
    SmSkin skin;
    double (*x0)[3]; /* [particles] of a lattice that can be cut, or NULL */
    int threads;
    double h;
    int64_t steps;
    long particles, instances;
    /* what was added, by number; handles that were removed have no particles */
    int handle_count, obstacle_count, blade_count, detail_count;
    SmHandle *handle; /* their particles are the body's */
    SbObstacle *obstacle;
    SbBlade *blade;
    OctRefinement *detail;
    bool bind; /* handles or obstacles are to be given to the engine */
};

/* Checks of arguments: SB_OK, or SB_USAGE and a line. Arrays may be NULL where nothing is wanted of
 * them; of numbers, NaN is out of every range. */
int sm_check_given(const void *pointer, const char *name, sb_error *error);
/* The same of where a call leaves what it creates: *result is NULL from here on. */
int sm_begin(void *result, const char *name, sb_error *error);
int sm_check_finite(const double *value, int64_t count, double most, const char *name,
                    sb_error *error);
int sm_check_array(const void *array, int64_t room, int64_t wanted, const char *name,
                   sb_error *error);
/* A list of which at most `room` entries are written. */
int sm_check_list(const void *list, int64_t room, const int64_t *count, const char *name,
                  sb_error *error);
int sm_check_range(double value, double least, double most, const char *name, sb_error *error);

/* Asks the engine how many particles there are. */
void sm_count_particles(sb_body *body);

/* Ends a call: what went wrong inside, or SB_OK. */
int sm_done(SmCode code, const SmError *from, sb_error *error);

/* Writes the line and returns the code. */
int sm_refuse(sb_error *error, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Ends a call that gives `count` entries of `size` bytes in an array with room for `room`. */
int sm_give_array(const void *from, int64_t count, size_t size, void *to, int64_t room,
                  const char *name, sb_error *error);

#endif
