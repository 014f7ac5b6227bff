#include "tension.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/engine/boundary.h"
#include "../../../lib/vector.h"
#include "thin.h"

enum { PLACES = REF_WARP_PLACES, SLACK = 10 };
/* Of how much more than there is steps bear too much: what G takes from motion is felt then. */
static const double TOO_MUCH = 8;

#define CONST(array) ((const double(*)[3])(array))

/* How large the tug at a place is, N/m. */
static double tug_at(const RefWarpPlace *place, const double f[2][3])
{
    const double(*a)[3] = place->tangent;
    double square = 0;
    for (int k = 0; k < 2; k++)
        for (int l = 0; l < 2; l++) square += sm_dot(a[k], a[l]) * sm_dot(f[k], f[l]);
    return place->area > 0 ? sqrt(square) / place->area : 0;
}

/* The sum of the squares of a place's two stretches, and their product. */
static void stretches_at(const RefWarp *warp, long at, double *squares, double *product)
{
    const double *q = warp->place[at].metric, (*s)[3] = warp->turn[at].tangent;
    double area = warp->place[at].area, S[3];
    for (int k = 0; k < 2; k++) S[k] = sm_dot(s[k], s[k]);
    S[2] = sm_dot(s[0], s[1]);
    *squares = *product = 0;
    if (!(area > 0)) return;
    *squares = (q[0] * S[0] + q[1] * S[1] + 2 * q[2] * S[2]) / area;
    *product = sqrt(fmax(0, (q[0] * q[1] - q[2] * q[2]) * (S[0] * S[1] - S[2] * S[2]))) / area;
}

/* How much waves at a place are pushed back by, N/m: the largest principal value of f^k .
 * tangent_l, as stretching and leaning share the rest, which the stiffness E t of that makes f^2 /
 * (E t). */
static double pull_on_waves(const RefWarp *warp, long at, double stiffness, double tug)
{
    const double(*f)[3] = CONST(warp->tug[at]), *R = warp->turn[at].R;
    double area = warp->place[at].area, m[2][2];
    if (!(area > 0)) return 0;
    for (int l = 0; l < 2; l++) {
        const double *s = warp->turn[at].tangent[l];
        double now[3];
        for (int d = 0; d < 3; d++) now[d] = sm_dot(R + 3 * d, s);
        for (int k = 0; k < 2; k++) m[k][l] = sm_dot(f[k], now) / area;
    }
    return fmax(ref_thin_principal((const double(*)[2])m), 0) + tug * tug / stiffness;
}

/* T' of all places, and what of it waves feel; returns how far the surface is stretched most, 1 for
 * not at all. */
static double find(const RefWarp *warp, double stiffness, bool pushed, double *tension,
                   double *felt)
{
    double most = 0;
    for (long at = 0; at < PLACES * warp->cells; at++) {
        double squares, product, tug = tug_at(warp->place + at, CONST(warp->tug[at]));
        stretches_at(warp, at, &squares, &product);
        tension[at] = tug * (sqrt(squares) + sqrt(squares + 4)) / 4;
        felt[at] =
            pushed ? tension[at] : fmin(tension[at], pull_on_waves(warp, at, stiffness, tug));
        double both = sqrt(squares + 2 * product), apart = sqrt(fmax(0, squares - 2 * product));
        most = fmax(most, (both + apart) / 2);
    }
    return most;
}

/* Whether what waves feel more than steps bear (NULL: none) can make waves grow: where these find
 * room, and are so long that places tell them from others. */
static bool matters(const RefTension *tension, const double *borne, const RefWarp *warp,
                    const RefShellOptions *shell, const RefSteps *steps)
{
    const RefMaterial *material = &shell->material;
    double t = shell->thickness, nu = material->poisson, h = steps->h;
    double mass = 4 * material->density * t;
    double bending = material->young * t * t * t / (12 * (1 - nu * nu)) *
                     (h * h + 2 * h * steps->damping.stiffness_damping);
    double room = 0; /* for waves, in squares of their lengths */
    for (long at = 0; at < PLACES * warp->cells; at++) {
        double area = warp->place[at].area, beyond = tension->felt[at] - (borne ? borne[at] : 0);
        /* k^2 of the wave that bears least, or of the shortest that there is */
        double square = fmin(sqrt(mass / bending), M_PI * M_PI / (4 * area));
        if (h * h * beyond * square > mass + bending * square * square)
            room += area * square / (4 * M_PI * M_PI);
    }
    return room > 1;
}

static bool bears_too_much(const RefTension *tension, const RefWarp *warp)
{
    double now = 0, borne = 0;
    for (long at = 0; at < PLACES * warp->cells; at++) {
        now += warp->place[at].area * tension->now[at];
        borne += warp->place[at].area * tension->borne[at];
    }
    return borne > TOO_MUCH * now;
}

void ref_tension_free(RefTension *tension)
{
    sm_free_all(tension->now, tension->felt, tension->borne);
    *tension = (RefTension){.now = NULL};
}

void ref_tension_find(RefTension *tension, const RefWarp *warp, const RefShellOptions *shell,
                      const RefSteps *steps, bool pushed)
{
    size_t places = PLACES * (size_t)warp->cells;
    double stiffness = shell->material.young * shell->thickness;
    if (!tension->now) tension->now = sm_alloc(places, sizeof *tension->now);
    if (!tension->felt) tension->felt = sm_alloc(places, sizeof *tension->felt);
    tension->stretch =
        fmax(tension->stretch, find(warp, stiffness, pushed, tension->now, tension->felt));
    tension->matters = matters(tension, NULL, warp, shell, steps);
    tension->lacks = tension->matters && matters(tension, tension->borne, warp, shell, steps);
    tension->idle = tension->borne && (!tension->matters || bears_too_much(tension, warp));
}

/* Twice what there is; and where that comes and goes from place to place, half of what was borne.
 */
static double *raised(const RefTension *tension, const RefWarp *warp)
{
    size_t places = PLACES * (size_t)warp->cells;
    double *borne = sm_alloc(places, sizeof *borne);
    bool kept = tension->borne && tension->slack <= SLACK;
    for (size_t at = 0; at < places; at++)
        borne[at] = fmax(2 * tension->now[at], kept ? tension->borne[at] / 2 : 0);
    return borne;
}

/* Has steps bear so much, which is taken over; where no factor can be had, as much as before. */
static void make(RefTension *tension, const RefWarp *warp, double *borne, RefSteps *steps)
{
    RefSparse G;
    ref_warp_laplacian(warp, &steps->matrices->mass, borne, &G);
    bool made = ref_steps_bear(steps, &G, NULL) == SM_OK;
    free(made ? tension->borne : borne);
    if (made) tension->borne = borne;
    tension->lacks = tension->idle = false;
    tension->slack = 0;
}

bool ref_tension_bear(RefTension *tension, const RefWarp *warp, RefSteps *steps)
{
    tension->slack = tension->idle ? tension->slack + 1 : 0;
    if (tension->slack > SLACK && !tension->matters) {
        ref_tension_drop(tension, steps);
        return true;
    }
    if (tension->slack <= SLACK && !tension->lacks) return false;
    make(tension, warp, raised(tension, warp), steps);
    return true;
}

void ref_tension_set(RefTension *tension, const double *borne, const RefWarp *warp, RefSteps *steps)
{
    size_t places = PLACES * (size_t)warp->cells, none = 0;
    while (none < places && borne[none] == 0) none++;
    tension->matters = tension->lacks = tension->idle = false;
    tension->slack = 0;
    if (none == places)
        ref_tension_drop(tension, steps);
    else if (!tension->borne || memcmp(borne, tension->borne, places * sizeof *borne) != 0)
        make(tension, warp, sm_copy(borne, places, sizeof *borne), steps);
}

void ref_tension_drop(RefTension *tension, RefSteps *steps)
{
    double stretch = tension->stretch;
    ref_steps_slacken(steps);
    ref_tension_free(tension);
    tension->stretch = stretch;
}
