/* elastic.h - a scene's body as Table 1 of Guo and Qin has it: points on its surface, the function
 * that they give, a meshless body, its free modes, their motion, and the points carried by it.
 *
 * A frame is one implicit step and all points' new positions. Each of the scene's handles binds
 * position and orientation of one of the points that it selects, the nearest to their middle
 * (meshless section 5.3.3); of what else moves a scene there is only gravity. The scene's lattice
 * plays no part. */
#ifndef BENCH_ELASTIC_H
#define BENCH_ELASTIC_H

#include "../../reference/meshless/motion/motion.h"
#include "../../reference/meshless/motion/skin.h"
#include "../scene/body.h"

typedef struct {
    const BenchScene *scene; /* the caller's, kept */
    RefMaterial material;    /* in mesh units */
    RefBody body;
    RefModes modes;
    RefMotion motion;
    RefSkin skin;
    double (*carried)[3]; /* [skin.count] the points now, in the skin's order */
    double (*held)[3];    /* [scene->handle_count] what each handle binds, at rest */
    double time;          /* s since the start */
    double field_seconds, matrix_seconds, mode_seconds, skin_seconds; /* what was built in */
} BenchElastic;

/* At rest. Errors: SM_INPUT, a scene with obstacles,
 * collisions, forces, cuts, touches, an eye, several instances or an initial deformation; a handle
 * that selects nothing, or another one's point; and those of points, field, body and modes. */
SmCode bench_elastic_create(const BenchScene *scene, const BenchBody *of, BenchElastic *elastic,
                            SmError *error);
void bench_elastic_free(BenchElastic *elastic);

/* One frame; the motion is the lap SM_SHAPE_MATCHING, the points are SM_OTHER. */
void bench_elastic_step(BenchElastic *elastic, SmLaps *laps);

/* Bytes that a frame reads or writes. */
long bench_elastic_bytes(const BenchElastic *elastic);

#endif
