/* The part of elastic_check.h that looks at a state of motion. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "elastic_check.h"

enum { FREE_STEPS = 64, POINTS = 2000 };

/* Amplitudes, their velocities, and where the constraints are. */
typedef struct {
    double *z, *speed;
    double (*target)[3]; /* [holds] */
} State;

static State keep(const RefMotion *motion)
{
    size_t modes = (size_t)motion->modes;
    State kept = {sm_alloc(modes, sizeof(double)), sm_alloc(modes, sizeof(double)),
                  sm_alloc((size_t)motion->holds, sizeof(double[3]))};
    for (int c = 0; c < motion->holds; c++)
        memcpy(kept.target[c], motion->hold[c].target, sizeof kept.target[c]);
    memcpy(kept.z, motion->z, modes * sizeof(double));
    memcpy(kept.speed, motion->speed, modes * sizeof(double));
    return kept;
}

/* The targets only where `targets` says so. */
static void put_back(const State *kept, bool targets, RefMotion *motion)
{
    for (int c = 0; c < motion->holds && targets; c++)
        memcpy(motion->hold[c].target, kept->target[c], sizeof kept->target[c]);
    memcpy(motion->z, kept->z, (size_t)motion->modes * sizeof(double));
    memcpy(motion->speed, kept->speed, (size_t)motion->modes * sizeof(double));
    ref_motion_pose(motion);
}

static void let_go(State *kept)
{
    free(kept->target);
    free(kept->z);
    free(kept->speed);
}

/* Where the displacements are small, warping turns nothing. */
static void check_pose(BenchElastic *elastic, BenchElasticFound *found)
{
    static const double small = 1e-6;
    RefMotion *motion = &elastic->motion;
    size_t modes = (size_t)motion->modes, size = 3 * (size_t)motion->nodes;
    double most = 0, off = 0;
    for (size_t k = 0; k < modes; k++) motion->z[k] *= small;
    ref_motion_pose(motion);
    for (size_t n = 0; n < size; n++) {
        double wanted = 0;
        for (size_t k = 0; k < modes; k++)
            wanted += elastic->modes.shape[n * modes + k] * motion->z[k];
        most = fmax(most, fabs(wanted));
        off = fmax(off, fabs(motion->moved[n / 3][n % 3] - wanted));
    }
    bench_elastic_note(found, BENCH_ELASTIC_POSE, most > 0 ? off / most : off);
}

/* d C / d z of all constraints by central differences, [3 holds][modes]. */
static double *slopes(RefMotion *motion, double step)
{
    size_t modes = (size_t)motion->modes;
    double *J = sm_alloc(3 * (size_t)motion->holds * modes, sizeof *J);
    for (size_t k = 0; k < modes; k++) {
        double z = motion->z[k];
        for (int side = 1; side >= -1; side -= 2) {
            motion->z[k] = z + side * step;
            for (int c = 0; c < motion->holds; c++) {
                double off[3];
                ref_motion_off(motion, c, off);
                for (size_t d = 0; d < 3; d++)
                    J[(3 * (size_t)c + d) * modes + k] += side * off[d] / (2 * step);
            }
        }
        motion->z[k] = z;
    }
    return J;
}

/* Eq. 33 as a dense system of the changes of the modes' velocities and the multipliers, by LU:
 * right becomes them. */
static void fill_system(const BenchElastic *elastic, double h, const double *J, gsl_matrix *system,
                        gsl_vector *right)
{
    const RefMotion *motion = &elastic->motion;
    size_t modes = (size_t)motion->modes, rows = 3 * (size_t)motion->holds;
    for (size_t k = 0; k < modes; k++) {
        double lambda = fmax(elastic->modes.lambda[k], 0);
        double damping = motion->damping.mass_damping + motion->damping.stiffness_damping * lambda;
        gsl_matrix_set(system, k, k, 1 + h * damping + h * h * lambda);
        gsl_vector_set(right, k,
                       h * (motion->load[k] - lambda * motion->z[k] -
                            (damping + h * lambda) * motion->speed[k]));
        for (size_t r = 0; r < rows; r++) {
            gsl_matrix_set(system, k, modes + r, J[r * modes + k]);
            gsl_matrix_set(system, modes + r, k, J[r * modes + k]);
        }
    }
    for (size_t r = 0; r < rows; r++) {
        double off[3], rate = 0;
        ref_motion_off(motion, (int)(r / 3), off);
        for (size_t k = 0; k < modes; k++) rate += J[r * modes + k] * motion->speed[k];
        gsl_vector_set(right, modes + r, -off[r % 3] / h - rate);
    }
}

/* The step's velocities `after` from those that a dense solution gives, by the largest of them, or
 * by what the forces alone would add to them: of a stiff body at rest nothing but rounding is left.
 * `motion` is as it was before the step, with the step's targets. */
static void compare_step(BenchElastic *elastic, double step, const double *after,
                         BenchElasticFound *found)
{
    RefMotion *motion = &elastic->motion;
    size_t modes = (size_t)motion->modes, all = modes + 3 * (size_t)motion->holds;
    double *J = slopes(motion, step), off = 0, most = 0;
    int sign;
    gsl_matrix *system = gsl_matrix_calloc(all, all);
    gsl_vector *right = gsl_vector_calloc(all), *change = gsl_vector_calloc(all);
    gsl_permutation *order = gsl_permutation_alloc(all);
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    fill_system(elastic, elastic->scene->params.h, J, system, right);
    bool solved = gsl_linalg_LU_decomp(system, order, &sign) == GSL_SUCCESS &&
                  gsl_linalg_LU_solve(system, order, right, change) == GSL_SUCCESS;
    gsl_set_error_handler(handler);
    for (size_t k = 0; k < modes; k++) {
        double wanted = motion->speed[k] + gsl_vector_get(change, k);
        most = fmax(most, fmax(fabs(wanted), elastic->scene->params.h * fabs(motion->load[k])));
        off = fmax(off, fabs(after[k] - wanted));
    }
    bench_elastic_note(found, BENCH_ELASTIC_STEP, !solved ? NAN : most > 0 ? off / most : off);
    gsl_matrix_free(system);
    gsl_vector_free(right);
    gsl_vector_free(change);
    gsl_permutation_free(order);
    free(J);
}

static void check_held(const RefMotion *motion, BenchElasticFound *found)
{
    for (int c = 0; c < motion->holds; c++) {
        double off[3], unit = motion->hold[c].kind == REF_HOLD_POSITION ? motion->size : 1;
        ref_motion_off(motion, c, off);
        for (int d = 0; d < 3; d++)
            bench_elastic_note(found, BENCH_ELASTIC_HELD, fabs(off[d]) / unit);
    }
}

/* Carried points from shape functions that are computed anew. */
static void check_skin(const BenchElastic *elastic, BenchElasticFound *found)
{
    const RefSkin *skin = &elastic->skin;
    RefShape shape = ref_shape_create(&elastic->body.nodes);
    for (long k = 0; k < POINTS; k++) {
        long p = k * skin->count / POINTS;
        bool covered = ref_mls_at(&elastic->body.nodes, elastic->body.basis, skin->rest[p], &shape);
        for (int d = 0; d < 3; d++) {
            double wanted = skin->rest[p][d];
            for (int n = 0; n < shape.count; n++)
                wanted += shape.value[n] * elastic->motion.moved[shape.node[n]][d];
            double off = fabs(elastic->carried[p][d] - wanted) / elastic->motion.size;
            bench_elastic_note(found, BENCH_ELASTIC_SKIN, covered ? off : NAN);
        }
    }
    ref_shape_free(&shape);
}

/* What the implicit step makes of the energy when nothing acts on the body. */
static void check_growth(BenchElastic *elastic, BenchElasticFound *found)
{
    RefMotion *motion = &elastic->motion;
    size_t nodes = (size_t)motion->nodes;
    double(*force)[3] = sm_alloc(nodes, sizeof *force);
    int holds = motion->holds;
    memcpy(force, motion->force, nodes * sizeof *force);
    memset(motion->force, 0, nodes * sizeof *force);
    motion->holds = 0;
    ref_motion_pose(motion);
    for (int n = 0; n < FREE_STEPS; n++) {
        double before = ref_motion_energy(motion);
        ref_motion_step(motion, elastic->scene->params.h);
        double grown = ref_motion_energy(motion) - before;
        bench_elastic_note(found, BENCH_ELASTIC_GROWTH,
                           before > 0 ? fmax(0, grown / before) : grown);
    }
    motion->holds = holds;
    memcpy(motion->force, force, nodes * sizeof *force);
    free(force);
}

void bench_elastic_check_state(BenchElastic *elastic, BenchElasticFound *found)
{
    RefMotion *motion = &elastic->motion;
    State before = keep(motion);
    double time = elastic->time, mass = 0;
    for (int c = 0; c < elastic->body.matrices.mass.columns; c++)
        mass += elastic->body.matrices.mass.value[elastic->body.matrices.mass.start[c]];
    check_pose(elastic, found);
    put_back(&before, true, motion);
    bench_elastic_step(elastic, NULL);
    check_held(motion, found);
    check_skin(elastic, found);
    State after = keep(motion);
    put_back(&before, false, motion);
    compare_step(elastic, 1e-5 * motion->size * sqrt(mass), after.speed, found);
    check_growth(elastic, found);
    put_back(&before, true, motion);
    elastic->time = time;
    let_go(&before);
    let_go(&after);
}
