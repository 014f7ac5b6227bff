#include "h5.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../../lib/system/child.h"
#include "../../lib/system/printable.h"
#include "checksum.h"

static bool same_class(hid_t type, BenchKind kind)
{
    H5T_class_t class = H5Tget_class(type);
    if (kind == BENCH_TEXT) return class == H5T_STRING && H5Tis_variable_str(type) <= 0;
    return class == (kind == BENCH_DOUBLE ? H5T_FLOAT : H5T_INTEGER);
}

/* Opens an attribute of the right kind and number of elements; its type goes to `type`. */
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
    hid_t file, memory;
    int count = bench_h5_types(field, &file, &memory);
    hid_t attribute = open_attribute(h5, object, field->name, field->kind, count);
    if (!h5->failed && H5Aread(attribute, memory, value) < 0)
        bench_h5_fail(h5, "attribute '%s' cannot be read", field->name);
    if (!h5->failed && field->kind == BENCH_BOOL) {
        unsigned char *flag = value; /* any other byte is no bool */
        *flag = *flag != 0;
    }
    if (attribute >= 0) H5Aclose(attribute);
    H5Tclose(file);
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

/* Not a link to another name or file: those that we write have none. */
static bool is_own(hid_t parent, const char *name)
{
    H5L_info_t link;
    return H5Lget_info(parent, name, &link, H5P_DEFAULT) >= 0 && link.type == H5L_TYPE_HARD;
}

hid_t bench_h5_find_group(BenchH5 *h5, hid_t parent, const char *name)
{
    if (h5->failed) return -1;
    hid_t group = is_own(parent, name) ? H5Gopen2(parent, name, H5P_DEFAULT) : -1;
    if (group < 0) bench_h5_fail(h5, "group '%s' is missing", name);
    return group;
}

/* Does the dataset lie in the file, and are all that were found no larger than it? One that was
 * never written, or is packed, can claim any size. */
static bool fits(BenchH5 *h5, hid_t dataset, hid_t space)
{
    hid_t layout = H5Dget_create_plist(dataset), type = H5Dget_type(dataset);
    hssize_t count = H5Sget_simple_extent_npoints(space);
    size_t unit = H5Tget_size(type);
    bool inside = layout >= 0 && H5Pget_layout(layout) != H5D_VIRTUAL &&
                  H5Pget_external_count(layout) == 0 && count >= 0 && unit > 0 &&
                  (hsize_t)count <= (h5->size - h5->found) / unit;
    if (inside) h5->found += (hsize_t)count * unit;
    if (layout >= 0) H5Pclose(layout);
    if (type >= 0) H5Tclose(type);
    return inside;
}

hid_t bench_h5_find_dataset(BenchH5 *h5, hid_t parent, const char *name, int rank,
                            const hsize_t *size)
{
    if (h5->failed) return -1;
    hid_t dataset = is_own(parent, name) ? H5Dopen2(parent, name, H5P_DEFAULT) : -1;
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

void bench_h5_read(BenchH5 *h5, hid_t dataset, hid_t type, void *values)
{
    if (h5->failed) return;
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

/* A file to load. */
typedef struct {
    const char *path;
    void (*read)(BenchH5 *h5, void *record);
    void *record;
    hsize_t size;
    BenchChecksum checksum;
} Load;

static SmCode load_here(const Load *load, SmError *error)
{
    BenchH5 h5;
    bench_h5_open(&h5, load->path);
    if (h5.file < 0)
        return sm_fail(error, SM_INPUT, "cannot read %.200s: not an HDF5 file, or cut off (%.200s)",
                       load->path, h5.message);
    h5.size = load->size;
    if (load->checksum == BENCH_CHECKSUM_ABSENT && H5Aexists(h5.file, BENCH_H5_CHECKSUM) > 0)
        bench_h5_fail(&h5,
                      "its checksum is missing: it was cut off, or something else wrote to it");
    else
        load->read(&h5, load->record);
    if (bench_h5_close(&h5)) return SM_OK;
    return sm_fail(error, SM_INPUT, "cannot use %.200s: %.250s", load->path, h5.message);
}

/* In a child: its copy of the record goes with it, its error is the reply. */
static int try_to_load(void *load, int reply)
{
    SmError error;
    memset(&error, 0, sizeof error);
    bool good = load_here(load, &error) == SM_OK;
    return good || sm_child_write(reply, &error, sizeof error) ? 0 : 1;
}

/* Damage that crashes HDF5, or has it take memory or time beyond measure, ends a child only. */
static SmCode load_in_child(const Load *load, SmError *error)
{
    static const double megabyte = 1048576;
    double megabytes = (double)load->size / megabyte;
    SmChildLimits limits = {.seconds = 30 + megabytes / 10, .megabytes = 128 + 8 * megabytes};
    SmChildResult result = sm_child_run(try_to_load, (void *)load, &limits);
    SmCode code = SM_OK;
    if (result.end == SM_CHILD_REPLIED && result.size == sizeof *error) {
        const SmError *said = (const SmError *)result.reply;
        code = sm_fail(error, said->code, "%s", said->text);
    } else if (result.end == SM_CHILD_FAILED) {
        code = sm_fail(error, SM_INPUT, "cannot read %.200s: no process can be started: %s",
                       load->path, strerror(result.status));
    } else if (result.end != SM_CHILD_REPLIED) {
        code =
            sm_fail(error, SM_INPUT, "cannot use %.200s: so damaged that reading it %s", load->path,
                    result.end == SM_CHILD_CRASHED    ? "crashes HDF5"
                    : result.end == SM_CHILD_TOO_LONG ? "does not end"
                                                      : "takes more memory than its size allows");
    }
    free(result.reply);
    return code;
}

SmCode bench_h5_load(const char *path, void (*read)(BenchH5 *h5, void *record), void *record,
                     SmError *error)
{
    struct stat status;
    if (access(path, R_OK) != 0 || stat(path, &status) != 0)
        return sm_fail(error, SM_INPUT, "cannot read %.300s: %s", path, strerror(errno));
    if (!S_ISREG(status.st_mode)) /* a pipe would be waited for */
        return sm_fail(error, SM_INPUT, "cannot read %.300s: it is a %s, not a file", path,
                       S_ISDIR(status.st_mode) ? "folder" : "pipe or device");
    Load load = {path, read, record, (hsize_t)status.st_size, BENCH_CHECKSUM_ABSENT};
    int number = bench_checksum_check(path, &load.checksum);
    if (number) return sm_fail(error, SM_INPUT, "cannot read %.300s: %s", path, strerror(number));
    if (load.checksum == BENCH_CHECKSUM_WRONG)
        return sm_fail(error, SM_INPUT,
                       "cannot use %.200s: it is damaged: its content is not that of its checksum",
                       path);
    SmCode code = load_in_child(&load, error);
    return code ? code : load_here(&load, error);
}
