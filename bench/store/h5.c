#include "h5.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../../lib/system/file.h"
#include "../system/remark.h"
#include "checksum.h"
#include "draft.h"

void bench_h5_fail(BenchH5 *h5, const char *format, ...)
{
    if (h5->failed) return;
    h5->failed = true;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(h5->message, sizeof h5->message, format, arguments);
    va_end(arguments);
}

/* Walks from the call made to the deepest cause, which stays. HDF5 says what the system said as
 * "errno = 28" within its text. */
static herr_t keep_cause(unsigned depth, const H5E_error2_t *entry, void *data)
{
    BenchH5 *h5 = data;
    (void)depth;
    if (!entry->desc) return 0;
    snprintf(h5->message, sizeof h5->message, "%s", entry->desc);
    const char *number = strstr(entry->desc, "errno = ");
    if (number) h5->number = atoi(number + strlen("errno = "));
    return 0;
}

/* Passes an HDF5 identifier or status through; notes the failure that a negative one is. */
static hid_t check(BenchH5 *h5, hid_t result)
{
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

/* Keeps links (of a group) and attributes of what is created within its header: HDF5 crashes where
 * the heap that it would make of more than 8 of them is damaged. Returns `list`. */
static hid_t keep_compact(hid_t list, bool group)
{
    const unsigned most = 65535; /* HDF5's own limit */
    H5Pset_attr_phase_change(list, most, 0);
    if (group) H5Pset_link_phase_change(list, most, 0);
    return list;
}

/* HDF5 is to close nothing at exit(): a file that could not be written is still open then
 * (bench_h5_close()). It must know before its first use. */
__attribute__((constructor)) static void close_nothing_at_exit(void)
{
    H5dont_atexit();
}

/* Returns the access to files of either use, which the caller closes. */
static hid_t start(BenchH5 *h5)
{
    *h5 = (BenchH5){.file = -1};
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
    H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
    return access;
}

void bench_h5_create(BenchH5 *h5, const char *path)
{
    hid_t access = start(h5), creation = keep_compact(H5Pcreate(H5P_FILE_CREATE), true);
    H5Pset_userblock(creation, BENCH_CHECKSUM_BLOCK);
    h5->file = check(h5, H5Fcreate(path, H5F_ACC_TRUNC, creation, access));
    h5->created = path;
    H5Pclose(creation);
    H5Pclose(access);
}

void bench_h5_open(BenchH5 *h5, const char *path)
{
    hid_t access = start(h5);
    h5->file = check(h5, H5Fopen(path, H5F_ACC_RDONLY, access));
    H5Pclose(access);
}

bool bench_h5_close(BenchH5 *h5)
{
    bool writes = h5->file >= 0 && h5->created;
    if (writes && !h5->failed) check(h5, H5Fflush(h5->file, H5F_SCOPE_GLOBAL));
    /* HDF5 1.10 crashes when it closes what it could not write: that stays open */
    if (h5->file >= 0 && !(writes && h5->failed)) check(h5, H5Fclose(h5->file));
    if (writes && !h5->failed) {
        h5->number = bench_checksum_write(h5->created);
        h5->failed = h5->number != 0;
    }
    h5->file = -1;
    return !h5->failed;
}

/* ---- writing */

hid_t bench_h5_group(BenchH5 *h5, hid_t parent, const char *name)
{
    if (h5->failed) return -1;
    hid_t creation = keep_compact(H5Pcreate(H5P_GROUP_CREATE), true);
    hid_t group = check(h5, H5Gcreate2(parent, name, H5P_DEFAULT, creation, H5P_DEFAULT));
    H5Pclose(creation);
    return group;
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

/* The type of a field's values in the file; the caller closes it. */
static hid_t type_of(const BenchField *field)
{
    hid_t type = H5Tcopy(field->kind == BENCH_TEXT   ? H5T_C_S1
                         : field->kind == BENCH_INT  ? H5T_STD_I32LE
                         : field->kind == BENCH_LONG ? H5T_STD_I64LE
                         : field->kind == BENCH_BOOL ? H5T_STD_U8LE
                         : field->kind == BENCH_HASH ? H5T_STD_U64LE
                                                     : H5T_IEEE_F64LE);
    if (field->kind == BENCH_TEXT) {
        H5Tset_size(type, field->size);
        H5Tset_cset(type, H5T_CSET_UTF8);
    }
    return type;
}

void bench_h5_fields(BenchH5 *h5, hid_t object, const BenchField *fields, int count,
                     const void *record)
{
    for (int i = 0; i < count && !h5->failed; i++) {
        const char *value = (const char *)record + fields[i].offset;
        if (!fields[i].name) continue;
        if (fields[i].kind == BENCH_TEXT) {
            bench_h5_text(h5, object, fields[i].name, bench_field_text(&fields[i], record));
            continue;
        }
        hid_t type = type_of(&fields[i]);
        int numbers = bench_field_values(&fields[i]);
        bench_h5_numbers(h5, object, fields[i].name, type, numbers == 1 ? 0 : numbers, value);
        H5Tclose(type);
    }
}

/* Chunks of about 64 KiB to 1 MiB (HDF5's chunk cache), whatever an entry's size, and no longer
 * than the dataset may become. */
static void chunk_shape(hid_t type, int rank, const hsize_t *most, hsize_t *chunk)
{
    hsize_t room = (1 << 20) / H5Tget_size(type), least = room / 16, inner = 1;
    for (int axis = rank - 1; axis > 0; axis--) {
        chunk[axis] = most[axis] < room / inner ? most[axis] : room / inner;
        inner *= chunk[axis];
    }
    chunk[0] = inner < least ? least / inner : 1;
    if (chunk[0] > most[0]) chunk[0] = most[0];
}

/* Creates a dataset of chunks that carry checksums; one that stays empty has none. */
static hid_t create_dataset(BenchH5 *h5, hid_t parent, const char *name, hid_t type, int rank,
                            const hsize_t *size, const hsize_t *most)
{
    hsize_t chunk[4], values = 1;
    for (int axis = 0; axis < rank; axis++) values *= most[axis];
    hid_t space = H5Screate_simple(rank, size, most), layout = H5Pcreate(H5P_DATASET_CREATE);
    if (values) {
        chunk_shape(type, rank, most, chunk);
        H5Pset_chunk(layout, rank, chunk);
        H5Pset_fletcher32(layout);
    }
    hid_t dataset =
        check(h5, H5Dcreate2(parent, name, type, space, H5P_DEFAULT, layout, H5P_DEFAULT));
    H5Pclose(layout);
    H5Sclose(space);
    return dataset;
}

void bench_h5_dataset(BenchH5 *h5, hid_t parent, const char *name, hid_t type, int rank,
                      const hsize_t *size, const void *values)
{
    if (h5->failed) return;
    hid_t memory = native(type);
    hid_t dataset = create_dataset(h5, parent, name, type, rank, size, size);
    if (!h5->failed) check(h5, H5Dwrite(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
    if (dataset >= 0) check(h5, H5Dclose(dataset));
    H5Tclose(memory);
}

hid_t bench_h5_growing(BenchH5 *h5, hid_t parent, const char *name, hid_t type, int rank,
                       const hsize_t *size)
{
    if (h5->failed) return -1;
    hsize_t first[4], most[4];
    for (int axis = 0; axis < rank; axis++) first[axis] = most[axis] = size[axis];
    first[0] = 0;
    most[0] = H5S_UNLIMITED;
    return create_dataset(h5, parent, name, type, rank, first, most);
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

/* Of a column: one number a record, or several. */
static int rank_of(const BenchField *field)
{
    return field->series || bench_field_values(field) > 1 ? 2 : 1;
}

void bench_h5_columns(BenchH5 *h5, hid_t group, const BenchField *fields, int count,
                      const void *records, size_t size, long number)
{
    for (int f = 0; f < count && !h5->failed; f++) {
        const BenchField *field = &fields[f];
        if (!field->name) continue;
        hid_t type = type_of(field);
        char *column = sm_alloc((size_t)number, field->size);
        for (long r = 0; r < number; r++)
            memcpy(column + (size_t)r * field->size,
                   (const char *)records + (size_t)r * size + field->offset, field->size);
        hsize_t shape[] = {(hsize_t)number, (hsize_t)bench_field_values(field)};
        bench_h5_dataset(h5, group, field->name, type, rank_of(field), shape, column);
        free(column);
        H5Tclose(type);
    }
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

/* ---- reading */

static bool same_class(hid_t type, BenchKind kind)
{
    H5T_class_t class = H5Tget_class(type);
    if (kind == BENCH_TEXT) return class == H5T_STRING && H5Tis_variable_str(type) <= 0;
    return class == (kind == BENCH_DOUBLE ? H5T_FLOAT : H5T_INTEGER);
}

/* Opens an attribute of the right kind and number of elements. */
static hid_t open_attribute(BenchH5 *h5, hid_t object, const char *name, BenchKind kind, int count)
{
    if (h5->failed) return -1;
    if (H5Aexists(object, name) <= 0) {
        bench_h5_fail(h5, "attribute '%s' is missing", name);
        return -1;
    }
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    hid_t type = attribute < 0 ? -1 : H5Aget_type(attribute);
    hid_t space = attribute < 0 ? -1 : H5Aget_space(attribute);
    if (type < 0 || space < 0 || !same_class(type, kind) ||
        H5Sget_simple_extent_npoints(space) != count)
        bench_h5_fail(h5, "attribute '%s' has the wrong type or size", name);
    if (type >= 0) H5Tclose(type);
    if (space >= 0) H5Sclose(space);
    return attribute;
}

void bench_h5_read_text(BenchH5 *h5, hid_t object, const char *name, size_t size, char *text)
{
    hid_t attribute = open_attribute(h5, object, name, BENCH_TEXT, 1);
    if (!h5->failed) {
        hid_t stored = H5Aget_type(attribute), type = H5Tcopy(stored);
        H5Tset_size(type, size);
        H5Tset_strpad(type, H5T_STR_NULLTERM);
        if (H5Tget_size(stored) > size || H5Aread(attribute, type, text) < 0)
            bench_h5_fail(h5, "attribute '%s' cannot be read or is too long", name);
        text[size - 1] = '\0';
        sm_printable(text);
        H5Tclose(type);
        H5Tclose(stored);
    }
    if (attribute >= 0) H5Aclose(attribute);
}

static void read_numbers(BenchH5 *h5, hid_t object, const BenchField *field, void *value)
{
    hid_t type = type_of(field), memory = native(type);
    hid_t attribute =
        open_attribute(h5, object, field->name, field->kind, bench_field_values(field));
    if (!h5->failed && H5Aread(attribute, memory, value) < 0)
        bench_h5_fail(h5, "attribute '%s' cannot be read", field->name);
    if (!h5->failed && field->kind == BENCH_BOOL) {
        unsigned char *flag = value; /* any other byte is no bool */
        *flag = *flag != 0;
    }
    if (attribute >= 0) H5Aclose(attribute);
    H5Tclose(type);
    H5Tclose(memory);
}

void bench_h5_read_fields(BenchH5 *h5, hid_t object, const BenchField *fields, int count,
                          void *record)
{
    for (int i = 0; i < count && !h5->failed; i++) {
        char *value = (char *)record + fields[i].offset;
        if (!fields[i].name) continue;
        if (fields[i].kind == BENCH_TEXT)
            bench_h5_read_text(h5, object, fields[i].name, fields[i].size, value);
        else
            read_numbers(h5, object, &fields[i], value);
    }
}

void bench_h5_read_what_is_there(BenchH5 *h5, hid_t object, const BenchField *fields, int count,
                                 void *record)
{
    for (int i = 0; i < count && !h5->failed; i++)
        if (H5Aexists(object, fields[i].name) > 0)
            bench_h5_read_fields(h5, object, &fields[i], 1, record);
}

hid_t bench_h5_find_group(BenchH5 *h5, hid_t parent, const char *name)
{
    if (h5->failed) return -1;
    hid_t group = H5Gopen2(parent, name, H5P_DEFAULT);
    if (group < 0) bench_h5_fail(h5, "group '%s' is missing", name);
    return group;
}

/* Are all datasets that were found no larger than the file? One that was never written can claim
 * any size. */
static bool fits(BenchH5 *h5, hid_t dataset, hid_t space)
{
    hid_t type = H5Dget_type(dataset);
    hssize_t count = H5Sget_simple_extent_npoints(space);
    size_t unit = H5Tget_size(type);
    bool inside = count >= 0 && unit > 0 && (hsize_t)count <= (h5->size - h5->found) / unit;
    if (inside) h5->found += (hsize_t)count * unit;
    H5Tclose(type);
    return inside;
}

hid_t bench_h5_find_dataset(BenchH5 *h5, hid_t parent, const char *name, int rank,
                            const hsize_t *size)
{
    if (h5->failed) return -1;
    hid_t dataset = H5Dopen2(parent, name, H5P_DEFAULT);
    if (dataset < 0) {
        bench_h5_fail(h5, "dataset '%s' is missing", name);
        return -1;
    }
    hid_t space = H5Dget_space(dataset);
    hsize_t stored[H5S_MAX_RANK] = {0};
    bool same = H5Sget_simple_extent_dims(space, stored, NULL) == rank;
    for (int axis = 0; same && axis < rank; axis++) same = stored[axis] == size[axis];
    if (!same) bench_h5_fail(h5, "dataset '%s' has the wrong size", name);
    if (same && h5->size && !fits(h5, dataset, space))
        bench_h5_fail(h5, "dataset '%s' holds more than the file does", name);
    H5Sclose(space);
    return dataset;
}

static bool has_checksum(hid_t dataset)
{
    hid_t layout = H5Dget_create_plist(dataset);
    unsigned flags;
    bool found =
        H5Pget_filter_by_id2(layout, H5Z_FILTER_FLETCHER32, &flags, NULL, NULL, 0, NULL, NULL) >= 0;
    H5Pclose(layout);
    return found || H5Dget_storage_size(dataset) == 0; /* empty */
}

void bench_h5_read(BenchH5 *h5, hid_t dataset, hid_t type, void *values)
{
    if (h5->failed) return;
    h5->unchecked |= !has_checksum(dataset);
    if (H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
        bench_h5_fail(h5, "a dataset cannot be read");
}

void bench_h5_check_kind(BenchH5 *h5, const char *kind, int oldest, int newest)
{
    char found[64] = "";
    int number = 0;
    const BenchField field = BENCH_VARIABLE("schema", BENCH_INT, number);
    bench_h5_read_text(h5, h5->file, "kind", sizeof found, found);
    if (h5->failed || strcmp(found, kind) != 0) {
        snprintf(h5->message, sizeof h5->message, "it is HDF5, but not a %s file", kind);
        h5->failed = true;
    }
    bench_h5_read_fields(h5, h5->file, &field, 1, &number);
    if (!h5->failed && (number < oldest || number > newest))
        bench_h5_fail(h5, "its schema is %d and this program reads %d; %s", number, newest,
                      number < oldest ? "measure again" : "use a newer shapebench");
}

/* A dataset of texts or numbers of another class, or of longer texts, would be converted. */
static void check_type(BenchH5 *h5, hid_t dataset, const BenchField *field)
{
    if (h5->failed) return;
    hid_t stored = H5Dget_type(dataset);
    bool same = same_class(stored, field->kind) &&
                (field->kind != BENCH_TEXT || H5Tget_size(stored) <= field->size);
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
        if (!field->name) continue;
        hid_t type = type_of(field), memory = native(type);
        hsize_t shape[] = {(hsize_t)number, (hsize_t)bench_field_values(field)};
        hid_t dataset = bench_h5_find_dataset(h5, group, field->name, rank_of(field), shape);
        check_type(h5, dataset, field);
        if (!h5->failed) {
            char *column = sm_alloc((size_t)number, field->size);
            bench_h5_read(h5, dataset, memory, column);
            if (!h5->failed) scatter(field, column, records, size, number);
            free(column);
        }
        H5Tclose(type);
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

SmCode bench_h5_load(const char *path, void (*read)(BenchH5 *h5, void *record), void *record,
                     SmError *error)
{
    double bytes;
    BenchChecksum checksum;
    BenchH5 h5;
    FILE *file = sm_file_open(path, &bytes, error);
    if (!file) return SM_INPUT;
    int number = bench_checksum_check(file, &checksum);
    fclose(file);
    if (number) return sm_fail(error, SM_INPUT, "%s: cannot be read: %s", path, strerror(number));
    if (checksum == BENCH_CHECKSUM_OLD)
        return sm_fail(
            error, SM_INPUT,
            "%.200s: HDF5 without checksums, as shapebench stored it until November 2026: "
            "measure again, or convert it: h5repack -m 1 -L -f FLET %.200s NEW.h5",
            path, path);
    bench_h5_open(&h5, path);
    if (strstr(h5.message, "lock file") || strstr(h5.message, "already open"))
        return sm_fail(
            error, SM_INPUT,
            "%.200s: another program has it open, or ended while it had: close it there, "
            "or type h5clear -s %.200s",
            path, path);
    if (h5.failed)
        return sm_fail(error, SM_INPUT, "%.200s: not an HDF5 file, or cut off (%.200s)", path,
                       h5.message);
    h5.size = (hsize_t)bytes;
    read(&h5, record);
    if (!bench_h5_close(&h5))
        return sm_fail(error, SM_INPUT, "cannot use %.200s: %s%.250s", path,
                       checksum ? "damaged, or changed by another program: " : "", h5.message);
    if (checksum)
        bench_remark("%s: written to by another program; %s", path,
                     h5.unchecked ? "some of its data have no checksums"
                                  : "HDF5's own checksums hold");
    return SM_OK;
}
