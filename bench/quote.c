#include "quote.h"

#include <string.h>

void bench_csv_text(FILE *file, const char *text)
{
    if (!text[strcspn(text, ",\"\r\n")]) {
        fputs(text, file);
        return;
    }
    fputc('"', file);
    for (; *text; text++) {
        if (*text == '"') fputc('"', file);
        fputc(*text, file);
    }
    fputc('"', file);
}

json_t *bench_json_text(const char *text)
{
    json_t *value = json_string(text);
    if (value) return value;
    char copy[1024];
    size_t i = 0;
    for (; text[i] && i < sizeof copy - 1; i++)
        copy[i] = (unsigned char)text[i] < 128 ? text[i] : '?';
    copy[i] = '\0';
    return json_string(copy);
}
