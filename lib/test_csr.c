/* Rows that change in one array against lists kept apart; sorting of short and long lists. */
#include "csr.h"

#include "test_frame.h"
#include "test_random.h"

enum { MOST = 64, ROWS = 40 };

typedef struct {
    int count, item[MOST], value[MOST];
} Twin;

static void check(const SmCsr *csr, const Twin *twin)
{
    long live = 0;
    for (long r = 0; r < csr->rows; r++) {
        long first = csr->first[r];
        size_t bytes = (size_t)twin[r].count * sizeof(int);
        assert_int_equal(csr->end[r] - first, twin[r].count);
        if (bytes) assert_memory_equal(csr->item + first, twin[r].item, bytes);
        if (bytes && csr->value)
            assert_memory_equal((int *)csr->value + first, twin[r].value, bytes);
        live += twin[r].count;
    }
    assert_int_equal(csr->live, live);
}

static void remove_item(SmCsr *csr, Twin *twin, int row, int item)
{
    int at = 0;
    while (at < twin->count && twin->item[at] != item) at++;
    assert_int_equal(sm_csr_remove(csr, row, item), at < twin->count);
    if (at == twin->count) return;
    twin->count--;
    twin->item[at] = twin->item[twin->count];
    twin->value[at] = twin->value[twin->count];
}

static void change(unsigned *seed, SmCsr *csr, Twin *twins)
{
    int row = random_int(seed, (int)csr->rows), kind = random_int(seed, 8);
    Twin *twin = twins + row;
    if (kind < 5 && twin->count < MOST) {
        int item = random_int(seed, 1000), value = random_int(seed, 1000);
        sm_csr_add(csr, row, item, &value);
        twin->item[twin->count] = item;
        twin->value[twin->count++] = value;
    } else if (kind < 7 && twin->count > 0) {
        remove_item(csr, twin, row, twin->item[random_int(seed, twin->count)]);
        remove_item(csr, twin, row, -1);
    } else {
        twin->count = random_int(seed, twin->count + 1);
        sm_csr_resize(csr, row, twin->count);
    }
}

static void adopt_empty_rows(SmCsr *csr, long count, bool values)
{
    sm_csr_adopt(csr, count, sm_alloc((size_t)count + 1, sizeof(long)), NULL,
                 values ? sm_alloc(1, sizeof(int)) : NULL, values ? sizeof(int) : 0);
}

TEST(lists_stay_what_they_are_while_others_change)
{
    unsigned seed = 21;
    for (int values = 0; values < 2; values++) {
        SmCsr csr;
        static Twin twin[ROWS];
        memset(twin, 0, sizeof twin);
        adopt_empty_rows(&csr, ROWS / 2, values);
        for (int step = 0; step < 20000; step++) {
            if (step == 5000) sm_csr_grow(&csr, ROWS);
            if (step == 9000) sm_csr_reserve(&csr);
            change(&seed, &csr, twin);
            if (step % 50 == 0) check(&csr, twin);
        }
        check(&csr, twin);
        sm_csr_free(&csr);
    }
}

/* Made of parts in blocks, rows follow each other until one is changed, and take no more memory
 * than where each begins. */
TEST(rows_of_parts_follow_each_other)
{
    enum { LONG = 200 };
    SmCsr csr;
    SmCsrParts parts;
    static Twin twin[LONG];
    unsigned seed = 4;
    sm_csr_parts_init(&parts, LONG);
    for (long b = parts.blocks - 1; b >= 0; b--)
        for (long r = sm_csr_parts_from(b); r < sm_csr_parts_to(&parts, b); r++) {
            twin[r] = (Twin){.count = random_int(&seed, 20)};
            for (int n = 0; n < twin[r].count; n++) twin[r].item[n] = random_int(&seed, 1000);
            int half = twin[r].count / 2; /* in two goes */
            sm_csr_parts_add(&parts, r, twin[r].item, half);
            sm_csr_parts_add(&parts, r, twin[r].item + half, twin[r].count - half);
        }
    sm_csr_parts_join(&parts, &csr, sizeof(int));
    check(&csr, twin);
    for (long r = 0; r < LONG; r++) assert_int_equal(csr.end[r], csr.first[r + 1]);
    sm_csr_grow(&csr, LONG); /* there are as many */
    for (int step = 0; step < 2000; step++) change(&seed, &csr, twin);
    check(&csr, twin);
    sm_csr_free(&csr);
}

/* Lists that take turns in growing leave gaps behind, which are closed in time. */
TEST(gaps_do_not_pile_up)
{
    SmCsr csr;
    enum { LONG = 400 };
    adopt_empty_rows(&csr, ROWS, false);
    for (int n = 0; n < LONG; n++)
        for (int row = 0; row < ROWS; row++) sm_csr_add(&csr, row, n + row, NULL);
    for (int row = 0; row < ROWS; row++)
        for (int n = 0; n < LONG; n++) assert_int_equal(csr.item[csr.first[row] + n], n + row);
    assert_true(csr.space < 3 * LONG * ROWS);
    sm_csr_free(&csr);
}

TEST(lists_are_sorted)
{
    enum { LONGEST = 500 };
    unsigned seed = 3;
    for (int trial = 0; trial < 2000; trial++) {
        int item[LONGEST], sorted[LONGEST], count = random_int(&seed, trial % 2 ? LONGEST : 20);
        for (int n = 0; n < count; n++) item[n] = random_int(&seed, 1 + trial);
        memcpy(sorted, item, sizeof item[0] * (size_t)count);
        qsort(sorted, (size_t)count, sizeof *sorted, sm_compare_ints);
        sm_sort_ints(item, count);
        assert_memory_equal(item, sorted, sizeof item[0] * (size_t)count);
    }
}
