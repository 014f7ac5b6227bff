#include "checksum.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "../../lib/error.h"

int bench_read_all(int file, void *bytes, size_t size, long long from)
{
    for (size_t done = 0; done < size;) {
        ssize_t got = pread(file, (char *)bytes + done, size - done, from + (off_t)done);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return got < 0 ? errno : EIO;
        done += (size_t)got;
    }
    return 0;
}

int bench_write_all(int file, const void *bytes, size_t size, long long to)
{
    for (size_t done = 0; done < size;) {
        ssize_t put = pwrite(file, (const char *)bytes + done, size - done, to + (off_t)done);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return put < 0 ? errno : EIO;
        done += (size_t)put;
    }
    return 0;
}

/* The line for the file's first `size` bytes; 0 or errno. */
static int make_line(int file, long long size, char line[BENCH_CHECKSUM_LINE + 1])
{
    enum { BLOCK = 1 << 18 };
    unsigned char *block = sm_alloc(BLOCK, 1);
    uLong crc = crc32(0, NULL, 0);
    int number = 0;
    for (long long at = 0; at < size && !number; at += BLOCK) {
        size_t part = size - at < BLOCK ? (size_t)(size - at) : BLOCK;
        number = bench_read_all(file, block, part, at);
        crc = crc32(crc, block, (uInt)part);
    }
    free(block);
    snprintf(line, BENCH_CHECKSUM_LINE + 1, "\nshapebench: CRC-32 %08lx of %018lld bytes before\n",
             crc & 0xffffffffUL, size);
    return number;
}

int bench_checksum_append(int file)
{
    char line[BENCH_CHECKSUM_LINE + 1];
    struct stat status;
    if (fstat(file, &status) != 0) return errno;
    int number = make_line(file, status.st_size, line);
    return number ? number : bench_write_all(file, line, BENCH_CHECKSUM_LINE, status.st_size);
}

static int check(int file, BenchChecksum *found)
{
    char line[BENCH_CHECKSUM_LINE + 1] = "", right[BENCH_CHECKSUM_LINE + 1];
    unsigned long crc;
    long long size;
    struct stat status;
    *found = BENCH_CHECKSUM_ABSENT;
    if (fstat(file, &status) != 0) return errno;
    long long before = status.st_size - BENCH_CHECKSUM_LINE;
    if (before < 0) return 0;
    int number = bench_read_all(file, line, BENCH_CHECKSUM_LINE, before);
    if (number ||
        sscanf(line, "\nshapebench: CRC-32 %8lx of %18lld bytes before", &crc, &size) != 2)
        return number;
    *found = BENCH_CHECKSUM_WRONG;
    number = make_line(file, before, right);
    if (!number && !memcmp(line, right, BENCH_CHECKSUM_LINE)) *found = BENCH_CHECKSUM_RIGHT;
    return number;
}

int bench_checksum_check(const char *path, BenchChecksum *found)
{
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return errno;
    int number = check(file, found);
    close(file);
    return number;
}
