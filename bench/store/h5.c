#include "h5.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "draft.h"
#include "sink.h"

void bench_h5_fail(BenchH5 *h5, const char *format, ...)
{
    if (h5->failed) return;
    h5->failed = true;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(h5->message, sizeof h5->message, format, arguments);
    va_end(arguments);
}

/* Walks from the call made to the deepest cause; the last entry stays. */
static herr_t keep_cause(unsigned depth, const H5E_error2_t *entry, void *data)
{
    BenchH5 *h5 = data;
    (void)depth;
    if (!entry->desc) return 0;
    snprintf(h5->message, sizeof h5->message, "%s", entry->desc);
    return 0;
}

/* Passes an HDF5 identifier or status through; notes the failure that a negative one is, and what
 * the sink has hidden from HDF5. */
static hid_t check(BenchH5 *h5, hid_t result)
{
    if (h5->number) h5->failed = true;
    if (result < 0 && !h5->failed) {
        h5->failed = true;
        H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_cause, h5);
    }
    return result;
}

static hid_t native(hid_t type)
{
    return H5Tget_native_type(type, H5T_DIR_DEFAULT);
}

static void start(BenchH5 *h5)
{
    *h5 = (BenchH5){.file = -1};
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

static hid_t strong_access(void)
{
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
    return access;
}

void bench_h5_create(BenchH5 *h5, const char *path)
{
    start(h5);
    hid_t access = strong_access();
    bench_sink_use(access, &h5->number);
    h5->file = check(h5, H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access));
    H5Pclose(access);
    bench_h5_text(h5, h5->file, BENCH_H5_CHECKSUM, "CRC-32, the file's last 64 bytes");
}

void bench_h5_open(BenchH5 *h5, const char *path)
{
    start(h5);
    hid_t access = strong_access();
    h5->file = check(h5, H5Fopen(path, H5F_ACC_RDONLY, access));
    H5Pclose(access);
}

bool bench_h5_close(BenchH5 *h5)
{
    if (h5->file >= 0) check(h5, H5Fclose(h5->file));
    h5->file = -1;
    return !h5->failed;
}

hid_t bench_h5_group(BenchH5 *h5, hid_t parent, const char *name)
{
    if (h5->failed) return -1;
    return check(h5, H5Gcreate2(parent, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
}

static void write_attribute(BenchH5 *h5, hid_t object, const char *name, hid_t type, hid_t space,
                            const void *values)
{
    hid_t memory = native(type);
    hid_t attribute = check(h5, H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
    if (!h5->failed) check(h5, H5Awrite(attribute, memory, values));
    if (attribute >= 0) H5Aclose(attribute);
    H5Tclose(memory);
    H5Sclose(space);
}

void bench_h5_numbers(BenchH5 *h5, hid_t object, const char *name, hid_t type, int count,
                      const void *values)
{
    if (h5->failed) return;
    hsize_t size = (hsize_t)count;
    hid_t space = count ? H5Screate_simple(1, &size, NULL) : H5Screate(H5S_SCALAR);
    write_attribute(h5, object, name, type, space, values);
}

void bench_h5_text(BenchH5 *h5, hid_t object, const char *name, const char *text)
{
    if (h5->failed) return;
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, strlen(text) + 1);
    H5Tset_cset(type, H5T_CSET_UTF8);
    write_attribute(h5, object, name, type, H5Screate(H5S_SCALAR), text);
    H5Tclose(type);
}

int bench_h5_types(const BenchField *field, hid_t *file, hid_t *memory)
{
    hid_t stored = H5T_IEEE_F64LE, native = H5T_NATIVE_DOUBLE;
    switch (field->kind) {
    case BENCH_INT:
        stored = H5T_STD_I32LE, native = H5T_NATIVE_INT;
        break;
    case BENCH_LONG:
        stored = H5T_STD_I64LE, native = H5T_NATIVE_LONG;
        break;
    case BENCH_BOOL:
        stored = H5T_STD_U8LE, native = H5T_NATIVE_UINT8;
        break;
    case BENCH_HASH:
        stored = H5T_STD_U64LE, native = H5T_NATIVE_ULLONG;
        break;
    case BENCH_TEXT:
        stored = native = H5T_C_S1;
        break;
    case BENCH_DOUBLE:
        break;
    }
    *file = H5Tcopy(stored);
    *memory = H5Tcopy(native);
    for (int t = 0; t < 2 && field->kind == BENCH_TEXT; t++) {
        H5Tset_size(t ? *memory : *file, field->size);
        H5Tset_cset(t ? *memory : *file, H5T_CSET_UTF8);
    }
    return (int)(field->size / H5Tget_size(*memory));
}

void bench_h5_fields(BenchH5 *h5, hid_t object, const BenchField *fields, int count,
                     const void *record)
{
    for (int i = 0; i < count && !h5->failed; i++) {
        const char *value = (const char *)record + fields[i].offset;
        if (!fields[i].name) continue;
        if (fields[i].kind == BENCH_TEXT) {
            bench_h5_text(h5, object, fields[i].name, value);
            continue;
        }
        hid_t type, memory;
        int numbers = bench_h5_types(&fields[i], &type, &memory);
        bench_h5_numbers(h5, object, fields[i].name, type, numbers == 1 ? 0 : numbers, value);
        H5Tclose(type);
        H5Tclose(memory);
    }
}

void bench_h5_dataset(BenchH5 *h5, hid_t parent, const char *name, hid_t type, int rank,
                      const hsize_t *size, const void *values)
{
    if (h5->failed) return;
    hid_t memory = native(type), space = H5Screate_simple(rank, size, NULL);
    hid_t dataset =
        check(h5, H5Dcreate2(parent, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    bool empty = H5Sget_simple_extent_npoints(space) == 0;
    if (!h5->failed && !empty)
        check(h5, H5Dwrite(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
    if (dataset >= 0) check(h5, H5Dclose(dataset));
    H5Sclose(space);
    H5Tclose(memory);
}

/* Chunks of about 64 KiB to 1 MiB (HDF5's chunk cache), whatever an entry's size. */
static void chunk_shape(hid_t type, int rank, const hsize_t *size, hsize_t *chunk)
{
    hsize_t room = (1 << 20) / H5Tget_size(type), least = room / 16, inner = 1;
    for (int axis = rank - 1; axis > 0; axis--) {
        chunk[axis] = size[axis] < room / inner ? size[axis] : room / inner;
        inner *= chunk[axis];
    }
    chunk[0] = inner < least ? least / inner : 1;
}

hid_t bench_h5_growing(BenchH5 *h5, hid_t parent, const char *name, hid_t type, int rank,
                       const hsize_t *size)
{
    if (h5->failed) return -1;
    hsize_t first[4], most[4], chunk[4];
    for (int axis = 0; axis < rank; axis++) first[axis] = most[axis] = size[axis];
    first[0] = 0;
    most[0] = H5S_UNLIMITED;
    chunk_shape(type, rank, size, chunk);
    hid_t space = H5Screate_simple(rank, first, most), layout = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(layout, rank, chunk);
    hid_t dataset =
        check(h5, H5Dcreate2(parent, name, type, space, H5P_DEFAULT, layout, H5P_DEFAULT));
    H5Pclose(layout);
    H5Sclose(space);
    return dataset;
}

void bench_h5_append(BenchH5 *h5, hid_t dataset, hsize_t rows, const void *values)
{
    if (h5->failed) return;
    hsize_t size[4], from[4] = {0};
    hid_t type = H5Dget_type(dataset), memory = native(type), space = H5Dget_space(dataset);
    int rank = H5Sget_simple_extent_dims(space, size, NULL);
    H5Sclose(space);
    from[0] = size[0];
    size[0] += rows;
    if (check(h5, H5Dset_extent(dataset, size)) >= 0) {
        space = H5Dget_space(dataset);
        size[0] = rows;
        hid_t part = H5Screate_simple(rank, size, NULL);
        H5Sselect_hyperslab(space, H5S_SELECT_SET, from, NULL, size, NULL);
        check(h5, H5Dwrite(dataset, memory, part, space, H5P_DEFAULT, values));
        H5Sclose(part);
        H5Sclose(space);
    }
    H5Tclose(memory);
    H5Tclose(type);
}

void bench_h5_link(BenchH5 *h5, const char *path, hid_t parent, const char *name)
{
    if (h5->failed) return;
    check(h5, H5Lcreate_hard(h5->file, path, parent, name, H5P_DEFAULT, H5P_DEFAULT));
}

void bench_h5_view(BenchH5 *h5, hid_t parent, const char *name, hid_t source, const hsize_t *start,
                   const hsize_t *size)
{
    if (h5->failed) return;
    char path[256];
    if (check(h5, H5Iget_name(source, path, sizeof path)) < 0) return;
    hid_t type = H5Dget_type(source), part = H5Dget_space(source);
    int rank = H5Sget_simple_extent_ndims(part);
    hid_t space = H5Screate_simple(rank, size, NULL), layout = H5Pcreate(H5P_DATASET_CREATE);
    H5Sselect_hyperslab(part, H5S_SELECT_SET, start, NULL, size, NULL);
    check(h5, H5Pset_virtual(layout, space, ".", path, part));
    hid_t view = check(h5, H5Dcreate2(parent, name, type, space, H5P_DEFAULT, layout, H5P_DEFAULT));
    if (view >= 0) check(h5, H5Dclose(view));
    H5Pclose(layout);
    H5Sclose(space);
    H5Sclose(part);
    H5Tclose(type);
}

SmCode bench_h5_store(const char *path, void (*write)(BenchH5 *h5, void *record), void *record,
                      SmError *error)
{
    BenchDraft draft;
    SmCode code = bench_draft_begin(path, &draft, error);
    if (code) return code;
    BenchH5 h5;
    bench_h5_create(&h5, draft.tmp);
    write(&h5, record);
    if (bench_h5_close(&h5)) return bench_draft_commit(&draft, error);
    bench_draft_discard(&draft);
    return bench_draft_fail(path, h5.number, h5.message, error);
}
