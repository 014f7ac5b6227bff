/* Files that are not what they are taken for, by the program: it neither waits nor fills memory,
 * says what is wrong in one line, and hands nothing of theirs on that a terminal or a spreadsheet
 * would act on. */
#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../../lib/test_frame.h"
#include "../store/export.h"
#include "command.h"
#include "test_program.h"

/* Not waiting for anything: 120 s are enough on any machine. */
static void assert_refused(const char *arguments, const char *wanted)
{
    Result result;
    run_with("timeout 120", arguments, &result);
    if (result.code != 3 || !strstr(result.err, wanted) || strchr(result.err, '\n')[1])
        fail_msg("shapebench %s: exit code %d, not 3 with \"%s\":\n%s", arguments, result.code,
                 wanted, result.err);
}

TEST(pipes_and_devices_are_refused_at_once)
{
    static const char *const ends[] = {".cfg", ".xyz", ".ply", ".obj", ".h5"};
    static const char *const commands[] = {"run pipe.cfg",
                                           "run zero.cfg",
                                           "claims --list --claims pipe.cfg",
                                           "claims --list --claims zero.cfg",
                                           "run pipe.xyz --engine meshless",
                                           "run zero.xyz --engine meshless",
                                           "info zero.xyz",
                                           "run pipe.ply --engine meshless",
                                           "run zero.ply --engine meshless",
                                           "run pipe.obj",
                                           "run penguin --mesh penguin=zero.obj",
                                           "run masses.cfg --no-output",
                                           "report pipe.h5 -o report.html",
                                           "report zero.h5 -o report.html"};
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        char name[32];
        snprintf(name, sizeof name, "pipe%s", ends[i]);
        assert_int_equal(mkfifo(path_in(name), 0600), 0);
        snprintf(name, sizeof name, "zero%s", ends[i]);
        assert_int_equal(symlink("/dev/zero", path_in(name)), 0);
    }
    write_text("masses.cfg",
               "mesh = \"shape:block\"; particles = 64; w = 1; vertex_mass = \"pipe.xyz\";\n");
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        assert_refused(commands[i], "pipe or device");
}

/* Bodies that fall through a thin box are told of, and what is said of the box holds them. */
TEST(a_step_too_long_is_said)
{
    static const struct {
        double low;
        const char *option, *said;
    } box[] = {{-1.02, "", "particles passed through box 1, which is 0.02 thick"},
               {-1.14, "", ""},
               {-1.02, " --h 0.001 --steps 100", ""},
               {-1.02, " --h 10", "a step took a particle up to "}};
    for (int i = 0; i < 4; i++) {
        char text[512], line[128];
        Result result;
        snprintf(
            text, sizeof text,
            "mesh = \"shape:block\"; particles = 60; damping = 0.1; gravity = [0.0, -9.81, 0.0];"
            "boxes = ( { low = [-1.0, %g, -1.0]; high = [1.0, -1.0, 1.0]; } );\n"
            "steps_per_frame = 10; frames = 10;\n",
            box[i].low);
        write_text("thin.cfg", text);
        snprintf(line, sizeof line, "run thin.cfg --no-output%s", box[i].option);
        run_with("", line, &result);
        if (*box[i].said ? !strstr(result.err, box[i].said) : *result.err)
            fail_msg("%d: %s", i, result.err);
    }
}

/* Points without an end of line, in a file that takes nothing of the disk. */
TEST(lines_have_an_end)
{
    write_text("sparse.xyz", "0 0 0 0 0 1\n");
    assert_int_equal(truncate(path_in("sparse.xyz"), (off_t)1 << 40), 0);
    assert_refused("run sparse.xyz --engine meshless", "there is no memory for it");
    char *blanks = malloc(3000000);
    memset(blanks, ' ', 3000000);
    write_bytes("long.xyz", blanks, 3000000);
    free(blanks);
    assert_refused("run long.xyz --engine meshless", "it holds no points");
}

TEST(points_are_told_of_the_engine_that_takes_them)
{
    write_text("cloud.ply", "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
                            "property float y\nproperty float z\nend_header\n0 0 0\n1 1 1\n");
    write_text("cloud.txt", "0 0 0 0 0 1\n");
    assert_refused("run cloud.ply", "'run --engine meshless' takes points with normals");
    assert_refused("run cloud.txt", "'run --engine meshless' takes points with normals");
    assert_refused("info cloud.ply", "'run --engine meshless' takes points with normals");
}

/* One sliver across its box, of which 35,000 particles would need too large a lattice. */
TEST(a_default_is_never_refused)
{
    Result result;
    write_text("sliver.obj", "v 0 0 0\nv 1 0.3 0.2\nv 1 0.3001 0.2\nf 1 2 3\n");
    run("run sliver.obj --engine octree --shell --no-output --frames 0", &result);
    assert_null(strstr(result.err, "too large a lattice"));
    assert_non_null(strstr(result.out, "octree, single precision: "));
    assert_refused("run sliver.obj --engine octree --shell --no-output --particles 35000",
                   "ask for that many");
}

/* Of what runs, and of what fails. */
static void assert_shown_safely(const char *arguments, int code, const char *wanted)
{
    Result result;
    run(arguments, &result);
    if (result.code != code || strpbrk(result.out, "\x1b\a\b\x7f") ||
        strpbrk(result.err, "\x1b\a\b\x7f") || strstr(result.out, "\xc2\x9b") ||
        (!strstr(result.out, wanted) && !strstr(result.err, wanted)))
        fail_msg("shapebench %s: exit code %d, not %d with \"%s\":\n%s%s", arguments, result.code,
                 code, wanted, result.out, result.err);
}

TEST(no_escape_code_of_a_file_reaches_the_terminal)
{
    static const char mesh[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                               "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    write_text("\x1b[31mred.obj", mesh);
    write_text("\x1b[31mbad.obj", "f 1 2 3\n");
    write_text("csi\xc2\x9b.obj", mesh);
    write_text("\x1b]0;title\a.cfg", "mesh = \"shape:block\"; particles = 64; w = 1;\n");
    write_text("title.cfg", "title = \"\\x1b[31m\"; mesh = \"shape:block\"; particles = 64;\n");
    write_text("word.cfg", "mesh = \"shape:block\";\n\x1b[31m = 1;\n");
    write_text("group.obj", "g \x1b[31m\nusemtl \x1b[31m\nv 0 0 0\nf 1 2 \x1b[31m\n");
    assert_shown_safely("info '\x1b[31mred.obj'", 0, "?[31mred.obj\n");
    assert_shown_safely("info 'csi\xc2\x9b.obj'", 0, "csi??.obj\n");
    assert_shown_safely("run '\x1b[31mred.obj' --frames 0 -o red.vtkhdf", 0, "?[31mred.obj: ");
    assert_shown_safely("info '\x1b[31mbad.obj'", 3, "?[31mbad.obj: ");
    assert_shown_safely("info '\x1b[31mabsent.obj'", 3, "?[31mabsent.obj: ");
    assert_shown_safely("run '\x1b]0;title\a.cfg' --frames 0 --no-output", 0, "?]0;title?: ");
    assert_shown_safely("run title.cfg", 3, "UTF-8 without control characters");
    assert_shown_safely("run word.cfg", 3, "word.cfg:2");
    assert_shown_safely("info group.obj", 3, "group.obj: ");
    assert_shown_safely("run penguin --polar '\x1b[31m'", 2, "?[31m");
}

TEST(no_cell_is_a_formula)
{
    static const char *const cells[][2] = {{"=1+1", "\"'=1+1\""},
                                           {"@SUM(A1)", "\"'@SUM(A1)\""},
                                           {"+1", "+1"},
                                           {"-2.5e3", "-2.5e3"},
                                           {"-cmd|x", "\"'-cmd|x\""},
                                           {"plain", "plain"},
                                           {"a=1", "a=1"},
                                           {"+1,=2", "\"'+1,=2\""},
                                           {"", ""},
                                           {"=\"a\"", "\"'=\"\"a\"\"\""}};
    for (size_t i = 0; i < sizeof cells / sizeof *cells; i++) {
        char *text;
        size_t size;
        FILE *file = open_memstream(&text, &size);
        bench_csv_text(file, cells[i][0]);
        fclose(file);
        assert_string_equal(text, cells[i][1]);
        free(text);
    }
}
