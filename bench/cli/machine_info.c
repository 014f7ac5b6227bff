#define _GNU_SOURCE
#include "machine_info.h"

#include <dlfcn.h>
#include <math.h>
#include <omp.h>
#include <string.h>
#include <unistd.h>

#include "../../lib/isa.h"
#include "../../lib/printable.h"
#include "../../lib/system/cores.h"
#include "../settings/command_line.h"

/* What the machine's record does not hold. */
typedef struct {
    char openmp[128];   /* the file that its functions are in; "": not known */
    char valgrind[128]; /* "3.19.0"; "": there is none */
} Tools;

static void find_tools(Tools *tools)
{
    Dl_info where;
    static const char before[] = "valgrind-";
    char line[128] = "";
    *tools = (Tools){0};
    if (dladdr((void *)omp_get_max_threads, &where) && where.dli_fname)
        sm_append(tools->openmp, sizeof tools->openmp, "%s", where.dli_fname);
    FILE *said = popen("valgrind --version 2>/dev/null", "re");
    bool there = said && fgets(line, sizeof line, said) && !strncmp(line, before, strlen(before));
    if (said) pclose(said);
    line[strcspn(line, "\n")] = '\0';
    if (there) sm_append(tools->valgrind, sizeof tools->valgrind, "%s", line + strlen(before));
}

static void print_caches(const BenchMachine *machine)
{
    const long bytes[] = {machine->l1_bytes, machine->l2_bytes, machine->l3_bytes};
    char text[128] = "";
    for (int c = 0; c < 3; c++)
        if (bytes[c])
            sm_append(text, sizeof text, "%sL%d %ld KiB", *text ? ", " : "", c + 1,
                      bytes[c] / 1024);
    printf("  caches        %s\n", *text ? text : "unknown");
}

static void print_text(const BenchMachine *machine, const Tools *tools)
{
    printf("This machine\n  processor     %s (%s)\n", machine->cpu, machine->cpu_model);
    print_caches(machine);
    double quota = sm_quota("").cores;
    printf("  cores         %d for this process: affinity %d of %ld, container's quota ",
           machine->cores, omp_get_num_procs(), sysconf(_SC_NPROCESSORS_ONLN));
    printf(isinf(quota) ? "none\n" : "%.3g\n", quota);
    printf("  instructions  %s\n", machine->cpu_instructions);
    printf("  kernel        %s, governor %s\n", machine->kernel, machine->governor);
    printf("  counters      %s\n", machine->counters);
    printf("  Valgrind      %s\n", tools->valgrind[0] ? tools->valgrind : "not installed");
    printf("This program\n  version       %s, commit %.12s%s\n", machine->version,
           machine->git_commit, machine->git_dirty ? " and changes" : "");
    printf("  compiler      %s\n  flags         %s\n  kernels       ", machine->compiler,
           machine->flags);
    bench_print_isas(stdout);
    printf("\n  OpenMP        %d%s%s, threads %d\n", _OPENMP, tools->openmp[0] ? ", " : "",
           tools->openmp, machine->threads);
    printf("  libraries     %s\n", machine->libraries);
}

static json_t *text_json(const char *text)
{
    return text[0] ? bench_json_text(text) : json_null();
}

static void print_json(const BenchMachine *machine, const Tools *tools)
{
    json_t *isas = json_array();
    for (int isa = 0; isa < sm_isa_count(); isa++)
        json_array_append_new(isas, json_pack("{s:s, s:b, s:b}", "name", sm_isa_name(isa), "there",
                                              (int)sm_isa_there(isa), "in_use", isa == sm_isa()));
    bench_json_write(stdout,
                     json_pack("{s:o, s:o, s:i, s:i, s:o, s:i, s:o, s:o}", "environment",
                               bench_json_machine(machine), "isas", isas, "processors",
                               (int)sysconf(_SC_NPROCESSORS_ONLN), "affinity", omp_get_num_procs(),
                               "quota", bench_json_number(sm_quota("").cores), "openmp", _OPENMP,
                               "openmp_library", text_json(tools->openmp), "valgrind",
                               text_json(tools->valgrind)));
}

void bench_machine_info(const BenchMachine *machine, bool json)
{
    Tools tools;
    find_tools(&tools);
    (json ? print_json : print_text)(machine, &tools);
}
