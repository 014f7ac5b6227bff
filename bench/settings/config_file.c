#include "config_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../../lib/system/file.h"

char *bench_config_load(const char *path, size_t *size, SmError *error)
{
    FILE *file = sm_file_open(path, NULL, error);
    if (!file) return NULL;
    char *text = sm_alloc(BENCH_CONFIG_BYTES + 1, 1);
    *size = fread(text, 1, BENCH_CONFIG_BYTES + 1, file);
    if (ferror(file)) {
        sm_fail(error, SM_INPUT, "%s: cannot be read: %s", path, strerror(errno));
        free(text);
        text = NULL;
    }
    fclose(file);
    return text;
}

/* libconfig would open other files for @include, and would stop at a zero byte. */
static SmCode check_text(const char *text, size_t size, const char *file, const char *kind,
                         SmError *error)
{
    if (size > BENCH_CONFIG_BYTES)
        return sm_fail(error, SM_INPUT, "%s: not a %s file: over %d bytes", file, kind,
                       BENCH_CONFIG_BYTES);
    int line = 1;
    for (size_t i = 0; i < size; i++) {
        if (text[i] == '\0')
            return sm_fail(error, SM_INPUT, "%s:%d: not a %s file: a zero byte", file, line, kind);
        if (text[i] == '@' && size - i >= 8 && !memcmp(text + i, "@include", 8))
            return sm_fail(error, SM_INPUT, "%s:%d: '@include' is not supported: copy the text in",
                           file, line);
        line += text[i] == '\n';
    }
    return SM_OK;
}

/* Cuts off all behind the setting that is there twice, and returns its name: the first in the line
 * up to whose '=' the text already fails so. libconfig does not say which it is. */
static const char *find_twin(char *text, int line)
{
    char *at = text, *end;
    while (--line > 0 && strchr(at, '\n')) at = strchr(at, '\n') + 1;
    for (bool twice = false; !twice; at = end + 1) {
        end = at + strcspn(at, "=:");
        if (!*end) return "a setting";
        char after = end[1];
        end[1] = '\0';
        config_t config;
        config_init(&config);
        twice = !config_read_string(&config, text) && strstr(config_error_text(&config), "dupl");
        config_destroy(&config);
        if (!twice) end[1] = after;
    }
    while (end > text && strchr("=: \t\r\n", end[-1])) end--;
    *end = '\0';
    while (end > text && !strchr(" \t\r\n;,{", end[-1])) end--;
    return end;
}

SmCode bench_config_parse(const char *text, size_t size, const char *file, const char *kind,
                          config_t *config, SmError *error)
{
    SmCode code = check_text(text, size, file, kind, error);
    if (code) return code;
    char *copy = sm_alloc(size + 1, 1);
    memcpy(copy, text, size);
    config_init(config);
    if (!config_read_string(config, copy)) {
        const char *what = config_error_text(config);
        int line = config_error_line(config);
        const char *remedy = strstr(what, "mismatched")
                                 ? "write all numbers of a [ ] with a decimal point, or use ( )"
                                 : "settings look like: name = value;";
        if (strstr(what, "duplicate"))
            code = sm_fail(error, SM_INPUT, "%s:%d: '%.40s' is there twice: remove one of them",
                           file, line, find_twin(copy, line));
        else
            code = sm_fail(error, SM_INPUT, "%s:%d: %s; %s", file, line, what, remedy);
        config_destroy(config);
    }
    free(copy);
    return code;
}

/* ---- settings */

/* Where a setting is to be written, and how messages begin. */
typedef struct {
    const BenchSetting *setting;
    const config_setting_t *item;
    void *record; /* that the setting's table describes */
    const char *file;
    SmError *error;
} Entry;

static SmCode wrong(const Entry *entry, const char *wanted)
{
    return sm_fail(entry->error, SM_INPUT, "%s:%u: '%s' must be %s", entry->file,
                   config_setting_source_line(entry->item), entry->setting->key, wanted);
}

static SmCode misses(const Entry *entry)
{
    char wanted[BENCH_WANTED];
    return wrong(entry, bench_setting_wanted(entry->setting, true, wanted));
}

static SmCode unknown(const config_setting_t *item, const BenchSetting *table, const char *file,
                      SmError *error)
{
    char known[400] = "";
    for (; !bench_setting_ends(table); table++) {
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", table->key);
    }
    return sm_fail(error, SM_INPUT, "%s:%u: unknown setting '%.40s'; known: %s", file,
                   config_setting_source_line(item), config_setting_name(item), known);
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

static SmCode read_number(const Entry *entry)
{
    double value;
    const BenchSetting *setting = entry->setting;
    bool good =
        number(entry->item, &value) && value >= setting->low && value <= setting->high &&
        (setting->kind == BENCH_SET_REAL || config_setting_type(entry->item) != CONFIG_TYPE_FLOAT);
    if (!good) return misses(entry);
    bench_setting_number(setting, value, entry->record);
    return SM_OK;
}

static SmCode read_vector(const Entry *entry)
{
    const BenchSetting *setting = entry->setting;
    int type = config_setting_type(entry->item);
    bool good = (type == CONFIG_TYPE_ARRAY || type == CONFIG_TYPE_LIST) &&
                config_setting_length(entry->item) == 3;
    double value[3];
    for (int d = 0; d < 3 && good; d++)
        good = number(config_setting_get_elem(entry->item, (unsigned)d), &value[d]) &&
               value[d] >= setting->low && value[d] <= setting->high;
    if (!good) return misses(entry);
    memcpy((char *)entry->record + setting->offset, value, sizeof value);
    return SM_OK;
}

/* Which of the setting's choices the text is; -1: none. */
static int choice_of(const Entry *entry)
{
    const char *text = config_setting_get_string(entry->item);
    const char *const *choice = bench_setting_choices(entry->setting);
    for (int i = 0; text && choice[i]; i++)
        if (!strcmp(choice[i], text)) return i;
    return -1;
}

static SmCode read_text(const Entry *entry)
{
    char *place = (char *)entry->record + entry->setting->offset;
    const char *text = config_setting_get_string(entry->item);
    if (!text || (bench_setting_choices(entry->setting) && choice_of(entry) < 0))
        return misses(entry);
    if (strlen(text) >= entry->setting->size) {
        char wanted[64];
        snprintf(wanted, sizeof wanted, "shorter than %zu characters", entry->setting->size);
        return wrong(entry, wanted);
    }
    strcpy(place, text);
    sm_printable(place);
    return strcmp(place, text) != 0 ? wrong(entry, "UTF-8 without control characters") : SM_OK;
}

static SmCode read_choice(const Entry *entry)
{
    int choice = choice_of(entry);
    if (choice < 0) return misses(entry);
    bench_setting_number(entry->setting, choice, entry->record);
    return SM_OK;
}

static SmCode read_list(const Entry *entry)
{
    const BenchSetting *setting = entry->setting;
    if (!config_setting_is_list(entry->item)) return misses(entry);
    int count = config_setting_length(entry->item);
    if (count > setting->high) {
        char wanted[64];
        snprintf(wanted, sizeof wanted, "a list of at most %.0f groups", setting->high);
        return wrong(entry, wanted);
    }
    char *place = (char *)entry->record + setting->offset;
    for (int i = 0; i < count; i++, place += setting->size) {
        const config_setting_t *element = config_setting_get_elem(entry->item, (unsigned)i);
        if (!config_setting_is_group(element)) return misses(entry);
        SmCode code =
            bench_settings_read(element, setting->table, place, entry->file, entry->error);
        if (code) return code;
    }
    *(int *)((char *)entry->record + setting->count) = count;
    return SM_OK;
}

static SmCode read_entry(const Entry *entry)
{
    char *place = (char *)entry->record + entry->setting->offset;
    switch (entry->setting->kind) {
    case BENCH_SET_BOOL:
        if (config_setting_type(entry->item) != CONFIG_TYPE_BOOL) return misses(entry);
        *(bool *)place = config_setting_get_bool(entry->item);
        return SM_OK;
    case BENCH_SET_VECTOR:
        return read_vector(entry);
    case BENCH_SET_CHOICE:
        return read_choice(entry);
    case BENCH_SET_TEXT:
        return read_text(entry);
    case BENCH_SET_LIST:
        return read_list(entry);
    case BENCH_SET_GROUP:
        if (!config_setting_is_group(entry->item)) return misses(entry);
        return bench_settings_read(entry->item, entry->setting->table, place, entry->file,
                                   entry->error);
    default:
        return read_number(entry);
    }
}

SmCode bench_settings_read(const config_setting_t *group, const BenchSetting *table, void *record,
                           const char *file, SmError *error)
{
    int count = config_setting_length(group);
    for (int i = 0; i < count; i++) {
        const config_setting_t *item = config_setting_get_elem(group, (unsigned)i);
        const BenchSetting *setting = table;
        while (!bench_setting_ends(setting) && strcmp(setting->key, config_setting_name(item)) != 0)
            setting++;
        if (bench_setting_ends(setting)) return unknown(item, table, file, error);
        SmCode code = read_entry(&(Entry){setting, item, record, file, error});
        if (code) return code;
    }
    for (; !bench_setting_ends(table); table++) {
        char wanted[BENCH_WANTED];
        if (table->needed && !config_setting_get_member(group, table->key))
            return sm_fail(error, SM_INPUT, "%s:%u: no '%s': give %s", file,
                           config_setting_source_line(group), table->key,
                           bench_setting_wanted(table, true, wanted));
    }
    return SM_OK;
}
