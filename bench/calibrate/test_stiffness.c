/* Young's modulus of beams that have a known one, through the measurement that engines go through:
 * theory's own modes behind the engines' interface, and the meshless reference. */
#include "../../lib/test_fields.h"
#include "../../lib/test_frame.h"
#include "../../reference/meshless/test_solver.h"
#include "../engines.h"
#include "cantilever.h"
#include "specimen.h"

enum { ASPECT = 6, ACROSS = 3 };
static const double thickness = 0.1, density = 1000;

/* ---- an engine of Euler and Bernoulli's beam: particles move with its three lowest modes */

static struct {
    double young, loss; /* of the next one that is created */
    double grows;       /* how much stiffer it is at a tip's rise of its length */
    bool breaks;        /* it leaves all numbers */
} wire;

struct SmEngine {
    long count;
    double h, length, omega[REF_BEAM_MODES], mass[REF_BEAM_MODES];
    double z[REF_BEAM_MODES], speed[REF_BEAM_MODES];
    double (*rest)[3], *weight;
    double *shape[REF_BEAM_MODES]; /* what a rise of a mode's tip by 1 moves a particle up */
};

static SmCode wire_create(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **result,
                          SmError *error)
{
    (void)error;
    SmEngine *e = sm_alloc(1, sizeof *e);
    size_t count = (size_t)voxels->particle_count;
    int(*at)[3] = sm_alloc(count, sizeof *at);
    e->count = voxels->particle_count;
    e->h = params->h;
    e->rest = sm_alloc(count, sizeof *e->rest);
    e->weight = sm_alloc(count, sizeof *e->weight);
    sm_voxels_particles(voxels, at);
    for (size_t p = 0; p < count; p++) {
        for (int d = 0; d < 3; d++) e->rest[p][d] = voxels->origin[d] + voxels->cell * at[p][d];
        e->weight[p] = params->mass[p];
        e->length = fmax(e->length, e->rest[p][0]);
    }
    free(at);
    double square[REF_BEAM_MODES];
    ref_beam_frequencies(&(RefBeam){e->length, thickness, 0.3}, REF_EULER, square);
    for (int k = 0; k < REF_BEAM_MODES; k++) {
        e->omega[k] = sqrt(square[k] * wire.young / density);
        e->shape[k] = sm_alloc(count, sizeof *e->shape[k]);
        for (size_t p = 0; p < count; p++) {
            double slope, s = e->rest[p][0] / e->length;
            e->shape[k][p] = s > 0 ? ref_beam_shape(k, s, &slope) / 2 : 0;
            e->mass[k] += e->weight[p] * e->shape[k][p] * e->shape[k][p];
        }
    }
    *result = e;
    return SM_OK;
}

static void wire_destroy(SmEngine *e)
{
    free(e->rest);
    free(e->weight);
    for (int k = 0; k < REF_BEAM_MODES; k++) free(e->shape[k]);
    free(e);
}

static void wire_step(SmEngine *e, SmLaps *laps)
{
    (void)laps;
    for (int k = 0; k < REF_BEAM_MODES; k++) {
        double omega = e->omega[k], rise = e->z[0] / e->length;
        e->speed[k] -= e->h * (omega * omega * (1 + wire.grows * rise * rise) * e->z[k] +
                               wire.loss * omega * e->speed[k]);
        if (wire.breaks) e->speed[k] = NAN;
        e->z[k] += e->h * e->speed[k];
    }
}

static void wire_get(SmEngine *e, SmField field, double (*values)[3])
{
    const double *amplitude = field == SM_VELOCITY ? e->speed : e->z;
    for (long p = 0; p < e->count; p++) {
        for (int d = 0; d < 3; d++) values[p][d] = field == SM_VELOCITY ? 0 : e->rest[p][d];
        for (int k = 0; k < REF_BEAM_MODES && field != SM_REST; k++)
            values[p][1] += amplitude[k] * e->shape[k][p];
    }
}

static void wire_set(SmEngine *e, SmField field, const double (*values)[3])
{
    double *amplitude = field == SM_VELOCITY ? e->speed : e->z;
    for (int k = 0; k < REF_BEAM_MODES; k++) {
        amplitude[k] = 0;
        for (long p = 0; p < e->count; p++)
            amplitude[k] += e->weight[p] * e->shape[k][p] / e->mass[k] *
                            (values[p][1] - (field == SM_VELOCITY ? 0 : e->rest[p][1]));
    }
}

static void wire_push(SmEngine *e, long count, const long *particle, const double (*impulse)[3])
{
    for (long n = 0; n < count; n++)
        for (int k = 0; k < REF_BEAM_MODES; k++)
            e->speed[k] += impulse[n][1] * e->shape[k][particle[n]] / e->mass[k];
}

static void wire_bound(SmEngine *e, const SmBoundary *boundary)
{
    (void)e;
    (void)boundary;
}

static void wire_masses(SmEngine *e, double *mass)
{
    memcpy(mass, e->weight, (size_t)e->count * sizeof *mass);
}

static void wire_count(SmEngine *e, SmCounts *counts)
{
    *counts = (SmCounts){.particles = e->count};
}

static const SmEngineType wire_type = {
    .name = "wire",
    .precision = "double",
    .create = wire_create,
    .destroy = wire_destroy,
    .step = wire_step,
    .get = wire_get,
    .set = wire_set,
    .push = wire_push,
    .bound = wire_bound,
    .masses = wire_masses,
    .count = wire_count,
};

/* ---- measured */

static BenchCantileverOptions options_of(double h)
{
    return (BenchCantileverOptions){.engine = "fastlsm",
                                    .w = 1,
                                    .across = ACROSS,
                                    .along = ACROSS * ASPECT,
                                    .root = 2,
                                    .cell = thickness / ACROSS,
                                    .h = h,
                                    .density = density};
}

static BenchStiffness measure(const BenchCantileverOptions *options, const SmEngineType *type,
                              bool range)
{
    BenchCantilever beam;
    BenchStiffness found;
    SmError error;
    if (bench_cantilever_create(options, type, &beam, &error)) fail_msg("%s", error.text);
    bench_stiffness_measure(&beam.beam, &(BenchBeamTrial){BENCH_TONES, 5, 0}, &found);
    if (range) bench_stiffness_range(&beam.beam, &found);
    bench_cantilever_free(&beam);
    return found;
}

static BenchSpecimen judge(const BenchStiffness *found, bool meshless)
{
    BenchSpecimen s;
    bench_record_none(bench_specimen_fields, bench_specimen_field_count, &s, sizeof s);
    BenchElasticCantilever ideal[BENCH_MODELS] = {{0}};
    s.aspect = ASPECT;
    s.valid = true;
    memcpy(s.frequency, found->frequency, sizeof s.frequency);
    s.load = found->load;
    s.sag = found->sag;
    for (int m = 0; m < BENCH_MODELS; m++)
        if (m != BENCH_MESHLESS || meshless)
            assert_int_equal(bench_elastic_cantilever((BenchModel)m, ASPECT, 0.3, &ideal[m], NULL),
                             SM_OK);
    bench_specimen_judge(ideal, thickness, density, &s);
    return s;
}

static void near_to(double value, double wanted, double share)
{
    if (!(fabs(value / wanted - 1) <= share)) fail_msg("%g, not %g", value, wanted);
}

/* A cantilever of few nodes sags too little, of the quadratic basis by less. */
TEST(quadratic_functions_bend_with_fewer_nodes)
{
    if (!ref_solver_built) skip();
    BenchElasticCantilever theory;
    double sag[2];
    long nodes;
    assert_int_equal(bench_elastic_cantilever(BENCH_TIMOSHENKO, 5, 0.3, &theory, NULL), SM_OK);
    for (int b = 0; b < 2; b++) {
        RefBasis basis = b ? REF_MLS_QUADRATIC : REF_MLS_LINEAR;
        assert_int_equal(bench_elastic_sag(5, 0.3, 3, basis, &nodes, &sag[b], NULL), SM_OK);
        assert_int_equal(nodes, 3 * 3 * 15);
        sag[b] /= theory.sag;
    }
    near_to(sag[0], 0.947, 0.01);
    near_to(sag[1], 1, 0.05);
    assert_true(fabs(sag[1] - 1) < 0.8 * fabs(sag[0] - 1));
}

/* Theory's beam has its own modulus, by the sag and by every frequency, and its own loss. */
TEST(a_beam_gives_its_modulus_back)
{
    for (int lossy = 0; lossy < 2; lossy++) {
        wire.young = lossy ? 3e5 : 2e6;
        wire.loss = lossy ? 0.02 : 0;
        BenchCantileverOptions options = options_of(5e-4);
        BenchStiffness found = measure(&options, &wire_type, true);
        assert_string_equal(found.why, "");
        BenchSpecimen s = judge(&found, false);
        for (int i = 0; i < BENCH_YOUNGS; i++) near_to(s.young_euler[i], wire.young, 0.01);
        for (int k = 0; k < BENCH_TONES; k++)
            assert_true(fabs(found.loss[k] - wire.loss) < 1e-4 + 0.02 * wire.loss);
        assert_true(found.unrest < BENCH_REST && found.linear_to == 0.4); /* it is linear */
        assert_true(isnan(s.young_meshless[0]) && s.young_timoshenko[3] > s.young_euler[3]);
        near_to(s.young, sqrt(s.young_timoshenko[0] * s.young_timoshenko[1]), 1e-12);
    }
    wire.loss = 0;
}

/* So many tones as are wanted, in fewer periods just as well; twice the load bends it twice as
 * far. */
TEST(a_trial_measures_what_it_is_asked_for)
{
    BenchCantileverOptions options = options_of(5e-4);
    BenchCantilever beam;
    BenchStiffness all, one;
    SmError error;
    wire.young = 2e6;
    if (bench_cantilever_create(&options, &wire_type, &beam, &error)) fail_msg("%s", error.text);
    bench_stiffness_measure(&beam.beam, &(BenchBeamTrial){BENCH_TONES, 5, 0}, &all);
    bench_stiffness_measure(&beam.beam, &(BenchBeamTrial){1, 2, 2 * all.load}, &one);
    bench_cantilever_free(&beam);
    assert_string_equal(one.why, "");
    assert_true(isnan(one.frequency[1]) && isnan(one.loss[1]) && isfinite(all.loss[1]));
    near_to(one.frequency[0], all.frequency[0], 1e-5);
    assert_true(one.load == 2 * all.load);
    near_to(one.sag, 2 * all.sag, 2e-3);
}

TEST(what_is_not_in_proportion_is_seen)
{
    wire.young = 2e6;
    wire.grows = 4; /* 4% stiffer at a sag of a tenth, 16% at a fifth */
    BenchCantileverOptions options = options_of(5e-4);
    BenchStiffness found = measure(&options, &wire_type, true);
    assert_true(found.linear_to == 0.1);
    wire.grows = 0;
}

TEST(a_beam_that_does_not_swing_has_no_figures)
{
    wire.young = 2e6;
    wire.breaks = true;
    BenchCantileverOptions options = options_of(5e-4);
    options.across = 1, options.along = ASPECT, options.cell = thickness;
    BenchStiffness found = measure(&options, &wire_type, true);
    assert_non_null(strstr(found.why, "does not swing to and fro"));
    assert_true(isnan(found.sag) && isnan(found.frequency[0]) && isnan(found.linear_to));
    wire.breaks = false;
}

/* Figures of a point that is not valid are nobody's. */
TEST(an_invalid_specimen_has_no_modulus)
{
    BenchElasticCantilever ideal[BENCH_MODELS] = {{0}};
    assert_int_equal(bench_elastic_cantilever(BENCH_EULER, ASPECT, 0.3, &ideal[0], NULL), SM_OK);
    assert_int_equal(bench_elastic_cantilever(BENCH_TIMOSHENKO, ASPECT, 0.3, &ideal[1], NULL),
                     SM_OK);
    BenchSpecimen s;
    bench_record_none(bench_specimen_fields, bench_specimen_field_count, &s, sizeof s);
    bench_specimen_judge(ideal, thickness, density, &s);
    assert_true(isnan(s.young) && isnan(s.spread) && isnan(s.young_euler[0]));
}

/* The three models of one elastic beam differ by what thin beams leave out, and by octants. */
TEST(models_agree)
{
    BenchElasticCantilever ideal[BENCH_MODELS];
    for (int m = 0; m < BENCH_MODELS; m++)
        assert_int_equal(bench_elastic_cantilever((BenchModel)m, ASPECT, 0.3, &ideal[m], NULL),
                         SM_OK);
    assert_int_equal(ideal[BENCH_MESHLESS].there, ref_solver_built);
    needs_solver();
    near_to(ideal[BENCH_MESHLESS].sag, ideal[BENCH_TIMOSHENKO].sag, 0.03);
    for (int k = 0; k < BENCH_TONES; k++)
        near_to(ideal[BENCH_MESHLESS].square[k], ideal[BENCH_TIMOSHENKO].square[k], 0.03);
    assert_true(ideal[BENCH_EULER].square[2] > 1.3 * ideal[BENCH_TIMOSHENKO].square[2]);
}

/* The meshless reference, as an engine of few modes that holds its root at four points, has its own
 * modulus to a tenth; its implicit step loses something. */
TEST(the_reference_gives_its_modulus_back)
{
    needs_solver();
    needs_figures();
    BenchCantileverOptions options = options_of(2e-2);
    strcpy(options.engine, "meshless");
    BenchStiffness found = measure(&options, &ref_meshless_engine, false);
    BenchSpecimen s = judge(&found, true);
    BenchScene scene;
    bench_scene_init(&scene);
    for (int i = 0; i < 2; i++) near_to(s.young_meshless[i], scene.meshless.material.young, 0.1);
    assert_true(found.loss[0] > 0.01 && found.loss[0] < 0.2);
}

/* A soft lattice beam is an elastic one: sag and frequencies agree; a shorter step makes it stiffer
 * with its inverse square. */
TEST(a_lattice_is_elastic)
{
    BenchSpecimen s[2];
    const SmEngineType *type;
    assert_int_equal(bench_engine_find("fastlsm", "double", &type, NULL), SM_OK);
    for (int n = 0; n < 2; n++) {
        BenchCantileverOptions options = options_of(n ? 5e-4 : 1e-3);
        BenchStiffness found = measure(&options, type, true);
        s[n] = judge(&found, false);
        near_to(s[n].young_timoshenko[1], s[n].young_timoshenko[0], 0.01);
        near_to(s[n].young_timoshenko[2], s[n].young_timoshenko[0], 0.05);
        assert_true(fabs(found.loss[0]) < 1e-5 && found.linear_to >= 0.1);
    }
    near_to(s[1].young, 4 * s[0].young, 1e-3);
}
