#include "checksum.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "../../lib/error.h"

/* Makes the user block of a file that is read from its second block on. 0 or errno. */
static int make_block(FILE *file, char block[BENCH_CHECKSUM_BLOCK])
{
    enum { PART = 1 << 18 };
    unsigned char *part = sm_alloc(PART, 1);
    uLong crc = crc32(0, NULL, 0);
    long long size = 0;
    if (fseek(file, BENCH_CHECKSUM_BLOCK, SEEK_SET) == 0)
        for (size_t got; (got = fread(part, 1, PART, file)) > 0; size += (long long)got)
            crc = crc32(crc, part, (uInt)got);
    free(part);
    memset(block, 0, BENCH_CHECKSUM_BLOCK);
    snprintf(block, BENCH_CHECKSUM_BLOCK,
             "shapebench: CRC-32 %08lx of %lld bytes of HDF5 after this block\n",
             crc & 0xffffffffUL, size);
    return ferror(file) ? errno : 0;
}

int bench_checksum_write(const char *path)
{
    char block[BENCH_CHECKSUM_BLOCK];
    FILE *file = fopen(path, "r+be");
    if (!file) return errno;
    int number = make_block(file, block);
    rewind(file);
    if (!number && fwrite(block, sizeof block, 1, file) != 1) number = errno;
    if (fclose(file) != 0 && !number) number = errno;
    return number;
}

int bench_checksum_check(FILE *file, BenchChecksum *found)
{
    static const char signature[] = "\x89HDF\r\n\x1a\n";
    enum { VERSION = sizeof signature - 1, WITH_CHECKSUMS = 2 }; /* of HDF5's superblock */
    char stored[BENCH_CHECKSUM_BLOCK] = "", right[BENCH_CHECKSUM_BLOCK];
    size_t got = fread(stored, 1, sizeof stored, file);
    if (got > VERSION && !memcmp(stored, signature, VERSION) && stored[VERSION] < WITH_CHECKSUMS) {
        *found = BENCH_CHECKSUM_OLD;
        return 0;
    }
    int number = ferror(file) ? errno : make_block(file, right);
    *found = memcmp(stored, right, sizeof stored) ? BENCH_CHECKSUM_DIFFERS : BENCH_CHECKSUM_HOLDS;
    return number;
}
