#include "h5_driver.h"

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
} DriverInfo;

typedef struct {
    H5FD_t common; /* HDF5's own part comes first */
    int file;
    int *number;
    haddr_t allocated, end; /* bytes that HDF5 has reserved; bytes in the file */
} Output;

static H5FD_t *driver_open(const char *name, unsigned flags, hid_t access, haddr_t most)
{
    (void)most;
    const DriverInfo *info = H5Pget_driver_info(access);
    int mode = O_RDWR | O_CLOEXEC | (flags & H5F_ACC_TRUNC ? O_TRUNC : 0);
    if (!info) return NULL;
    int file = open(name, mode);
    if (file < 0) {
        *info->number = errno;
        return NULL;
    }
    Output *output = sm_alloc(1, sizeof *output);
    output->file = file;
    output->number = info->number;
    return &output->common;
}

static void note_failure(Output *output, int number)
{
    if (*output->number == 0) *output->number = number ? number : EIO;
}

static herr_t driver_close(H5FD_t *common)
{
    Output *output = (Output *)common;
    int number = *output->number ? 0 : bench_checksum_append(output->file);
    if (number) note_failure(output, number);
    if (close(output->file) != 0) note_failure(output, errno);
    free(output);
    return 0;
}

static herr_t driver_query(const H5FD_t *common, unsigned long *flags)
{
    (void)common;
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
    return 0;
}

static haddr_t driver_get_eoa(const H5FD_t *common, H5FD_mem_t type)
{
    (void)type;
    return ((const Output *)common)->allocated;
}

static herr_t driver_set_eoa(H5FD_t *common, H5FD_mem_t type, haddr_t address)
{
    (void)type;
    ((Output *)common)->allocated = address;
    return 0;
}

static haddr_t driver_get_eof(const H5FD_t *common, H5FD_mem_t type)
{
    (void)type;
    return ((const Output *)common)->end;
}

/* What was never written reads as zeros, as in any file with holes. */
static herr_t driver_read(H5FD_t *common, H5FD_mem_t type, hid_t transfer, haddr_t address,
                          size_t size, void *buffer)
{
    (void)type;
    (void)transfer;
    memset(buffer, 0, size);
    (void)bench_read_all(((Output *)common)->file, buffer, size, (long long)address);
    return 0;
}

static herr_t driver_write(H5FD_t *common, H5FD_mem_t type, hid_t transfer, haddr_t address,
                           size_t size, const void *buffer)
{
    (void)type;
    (void)transfer;
    Output *output = (Output *)common;
    if (address + size > output->end) output->end = address + size;
    if (*output->number == 0)
        *output->number = bench_write_all(output->file, buffer, size, (long long)address);
    return 0;
}

static herr_t driver_truncate(H5FD_t *common, hid_t transfer, hbool_t closing)
{
    (void)transfer;
    (void)closing;
    Output *output = (Output *)common;
    if (output->end == output->allocated) return 0;
    output->end = output->allocated;
    if (*output->number == 0 && ftruncate(output->file, (off_t)output->allocated) != 0)
        note_failure(output, errno);
    return 0;
}

static const H5FD_class_t driver_class = {
    .name = "shapebench driver",
    .maxaddr = (haddr_t)INT64_MAX,
    .fc_degree = H5F_CLOSE_STRONG,
    .fapl_size = sizeof(DriverInfo),
    .open = driver_open,
    .close = driver_close,
    .query = driver_query,
    .get_eoa = driver_get_eoa,
    .set_eoa = driver_set_eoa,
    .get_eof = driver_get_eof,
    .read = driver_read,
    .write = driver_write,
    .truncate = driver_truncate,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};

void bench_h5_driver_use(hid_t access, int *number)
{
    /* As HDF5's own drivers, it stays for good: H5FD_close() lets the driver go before it calls the
     * driver's close, which is freed memory by then if the file held it last. */
    static hid_t driver = H5I_INVALID_HID;
    const DriverInfo info = {number};
    if (H5Iget_type(driver) != H5I_VFL) driver = H5FDregister(&driver_class);
    H5Pset_driver(access, driver, &info);
}
