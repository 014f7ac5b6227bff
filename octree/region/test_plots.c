/* Lists that change in one array against lists kept apart. */
#include "plots.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "../../fastlsm/lattice/random_bodies.h"

enum { MOST = 64, ROWS = 40 };

typedef struct {
    int count, item[MOST], also[MOST];
} Twin;

static void check(const OctPlots *plots, const Twin *twin)
{
    long live = 0;
    for (long r = 0; r < plots->rows; r++) {
        long first = plots->first[r];
        size_t bytes = (size_t)twin[r].count * sizeof(int);
        assert_int_equal(plots->end[r] - first, twin[r].count);
        if (bytes) assert_memory_equal(plots->item + first, twin[r].item, bytes);
        if (bytes && plots->also) assert_memory_equal(plots->also + first, twin[r].also, bytes);
        live += twin[r].count;
    }
    assert_int_equal(plots->live, live);
}

static void remove_item(OctPlots *plots, Twin *twin, int row, int item)
{
    int at = 0;
    while (at < twin->count && twin->item[at] != item) at++;
    assert_int_equal(oct_plots_remove(plots, row, item), at < twin->count);
    if (at == twin->count) return;
    twin->count--;
    twin->item[at] = twin->item[twin->count];
    twin->also[at] = twin->also[twin->count];
}

static void change(unsigned *seed, OctPlots *plots, Twin *twins)
{
    int row = random_int(seed, (int)plots->rows), kind = random_int(seed, 8);
    Twin *twin = twins + row;
    if (kind < 5 && twin->count < MOST) {
        int item = random_int(seed, 1000), also = random_int(seed, 1000);
        oct_plots_add(plots, row, item, also);
        twin->item[twin->count] = item;
        twin->also[twin->count++] = also;
    } else if (kind < 7 && twin->count > 0) {
        remove_item(plots, twin, row, twin->item[random_int(seed, twin->count)]);
        remove_item(plots, twin, row, -1);
    } else {
        twin->count = random_int(seed, twin->count + 1);
        oct_plots_resize(plots, row, twin->count);
    }
}

static void adopt_empty_rows(OctPlots *plots, long count, bool pairs)
{
    oct_plots_adopt(plots, count, sm_alloc((size_t)count + 1, sizeof(long)), NULL,
                    pairs ? sm_alloc(1, sizeof(int)) : NULL);
}

static void lists_stay_what_they_are_while_others_change(void **state)
{
    (void)state;
    unsigned seed = 21;
    for (int pairs = 0; pairs < 2; pairs++) {
        OctPlots plots;
        static Twin twin[ROWS];
        memset(twin, 0, sizeof twin);
        adopt_empty_rows(&plots, ROWS / 2, pairs);
        for (int step = 0; step < 20000; step++) {
            if (step == 5000) oct_plots_grow(&plots, ROWS);
            if (step == 9000) oct_plots_reserve(&plots);
            change(&seed, &plots, twin);
            if (step % 50 == 0) check(&plots, twin);
        }
        check(&plots, twin);
        oct_plots_free(&plots);
    }
}

/* Lists that take turns in growing leave gaps behind, which are closed in time. */
static void gaps_do_not_pile_up(void **state)
{
    (void)state;
    OctPlots plots;
    enum { LONG = 400 };
    adopt_empty_rows(&plots, ROWS, false);
    for (int n = 0; n < LONG; n++)
        for (int row = 0; row < ROWS; row++) oct_plots_add(&plots, row, n + row, 0);
    for (int row = 0; row < ROWS; row++)
        for (int n = 0; n < LONG; n++) assert_int_equal(plots.item[plots.first[row] + n], n + row);
    assert_true(oct_plots_bytes(&plots) < 3 * LONG * ROWS * sizeof(int));
    oct_plots_free(&plots);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_stay_what_they_are_while_others_change),
        cmocka_unit_test(gaps_do_not_pile_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
