#define _GNU_SOURCE
#include "machine_info.h"

#include <dlfcn.h>
#include <math.h>
#include <omp.h>
#include <unistd.h>

#include "../../lib/isa.h"
#include "../../lib/printable.h"
#include "../../lib/system/cores.h"
#include "../settings/command_line.h"

/* The file that OpenMP's functions are in; NULL: not known. */
static const char *find_openmp(void)
{
    Dl_info where;
    return dladdr((void *)omp_get_max_threads, &where) ? where.dli_fname : NULL;
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

static void print_text(const BenchMachine *machine, const char *openmp)
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
    printf("This program\n  version       %s, commit %.12s%s\n", machine->version,
           machine->git_commit, machine->git_dirty ? " and changes" : "");
    printf("  compiler      %s\n  flags         %s\n  kernels       ", machine->compiler,
           machine->flags);
    bench_print_isas(stdout);
    printf("\n  OpenMP        %d%s%s, threads %d\n", _OPENMP, openmp ? ", " : "",
           openmp ? openmp : "", machine->threads);
    printf("  libraries     %s\n", machine->libraries);
}

static void print_json(const BenchMachine *machine, const char *openmp)
{
    json_t *isas = json_array();
    for (int isa = 0; isa < sm_isa_count(); isa++)
        json_array_append_new(isas, json_pack("{s:s, s:b, s:b}", "name", sm_isa_name(isa), "there",
                                              (int)sm_isa_there(isa), "in_use", isa == sm_isa()));
    bench_json_write(stdout,
                     json_pack("{s:o, s:o, s:i, s:i, s:o, s:i, s:o}", "environment",
                               bench_json_machine(machine), "isas", isas, "processors",
                               (int)sysconf(_SC_NPROCESSORS_ONLN), "affinity", omp_get_num_procs(),
                               "quota", bench_json_number(sm_quota("").cores), "openmp", _OPENMP,
                               "openmp_library", openmp ? bench_json_text(openmp) : json_null()));
}

void bench_machine_info(const BenchMachine *machine, bool json)
{
    (json ? print_json : print_text)(machine, find_openmp());
}
