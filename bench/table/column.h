/* column.h - an array of records in HDF5 as one dataset a member, so that a reader has tables:
 * group/member is [records], or [records][n] of a member that is an array. */
#ifndef BENCH_COLUMN_H
#define BENCH_COLUMN_H

#include "../store/h5.h"

/* `size` is a record's bytes. Texts become fixed-length UTF-8, as long as the member. */
void bench_h5_columns(BenchH5 *h5, hid_t group, const BenchField *fields, int count,
                      const void *records, size_t size, long number);

/* Reads `number` records back: a dataset that is missing, of another type or another size is a
 * failure that names it. Members that `fields` leaves out stay. */
void bench_h5_read_columns(BenchH5 *h5, hid_t group, const BenchField *fields, int count,
                           void *records, size_t size, long number);

/* How many there are: the first axis of the first field's dataset, at most `most`. */
long bench_h5_records(BenchH5 *h5, hid_t group, const BenchField *fields, long most);

#endif
