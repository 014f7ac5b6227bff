#include "quantity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../engines.h"
#include "records.h"

/* ---- what is not a plain member */

static bool changes(const void *record)
{
    return ((const BenchRow *)record)->change.frames > 0;
}

static bool meshless(const void *record)
{
    return ((const BenchRow *)record)->elastic.nodes > 0;
}

static bool timed(const void *record)
{
    return bench_row_timed(record);
}

static bool checked(const void *record)
{
    return ((const BenchRow *)record)->valid;
}

static double particle_cycles(const void *record)
{
    const BenchRow *row = record;
    return row->cycles / (double)row->particles;
}

static double cycle_instructions(const void *record)
{
    const BenchRow *row = record;
    return row->instructions / row->cycles;
}

static double ratio(const void *record)
{
    const BenchRow *row = record;
    return row->paper_total_ms / row->total_ms;
}

static const char *verdict(const void *record)
{
    return bench_row_mark(record);
}

/* ---- cells of tables for people */

static void w_cell(const void *record, char *text)
{
    int w = ((const BenchRow *)record)->w;
    snprintf(text, BENCH_GRID_TEXT, w ? "%d" : "-", w);
}

static void faster_cell(const void *record, char *text)
{
    if (!isfinite(((const BenchRow *)record)->paper_total_ms)) return;
    bench_grid_number(ratio(record), text);
    strcat(text, "x");
}

static void quartiles_cell(const void *record, char *text)
{
    const BenchRow *row = record;
    bench_grid_range(row->total_low_ms, row->total_high_ms, text);
}

/* "a -> b", or the one that there is, or "-"; `mark` behind each. */
static void pair_text(double from, double to, const char *joint, const char *mark, char *text)
{
    char a[BENCH_GRID_TEXT], b[BENCH_GRID_TEXT];
    bench_grid_number(from, a);
    bench_grid_number(to, b);
    if (isfinite(from) && isfinite(to))
        snprintf(text, BENCH_GRID_TEXT, "%.20s%s%s%.20s%s", a, mark, joint, b, mark);
    else
        snprintf(text, BENCH_GRID_TEXT, "%.20s%s", isfinite(from) ? a : b,
                 isfinite(from) || isfinite(to) ? mark : "");
}

static void counts_text(double from, double to, char *text)
{
    if (isfinite(from) && isfinite(to))
        snprintf(text, BENCH_GRID_TEXT, "%.0f -> %.0f", from, to);
    else
        strcpy(text, "-");
}

static void nodes_cell(const void *record, char *text)
{
    const BenchChangeRow *change = &((const BenchRow *)record)->change;
    counts_text((double)change->first_nodes, (double)change->most_nodes, text);
}

static void simulation_cell(const void *record, char *text)
{
    const BenchChangeRow *change = &((const BenchRow *)record)->change;
    pair_text(change->first_ms, change->last_ms, " -> ", "", text);
}

static void resampling_cell(const void *record, char *text)
{
    const BenchChangeRow *change = &((const BenchRow *)record)->change;
    pair_text(change->change_ms, change->change_most_ms, " to ", "", text);
}

static void triangles_cell(const void *record, char *text)
{
    const BenchChangeRow *change = &((const BenchRow *)record)->change;
    counts_text((double)change->first_triangles, (double)change->last_triangles, text);
}

/* ---- the paper's cells below: "?" behind a damaged or misprinted value, "*" behind a second-hand
 * one */

#define BELOW(name) static void name(const RefPaperRow *paper, const RefValue *value, char *text)

const char *bench_quantity_mark(RefStatus status)
{
    static const char *const marks[] = {"", "", "~", "?", "*"};
    return marks[status];
}

BELOW(name_below)
{
    (void)paper, (void)value;
    strcpy(text, "  paper");
}

BELOW(dash_below)
{
    (void)paper, (void)value;
    strcpy(text, "-");
}

BELOW(count_below)
{
    (void)paper;
    if (isfinite(value->value)) snprintf(text, BENCH_GRID_TEXT, "%.0f", value->value);
}

BELOW(bound_below)
{
    (void)paper;
    if (isfinite(value->value))
        snprintf(text, BENCH_GRID_TEXT, "< %.0f", value->value);
    else
        strcpy(text, "-");
}

BELOW(number_below)
{
    (void)paper;
    bench_grid_number(value->value, text);
}

BELOW(marked_below)
{
    (void)paper;
    bench_grid_number(value->value, text);
    if (isfinite(value->value)) strcat(text, bench_quantity_mark(value->status));
}

/* Times of a step, and the rate, are as sound as each other. */
static void step_text(const RefPaperRow *paper, double value, char *text)
{
    bench_grid_number(value, text);
    if (isfinite(value)) strcat(text, bench_quantity_mark(ref_paper_step_status(paper)));
}

BELOW(step_below)
{
    step_text(paper, value->value, text);
}

BELOW(particle_below)
{
    step_text(paper, 1e6 * value->value / paper->particles.value, text);
}

BELOW(nodes_below)
{
    counts_text(value->value, paper->last_particles.value, text);
}

BELOW(simulation_below)
{
    bool second_hand = ref_paper_step_status(paper) == REF_SECOND_HAND;
    pair_text(value->value, paper->last_ms.value, " -> ", second_hand ? "*" : "", text);
}

BELOW(resampling_below)
{
    pair_text(value->value, paper->change_most_ms.value, " to ", "", text);
}

/* ---- the list */

enum { PLAIN = 1 << BENCH_GRID_PLAIN, LATEX = 1 << BENCH_GRID_LATEX };
enum { PAGE = 1 << BENCH_GRID_MARKDOWN | LATEX, EVERY = PLAIN | PAGE };

#define LATTICES   .shown[BENCH_TABLE_LATTICES]
#define STEPS      .shown[BENCH_TABLE_STEPS]
#define FRAMES     .shown[BENCH_TABLE_FRAMES]
#define SHELLS     .shown[BENCH_TABLE_SHELLS]
#define CHANGES    .shown[BENCH_TABLE_CHANGES]
#define COUNTERS   .shown[BENCH_TABLE_COUNTERS]
#define BOTH_STEPS LATTICES = EVERY, STEPS = EVERY

#define PLACE(type, member)                                                                        \
    .field.kind = BENCH_##type, .field.offset = offsetof(BenchRow, member),                        \
    .field.size = sizeof(((BenchRow *)0)->member)
#define COLUMN(title)       .field.column = title
#define TITLE(text)         .field.title = text
#define TIME(title)         .field.column = title, .field.timed = timed
#define LATER               .later = true
#define COUNTER(title)      LATER, .field.column = title, .field.timed = checked
#define MEANS(unit_, words) .field.unit = unit_, .field.meaning = words
#define PAPER(member, how)  .paper = offsetof(RefPaperRow, member), .below = how

#define STORED(type, member, ...) .field.name = #member, PLACE(type, member), __VA_ARGS__
#define ROW(type, member, ...)    {STORED(type, member, __VA_ARGS__)},
#define TEXT(member, size_, ...)  {STORED(TEXT, member, __VA_ARGS__)},
#define ARRAY(member, count, ...) {STORED(DOUBLE, member, __VA_ARGS__)},
#define OCTREE(type, member, ...) {.of = "octree", STORED(type, member, __VA_ARGS__)},
#define OF(what, when, type, name_, place, ...)                                                    \
    {.of = what, .field.given = when, .field.name = name_, PLACE(type, place), __VA_ARGS__},
#define CHANGE(type, member, ...)                                                                  \
    OF("change", changes, type, "change." #member, change.member, __VA_ARGS__)
#define ELASTIC(type, member, ...)                                                                 \
    OF("meshless", meshless, type, #member, elastic.member, .elastic = true, __VA_ARGS__)
#define ELASTIC_ARRAY(member, count, ...) ELASTIC(DOUBLE, member, __VA_ARGS__)
#define VIEW(...)                         {__VA_ARGS__},
#define STAGES(...)                       {.stage = in_tables, __VA_ARGS__},
#define MORE_STAGES(...)                  {.stage = behind},

static const char in_tables[] = "", behind[] = "";

static const BenchQuantity lines[] = {
#include "../measure/row_quantities.inc"
};

enum { LINES = sizeof lines / sizeof *lines, MOST_STAGES = SM_STAGES * BENCH_MOST_ENGINES };

/* A stage of an engine: shape matching's are columns of files in their place, others behind. */
typedef struct {
    const SmEngineType *type;
    int place;
    bool matching;
    char column[32];
} Stage;

static const SmStageName *name_of(const Stage *stage)
{
    return &sm_engine_stages(stage->type)->of[stage->place];
}

/* Those of all engines, each name once. Returns how many. */
static int find_stages(Stage *stage)
{
    int count = 0;
    for (int i = 0; bench_engine_list[i / SM_STAGES]; i++) {
        const SmEngineType *type = bench_engine_list[i / SM_STAGES]->type[0];
        bool matching = sm_engine_stages(type) == &sm_matching_stages;
        Stage *next = &stage[count];
        *next = (Stage){type, i % SM_STAGES, matching, ""};
        const char *name = name_of(next)->name;
        int same = 0;
        while (name && same < count && strcmp(name_of(&stage[same])->name, name)) same++;
        if (!name || same < count) continue;
        snprintf(next->column, sizeof next->column, "%s_ms", name);
        count++;
    }
    return count;
}

/* A stage as a column: of tables as `here` says, of files if it is one of theirs here. */
static BenchQuantity stage_column(const BenchQuantity *here, const Stage *stage)
{
    const SmStageName *name = name_of(stage);
    bool in_files = stage->matching == (here->stage == in_tables);
    BenchQuantity to = *here;
    to.stage = name->name;
    to.terse = name->terse;
    to.field = (BenchField){.kind = BENCH_DOUBLE,
                            .offset = offsetof(BenchRow, stage_ms[stage->place]),
                            .size = sizeof(double),
                            .column = in_files ? stage->column : NULL,
                            .timed = timed,
                            .title = name->title,
                            .unit = "ms",
                            .meaning = name->meaning};
    to.paper = offsetof(RefPaperRow, stage_ms[stage->place]);
    to.below = stage->matching ? NULL : dash_below;
    to.of = stage->matching ? NULL : stage->type->name;
    return to;
}

const BenchQuantity *bench_quantities(int *count)
{
    static Stage stage[MOST_STAGES];
    static BenchQuantity list[LINES + 2 * MOST_STAGES];
    static int made;
    *count = made;
    if (made) return list;
    int stages = find_stages(stage);
    for (int l = 0; l < LINES; l++) {
        if (!lines[l].stage) list[made++] = lines[l];
        for (int s = 0; s < stages && lines[l].stage; s++)
            if (lines[l].stage == in_tables || !stage[s].matching)
                list[made++] = stage_column(&lines[l], &stage[s]);
    }
    *count = made;
    return list;
}

const double *bench_quantity_stage(const BenchQuantity *quantity, const BenchRow *row)
{
    const SmEngineType *type = bench_engine(row->engine)->type[0];
    for (int s = 0; s < SM_STAGES; s++) {
        const char *name = sm_engine_stage(type, (SmStage)s);
        if (name && !strcmp(name, quantity->stage)) return &row->stage_ms[s];
    }
    return NULL;
}

const BenchField *bench_quantity_number(const char *name)
{
    int count;
    const BenchQuantity *quantity = bench_quantities(&count);
    for (int q = 0; q < count; q++) {
        const BenchField *field = &quantity[q].field;
        bool whole = field->kind == BENCH_INT || field->kind == BENCH_LONG;
        bool number = whole || (field->kind == BENCH_DOUBLE && bench_field_values(field) == 1);
        if (!field->name || !number) continue;
        size_t group = strncmp(field->name, "change.", 7) ? 0 : 7;
        const char *const names[] = {field->name + group, field->column, quantity[q].alias};
        for (int n = 0; n < 3; n++)
            if (names[n] && !strcmp(names[n], name)) return field;
    }
    return NULL;
}

/* ---- documentation */

void bench_quantities_document(FILE *file)
{
    fputs("| attribute | type | in csv, json | of | unit | meaning |\n"
          "| --- | --- | --- | --- | --- | --- |\n",
          file);
    int count;
    const BenchQuantity *quantity = bench_quantities(&count);
    for (int q = 0; q < count; q++) {
        const BenchField *field = &quantity[q].field;
        const char *group = quantity[q].elastic ? "elastic/" : "";
        char type[32];
        bench_field_type(field, sizeof type, type);
        if (!field->name && !field->column) continue;
        if (field->name) fprintf(file, "| `%s%s` | %s", group, field->name, type);
        if (!field->name) fputs("| | ", file);
        fprintf(file, field->column ? " | `%s` |" : " |%s |", field->column ? field->column : "");
        const char *of = quantity[q].of, *unit = field->unit;
        fprintf(file, " %s | %s | %s |\n", of ? of : "", unit ? unit : "", field->meaning);
    }
}
