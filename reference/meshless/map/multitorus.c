#include "multitorus.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../shell/quadtree.h"
#include "harmonic.h"
#include "holomorphic.h"
#include "zeros.h"

enum { TRIED = 80, MOST_TRIANGLES = 100000, MOST_PARTS = 16 };
/* Cells for each zero that are as bad as 1 of a form's score; and roots of each cylinder that are
 * too many. */
static const double MANY_CELLS = 20, MOST_ROOTS = 100;
/* Of edges: a form has as many zeros as it should where none is below 0. */
static const double LEAST_WEIGHT = 1e-4;

/* A form and what has become of the surface with it. */
typedef struct {
    RefTriangulation surface;
    double *step[2];
    int zeros, *zero;
    RefLeaves leaves;
} Attempt;

static void attempt_free(Attempt *attempt)
{
    ref_triangulation_free(&attempt->surface);
    ref_leaves_free(&attempt->leaves);
    sm_free_all(attempt->step[0], attempt->step[1], attempt->zero);
}

/* Scales the plane to the surface's area. */
static void scale(const Attempt *attempt)
{
    long corners = 3 * attempt->surface.triangles;
    double area = ref_triangulation_area(&attempt->surface);
    double flat = ref_harmonic_wedge(&attempt->surface, attempt->step[0], attempt->step[1]);
    double factor = sqrt(area / flat);
    for (int d = 0; d < 2; d++)
        for (long c = 0; c < corners; c++) attempt->step[d][c] *= factor;
}

/* Brings zeros that are nearly on one leaf onto one, so that no cylinder is flat, if that can be.
 */
static void make_level(Attempt *attempt)
{
    RefTriangulation *surface = &attempt->surface;
    const int *zero = attempt->zero;
    RefLeaves leaves;
    double *step[2], *const *from = attempt->step;
    for (int d = 0; d < 2; d++) step[d] = sm_alloc(3 * (size_t)surface->triangles, sizeof *step[d]);
    bool level = ref_zeros_lift(surface, from, attempt->zeros, zero, attempt->leaves.lift, step) &&
                 ref_leaves_trace(surface, step, attempt->zeros, zero, &leaves);
    for (int d = 0; d < 2; d++) {
        free(level ? attempt->step[d] : step[d]);
        if (level) attempt->step[d] = step[d];
    }
    if (!level) return;
    ref_leaves_free(&attempt->leaves);
    attempt->leaves = leaves;
}

/* What is tried, one after the other, until there is a map. */
typedef enum { NARROW_ZEROS, ANY_ZEROS, LEVEL_ZEROS, WAYS } Way;
typedef struct {
    int count;
    double *number, score[TRIED];
    bool hopeless[TRIED]; /* no later way will do */
} Forms;

/* False, and nothing to free, where it fails. */
static bool try(const RefTriangulation *surface, const RefHolomorphic *basis, Forms *forms, int n,
                Way way, Attempt *attempt)
{
    bool narrowed;
    *attempt =
        (Attempt){.surface = ref_triangulation_copy(surface),
                  .zero = sm_alloc(2 * (size_t)ref_zeros_count(surface), sizeof *attempt->zero)};
    for (int d = 0; d < 2; d++)
        attempt->step[d] = sm_alloc(3 * (size_t)surface->triangles, sizeof *attempt->step[d]);
    ref_holomorphic_form(surface, basis, forms->number + n * basis->count, attempt->step);
    attempt->zeros = ref_zeros_place(&attempt->surface, attempt->step, attempt->zero, &narrowed);
    bool placed = attempt->zeros > 0, made = placed && (narrowed || way != NARROW_ZEROS);
    if (made) {
        scale(attempt);
        made = ref_leaves_trace(&attempt->surface, attempt->step, attempt->zeros, attempt->zero,
                                &attempt->leaves);
    }
    bool flat = made && attempt->leaves.lift;
    forms->hopeless[n] = way == NARROW_ZEROS ? !placed : !flat;
    if (flat && way == LEVEL_ZEROS) make_level(attempt);
    if (!made) attempt_free(attempt);
    return made;
}

static double one(const void *data, const double low[2], const double high[2])
{
    (void)data, (void)low, (void)high;
    return 1;
}

/* The cells of the coarsest balanced quadtree: a low cylinder needs many, and small ones beside it.
 * Infinite where there are too many. */
static double cells_of(const RefCylinders *cylinders)
{
    RefChart chart = {.mean = one, .cylinders = cylinders};
    RefQuadtree tree;
    double roots = 0;
    for (int c = 0; c < cylinders->count; c++) {
        const RefCylinder *in = cylinders->cylinder + c;
        double shape = (in->high[1] - in->low[1]) / (in->high[0] - in->low[0]);
        roots += fmax(shape, 1 / shape);
    }
    if (roots > MOST_ROOTS * cylinders->count ||
        ref_quadtree_build(&chart, 1, INFINITY, &tree, NULL) != SM_OK)
        return INFINITY;
    double cells = (double)tree.leaves;
    ref_quadtree_free(&tree);
    return cells;
}

/* The best of the forms; false where none will do. */
static bool try_all(const RefTriangulation *surface, const RefHolomorphic *basis, Forms *forms,
                    Way way, Attempt *best)
{
    double least = INFINITY;
    for (int n = 0; n < forms->count; n++) {
        Attempt attempt;
        if (forms->hopeless[n] || !(forms->score[n] < least)) continue; /* with any cylinders */
        if (!try(surface, basis, forms, n, way, &attempt)) continue;
        double cells = cells_of(&attempt.leaves.cylinders) / ref_zeros_count(surface);
        double found = forms->score[n] + cells / MANY_CELLS;
        if (!(found < least) || !ref_leaves_place(&attempt.surface, attempt.step, attempt.zeros,
                                                  attempt.zero, &attempt.leaves)) {
            attempt_free(&attempt);
            continue;
        }
        if (isfinite(least)) attempt_free(best);
        least = found;
        *best = attempt;
    }
    return isfinite(least);
}

/* What forms of the surface are and the best of them; false where none will do. */
static SmCode unfold(const RefTriangulation *surface, const char *name, Attempt *best, bool *found,
                     SmError *error)
{
    RefHolomorphic basis;
    Forms forms = {.count = 0};
    double *weight = ref_harmonic_weights(surface, LEAST_WEIGHT);
    SmCode code = ref_holomorphic_create(surface, weight, name, &basis, error);
    free(weight);
    if (code != SM_OK) return code;
    forms.number = sm_alloc((size_t)(TRIED * basis.count), sizeof *forms.number);
    forms.count = ref_holomorphic_choose(surface, &basis, TRIED, forms.number, forms.score);
    *found = false;
    for (int way = 0; way < WAYS && !*found; way++)
        *found = try_all(surface, &basis, &forms, way, best);
    free(forms.number);
    ref_holomorphic_free(&basis);
    return SM_OK;
}

SmCode ref_multitorus_unfold(RefTriangulation *surface, const char *name, double *step[2],
                             RefLeaves *leaves, SmError *error)
{
    Attempt best = {.zeros = 0};
    bool found;
    if (surface->genus + surface->rims > MOST_PARTS)
        return sm_fail(error, SM_INPUT,
                       "%s: a surface of genus %d with %d rims: a map takes %d handles and rims at "
                       "most; cut or close some",
                       name, surface->genus, surface->rims, MOST_PARTS);
    SmCode code = unfold(surface, name, &best, &found, error);
    RefTriangulation fine = {.triangles = 0};
    long most = MOST_TRIANGLES / (surface->genus + surface->rims);
    for (long four = 4; code == SM_OK && !found && four * surface->triangles <= most; four *= 4) {
        RefTriangulation next = ref_triangulation_quarter(fine.triangles ? &fine : surface);
        ref_triangulation_free(&fine);
        fine = next;
        ref_triangulation_delaunay(&fine);
        ref_triangulation_split(&fine);
        code = unfold(&fine, name, &best, &found, error);
    }
    ref_triangulation_free(&fine);
    if (code != SM_OK) return code;
    if (!found)
        return sm_fail(error, SM_INPUT,
                       "%s: a surface of genus %d with %d rims, all of whose maps turn triangles "
                       "over or have cylinders that are too thin: give it more triangles, close "
                       "some holes, or cut handles",
                       name, surface->genus, surface->rims);
    free(best.zero);
    ref_triangulation_free(surface);
    *surface = best.surface;
    *leaves = best.leaves;
    for (int d = 0; d < 2; d++) step[d] = best.step[d];
    return SM_OK;
}
