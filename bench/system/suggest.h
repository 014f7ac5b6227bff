/* suggest.h - what was meant by a mistyped name. */
#ifndef BENCH_SUGGEST_H
#define BENCH_SUGGEST_H

/* Begins zeroed but for `typed`; the one nearest of all that were offered, or NULL. */
typedef struct {
    const char *typed, *name;
    int changes;
} BenchSuggestion;

/* Offers a name. One is near when at most 2 changes (a letter more, less, another, or two that are
 * next to each other exchanged; 1 of a name of under 5 letters) make it of what was typed.
 * O(product of the lengths). */
void bench_suggest(BenchSuggestion *suggestion, const char *name);

enum { BENCH_SUGGEST_TEXT = 560 };

/* "; did you mean 'PREFIXNAME'?", or "" where nothing is near. Returns `text`. */
const char *bench_suggest_words(const BenchSuggestion *suggestion, const char *prefix,
                                char text[BENCH_SUGGEST_TEXT]);

/* The same of what was typed in place of one of the NULL-terminated `names`. */
const char *bench_suggest_among(const char *typed, const char *const *names,
                                char text[BENCH_SUGGEST_TEXT]);

#endif
