#include "export.h"

#include <math.h>
#include <stdbool.h>

#include "quote.h"

void bench_csv_number(FILE *file, double value)
{
    if (isfinite(value)) fprintf(file, "%.9g", value);
}

json_t *bench_json_number(double value)
{
    if (!isfinite(value)) return json_null();
    return value == rint(value) && fabs(value) < 1e15 ? json_integer((json_int_t)value)
                                                      : json_real(value);
}

json_t *bench_json_machine(const BenchMachine *machine)
{
    int count;
    const BenchField *fields = bench_machine_fields(&count);
    json_t *object = json_object();
    for (int i = 0; i < count; i++) {
        const char *at = (const char *)machine + fields[i].offset;
        json_t *value = NULL;
        switch (fields[i].kind) {
        case BENCH_TEXT:
            value = bench_json_text(at);
            break;
        case BENCH_INT:
            value = json_integer(*(const int *)(const void *)at);
            break;
        case BENCH_LONG:
            value = json_integer(*(const long *)(const void *)at);
            break;
        case BENCH_BOOL:
            value = json_boolean(*(const bool *)at);
            break;
        case BENCH_HASH:
        case BENCH_DOUBLE:
            break; /* the machine has none */
        }
        if (value) json_object_set_new(object, fields[i].name, value);
    }
    return object;
}
