#include "inner.h"

#include <math.h>
#include <string.h>

int sb_version(void)
{
    return SHAPEBENCH_VERSION;
}

#define TEXT(number)   #number
#define DIGITS(number) TEXT(number)

const char *sb_version_text(void)
{
    return DIGITS(SHAPEBENCH_VERSION_MAJOR) "." DIGITS(SHAPEBENCH_VERSION_MINOR) "." DIGITS(
        SHAPEBENCH_VERSION_PATCH);
}

int sm_refuse(sb_error *error, int code, const char *format, ...)
{
    if (!error) return code;
    error->code = code;
    va_list arguments;
    va_start(arguments, format);
    sm_write_line(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    return code;
}

int sm_done(SmCode code, const SmError *from, sb_error *error)
{
    if (code) return sm_refuse(error, (int)code, "%s", from->text);
    if (error) error->code = SB_OK, error->text[0] = 0;
    return SB_OK;
}

int sm_check_given(const void *pointer, const char *name, sb_error *error)
{
    if (pointer) return SB_OK;
    return sm_refuse(error, SB_USAGE, "'%s' is NULL: it must be given", name);
}

int sm_begin(void *result, const char *name, sb_error *error)
{
    int code = sm_check_given(result, name, error);
    if (!code) memset(result, 0, sizeof(void *));
    return code;
}

int sm_check_finite(const double *value, int64_t count, double most, const char *name,
                    sb_error *error)
{
    int code = sm_check_given(value, name, error);
    for (int64_t i = 0; i < count && !code; i++)
        if (!(fabs(value[i]) <= most))
            code = sm_refuse(error, SB_USAGE, "'%s' holds %g at %lld: give numbers of at most %g",
                             name, value[i], (long long)i, most);
    return code;
}

int sm_check_array(const void *array, int64_t room, int64_t wanted, const char *name,
                   sb_error *error)
{
    int code = wanted > 0 ? sm_check_given(array, name, error) : SB_OK;
    if (code || room >= wanted) return code;
    return sm_refuse(error, SB_USAGE, "'%s' has room for %lld entries, and %lld are needed", name,
                     (long long)room, (long long)wanted);
}

int sm_check_range(double value, double least, double most, const char *name, sb_error *error)
{
    if (value >= least && value <= most) return SB_OK;
    return sm_refuse(error, SB_USAGE, "'%s' is %g: it is from %g to %g", name, value, least, most);
}

int sm_give_array(const void *from, int64_t count, size_t size, void *to, int64_t room,
                  const char *name, sb_error *error)
{
    int code = sm_check_array(to, room, count, name, error);
    if (code) return code;
    if (count > 0) memcpy(to, from, (size_t)count * size);
    return sm_done(SM_OK, NULL, error);
}

int sm_check_list(const void *list, int64_t room, const int64_t *count, const char *name,
                  sb_error *error)
{
    int code = sm_check_given(count, "count", error);
    if (!code && room < 0)
        code = sm_refuse(error, SB_USAGE, "'room' is %lld: it is 0 or more", (long long)room);
    return code ? code : sm_check_array(list, room, room, name, error);
}

void sm_count_particles(sb_body *body)
{
    SmCounts counts;
    body->type->count(body->engine, &counts);
    body->particles = counts.particles;
}
