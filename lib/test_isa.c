/* Instruction sets: which there are, and that engines of all of them do the same. */
#include "isa.h"

#include "../fastlsm/fastlsm.h"
#include "../octree/engine.h"
#include "system/hash.h"
#include "test_fields.h"
#include "test_frame.h"
#include "test_random.h"
#include "voxel/test_bodies.h"

enum { STEPS = 60 };

TEST(the_best_that_is_there_is_used_until_another_is_asked_for)
{
    SmError error;
    int best = sm_isa_count() - 1;
    while (!sm_isa_there(best)) best--;
    assert_true(sm_isa_there(0));
    if (!getenv("SHAPEBENCH_ISA")) assert_int_equal(sm_isa(), best);
    for (int isa = 0; isa < sm_isa_count(); isa++) {
        const SmCode code = sm_isa_use(sm_isa_name(isa), &error);
        assert_int_equal(code, sm_isa_there(isa) ? SM_OK : SM_USAGE);
        if (!code) assert_int_equal(sm_isa(), isa);
        if (code) assert_non_null(strstr(error.text, sm_isa_name(isa)));
    }
    int before = sm_isa();
    assert_int_equal(sm_isa_use("abacus", &error), SM_USAGE);
    for (int isa = 0; isa < sm_isa_count(); isa++)
        assert_non_null(strstr(error.text, sm_isa_name(isa)));
    assert_int_equal(sm_isa(), before);
}

TEST(the_environment_is_believed_only_where_it_names_one)
{
    SmError error;
    char was[16] = "";
    if (getenv("SHAPEBENCH_ISA")) snprintf(was, sizeof was, "%s", getenv("SHAPEBENCH_ISA"));
    unsetenv("SHAPEBENCH_ISA");
    assert_int_equal(sm_isa_wanted(&error), SM_OK);
    setenv("SHAPEBENCH_ISA", sm_isa_name(0), 1);
    assert_int_equal(sm_isa_wanted(&error), SM_OK);
    setenv("SHAPEBENCH_ISA", "abacus", 1);
    assert_int_equal(sm_isa_wanted(&error), SM_USAGE);
    assert_non_null(strstr(error.text, "SHAPEBENCH_ISA: no instruction set 'abacus'"));
    if (was[0])
        setenv("SHAPEBENCH_ISA", was, 1);
    else
        unsetenv("SHAPEBENCH_ISA");
}

typedef struct {
    const SmEngineType *type;
    SmVoxels voxels;
    SmEngineParams params;
    long n;
    double (*v)[3];
} Case;

/* A body of any shape, and how it is thrown. */
static Case make_case(unsigned *seed, int trial)
{
    static const SmEngineType *const types[] = {&fastlsm_engine_f32, &octree_engine_f32,
                                                &fastlsm_engine_f64, &octree_engine_f64};
    static const OctOptions options = {.epsilon = 0.5, .width.edges = 1};
    Case c = {.type = types[trial % 4]};
    random_body(seed, random_int(seed, 6), 7, &c.voxels);
    c.params = (SmEngineParams){.w = 1 + random_int(seed, 10),
                                .h = 0.01,
                                .damping = random_int(seed, 2) * 0.2,
                                .octree = &options,
                                .instances = trial % 3 ? 1 : 1 + random_int(seed, 20)};
    c.n = c.voxels.particle_count * c.params.instances;
    c.v = sm_alloc((size_t)(c.n + 1), sizeof *c.v);
    for (long p = 0; p < c.n; p++)
        for (int d = 0; d < 3; d++) c.v[p][d] = 2 * random_between(seed, -1, 1);
    return c;
}

/* Where it is after some steps with so many threads, [particles][3]. */
static double (*play(Case *c, int threads))[3]
{
    SmError error;
    SmEngine *engine;
    SmCounts counts;
    c->params.threads = threads;
    if (c->type->create(&c->voxels, &c->params, &engine, &error)) fail_msg("%s", error.text);
    c->type->count(engine, &counts);
    assert_true(counts.particles <= c->n);
    c->n = counts.particles; /* an octree's nodes are fewer */
    c->type->set(engine, SM_VELOCITY, (const double(*)[3])c->v);
    for (int s = 0; s < STEPS; s++) c->type->step(engine, NULL);
    double(*x)[3] = sm_alloc((size_t)c->n, sizeof *x);
    c->type->get(engine, SM_POSITION, x);
    c->type->destroy(engine);
    return x;
}

/* Positions from one machine to another's: the file that SHAPEBENCH_POSITIONS names is written, or
 * where there is one, read, and what it holds is `first` (scripts/check_processors.sh). */
typedef struct {
    FILE *file;
    bool reads;
    double worst[2]; /* single, double */
} Elsewhere;

static Elsewhere elsewhere_open(void)
{
    const char *path = getenv("SHAPEBENCH_POSITIONS");
    if (!path) return (Elsewhere){0};
    FILE *there = fopen(path, "rb");
    return (Elsewhere){.file = there ? there : fopen(path, "wb"), .reads = there != NULL};
}

static void compare_elsewhere(Elsewhere *to, const Case *c, double (*x)[3], double bound)
{
    if (!to->file) return;
    const size_t n = (size_t)c->n;
    if (!to->reads) assert_int_equal(fwrite(x, sizeof *x, n, to->file), n);
    if (!to->reads) return;
    double(*there)[3] = sm_alloc(n, sizeof *there), *worst = &to->worst[bound < 1e-6];
    assert_int_equal(fread(there, sizeof *there, n, to->file), n);
    double off = field_difference(c->n, there, x) / c->voxels.cell;
    assert_true(off < bound);
    if (off > *worst) *worst = off;
    free(there);
}

static void elsewhere_close(Elsewhere *to)
{
    if (!to->file) return;
    fclose(to->file);
    if (to->reads)
        print_message("[  NOTE    ] off another machine's by %.2g of a cell in single and %.2g in "
                      "double precision\n",
                      to->worst[0], to->worst[1]);
}

/* Threads never change a bit; instruction sets change roundings: within 60 steps of a thrown body
 * by no more than 1e-4 of a cell in single and 1e-12 in double precision. */
TEST(engines_of_all_sets_and_threads_do_the_same)
{
    SmError error;
    unsigned seed = 5;
    Elsewhere elsewhere = elsewhere_open();
    for (int trial = 0; trial < 24; trial++) {
        Case c = make_case(&seed, trial);
        double(*first)[3] = NULL;
        const double bound = strcmp(c.type->precision, "single") ? 1e-12 : 1e-4;
        for (int isa = 0; isa < sm_isa_count(); isa++) {
            if (!sm_isa_there(isa)) continue;
            assert_int_equal(sm_isa_use(sm_isa_name(isa), &error), SM_OK);
            double(*one)[3] = play(&c, 1), (*three)[3] = play(&c, 3);
            assert_memory_equal(one, three, (size_t)c.n * sizeof *one);
            if (first) assert_true(field_difference(c.n, first, one) < bound * c.voxels.cell);
            if (first)
                free(one);
            else
                first = one;
            free(three);
        }
        compare_elsewhere(&elsewhere, &c, first, bound);
        free(first);
        free(c.v);
        sm_voxels_free(&c.voxels);
    }
    elsewhere_close(&elsewhere);
}
