
#define _GNU_SOURCE
#include <jansson.h>

#include "../../lib/test_frame.h"
#include "../measure/measure.h"
#include "quantity.h"
#include "row_table.h"

/* Columns keep their places; new ones come behind them. */
static const char header[] =
    "paper,scene,engine,particles,regions,w,epsilon,fast_sum_ms,shape_matching_ms,polar_ms,"
    "damping_ms,other_ms,total_ms,ns_per_particle_step,paper_total_ms,ratio,valid,fps,"
    "speedup,summation_nodes,last_particles,frame_ms,last_frame_ms,resampling_ms,"
    "most_resampling_ms,splitting_ms,surface_ms,nodes,modes,matrices_s,modes_s,total_low_ms,"
    "total_high_ms,steps,busy,lost_percent,load,samples_ms,isa,state_hash,cycles,"
    "instructions,"
    "cache_misses,branch_misses";

static double seconds[] = {13e-6, 14e-6, 15e-6};

/* A valid row of the paper's penguin and an invalid one without a paper. */
static void make_rows(BenchRow rows[2])
{
    rows[0] = (BenchRow){.particles = 150,
                         .regions = 130,
                         .w = 2,
                         .valid = true,
                         .total_ms = 0.014,
                         .total_low_ms = 0.013,
                         .total_high_ms = 0.015,
                         .repeats = 3,
                         .total = seconds,
                         .steps = 64,
                         .ns_per_particle_step = 93.25,
                         .fps = 1e3 / 0.014,
                         .speedup = NAN,
                         .summation_nodes = NAN,
                         .paper_total_ms = 0.28,
                         .stage_ms = {0.002, 0.003, 0.004, 0.0, 0.005},
                         .goal_tolerance = 5e-5,
                         .engine = "fastlsm",
                         .paper = "fastlsm",
                         .paper_row = "penguin",
                         .scene = "penguin",
                         .found = "goals within 2e-06 cells of brute force"};
    rows[1] = rows[0];
    rows[1].valid = false;
    rows[1].total_ms = 777.125; /* must not be seen anywhere */
    for (int s = 0; s < SM_STAGES; s++) rows[1].stage_ms[s] = 777.125;
    rows[1].ns_per_particle_step = rows[1].fps = rows[1].speedup = 777.125;
    rows[1].paper_total_ms = NAN;
    rows[1].paper[0] = rows[1].paper_row[0] = '\0';
    strcpy(rows[1].scene, "a_b,\"c\"&50%|x");
    strcpy(rows[1].reason, "goals are off");
}

static void fill_octree_row(BenchRow *row)
{
    *row = (BenchRow){.particles = 662,
                      .regions = 662,
                      .bases = 29,
                      .wanted_bases = 28,
                      .wanted_nodes = 661,
                      .cells = 29358,
                      .epsilon = 0.5,
                      .width_edges = 0.75,
                      .wanted_summation = 6,
                      .summation_nodes = 6.23,
                      .most_summation = 32,
                      .parts = 4,
                      .reached = 4.125,
                      .most_reached = 21,
                      .local_nodes = 7,
                      .welded_pairs = 3,
                      .bytes = 1500000,
                      .plain = true,
                      .momentum_error = 0.02,
                      .stage_ms = {0.01, 0.0125, 0.01, 0.0125, 0.005},
                      .valid = true,
                      .total_ms = 0.05,
                      .fps = 20000,
                      .speedup = 99.5,
                      .paper_total_ms = 4.505,
                      .damping = 0.1,
                      .engine = "octree",
                      .paper = "octree",
                      .paper_row = "hand-sampled",
                      .scene = "hand-sampled",
                      .found = "goals as the check has found them"};
}

static bool counters; /* with their table */

/* All rows at once, or one at a time; the caller frees the text. */
static char *write_rows(BenchFormat format, const BenchRow *rows, int count, bool explain,
                        bool at_once)
{
    BenchMachine machine = {.threads = 1, .cores = 2};
    strcpy(machine.cpu, "Test CPU");
    strcpy(machine.command, "run \xff");
    char *text;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    BenchTable table = {
        .format = format,
        .explain = explain,
        .report = {
            .file = file, .rows = rows, .count = count, .machine = &machine, .counters = counters}};
    for (int r = at_once ? count : 1; r <= count; r++) {
        bench_table_rows(&table, r);
        fflush(file);
    }
    bench_table_end(&table);
    fclose(file);
    return text;
}

static char *print(BenchFormat format)
{
    BenchRow rows[2];
    make_rows(rows);
    return write_rows(format, rows, 2, false, true);
}

TEST(csv_is_the_stable_interface)
{
    char *text = print(BENCH_AS_CSV), *rest = text;
    const char *const wanted[] = {
        header,
        "fastlsm,penguin,fastlsm,150,130,2,0,0.002,0.003,0.004,0,0.005,0.014,93.25,0.28,20,"
        "VALID,71428.5714,,,,,,,,,,,,,,0.013,0.015,64,0,0,0,0.013 0.014 0.015",
        ",\"a_b,\"\"c\"\"&50%|x\",fastlsm,150,130,2,0,INVALID,INVALID,INVALID,INVALID,INVALID,"
        "INVALID,INVALID,,INVALID,INVALID,INVALID,INVALID,,,INVALID,INVALID,INVALID,INVALID,"
        "INVALID,INVALID,,,INVALID,INVALID,INVALID,INVALID,64,0,0,0,INVALID"};
    for (int l = 0; l < 3; l++) {
        char *line = strsep(&rest, "\n");
        assert_int_equal(strncmp(line, wanted[l], strlen(wanted[l])), 0);
    }
    assert_string_equal(rest, "");
    free(text);
}

TEST(json_has_the_same_columns)
{
    char *text = print(BENCH_AS_JSON);
    json_t *root = json_loads(text, 0, NULL);
    assert_non_null(root);
    json_t *rows = json_object_get(root, "rows"),
           *environment = json_object_get(root, "environment");
    assert_int_equal(json_object_size(root), 2);
    assert_int_equal(json_array_size(rows), 2);
    char names[1024] = "";
    const char *name;
    json_t *value;
    json_object_foreach(json_array_get(rows, 0), name, value) snprintf(
        names + strlen(names), sizeof names - strlen(names), "%s%s", names[0] ? "," : "", name);
    assert_int_equal(strncmp(names, header, strlen(header)), 0);
    json_t *good = json_array_get(rows, 0), *bad = json_array_get(rows, 1);
    assert_true(json_is_true(json_object_get(good, "valid")));
    assert_true(json_is_false(json_object_get(bad, "valid")));
    assert_true(fabs(json_real_value(json_object_get(good, "ratio")) - 20) < 1e-9);
    static const char *const times[] = {
        "fast_sum_ms", "shape_matching_ms",    "polar_ms",   "damping_ms",     "other_ms",
        "total_ms",    "ns_per_particle_step", "ratio",      "paper_total_ms", "fps",
        "speedup",     "summation_nodes",      "samples_ms", "total_low_ms",   "total_high_ms"};
    for (int i = 0; i < 15; i++) assert_true(json_is_null(json_object_get(bad, times[i])));
    json_t *samples = json_object_get(good, "samples_ms");
    assert_int_equal(json_array_size(samples), 3);
    assert_true(fabs(json_real_value(json_array_get(samples, 1)) - 0.014) < 1e-12);
    assert_true(fabs(json_real_value(json_object_get(good, "total_high_ms")) - 0.015) < 1e-12);
    assert_string_equal(json_string_value(json_object_get(environment, "cpu")), "Test CPU");
    assert_string_equal(json_string_value(json_object_get(environment, "command")), "run ?");
    json_decref(root);
    free(text);
}

TEST(an_invalid_row_never_shows_a_time)
{
    for (BenchFormat format = BENCH_AS_TEXT; format <= BENCH_AS_JSON; format++) {
        char *text = print(format);
        assert_null(strstr(text, "777"));
        if (format != BENCH_AS_JSON) assert_non_null(strstr(text, "INVALID"));
        free(text);
    }
}

TEST(text_sets_the_paper_beside_the_measured)
{
    char *text = print(BENCH_AS_TEXT);
    static const char *const wanted[] = {"penguin",
                                         "  paper",
                                         "  14%  ",
                                         "0.0140",
                                         "20.0x",
                                         "0.280",
                                         "goals 0.0e+00, drift 0e+00; ",
                                         "INVALID: goals are off"};
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++)
        if (!strstr(text, wanted[i])) fail_msg("no \"%s\" in:\n%s", wanted[i], text);
    /* Aligned: every measured line's verdict starts at the heading's column. */
    char *heading = strstr(text, "scene ");
    long column = strstr(heading, "check") - heading;
    char *line = strstr(text, "\npenguin ") + 1;
    assert_memory_equal(line + column, "VALID\n", 6);
    free(text);
}

TEST(all_that_is_known_is_explained_when_asked_for)
{
    static const char *const wanted[] = {
        "VALID: goals within 2e-06",   "fast sum 0.00200 (paper 0.0300)",
        "93.2 ns a particle and step", "150 particles (+0.0% of the paper's)",
        "3 repeats of 64 steps",       "INVALID: goals are off",
        "penguin, paper: no damping"};
    BenchRow rows[2];
    make_rows(rows);
    char *text = write_rows(BENCH_AS_TEXT, rows, 2, true, true);
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++)
        if (!strstr(text, wanted[i])) fail_msg("no \"%s\" in:\n%s", wanted[i], text);
    free(text);
}

/* Every format; a scene that changes and a meshless one have tables of their own. */
TEST(a_table_is_the_same_when_its_rows_come_one_by_one)
{
    BenchRow rows[5];
    make_rows(rows);
    fill_octree_row(&rows[2]);
    rows[3] = rows[2];
    rows[3].change = (BenchChangeRow){.frames = 4, .first_nodes = 5, .first_ms = 0.5};
    rows[4] = rows[0];
    strcpy(rows[4].engine, "meshless");
    for (BenchFormat format = BENCH_AS_TEXT; format <= BENCH_AS_JSON; format++) {
        char *whole = write_rows(format, rows, 5, false, true);
        char *parts = write_rows(format, rows, 5, false, false);
        assert_string_equal(parts, whole);
        if (format == BENCH_AS_TEXT) assert_non_null(strstr(whole, "Meshless bodies"));
        free(whole);
        free(parts);
    }
}

/* What has been measured is there at once, but for JSON, which is one document. */
TEST(a_row_is_written_when_it_is_measured)
{
    BenchRow rows[2];
    make_rows(rows);
    BenchMachine machine = {.threads = 1};
    for (BenchFormat format = BENCH_AS_TEXT; format < BENCH_AS_JSON; format++) {
        char *text;
        size_t size;
        FILE *file = open_memstream(&text, &size);
        BenchTable table = {
            .format = format,
            .report = {.file = file, .rows = rows, .count = 2, .machine = &machine}};
        bench_table_rows(&table, 1);
        assert_non_null(strstr(text, "penguin"));
        assert_null(strstr(text, "INVALID"));
        bench_table_rows(&table, 2);
        assert_non_null(strstr(text, "INVALID"));
        bench_table_end(&table);
        fclose(file);
        free(text);
    }
}

static void count(BenchRow *row, double scale)
{
    row->cycles = 45e3 * scale;
    row->instructions = 90e3 * scale;
    row->cache_misses = 0 * scale;
    row->branch_misses = 12.5 * scale;
}

TEST(text_fits_100_characters)
{
    BenchRow rows[3];
    make_rows(rows);
    fill_octree_row(&rows[2]);
    for (int first = 0; first < 3; first++) { /* of a lattice; of an octree's paper */
        BenchRow *row = &rows[first == 1 ? 0 : first];
        strcpy(row->scene, first < 2 ? "penguins-collide" : "hand-regular-lattice");
        for (int s = 0; s < SM_STAGES; s++) row->stage_ms[s] = 0.000123456;
        row->total_ms = row->total_low_ms = row->total_high_ms = 0.000123456;
        row->momentum_error = 1e-3;
        row->left_out = 57587;
        if (first == 1) {
            strcpy(row->engine, "meshless");
            row->particles = 1370620;
        }
        count(row, 9999);
        counters = true;
        char *text = write_rows(BENCH_AS_TEXT, row, 1, false, true);
        counters = false;
        for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n"))
            if (strlen(line) > 100) fail_msg("%zu characters: %s", strlen(line), line);
        free(text);
    }
}

TEST(markdown_and_latex_escape)
{
    char *text = print(BENCH_AS_MARKDOWN);
    assert_non_null(strstr(text, "| a_b,\"c\"&50%\\|x | 150 |"));
    assert_memory_equal(text, "Measured on ", 12);
    for (char *line = strtok(strchr(text, '|'), "\n"); line; line = strtok(NULL, "\n")) {
        int bars = 0;
        for (char *c = line; *c; c++) bars += *c == '|' && (c == line || c[-1] != '\\');
        assert_int_equal(bars, 14);
    }
    free(text);
    text = print(BENCH_AS_LATEX);
    assert_non_null(strstr(text, "\na\\_b,\"c\"\\&50\\%$|$x & 150 & 130 & 2 & INVALID &"));
    assert_non_null(strstr(text, "0.00200 (14\\%)"));
    assert_non_null(strstr(text, "\\end{tabular}"));
    free(text);
}

/* A table with an octree's row has its columns, and says of what it is made. */
TEST(an_octree_has_columns_of_its_own)
{
    BenchRow row;
    static const char *const wanted[] = {
        "speedup",
        "99.5",
        "88.0",
        "4.50 ", /* of a rate that is quoted */
        "662 nodes (nearest to the 661 wanted) from 29 base cells (nearest to the 28 wanted), "
        "29358 "
        "finest cells; paper: 661 from 28;",
        "w = 0.75 x the node's edge, found for 6 summation nodes a region, w local at 7 of 662 "
        "nodes, "
        "epsilon 0.5;",
        "6.23 summation nodes a region on average (nearest to the 6 wanted), 32 at most; regions "
        "reach 4.12 finest cells on average, 21 at most",
        "falls into 4 parts that no region joins (a w of 1 edge of each node's own cell joins what "
        "touches); coarse nodes weld what does not touch: 0 inside, "
        "3 pairs; 1.5 MB",
        "summation and matching 45%, polar 20%, damping 25%, other 10% (paper, regular sampling: "
        "33/33/33)",
        "VALID: goals as the check has found them;"};
    fill_octree_row(&row);
    for (int valid = 1; valid >= 0; valid--) {
        row.valid = valid;
        char *text = write_rows(BENCH_AS_TEXT, &row, 1, true, true);
        for (size_t i = 0; i < sizeof wanted / sizeof *wanted && valid; i++)
            if (!strstr(text, wanted[i])) fail_msg("no \"%s\" in:\n%s", wanted[i], text);
        if (!valid) assert_null(strstr(text, "99.5"));
        free(text);
    }
    strcpy(row.paper_row, "hand-regular"); /* its rate is second-hand, and so what follows */
    char *text = write_rows(BENCH_AS_MARKDOWN, &row, 1, false, true);
    assert_non_null(strstr(text, "| 217* | 6211* |"));
    assert_non_null(strstr(text, "| 4.60* |"));
    free(text);
}

/* Optimised code beside optimised code, of the same body; naive sums beside nothing. */
TEST(like_is_compared_with_like)
{
    enum { ROWS = 6, FAST = 0, PLAIN = 2, SAMPLED = 4, JACOBI = 5 };
    static const struct {
        const char *scene, *engine, *polar, *summation;
        unsigned long long hash;
        double ms;
    } of[ROWS] = {{"hand-lattice", "fastlsm", "fast", "fast", 1, 2},
                  {"hand-lattice-naive", "fastlsm", "jacobi", "naive", 1, 30},
                  {"hand-lattice-plain", "fastlsm", "jacobi", "bars", 1, 12},
                  {"penguins", "fastlsm", "fast", "fast", 2, 9},
                  {"hand-sampled", "octree", "fast", "fast", 1, 0.04},
                  {"hand-sampled-jacobi", "octree", "jacobi", "fast", 1, 0.2}};
    static BenchRow rows[ROWS];
    for (int r = 0; r < ROWS; r++) {
        rows[r] = (BenchRow){.valid = true, .input_hash = of[r].hash, .total_ms = of[r].ms};
        strcpy(rows[r].paper, "octree");
        strcpy(rows[r].scene, of[r].scene);
        strcpy(rows[r].engine, of[r].engine);
        strcpy(rows[r].polar, of[r].polar);
        strcpy(rows[r].summation, of[r].summation);
        if (r >= SAMPLED) rows[r].wanted_nodes = 661;
    }
    strcpy(rows[PLAIN].paper_row, "hand-lattice-plain");
    assert_ptr_equal(bench_row_lattice(rows, ROWS, &rows[SAMPLED]), &rows[FAST]);
    assert_ptr_equal(bench_row_lattice(rows, ROWS, &rows[JACOBI]), &rows[PLAIN]);
    rows[SAMPLED].speedup = 50;
    rows[JACOBI].speedup = 60;
    char *text = write_rows(BENCH_AS_TEXT, rows, ROWS, true, true);
    assert_non_null(strstr(text, "hand-sampled is 50 times as fast as hand-lattice, both with fast "
                                 "rotations\n"));
    assert_non_null(strstr(text,
                           "hand-sampled-jacobi is 60 times as fast as hand-lattice-plain, both "
                           "with jacobi rotations (paper, Fig. 1: 88 times)"));
    assert_null(strstr(text, "as fast as penguins"));
    free(text);
    rows[PLAIN].valid = false;
    assert_null(bench_row_lattice(rows, ROWS, &rows[JACOBI]));
}

/* A liver that is cut, as measured. */
static BenchRow changing_row(void)
{
    BenchRow row = {.particles = 501,
                    .valid = true,
                    .total_ms = 0.05,
                    .paper_total_ms = 3.7,
                    .summation_nodes = 9,
                    .speedup = NAN,
                    .change = {.frames = 400,
                               .changed = 30,
                               .first_nodes = 501,
                               .most_nodes = 1548,
                               .last_nodes = 1548,
                               .most_added = 77,
                               .first_ms = 0.0625,
                               .last_ms = 0.25,
                               .change_ms = 2.5,
                               .change_most_ms = 4.75,
                               .follow_ms = 1.25,
                               .surface_ms = 0.075,
                               .first_triangles = 4400,
                               .last_triangles = 11858,
                               .pieces = 2}};
    strcpy(row.paper, "octree");
    strcpy(row.paper_row, "liver");
    strcpy(row.scene, "liver");
    strcpy(row.engine, "octree");
    return row;
}

/* A row that changes has a line in a second table, the paper's below, and its columns in CSV. */
TEST(what_changes_has_a_table_of_its_own)
{
    BenchRow row = changing_row();
    static const char *const wanted[] = {"\nWhile they change",
                                         "501 -> 1548",
                                         "0.0625 -> 0.250",
                                         "2.50 to 4.75",
                                         "1.25",
                                         "0.0750",
                                         "has 4400 triangles, at the end 11858 in 2 pieces",
                                         "500 -> 1550",
                                         "3.70* -> 15.5*",
                                         "62.0 to 124"};
    for (int valid = 1; valid >= 0; valid--)
        for (BenchFormat format = BENCH_AS_TEXT; format <= BENCH_AS_JSON; format++) {
            row.valid = valid;
            char *text = write_rows(format, &row, 1, true, true);
            for (size_t i = 0; i < sizeof wanted / sizeof *wanted && valid; i++)
                if (format == BENCH_AS_TEXT && !strstr(text, wanted[i]))
                    fail_msg("no \"%s\" in:\n%s", wanted[i], text);
            if (format == BENCH_AS_CSV && valid)
                assert_non_null(strstr(text, ",1548,0.0625,0.25,2.5,4.75,1.25,0.075,,,,,"));
            if (format == BENCH_AS_MARKDOWN) assert_non_null(strstr(text, "| 501 -> 1548 |"));
            if (format == BENCH_AS_LATEX) assert_non_null(strstr(text, " & 501 $\\to$ 1548 & "));
            if (!valid) assert_null(strstr(text, "0.25"));
            assert_null(strstr(text, "could not follow"));
            free(text);
        }
}

/* Of all rows, whether they have times or not; an invalid one has none. */
TEST(what_was_counted_has_a_table_of_its_own)
{
    static const char *const known[] = {
        "\npenguin          45000        300         90000     2.00             0           12.5\n",
        "\n| penguin | 45000 | 300 | 90000 | 2.00 | 0 | 12.5 |\n", "avx2,,45000,90000,0,12.5,",
        "\npenguin & 45000 & 300 & 90000 & 2.00 & 0 & 12.5 \\\\\n",
        "\"state_hash\": \"\",\n      \"cycles\": 45000.0,"};
    static const char *const unknown[] = {
        "\npenguin              -          -             -        -             -              -\n",
        "\n| penguin | - | - | - | - | - | - |\n", "avx2,,,,,,",
        "\npenguin & - & - & - & - & - & - ", "\"state_hash\": \"\",\n      \"cycles\": null,"};
    for (int c = 0; c < 2; c++)
        for (BenchFormat format = BENCH_AS_TEXT; format <= BENCH_AS_JSON; format++) {
            BenchRow rows[2];
            const char *wanted = (c ? known : unknown)[format];
            make_rows(rows);
            count(&rows[0], c ? 1 : NAN);
            count(&rows[1], 777);
            rows[0].busy = true; /* without times */
            strcpy(rows[0].isa, "avx2");
            counters = true;
            char *text = write_rows(format, rows, 2, false, true);
            counters = false;
            if (!strstr(text, wanted)) fail_msg("no \"%s\" in:\n%s", wanted, text);
            assert_null(strstr(text, "34965000")); /* 45e3 * 777 */
            free(text);
        }
}

/* Surfaces that a cut did not split are told of, whether the row is valid or not. */
TEST(what_a_surface_could_not_follow_is_said)
{
    for (int valid = 1; valid >= 0; valid--)
        for (long left = 0; left < 3; left++) {
            static const char *const wanted[] = {NULL, "\n    the surface of 1 body could not ",
                                                 "\n    the surface of 2 bodies could not "};
            BenchRow row = {.valid = valid, .particles = 8, .change = {.frames = 5, .left = left}};
            strcpy(row.engine, "fastlsm");
            char *text = write_rows(BENCH_AS_TEXT, &row, 1, left > 1, true);
            if (left)
                assert_non_null(strstr(text, wanted[left]));
            else
                assert_null(strstr(text, "could not follow"));
            free(text);
        }
}

/* By the stored name, the column or papers.cfg's name; texts and arrays are no numbers. */
TEST(numbers_of_a_row_are_found_by_name)
{
    static const char *const names[] = {"change_most_ms", "most_resampling_ms", "most_ms"};
    const BenchRow row = {.bytes = 7, .w = 3, .change.change_most_ms = 1.5};
    for (int n = 0; n < 3; n++)
        assert_true(bench_record_number(bench_quantity_number(names[n]), &row) == 1.5);
    assert_true(bench_record_number(bench_quantity_number("bytes"), &row) == 7);
    assert_true(bench_record_number(bench_quantity_number("w"), &row) == 3);
    assert_null(bench_quantity_number("reason"));
    assert_null(bench_quantity_number("stage_ms"));
    assert_null(bench_quantity_number("valid"));
    assert_null(bench_quantity_number(""));
}
