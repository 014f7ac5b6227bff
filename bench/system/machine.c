#include "machine.h"

#ifdef SHAPEBENCH_ASSIMP
#include <assimp/version.h>
#endif
#include <gsl/gsl_version.h>
#include <jansson.h>
#include <libconfig.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include "../../lib/isa.h"
#include "../../lib/printable.h"
#include "../../lib/system/cores.h"
#include "counters.h"
#include "provenance.h"
#include "quote.h"

#define FIELD(kind, member) BENCH_FIELD(BenchMachine, kind, member)

static const BenchField fields[] = {
    FIELD(BENCH_TEXT, git_commit), FIELD(BENCH_BOOL, git_dirty),
    FIELD(BENCH_TEXT, version),    FIELD(BENCH_TEXT, compiler),
    FIELD(BENCH_TEXT, flags),      FIELD(BENCH_TEXT, cpu),
    FIELD(BENCH_TEXT, cpu_model),  FIELD(BENCH_TEXT, cpu_instructions),
    FIELD(BENCH_LONG, l1_bytes),   FIELD(BENCH_LONG, l2_bytes),
    FIELD(BENCH_LONG, l3_bytes),   FIELD(BENCH_INT, cores),
    FIELD(BENCH_INT, threads),     FIELD(BENCH_TEXT, isa),
    FIELD(BENCH_TEXT, governor),   FIELD(BENCH_TEXT, kernel),
    FIELD(BENCH_TEXT, libraries),  FIELD(BENCH_TEXT, hostname),
    FIELD(BENCH_TEXT, utc),        FIELD(BENCH_TEXT, command),
    FIELD(BENCH_TEXT, counters),
};
enum { FIELDS = sizeof fields / sizeof fields[0] };

/* The first line of a file without its newline, or "unknown". */
static void read_line(const char *path, size_t size, char *line)
{
    FILE *file = fopen(path, "re");
    if (!file || !fgets(line, (int)size, file)) snprintf(line, size, "unknown");
    if (file) fclose(file);
    line[strcspn(line, "\n")] = '\0';
}

/* Appends `words` to `text`, but only those that name instruction sets. */
static void add_instructions(char *words, size_t size, char *text)
{
    static const char *const sets[] = {"sse", "ssse", "avx", "fma",  "f16c",
                                       "bmi", "amx",  "sve", "asimd"};
    for (char *word; (word = strtok_r(words, " \t\n", &words));)
        for (size_t s = 0; s < sizeof sets / sizeof *sets; s++)
            if (!strncmp(word, sets[s], strlen(sets[s]))) {
                sm_append(text, size, "%s%s", *text ? " " : "", word);
                break;
            }
}

/* Clouds name a processor "AMD EPYC" or "Intel Xeon Processor", whatever it is. */
static void add_generation(const char *vendor, int family, int model, size_t size, char *cpu)
{
    static const struct {
        const char *vendor;
        int family, from, to; /* models */
        const char *name;
    } known[] = {{"AuthenticAMD", 23, 0x00, 0x2f, "Zen"},
                 {"AuthenticAMD", 23, 0x30, 0xff, "Zen 2"},
                 {"AuthenticAMD", 25, 0x10, 0x1f, "Zen 4"},
                 {"AuthenticAMD", 25, 0x60, 0xaf, "Zen 4"},
                 {"AuthenticAMD", 25, 0x00, 0x5f, "Zen 3"},
                 {"AuthenticAMD", 26, 0x00, 0x4f, "Zen 5"},
                 {"AuthenticAMD", 26, 0x60, 0x7f, "Zen 5"},
                 {"GenuineIntel", 6, 0x55, 0x55, "Skylake or Cascade Lake"},
                 {"GenuineIntel", 6, 0x6a, 0x6c, "Ice Lake"},
                 {"GenuineIntel", 6, 0x8f, 0x8f, "Sapphire Rapids"},
                 {"GenuineIntel", 6, 0xcf, 0xcf, "Emerald Rapids"},
                 {"GenuineIntel", 6, 0xad, 0xad, "Granite Rapids"}};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (!strcmp(vendor, known[k].vendor) && family == known[k].family &&
            model >= known[k].from && model <= known[k].to) {
            sm_append(cpu, size, ", %s", known[k].name);
            return;
        }
}

/* Of /proc/cpuinfo's first processor, on x86 and on ARM. */
static void read_cpu(BenchMachine *machine)
{
    static const struct {
        const char *key, *word; /* NULL: the value alone */
    } parts[] = {
        {"vendor_id", NULL},      {"cpu family", "family"},           {"model\t", "model"},
        {"stepping", "stepping"}, {"CPU implementer", "implementer"}, {"CPU variant", "variant"},
        {"CPU part", "part"},     {"CPU revision", "revision"}};
    char line[8192], *model = machine->cpu_model, vendor[16] = "";
    int family = 0, number = 0;
    FILE *file = fopen("/proc/cpuinfo", "re");
    while (file && fgets(line, sizeof line, file) && line[0] != '\n') {
        char *value = strchr(line, ':');
        if (!value) continue;
        value += 1 + strspn(value + 1, " ");
        value[strcspn(value, "\n")] = '\0';
        if (!strncmp(line, "model name", 10))
            snprintf(machine->cpu, sizeof machine->cpu, "%.127s", value);
        if (!strncmp(line, "vendor_id", 9)) snprintf(vendor, sizeof vendor, "%s", value);
        if (!strncmp(line, "cpu family", 10)) family = atoi(value);
        if (!strncmp(line, "model\t", 6)) number = atoi(value);
        if (!strncmp(line, "flags", 5) || !strncmp(line, "Features", 8))
            add_instructions(value, sizeof machine->cpu_instructions, machine->cpu_instructions);
        for (size_t p = 0; p < sizeof parts / sizeof *parts; p++)
            if (!strncmp(line, parts[p].key, strlen(parts[p].key)))
                sm_append(model, sizeof machine->cpu_model, "%s%s%s%s", *model ? " " : "",
                          parts[p].word ? parts[p].word : "", parts[p].word ? " " : "", value);
    }
    if (file) fclose(file);
    add_generation(vendor, family, number, sizeof machine->cpu, machine->cpu);
    char *texts[] = {machine->cpu, machine->cpu_model, machine->cpu_instructions};
    for (int t = 0; t < 3; t++)
        if (!texts[t][0]) strcpy(texts[t], "unknown");
}

bool bench_machine_known(const char *text)
{
    return text[0] && strcmp(text, "unknown") != 0;
}

const char *bench_machine_where(const BenchMachine *machine, char text[BENCH_WHERE_TEXT])
{
    bool known = bench_machine_known(machine->isa);
    snprintf(text, BENCH_WHERE_TEXT, "%s%s%s%s, %d thread%s", machine->cpu, known ? " (" : "",
             known ? machine->isa : "", known ? ")" : "", machine->threads,
             machine->threads == 1 ? "" : "s");
    return text;
}

void bench_machine_measured(FILE *file, const BenchMachine *machine)
{
    char where[BENCH_WHERE_TEXT];
    fprintf(file, "Measured on %.10s, %s; %s.\n\n", machine->utc,
            bench_machine_where(machine, where), machine->compiler);
}

bool bench_machine_same(const BenchMachine *a, const BenchMachine *b, size_t size, char *text)
{
    const char *const texts[][3] = {
        {"", a->cpu, b->cpu},
        {"", a->cpu_model, b->cpu_model},
        {"instructions ", a->cpu_instructions, b->cpu_instructions},
        {"kernels of ", a->isa, b->isa},
    };
    const struct {
        int level;
        long a, b;
    } cache[] = {{1, a->l1_bytes, b->l1_bytes},
                 {2, a->l2_bytes, b->l2_bytes},
                 {3, a->l3_bytes, b->l3_bytes}};
    for (int t = 0; t < 4; t++)
        if (bench_machine_known(texts[t][1]) && bench_machine_known(texts[t][2]) &&
            strcmp(texts[t][1], texts[t][2]) != 0) {
            snprintf(text, size, "%s%.*s; this is %.*s", texts[t][0], (int)size / 2 - 16,
                     texts[t][1], (int)size / 2 - 16, texts[t][2]);
            return false;
        }
    for (int c = 0; c < 3; c++)
        if (cache[c].a && cache[c].b && cache[c].a != cache[c].b) {
            snprintf(text, size, "an L%d cache of %ld KiB; this has %ld KiB", cache[c].level,
                     cache[c].a / 1024, cache[c].b / 1024);
            return false;
        }
    return true;
}

/* Linux lists processor 0's caches as index0, index1, ...; sizes are like "32K". */
static void read_caches(BenchMachine *machine)
{
    long *bytes[] = {&machine->l1_bytes, &machine->l2_bytes, &machine->l3_bytes};
    for (int index = 0; index < 16; index++) {
        char path[96], level[16], type[32], size[32];
        const char *folder = "/sys/devices/system/cpu/cpu0/cache/index";
        snprintf(path, sizeof path, "%s%d/level", folder, index);
        read_line(path, sizeof level, level);
        snprintf(path, sizeof path, "%s%d/type", folder, index);
        read_line(path, sizeof type, type);
        snprintf(path, sizeof path, "%s%d/size", folder, index);
        read_line(path, sizeof size, size);
        int number = atoi(level);
        if (number < 1 || number > 3 || strcmp(type, "Instruction") == 0) continue;
        char *unit;
        long value = strtol(size, &unit, 10);
        *bytes[number - 1] = value * (*unit == 'K' ? 1024 : *unit == 'M' ? 1024 * 1024 : 1);
    }
}

static void read_libraries(size_t size, char *text)
{
    unsigned major, minor, release;
    char assimp[40] = "";
    H5get_libversion(&major, &minor, &release);
#ifdef SHAPEBENCH_ASSIMP
    snprintf(assimp, sizeof assimp, "Assimp %u.%u.%u, ", aiGetVersionMajor(), aiGetVersionMinor(),
             aiGetVersionPatch());
#endif
    snprintf(text, size, "HDF5 %u.%u.%u, %sGSL %s, libconfig %d.%d.%d, jansson %s", major, minor,
             release, assimp, gsl_version, LIBCONFIG_VER_MAJOR, LIBCONFIG_VER_MINOR,
             LIBCONFIG_VER_REVISION, JANSSON_VERSION);
}

/* Joins the words; the first is the program and its command. What has no room becomes "...". */
static void quote_command(int argc, char **argv, size_t size, char *text)
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < argc && used < size; i++) {
        if (i) text[used++] = ' ';
        used += i ? bench_quote(argv[i], size - used, text + used)
                  : (size_t)snprintf(text, size, "%s", argv[i]);
    }
    if (used >= size) strcpy(text + size - 4, "...");
}

void bench_machine_stamp(char host[64], char utc[32])
{
    if (gethostname(host, 64)) strcpy(host, "unknown");
    host[63] = '\0';
    time_t now = time(NULL);
    struct tm parts;
    gmtime_r(&now, &parts);
    strftime(utc, 32, "%Y-%m-%dT%H:%M:%SZ", &parts);
}

static void read_system(BenchMachine *machine)
{
    struct utsname name;
    if (uname(&name) == 0)
        snprintf(machine->kernel, sizeof machine->kernel, "%.40s %.60s %.20s", name.sysname,
                 name.release, name.machine);
    else
        snprintf(machine->kernel, sizeof machine->kernel, "unknown");
    bench_machine_stamp(machine->hostname, machine->utc);
    machine->cores = sm_cores("");
    read_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", sizeof machine->governor,
              machine->governor);
}

static void read_counters(BenchMachine *machine)
{
    char text[sizeof machine->counters - 8];
    bool there = bench_counters_there(sizeof text, text);
    snprintf(machine->counters, sizeof machine->counters, "%s%s", there ? "" : "none: ", text);
}

void bench_machine_read(int argc, char **argv, int threads, BenchMachine *machine)
{
    memset(machine, 0, sizeof *machine);
    snprintf(machine->git_commit, sizeof machine->git_commit, "%s", SHAPEBENCH_GIT_COMMIT);
    machine->git_dirty = SHAPEBENCH_GIT_DIRTY;
    snprintf(machine->version, sizeof machine->version, "%s", SHAPEBENCH_VERSION);
    snprintf(machine->compiler, sizeof machine->compiler, "%s", SHAPEBENCH_COMPILER);
    snprintf(machine->flags, sizeof machine->flags, "%s", SHAPEBENCH_FLAGS);
    machine->threads = threads;
    snprintf(machine->isa, sizeof machine->isa, "%s", sm_isa_name(sm_isa()));
    read_counters(machine);
    read_cpu(machine);
    read_caches(machine);
    read_system(machine);
    read_libraries(sizeof machine->libraries, machine->libraries);
    quote_command(argc, argv, sizeof machine->command, machine->command);
}

void bench_machine_differences(const BenchMachine *old, const BenchMachine *new,
                               BenchMachineSay *say, void *context)
{
    const struct {
        const char *what, *old, *new;
    } text[] = {
        {"processor", old->cpu, new->cpu},          {"processor", old->cpu_model, new->cpu_model},
        {"compiler", old->compiler, new->compiler}, {"libraries", old->libraries, new->libraries},
        {"kernel", old->kernel, new->kernel},       {"governor", old->governor, new->governor},
        {"host", old->hostname, new->hostname},     {"instruction set", old->isa, new->isa},
    };
    for (size_t i = 0; i < sizeof text / sizeof *text; i++)
        if (bench_machine_known(text[i].old) && bench_machine_known(text[i].new) &&
            strcmp(text[i].old, text[i].new) != 0)
            say(context, text[i].what, text[i].old, text[i].new);
}

json_t *bench_json_machine(const BenchMachine *machine)
{
    return bench_json_record(fields, FIELDS, machine);
}

void bench_machine_store(BenchH5 *h5, const BenchMachine *machine)
{
    bench_h5_fields(h5, bench_h5_group(h5, h5->file, "machine"), fields, FIELDS, machine);
}

void bench_machine_load(BenchH5 *h5, BenchMachine *machine)
{
    hid_t group = bench_h5_find_group(h5, h5->file, "machine");
    memset(machine, 0, sizeof *machine);
    for (int f = 0; f < FIELDS; f++)
        if (fields[f].kind == BENCH_TEXT) strcpy((char *)machine + fields[f].offset, "unknown");
    bench_h5_read_what_is_there(h5, group, fields, FIELDS, machine);
}
