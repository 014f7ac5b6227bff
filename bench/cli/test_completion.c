/* What shells are offered: all that --help and the lists of names have, and nothing else. */
#include "test_program.h"

/* Is there a line that begins with this word? */
static bool offered(const Result *result, const char *word)
{
    char line[128];
    snprintf(line, sizeof line, "\n%s\t", word);
    return !strncmp(result->out, line + 1, strlen(line + 1)) || strstr(result->out, line);
}

/* How many lines there are; each has a tab. */
static int lines_of(const Result *result)
{
    int lines = 0, tabs = 0;
    for (const char *c = result->out; *c; c++) lines += *c == '\n', tabs += *c == '\t';
    assert_int_equal(lines, tabs);
    return lines;
}

/* What completing these words, quoted as a shell wants them, offers. */
static void complete(const char *words, Result *result)
{
    char arguments[512];
    snprintf(arguments, sizeof arguments, "complete %s", words);
    run(arguments, result);
    assert_int_equal(result->code, 0);
    assert_string_equal(result->err, "");
}

static void expect_offer(const char *words, const char *word)
{
    Result result;
    complete(words, &result);
    if (!offered(&result, word)) fail_msg("%s: no %s, but\n%s", words, word, result.out);
}

TEST(commands_and_their_options_are_those_of_the_help)
{
    Result commands, help, options;
    complete("''", &commands);
    assert_int_equal(lines_of(&commands), 11);
    for (char *name = strtok(commands.out, "\n"), *next; name; name = next) {
        next = strtok(NULL, "\n");
        char words[160];
        snprintf(words, sizeof words, "help %.*s", (int)strcspn(name, "\t"), name);
        run(strcmp(words, "help help") == 0 ? "help" : words, &help);
        assert_int_equal(help.code, 0);
        if (!strcmp(words, "help help")) continue;
        snprintf(words, sizeof words, "%.*s --", (int)strcspn(name, "\t"), name);
        complete(words, &options);
        int listed = 0;
        for (const char *c = help.out; (c = strstr(c, "\n  ")); c++) {
            const char *dash = strstr(c + 1, "--");
            if (!dash || dash - c > 9 || c[3 + strspn(c + 3, " ")] != '-') continue;
            char option[64];
            snprintf(option, sizeof option, "%.*s", (int)strcspn(dash, "= [\n"), dash);
            if (!strcmp(option, "--usage")) continue; /* which few miss */
            listed++;
            if (!offered(&options, option)) fail_msg("%s: no %s", words, option);
        }
        assert_int_equal(lines_of(&options), listed);
    }
}

TEST(values_are_offered_after_an_option_or_its_equals_sign)
{
    expect_offer("run hand --engine ''", "octree");
    expect_offer("run hand --engine=oct", "--engine=octree");
    expect_offer("run hand --fields sp", "speed");
    expect_offer("tables --scene pen", "penguin");
    expect_offer("tables --isa a", "all");
    expect_offer("kernels --only ''", "polar");
    expect_offer("claims --claim ''", "stiffness");
    expect_offer("claims --paper o", "octree");
    expect_offer("regress --format j", "json");
    expect_offer("regress --by c", "cycles");
    Result result;
    complete("run hand --threads ''", &result); /* a number: nothing to offer */
    assert_string_equal(result.out, "");
    complete("run hand --engine lattice", &result);
    assert_string_equal(result.out, "");
}

TEST(scenes_and_files_are_arguments)
{
    Result scenes, offers;
    run("scenes", &scenes);
    complete("run ''", &offers);
    char *end = strstr(scenes.out, "\n\n"); /* shapes follow */
    assert_non_null(end);
    *end = '\0';
    int names = 0;
    for (char *line = strtok(strchr(scenes.out, '\n'), "\n"); line; line = strtok(NULL, "\n")) {
        char name[64];
        line += strspn(line, " ");
        snprintf(name, sizeof name, "%.*s", (int)strcspn(line, " "), line);
        names += offered(&offers, name);
    }
    assert_true(names > 30);
    assert_int_equal(lines_of(&offers), names + 1);
    expect_offer("run ''", ""); /* files of any name */
    complete("report ''", &offers);
    assert_string_equal(offers.out, "\t\n");
    complete("sweep ''", &offers);
    assert_string_equal(offers.out, "\t.h5\n");
    complete("tables -o ''", &offers);
    assert_string_equal(offers.out, "\t.h5\n");
    complete("run hand -- --", &offers); /* no option behind the two dashes */
    assert_string_equal(offers.out, "\t\n");
}

TEST(words_that_make_no_sense_have_no_offers)
{
    static const char *const cases[] = {"frobnicate ''", "run hand --frob=", "frob", "", "help x"};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Result result;
        complete(cases[i], &result);
        assert_string_equal(result.out, "");
    }
}
