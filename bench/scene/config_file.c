#include "config_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
        const char *remedy = strstr(what, "mismatched")
                                 ? "write all numbers of a [ ] with a decimal point, or use ( )"
                                 : "settings look like: name = value;";
        code = sm_fail(error, SM_INPUT, "%s:%d: %s; %s", file, config_error_line(config), what,
                       remedy);
        config_destroy(config);
    }
    free(copy);
    return code;
}
