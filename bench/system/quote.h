/* quote.h - words as a shell takes them, and as a sentence does. */
#ifndef BENCH_QUOTE_H
#define BENCH_QUOTE_H

#include <stddef.h>

/* Writes the word, in quotes unless a POSIX shell would take it as it is, into `size` bytes, cut
 * there. Returns the length that it has whole, as snprintf() does. */
size_t bench_quote(const char *word, size_t size, char *text);

/* "A, B or C": the words, NULL-terminated, with `prefix` before each and `last` (" or ") before the
 * last, cut at `size` bytes. Returns `text`. */
const char *bench_enumerate(const char *const *words, const char *prefix, const char *last,
                            size_t size, char *text);

#endif
