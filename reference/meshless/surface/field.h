/* field.h - a body as a function of space, which is all that the meshless method asks of it.
 *
 * The function is negative inside and, near the surface, close to the signed distance: that of the
 * points' implicit surface (mpu.h), or of a brick, whose theory is known. */
#ifndef REF_FIELD_H
#define REF_FIELD_H

#include <stdbool.h>

typedef struct {
    /* Value at x; writes its gradient unless that is NULL. Any x, also far away. */
    double (*at)(const void *body, const double x[3], double gradient[3]);
    const void *body;       /* the caller's, kept */
    double low[3], high[3]; /* a box that holds the body */
} RefField;

typedef struct {
    double low[3], high[3];
} RefBrick;

/* The signed distance from a brick, which is the caller's and stays. */
RefField ref_field_brick(const RefBrick *brick);

static inline double ref_field_at(const RefField *field, const double x[3], double gradient[3])
{
    return field->at(field->body, x, gradient);
}

/* Moves x onto the surface along the gradient (Newton); at most `most` far. Returns whether it got
 * there to within `near`; x is unchanged where it did not. */
bool ref_field_project(const RefField *field, double most, double near, double x[3]);

#endif
