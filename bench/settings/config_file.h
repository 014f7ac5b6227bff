/* config_file.h - libconfig files from users: read whole, parsed, and put into a struct by a table
 * of settings, with one clear line on what is wrong. */
#ifndef BENCH_CONFIG_FILE_H
#define BENCH_CONFIG_FILE_H

#include <libconfig.h>
#include <stddef.h>

#include "setting.h"

enum { BENCH_CONFIG_BYTES = 1 << 20 };

/* The file's text, at most a byte more than one may have; the caller frees. NULL and `error`
 * (SM_INPUT) when it cannot be read. */
char *bench_config_load(const char *path, size_t *size, SmError *error);

/* Parses the text; on SM_OK the caller calls config_destroy(). `file` is for the messages, `kind`
 * says what it should be ("scene"). SM_INPUT, with file and line: too long, a zero byte, an
 * @include, or not libconfig. */
SmCode bench_config_parse(const char *text, size_t size, const char *file, const char *kind,
                          config_t *config, SmError *error);

/* Reads `group` into the record that the table describes. A setting that is absent leaves its place
 * as it is; one that the table has not is an error that lists what is known. `file` is for the
 * messages: "file:line: ...". Errors: SM_INPUT. */
SmCode bench_settings_read(const config_setting_t *group, const BenchSetting *table, void *record,
                           const char *file, SmError *error);

#endif
