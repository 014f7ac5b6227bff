/* test_frame.h - the frame of a unit test: cmocka, the standard headers that nearly every test
 * needs, and main(), which runs the tests of the file in their order.
 *
 *     TEST(a_box_has_its_volume)
 *     {
 *         assert_int_equal(...);
 *     }
 */
#ifndef SM_TEST_FRAME_H
#define SM_TEST_FRAME_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "isa.h"

static struct CMUnitTest test_list[64]; /* cmocka passes over entries that are empty */
static CMFixtureFunction test_set_up, test_tear_down;

static inline void test_enlist(struct CMUnitTest test)
{
    size_t room = sizeof test_list / sizeof *test_list, n = 0;
    while (n < room && test_list[n].name) n++;
    if (n == room) abort();
    test_list[n] = test;
}

/* Defines a test. */
#define TEST(name)                                                                                 \
    static void name(void **state);                                                                \
    __attribute__((constructor)) static void enlist_##name(void)                                   \
    {                                                                                              \
        test_enlist((struct CMUnitTest)cmocka_unit_test(name));                                    \
    }                                                                                              \
    static void name(void **state __attribute__((unused)))

/* What cmocka calls before the file's first test and after its last. A later one takes the place of
 * an earlier one, so that of test_folder.h. */
#define TEST_GROUP(set_up, tear_down)                                                              \
    __attribute__((constructor)) static void test_group_##set_up(void)                             \
    {                                                                                              \
        test_set_up = set_up;                                                                      \
        test_tear_down = tear_down;                                                                \
    }

/* Ends the test as skipped, and says why. */
static inline void skip_because(const char *why)
{
    print_message("[  NOTE    ] skipped: %s\n", why);
    skip();
}

/* Goes on where the test has what it needs. */
static inline void needs(bool have, const char *why)
{
    if (!have) skip_because(why);
}

/* The same of Debian's Python and these modules of it, "h5py, numpy". */
static inline void needs_python(const char *modules)
{
    char text[128];
    snprintf(text, sizeof text, "/usr/bin/python3 -c 'import %s' 2>/dev/null", modules);
    bool have = system(text) == 0;
    snprintf(text, sizeof text, "no /usr/bin/python3 with %s", modules);
    needs(have, text);
}

/* 77, skipped, where the processor lacks the instruction set that SHAPEBENCH_ISA names. With
 * SHAPEBENCH_TEST, whose `*` and `?` stand for others, only tests of that name run. */
int main(void)
{
    SmError error;
    if (sm_isa_wanted(&error)) {
        puts(error.text);
        return 77;
    }
    cmocka_set_test_filter(getenv("SHAPEBENCH_TEST"));
    return cmocka_run_group_tests_name("tests", test_list, test_set_up, test_tear_down);
}

#endif
