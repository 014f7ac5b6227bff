#include "slice.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../../reference/meshless/surface/mpu.h"
#include "../store/h5.h"
#include "body.h"

enum { LONGEST = 400, SCHEMA = 1 }; /* samples along the picture's longer side */
static const double margin = 0.1;   /* of the longer side, around the body */

bool bench_slice_parse(const char *text, BenchSlice *slice)
{
    char *end;
    if (text[0] < 'x' || text[0] > 'z' || text[1] != '=') return false;
    slice->axis = text[0] - 'x';
    slice->share = strtod(text + 2, &end);
    return end > text + 2 && !*end && slice->share >= 0 && slice->share <= 1;
}

/* Where the picture lies, and its samples. */
typedef struct {
    int axis, across, along; /* across: columns; along: rows */
    double at, low[2], high[2];
    hsize_t size[2]; /* rows, columns */
    float *distance;
} Picture;

static Picture lay_out(const RefField *field, const BenchSlice *slice)
{
    Picture p = {.axis = slice->axis,
                 .across = slice->axis == 0 ? 2 : 0,
                 .along = slice->axis == 1 ? 2 : 1,
                 .at = field->low[slice->axis] +
                       slice->share * (field->high[slice->axis] - field->low[slice->axis])};
    const int axes[2] = {p.across, p.along};
    double extent[2];
    for (int e = 0; e < 2; e++) extent[e] = field->high[axes[e]] - field->low[axes[e]];
    double longest = fmax(extent[0], extent[1]);
    for (int e = 0; e < 2; e++) {
        p.low[e] = field->low[axes[e]] - margin * longest;
        p.high[e] = field->high[axes[e]] + margin * longest;
        double share = (p.high[e] - p.low[e]) / (longest * (1 + 2 * margin));
        p.size[1 - e] = (hsize_t)fmax(2, rint(LONGEST * share));
    }
    return p;
}

static void sample(const RefField *field, Picture *picture)
{
    hsize_t rows = picture->size[0], columns = picture->size[1];
    picture->distance = sm_alloc((size_t)(rows * columns), sizeof *picture->distance);
    for (hsize_t r = 0; r < rows; r++)
        for (hsize_t c = 0; c < columns; c++) {
            double x[3],
                share[2] = {((double)c + 0.5) / (double)columns, ((double)r + 0.5) / (double)rows};
            x[picture->axis] = picture->at;
            x[picture->across] = picture->low[0] + share[0] * (picture->high[0] - picture->low[0]);
            x[picture->along] = picture->low[1] + share[1] * (picture->high[1] - picture->low[1]);
            picture->distance[r * columns + c] = (float)ref_field_at(field, x, NULL);
        }
}

/* What a file is to hold. */
typedef struct {
    const char *source;
    const RefMpu *mpu;
    const Picture *picture;
} File;

static void write_file(BenchH5 *h5, void *record)
{
    const File *file = record;
    const Picture *picture = file->picture;
    int schema = SCHEMA;
    unsigned char flipped = file->mpu->flipped;
    bench_h5_text(h5, h5->file, "kind", "shapebench slice");
    bench_h5_numbers(h5, h5->file, "schema", H5T_STD_I32LE, 0, &schema);
    bench_h5_text(h5, h5->file, "source", file->source);
    bench_h5_numbers(h5, h5->file, "axis", H5T_STD_I32LE, 0, &picture->axis);
    bench_h5_numbers(h5, h5->file, "at", H5T_IEEE_F64LE, 0, &picture->at);
    bench_h5_numbers(h5, h5->file, "low", H5T_IEEE_F64LE, 2, picture->low);
    bench_h5_numbers(h5, h5->file, "high", H5T_IEEE_F64LE, 2, picture->high);
    bench_h5_numbers(h5, h5->file, "points", H5T_STD_I64LE, 0, &file->mpu->points.count);
    bench_h5_numbers(h5, h5->file, "flipped", H5T_STD_U8LE, 0, &flipped);
    bench_h5_dataset(h5, h5->file, "distance", H5T_IEEE_F32LE, 2, picture->size, picture->distance);
}

/* The surface function of a file's points, or of points on its mesh. */
static SmCode load(const char *source, RefMpu *mpu, SmError *error)
{
    RefPoints points;
    SmMesh mesh;
    SmError why;
    SmCode code = bench_points_or_mesh(source, &points, &mesh, error);
    if (code) return code;
    if (!points.count) code = ref_points_of_mesh(&mesh, REF_MESHLESS_POINTS, &points, &why);
    sm_mesh_free(&mesh);
    if (!code) code = ref_mpu_build(&points, NULL, mpu, &why);
    return code ? sm_fail(error, code, "%s: %s", source, why.text) : SM_OK;
}

SmCode bench_slice_write(const char *source, const BenchSlice *slice, const char *path,
                         SmError *error)
{
    RefMpu mpu;
    SmCode code = load(source, &mpu, error);
    if (code) return code;
    RefField field = ref_mpu_field(&mpu);
    Picture picture = lay_out(&field, slice);
    sample(&field, &picture);
    code = bench_h5_store(path, write_file, &(File){source, &mpu, &picture}, error);
    free(picture.distance);
    ref_mpu_free(&mpu);
    return code;
}
