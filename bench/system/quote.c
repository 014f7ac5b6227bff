#include "quote.h"

#include <stdio.h>
#include <string.h>

#include "../../lib/printable.h"

size_t bench_quote(const char *word, size_t size, char *text)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "_-+=./:,@%^";
    if (*word && !word[strspn(word, plain)]) return (size_t)snprintf(text, size, "%s", word);
    size_t used = 0;
    for (const char *c = word; c == word || c[-1]; c++) {
        const char *piece = (char[]){*c, '\0'};
        if (*c == '\'') piece = "'\\''"; /* ends the quotes, one that is escaped, begins them */
        if (!*c) piece = "'";
        used += (size_t)snprintf(used < size ? text + used : NULL, used < size ? size - used : 0,
                                 "%s%s", c == word ? "'" : "", piece);
    }
    return used;
}

const char *bench_enumerate(const char *const *words, const char *prefix, const char *last,
                            size_t size, char *text)
{
    text[0] = '\0';
    for (int i = 0; words[i]; i++)
        sm_append(text, size, "%s%s%s", !i ? "" : words[i + 1] ? ", " : last, prefix, words[i]);
    return text;
}
