#include <stdlib.h>
#include <unistd.h>

#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "scene.h"

#define BODY "mesh = \"shape:block\";\nparticles = 100;\n"

static SmCode parse(const char *text, BenchScene *scene, SmError *error)
{
    return bench_scene_parse(text, strlen(text), "dir/my.cfg", scene, error);
}

TEST(reads_every_kind_of_setting)
{
    BenchScene scene;
    SmError error;
    const char *text = BODY
        "title = \"A title\"; fill = \"shell\"; w = 3; h = 1; damping = 0.25; engine = \"brute\";\n"
        "summation = \"naive\"; polar = \"jacobi\"; gravity = (0, -9.81, 0);\n"
        "handles = ({ box_low = [0, 0, 0]; box_high = [1.0, 0.5, 1.0]; axis = (0, 0, 2); rate = "
        "1.5;\n"
        "             stop = 2.0; release = true; },\n"
        "           { sphere_centre = [0.0, 1.0, 0.0]; sphere_radius = 0.2; });\n"
        "planes = ({ point = [0, -1, 0]; normal = [0, 3, 4]; friction = 0.5; });\n"
        "spheres = ({ centre = [1, 2, 3]; radius = 4; });\n";
    if (parse(text, &scene, &error)) fail_msg("%s", error.text);
    assert_string_equal(scene.name, "my");
    assert_string_equal(scene.title, "A title");
    assert_int_equal(scene.voxel.fill, SM_SHELL);
    assert_int_equal(scene.voxel.particles, 100);
    assert_int_equal(scene.params.w, 3);
    assert_true(scene.params.h == 1 && scene.params.damping == 0.25);
    assert_int_equal(scene.params.summation, SM_SUM_NAIVE);
    assert_int_equal(scene.params.polar, SM_POLAR_JACOBI);
    assert_true(scene.params.gravity[1] == -9.81);
    assert_int_equal(scene.handle_count, 2);
    assert_true(scene.handle[0].axis[2] == 1 && scene.handle[0].release);
    assert_false(scene.handle[0].select.sphere);
    assert_true(scene.handle[1].select.sphere);
    assert_int_equal(scene.obstacle_count, 2);
    assert_int_equal(scene.obstacle[0].kind, SM_PLANE);
    assert_true(scene.obstacle[0].b[1] == 0.6 && scene.obstacle[0].b[2] == 0.8);
    assert_int_equal(scene.obstacle[1].kind, SM_SPHERE);
    assert_true(scene.obstacle[1].a[2] == 3 && scene.obstacle[1].radius == 4);
    /* What was left out has its default. */
    assert_int_equal(scene.instances, 1);
    assert_int_equal(scene.steps_per_frame, 4);
    assert_true(scene.params.strain_limit == 0 && scene.kick == 0);
    char said[2048], shortened[64];
    bench_scene_said(&scene, sizeof said, said);
    assert_string_equal(
        said,
        "fill = shell; particles = 100; engine = brute; w = 3; h = 1; damping = 0.25; "
        "gravity = [0, -9.81, 0]; summation = naive; polar = jacobi; handles[0].box_high = [1, "
        "0.5, 1]; handles[0].axis = [0, 0, 1]; handles[0].rate = 1.5; handles[0].stop = 2; "
        "handles[0].release = true; handles[1].sphere_centre = [0, 1, 0]; handles[1].sphere_radius "
        "= 0.2; planes[0].point = [0, -1, 0]; planes[0].normal = [0, 0.6, 0.8]; planes[0].friction "
        "= 0.5; spheres[0].centre = [1, 2, 3]; spheres[0].radius = 4; ");
    bench_scene_said(&scene, sizeof shortened, shortened);
    assert_memory_equal(shortened, said, 32);
    assert_memory_equal(shortened + 32, "; all = ", 8);
}

TEST(an_octree_has_a_group_of_settings)
{
    BenchScene scene;
    SmError error;
    const char *text = "mesh = \"a.obj\"; cells = 3000; engine = \"octree\"; epsilon = 0.5;\n"
                       "octree = { levels = 3; bases = 28; nodes = 661; balance = true;\n"
                       "  criteria = ( { kind = \"surface\"; level = 2; },\n"
                       "               { kind = \"sphere\"; centre = (1, 2, 3); radius = 0.5; },\n"
                       "               { kind = \"box\"; low = (0, 0, 0); high = (1, 1, 1); } );\n"
                       "  w = 2.5; edges = 0.75;\n"
                       "  widths = ( { low = (0, 0, 0); high = (1, 1, 2); edges = 3; },\n"
                       "             { centre = (0, 0, 1); radius = 0.1; w = 1.5; } );\n"
                       "  masses = \"volume\"; symmetry = \"intersection\"; weighting = \"plain\"; "
                       "goals = \"adjoint\"; yield = 0.1; creep = 5; most = 0.8; };";
    if (parse(text, &scene, &error)) fail_msg("%s", error.text);
    const OctOptions *o = &scene.octree;
    assert_int_equal(scene.cells, 3000);
    assert_true(o->epsilon == 0.5 && o->sampling.levels == 3 && o->sampling.bases == 28);
    assert_true(o->sampling.nodes == 661 && o->sampling.balance);
    assert_int_equal(o->sampling.criteria_count, 3);
    assert_int_equal(o->sampling.criteria[0].kind, OCT_SURFACE);
    assert_int_equal(o->sampling.criteria[0].level, 2);
    assert_int_equal(o->sampling.criteria[1].kind, OCT_SPHERE);
    assert_true(o->sampling.criteria[1].centre[2] == 3 && o->sampling.criteria[1].radius == 0.5);
    assert_int_equal(o->sampling.criteria[2].kind, OCT_BOX);
    assert_true(o->width.cells == 2.5 && o->width.edges == 0.75);
    assert_int_equal(o->local_count, 2);
    assert_true(o->local[0].width.edges == 3 && o->local[0].high[2] == 2);
    assert_true(o->local[1].width.cells == 1.5 && o->local[1].radius == 0.1);
    assert_true(o->masses == OCT_VOLUME && o->symmetry == OCT_INTERSECTION);
    assert_int_equal(o->weighting, OCT_PLAIN);
    assert_int_equal(o->form, OCT_ADJOINT);
    assert_true(o->yield == 0.1 && o->creep == 5 && o->most == 0.8);
    if (parse(BODY "octree = { summation_nodes = 6; };", &scene, &error))
        fail_msg("%s", error.text);
    assert_true(scene.octree.summation_nodes == 6);
}

#define OCTREE BODY "engine = \"octree\";"

TEST(changes_while_it_runs)
{
    static const char text[] =
        "mesh = \"shape:liver\"; particles = 100; engine = \"octree\"; instances = 1;\n"
        "cuts = ( { base_from = (1, 2, 3); tip_to = (4, 5, 6); start = 0.5; stop = 2; level = 3; "
        "},\n"
        "         { stop = 1; reach = 2; } );\n"
        "touches = ( { radius = 0.5; level = 4; hold = 0.25; } );\n"
        "view = { eye_from = (0, 0, 9); near = 2; slack = 0.1; level = 2; };\n";
    BenchScene scene;
    SmError error;
    if (bench_scene_parse(text, sizeof text - 1, "my.cfg", &scene, &error))
        fail_msg("%s", error.text);
    assert_int_equal(scene.cut_count, 2);
    assert_true(scene.cut[0].base_from[1] == 2 && scene.cut[0].tip_to[2] == 6);
    assert_true(scene.cut[0].start == 0.5 && scene.cut[0].stop == 2 && scene.cut[0].level == 3);
    assert_true(scene.cut[0].reach == 1 && scene.cut[1].reach == 2 && scene.cut[1].level == 0);
    assert_int_equal(scene.touch_count, 1);
    assert_int_equal(scene.touch[0].instance, 1);
    assert_true(scene.touch[0].radius == 0.5 && scene.touch[0].hold == 0.25);
    assert_true(scene.view.eye_from[2] == 9 && scene.view.near == 2 && scene.view.level == 2);
}

static void assert_explained(const BenchSetting *table)
{
    for (; !bench_setting_ends(table); table++) {
        if (!table->key || !table->help || !table->help[0])
            fail_msg("'%s' has no sentence", table->key ? table->key : table->option);
        if (table->table) assert_explained(table->table);
    }
}

TEST(every_setting_is_explained)
{
    assert_explained(bench_scene_settings);
}

/* Of the list, in groups, too. */
TEST(defaults_are_listed_as_they_are)
{
    char *text;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    BenchScene scene;
    bench_scene_init(&scene);
    bench_settings_document(file, bench_scene_settings, &scene, 0);
    fclose(file);
    assert_non_null(
        strstr(text, "\nh: a number from 1e-09 to 10, default 0.01\n    run --h: Time"));
    assert_non_null(strstr(text, "\nw: a whole number from 1 to 32, default 2\n"));
    assert_non_null(strstr(text, "\nfill: one of \"solid|shell\", default \"solid\"\n"));
    assert_non_null(strstr(text, "\n        poisson: a number from -0.99 to 0.49, default 0.3\n"));
    assert_non_null(
        strstr(text, "\nhandles: a list of groups: ( { ... }, { ... } ), at most 64\n"));
    free(text);
}

/* A mistake in a scene, and what the error line says. */
typedef struct {
    const char *text, *wanted;
} Mistake;

static void expect_lines(const Mistake *cases, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        BenchScene scene = {.frames = 1234};
        SmError error = {0};
        assert_int_equal(parse(cases[i].text, &scene, &error), SM_INPUT);
        if (!strstr(error.text, cases[i].wanted))
            fail_msg("wanted \"%s\", got \"%s\"", cases[i].wanted, error.text);
        assert_int_equal(scene.frames, 1234);
    }
}

TEST(errors_name_file_line_and_remedy)
{
    static const Mistake cases[] = {
        {BODY "damping_k = 1;", "dir/my.cfg:3: unknown setting 'damping_k'; known: title, paper,"},
        {BODY "w = 2.5;", "dir/my.cfg:3: 'w' must be a whole number from 1 to 32"},
        {BODY "w = 0;", "dir/my.cfg:3: 'w' must be a whole number from 1 to 32"},
        {BODY "\n\nw = \"2\";", "dir/my.cfg:5: 'w' must be"},
        {BODY "h = 0;", "dir/my.cfg:3: 'h' must be a number from 1e-09 to 10"},
        {BODY "h = 1e400;", "dir/my.cfg:3: 'h' must be a number"},
        {BODY "damping = 1.01;", "dir/my.cfg:3: 'damping' must be a number from 0 to 1"},
        {BODY "fill = \"hollow\";", "dir/my.cfg:3: 'fill' must be one of \"solid|shell\""},
        {BODY "fill = 1;", "dir/my.cfg:3: 'fill' must be one of"},
        {BODY "fill = \"solid|shell\";", "dir/my.cfg:3: 'fill' must be one of"},
        {BODY "gravity = [0, 1];", "dir/my.cfg:3: 'gravity' must be three numbers"},
        {BODY "gravity = [0, -9.81, 0];", "dir/my.cfg:3: mismatched element type in array; write"},
        {BODY "gravity = -9.81;", "dir/my.cfg:3: 'gravity' must be three numbers"},
        {BODY "title = 3;", "dir/my.cfg:3: 'title' must be text in double quotes"},
        {BODY "paper = \"a name that is far too long for a paper\";", "'paper' must be shorter"},
        {BODY "engine = \"warp\";",
         "dir/my.cfg:3: 'engine' must be one of \"fastlsm|octree|brute|meshless|shell\""},
        {BODY "handles = { rate = 1.0; };", "dir/my.cfg:3: 'handles' must be a list of groups"},
        {BODY "handles = ( 1, 2 );", "dir/my.cfg:3: 'handles' must be a list of groups"},
        {BODY "handles = (\n{ rate = 1.0;\nspeed = 2.0; } );",
         "dir/my.cfg:5: unknown setting 'speed'; known: box_low"},
        {BODY "handles = ( { rate = 1.0; } );", "dir/my.cfg: handle 1 selects nothing"},
        {BODY "handles = ( { sphere_radius = 1.0; rate = 1.0; } );",
         "handle 1 turns but has no 'axis'"},
        {BODY "handles = ( { sphere_radius = 1.0; release = 1; } );",
         "'release' must be true or false"},
        {BODY "planes = ( { point = [0, 0, 0]; } );", "plane 1 needs a 'normal'"},
        {BODY "w = ;", "dir/my.cfg:3: syntax error"},
        {BODY "w = 1;\nw = 2;", "dir/my.cfg:4: 'w' is there twice: remove one of them"},
        {BODY "h = 0.1; # w = 1;\nw = 1; title = \"w = 2\"; h= 0.2; w = 2;",
         "dir/my.cfg:4: 'h' is there twice"},
        {BODY "w = 1; handles = (\n{ rate = 1.0; }, { rate = 1.0; w : 1;rate : 2.0; } );",
         "dir/my.cfg:4: 'rate' is there twice"},
        {BODY "@include \"/dev/zero\"", "dir/my.cfg:3: '@include' is not supported"},
        {"particles = 100;", "dir/my.cfg: no 'mesh'"},
        {"mesh = \"a.obj\";", "dir/my.cfg: give one of 'particles', 'cell' and 'cells'"},
        {BODY "cell = 0.1;", "dir/my.cfg: give one of 'particles', 'cell' and 'cells'"},
        {BODY "cells = 100;", "dir/my.cfg: give one of 'particles', 'cell' and 'cells'"},
        {"", "dir/my.cfg: no 'mesh'"},
    };
    expect_lines(cases, sizeof cases / sizeof cases[0]);
}

TEST(errors_in_an_octree_are_named)
{
    static const Mistake cases[] = {
        {BODY "octree = 3;", "dir/my.cfg:3: 'octree' must be a group"},
        {BODY "octree = { level = 3; };", "dir/my.cfg:3: unknown setting 'level'; known: levels"},
        {BODY "octree = {\n levels = 13; };", "dir/my.cfg:4: 'levels' must be a whole number"},
        {BODY "octree = { w = -1; };", "'w' must be a number from 0"},
        {BODY "octree = { goals = \"sum\"; };", "'goals' must be one of \"gather|adjoint\""},
        {BODY "octree = { criteria = ( { kind = \"corner\"; } ); };", "'kind' must be one of"},
        {BODY "octree = { criteria = ( { kind = \"box\"; low = 1; } ); };", "'low' must be three"},
        {BODY "octree = { criteria = (\n{ level = 1; } ); };",
         "dir/my.cfg:4: no 'kind': give one of \"uniform|features|surface|box|sphere\""},
        {BODY "octree = { criteria = ( { kind = \"uniform\"; high = (1, 1, 1); } ); };",
         "dir/my.cfg: criterion 1: 'low' and 'high' are of the kind \"box\""},
        {BODY "octree = { criteria = ( { kind = \"box\"; high = (1, 1, 1); radius = 1; } ); };",
         "dir/my.cfg: criterion 1: "},
        {BODY "octree = { widths = ( { high = (1, 1, 1); radius = 1; w = 1; } ); };",
         "dir/my.cfg: width 1 has a box and a sphere"},
        {BODY "octree = { w = 1; summation_nodes = 6; };",
         "dir/my.cfg: the width is searched for 'summation_nodes', or given by"},
        {BODY "octree = { yield = 0.1; };", "dir/my.cfg: 'yield' and 'most' are a plastic body's"},
    };
    expect_lines(cases, sizeof cases / sizeof cases[0]);
}

TEST(errors_in_changes_are_named)
{
    static const Mistake cases[] = {
        {BODY "cuts = ( { start = 1; stop = 1; } );", "dir/my.cfg: cut 1 ends before it begins"},
        {BODY "instances = 2; cuts = ( { stop = 1; } );", "'cuts' and 'view' are of a body alone"},
        {BODY "cuts = ( { stop = 1; level = 0; } );",
         "dir/my.cfg:3: 'level' must be a whole number"},
        {OCTREE "touches = ( { radius = 1; } );", "touch 1 needs a 'radius' and a 'level'"},
        {OCTREE "touches = ( { instance = 2; radius = 1; level = 2; } );",
         "touch 1 is on instance 2, and there are 1"},
        {OCTREE "view = { level = 3; };", "'view' needs 'near', a distance above 0"},
    };
    expect_lines(cases, sizeof cases / sizeof cases[0]);
}

TEST(refuses_zero_bytes_and_huge_files)
{
    BenchScene scene;
    SmError error;
    static const char zero[] = "w = 2;\n\0w = 3;";
    assert_int_equal(bench_scene_parse(zero, sizeof zero, "z.cfg", &scene, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "z.cfg:2: not a scene file"));
    size_t size = 3 << 20;
    char *huge = malloc(size);
    memset(huge, ' ', size);
    assert_int_equal(bench_scene_parse(huge, size, "z.cfg", &scene, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "over 1048576 bytes"));
    memset(huge, '(', 1 << 20); /* as deep as it gets */
    assert_int_equal(bench_scene_parse(huge, 1 << 20, "z.cfg", &scene, &error), SM_INPUT);
    free(huge);
}

TEST(too_many_obstacles_are_an_error)
{
    char text[16384] = BODY "spheres = (";
    for (int i = 0; i < 65; i++) strcat(text, i ? ", { radius = 1; }" : "{ radius = 1; }");
    strcat(text, ");");
    BenchScene scene;
    SmError error;
    assert_int_equal(parse(text, &scene, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "a list of at most 64 groups"));
    strcpy(strstr(text, ", { radius"), ");\nboxes = (");
    for (int i = 0; i < 64; i++) strcat(text, i ? ", { friction = 1; }" : "{ friction = 1; }");
    strcat(text, ");");
    assert_int_equal(parse(text, &scene, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "more than 64 planes, spheres, boxes and capsules"));
}

TEST(every_built_in_scene_parses)
{
    int count = 0;
    for (const char *const *name = bench_scene_names(); *name; name++, count++) {
        BenchScene scene;
        SmError error;
        if (bench_scene_find(*name, &scene, &error)) fail_msg("%s", error.text);
        assert_string_equal(scene.name, *name);
        assert_true(scene.title[0] != '\0');
        assert_memory_equal(scene.mesh, "shape:", 6);
    }
    assert_true(count >= 4);
    static const char *const rows[] = {"penguin", "statue-solid", "statue-shell", "infant"};
    for (int i = 0; i < 4; i++) assert_non_null(bench_scene_text(rows[i], NULL));
    assert_null(bench_scene_text("no-such", NULL));
}

/* Cut anywhere, a scene file is a scene or an error line, never a crash. */
TEST(every_prefix_is_handled)
{
    size_t size;
    const char *text = bench_scene_text("penguins", &size);
    for (size_t cut = 0; cut <= size; cut++) {
        BenchScene scene;
        SmError error = {0};
        SmCode code = bench_scene_parse(text, cut, "cut.cfg", &scene, &error);
        if (code) {
            assert_int_equal(code, SM_INPUT);
            assert_memory_equal(error.text, "cut.cfg", 7);
        } else {
            assert_int_equal(scene.params.w >= 1, 1);
        }
    }
}

TEST(paths_are_relative_to_the_file)
{
    const char *path =
        write_text("own.cfg", "mesh = \"part/a.obj\"; vertex_mass = \"/abs/m.txt\"; cell = 0.5;");
    BenchScene scene;
    SmError error;
    assert_int_equal(bench_scene_find(path, &scene, &error), SM_OK);
    char wanted[96];
    snprintf(wanted, sizeof wanted, "%s/part/a.obj", folder);
    assert_string_equal(scene.mesh, wanted);
    assert_string_equal(scene.vertex_mass, "/abs/m.txt");
    assert_string_equal(scene.name, "own");
    assert_int_equal(bench_scene_read(folder, &scene, &error), SM_INPUT);
    unlink(path);
    assert_int_equal(bench_scene_read(path, &scene, &error), SM_INPUT);
    assert_non_null(strstr(error.text, "no such file"));
    assert_int_equal(bench_scene_find("no-such-scene", &scene, &error), SM_USAGE);
    assert_non_null(strstr(error.text, "shapebench scenes"));
}
