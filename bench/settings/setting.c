#include "setting.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../system/quote.h"
#include "../system/suggest.h"

bool bench_setting_ends(const BenchSetting *setting)
{
    return !setting->key && !setting->option && !setting->table && !setting->help;
}

const char *const *bench_setting_choices(const BenchSetting *setting)
{
    return setting->choices_of ? setting->choices_of() : setting->choices;
}

static bool is_whole(const BenchSetting *setting)
{
    return setting->kind == BENCH_SET_INT || setting->kind == BENCH_SET_LONG;
}

static const char *list_choices(const BenchSetting *setting, bool file, char text[BENCH_WANTED])
{
    const char *const *choice = bench_setting_choices(setting);
    const char *begin = file ? "one of \"" : choice[1] ? "one of " : "", *end = file ? "\"" : "";
    size_t used = (size_t)snprintf(text, BENCH_WANTED, "%s%s", begin, choice[0]);
    for (int i = 1; choice[i] && used < BENCH_WANTED; i++)
        used += (size_t)snprintf(text + used, BENCH_WANTED - used, "%s%s", file ? "|" : ", ",
                                 choice[i]);
    if (used < BENCH_WANTED) snprintf(text + used, BENCH_WANTED - used, "%s", end);
    return text;
}

const char *bench_setting_wanted(const BenchSetting *setting, bool file, char text[BENCH_WANTED])
{
    int digits = file || is_whole(setting) ? 10 : 6;
    if (bench_setting_choices(setting)) return list_choices(setting, file, text);
    switch (setting->kind) {
    case BENCH_SET_INT:
    case BENCH_SET_LONG:
    case BENCH_SET_REAL:
        snprintf(text, BENCH_WANTED, "a %s from %.*g to %.*g",
                 is_whole(setting) ? "whole number" : "number", digits, setting->low, digits,
                 setting->high);
        break;
    case BENCH_SET_VECTOR:
        snprintf(text, BENCH_WANTED, "three numbers %s, each from %g to %g",
                 file ? "(x, y, z)" : "x,y,z", setting->low, setting->high);
        break;
    case BENCH_SET_BOOL:
        strcpy(text, "true or false");
        break;
    case BENCH_SET_LIST:
        strcpy(text, "a list of groups: ( { ... }, { ... } )");
        break;
    case BENCH_SET_GROUP:
        strcpy(text, "a group: { ... }");
        break;
    default:
        strcpy(text, "text in double quotes");
    }
    return text;
}

const char *bench_setting_sentence(const BenchSetting *setting, char text[BENCH_SENTENCE])
{
    char choices[BENCH_WANTED];
    const char *const *choice = bench_setting_choices(setting);
    const char *place = strstr(setting->help, "%s");
    if (!place || !choice) return setting->help;
    snprintf(text, BENCH_SENTENCE, "%.*s%s%s", (int)(place - setting->help), setting->help,
             bench_enumerate(choice, "", " or ", sizeof choices, choices), place + 2);
    return text;
}

void bench_setting_number(const BenchSetting *setting, double value, void *record)
{
    void *place = (char *)record + setting->offset;
    if (setting->kind == BENCH_SET_LONG)
        *(long *)place = (long)value;
    else if (setting->kind == BENCH_SET_REAL)
        *(double *)place = value;
    else
        *(int *)place = (int)value;
}

/* ---- values as text */

static bool parse_number(const BenchSetting *setting, const char *text, void *record)
{
    char *end;
    errno = 0;
    double value = is_whole(setting) ? (double)strtol(text, &end, 10) : strtod(text, &end);
    bool good = end != text && !*end && value >= setting->low && value <= setting->high &&
                !(is_whole(setting) && errno);
    if (good) bench_setting_number(setting, value, record);
    return good;
}

/* "x,y,z" */
static bool parse_vector(const BenchSetting *setting, const char *text, void *record)
{
    double value[3];
    for (int d = 0; d < 3; d++) {
        char *end;
        value[d] = strtod(text, &end);
        bool good = end != text && *end == (d < 2 ? ',' : '\0') && value[d] >= setting->low &&
                    value[d] <= setting->high;
        if (!good) return false;
        text = end + 1;
    }
    memcpy((char *)record + setting->offset, value, sizeof value);
    return true;
}

static SmCode take_text(const BenchSetting *setting, const char *text, void *record, SmError *error)
{
    void *place = (char *)record + setting->offset;
    BenchNames *names = place;
    if (setting->kind == BENCH_SET_NAME)
        *(const char **)place = text;
    else if (setting->kind == BENCH_SET_TEXT && strlen(text) < setting->size)
        strcpy(place, text);
    else if (setting->kind == BENCH_SET_TEXT)
        return sm_fail(error, SM_USAGE, "the path '%.60s...' is too long", text);
    else if (names->count == BENCH_NAMES)
        return sm_fail(error, SM_USAGE, "at most %d", BENCH_NAMES);
    else
        names->name[names->count++] = text;
    return SM_OK;
}

static SmCode take_choice(const BenchSetting *setting, const char *text, void *record,
                          SmError *error)
{
    char wanted[BENCH_WANTED], near[BENCH_SUGGEST_TEXT];
    const char *const *choice = bench_setting_choices(setting);
    int i = 0;
    while (choice[i] && strcmp(choice[i], text) != 0) i++;
    if (!choice[i]) {
        const char *why = setting->why_not ? setting->why_not(text) : NULL;
        return sm_fail(error, SM_USAGE, "'%s' is not %s%s%s", text,
                       bench_setting_wanted(setting, false, wanted), why ? ": " : "",
                       why ? why : bench_suggest_among(text, choice, near));
    }
    if (setting->kind == BENCH_SET_NAME || setting->kind == BENCH_SET_TEXT)
        return take_text(setting, choice[i], record, error);
    bench_setting_number(setting, setting->low + i, record);
    return SM_OK;
}

SmCode bench_setting_text(const BenchSetting *setting, const char *text, void *record,
                          SmError *error)
{
    char wanted[BENCH_WANTED];
    bool good = true;
    if (!text && setting->kind == BENCH_SET_BOOL)
        *(bool *)((char *)record + setting->offset) = true;
    else if (!text)
        bench_setting_number(setting, 1, record);
    else if (bench_setting_choices(setting))
        return take_choice(setting, text, record, error);
    else if (is_whole(setting) || setting->kind == BENCH_SET_REAL)
        good = parse_number(setting, text, record);
    else if (setting->kind == BENCH_SET_VECTOR)
        good = parse_vector(setting, text, record);
    else
        return take_text(setting, text, record, error);
    return good ? SM_OK
                : sm_fail(error, SM_USAGE, "'%s' is not %s", text,
                          bench_setting_wanted(setting, false, wanted));
}

/* ---- the documented list */

static void print_value(FILE *file, const BenchSetting *setting, const void *place)
{
    const double *real = place;
    if (setting->kind == BENCH_SET_CHOICE)
        fputs(bench_setting_choices(setting)[*(const unsigned *)place - (unsigned)setting->low],
              file);
    else if (setting->kind == BENCH_SET_BOOL)
        fputs(*(const bool *)place ? "true" : "false", file);
    else if (setting->kind == BENCH_SET_REAL)
        fprintf(file, "%.15g", *real);
    else if (setting->kind == BENCH_SET_VECTOR)
        fprintf(file, "[%.15g, %.15g, %.15g]", real[0], real[1], real[2]);
    else if (setting->kind == BENCH_SET_LONG)
        fprintf(file, "%ld", *(const long *)place);
    else if (setting->kind == BENCH_SET_INT)
        fprintf(file, "%d", *(const int *)place);
    else
        fputs(setting->kind == BENCH_SET_NAME ? *(const char *const *)place : place, file);
}

/* ", default 0.01", where the record holds one that the setting can take. */
static void print_default(FILE *file, const BenchSetting *setting, const void *record)
{
    const void *place = (const char *)record + setting->offset;
    double value = setting->kind == BENCH_SET_REAL   ? *(const double *)place
                   : setting->kind == BENCH_SET_LONG ? (double)*(const long *)place
                   : setting->kind == BENCH_SET_INT  ? *(const int *)place
                                                     : NAN;
    bool text = setting->kind == BENCH_SET_TEXT, word = text || setting->kind == BENCH_SET_CHOICE;
    if (!(value >= setting->low && value <= setting->high) && setting->kind != BENCH_SET_BOOL &&
        (text ? !*(const char *)place : !word))
        return;
    fputs(word ? ", default \"" : ", default ", file);
    print_value(file, setting, place);
    if (word) fputc('"', file);
}

/* In lines of up to 100 characters, indented; what stands before has been printed. */
static void print_wrapped(FILE *file, const char *text, int indent, int used)
{
    for (int length; *text; text += length + (text[length] == ' ')) {
        length = (int)strcspn(text, " ");
        if (used + 1 + length > 100) used = fprintf(file, "\n%*s", indent, "") - 1;
        used += fprintf(file, used > indent ? " %.*s" : "%.*s", length, text);
    }
    fputc('\n', file);
}

void bench_settings_document(FILE *file, const BenchSetting *table, const void *defaults,
                             int indent)
{
    for (; !bench_setting_ends(table); table++) {
        char wanted[BENCH_WANTED], sentence[BENCH_SENTENCE];
        const void *within = defaults ? (const char *)defaults + table->offset : NULL;
        fprintf(file, "%*s%s: %s", indent, "", table->key,
                bench_setting_wanted(table, true, wanted));
        if (table->kind == BENCH_SET_LIST) fprintf(file, ", at most %.0f", table->high);
        if (defaults) print_default(file, table, defaults);
        int used = fprintf(file, "\n%*s", indent + 4, "") - 1;
        if (table->option) used += fprintf(file, "run --%s:", table->option);
        print_wrapped(file, bench_setting_sentence(table, sentence), indent + 4, used);
        if (table->table)
            bench_settings_document(file, table->table,
                                    table->kind == BENCH_SET_GROUP ? within : NULL, indent + 8);
    }
}

/* ---- what a record says */

static bool same_value(const BenchSetting *setting, const char *a, const char *b)
{
    return setting->kind == BENCH_SET_TEXT ? !strcmp(a, b) : !memcmp(a, b, setting->size);
}

void bench_settings_said(FILE *file, const BenchSetting *table, const char *within,
                         const void *record, const void *defaults)
{
    static const char zeros[1024]; /* an item of a list by default */
    for (; !bench_setting_ends(table); table++) {
        const char *place = (const char *)record + table->offset;
        const char *usual = (const char *)defaults + table->offset;
        bool list = table->kind == BENCH_SET_LIST;
        int items = list ? *(const int *)(const void *)((const char *)record + table->count) : 1;
        char key[128];
        for (int i = 0; i < items && table->table; i++, place += table->size) {
            snprintf(key, sizeof key, list ? "%s%s[%d]." : "%s%s.", within, table->key, i);
            bench_settings_said(file, table->table, key, place, list ? zeros : usual);
        }
        if (table->table || same_value(table, place, usual)) continue;
        fprintf(file, "%s%s = ", within, table->key);
        print_value(file, table, place);
        fputs("; ", file);
    }
}

/* ---- options for a struct that is still to be made */

const char *bench_given(const BenchGiven *given, const char *option)
{
    for (int i = 0; i < given->count; i++)
        if (!strcmp(given->item[i].setting->option, option))
            return given->item[i].text ? given->item[i].text : "";
    return NULL;
}

SmCode bench_given_add(BenchGiven *given, const BenchSetting *setting, size_t offset,
                       const char *text, SmError *error)
{
    int at = 0;
    BenchSetting tried = *setting;
    double value[3];
    tried.offset = 0;
    SmCode code = bench_setting_text(&tried, text, value, error);
    while (at < given->count && given->item[at].setting != setting) at++;
    if (code || at == BENCH_GIVEN) return code;
    given->item[at].setting = setting;
    given->item[at].offset = offset;
    given->item[at].text = text;
    if (at == given->count) given->count++;
    return SM_OK;
}

void bench_given_apply(const BenchGiven *given, void *record)
{
    for (int i = 0; i < given->count; i++)
        bench_setting_text(given->item[i].setting, given->item[i].text,
                           (char *)record + given->item[i].offset, NULL);
}

/* ---- several numbers */

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
