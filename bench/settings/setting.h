/* setting.h - one description of a setting: from it come a command's option and its line in --help
 * (command_line.h), the key of a scene or claims file (config_file.h), the range and the messages
 * of both, and the documented list of what a scene file may say.
 *
 * A table of settings describes a struct and ends with {0}; what kind a setting is follows from its
 * member's type (BENCH_IN). A new setting is a line in its table, and the code that acts on it. */
#ifndef BENCH_SETTING_H
#define BENCH_SETTING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "../../lib/error.h"

struct argp_state; /* <argp.h> */

typedef enum {
    BENCH_SET_INT,    /* int, */
    BENCH_SET_LONG,   /* long, */
    BENCH_SET_REAL,   /* double: from low to high */
    BENCH_SET_VECTOR, /* double[3], each from low to high */
    BENCH_SET_BOOL,   /* bool; as an option it takes no value and sets it */
    BENCH_SET_CHOICE, /* an enum: the choice's place, from `low` on */
    BENCH_SET_TEXT,   /* char[] */
    BENCH_SET_NAME,   /* const char *: the option's text itself, or the choice */
    BENCH_SET_NAMES,  /* BenchNames: one more of them */
    BENCH_SET_LIST,   /* an array of at most `high` structs with their own table */
    BENCH_SET_GROUP,  /* a struct with its own table */
    BENCH_SET_GIVEN,  /* BenchGiven: options that replace what the table's struct will hold */
} BenchSettingKind;

typedef struct BenchSetting {
    const char *key; /* in files; NULL: only an option */
    BenchSettingKind kind;
    size_t offset, size; /* of the member; size: of a list's element */
    double low, high;
    const char *const *choices;               /* NULL-terminated; NULL: any; */
    const char *const *(*choices_of)(void);   /* or those that are known at run time */
    const char *(*why_not)(const char *text); /* why a text is none of them; NULL: just so */
    const struct BenchSetting *table;         /* group, list, given */
    size_t count;                             /* list: offset of the int that takes how many */
    bool needed;                              /* a choice that a file must make */
    const char *option;                       /* long name on the command line; NULL: none */
    int letter;                               /* its short name, or 0 */
    const char *argument; /* its value's name; NULL: it takes none, and sets 1 */
    int section;          /* its place in --help */
    const char *help;     /* without a key and an option: a heading there */
    unsigned who;         /* of those who share a table, who has it (bits; 0:
                           * all); of a group: as whom it is read */
    unsigned of;          /* engines that alone have it: BENCH_OF_... */
    bool measuring;       /* says what to measure (BenchCommon.measuring) */
    void (*take)(const struct argp_state *state, const char *text,
                 void *member); /* the option's
                                 * value, where it is none of these kinds */
} BenchSetting;

/* Values of an option that may be repeated. */
enum { BENCH_NAMES = 64 };
typedef struct {
    const char *name[BENCH_NAMES + 1]; /* NULL behind the last */
    int count;
} BenchNames;

/* Options that were given, and found good, for a struct that is still to be made. */
enum { BENCH_GIVEN = 32 };
typedef struct {
    int count;
    struct {
        const BenchSetting *setting;
        size_t offset; /* of the setting's struct in the whole one */
        const char *text;
    } item[BENCH_GIVEN];
} BenchGiven;

/* The member's place, size and kind. */
#define BENCH_IN(record, member)                                                                   \
    .kind = _Generic(((record *)0)->member, int                                                    \
                     : BENCH_SET_INT, long                                                         \
                     : BENCH_SET_LONG, unsigned long                                               \
                     : BENCH_SET_LONG, double                                                      \
                     : BENCH_SET_REAL, double *                                                    \
                     : BENCH_SET_VECTOR, bool                                                      \
                     : BENCH_SET_BOOL, unsigned                                                    \
                     : BENCH_SET_CHOICE, char *                                                    \
                     : BENCH_SET_TEXT, const char *                                                \
                     : BENCH_SET_NAME, BenchNames                                                  \
                     : BENCH_SET_NAMES, BenchGiven                                                 \
                     : BENCH_SET_GIVEN, default                                                    \
                     : BENCH_SET_GROUP),                                                           \
    .offset = offsetof(record, member), .size = sizeof(((record *)0)->member)

/* An option's name, its value's (NULL: it has none), its place in --help and what that says; the
 * same of one that says what to measure; one of a few values; -o. */
#define BENCH_OPTION(name, value, place, words)                                                    \
    .option = (name), .argument = (value), .section = (place), .help = (words)
#define BENCH_MEASURE(name, value, place, words)                                                   \
    BENCH_OPTION(name, value, place, words), .measuring = true
#define BENCH_CHOICES(words) .choices = (words)
#define BENCH_ONE_OF(...)                                                                          \
    .choices = (const char *const[]){__VA_ARGS__, NULL},                                           \
    .choices_of = NULL /* GCC 12.3 takes a literal that is the last for one without a name */
#define BENCH_OUTPUT_OPTION(value, place, words)                                                   \
    BENCH_OPTION("output", value, place, words), .letter = 'o'

/* A list: its items, how many there can be, and where their number is. */
#define BENCH_ITEMS(record, items, number, most)                                                   \
    .kind = BENCH_SET_LIST, .offset = offsetof(record, items),                                     \
    .size = sizeof *((record *)0)->items, .low = 0, .high = (most),                                \
    .count = offsetof(record, number)

/* What a setting takes, "a number from 0 to 1", as a file has it or as an option does. Returns
 * `text`. */
enum { BENCH_WANTED = 256 };
const char *bench_setting_wanted(const BenchSetting *setting, bool file, char text[BENCH_WANTED]);

const char *const *bench_setting_choices(const BenchSetting *setting);

/* Its sentence in --help; "%s" in it stands for the choices: "fast, bars or naive". */
enum { BENCH_SENTENCE = 512 };
const char *bench_setting_sentence(const BenchSetting *setting, char text[BENCH_SENTENCE]);

/* A number of low..high; of kinds that are not real, a whole one. */
void bench_setting_number(const BenchSetting *setting, double value, void *record);

/* Writes an option's value (NULL: it has none) into the record that the table describes. SM_USAGE:
 * what is wrong with it, without the option's name. */
SmCode bench_setting_text(const BenchSetting *setting, const char *text, void *record,
                          SmError *error);

/* Lists what a file can say: each key, what it takes, its default where `defaults`, a record that
 * the table describes, has one (NULL: none is said), the option of `run` that replaces it, and its
 * sentence; the tables within likewise. */
void bench_settings_document(FILE *file, const BenchSetting *table, const void *defaults,
                             int indent);

/* "damping = 0.1; handles[0].axis = [0, 1, 0]; ": what the record, whose keys stand behind `within`
 * (""), says that is not as in `defaults`; items of lists by default are all 0. */
void bench_settings_said(FILE *file, const BenchSetting *table, const char *within,
                         const void *record, const void *defaults);

/* The value that was given to this option, or NULL. */
const char *bench_given(const BenchGiven *given, const char *option);

/* Adds what was given, or puts it in the place of the last such. SM_USAGE as above. */
SmCode bench_given_add(BenchGiven *given, const BenchSetting *setting, size_t offset,
                       const char *text, SmError *error);

/* Puts all that was given into the struct. */
void bench_given_apply(const BenchGiven *given, void *record);

/* Is this the end of a table? */
bool bench_setting_ends(const BenchSetting *setting);

/* Several numbers as an option gives them: "3", "1:8", "0:1:0.1", or these with commas between
 * them, "1:3,6,9". FIRST:LAST:STEP, step 1 where it is left out; LAST belongs to it where a step
 * falls on it. Writes them to `value`, which has room for `most`, rounded to 1e-9. They must rise
 * and lie in low..high. SM_USAGE: what is wrong, after the option's name ("--w"). */
SmCode bench_range_parse(const char *name, const char *text, double low, double high, int most,
                         double *value, int *count, SmError *error);

#endif
