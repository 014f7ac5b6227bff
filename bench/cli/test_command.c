/* The program as a user runs it: exit codes, single lines, files. */
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <jansson.h>

#include "../../lib/printable.h"
#include "../../lib/test_frame.h"
#include "../../reference/meshless/test_solver.h"
#include "test_program.h"

static bool there(const char *name)
{
    return access(path_in(name), F_OK) == 0;
}

static int set_up(void **state)
{
    static const int face[6][4] = {{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5},
                                   {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}};
    if (make_folder(state)) return -1;
    write_text("bad.cfg", "mesh = \"shape:block\";\nparticles = 64;\ndamping_k = 1;\n");
    write_text("tiny.cfg",
               "mesh = \"shape:block\"; particles = 64; w = 1; engine = \"brute\"; bend = 0.3;\n"
               "frames = 3; steps_per_frame = 2;\n");
    write_text("noise.obj", "no mesh at all\n");
    write_text("plain", "v 0 0 0\n");
    write_text("loose.obj", "v 0 0 0\nv 3 1 2\nv 1 3 1\nf 1 2 3\n");
    write_text("lattice.cfg",
               "paper = \"octree\"; mesh = \"shape:block\"; particles = 500; w = 1; bend = 0.3;\n");
    write_text(
        "wishes.cfg",
        "mesh = \"shape:block\"; cells = 343; engine = \"octree\"; bend = 0.3;\n"
        "instances = 2; frames = 2;\n"
        "octree = { levels = 2; bases = 3; summation_nodes = 1000.0; weighting = \"plain\";\n"
        "           widths = ( { radius = 0.15; w = 0.0; } ); };\n");
    write_text("plastic.cfg",
               "mesh = \"shape:block\"; particles = 64; octree = { creep = 1.0; };\n");
    write_text(
        "far.cfg",
        "mesh = \"shape:block\"; particles = 64; engine = \"octree\";\n"
        "octree = { widths = ( { centre = [9.0, 0.0, 0.0]; radius = 1.0; w = 1.0; } ); };\n");
    char two[2048] = "";
    for (int box = 0; box < 2; box++) {
        for (int v = 0; v < 8; v++)
            sm_append(two, sizeof two, "v %d %d %d\n", 3 * box + v % 2, v / 2 % 2, v / 4);
        for (int f = 0; f < 6; f++)
            sm_append(two, sizeof two, "f %d %d %d %d\n", 8 * box + face[f][0],
                      8 * box + face[f][1], 8 * box + face[f][2], 8 * box + face[f][3]);
    }
    write_text("two.obj", two);
    write_text("wide.cfg", "mesh = \"shape:block\"; particles = 70000; w = 31;\n");
    write_text("tree.cfg",
               "paper = \"octree\"; row = \"hand-sampled\"; mesh = \"shape:block\"; cells = 343;\n"
               "engine = \"octree\"; bend = 0.3; kick = 0.01; epsilon = 0.5;\n"
               "octree = { levels = 2; nodes = 120; summation_nodes = 9.0; };\n");
    return 0;
}

TEST(mistyped_words_get_a_suggestion)
{
    static const Mistake cases[] = {
        {"--frobnicate", 2, "unrecognized option '--frobnicate'; see 'shapebench --help'"},
        {"frobnicate", 2, "unknown command 'frobnicate'; see 'shapebench --help'"},
        {"tabels", 2, "unknown command 'tabels'; did you mean 'tables'? See 'shapebench --help'"},
        {"help tabels", 2, "did you mean 'tables'?"},
        {"--verison", 2, "did you mean '--version'?"},
        {"run tiny.cfg --enigne octree", 2,
         "unrecognized option '--enigne'; did you mean '--engine'? See 'shapebench run --help'"},
        {"tables --sceen=penguin", 2, "did you mean '--scene'?"},
        {"run tiny.cfg --trheads 2", 2, "did you mean '--threads'?"},
        {"run pengiun", 2, "did you mean 'penguin'? See 'shapebench run --help'"},
        {"scenes --quiet", 2, "unrecognized option '--quiet'"},
        {"report --threads 2 a.h5", 2, "unrecognized option '--threads'"},
        {"penguin", 2, "unknown command 'penguin'; did you mean 'run penguin'?"},
        {"tiny.cfg", 2, "did you mean 'run tiny.cfg'?"},
        {"view pengiun", 2, "did you mean 'penguin'? See 'shapebench view --help'"},
    };
    make_mistakes(cases, sizeof cases / sizeof cases[0]);
}

TEST(wrong_values_of_run_are_one_line_and_an_exit_code)
{
    static const Mistake cases[] = {
        {"run", 2, "which scene or mesh? See 'shapebench run --help'"},
        {"run tiny.cfg --frobnicate", 2, "'--frobnicate'; see 'shapebench run --help'"},
        {"run tiny.cfg --w 0", 2,
         "--w: '0' is not a whole number from 1 to 32; see 'shapebench run --help'"},
        {"run tiny.cfg --w 2x", 2, "--w: '2x'"},
        {"run tiny.cfg --damping 1.5", 2, "--damping: '1.5' is not a number from 0 to 1"},
        {"run tiny.cfg --damping nan", 2, "--damping: 'nan'"},
        {"run tiny.cfg --gravity 1,2", 2, "--gravity: '1,2' is not three numbers x,y,z"},
        {"run tiny.cfg --summation slow", 2, "not one of fast, bars, naive"},
        {"run tiny.cfg --layout round", 2, "'round' is not one of auto, lists, blocks"},
        {"run tiny.cfg --fields speed,film", 2,
         "--fields: 'film' is not one of displacement, speed"},
        {"run tiny.cfg --fields speed,", 2, "--fields: '' is not one of"},
        {"run tiny.cfg --fields level", 2, "--fields level is of an octree's leaves"},
        {"run tiny.cfg --no-output --fields speed", 2, "--no-output goes with none of"},
        {"run tiny.cfg --record film", 2, "--record: 'film' is not one of particles, nodes"},
        {"run tiny.cfg --w", 2, "requires an argument; see 'shapebench run --help'"},
        {"run tiny.cfg tiny.cfg", 2, "One scene or mesh only"},
        {"run tiny.cfg --particles 100 --cell 0.1", 2, "either --particles or --cell"},
    };
    make_mistakes(cases, sizeof cases / sizeof cases[0]);
}

TEST(options_that_an_engine_has_not_are_refused)
{
    static const Mistake cases[] = {
        {"run tiny.cfg --engine warp", 2,
         "'warp' is not one of fastlsm, octree, brute, meshless, shell"},
        {"run tiny.cfg --engine octre", 2, "did you mean 'octree'? See 'shapebench run --help'"},
        {"run tiny.cfg --epsilon 0.5", 2, "are the octree's: add --engine octree"},
        {"run tiny.cfg --levels 2 --nodes 9", 2,
         "and --nodes are the octree's: add --engine octree"},
        {"run tiny.cfg --engine meshless --levels 2 --nodes 9", 2,
         "--epsilon and --levels are the"},
        {"run tiny.cfg --engine octree --levels 13", 2, "--levels: '13'"},
        {"run tiny.cfg --engine octree --epsilon -1", 2, "--epsilon: '-1'"},
        {"run tiny.cfg --engine octree --nodes 0", 2, "--nodes: '0'"},
        {"run hand-sampled --nodes 100000000 --no-output", 3,
         "100000000 nodes wanted, but there can be "},
        {"run tiny.cfg --engine octree --w wide", 2, "--w: 'wide' is not a number above 0"},
        {"run tiny.cfg --engine octree --w 0", 2, "--w: '0' is not a number above 0"},
        {"run tiny.cfg --w 1 --width cells", 2, "add --engine octree"},
        {"run tiny.cfg --engine octree --width cells", 2, "add --w"},
        {"run tiny.cfg --engine octree --summation naive", 3, "the octree has its own"},
        {"run tiny.cfg --engine octree --strain-limit 2", 3, "strain_limit: the octree's"},
        {"run tiny.cfg --engine octree --record particles", 2, "stores a lattice"},
        {"run tiny.cfg --record nodes", 2, "--record nodes stores an octree"},
        {"run tiny.cfg --engine octree --layout lists", 3, "tiny.cfg: summation and layout:"},
        {"run plastic.cfg --engine fastlsm", 3,
         "plastic.cfg: plastic bodies ('creep') need the engine octree, not fastlsm"},
        {"run far.cfg", 3, "far.cfg: octree: no node's centre lies in the box or sphere"},
        {"run tiny.cfg --particles 1000000000 --w 31 --no-output", 70,
         "tiny.cfg: 1000000000 particles on brute take "},
    };
    make_mistakes(cases, sizeof cases / sizeof cases[0]);
}

TEST(files_that_cannot_be_used_are_named)
{
    static const Mistake cases[] = {
        {"run no-such-scene", 2, "shapebench scenes"},
        {"run bad.cfg", 3, "bad.cfg:3: unknown setting 'damping_k'; known: "},
        {"run missing.cfg", 3, "missing.cfg: no such file"},
        {"run missing.obj", 3, "missing.obj"},
        {"run noise.obj", 3, "noise.obj"},
        {"run loose.obj", 3, "join its vertices, or simulate it as a shell ('run --shell')"},
        {"run tiny.cfg -o no/such/folder.vtkhdf", 4, "no/such/folder.vtkhdf"},
        {"run tiny.cfg --mesh penguin", 2, "--mesh: 'penguin' is not NAME=FILE"},
        {"run tiny.cfg --mesh penguin=noise.obj", 2, "--mesh: 'penguin' is not this scene, tiny"},
        {"run noise.obj --mesh penguin=noise.obj", 2, "noise.obj is a mesh itself"},
        {"tables --scene penguin --mesh hand=noise.obj", 2,
         "'hand' is not measured: name it with --scene"},
        {"run plain --no-output", 2, "plain: the ending of its name must say what it is"},
        {"run tiny.cfg --strain-limit 0.5", 3, "it is 0 (never) or above 1"},
        {"run tiny.cfg --mode 1", 2, "--mode is of a meshless body or a shell, and brute has no"},
        {"run beam-elastic --nodes 60 --modes 9 --mode 4 --no-output", 2,
         "3 modes were found that deform the body: --modes 10 finds more"},
        {"run two.obj --engine meshless --nodes 200 --points 1000 --modes 20 --mode 2 --no-output",
         2, "--mode 2: it deforms nothing, because the body is in pieces"},
        {"run beam-elastic --basis cubic", 2, "'cubic' is not one of usual, linear, quadratic"},
        {"run beam-elastic --w 2", 2, "--w: a meshless body has no regions"},
        {"run lattice.cfg --w 33", 2, "--w: '33' is not a whole number from 1 to 32"},
        {"run tiny.cfg --mesh x=y", 2, "'x' is not a built-in scene"},
        {"run tiny.cfg --mesh pengiun=y", 2, "did you mean 'penguin'?"},
        {"run tiny.cfg -o film.xdmf", 2, "give a name that ends in .vtkhdf"},
    };
    make_mistakes(cases, sizeof cases / sizeof cases[0]);
}

TEST(mistakes_of_other_commands_are_too)
{
    static const Mistake cases[] = {
        {"info --particles 9", 2, "which MESH?"},
        {"info missing.obj", 3, "missing.obj"},
        {"info --format xml a.obj", 2, "'xml' is not one of text, json"},
        {"view missing.obj", 3, "missing.obj: no such file"},
        {"view noise.obj", 3, "noise.obj"},
        {"view two.obj -o tiny.cfg", 4, "tiny.cfg: it is there; choose another name, or give"},
        {"view two.obj -o no/such/view.html", 4, "no/such/view.html"},
        {"scenes no-such", 2, "'no-such' is not a built-in scene"},
        {"scenes pengiun", 2, "did you mean 'penguin'? See"},
        {"claims --claim stabel", 2, "did you mean 'stable'? See"},
        {"tabl\033[31mes", 2, "unknown command 'tabl?[31mes'"},
        {"scenes --write-mesh a.obj", 2, "which shape?"},
        {"scenes penguin --settings", 2, "--settings goes alone"},
        {"run penguin --gravity 1e13,0,0", 2, "three numbers x,y,z, each from -1e+12 to 1e+12"},
        {"scenes penguin --write-mesh /no/such/a.obj", 4, "/no/such/a.obj"},
        {"scenes penguin --write-mesh /dev/null", 4, "it is there and not a regular file"},
        {"scenes penguin --write-mesh /tmp", 4, "it is there and not a regular file"},
        {"tables --scene wide.cfg", 3, "wide.cfg: regions with 4.98e+09 members take too long"},
        {"tables --repeats 0", 2, "--repeats: '0'"},
        {"info shape:block --map --particles 9", 2, "without --format and --part"},
        {"tables --paper unknown", 2, "'unknown' is not one of fastlsm, octree, meshless"},
        {"tables --paper octre", 2, "did you mean 'octree'? See"},
        {"claims --paper fastlms", 2, "did you mean 'fastlsm'? See"},
        {"regress --revision HEAD --paper meshles", 2, "did you mean 'meshless'? See"},
        {"sweep two.obj", 2, "two.obj: FILE.h5 alone is shown; --mesh two.obj is measured"},
        {"sweep hand", 2, "hand: FILE.h5 alone is shown; --scene hand is measured"},
        {"sweep --engine octre", 2, "did you mean 'octree'? See"},
        {"kernels --only polar-fats", 2, "did you mean 'polar-fast'? See"},
        {"kernels --only scalling", 2, "did you mean 'scaling'? See"},
        {"kernels --list --threads 2", 2, "--list goes alone"},
        {"tables --format pdf", 2, "'pdf' is not one of text, markdown, csv, latex, json"},
        {"tables penguin", 2, "what is 'penguin'?"},
        {"tables --layout round", 2, "--layout: 'round'"},
        {"tables -o no/such/rows.h5", 4, "no/such/rows.h5"},
        {"tables --threads -1", 2, "--threads: '-1'"},
        {"tables --scene tiny.cfg --overwrite", 2,
         "--overwrite: what? Name the file with --output"},
        {"claims --overwrite", 2, "--overwrite: what?"},
        {"claims --list -o claims.h5", 2, "--list measures nothing"},
    };
    make_mistakes(cases, sizeof cases / sizeof cases[0]);
}

TEST(help_is_everywhere)
{
    static const char *const commands[] = {"",      "run",       "tables", "info",
                                           "sweep", "calibrate", "scenes"};
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        char arguments[64];
        Result result;
        snprintf(arguments, sizeof arguments, "%s --help", commands[i]);
        run(arguments, &result);
        assert_int_equal(result.code, 0);
        assert_string_equal(result.err, "");
        assert_non_null(strstr(result.out, "Usage: shapebench"));
        assert_non_null(strstr(result.out, "Exit codes: 0 done;"));
        if (strstr(result.out, "\n\n\n") || strstr(result.out, " \n"))
            fail_msg("shapebench %s has blank lines too many:\n%s", arguments, result.out);
    }
    static const char *const same[][2] = {{"-h", "--help"},
                                          {"help", "--help"},
                                          {"help run", "run --help"},
                                          {"sweep --quiet -h", "sweep --help"}};
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        Result result, wanted;
        run(same[i][0], &result);
        run(same[i][1], &wanted);
        assert_int_equal(result.code, 0);
        assert_string_equal(result.out, wanted.out);
    }
    Result result;
    run("--version", &result);
    assert_int_equal(result.code, 0);
    assert_memory_equal(result.out, "shapebench ", 11);
}

TEST(the_machine_is_described)
{
    static const char *const wanted[] = {"\n  processor     ", "\n  caches        ",
                                         "\n  counters      ", "\n  compiler      ",
                                         "(in use)",           "\n  libraries     HDF5 "};
    Result result;
    run("info", &result);
    assert_int_equal(result.code, 0);
    assert_string_equal(result.err, "");
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        if (!strstr(result.out, wanted[i])) fail_msg("no '%s' in\n%s", wanted[i], result.out);
    run("info --format json --threads 2", &result);
    json_t *root = json_loads(result.out, 0, NULL), *isas = json_object_get(root, "isas"), *isa;
    size_t i, in_use = 0;
    json_array_foreach(isas, i, isa) in_use += json_is_true(json_object_get(isa, "in_use"));
    assert_int_equal(in_use, 1);
    json_t *environment = json_object_get(root, "environment");
    assert_int_equal(json_integer_value(json_object_get(environment, "threads")), 2);
    const char *counters = json_string_value(json_object_get(environment, "counters"));
    assert_true(!strncmp(counters, "none: ", 6) || !strncmp(counters, "cycles", 6));
    json_decref(root);
}

TEST(a_scene_can_be_copied_and_run)
{
    Result result;
    run("scenes", &result);
    assert_non_null(strstr(result.out, "penguin"));
    run("scenes block-twist", &result);
    assert_int_equal(result.code, 0);
    write_text("mine.cfg", result.out);
    run("run mine.cfg --engine brute --particles 64 --frames 2", &result);
    if (result.code) fail_msg("%s", result.err);
    assert_string_equal(result.err, ""); /* no progress where there is no terminal */
    assert_non_null(strstr(result.out, "mine: brute, double precision: 64 particles"));
    assert_non_null(strstr(result.out, "deviation: goals within"));
    assert_true(there("mine.vtkhdf") && there("mine.vtkhdf.xdmf"));
}

TEST(a_path_may_be_as_long_as_the_system_has_it)
{
    Result result;
    run_with("D=$(printf %0200d 0); P=$D/$D/$D/$D/$D/$D; mkdir -p $P;",
             "run tiny.cfg --frames 0 -o $P/a.vtkhdf && { ls $P; rm -r $D; }", &result);
    if (result.code) fail_msg("%s", result.err);
    const char *last = strstr(result.out, "a.vtkhdf\na.vtkhdf.xdmf\n");
    if (!last) fail_msg("written elsewhere: %s", result.out);
}

TEST(a_mesh_alone_can_be_run)
{
    Result result;
    run("scenes block --write-mesh block.obj", &result);
    assert_int_equal(result.code, 0);
    run("info block.obj --format json", &result);
    assert_int_equal(result.code, 0);
    json_t *list = json_loads(result.out, 0, NULL);
    json_t *mesh = json_array_get(list, 0);
    assert_true(json_is_true(json_object_get(mesh, "watertight")));
    assert_true(json_is_true(json_object_get(mesh, "solid")));
    assert_int_equal(json_integer_value(json_object_get(mesh, "open_edges")), 0);
    json_decref(list);
    write_text("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\n");
    run("info open.obj", &result);
    assert_non_null(strstr(result.out, "volume        none: the surface is open\n"));
    run("info open.obj --format json", &result);
    list = json_loads(result.out, 0, NULL);
    assert_true(json_is_null(json_object_get(json_array_get(list, 0), "volume")));
    json_decref(list);
    run("info block.obj missing.obj", &result);
    assert_int_equal(result.code, 3);
    assert_non_null(strstr(result.out, "watertight    yes"));
    assert_non_null(strstr(result.out, "solid         yes"));
    run("run block.obj --engine brute --particles 100 --w 1 --frames 2 -o out.vtkhdf", &result);
    if (result.code) fail_msg("%s", result.err);
    assert_true(there("out.vtkhdf"));
    run("run block.obj --engine brute --particles 100 --frames 1 --no-output", &result);
    assert_int_equal(result.code, 0);
    assert_false(there("block.vtkhdf"));
}

/* What the page opens; a mesh that it has no reader for goes in as OBJ. */
TEST(a_page_carries_a_scene_or_a_mesh)
{
    static const struct {
        const char *what, *text;
    } cases[] = {{"tiny.cfg", "\"scene\": \"mesh = "},
                 {"penguin", "One penguin, 150 particles"},
                 {"two.obj", "\"scene\": \"\", \"mesh\": [{\"name\": \"two.obj\", \"gzip\": \""},
                 {"shape:block", "\"mesh\": [{\"name\": \"block.obj\", \"gzip\": \""}};
    static char page[1 << 23];
    Result result;
    if (access("/usr/bin/python3", X_OK)) skip();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char words[64];
        snprintf(words, sizeof words, "view %s --overwrite", cases[i].what);
        run(words, &result);
        if (result.code) fail_msg("%s: %s", cases[i].what, result.err);
        assert_string_equal(result.out, "wrote view.html: open it in a browser\n");
        FILE *file = fopen(path_in("view.html"), "r");
        assert_non_null(file);
        page[fread(page, 1, sizeof page - 1, file)] = '\0';
        fclose(file);
        if (!strstr(page, cases[i].text)) fail_msg("%s is not in it", cases[i].what);
    }
    run("view penguin", &result);
    assert_int_equal(result.code, 4);
}

TEST(tables_measure_a_scene)
{
    Result result;
    run("tables --scene tiny.cfg --repeats 3 --block 1 --format csv -o rows.h5", &result);
    if (result.code) fail_msg("%s", result.err);
    assert_string_equal(result.err, "");
    assert_memory_equal(result.out, "paper,scene,engine,particles,", 29);
    assert_non_null(strstr(result.out, "\n,tiny,brute,64,"));
    assert_true(strstr(result.out, ",VALID,") || strstr(result.out, ",BUSY,"));
    assert_true(there("rows.h5"));
    run("tables --scene tiny.cfg --repeats 1 --block 1 --threads 0 --format json", &result);
    json_t *root = json_loads(result.out, 0, NULL);
    assert_non_null(root);
    json_t *environment = json_object_get(root, "environment");
    assert_true(json_integer_value(json_object_get(environment, "threads")) >= 1);
    json_decref(root);
}

/* Row by row, those of one scene or kernel side by side, in the order of the sets. */
TEST(every_instruction_set_is_measured_in_one_run)
{
    Result result;
    char wanted[64];
    run("tables --scene tiny.cfg --isa all --repeats 1 --block 1 --format csv", &result);
    if (result.code) fail_msg("%s", result.err);
    const char *at = result.out;
    int sets = 0;
    for (int isa = 0; isa < sm_isa_count(); isa++) sets += sm_isa_there(isa);
    for (int isa = 0; isa < sm_isa_count(); isa++) {
        if (!sm_isa_there(isa)) continue;
        snprintf(wanted, sizeof wanted, "\n,tiny%s%s,", sets > 1 ? "-" : "",
                 sets > 1 ? sm_isa_name(isa) : "");
        at = strstr(at, wanted);
        if (!at) fail_msg("no %s in %s", wanted, result.out);
    }
    run("kernels --only polar --isa all --repeats 1 --format csv", &result);
    if (result.code) fail_msg("%s", result.err);
    at = result.out;
    for (int row = 0; row < 4; row++)
        for (int isa = 0; isa < sm_isa_count(); isa++) {
            if (!sm_isa_there(isa)) continue;
            snprintf(wanted, sizeof wanted, ",%s\n", sm_isa_name(isa));
            at = strstr(at, wanted);
            if (!at) fail_msg("no %s in %s", wanted, result.out);
            at += strlen(wanted);
        }
    assert_string_equal(at, "");
    run("run tiny.cfg --isa all", &result);
    assert_int_equal(result.code, 2);
}

/* An octree's options, and its mesh alone: what was made is said. */
TEST(an_octree_can_be_run)
{
    Result result;
    run("scenes block --write-mesh block.obj", &result);
    run("run block.obj --engine octree --epsilon 0.5 --particles 500 --levels 2 --nodes 120 "
        "--w 2.5 --width cells --frames 2 --steps 2 -o tree.vtkhdf",
        &result);
    if (result.code) fail_msg("%s", result.err);
    static const char *const wanted[] = {"block.obj: octree, single precision: ",
                                         " nodes",
                                         " base cells, 343 finest cells of ",
                                         "regions: w = 2.5 finest cells, epsilon 0.5: ",
                                         "deviation: goals within ",
                                         "4 steps of 0.01 s: "};
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        if (!strstr(result.out, wanted[i])) fail_msg("no '%s' in %s", wanted[i], result.out);
    assert_true(there("tree.vtkhdf") && there("tree.vtkhdf.xdmf"));
    run("run block.obj --engine octree --particles 500 --w 0.4 --frames 1 --no-output", &result);
    assert_non_null(strstr(result.out, "w = 0.4 x the node's edge"));
    assert_non_null(strstr(result.out, "the body falls into "));
    assert_non_null(strstr(result.out, "a w of 1 edge of each node's own cell joins what touches"));
    run("run block.obj --engine octree --particles 500 --w 1 --frames 1 --no-output", &result);
    assert_non_null(strstr(result.out, "the body is held together"));
    run("run wishes.cfg --no-output", &result);
    if (result.code) fail_msg("%s", result.err);
    static const char *const told[] = {"wishes: octree, single precision: 2 bodies of ",
                                       "(nearest to the 3 wanted)",
                                       "(nearest to the 1000 wanted)",
                                       ", w local at ",
                                       "regions reach ",
                                       " MB\n",
                                       "momentum of one step not kept by plain weighting, off by "};
    for (size_t i = 0; i < sizeof told / sizeof *told; i++)
        if (!strstr(result.out, told[i])) fail_msg("no '%s' in %s", told[i], result.out);
    run("run block.obj --engine octree --particles 200 --precision double --frames 1 --no-output",
        &result);
    if (result.code) fail_msg("%s", result.err);
    assert_non_null(strstr(result.out, "w = 1 x the node's edge, epsilon 0.5"));
    run("run tiny.cfg --frames 0 --no-output", &result);
    assert_non_null(strstr(result.out, "\n0 steps of 0.01 s: nothing timed\n"));
    run("run tiny.cfg --engine octree --frames 1 --no-output", &result);
    if (result.code) fail_msg("%s", result.err);
}

/* Its table: speed-ups over the lattice, summation nodes, both held to their twins. */
TEST(tables_set_the_octree_beside_the_lattice)
{
    Result result;
    run("tables --paper octree --scene lattice.cfg --scene tree.cfg --repeats 2 --block 1 "
        "--format json",
        &result);
    if (result.code) fail_msg("%s", result.err);
    json_t *root = json_loads(result.out, 0, NULL), *rows = json_object_get(root, "rows");
    assert_int_equal(json_array_size(rows), 2);
    double total[2];
    for (int r = 0; r < 2; r++) {
        json_t *row = json_array_get(rows, (size_t)r);
        total[r] = json_real_value(json_object_get(row, "total_ms"));
        double fps = json_real_value(json_object_get(row, "fps")),
               speedup = json_real_value(json_object_get(row, "speedup"));
        if (total[r] > 0) assert_true(fps * total[r] > 999.99 && fps * total[r] < 1000.01);
        if (total[0] > 0 && total[r] > 0) { /* neither is BUSY */
            assert_true(speedup * total[r] > 0.9999 * total[0]);
            assert_true(speedup * total[r] < 1.0001 * total[0]);
        }
        assert_true(json_is_null(json_object_get(row, "summation_nodes")) == (r == 0));
        assert_true(json_is_true(json_object_get(row, "valid")));
    }
    json_decref(root);
    run("tables --paper octree --scene tree.cfg --repeats 1 --block 1 --explain", &result);
    assert_non_null(strstr(result.out, "found for 9 summation nodes a region"));
    assert_non_null(strstr(result.out, "88.0")); /* the paper's */
    run("tables --paper octree --scene tree.cfg --scene lattice.cfg --repeats 1 --block 1",
        &result);
    bool busy = strstr(result.out, "BUSY");    /* a lattice that has no time gives no speed-up */
    char *row = strstr(result.out, "\ntree "); /* has waited for the lattice */
    assert_non_null(row);
    row[1 + strcspn(row + 1, "\n")] = '\0';
    if (!busy) assert_null(strstr(row, "-  VALID")); /* the column of speed-ups */
}

/* What was measured before a scene that cannot be stays; a scene that is not there stops all. */
TEST(rows_before_an_error_are_kept)
{
    Result result;
    run("tables --scene tiny.cfg --scene wide.cfg --repeats 1 --block 1", &result);
    assert_int_equal(result.code, 3);
    assert_non_null(strstr(result.out, "\ntiny "));
    assert_non_null(strstr(result.out, "On the state that was timed"));
    run("tables --scene tiny.cfg --scene wide.cfg --repeats 1 --block 1 --format json", &result);
    assert_string_equal(result.out, "");
    run("tables --scene tiny.cfg --scene no-such --repeats 1 --block 1", &result);
    assert_int_equal(result.code, 2);
    assert_string_equal(result.out, "");
}

static const char own_claims[] =
    "claims = (\n"
    "  { kind = \"method\"; paper = \"mine\"; name = \"few\"; statement = \"It has 64 "
    "particles.\"; value = 64;\n"
    "    test = \"near\"; measure = { experiment = \"scene\"; scene = \"./tiny.cfg\";\n"
    "    field = \"particles\"; }; },\n"
    "  { kind = \"method\"; paper = \"mine\"; name = \"many\"; statement = \"It has 640.\"; value "
    "= 640;\n"
    "    test = \"near\"; measure = { experiment = \"scene\"; scene = \"./tiny.cfg\";\n"
    "    field = \"particles\"; }; },\n"
    "  { kind = \"method\"; paper = \"mine\"; name = \"none\"; statement = \"It is nowhere.\"; "
    "value = 1;\n"
    "    test = \"near\"; measure = { experiment = \"scene\"; scene = \"./no.cfg\";\n"
    "    field = \"particles\"; }; } );\n";

TEST(claims_of_ones_own_decide_the_exit_code)
{
    Result result;
    write_text("own.cfg", own_claims);
    run("claims --claims own.cfg --claim few --quick -o few.h5", &result);
    assert_int_equal(result.code, 0);
    assert_true(there("few.h5") && strstr(result.out, "Of 1, 1 method: 1 reproduced."));
    run("claims --claims own.cfg --paper mine --quick --format csv -o all.h5", &result);
    assert_int_equal(result.code, 1); /* one is not reproduced, one cannot be measured */
    assert_true(there("all.h5") && strstr(result.out, ",not reproduced,"));
    assert_non_null(strstr(result.out, ",INVALID,"));
    assert_non_null(
        strstr(result.err, "2 of 3 claims are not reproduced, not as set or INVALID; first many"));
    run("claims --claims own.cfg --claims own.cfg --list", &result);
    assert_int_equal(result.code, 3);
    assert_non_null(strstr(result.err, "own.cfg:2: 'few' of 'mine' is there already"));
}

TEST(what_can_break_says_what_did)
{
    Result result;
    run("run bar-breaks --frames 1 --no-output", &result);
    assert_int_equal(result.code, 0);
    assert_non_null(strstr(result.out, "\nchanges: none\n"));
    run("run bar-breaks --frames 35 --no-output", &result);
    assert_int_equal(result.code, 0);
    const char *changes = strstr(result.out, "\nchanges: "),
               *end = strstr(result.out, "in the end");
    assert_true(changes && end && strtol(changes + 10, NULL, 10) > 0);
    assert_non_null(strstr(end, "in the end 1470 particles, and surfaces of "));
    needs_solver();
    run("run shape:block --engine shell --nodes 60 --strength 1e12 --frames 1 --no-output",
        &result);
    assert_int_equal(result.code, 0);
    assert_non_null(strstr(result.out, "\nchanges: none\n"));
}

/* A scene for other engines: its wind pulls at a shell of some hundred grams with a thousand times
 * its weight. */
TEST(a_shell_bears_any_wind)
{
    needs_solver();
    Result result;
    run("run flower --engine shell --frames 5 --no-output", &result);
    assert_int_equal(result.code, 0);
    assert_non_null(strstr(result.out, "\nforces stretched parts of it to "));
}

/* What most people have as a shell: a cloth that lies on y = 0. */
TEST(a_mesh_that_lies_flat_is_held_at_one_end)
{
    needs_solver();
    Result result;
    FILE *file = fopen(path_in("cloth.obj"), "w");
    for (int n = 0; n < 81; n++) fprintf(file, "v %d 0 %g\n", n % 9, n / 9 * 0.5);
    for (int n = 0; n < 72; n++)
        if (n % 9 < 8) fprintf(file, "f %d %d %d %d\n", n + 1, n + 2, n + 11, n + 10);
    fclose(file);
    run("run cloth.obj --engine shell --nodes 60 --frames 2 --no-output", &result);
    assert_int_equal(result.code, 0);
}

TEST(a_full_disk_is_an_error)
{
    char command[512];
    snprintf(command, sizeof command, "'%s/shapebench' scenes penguin >/dev/full 2>%s/err",
             BINARY_DIR, folder);
    int status = system(command);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 4);
}

/* Told beforehand that its file would be huge; interrupted in mid-run, it leaves none. */
TEST(a_huge_file_is_announced_and_an_interrupt_leaves_nothing)
{
    pid_t child = fork();
    if (child == 0) {
        signal(SIGINT, SIG_DFL); /* it is ignored in what a shell has started behind itself */
        if (chdir(folder) || !freopen("err", "w", stderr)) _exit(99);
        execl(BINARY_DIR "/shapebench", "shapebench", "run", "tiny.cfg", "--frames", "10000000",
              "-o", "long.vtkhdf", (char *)NULL);
        _exit(99);
    }
    char said[4096] = "", command[96];
    int status, waits = 6000; /* of 10 ms */
    while (!strstr(said, "will take") && waitpid(child, &status, WNOHANG) == 0 && waits-- > 0) {
        usleep(10000);
        slurp("err", said, sizeof said);
    }
    kill(child, SIGINT);
    waitpid(child, &status, 0);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 130);
    assert_non_null(strstr(said, "long.vtkhdf will take about 46.3 GB; --frames N writes fewer"));
    snprintf(command, sizeof command, "ls %s | grep -q long", folder);
    assert_int_not_equal(system(command), 0);
}

TEST_GROUP(set_up, remove_folder)
