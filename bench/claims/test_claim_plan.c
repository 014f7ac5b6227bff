/* Claims as a user runs them: whole, interrupted, on several ranks; and mistakes. */
#define _GNU_SOURCE
#include <signal.h>
#include <unistd.h>

#include "../../lib/test_frame.h"
#include "../cli/test_program.h"
#include "claim_plan.h"

/* Three curves, a scene, and one that is not there; the last two claims share the scene's row. */
#define OWN "claims --claims own.cfg --paper mine --quick --quiet"
#define CLAIM                                                                                      \
    "{ kind = \"method\"; paper = \"mine\"; statement = \"So.\"; test = \"near\"; value = "
#define SCENE "scene = \"./tiny.cfg\"; field = "

static const char own[] =
    "claims = (\n" CLAIM "2; name = \"reach\"; take = \"largest\"; tolerance = 9.0;\n"
    "  measure = { experiment = \"smoothing\"; w = { from = 1; to = 2; points = 2; }; }; },\n" CLAIM
    "1; name = \"jump\"; take = \"largest\"; tolerance = 99.0;\n"
    "  measure = { experiment = \"blending\"; matching = \"rigid\"; n = { from = 2; to = 3; points "
    "= 2; }; };\n"
    "  over = { experiment = \"blending\"; matching = \"quadratic\"; n = { from = 2; to = 3; "
    "points "
    "= 2; }; }; },\n" CLAIM "1; name = \"none\"; expect = \"not comparable\"; because = \"it is "
    "nowhere\";\n"
    "  measure = { experiment = \"scene\"; scene = \"./no.cfg\"; field = \"particles\"; }; "
    "},\n" CLAIM "64; name = \"few\"; measure = { experiment = \"scene\"; " SCENE
    "\"particles\"; }; },\n" CLAIM
    "1; name = \"pieces\"; tolerance = 99.0; measure = { experiment = \"scene\"; " SCENE
    "\"regions\"; }; } );\n";

static Result result;

static void runs(const char *arguments, int code)
{
    run(arguments, &result);
    if (result.code != code) fail_msg("%s: %d: %s", arguments, result.code, result.err);
}

static int set_up(void **state)
{
    if (make_folder(state)) return -1;
    write_text("own.cfg", own);
    write_text("tiny.cfg", "mesh = \"shape:block\"; particles = 64; w = 1; engine = \"brute\";\n");
    runs(OWN " -o whole.h5", 1); /* a scene is not there */
    return 0;
}

static void load(const char *name, BenchCampaign *claims)
{
    SmError error;
    if (bench_campaign_load(path_in(name), &bench_claims_type, claims, &error))
        fail_msg("%s", error.text);
}

/* The file has all experiments of whole.h5, and what repeats is the same to the last bit. */
static void equals_whole(const char *name)
{
    BenchCampaign whole, other;
    load("whole.h5", &whole);
    load(name, &other);
    assert_int_equal(other.count, whole.count);
    for (long i = 0; i < whole.count; i++) {
        const BenchClaimPoint *a = bench_campaign_at(&whole, i), *b = bench_campaign_at(&other, i);
        assert_string_equal(a->name, b->name);
        assert_string_equal(a->reason, b->reason);
        assert_true(a->lab.curves == b->lab.curves && a->lab.rows == b->lab.rows);
        assert_memory_equal(a->lab.curve, b->lab.curve,
                            (size_t)a->lab.curves * sizeof *a->lab.curve);
        for (int r = 0; r < a->lab.rows; r++) {
            const BenchRow *left = &a->lab.row[r], *right = &b->lab.row[r];
            assert_true(left->particles == right->particles && left->valid && right->valid);
            assert_true(left->repeats == right->repeats && right->total && right->total[0] > 0);
        }
    }
    bench_campaign_free(&whole);
    bench_campaign_free(&other);
}

TEST(a_scene_is_measured_once_for_its_claims)
{
    BenchCampaign whole;
    BenchLab lab;
    BenchFinding *findings;
    load("whole.h5", &whole);
    assert_int_equal(whole.count, 5);
    const BenchClaimPoint *scene = bench_campaign_at(&whole, 4),
                          *none = bench_campaign_at(&whole, 3);
    assert_string_equal(scene->name, "./tiny.cfg");
    assert_int_equal(scene->lab.rows, 1);
    assert_non_null(strstr(none->reason, "no.cfg"));
    assert_int_equal(bench_claims_find(&whole, &lab, &findings), 5);
    assert_int_equal(findings[2].verdict, BENCH_INVALID);
    if (findings[3].verdict != BENCH_REPRODUCED || findings[3].value[0] != 64)
        fail_msg("%g: %s", findings[3].value[0], findings[3].words);
    assert_string_equal(findings[3].evidence[0], "/rows/000");
    bench_claims_release(&lab, findings);
    bench_campaign_free(&whole);
}

/* Interrupted as soon as an experiment is stored; what is there is not measured again. */
TEST(interrupted_claims_go_on)
{
    char said[512];
    assert_int_equal(interrupt(OWN " -o part.h5", "part.h5"), 128 + SIGINT);
    slurp("err", said, sizeof said);
    assert_non_null(strstr(said, "part.h5 keeps the experiments that are finished, if any; the "
                                 "same command with --resume goes on"));
    assert_int_equal(entries(".tmp"), 0);
    BenchCampaign part;
    load("part.h5", &part);
    assert_in_range(part.count, 1, 4);
    double took = ((BenchClaimPoint *)part.point)->stamp.wall;
    bench_campaign_free(&part);
    runs(OWN " --resume -o part.h5", 1);
    equals_whole("part.h5");
    load("part.h5", &part);
    assert_true(((BenchClaimPoint *)part.point)->stamp.wall == took);
    bench_campaign_free(&part);
    runs("claims part.h5 --format csv", 1);
    assert_non_null(strstr(result.out, "mine,few,"));
}

/* Two ranks do the same as one. */
TEST(ranks_share_the_work)
{
    run_ranks(OWN " -o ranks.h5", &result);
    assert_int_equal(result.code, 1);
    equals_whole("ranks.h5");
}

TEST(mistakes_are_one_line)
{
    static const Mistake cases[] = {
        {OWN " -o whole.h5", 4, "cannot write whole.h5: it is there"},
        {OWN " --resume --overwrite -o whole.h5", 2, "--overwrite starts anew"},
        {OWN " --resume --seed 5 -o whole.h5", 3,
         "whole.h5 holds other claims: its seed is 1, and here 5"},
        {OWN " --resume --claim few -o whole.h5", 3, "holds other claims: its claims_hash differs"},
        {"claims whole.h5 --quick --resume", 2, "whole.h5 alone is shown as it is"},
        {"claims whole.h5 --overwrite", 2, "whole.h5 alone is shown as it is"},
        {"claims own.cfg", 3, "own.cfg: not an HDF5 file"},
        {"sweep whole.h5", 3, "not a shapebench sweep file"},
    };
    make_mistakes(cases, sizeof cases / sizeof cases[0]);
    equals_whole("whole.h5");
}

/* Without the curve of an experiment nothing would be left to judge. */
TEST(a_file_without_a_curve_is_refused)
{
    static const char *const lost[] = {"curves/blending.rigid.n2-3.2", "rows/000", "plan/names"};
    char command[256];
    for (int i = 0; i < 3; i++) {
        snprintf(command, sizeof command, "cp %s/whole.h5 %s/lost.h5", folder, folder);
        assert_int_equal(system(command), 0);
        hid_t file = H5Fopen(path_in("lost.h5"), H5F_ACC_RDWR, H5P_DEFAULT);
        assert_true(H5Ldelete(file, lost[i], H5P_DEFAULT) >= 0);
        H5Fclose(file);
        runs("claims lost.h5", 3);
        assert_non_null(strstr(result.err, i ? "is missing" : "has no curve"));
    }
}

TEST_GROUP(set_up, remove_folder)
