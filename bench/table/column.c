#include "column.h"

#include <stdlib.h>
#include <string.h>

#include "../../lib/error.h"

void bench_h5_columns(BenchH5 *h5, hid_t group, const BenchField *fields, int count,
                      const void *records, size_t size, long number)
{
    for (int f = 0; f < count && !h5->failed; f++) {
        const BenchField *field = &fields[f];
        hid_t file, memory;
        int values = bench_h5_types(field, &file, &memory);
        char *column = sm_alloc((size_t)number, field->size);
        for (long r = 0; r < number; r++)
            memcpy(column + (size_t)r * field->size,
                   (const char *)records + (size_t)r * size + field->offset, field->size);
        hsize_t shape[] = {(hsize_t)number, (hsize_t)values};
        bench_h5_dataset(h5, group, field->name, file, values > 1 ? 2 : 1, shape, column);
        free(column);
        H5Tclose(file);
        H5Tclose(memory);
    }
}

/* A dataset of texts or numbers of another class, or of longer texts, would be converted. */
static void check_type(BenchH5 *h5, hid_t dataset, const BenchField *field, hid_t file)
{
    if (h5->failed) return;
    hid_t stored = H5Dget_type(dataset);
    bool text = field->kind == BENCH_TEXT;
    bool same = H5Tget_class(stored) == H5Tget_class(file) &&
                (!text || (H5Tis_variable_str(stored) <= 0 && H5Tget_size(stored) <= field->size));
    if (!same) bench_h5_fail(h5, "dataset '%s' has the wrong type", field->name);
    H5Tclose(stored);
}

static void scatter(const BenchField *field, const char *column, char *records, size_t size,
                    long number)
{
    for (long r = 0; r < number; r++) {
        char *value = records + (size_t)r * size + field->offset;
        memcpy(value, column + (size_t)r * field->size, field->size);
        if (field->kind == BENCH_TEXT) value[field->size - 1] = '\0';
        if (field->kind == BENCH_BOOL) *value = *value != 0; /* any other byte is no bool */
    }
}

void bench_h5_read_columns(BenchH5 *h5, hid_t group, const BenchField *fields, int count,
                           void *records, size_t size, long number)
{
    for (int f = 0; f < count && !h5->failed; f++) {
        const BenchField *field = &fields[f];
        hid_t file, memory;
        int values = bench_h5_types(field, &file, &memory);
        hsize_t shape[] = {(hsize_t)number, (hsize_t)values};
        hid_t dataset = bench_h5_find_dataset(h5, group, field->name, values > 1 ? 2 : 1, shape);
        check_type(h5, dataset, field, file);
        if (!h5->failed) {
            char *column = sm_alloc((size_t)number, field->size);
            bench_h5_read(h5, dataset, memory, column);
            if (!h5->failed) scatter(field, column, records, size, number);
            free(column);
        }
        H5Tclose(file);
        H5Tclose(memory);
    }
}

long bench_h5_records(BenchH5 *h5, hid_t group, const BenchField *fields, long most)
{
    if (h5->failed) return 0;
    hid_t dataset = H5Dopen2(group, fields[0].name, H5P_DEFAULT);
    hsize_t shape[H5S_MAX_RANK] = {0};
    int rank = -1;
    if (dataset >= 0) {
        hid_t space = H5Dget_space(dataset);
        rank = H5Sget_simple_extent_dims(space, shape, NULL);
        H5Sclose(space);
    }
    if (rank < 1 || shape[0] > (hsize_t)most)
        bench_h5_fail(h5, "dataset '%s' is missing or has the wrong size", fields[0].name);
    return h5->failed ? 0 : (long)shape[0];
}
