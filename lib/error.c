#include "error.h"
#include "printable.h"
#include "system/team.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

void sm_write_line(char *text, size_t size, const char *format, va_list arguments)
{
    vsnprintf(text, size, format, arguments);
    sm_printable(text);
}

SmCode sm_fail(SmError *error, SmCode code, const char *format, ...)
{
    if (!error) return code;
    error->code = code;
    va_list arguments;
    va_start(arguments, format);
    sm_write_line(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    return code;
}

static void out_of_memory(size_t count, size_t size, const char *file, int line)
{
    fprintf(stderr, "shapebench: out of memory: %zu x %zu bytes wanted at %s:%d\n", count, size,
            file, line);
    exit(SM_MEMORY);
}

static const size_t huge_page = (size_t)2 << 20;

/* Large arrays in huge pages, where the system has them: a step streams through more small pages
 * than the processor's translation buffer holds. Only pages that the array fills are asked for. */
static void *allocate(size_t bytes)
{
    void *memory;
    if (posix_memalign(&memory, bytes < huge_page ? 64 : huge_page, bytes)) return NULL;
#ifdef MADV_HUGEPAGE
    if (bytes >= huge_page) madvise(memory, bytes / huge_page * huge_page, MADV_HUGEPAGE);
#endif
    return memory;
}

/* Each thread touches, and by that places, the part that it will mostly work on: bodies are shared
 * among threads in such consecutive parts. */
static void zero(char *memory, size_t bytes)
{
    size_t pages = bytes / huge_page;
    int team = pages < 4 || omp_in_parallel() ? 1 : sm_team(0);
    if (team == 1) {
        memset(memory, 0, bytes);
        return;
    }
#pragma omp parallel for schedule(static) num_threads(team)
    for (size_t page = 0; page < pages; page++) memset(memory + page * huge_page, 0, huge_page);
    memset(memory + pages * huge_page, 0, bytes - pages * huge_page);
}

void *sm_alloc_at(size_t count, size_t size, const char *file, int line)
{
    if (size && count > (SIZE_MAX - 64) / size) out_of_memory(count, size, file, line);
    size_t bytes = (count * size + 63) / 64 * 64;
    if (bytes == 0) bytes = 64;
    void *memory = allocate(bytes);
    if (!memory) out_of_memory(count, size, file, line);
    zero(memory, bytes);
    return memory;
}

void *sm_copy_at(const void *array, size_t count, size_t size, const char *file, int line)
{
    void *copy = sm_alloc_at(count, size, file, line);
    if (count) memcpy(copy, array, count * size);
    return copy;
}

void *sm_realloc_at(void *pointer, size_t count, size_t size, const char *file, int line)
{
    if (size && count > SIZE_MAX / size) out_of_memory(count, size, file, line);
    void *memory = realloc(pointer, count && size ? count * size : 1);
    if (!memory) out_of_memory(count, size, file, line);
    return memory;
}

void sm_free_each(size_t count, void *const *pointer)
{
    for (size_t i = 0; i < count; i++) free(pointer[i]);
}
