/* quote.h - words as a shell takes them. */
#ifndef BENCH_QUOTE_H
#define BENCH_QUOTE_H

#include <stddef.h>

/* Writes the word, in quotes unless a POSIX shell would take it as it is, into `size` bytes, cut
 * there. Returns the length that it has whole, as snprintf() does. */
size_t bench_quote(const char *word, size_t size, char *text);

#endif
