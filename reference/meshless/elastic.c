#include "elastic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The fewest points, of `least` and its doubles, that tell the mesh's sides apart; 0: too many. */
static long enough_points(const SmMesh *mesh, long least)
{
    for (long wanted = least; wanted <= REF_MESHLESS_MOST_POINTS; wanted *= 2) {
        RefPoints points;
        if (ref_points_of_mesh(mesh, wanted, &points, NULL) != SM_OK) return wanted;
        bool enough = ref_mpu_dense(&points);
        ref_points_free(&points);
        if (enough) return wanted;
    }
    return 0;
}

SmCode ref_meshless_field(const RefMeshlessOptions *options, RefMpu *mpu, SmError *error)
{
    RefPoints points;
    SmError why;
    long enough =
        enough_points(options->mesh, options->points > 0 ? options->points : REF_MESHLESS_POINTS);
    long wanted = options->points > 0 ? options->points : enough > 0 ? enough : REF_MESHLESS_POINTS;
    SmCode code = ref_points_of_mesh(options->mesh, wanted, &points, error);
    if (code != SM_OK) return code;
    code = ref_mpu_build(&points, NULL, mpu, &why);
    if (code == SM_OK) return code;
    if (enough > wanted)
        return sm_fail(
            error, code,
            "%ld points on its surface are too few to tell the sides of a body this thin "
            "apart: take %ld (run --points, or points in a scene's group meshless)",
            wanted, enough);
    return sm_fail(error, code, "%s", why.text);
}

SmCode ref_elastic_body(const RefMeshlessOptions *options, bool cuttable, long *count,
                        double (**x)[3], RefElastic *elastic, SmError *error)
{
    bool own = !*x; /* points: what is given beside the mesh plays no part */
    const RefMpu *given = own ? NULL : options->given;
    RefMpu *mpu = &elastic->mpu;
    double start = sm_now();
    SmCode code = given ? SM_OK : ref_meshless_field(options, mpu, error);
    if (code != SM_OK) return code;
    double built = sm_now();
    if (own) {
        *count = mpu->points.count;
        *x = sm_alloc((size_t)*count, sizeof **x);
        memcpy(*x, mpu->points.position, (size_t)*count * sizeof **x);
    }
    RefField field = ref_mpu_field(given ? given : mpu);
    RefBodyOptions body = {.nodes = options->nodes > 0 ? options->nodes : REF_MESHLESS_NODES,
                           .within = own ? 0.01 : 0,
                           .coarser = options->uniform ? 0 : 1,
                           .basis = options->basis == REF_MESHLESS_QUADRATIC ? REF_MLS_QUADRATIC
                                                                             : REF_MLS_LINEAR,
                           .material = options->material};
    code = ref_body_build(&field, &body, *count, (const double(*)[3]) * x, &elastic->body, error);
    elastic->field_seconds = built - start;
    elastic->matrix_seconds = sm_now() - built;
    if (cuttable)
        elastic->field = field;
    else
        ref_mpu_free(mpu);
    return code;
}

SmCode ref_elastic_modes(const RefMeshlessOptions *options, RefElastic *elastic, SmError *error)
{
    double start = sm_now();
    long most = 3 * elastic->body.nodes.count / 2;
    int wanted = options->modes > 0 ? options->modes : (int)fmin(REF_MESHLESS_MODES, (double)most);
    SmCode code = ref_modes_find(&elastic->body.matrices, NULL, wanted, &elastic->modes, error);
    elastic->mode_seconds = sm_now() - start;
    return code;
}
