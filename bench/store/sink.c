#include "sink.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../../lib/error.h"
#include "checksum.h"

/* What a file access list carries for this driver; HDF5 copies it byte for byte. */
typedef struct {
    int *number;
} SinkInfo;

typedef struct {
    H5FD_t common; /* HDF5's own part comes first */
    int file;
    int *number;
    haddr_t allocated, end; /* bytes that HDF5 has reserved; bytes in the file */
} Sink;

static H5FD_t *sink_open(const char *name, unsigned flags, hid_t access, haddr_t most)
{
    (void)most;
    const SinkInfo *info = H5Pget_driver_info(access);
    int mode = O_RDWR | O_CLOEXEC | (flags & H5F_ACC_TRUNC ? O_TRUNC : 0);
    if (!info) return NULL;
    int file = open(name, mode);
    if (file < 0) {
        *info->number = errno;
        return NULL;
    }
    Sink *sink = sm_alloc(1, sizeof *sink);
    sink->file = file;
    sink->number = info->number;
    return &sink->common;
}

static void note_failure(Sink *sink, int number)
{
    if (*sink->number == 0) *sink->number = number ? number : EIO;
}

static herr_t sink_close(H5FD_t *common)
{
    Sink *sink = (Sink *)common;
    int number = *sink->number ? 0 : bench_checksum_append(sink->file);
    if (number) note_failure(sink, number);
    if (close(sink->file) != 0) note_failure(sink, errno);
    free(sink);
    return 0;
}

static herr_t sink_query(const H5FD_t *common, unsigned long *flags)
{
    (void)common;
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
    return 0;
}

static haddr_t sink_get_eoa(const H5FD_t *common, H5FD_mem_t type)
{
    (void)type;
    return ((const Sink *)common)->allocated;
}

static herr_t sink_set_eoa(H5FD_t *common, H5FD_mem_t type, haddr_t address)
{
    (void)type;
    ((Sink *)common)->allocated = address;
    return 0;
}

static haddr_t sink_get_eof(const H5FD_t *common, H5FD_mem_t type)
{
    (void)type;
    return ((const Sink *)common)->end;
}

/* What was never written reads as zeros, as in any file with holes. */
static herr_t sink_read(H5FD_t *common, H5FD_mem_t type, hid_t transfer, haddr_t address,
                        size_t size, void *buffer)
{
    (void)type;
    (void)transfer;
    char *to = buffer;
    while (size > 0) {
        ssize_t got = pread(((Sink *)common)->file, to, size, (off_t)address);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        to += got;
        address += (haddr_t)got;
        size -= (size_t)got;
    }
    memset(to, 0, size);
    return 0;
}

static herr_t sink_write(H5FD_t *common, H5FD_mem_t type, hid_t transfer, haddr_t address,
                         size_t size, const void *buffer)
{
    (void)type;
    (void)transfer;
    Sink *sink = (Sink *)common;
    const char *from = buffer;
    if (address + size > sink->end) sink->end = address + size;
    while (size > 0 && *sink->number == 0) {
        ssize_t put = pwrite(sink->file, from, size, (off_t)address);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) {
            note_failure(sink, errno);
            break;
        }
        from += put;
        address += (haddr_t)put;
        size -= (size_t)put;
    }
    return 0;
}

static herr_t sink_truncate(H5FD_t *common, hid_t transfer, hbool_t closing)
{
    (void)transfer;
    (void)closing;
    Sink *sink = (Sink *)common;
    if (sink->end == sink->allocated) return 0;
    sink->end = sink->allocated;
    if (*sink->number == 0 && ftruncate(sink->file, (off_t)sink->allocated) != 0)
        note_failure(sink, errno);
    return 0;
}

static const H5FD_class_t sink_class = {
    .name = "shapebench sink",
    .maxaddr = (haddr_t)INT64_MAX,
    .fc_degree = H5F_CLOSE_STRONG,
    .fapl_size = sizeof(SinkInfo),
    .open = sink_open,
    .close = sink_close,
    .query = sink_query,
    .get_eoa = sink_get_eoa,
    .set_eoa = sink_set_eoa,
    .get_eof = sink_get_eof,
    .read = sink_read,
    .write = sink_write,
    .truncate = sink_truncate,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};

void bench_sink_use(hid_t access, int *number)
{
    /* As HDF5's own drivers, it stays for good: H5FD_close() lets the driver go before it calls the
     * driver's close, which is freed memory by then if the file held it last. */
    static hid_t driver = H5I_INVALID_HID;
    const SinkInfo info = {number};
    if (H5Iget_type(driver) != H5I_VFL) driver = H5FDregister(&sink_class);
    H5Pset_driver(access, driver, &info);
}
