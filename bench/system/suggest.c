#include "suggest.h"

#include <stdio.h>
#include <string.h>

enum { LONGEST = 40, NEAR = 2 };

static int least(int a, int b)
{
    return a < b ? a : b;
}

/* Damerau and Levenshtein's distance, where no part is changed twice. */
static int count_changes(const char *a, int m, const char *b, int n)
{
    int row[LONGEST + 1][LONGEST + 1];
    for (int i = 0; i <= m; i++)
        for (int j = 0; j <= n; j++) {
            if (!i || !j) {
                row[i][j] = i + j;
                continue;
            }
            int other = row[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            row[i][j] = least(other, least(row[i - 1][j], row[i][j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[i][j] = least(row[i][j], row[i - 2][j - 2] + 1);
        }
    return row[m][n];
}

void bench_suggest(BenchSuggestion *suggestion, const char *name)
{
    size_t typed = strlen(suggestion->typed), length = strlen(name);
    if (typed > LONGEST || length > LONGEST || typed < 2) return;
    int changes = count_changes(suggestion->typed, (int)typed, name, (int)length);
    if (changes > (typed < 5 ? 1 : NEAR)) return;
    if (suggestion->name && suggestion->changes <= changes) return;
    suggestion->name = name;
    suggestion->changes = changes;
}

const char *bench_suggest_words(const BenchSuggestion *suggestion, const char *prefix,
                                char text[BENCH_SUGGEST_TEXT])
{
    text[0] = '\0';
    if (suggestion->name)
        snprintf(text, BENCH_SUGGEST_TEXT, "; did you mean '%s%s'?", prefix, suggestion->name);
    return text;
}

const char *bench_suggest_among(const char *typed, const char *const *names,
                                char text[BENCH_SUGGEST_TEXT])
{
    BenchSuggestion meant = {.typed = typed};
    for (; *names; names++) bench_suggest(&meant, *names);
    return bench_suggest_words(&meant, "", text);
}
