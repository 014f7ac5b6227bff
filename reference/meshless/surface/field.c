#include "field.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "../../../lib/vector.h"

static double brick_at(const void *body, const double x[3], double gradient[3])
{
    const RefBrick *brick = body;
    double beyond[3], outside[3], square = 0, inside = -INFINITY;
    int face = 0;
    for (int d = 0; d < 3; d++) {
        double half = (brick->high[d] - brick->low[d]) / 2;
        double from = x[d] - (brick->low[d] + half);
        beyond[d] = fabs(from) - half;
        outside[d] = beyond[d] > 0 ? copysign(beyond[d], from) : 0;
        square += outside[d] * outside[d];
        if (beyond[d] > inside) {
            inside = beyond[d];
            face = d;
        }
    }
    double distance = square > 0 ? sqrt(square) : inside;
    for (int d = 0; gradient && d < 3; d++)
        gradient[d] = square > 0  ? outside[d] / distance
                      : d == face ? copysign(1, x[d] - (brick->low[d] + brick->high[d]) / 2)
                                  : 0;
    return distance;
}

RefField ref_field_brick(const RefBrick *brick)
{
    RefField field = {.at = brick_at, .body = brick};
    memcpy(field.low, brick->low, sizeof field.low);
    memcpy(field.high, brick->high, sizeof field.high);
    return field;
}

bool ref_field_project(const RefField *field, double most, double near, double x[3])
{
    double to[3] = {x[0], x[1], x[2]};
    for (int step = 0; step < 20; step++) {
        double gradient[3], away = 0, value = ref_field_at(field, to, gradient);
        double square = sm_dot(gradient, gradient);
        if (fabs(value) <= near) {
            memcpy(x, to, sizeof to);
            return true;
        }
        if (!(square > 1e-6)) return false;
        for (int d = 0; d < 3; d++) {
            to[d] -= value * gradient[d] / square;
            away += (to[d] - x[d]) * (to[d] - x[d]);
        }
        if (!(away <= most * most)) return false;
    }
    return false;
}
