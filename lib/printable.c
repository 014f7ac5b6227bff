#include "printable.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

void sm_append(char *text, size_t size, const char *format, ...)
{
    size_t used = strlen(text);
    va_list values;
    va_start(values, format);
    vsnprintf(text + used, size - used, format, values);
    va_end(values);
}

int sm_character(const char *text)
{
    static const unsigned least[] = {0, 0, 0xa0, 0x800, 0x10000};
    const unsigned char *byte = (const unsigned char *)text;
    unsigned c = byte[0];
    if (c < 0x80) return c >= 0x20 && c != 0x7f;
    int length = c >= 0xf0 ? 4 : c >= 0xe0 ? 3 : 2;
    if (c < 0xc0 || c >= 0xf8) return 0;
    unsigned code = c & (0xffu >> (length + 1));
    for (int i = 1; i < length; i++) {
        if ((byte[i] & 0xc0) != 0x80) return 0;
        code = code << 6 | (byte[i] & 0x3f);
    }
    bool surrogate = code >= 0xd800 && code < 0xe000;
    bool beyond = code > 0x10ffff || code == 0xfffe || code == 0xffff;
    return code < least[length] || surrogate || beyond ? 0 : length;
}

void sm_printable(char *text)
{
    while (*text) {
        int length = sm_character(text);
        if (length == 0) *text = *text == '\n' || *text == '\r' || *text == '\t' ? ' ' : '?';
        text += length ? length : 1;
    }
}
