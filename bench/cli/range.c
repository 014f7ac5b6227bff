#include "range.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

typedef struct {
    double first, last, step;
} Range;

static bool read_number(const char **text, double *value)
{
    char *end;
    *value = strtod(*text, &end);
    bool good = end != *text && isfinite(*value);
    *text = end;
    return good;
}

/* One item of the list; `text` is then at its end. */
static bool read_range(const char **text, Range *range)
{
    if (!read_number(text, &range->first)) return false;
    range->last = range->first;
    range->step = 1;
    if (**text == ':') {
        (*text)++;
        if (!read_number(text, &range->last)) return false;
        if (**text == ':') {
            (*text)++;
            if (!read_number(text, &range->step)) return false;
        }
    }
    return **text == ',' || **text == '\0';
}

static SmCode check(const char *name, const Range *range, double low, double high, SmError *error)
{
    if (!(range->step > 0))
        return sm_fail(error, SM_USAGE, "%s: the step %g is not above 0", name, range->step);
    if (range->last < range->first)
        return sm_fail(error, SM_USAGE, "%s: %g:%g falls: give the smaller number first", name,
                       range->first, range->last);
    if (range->first < low || range->last > high)
        return sm_fail(error, SM_USAGE, "%s: %g is not from %g to %g", name,
                       range->first < low ? range->first : range->last, low, high);
    return SM_OK;
}

SmCode bench_range_parse(const char *name, const char *text, double low, double high, int most,
                         double *value, int *count, SmError *error)
{
    const char *place = text;
    *count = 0;
    for (;;) {
        Range range;
        if (!read_range(&place, &range))
            return sm_fail(error, SM_USAGE,
                           "%s: '%.60s' is not a range FIRST:LAST:STEP, a number, or several of "
                           "them with commas between",
                           name, text);
        SmCode code = check(name, &range, low, high, error);
        if (code) return code;
        double steps = floor((range.last - range.first) / range.step * (1 + 1e-12) + 1e-9);
        if (!(steps < most - *count))
            return sm_fail(error, SM_USAGE, "%s: '%.60s' is more than %d numbers", name, text,
                           most);
        for (int i = 0; i <= (int)steps; i++) {
            double next = rint((range.first + i * range.step) * 1e9) / 1e9;
            if (*count && next <= value[*count - 1])
                return sm_fail(error, SM_USAGE, "%s: %g follows %g: give rising numbers", name,
                               next, value[*count - 1]);
            value[(*count)++] = next;
        }
        if (*place == '\0') return SM_OK;
        place++;
    }
}
