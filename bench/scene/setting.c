#include "setting.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "../../lib/system/printable.h"

static const BenchSetting *find(const BenchSetting *table, const char *name)
{
    for (; table->name; table++)
        if (!strcmp(table->name, name)) return table;
    return NULL;
}

static SmCode unknown(const config_setting_t *item, const BenchSetting *table, const char *file,
                      SmError *error)
{
    char known[400] = "";
    for (; table->name; table++) {
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", table->name);
    }
    return sm_fail(error, SM_INPUT, "%s:%u: unknown setting '%.40s'; known: %s", file,
                   config_setting_source_line(item), config_setting_name(item), known);
}

static SmCode wrong(const config_setting_t *item, const BenchSetting *setting, const char *wanted,
                    const char *file, SmError *error)
{
    return sm_fail(error, SM_INPUT, "%s:%u: '%s' must be %s", file,
                   config_setting_source_line(item), setting->name, wanted);
}

/* A number of either type; false for anything else and for what is not finite. */
static bool number(const config_setting_t *item, double *value)
{
    switch (config_setting_type(item)) {
    case CONFIG_TYPE_INT:
        *value = config_setting_get_int(item);
        return true;
    case CONFIG_TYPE_INT64:
        *value = (double)config_setting_get_int64(item);
        return true;
    case CONFIG_TYPE_FLOAT:
        *value = config_setting_get_float(item);
        return isfinite(*value);
    }
    return false;
}

static SmCode read_number(const config_setting_t *item, const BenchSetting *setting, void *place,
                          const char *file, SmError *error)
{
    double value;
    bool whole = setting->kind != BENCH_REAL;
    bool good = number(item, &value) && value >= setting->low && value <= setting->high;
    if (whole && good) good = config_setting_type(item) != CONFIG_TYPE_FLOAT;
    if (!good) {
        char wanted[96];
        snprintf(wanted, sizeof wanted, "a %s from %.10g to %.10g",
                 whole ? "whole number" : "number", setting->low, setting->high);
        return wrong(item, setting, wanted, file, error);
    }
    if (setting->kind == BENCH_INT) *(int *)place = (int)value;
    if (setting->kind == BENCH_LONG) *(long *)place = (long)value;
    if (setting->kind == BENCH_REAL) *(double *)place = value;
    return SM_OK;
}

static SmCode read_vector(const config_setting_t *item, const BenchSetting *setting, void *place,
                          const char *file, SmError *error)
{
    int type = config_setting_type(item);
    bool good =
        (type == CONFIG_TYPE_ARRAY || type == CONFIG_TYPE_LIST) && config_setting_length(item) == 3;
    double value[3];
    for (int d = 0; d < 3 && good; d++)
        good = number(config_setting_get_elem(item, (unsigned)d), &value[d]) &&
               value[d] >= setting->low && value[d] <= setting->high;
    if (!good) {
        char wanted[96];
        snprintf(wanted, sizeof wanted, "three numbers (x, y, z), each from %g to %g", setting->low,
                 setting->high);
        return wrong(item, setting, wanted, file, error);
    }
    memcpy(place, value, sizeof value);
    return SM_OK;
}

static SmCode read_text(const config_setting_t *item, const BenchSetting *setting, void *place,
                        const char *file, SmError *error)
{
    const char *text = config_setting_get_string(item);
    if (!text) return wrong(item, setting, "text in double quotes", file, error);
    if (strlen(text) >= (size_t)setting->high) {
        char wanted[64];
        snprintf(wanted, sizeof wanted, "shorter than %.0f characters", setting->high);
        return wrong(item, setting, wanted, file, error);
    }
    strcpy(place, text);
    sm_printable(place);
    if (strcmp(place, text) != 0)
        return wrong(item, setting, "UTF-8 without control characters", file, error);
    return SM_OK;
}

static SmCode read_choice(const config_setting_t *item, const BenchSetting *setting, void *place,
                          const char *file, SmError *error)
{
    const char *text = config_setting_get_string(item);
    size_t length = text ? strlen(text) : 0;
    const char *word = setting->words;
    for (int i = 0; text; i++) {
        size_t size = strcspn(word, "|");
        if (size == length && !memcmp(word, text, size)) {
            memcpy(place, &i, sizeof i);
            return SM_OK;
        }
        if (!word[size]) break;
        word += size + 1;
    }
    char wanted[128];
    snprintf(wanted, sizeof wanted, "one of \"%s\"", setting->words);
    return wrong(item, setting, wanted, file, error);
}

static SmCode read_list(const config_setting_t *item, const BenchSetting *setting, void *target,
                        const char *file, SmError *error)
{
    if (!config_setting_is_list(item))
        return wrong(item, setting, "a list of groups: ( { ... }, { ... } )", file, error);
    int count = config_setting_length(item);
    if (count > setting->high) {
        char wanted[64];
        snprintf(wanted, sizeof wanted, "a list of at most %.0f groups", setting->high);
        return wrong(item, setting, wanted, file, error);
    }
    for (int i = 0; i < count; i++) {
        const config_setting_t *element = config_setting_get_elem(item, (unsigned)i);
        if (!config_setting_is_group(element))
            return wrong(item, setting, "a list of groups: ( { ... }, { ... } )", file, error);
        char *place = (char *)target + setting->offset + (size_t)i * setting->size;
        SmCode code = bench_settings_read(element, setting->table, place, file, error);
        if (code) return code;
    }
    *(int *)((char *)target + setting->count) = count;
    return SM_OK;
}

static SmCode read_item(const config_setting_t *item, const BenchSetting *setting, void *target,
                        const char *file, SmError *error)
{
    void *place = (char *)target + setting->offset;
    switch (setting->kind) {
    case BENCH_INT:
    case BENCH_LONG:
    case BENCH_REAL:
        return read_number(item, setting, place, file, error);
    case BENCH_BOOL:
        if (config_setting_type(item) != CONFIG_TYPE_BOOL)
            return wrong(item, setting, "true or false", file, error);
        *(bool *)place = config_setting_get_bool(item);
        return SM_OK;
    case BENCH_TEXT:
        return read_text(item, setting, place, file, error);
    case BENCH_VECTOR:
        return read_vector(item, setting, place, file, error);
    case BENCH_CHOICE:
        return read_choice(item, setting, place, file, error);
    case BENCH_GROUP:
        if (!config_setting_is_group(item))
            return wrong(item, setting, "a group: { ... }", file, error);
        return bench_settings_read(item, setting->table, place, file, error);
    case BENCH_LIST:
        break;
    }
    return read_list(item, setting, target, file, error);
}

SmCode bench_settings_read(const config_setting_t *group, const BenchSetting *table, void *target,
                           const char *file, SmError *error)
{
    int count = config_setting_length(group);
    for (int i = 0; i < count; i++) {
        const config_setting_t *item = config_setting_get_elem(group, (unsigned)i);
        const BenchSetting *setting = find(table, config_setting_name(item));
        if (!setting) return unknown(item, table, file, error);
        SmCode code = read_item(item, setting, target, file, error);
        if (code) return code;
    }
    for (; table->name; table++)
        if (table->kind == BENCH_CHOICE && table->low > 0 &&
            !config_setting_get_member(group, table->name))
            return sm_fail(error, SM_INPUT, "%s:%u: no '%s': give one of \"%s\"", file,
                           config_setting_source_line(group), table->name, table->words);
    return SM_OK;
}
