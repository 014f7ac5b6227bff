/* error.h - how functions of this project fail.
 *
 * A function that can fail because of its input (a file, an option, a mesh) returns an SmCode and
 * writes one line for a person into an SmError: the file, the place, the remedy. Misuse of a
 * function asserts. Memory exhaustion ends the program with file and line. */
#ifndef SM_ERROR_H
#define SM_ERROR_H

#include <stdarg.h>
#include <stddef.h>

/* The values are the program's exit codes. */
typedef enum {
    SM_OK = 0,
    SM_INVALID = 1, /* a correctness check failed */
    SM_USAGE = 2,   /* unknown option, value out of range */
    SM_INPUT = 3,   /* a mesh, scene or result file cannot be used */
    SM_OUTPUT = 4,  /* a file cannot be written: no permission, disk full */
    SM_MEMORY = 70, /* it would not fit into this machine's memory */
} SmCode;

typedef struct {
    SmCode code;
    char text[512]; /* one line that a terminal can show (printable.h), no full stop needed */
} SmError;

/* Writes the formatted line into `error` (which may be NULL) and returns `code`. */
SmCode sm_fail(SmError *error, SmCode code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Writes such a line into `size` bytes. */
void sm_write_line(char *text, size_t size, const char *format, va_list arguments);

/* Zeroed memory, aligned to 64 bytes; ends the program with file and line when there is none.
 * Free with free(). A size of 0 gives a valid pointer. Large arrays lie in huge pages and are
 * zeroed by all threads (system/team.h). */
#define sm_alloc(count, size) sm_alloc_at((count), (size), __FILE__, __LINE__)
void *sm_alloc_at(size_t count, size_t size, const char *file, int line);

/* A copy of an array, likewise. */
#define sm_copy(array, count, size) sm_copy_at((array), (count), (size), __FILE__, __LINE__)
void *sm_copy_at(const void *array, size_t count, size_t size, const char *file, int line);

/* realloc() that ends the program when there is no memory; grown bytes are not zeroed. */
#define sm_realloc(pointer, count, size)                                                           \
    sm_realloc_at((pointer), (count), (size), __FILE__, __LINE__)
void *sm_realloc_at(void *pointer, size_t count, size_t size, const char *file, int line);

/* Makes an array that has room for `room` entries, a variable, hold `need` of them: where it does
 * not, twice as many and some more, so that adding one after another costs O(1) on average. */
#define sm_make_room(array, room, need)                                                            \
    do {                                                                                           \
        if ((need) > (room))                                                                       \
            (array) = sm_realloc((array), (size_t)((room) = 2 * (need) + 62), sizeof *(array));    \
    } while (0)

/* Frees all of these pointers. */
#define sm_free_all(...)                                                                           \
    sm_free_each(sizeof((void *[]){__VA_ARGS__}) / sizeof(void *), (void *[]){__VA_ARGS__})
void sm_free_each(size_t count, void *const *pointer);

#endif
