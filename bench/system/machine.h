/* machine.h - what ran where: the provenance of every result. */
#ifndef BENCH_MACHINE_H
#define BENCH_MACHINE_H

#include <stdbool.h>

#include "../store/export.h"
#include "../store/h5.h"

/* Strings are "unknown" and numbers 0 where unknown. */
typedef struct {
    char git_commit[48], compiler[128], flags[512], cpu[128], governor[32], kernel[128];
    char libraries[256], hostname[64], utc[32], command[1024], version[32];
    char cpu_model[96];         /* what is behind that name: vendor, family, model, stepping */
    char cpu_instructions[256]; /* sets that compilers use, of those that the kernel lists */
    long l1_bytes, l2_bytes, l3_bytes; /* data caches of processor 0; L3 shared by several */
    int cores;                         /* that this process may use (lib/system/cores.h) */
    int threads;                       /* used */
    char isa[16];                      /* instruction set of the kernels: lib/isa.h */
    char counters[160]; /* of the processor that can be read, or "none: ..." (counters.h) */
    bool git_dirty;     /* sources were changed after the commit when the program was built */
} BenchMachine;

/* `argv` is the whole command line; it is stored quoted for a shell, and cut at its room with
 * "...". Time is now. */
void bench_machine_read(int argc, char **argv, int threads, BenchMachine *machine);

/* This host, and now (ISO 8601). */
void bench_machine_stamp(char host[64], char utc[32]);

/* "AMD EPYC (avx512), 2 threads": where tables were measured, with what. Returns `text`. */
enum { BENCH_WHERE_TEXT = 192 };
const char *bench_machine_where(const BenchMachine *machine, char text[BENCH_WHERE_TEXT]);

/* Above a table in Markdown, a paragraph: when, where and with which compiler. */
void bench_machine_measured(FILE *file, const BenchMachine *machine);

/* Is a text of it known? */
bool bench_machine_known(const char *text);

/* Are they of the same processor: name, model, caches and instructions? If not, `size` bytes of
 * `text` say what differs. What a record does not hold is not held against it. */
bool bench_machine_same(const BenchMachine *a, const BenchMachine *b, size_t size, char *text);

/* Calls `say` for each text in which they differ, as far as it is known of both: processor (name,
 * and what is behind it), compiler, libraries, kernel, governor, host, instruction set. */
typedef void BenchMachineSay(void *context, const char *what, const char *old, const char *new);
void bench_machine_differences(const BenchMachine *old, const BenchMachine *new,
                               BenchMachineSay *say, void *context);

/* All of them: the group "machine" of a file that is written, or read. Files lack what was first
 * written down later: it is unknown. */
void bench_machine_store(BenchH5 *h5, const BenchMachine *machine);
void bench_machine_load(BenchH5 *h5, BenchMachine *machine);

/* And the object "environment" of JSON. */
json_t *bench_json_machine(const BenchMachine *machine);

#endif
