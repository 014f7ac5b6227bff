#include "holomorphic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../solve/dense.h"
#include "harmonic.h"

void ref_holomorphic_free(RefHolomorphic *basis)
{
    for (int k = 0; k < basis->count; k++) {
        if (basis->dual != basis->form) free(basis->dual[k]);
        free(basis->form[k]);
    }
    if (basis->dual != basis->form) free(basis->dual);
    sm_free_all(basis->form, basis->energy, basis->star);
    *basis = (RefHolomorphic){.count = 0};
}

/* Adds so many times another form. */
static void add(const RefTriangulation *surface, double times, const double *other, double *form)
{
    for (long c = 0; c < 3 * surface->triangles; c++) form[c] += times * other[c];
}

/* Takes whole multiples of others from each of the loops' forms, until none gets less energy by
 * that. */
static void shorten(const RefTriangulation *surface, const RefHolomorphic *basis)
{
    double *energy = basis->energy;
    int count = basis->count;
    bool changed = true;
    for (int round = 0; round < 100 && changed; round++) {
        changed = false;
        for (int i = 0; i < basis->loops; i++)
            for (int j = 0; j < basis->loops; j++) {
                double times = rint(energy[i * count + j] / energy[j * count + j]);
                if (i == j || times == 0 || !isfinite(times)) continue;
                add(surface, -times, basis->form[j], basis->form[i]);
                for (int k = 0; k < count; k++)
                    energy[i * count + k] -= times * energy[j * count + k];
                for (int k = 0; k < count; k++)
                    energy[k * count + i] -= times * energy[k * count + j];
                changed = true;
            }
    }
}

/* The star of each form: wedge star = energy, wedge and energy the products of the forms. */
static bool find_star(const RefTriangulation *surface, RefHolomorphic *basis)
{
    int count = basis->count;
    size_t size = (size_t)count * (size_t)count;
    double *wedge = sm_alloc(size, sizeof *wedge), *left = sm_alloc(size, sizeof *left);
    double *right = sm_alloc((size_t)count, sizeof *right);
    bool found = true;
    basis->star = sm_alloc(size, sizeof *basis->star);
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            wedge[i * count + j] = ref_harmonic_wedge(surface, basis->form[i], basis->dual[j]);
    for (int j = 0; j < count && found; j++) {
        memcpy(left, wedge, size * sizeof *left);
        for (int i = 0; i < count; i++) right[i] = basis->energy[i * count + j];
        found = ref_dense_any(count, left, right);
        for (int i = 0; i < count; i++) basis->star[i * count + j] = right[i];
    }
    sm_free_all(wedge, left, right);
    return found;
}

static int longest_rim(const RefTriangulation *surface)
{
    double *length = ref_triangulation_rims(surface);
    int longest = 0;
    for (int r = 1; r < surface->rims; r++)
        if (length[r] > length[longest]) longest = r;
    free(length);
    return longest;
}

/* Forms of loops and between rims, and those of their stars. */
static SmCode make_forms(const RefTriangulation *surface, const double *weight,
                         RefHolomorphic *basis, SmError *error)
{
    size_t corners = 3 * (size_t)surface->triangles;
    int longest = surface->rims ? longest_rim(surface) : 0;
    bool *held = NULL;
    ref_harmonic_loops(surface, basis->form);
    if (surface->rims) {
        basis->dual = sm_alloc((size_t)basis->count, sizeof *basis->dual);
        held = sm_alloc((size_t)surface->vertices, sizeof *held);
        for (long v = 0; v < surface->vertices; v++)
            held[v] = surface->rim[surface->corner[v]] >= 0;
    }
    for (int k = 0; k < basis->loops && surface->rims; k++) {
        basis->dual[k] = sm_alloc(corners, sizeof **basis->dual);
        memcpy(basis->dual[k], basis->form[k], corners * sizeof **basis->dual);
    }
    for (int k = basis->loops; k < basis->count; k++) {
        int rim = k - basis->loops + (k - basis->loops >= longest);
        basis->form[k] = sm_alloc(corners, sizeof **basis->form);
        basis->dual[k] = ref_harmonic_crossing(surface, longest, rim);
        for (int c = 0; c < (int)corners; c++) {
            int from = surface->corner[surface->vertex[c]];
            int to = surface->corner[surface->vertex[ref_corner_next(c)]];
            basis->form[k][c] = (surface->rim[to] == rim) - (surface->rim[from] == rim);
        }
    }
    SmCode code = ref_harmonic_solve(surface, weight, held, basis->count, basis->form, error);
    if (code == SM_OK && surface->rims)
        code = ref_harmonic_solve(surface, weight, NULL, basis->count, basis->dual, error);
    free(held);
    return code;
}

/* Takes from the loops' forms what lies between rims, so that nothing flows through a rim. */
static bool part_loops(const RefTriangulation *surface, const double *weight,
                       const RefHolomorphic *basis)
{
    int loops = basis->loops, rims = basis->count - loops;
    double *A = sm_alloc((size_t)(rims * rims), sizeof *A);
    double *b = sm_alloc((size_t)rims, sizeof *b);
    double *const *form = basis->form;
    bool parted = true;
    for (int k = 0; k < loops && parted; k++) {
        for (int i = 0; i < rims; i++) {
            b[i] = ref_harmonic_product(surface, weight, form[loops + i], form[k]);
            for (int j = 0; j < rims; j++)
                A[i * rims + j] =
                    ref_harmonic_product(surface, weight, form[loops + i], form[loops + j]);
        }
        parted = ref_dense_definite(rims, A, b);
        for (int i = 0; i < rims && parted; i++) add(surface, -b[i], form[loops + i], form[k]);
    }
    sm_free_all(A, b);
    return parted;
}

/* Makes loops' forms short, and finds all forms' stars; false where they depend on one another. */
static bool finish(const RefTriangulation *surface, const double *weight, RefHolomorphic *basis)
{
    int count = basis->count;
    if (count > basis->loops && !part_loops(surface, weight, basis)) return false;
    double *energy = basis->energy = sm_alloc((size_t)count * (size_t)count, sizeof *energy);
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            energy[i * count + j] =
                ref_harmonic_product(surface, weight, basis->form[i], basis->form[j]);
    shorten(surface, basis);
    return find_star(surface, basis);
}

SmCode ref_holomorphic_create(const RefTriangulation *surface, const double *weight,
                              const char *name, RefHolomorphic *basis, SmError *error)
{
    int loops = 2 * surface->genus, count = loops + (surface->rims ? surface->rims - 1 : 0);
    *basis = (RefHolomorphic){
        .count = count, .loops = loops, .form = sm_alloc((size_t)count, sizeof(double *))};
    basis->dual = basis->form;
    SmCode code = make_forms(surface, weight, basis, error);
    if (code == SM_OK && !finish(surface, weight, basis))
        code = sm_fail(error, SM_INPUT,
                       "%s: the forms of its handles or rims depend on one another: give it more "
                       "triangles",
                       name);
    if (code != SM_OK) ref_holomorphic_free(basis);
    return code;
}

void ref_holomorphic_form(const RefTriangulation *surface, const RefHolomorphic *basis,
                          const double *number, double *const step[2])
{
    long corners = 3 * surface->triangles;
    for (int d = 0; d < 2; d++) memset(step[d], 0, (size_t)corners * sizeof *step[d]);
    for (int k = 0; k < basis->count; k++) {
        double star = 0;
        for (int j = 0; j < basis->count; j++)
            star -= basis->star[k * basis->count + j] * number[j];
        for (long c = 0; c < corners; c++) {
            step[0][c] += star * basis->dual[k][c];
            step[1][c] += number[k] * basis->form[k][c];
        }
    }
}

/* How bad a form is beside the variance of log L: its energy for each of the basis's. Forms of
 * little energy have few and wide cylinders. */
static const double ENERGY = 0.1;

/* Roots of cylinders between rims, for each zero, that are as bad as a variance of 1. */
static const double MANY_ROOTS = 20, UNKNOWN_GAP = 0.02;

/* By so much numbers between rims differ: a share of the greatest difference, or of a period.
 * Closer choices would all be poor for the same reason. */
static const double LEVEL = 0.125;

/* Of forms that are looked for: every so many triangles, with two steps of each basis form. */
enum { BEAM = 80, MOST_LOOKED_AT = 4000, MOST_JUDGED = 5000 };
typedef struct {
    double score, *number; /* [count] */
    bool known;            /* what is near has been considered */
} Form;
typedef struct {
    const RefHolomorphic *basis;
    long triangles, stride;
    double *area, (*step)[2], (*dual)[2]; /* [triangles], [count][triangles] */
    double many_roots;
    int judged, choices;
    Form form[BEAM]; /* the best, best first */
} Choice;

static int by_value(const void *a, const void *b)
{
    const double *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

/* Without handles: how much longer than wide, or wider than long, cylinders between rims are that
 * have all that flows. Rims on one level have none between them; but on the highest or the lowest
 * one they have zeros between them that are not on it: it is not known how far. */
static double thinness(int count, const double *number, double flow)
{
    double sum = 0, *level = sm_alloc((size_t)count + 1, sizeof *level);
    memcpy(level, number, (size_t)count * sizeof *level);
    qsort(level, (size_t)count + 1, sizeof *level, by_value);
    for (int k = 0; k < count; k++) {
        double gap = level[k + 1] - level[k];
        bool last = level[k] == level[0] || level[k + 1] == level[count];
        if (last) gap = fmax(gap, UNKNOWN_GAP);
        if (gap > 1e-9) sum += fmax(flow / gap, gap / flow);
    }
    free(level);
    return sum;
}

/* The variance of log L, and a share of the energy or of the roots. */
static double judge(const Choice *choice, const double *number, double many_roots)
{
    int count = choice->basis->count;
    double sum = 0, square = 0, whole = 0, energy = 0;
    double *star = sm_alloc((size_t)count, sizeof *star);
    for (int k = 0; k < count; k++)
        for (int j = 0; j < count; j++) star[k] -= choice->basis->star[k * count + j] * number[j];
    for (long t = 0; t < choice->triangles; t++) {
        double x[2] = {0}, y[2] = {0};
        for (int k = 0; k < count; k++) {
            const double *step = choice->step[k * choice->triangles + t];
            const double *dual = choice->dual[k * choice->triangles + t];
            for (int d = 0; d < 2; d++) {
                x[d] += star[k] * dual[d];
                y[d] += number[k] * step[d];
            }
        }
        double flat = fabs(x[0] * y[1] - x[1] * y[0]) / 2, area = choice->area[t];
        double log_L = log(area / fmax(flat, 1e-300)) / 2;
        whole += area;
        energy += flat;
        sum += area * log_L;
        square += area * log_L * log_L;
    }
    free(star);
    energy *= (double)choice->stride;
    return square / whole - sum / whole * (sum / whole) +
           (choice->basis->loops
                ? energy / count * ENERGY
                : thinness(count, number, energy) / fmax(count - 1, 1) / many_roots);
}

/* Turned about or scaled, a form has the same leaves: whole numbers have no common divisor, and the
 * first of them is positive; without them the greatest difference between rims is 1. False where
 * all are 0, or have a divisor. */
static bool normalise(const RefHolomorphic *basis, double *number)
{
    int common = 0, first = 0;
    double low = 0, high = 0, factor = 1;
    for (int k = 0; k < basis->count; k++) {
        int a = k < basis->loops ? abs((int)number[k]) : 0;
        if (first == 0 && number[k] != 0) first = number[k] > 0 ? 1 : -1;
        while (a != 0) {
            int rest = common % a;
            common = a;
            a = rest;
        }
        low = fmin(low, number[k]);
        high = fmax(high, number[k]);
    }
    if (basis->loops ? common != 1 : high == low) return false;
    factor = first / (basis->loops ? 1 : high - low);
    for (int k = 0; k < basis->count; k++) number[k] *= factor;
    return true;
}

static bool same(int count, const double *a, const double *b)
{
    for (int k = 0; k < count; k++)
        if (fabs(a[k] - b[k]) > 1e-9) return false;
    return true;
}

/* Puts a choice where it belongs among the best, if it is one and new. */
static void consider(Choice *choice, double *number)
{
    size_t count = (size_t)choice->basis->count, bytes = count * sizeof *number;
    if (!normalise(choice->basis, number)) return;
    for (int n = 0; n < choice->choices; n++)
        if (same((int)count, choice->form[n].number, number)) return;
    double score = judge(choice, number, choice->many_roots);
    choice->judged++;
    if (choice->choices == BEAM && !(score < choice->form[BEAM - 1].score)) return;
    if (choice->choices < BEAM) choice->choices++;
    int at = choice->choices - 1;
    Form form = {.score = score, .number = choice->form[at].number};
    for (; at > 0 && choice->form[at - 1].score > score; at--)
        choice->form[at] = choice->form[at - 1];
    memcpy(form.number, number, bytes);
    choice->form[at] = form;
}

/* Considers what flows from one rim to another and through no third one, for all two. */
static void consider_flows(Choice *choice)
{
    const RefHolomorphic *basis = choice->basis;
    int count = basis->count;
    size_t size = (size_t)count * (size_t)count;
    double *A = sm_alloc(size, sizeof *A), *c = sm_alloc((size_t)count, sizeof *c);
    for (int i = 0; i < count; i++)
        for (int j = i; j < count; j++) {
            memcpy(A, basis->energy, size * sizeof *A);
            for (int k = 0; k < count; k++) c[k] = (k == i) - (k == j && j != i);
            if (ref_dense_definite(count, A, c)) consider(choice, c);
        }
    for (int k = 0; k < count; k++) c[k] = 1;
    consider(choice, c);
    sm_free_all(A, c);
}

/* Considers what differs from another choice in one number: whole ones by one, others by a step, or
 * they are another rim's. */
static void consider_near(Choice *choice, const double *from, double *next)
{
    int count = choice->basis->count, loops = choice->basis->loops;
    for (int k = 0; k < count; k++)
        for (int j = -2; j < count; j++) {
            if (j >= 0 && (k < loops || j < loops || j == k)) continue;
            memcpy(next, from, (size_t)count * sizeof *next);
            next[k] = j >= 0 ? from[j] : from[k] + (j == -1 ? 1 : -1) * (k < loops ? 1 : LEVEL);
            consider(choice, next);
        }
}

/* Considers what is near the best whose neighbours are not known, until they all are. */
static void search(Choice *choice)
{
    size_t count = (size_t)choice->basis->count;
    double *from = sm_alloc(count, sizeof *from), *next = sm_alloc(count, sizeof *next);
    choice->choices = choice->judged = 0;
    consider_near(choice, from, next); /* zeros first */
    if (choice->basis->loops == 0) consider_flows(choice);
    for (int n = 0; n < choice->choices && choice->judged < MOST_JUDGED;) {
        if (choice->form[n].known) {
            n++;
            continue;
        }
        choice->form[n].known = true;
        memcpy(from, choice->form[n].number, count * sizeof *from);
        consider_near(choice, from, next);
        n = 0;
    }
    sm_free_all(from, next);
}

int ref_holomorphic_choose(const RefTriangulation *surface, const RefHolomorphic *basis, int wanted,
                           double *number, double *score)
{
    long stride = 1 + surface->triangles / MOST_LOOKED_AT;
    Choice choice = {
        .basis = basis, .stride = stride, .triangles = (surface->triangles + stride - 1) / stride};
    size_t count = (size_t)basis->count, triangles = (size_t)choice.triangles;
    choice.area = sm_alloc(triangles, sizeof *choice.area);
    choice.step = sm_alloc(count * triangles, sizeof *choice.step);
    choice.dual = sm_alloc(count * triangles, sizeof *choice.dual);
    double *room = sm_alloc(BEAM * count, sizeof *room);
    for (size_t n = 0; n < BEAM; n++) choice.form[n].number = room + n * count;
    for (size_t t = 0; t < triangles; t++) {
        size_t c = 3 * t * (size_t)stride;
        double cotangent[3];
        choice.area[t] = ref_triangle_shape(surface->length + c, cotangent) / 2;
        for (size_t k = 0; k < count; k++)
            for (size_t d = 0; d < 2; d++) {
                choice.step[k * triangles + t][d] = basis->form[k][c + d];
                choice.dual[k * triangles + t][d] = basis->dual[k][c + d];
            }
    }
    int found = 0, parts = basis->loops ? 1 : 2;
    for (int part = 0; part < parts; part++) {
        choice.many_roots = part ? INFINITY : MANY_ROOTS;
        search(&choice);
        for (int n = 0; n < choice.choices && n < wanted / parts; n++, found++) {
            double *one = number + (size_t)found * count;
            memcpy(one, choice.form[n].number, count * sizeof *one);
            score[found] = judge(&choice, one, INFINITY);
        }
    }
    sm_free_all(choice.area, choice.step, choice.dual, room);
    return found;
}
