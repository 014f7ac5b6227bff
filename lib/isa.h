/* isa.h - the instruction sets that the kernels are compiled for, and the one that is in use.
 *
 * Kernels are one source (lib/simd/lanes.h), compiled once for each set of x86-64 (sse2, avx2,
 * avx512), or for one alone: the building machine's (SHAPEBENCH_NATIVE), that of another family
 * (neon, simd128), or none (portable: another family still, or SHAPEBENCH_SCALAR). What others call
 * of them are tables of functions, one for each set; a table of the same name without a suffix
 * holds those in use. Before main() these are those of the best set that the processor has, or that
 * the environment variable SHAPEBENCH_ISA names. */
#ifndef SM_ISA_H
#define SM_ISA_H

#include <stdbool.h>

#include "error.h"

/* How many there are. */
int sm_isa_count(void);

/* "avx2", say. */
const char *sm_isa_name(int isa);

/* Does this processor have it? */
bool sm_isa_there(int isa);

/* The one in use. */
int sm_isa(void);

/* Takes another, by its name; engines of the one before must be gone. SM_USAGE: there is no such
 * set, or the processor lacks it. */
SmCode sm_isa_use(const char *name, SmError *error);

/* What SHAPEBENCH_ISA names and cannot be had, or SM_OK. */
SmCode sm_isa_wanted(SmError *error);

typedef struct SmIsaTable {
    void *table;
    size_t size;
    const void *const *variant; /* [sm_isa_count()] */
    struct SmIsaTable *next;
} SmIsaTable;

/* Fills the table in now, and again when another set is taken. */
void sm_isa_add(SmIsaTable *table);

/* Defines the table `name` of variants name_avx2 and so on, constants of the same type. */
#define SM_ISA_TABLE(type, name)                                                                   \
    SM_ISA_DECLARE_(type, name)                                                                    \
    type name;                                                                                     \
    __attribute__((constructor)) static void name##_add(void)                                      \
    {                                                                                              \
        static const void *const variant[] = {SM_ISA_VARIANTS_(name)};                             \
        static SmIsaTable table = {&name, sizeof name, variant, NULL};                             \
        sm_isa_add(&table);                                                                        \
    }
#if defined(SM_ISA_NATIVE) || !defined(__x86_64__)
#define SM_ISA_DECLARE_(type, name) extern const type name##_native;
#define SM_ISA_VARIANTS_(name)      &name##_native
#else
#define SM_ISA_DECLARE_(type, name) extern const type name##_sse2, name##_avx2, name##_avx512;
#define SM_ISA_VARIANTS_(name)      &name##_sse2, &name##_avx2, &name##_avx512
#endif

#endif
