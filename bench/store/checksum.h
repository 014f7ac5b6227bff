/* checksum.h - the user block of a stored file: the CRC-32 of all bytes after it.
 *
 * HDF5 begins after the user block and leaves it as it is, so a file that another program has
 * written to no longer fits its checksum. What HDF5 stores has checksums of its own (h5.h); this
 * one covers the whole file and is compared before HDF5 opens it. */
#ifndef BENCH_CHECKSUM_H
#define BENCH_CHECKSUM_H

#include <stdio.h>

enum { BENCH_CHECKSUM_BLOCK = 512 }; /* bytes, HDF5's smallest user block */

typedef enum {
    BENCH_CHECKSUM_HOLDS,
    BENCH_CHECKSUM_DIFFERS, /* damaged, or written to by another program, or not shapebench's */
    BENCH_CHECKSUM_OLD, /* HDF5 before its metadata had checksums: shapebench until November 2026 */
} BenchChecksum;

/* Fills the user block of a file that HDF5 has closed. 0 or errno. Reads all of it: about a second
 * a GB. */
int bench_checksum_write(const char *path);

/* Compares an open file with its user block. 0 or errno. */
int bench_checksum_check(FILE *file, BenchChecksum *found);

#endif
