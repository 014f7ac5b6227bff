#include "isa.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *name, *needs;
    bool (*there)(void);
} Isa;

#if defined(SM_ISA_NATIVE) || !defined(__x86_64__)
static bool always(void)
{
    return true;
}

#ifdef SM_SCALAR
#define NATIVE "portable"
#elif defined(__AVX512F__) && defined(__AVX512VL__)
#define NATIVE "avx512"
#elif defined(__AVX2__)
#define NATIVE "avx2"
#elif defined(__SSE2__)
#define NATIVE "sse2"
#elif defined(__ARM_NEON) && defined(__aarch64__)
#define NATIVE "neon"
#elif defined(__wasm_simd128__)
#define NATIVE "simd128"
#else
#define NATIVE "portable"
#endif
static const Isa isas[] = {{NATIVE, "", always}};
#else
static bool has_sse2(void)
{
    return true;
}

static bool has_avx2(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
           __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
           __builtin_cpu_supports("popcnt");
}

static bool has_avx512(void)
{
    return has_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}

static const Isa isas[] = {{"sse2", "", has_sse2},
                           {"avx2", " (AVX2, FMA, BMI, POPCNT)", has_avx2},
                           {"avx512", " (AVX-512 F, BW, CD, DQ, VL)", has_avx512}};
#endif

enum { COUNT = sizeof isas / sizeof *isas };

static int used = -1;
static SmIsaTable *tables;

int sm_isa_count(void)
{
    return COUNT;
}

const char *sm_isa_name(int isa)
{
    return isas[isa].name;
}

bool sm_isa_there(int isa)
{
    return isas[isa].there();
}

static int best(void)
{
    int isa = COUNT - 1;
    while (isa > 0 && !isas[isa].there()) isa--;
    return isa;
}

static SmCode find(const char *name, int *isa, SmError *error)
{
    char all[64] = "";
    for (*isa = 0; *isa < COUNT; ++*isa) {
        if (!strcmp(isas[*isa].name, name)) break;
        strcat(strcat(all, *isa ? ", " : ""), isas[*isa].name);
    }
    if (*isa == COUNT)
        return sm_fail(error, SM_USAGE, "no instruction set '%s' in this build: it has %s", name,
                       all);
    if (isas[*isa].there()) return SM_OK;
    return sm_fail(error, SM_USAGE, "this processor has no %s%s: its best is %s", name,
                   isas[*isa].needs, isas[best()].name);
}

/* Constructors ask first. */
int sm_isa(void)
{
    SmError error;
    const char *wanted = getenv("SHAPEBENCH_ISA");
    if (used < 0 && !(wanted && *wanted && !find(wanted, &used, &error))) used = best();
    return used;
}

SmCode sm_isa_wanted(SmError *error)
{
    int isa;
    const char *wanted = getenv("SHAPEBENCH_ISA");
    char text[sizeof error->text];
    if (!wanted || !*wanted || !find(wanted, &isa, error)) return SM_OK;
    snprintf(text, sizeof text, "%s", error->text);
    return sm_fail(error, SM_USAGE, "SHAPEBENCH_ISA: %.400s", text);
}

static void fill(const SmIsaTable *table)
{
    memcpy(table->table, table->variant[sm_isa()], table->size);
}

void sm_isa_add(SmIsaTable *table)
{
    table->next = tables;
    tables = table;
    fill(table);
}

SmCode sm_isa_use(const char *name, SmError *error)
{
    int isa;
    SmCode code = find(name, &isa, error);
    if (code) return code;
    used = isa;
    for (const SmIsaTable *table = tables; table; table = table->next) fill(table);
    return SM_OK;
}
