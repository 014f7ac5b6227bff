/* h5.h - HDF5 with one failure state instead of a check at every call.
 *
 * After a call has failed the later ones do nothing, so a writer or reader checks once at its end.
 * HDF5 prints nothing itself; its deepest message is kept. Files have the format of HDF5 1.10,
 * whose metadata carry checksums, every dataset has Fletcher32, and the user block a checksum of
 * the whole (checksum.h). */
#ifndef BENCH_H5_H
#define BENCH_H5_H

#include <hdf5.h>
#include <stdbool.h>
#include <stddef.h>

#include "../../lib/error.h"
#include "field.h"

typedef struct {
    hid_t file;
    bool failed;
    int number;          /* errno of what failed, else 0 */
    const char *created; /* path of a file that is written, else NULL */
    hsize_t size;        /* of a file that is loaded: its datasets hold no more; 0: not known */
    hsize_t found;       /* bytes of datasets so far */
    bool unchecked;      /* something was read that has no checksum */
    char message[256];   /* what failed */
} BenchH5;

/* Creates (replacing an empty draft) or opens a file. The path of a created one must stay. */
void bench_h5_create(BenchH5 *h5, const char *path);
void bench_h5_open(BenchH5 *h5, const char *path);

/* Closes the file and all that is open in it, and gives a created one its checksum; true when
 * everything since create went well. Twice does no harm. */
bool bench_h5_close(BenchH5 *h5);

/* Marks `h5` as failed with this message, unless it has failed before. */
void bench_h5_fail(BenchH5 *h5, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Writing. `type` is the type in the file; the memory has its native form. */
hid_t bench_h5_group(BenchH5 *h5, hid_t parent, const char *name);
void bench_h5_numbers(BenchH5 *h5, hid_t object, const char *name, hid_t type, int count,
                      const void *values); /* attribute; count 0: a scalar */
void bench_h5_text(BenchH5 *h5, hid_t object, const char *name, const char *text);
/* The members of a record as attributes: arrays of numbers become one-dimensional, texts
 * fixed-length UTF-8; what has no name is left out. */
void bench_h5_fields(BenchH5 *h5, hid_t object, const BenchField *fields, int count,
                     const void *record);
void bench_h5_dataset(BenchH5 *h5, hid_t parent, const char *name, hid_t type, int rank,
                      const hsize_t *size, const void *values);

/* A dataset that grows along its first axis, which starts at 0 (size[0] is ignored). */
hid_t bench_h5_growing(BenchH5 *h5, hid_t parent, const char *name, hid_t type, int rank,
                       const hsize_t *size);
/* Appends `rows` entries along the first axis. */
void bench_h5_append(BenchH5 *h5, hid_t dataset, hsize_t rows, const void *values);
/* One more name, in `parent`, of what the file has at `path`. */
void bench_h5_link(BenchH5 *h5, const char *path, hid_t parent, const char *name);
/* A dataset that is a part of another one in the file, of as many dimensions: a virtual one, no
 * copy. */
void bench_h5_view(BenchH5 *h5, hid_t parent, const char *name, hid_t source, const hsize_t *start,
                   const hsize_t *size);

/* An array of `number` records of `size` bytes as one dataset a member, so that a reader has
 * tables: group/member is [number], or [number][n] of a member that is an array. Texts become
 * fixed-length UTF-8, as long as the member. */
void bench_h5_columns(BenchH5 *h5, hid_t group, const BenchField *fields, int count,
                      const void *records, size_t size, long number);

/* Reading: wrong type, wrong size and absence are failures that name the thing, and so are datasets
 * that hold more than the file that is loaded. */
hid_t bench_h5_find_group(BenchH5 *h5, hid_t parent, const char *name);
hid_t bench_h5_find_dataset(BenchH5 *h5, hid_t parent, const char *name, int rank,
                            const hsize_t *size);
void bench_h5_read(BenchH5 *h5, hid_t dataset, hid_t type, void *values);
void bench_h5_read_fields(BenchH5 *h5, hid_t object, const BenchField *fields, int count,
                          void *record);
/* The same of those that are there: of the others the record stays as it is. */
void bench_h5_read_what_is_there(BenchH5 *h5, hid_t object, const BenchField *fields, int count,
                                 void *record);
/* Fails unless the file's attributes are this `kind` ("shapebench results") and a `schema` from
 * `oldest` to `newest`, this program's. */
void bench_h5_check_kind(BenchH5 *h5, const char *kind, int oldest, int newest);
/* A text attribute into room of `size` bytes. */
void bench_h5_read_text(BenchH5 *h5, hid_t object, const char *name, size_t size, char *text);

/* Reads `number` records back. Members that `fields` leaves out stay. */
void bench_h5_read_columns(BenchH5 *h5, hid_t group, const BenchField *fields, int count,
                           void *records, size_t size, long number);
/* How many there are: the first axis of the first field's dataset, at most `most`. */
long bench_h5_records(BenchH5 *h5, hid_t group, const BenchField *fields, long most);

/* Has `write` write the record: the file appears whole or not at all (draft.h). SM_OUTPUT. */
SmCode bench_h5_store(const char *path, void (*write)(BenchH5 *h5, void *record), void *record,
                      SmError *error);

/* Has `read` read the file into `record`. SM_INPUT, with the file and what is wrong: no such file,
 * a folder or pipe, not HDF5, cut off, damaged, of a version without checksums, or what `read`
 * failed at; the caller then frees what it has made so far. A file that another program has written
 * to is read, with a remark on standard error. */
SmCode bench_h5_load(const char *path, void (*read)(BenchH5 *h5, void *record), void *record,
                     SmError *error);

#endif
