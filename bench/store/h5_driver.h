/* h5_driver.h - an HDF5 file driver for writing that survives a full disk.
 *
 * HDF5 1.10 keeps a file half open when a write fails during close, and crashes when the program
 * ends. This driver notes the first failure and tells HDF5 that all went well; the file, by then
 * worthless, is closed in good order and its writer throws it away. What is closed without failure
 * ends in its checksum (checksum.h). */
#ifndef BENCH_H5_DRIVER_H
#define BENCH_H5_DRIVER_H

#include <hdf5.h>

/* Sets the driver in a file access list. `number` stays 0 or receives the errno of the first write
 * that failed; it must live until the file is closed. */
void bench_h5_driver_use(hid_t access, int *number);

#endif
