#define _GNU_SOURCE /* strtod_l() of musl */
/* Words and numbers of a draft. */
#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "draft.h"

enum { LONGEST_NUMBER = 500 }; /* characters */

/* Bytes of the line end at `at`: 0 where there is none. */
static size_t end_of_line(const char *at, const char *end)
{
    if (at == end || (*at != '\n' && *at != '\r')) return 0;
    return *at == '\r' && end - at > 1 && at[1] == '\n' ? 2 : 1;
}

static bool divides_words(const SmDraft *draft, const char *at)
{
    if (*at <= ' ') return *at == ' ' || (*at >= '\t' && *at <= '\r');
    if (draft->commas && (*at == ',' || *at == ';')) return true;
    return draft->joined && *at == '\\' && end_of_line(at + 1, draft->end);
}

void sm_draft_trim(SmDraft *draft)
{
    while (draft->end > draft->at && !draft->end[-1]) draft->end--;
}

bool sm_draft_word(SmDraft *draft)
{
    for (; draft->at < draft->end && divides_words(draft, draft->at); draft->at++) {
        if (end_of_line(draft->at, draft->end)) return false;
        if (*draft->at == '\\') {
            draft->at += end_of_line(draft->at + 1, draft->end);
            draft->line++;
        }
    }
    return draft->at < draft->end && !(draft->comment && *draft->at == draft->comment);
}

bool sm_draft_line(SmDraft *draft)
{
    while (draft->at < draft->end && *draft->at != '\n' && *draft->at != '\r') draft->at++;
    size_t bytes = end_of_line(draft->at, draft->end);
    draft->at += bytes;
    draft->line += bytes > 0;
    return draft->at < draft->end;
}

bool sm_draft_find(SmDraft *draft)
{
    while (!sm_draft_word(draft))
        if (!sm_draft_line(draft)) return false;
    return true;
}

int sm_draft_length(const SmDraft *draft)
{
    const char *at = draft->at;
    while (at < draft->end && at - draft->at < INT_MAX && !divides_words(draft, at)) at++;
    return (int)(at - draft->at);
}

bool sm_draft_fail_word(SmDraft *draft, const char *what)
{
    int length = sm_draft_length(draft);
    return sm_draft_fail(draft, "'%.*s' is not %s" SM_AGAIN, length < 40 ? length : 40, draft->at,
                         what);
}

void sm_draft_skip(SmDraft *draft, long count)
{
    while (count-- > 0 && sm_draft_word(draft)) draft->at += sm_draft_length(draft);
}

bool sm_draft_take(SmDraft *draft, const char *word, bool any_case)
{
    if (draft->at == draft->end || (*draft->at ^ *word) & (any_case ? ~32 : ~0)) return false;
    size_t length = strlen(word);
    const char *end = draft->at + length;
    if ((size_t)(draft->end - draft->at) < length ||
        (any_case ? strncasecmp(draft->at, word, length) : memcmp(draft->at, word, length)) ||
        (end < draft->end && !divides_words(draft, end)))
        return false;
    draft->at = end;
    return true;
}

/* A decimal number's parts: digits * 10^exponent, and whether these are all of its digits. */
typedef struct {
    uint64_t digits;
    int count; /* of digits, at most 19 */
    long exponent;
    bool exact;
} Decimal;

static const char *read_digits(const char *at, const char *end, Decimal *decimal, bool fraction)
{
    for (; at < end && *at >= '0' && *at <= '9'; at++) {
        bool fits = decimal->count < 19;
        if (fits) decimal->digits = decimal->digits * 10 + (uint64_t)(*at - '0');
        decimal->count += fits && decimal->digits > 0;
        decimal->exponent += (fits ? 0 : 1) - fraction;
        decimal->exact &= fits;
    }
    return at;
}

/* Returns the end of the number at `at`; NULL where there is none. */
static const char *read_decimal(const char *at, const char *end, Decimal *decimal)
{
    *decimal = (Decimal){.exact = true};
    const char *whole = at, *point = read_digits(at, end, decimal, false);
    at = point < end && *point == '.' ? read_digits(point + 1, end, decimal, true) : point;
    if (at - whole == (at > point)) return NULL; /* no digit */
    if (at == end || (*at | 32) != 'e') return at;
    bool negative = at + 1 < end && at[1] == '-';
    const char *first = at += 1 + (at + 1 < end && (at[1] == '-' || at[1] == '+'));
    long exponent = 0;
    for (; at < end && *at >= '0' && *at <= '9'; at++)
        if (exponent < 100000) exponent = 10 * exponent + (*at - '0');
    decimal->exponent += negative ? -exponent : exponent;
    return at > first ? at : NULL;
}

static double round_slowly(const SmDraft *draft, const char *end)
{
    char text[LONGEST_NUMBER + 1];
    size_t length = (size_t)(end - draft->at);
    memcpy(text, draft->at, length);
    text[length] = 0;
    return strtod_l(text, NULL, draft->locale);
}

bool sm_draft_decimal(SmDraft *draft, double *value)
{
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    Decimal decimal;
    bool negative = *draft->at == '-', sign = negative || *draft->at == '+';
    const char *first = draft->at + sign, *end = read_decimal(first, draft->end, &decimal);
    bool letters = !end && draft->end - first > 2;
    if (letters && (!strncasecmp(first, "nan", 3) || !strncasecmp(first, "inf", 3))) {
        *value = (*first | 32) == 'n' ? NAN : negative ? -INFINITY : INFINITY;
        draft->at += sm_draft_length(draft);
        return true;
    }
    if (!end || (end < draft->end && !divides_words(draft, end)) ||
        end - draft->at > LONGEST_NUMBER)
        return sm_draft_fail_word(draft, "a number");
    long e = decimal.exponent;
    if (decimal.exact && decimal.digits <= (uint64_t)1 << 53 && e >= -22 && e <= 22) {
        double digits = (double)decimal.digits; /* and one rounding: exact (Clinger 1990) */
        digits = e < 0 ? digits / power[-e] : digits * power[e];
        *value = negative ? -digits : digits;
    } else {
        *value = round_slowly(draft, end);
    }
    draft->at = end;
    return true;
}

int sm_number_size(SmNumberType type)
{
    return type == SM_F64 ? 8 : type >= SM_I32 ? 4 : type >= SM_I16 ? 2 : 1;
}

/* The compiler makes one load of it where the size is known. */
static inline uint64_t load_bits(const unsigned char *at, int size, bool big)
{
    uint64_t bits = 0;
    for (int b = 0; b < size; b++) bits |= (uint64_t)at[big ? size - 1 - b : b] << 8 * b;
    return bits;
}

double sm_number_at(const void *at, SmNumberType type, bool big)
{
    uint32_t bits32;
    uint64_t bits64;
    float float32;
    double float64;
    switch (type) {
    case SM_I8:
        return *(const signed char *)at;
    case SM_U8:
        return *(const unsigned char *)at;
    case SM_I16:
        return (int16_t)load_bits(at, 2, big);
    case SM_U16:
        return (uint16_t)load_bits(at, 2, big);
    case SM_I32:
        return (int32_t)load_bits(at, 4, big);
    case SM_U32:
        return (uint32_t)load_bits(at, 4, big);
    case SM_F32:
        bits32 = (uint32_t)load_bits(at, 4, big);
        memcpy(&float32, &bits32, sizeof bits32);
        return (double)float32;
    default:
        bits64 = load_bits(at, 8, big);
        memcpy(&float64, &bits64, sizeof bits64);
        return float64;
    }
}

bool sm_draft_numbers(SmDraft *draft, SmNumberType type, int count, double *value)
{
    long size = draft->line ? 0 : sm_number_size(type);
    for (int i = 0; i < count; i++) {
        if (size ? draft->end - draft->at < size : !sm_draft_find(draft))
            return sm_draft_fail(draft, "the file ends where a number is due" SM_AGAIN);
        if (size) value[i] = sm_number_at(draft->at, type, draft->big);
        draft->at += size;
        if (!size && !sm_draft_decimal(draft, &value[i])) return false;
    }
    return true;
}

bool sm_draft_count(SmDraft *draft, SmNumberType type, int bytes, long *count)
{
    double number;
    if (!sm_draft_numbers(draft, type, 1, &number)) return false;
    double left = (double)(draft->end - draft->at) + (draft->line > 0); /* a last line end */
    if (!(number >= 0 && number == rint(number) && number <= INT_MAX && number * bytes <= left))
        return sm_draft_fail(draft, "a count of %.17g is wrong, or the file too small" SM_AGAIN,
                             number);
    *count = (long)number;
    return true;
}
