#include "paper.h"

#include <libconfig.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/error.h"

extern const char ref_papers_text[]; /* scripts/embed.cmake makes it of papers.cfg */

static struct {
    int row_count, claim_count;
    RefPaperRow *row;
    RefPaperClaim *claim;
} data;

const char *ref_status_name(RefStatus status)
{
    static const char *const names[] = {"quoted", "derived", "ours", "damaged", "second-hand"};
    return names[status];
}

/* The data file is part of the program: a fault in it is the program's. */
static void fault(const char *what, int line)
{
    fprintf(stderr, "shapebench: reference/papers.cfg, line %d: %s\n", line, what);
    abort();
}

static RefStatus status_of(const config_setting_t *pair)
{
    const char *name = config_setting_get_string_elem(pair, 1);
    for (RefStatus s = REF_QUOTED; name && s <= REF_SECOND_HAND; s++)
        if (strcmp(name, ref_status_name(s)) == 0) return s;
    fault("a status is quoted, derived, ours, damaged or second-hand",
          config_setting_source_line(pair));
    return REF_DAMAGED;
}

static RefValue value_of(const config_setting_t *group, const char *name)
{
    const config_setting_t *pair = group ? config_setting_get_member(group, name) : NULL;
    if (!pair) return (RefValue){NAN, REF_QUOTED};
    const config_setting_t *number = config_setting_get_elem(pair, 0);
    if (config_setting_length(pair) != 2 || !number || !config_setting_is_number(number))
        fault("a value is a number and its status", config_setting_source_line(pair));
    return (RefValue){config_setting_get_float(number), status_of(pair)};
}

static void text_of(const config_setting_t *group, const char *name, char *text, size_t room)
{
    const char *value = NULL;
    if (!config_setting_lookup_string(group, name, &value) || strlen(value) >= room)
        fault("a text is missing or too long", config_setting_source_line(group));
    else
        memcpy(text, value, strlen(value) + 1);
}

#define COLUMN(name, in_change, member)                                                            \
    {                                                                                              \
        name, in_change, offsetof(RefPaperRow, member)                                             \
    }

/* Columns of one value, in the row's group or in its group `change`. */
static const struct Column {
    const char *name;
    bool in_change;
    size_t offset;
} columns[] = {
    COLUMN("triangles", false, triangles),
    COLUMN("particles", false, particles),
    COLUMN("regions", false, regions),
    COLUMN("w", false, w),
    COLUMN("total_ms", false, total_ms),
    COLUMN("fps", false, fps),
    COLUMN("speedup", false, speedup),
    COLUMN("bases", false, bases),
    COLUMN("summation_nodes", false, summation_nodes),
    COLUMN("nodes", false, nodes),
    COLUMN("modes", false, modes),
    COLUMN("matrix_s", false, matrix_s),
    COLUMN("mode_s", false, mode_s),
    COLUMN("map_s", false, map_s),
    COLUMN("last_nodes", false, last_nodes),
    COLUMN("last_particles", true, last_particles),
    COLUMN("added", true, added),
    COLUMN("last_ms", true, last_ms),
    COLUMN("least_ms", true, change_ms),
    COLUMN("most_ms", true, change_most_ms),
    COLUMN("surface_ms", true, surface_ms),
};
enum { COLUMNS = sizeof columns / sizeof columns[0] };

static void read_row(const config_setting_t *from, RefPaperRow *row)
{
    text_of(from, "paper", row->paper, sizeof row->paper);
    text_of(from, "scene", row->scene, sizeof row->scene);
    text_of(from, "title", row->title, sizeof row->title);
    text_of(from, "note", row->note, sizeof row->note);
    const config_setting_t *change = config_setting_get_member(from, "change");
    for (int c = 0; c < COLUMNS; c++) {
        RefValue value = value_of(columns[c].in_change ? change : from, columns[c].name);
        memcpy((char *)row + columns[c].offset, &value, sizeof value);
    }
    const config_setting_t *ms = config_setting_get_member(from, "stage_ms");
    const config_setting_t *percent = config_setting_get_member(from, "stage_percent");
    for (int s = 0; s < SM_STAGES; s++) {
        row->stage_ms[s] = value_of(ms, sm_stage_name((SmStage)s));
        row->stage_percent[s] = value_of(percent, sm_stage_name((SmStage)s));
    }
}

static void read_claim(const config_setting_t *from, RefPaperClaim *claim)
{
    text_of(from, "paper", claim->paper, sizeof claim->paper);
    text_of(from, "name", claim->name, sizeof claim->name);
    text_of(from, "unit", claim->unit, sizeof claim->unit);
    text_of(from, "place", claim->place, sizeof claim->place);
    text_of(from, "note", claim->note, sizeof claim->note);
    claim->value = value_of(from, "value");
}

static void read_all(void)
{
    config_t config;
    config_init(&config);
    config_set_auto_convert(&config, CONFIG_TRUE); /* 150 is a number, too */
    if (!config_read_string(&config, ref_papers_text))
        fault(config_error_text(&config), config_error_line(&config));
    const config_setting_t *rows = config_lookup(&config, "rows");
    const config_setting_t *claims = config_lookup(&config, "claims");
    if (!rows || !claims) fault("rows and claims are wanted", 1);
    data.row_count = config_setting_length(rows);
    data.claim_count = config_setting_length(claims);
    data.row = sm_alloc((size_t)data.row_count, sizeof *data.row);
    data.claim = sm_alloc((size_t)data.claim_count, sizeof *data.claim);
    for (int n = 0; n < data.row_count; n++)
        read_row(config_setting_get_elem(rows, (unsigned)n), data.row + n);
    for (int n = 0; n < data.claim_count; n++)
        read_claim(config_setting_get_elem(claims, (unsigned)n), data.claim + n);
    config_destroy(&config);
}

/* By whichever thread comes first; C11's call_once is not everywhere. */
static void read_once(void)
{
#pragma omp critical(ref_paper)
    if (!data.row) read_all();
}

const RefPaperRow *ref_paper_rows(int *count)
{
    read_once();
    *count = data.row_count;
    return data.row;
}

const RefPaperRow *ref_paper_find(const char *paper, const char *scene)
{
    int count;
    const RefPaperRow *row = ref_paper_rows(&count);
    for (int n = 0; n < count; n++)
        if (strcmp(row[n].paper, paper) == 0 && strcmp(row[n].scene, scene) == 0) return row + n;
    return NULL;
}

int ref_paper_column(const RefPaperRow *row, const char *column, RefValue value[SM_STAGES])
{
    SmStage stage = sm_stage_of_ms(column);
    if (stage < SM_STAGES) {
        *value = row->stage_ms[stage];
        return 1;
    }
    bool ms = strcmp(column, "stage_ms") == 0;
    if (ms || strcmp(column, "stage_percent") == 0) {
        memcpy(value, ms ? row->stage_ms : row->stage_percent, sizeof row->stage_ms);
        return SM_STAGES;
    }
    for (int c = 0; c < COLUMNS; c++)
        if (strcmp(column, columns[c].name) == 0) {
            memcpy(value, (const char *)row + columns[c].offset, sizeof *value);
            return 1;
        }
    return 0;
}

RefStatus ref_paper_step_status(const RefPaperRow *row)
{
    return row->total_ms.status == REF_DERIVED ? row->fps.status : row->total_ms.status;
}

const RefPaperClaim *ref_paper_claims(int *count)
{
    read_once();
    *count = data.claim_count;
    return data.claim;
}

const RefPaperClaim *ref_paper_claim(const char *paper, const char *name)
{
    int count;
    const RefPaperClaim *claim = ref_paper_claims(&count);
    for (int n = 0; n < count; n++)
        if (strcmp(claim[n].paper, paper) == 0 && strcmp(claim[n].name, name) == 0)
            return claim + n;
    return NULL;
}
