/* What a file that is written may be, and what is left when the writer ends early. */
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../../lib/test_folder.h"
#include "../../lib/test_frame.h"
#include "../system/interrupt.h"
#include "draft.h"

static void print(FILE *file, const void *what)
{
    fputs(what, file);
}

static void writes(const char *name, const char *text)
{
    SmError error = {0};
    if (bench_draft_write(path_in(name), print, text, &error)) fail_msg("%s", error.text);
}

static void holds(const char *name, const char *text)
{
    char found[64] = "";
    FILE *file = fopen(path_in(name), "r");
    assert_non_null(file);
    assert_non_null(fgets(found, sizeof found, file));
    fclose(file);
    assert_string_equal(found, text);
}

/* Writing `path` fails with these words, and changes nothing. */
static void refused(const char *path, const char *words)
{
    SmError error = {0};
    struct stat before, after;
    int there = lstat(path, &before), count = entries("");
    assert_int_equal(bench_draft_write(path, print, "new", &error), SM_OUTPUT);
    if (!strstr(error.text, words)) fail_msg("'%s' does not say '%s'", error.text, words);
    assert_int_equal(lstat(path, &after), there);
    if (!there) assert_true(before.st_ino == after.st_ino && before.st_mode == after.st_mode);
    assert_int_equal(entries(""), count);
}

static void make_link(const char *name, const char *to)
{
    unlink(path_in(name));
    assert_int_equal(symlink(to, path_in(name)), 0);
}

static void stays_a_link(const char *name)
{
    struct stat status;
    assert_int_equal(lstat(path_in(name), &status), 0);
    assert_true(S_ISLNK(status.st_mode));
}

TEST(a_link_stays_and_its_target_is_written)
{
    assert_int_equal(mkdir(path_in("far"), 0777), 0);
    write_text("far/real", "old");
    assert_int_equal(chmod(path_in("far/real"), 0640), 0);
    make_link("second", "far/real");
    make_link("first", "second");
    writes("first", "through two links");
    holds("far/real", "through two links");
    stays_a_link("first");
    stays_a_link("second");
    struct stat status;
    assert_int_equal(stat(path_in("far/real"), &status), 0);
    assert_int_equal(status.st_mode & 07777, 0640); /* who may read it is not ours to change */
    make_link("dangling", "far/new");
    writes("dangling", "made through a link");
    holds("far/new", "made through a link");
    stays_a_link("dangling");
    make_link("round", "round");
    refused(path_in("round"), "symbolic links");
}

TEST(what_is_no_file_is_refused)
{
    refused("/dev/null", "not a regular file");
    refused(folder, "not a regular file");
    assert_int_equal(mkfifo(path_in("pipe"), 0666), 0);
    refused(path_in("pipe"), "not a regular file");
    make_link("null", "/dev/null");
    refused(path_in("null"), "not a regular file");
    write_text("behind", "old");
    make_link("out", "/proc/self/fd/1");
    int saved = dup(STDOUT_FILENO); /* our standard output is a regular file, its name a device's */
    assert_non_null(freopen(path_in("behind"), "a", stdout));
    SmError error = {0};
    SmCode code = bench_draft_write(path_in("out"), print, "new", &error);
    SmCode direct = bench_draft_write("/proc/self/fd/1", print, "new", &error);
    fflush(stdout);
    dup2(saved, STDOUT_FILENO);
    close(saved);
    assert_int_equal(code, SM_OUTPUT);
    assert_int_equal(direct, SM_OUTPUT);
    stays_a_link("out");
}

/* Also from root, whom the kernel lets write them. */
TEST(what_is_write_protected_is_refused)
{
    write_text("protected", "old");
    assert_int_equal(chmod(path_in("protected"), 0444), 0);
    refused(path_in("protected"), "write-protected");
    make_link("indirect", "protected");
    refused(path_in("indirect"), "write-protected");
    holds("protected", "old");
}

/* Somebody else's link under the draft's name would send our bytes where it points. */
TEST(a_draft_is_a_new_file)
{
    char name[64];
    write_text("precious", "precious");
    snprintf(name, sizeof name, "mine.%ld.tmp", (long)getpid());
    make_link(name, "precious");
    writes("mine", "new");
    holds("mine", "new");
    holds("precious", "precious");
    stays_a_link(name);
    unlink(path_in(name));
}

TEST(a_file_that_is_there_is_replaced_only_when_asked)
{
    SmError error = {0};
    write_text("results", "old");
    assert_int_equal(bench_draft_reserve(NULL, false, &error), SM_OK);
    assert_int_equal(bench_draft_reserve(NULL, true, &error), SM_USAGE);
    assert_int_equal(bench_draft_reserve(path_in("absent"), false, &error), SM_OK);
    assert_int_equal(bench_draft_reserve(path_in("results"), false, &error), SM_OUTPUT);
    assert_non_null(strstr(error.text, "--overwrite"));
    bench_drafts_remove(); /* as at the program's end */
    assert_int_equal(entries(".lock"), 0);
    holds("results", "old");
}

/* In a child, because a lock is held until its program ends. */
static void while_one_program_writes(const char *name, int number)
{
    int ends[2];
    char byte;
    assert_int_equal(pipe(ends), 0);
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        bench_interrupt_catch();
        if (bench_draft_reserve(path_in(name), true, NULL)) _exit(9);
        if (write(ends[1], "x", 1) != 1) _exit(9);
        pause();
    }
    assert_int_equal(read(ends[0], &byte, 1), 1);
    char words[64];
    SmError error = {0};
    snprintf(words, sizeof words, "process %ld on ", (long)child);
    assert_int_equal(bench_draft_reserve(path_in(name), true, &error), SM_OUTPUT);
    assert_non_null(strstr(error.text, words));
    kill(child, number);
    waitpid(child, NULL, 0);
    close(ends[0]);
    close(ends[1]);
}

TEST(two_programs_do_not_write_one_file)
{
    while_one_program_writes("sweep", SIGTERM);
    assert_int_equal(entries(".lock"), 0);
    while_one_program_writes("sweep", SIGKILL); /* its lock file stays, its lock does not */
    assert_int_equal(entries(".lock"), 1);
    SmError error = {0};
    assert_int_equal(bench_draft_reserve(path_in("sweep"), true, &error), SM_OK);
    bench_drafts_remove();
    assert_int_equal(entries(".lock"), 0);
}

/* A child that holds a draft and a lock gets the signal, or ends by exit(). */
static int end_of_writer(int number)
{
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        BenchDraft draft;
        if (!freopen("/dev/null", "w", stderr)) _exit(9);
        bench_interrupt_catch();
        if (bench_draft_reserve(path_in("early"), true, NULL)) _exit(9);
        if (bench_draft_begin(path_in("early"), &draft, NULL)) _exit(9);
        if (number) raise(number);
        exit(SM_MEMORY);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

TEST(no_signal_leaves_a_draft)
{
    int count = entries("");
    for (int i = 0; i < BENCH_INTERRUPT_SIGNALS; i++)
        assert_int_equal(end_of_writer(bench_interrupt_signals[i]),
                         128 + bench_interrupt_signals[i]);
    assert_int_equal(end_of_writer(SIGPIPE), 128 + SIGPIPE);
    assert_int_equal(end_of_writer(SIGXFSZ), SM_MEMORY); /* a write that fails is told instead */
    assert_int_equal(end_of_writer(0), SM_MEMORY);
    assert_int_equal(entries(""), count);
}
