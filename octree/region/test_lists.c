/* Sorting of short and long lists. */
#include "lists.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../../fastlsm/lattice/random_bodies.h"

static void lists_are_sorted(void **state)
{
    (void)state;
    enum { MOST = 500 };
    unsigned seed = 3;
    for (int trial = 0; trial < 2000; trial++) {
        int item[MOST], sorted[MOST], count = random_int(&seed, trial % 2 ? MOST : 20);
        for (int n = 0; n < count; n++) item[n] = random_int(&seed, 1 + trial);
        memcpy(sorted, item, sizeof item[0] * (size_t)count);
        qsort(sorted, (size_t)count, sizeof *sorted, oct_lists_compare);
        oct_lists_sort(item, count);
        assert_memory_equal(item, sorted, sizeof item[0] * (size_t)count);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_are_sorted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
