/* The bar and the time that is left; colours. */
#include "../../lib/system/clock.h"
#include "../../lib/test_frame.h"
#include "../table/grid.h"
#include "progress.h"
#include "terminal.h"

#include <pty.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

TEST(time_left_is_in_words)
{
    static const struct {
        double seconds;
        const char *words;
    } cases[] = {{0, "0 s left"},
                 {89.4, "89 s left"},
                 {90, "2 min left"},
                 {720, "12 min left"},
                 {5400, "1 h 30 min left"},
                 {11100, "3 h 5 min left"},
                 {NAN, ""},
                 {-1, ""},
                 {INFINITY, ""}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        char text[24];
        bench_progress_left(cases[c].seconds, text);
        assert_string_equal(text, cases[c].words);
    }
}

/* What is drawn on standard error, which a file takes. */
static void drawn(BenchProgress *progress, double share, char text[200])
{
    FILE *file = tmpfile();
    int kept = dup(STDERR_FILENO);
    assert_non_null(file);
    dup2(fileno(file), STDERR_FILENO);
    progress->last = 0;
    bench_progress_show(progress, "hand", share);
    dup2(kept, STDERR_FILENO);
    close(kept);
    rewind(file);
    text[fread(text, 1, 199, file)] = '\0';
    fclose(file);
}

/* By what the share done took; nothing at first, nor when a share falls. */
TEST(time_left_follows_what_was_done)
{
    BenchProgress progress = {.shown = true};
    char text[200];
    drawn(&progress, 0, text);
    assert_null(strstr(text, "left"));
    assert_non_null(strstr(text, "hand "));
    progress.since = sm_now() - 30;
    drawn(&progress, 0.25, text);
    assert_non_null(strstr(text, " 25%  2 min left"));
    drawn(&progress, 0.5, text);
    assert_non_null(strstr(text, " 50%  30 s left"));
    bench_progress_part(&progress, 3, 4); /* of four scenes the last */
    drawn(&progress, 0, text);
    assert_non_null(strstr(text, " 75%  10 s left"));
    bench_progress_part(&progress, 0, 4);
    drawn(&progress, 0.5, text);
    assert_non_null(strstr(text, " 12%"));
    assert_null(strstr(text, "left"));
}

TEST(nothing_is_drawn_where_there_is_no_terminal)
{
    BenchProgress progress;
    char text[200];
    bench_progress_start(&progress, true);
    drawn(&progress, 0.5, text);
    assert_string_equal(text, "");
}

/* What a table with one row of this verdict is on this stream. */
static void table_of(FILE *to, const char *verdict)
{
    BenchGrid grid = {0};
    bench_grid_column(&grid, "scene", true);
    bench_grid_column(&grid, "check", false);
    BenchGridLine *line = bench_grid_add(&grid);
    strcpy((*line)[0], "hand");
    strcpy((*line)[1], verdict);
    bench_grid_whole(to, &grid, BENCH_GRID_PLAIN);
    bench_grid_free(&grid);
    fflush(to);
}

/* Its two lines may come one by one. */
static void seen_on_terminal(const char *verdict, char text[200])
{
    int master, slave;
    size_t got = 0;
    assert_int_equal(openpty(&master, &slave, NULL, NULL, NULL), 0);
    FILE *terminal = fdopen(slave, "w");
    table_of(terminal, verdict);
    for (int lines = 0; lines < 2 && got < 199 && read(master, text + got, 1) == 1; got++)
        lines += text[got] == '\n';
    text[got] = '\0';
    fclose(terminal);
    close(master);
}

TEST(verdicts_have_colours_on_a_terminal_alone)
{
    char text[200];
    setenv("TERM", "xterm", 1);
    unsetenv("NO_COLOR");
    seen_on_terminal("VALID", text);
    assert_string_equal(
        text, "\033[1mscene\033[0m  \033[1mcheck\033[0m\r\nhand   \033[32mVALID\033[0m\r\n");
    seen_on_terminal("INVALID", text);
    assert_non_null(strstr(text, "hand   \033[31mINVALID\033[0m\r\n"));
    setenv("NO_COLOR", "1", 1);
    seen_on_terminal("VALID", text);
    assert_string_equal(text, "scene  check\r\nhand   VALID\r\n");
    unsetenv("NO_COLOR");
    setenv("TERM", "dumb", 1);
    seen_on_terminal("VALID", text);
    assert_null(strchr(text, '\033'));
    setenv("TERM", "xterm", 1);
    FILE *file = tmpfile();
    assert_non_null(file);
    table_of(file, "VALID");
    rewind(file);
    text[fread(text, 1, 199, file)] = '\0';
    fclose(file);
    assert_string_equal(text, "scene  check\nhand   VALID\n");
}
