/* test_beam.h - bricks as meshless bodies, for the tests. */
#ifndef REF_TEST_BEAM_H
#define REF_TEST_BEAM_H

#include "body/body.h"
#include "test_solver.h"

static const RefMaterial steel = {.young = 1e7, .poisson = 0.3, .density = 1000};

/* Gauss points on the six faces of a brick whose lowest corner is the origin. */
typedef struct {
    long count;
    double (*x)[3], (*normal)[3], *area;
} FacePoints;

/* Two by two in every square of about `edge`. */
static inline FacePoints face_points(const double size[3], double edge)
{
    FacePoints face = {0};
    for (int side = 0; side < 6; side++) {
        int up = side / 2, a = (up + 1) % 3, b = (up + 2) % 3;
        int across = 2 * (int)ceil(size[a] / edge), along = 2 * (int)ceil(size[b] / edge);
        size_t all = (size_t)face.count + (size_t)(across * along);
        face.x = sm_realloc(face.x, all, sizeof *face.x);
        face.normal = sm_realloc(face.normal, all, sizeof *face.normal);
        face.area = sm_realloc(face.area, all, sizeof *face.area);
        for (int n = 0; n < across * along; n++, face.count++) {
            int i = n % across, j = n / across;
            double shift = 0.5 - sqrt(1.0 / 12) * 2;
            double *x = face.x[face.count], *normal = face.normal[face.count];
            x[up] = side % 2 ? size[up] : 0;
            x[a] = size[a] * (i + 0.5 + (i % 2 ? -shift : shift)) / across;
            x[b] = size[b] * (j + 0.5 + (j % 2 ? -shift : shift)) / along;
            normal[a] = normal[b] = 0;
            normal[up] = side % 2 ? 1 : -1;
            face.area[face.count] = size[a] * size[b] / (across * along);
        }
    }
    return face;
}

static inline void face_points_free(FacePoints *face)
{
    free(face->x);
    free(face->normal);
    free(face->area);
}

/* A brick with its lowest corner in the origin that covers the points, too. */
static inline RefBody brick_body_showing(const double size[3], const RefBodyOptions *options,
                                         long count, const double (*shown)[3])
{
    RefBrick brick = {{0, 0, 0}, {size[0], size[1], size[2]}};
    RefField field = ref_field_brick(&brick);
    RefBody body;
    SmError error = {0};
    if (ref_body_build(&field, options, count, shown, &body, &error) != SM_OK)
        fail_msg("%s", error.text);
    return body;
}

static inline RefBody brick_body(const double size[3], const RefBodyOptions *options)
{
    return brick_body_showing(size, options, 0, NULL);
}

#endif
