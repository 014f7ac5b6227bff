/* checksum.h - the last line of a stored file: the CRC-32 of all bytes before it.
 *
 * HDF5 reads no further than its own end, so other programs do not see the line; one that writes to
 * the file cuts it off. It shows damage (a wrong disk, a cut-off copy), not intent. */
#ifndef BENCH_CHECKSUM_H
#define BENCH_CHECKSUM_H

#include <stddef.h>

enum { BENCH_CHECKSUM_LINE = 64 }; /* bytes */

typedef enum {
    BENCH_CHECKSUM_ABSENT, /* the file does not end in such a line */
    BENCH_CHECKSUM_RIGHT,
    BENCH_CHECKSUM_WRONG,
} BenchChecksum;

/* pread() and pwrite() of all bytes, also past signals. 0 or errno; EIO at the file's end: what is
 * beyond it stays as it is. */
int bench_read_all(int file, void *bytes, size_t size, long long from);
int bench_write_all(int file, const void *bytes, size_t size, long long to);

/* Appends the line to a file open for reading and writing. 0 or errno. Reads all of it: about a
 * second a GB. */
int bench_checksum_append(int file);

/* Compares a file with its line. 0 or errno. */
int bench_checksum_check(const char *path, BenchChecksum *found);

#endif
