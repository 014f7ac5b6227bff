#define _GNU_SOURCE
#include "machine.h"

#include <assimp/version.h>
#include <gsl/gsl_version.h>
#include <jansson.h>
#include <libconfig.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include "provenance.h"

#define FIELD(kind, member) BENCH_FIELD(BenchMachine, kind, member)

const BenchField *bench_machine_fields(int *count)
{
    static const BenchField fields[] = {
        FIELD(BENCH_TEXT, git_commit), FIELD(BENCH_BOOL, git_dirty), FIELD(BENCH_TEXT, version),
        FIELD(BENCH_TEXT, compiler),   FIELD(BENCH_TEXT, flags),     FIELD(BENCH_TEXT, cpu),
        FIELD(BENCH_LONG, l1_bytes),   FIELD(BENCH_LONG, l2_bytes),  FIELD(BENCH_LONG, l3_bytes),
        FIELD(BENCH_INT, cores),       FIELD(BENCH_INT, threads),    FIELD(BENCH_TEXT, governor),
        FIELD(BENCH_TEXT, kernel),     FIELD(BENCH_TEXT, libraries), FIELD(BENCH_TEXT, hostname),
        FIELD(BENCH_TEXT, utc),        FIELD(BENCH_TEXT, command),
    };
    *count = (int)(sizeof fields / sizeof fields[0]);
    return fields;
}

/* The first line of a file without its newline, or "unknown". */
static void read_line(const char *path, size_t size, char *line)
{
    FILE *file = fopen(path, "re");
    if (!file || !fgets(line, (int)size, file)) snprintf(line, size, "unknown");
    if (file) fclose(file);
    line[strcspn(line, "\n")] = '\0';
}

static void read_cpu(size_t size, char *cpu)
{
    snprintf(cpu, size, "unknown");
    FILE *file = fopen("/proc/cpuinfo", "re");
    if (!file) return;
    char line[512];
    while (fgets(line, sizeof line, file)) {
        char *value = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || !value) continue;
        value[strcspn(value, "\n")] = '\0';
        snprintf(cpu, size, "%.*s", (int)size - 1, value + strspn(value, ": "));
        break;
    }
    fclose(file);
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
    H5get_libversion(&major, &minor, &release);
    snprintf(text, size, "HDF5 %u.%u.%u, Assimp %u.%u.%u, GSL %s, libconfig %d.%d.%d, jansson %s",
             major, minor, release, aiGetVersionMajor(), aiGetVersionMinor(), aiGetVersionPatch(),
             gsl_version, LIBCONFIG_VER_MAJOR, LIBCONFIG_VER_MINOR, LIBCONFIG_VER_REVISION,
             JANSSON_VERSION);
}

/* Joins the words, quoted where a shell would not take them as they are. The first is the program
 * and its command. */
static void quote_command(int argc, char **argv, size_t size, char *text)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "_-+=./:,@%^";
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < argc; i++) {
        const char *word = argv[i];
        bool quote = i > 0 && (!*word || word[strspn(word, plain)]);
        char piece[8];
        for (long at = quote ? -1 : 0; at <= (long)strlen(word); at++) {
            bool end = at == (long)strlen(word);
            snprintf(piece, sizeof piece, "%c", at < 0 || end ? '\'' : word[at]);
            if (end && !quote) piece[0] = '\0';
            if (at >= 0 && !end && word[at] == '\'') snprintf(piece, sizeof piece, "'\\''");
            if (end && i + 1 < argc) strcat(piece, " ");
            if (used + strlen(piece) + 4 > size) {
                strcpy(text + used, "...");
                return;
            }
            strcpy(text + used, piece);
            used += strlen(piece);
        }
    }
}

static void read_system(BenchMachine *machine)
{
    struct utsname name;
    if (uname(&name) == 0)
        snprintf(machine->kernel, sizeof machine->kernel, "%.40s %.60s %.20s", name.sysname,
                 name.release, name.machine);
    else
        snprintf(machine->kernel, sizeof machine->kernel, "unknown");
    if (gethostname(machine->hostname, sizeof machine->hostname) != 0)
        snprintf(machine->hostname, sizeof machine->hostname, "unknown");
    machine->hostname[sizeof machine->hostname - 1] = '\0';
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0)
        machine->cores = CPU_COUNT(&set);
    else
        machine->cores = (int)sysconf(_SC_NPROCESSORS_ONLN);
    read_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", sizeof machine->governor,
              machine->governor);
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
    read_cpu(sizeof machine->cpu, machine->cpu);
    read_caches(machine);
    read_system(machine);
    read_libraries(sizeof machine->libraries, machine->libraries);
    quote_command(argc, argv, sizeof machine->command, machine->command);
    time_t now = time(NULL);
    struct tm utc;
    gmtime_r(&now, &utc);
    strftime(machine->utc, sizeof machine->utc, "%Y-%m-%dT%H:%M:%SZ", &utc);
}
