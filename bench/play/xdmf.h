/* xdmf.h - the text file that tells older readers how to read a trajectory's HDF5. */
#ifndef BENCH_XDMF_H
#define BENCH_XDMF_H

#include "../store/draft.h"
#include "fields.h"

typedef struct {
    double time; /* s */
    long points, cells;
    int corners;   /* of a cell: 3, or 1 of points alone */
    long topology; /* number of the surface that it shows */
} BenchXdmfFrame;

typedef struct {
    const char *data;  /* path of the HDF5 file; named without its folder, beside which it lies */
    const char *scene; /* any bytes; what XML cannot hold becomes '?' */
    long frames;
    int point_bytes;             /* 4 or 8 for a coordinate */
    BenchFields fields;          /* of every point, in 4 bytes a number */
    const BenchXdmfFrame *frame; /* [frames] */
} BenchXdmf;

/* Writes into a draft that has begun; the caller commits or discards it. SM_OUTPUT. */
SmCode bench_xdmf_write(const BenchXdmf *xdmf, const BenchDraft *draft, SmError *error);

#endif
