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
    sm_free_all(basis->form, basis->star);
    *basis = (RefHolomorphic){.count = 0};
}

/* Takes whole multiples of other forms from each, until none gets less energy by that. */
static void shorten(const RefTriangulation *surface, const RefHolomorphic *basis, double *energy)
{
    int count = basis->count;
    bool changed = true;
    for (int round = 0; round < 100 && changed; round++) {
        changed = false;
        for (int i = 0; i < count; i++)
            for (int j = 0; j < count; j++) {
                double times = rint(energy[i * count + j] / energy[j * count + j]);
                if (i == j || times == 0 || !isfinite(times)) continue;
                for (long c = 0; c < 3 * surface->triangles; c++)
                    basis->form[i][c] -= times * basis->form[j][c];
                for (int k = 0; k < count; k++)
                    energy[i * count + k] -= times * energy[j * count + k];
                for (int k = 0; k < count; k++)
                    energy[k * count + i] -= times * energy[k * count + j];
                changed = true;
            }
    }
}

/* The star of each form: wedge star = energy, wedge and energy the products of the forms. */
static bool find_star(const RefTriangulation *surface, const double *energy, RefHolomorphic *basis)
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
        for (int i = 0; i < count; i++) right[i] = energy[i * count + j];
        found = ref_dense_any(count, left, right);
        for (int i = 0; i < count; i++) basis->star[i * count + j] = right[i];
    }
    sm_free_all(wedge, left, right);
    return found;
}

static int longest_rim(const RefTriangulation *surface)
{
    double *length = sm_alloc((size_t)surface->rims, sizeof *length);
    int longest = 0;
    for (long c = 0; c < 3 * surface->triangles; c++)
        if (surface->rim[c] >= 0) length[surface->rim[c]] += surface->length[c];
    for (int r = 1; r < surface->rims; r++)
        if (length[r] > length[longest]) longest = r;
    free(length);
    return longest;
}

/* Forms of a surface with rims, and those of their stars. */
static SmCode between_rims(const RefTriangulation *surface, const double *weight,
                           RefHolomorphic *basis, SmError *error)
{
    size_t corners = 3 * (size_t)surface->triangles;
    bool *held = sm_alloc((size_t)surface->vertices, sizeof *held);
    basis->dual = sm_alloc((size_t)basis->count, sizeof *basis->dual);
    int longest = longest_rim(surface);
    for (int k = 0; k < basis->count; k++) {
        int rim = k < longest ? k : k + 1;
        basis->form[k] = sm_alloc(corners, sizeof **basis->form);
        basis->dual[k] = ref_harmonic_crossing(surface, longest, rim);
        for (int c = 0; c < (int)corners; c++) {
            int from = surface->corner[surface->vertex[c]];
            int to = surface->corner[surface->vertex[ref_corner_next(c)]];
            basis->form[k][c] = (surface->rim[to] == rim) - (surface->rim[from] == rim);
            held[surface->vertex[c]] = surface->rim[from] >= 0;
        }
    }
    SmCode code = ref_harmonic_solve(surface, weight, held, basis->count, basis->form, error);
    if (code == SM_OK)
        code = ref_harmonic_solve(surface, weight, NULL, basis->count, basis->dual, error);
    free(held);
    return code;
}

SmCode ref_holomorphic_create(const RefTriangulation *surface, const double *weight,
                              const char *name, RefHolomorphic *basis, SmError *error)
{
    int count = surface->rims ? surface->rims - 1 : 2 * surface->genus;
    SmCode code;
    *basis = (RefHolomorphic){.count = count, .form = sm_alloc((size_t)count, sizeof(double *))};
    if (surface->rims) {
        code = between_rims(surface, weight, basis, error);
    } else {
        basis->dual = basis->form;
        ref_harmonic_loops(surface, basis->form);
        code = ref_harmonic_solve(surface, weight, NULL, count, basis->form, error);
    }
    if (code == SM_OK) {
        double *energy = sm_alloc((size_t)count * (size_t)count, sizeof *energy);
        for (int i = 0; i < count; i++)
            for (int j = 0; j < count; j++)
                energy[i * count + j] =
                    ref_harmonic_product(surface, weight, basis->form[i], basis->form[j]);
        if (surface->rims == 0) shorten(surface, basis, energy);
        if (!find_star(surface, energy, basis))
            code =
                sm_fail(error, SM_INPUT,
                        "%s: the forms of its handles or rims depend on one another: give it more "
                        "triangles",
                        name);
        free(energy);
    }
    if (code != SM_OK) ref_holomorphic_free(basis);
    return code;
}

void ref_holomorphic_form(const RefTriangulation *surface, const RefHolomorphic *basis,
                          const int *number, double *const step[2])
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

/* From which numbers between rims start: functions differ by a share of this. */
enum { LEVEL = 16 };

/* Of forms that are looked for: every so many triangles, with two steps of each basis form. */
enum { BEAM = 80, MOST_LOOKED_AT = 4000 };
typedef struct {
    const RefHolomorphic *basis;
    long triangles, stride;
    double *area, (*step)[2], (*dual)[2]; /* [triangles], [count][triangles] */
    bool open;                            /* has rims */
    long edges;                           /* that leave rims */
    double *leave;        /* [count][edges] steps along them, turned about on the longest rim */
    int choices, *number; /* [BEAM][count] the best, best first */
    double score[BEAM];
} Choice;

/* The variance of log L, and a share of the energy. */
static double judge(const Choice *choice, const int *number)
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
           (choice->open ? 0 : energy / count * ENERGY);
}

/* Whether whole numbers are not all 0, have no common divisor, and the first of them is positive:
 * turned about, a form has the same leaves. */
static bool is_one(int count, const int *number)
{
    int common = 0, first = 0;
    for (int k = 0; k < count; k++) {
        int a = abs(number[k]);
        if (first == 0) first = number[k];
        while (a != 0) {
            int rest = common % a;
            common = a;
            a = rest;
        }
    }
    return common == 1 && first > 0;
}

/* Whether the function falls everywhere away from rims, and rises from the longest one, so that
 * none of its zeros is on a rim. */
static bool falls(const Choice *choice, const int *number)
{
    for (long e = 0; e < choice->edges; e++) {
        double step = 0;
        for (int k = 0; k < choice->basis->count; k++)
            step += number[k] * choice->leave[k * choice->edges + e];
        if (!(step < 0)) return false;
    }
    return true;
}

/* The edges that leave rims. */
static void find_edges(const RefTriangulation *surface, Choice *choice)
{
    size_t count = (size_t)choice->basis->count;
    int longest = longest_rim(surface);
    for (int pass = 0; pass < 2; pass++) {
        if (pass) choice->leave = sm_alloc(count * (size_t)choice->edges, sizeof(double));
        long edge = 0;
        for (int c = 0; c < 3 * surface->triangles; c++) {
            int rim = surface->rim[surface->corner[surface->vertex[c]]];
            int to = surface->rim[surface->corner[surface->vertex[ref_corner_next(c)]]];
            if (rim < 0 || to >= 0) continue;
            for (size_t k = 0; pass && k < count; k++)
                choice->leave[k * (size_t)choice->edges + (size_t)edge] =
                    (rim == longest ? -1 : 1) * choice->basis->form[k][c];
            edge++;
        }
        choice->edges = edge;
    }
}

/* Puts a choice where it belongs among the best; whether it is one and new. */
static bool consider(Choice *choice, const int *number)
{
    size_t count = (size_t)choice->basis->count, bytes = count * sizeof *number;
    if (choice->open ? !falls(choice, number) : !is_one((int)count, number)) return false;
    for (int n = 0; n < choice->choices; n++)
        if (!memcmp(choice->number + (size_t)n * count, number, bytes)) return false;
    double score = judge(choice, number);
    int at = choice->choices;
    if (at == BEAM && !(score < choice->score[BEAM - 1])) return false;
    if (at < BEAM)
        choice->choices++;
    else
        at--;
    for (; at > 0 && choice->score[at - 1] > score; at--) {
        choice->score[at] = choice->score[at - 1];
        memcpy(choice->number + (size_t)at * count, choice->number + (size_t)(at - 1) * count,
               bytes);
    }
    choice->score[at] = score;
    memcpy(choice->number + (size_t)at * count, number, bytes);
    return true;
}

/* Considers what differs from the best by one in one number, as long as that makes them better. */
static void search(Choice *choice)
{
    int count = choice->basis->count;
    size_t size = (size_t)BEAM * (size_t)count;
    int *from = sm_alloc(size, sizeof *from), *next = sm_alloc((size_t)count, sizeof *next);
    bool better = true;
    for (int k = 0; k < count; k++) next[k] = LEVEL;
    if (choice->open) consider(choice, next);
    for (int round = 0; round < 2 * count && better; round++) {
        int known = choice->choices ? choice->choices : 1; /* zeros first */
        memcpy(from, choice->number, size * sizeof *from);
        better = false;
        for (int n = 0; n < known; n++)
            for (int k = 0; k < 2 * count; k++) {
                memcpy(next, from + n * count, (size_t)count * sizeof *next);
                next[k / 2] += k % 2 ? -1 : 1;
                better |= consider(choice, next);
            }
    }
    sm_free_all(from, next);
}

int ref_holomorphic_choose(const RefTriangulation *surface, const RefHolomorphic *basis, int wanted,
                           int *number, double *score)
{
    long stride = 1 + surface->triangles / MOST_LOOKED_AT;
    Choice choice = {
        .basis = basis, .stride = stride, .triangles = (surface->triangles + stride - 1) / stride};
    size_t count = (size_t)basis->count, triangles = (size_t)choice.triangles;
    choice.area = sm_alloc(triangles, sizeof *choice.area);
    choice.open = surface->rims > 0;
    if (choice.open) find_edges(surface, &choice);
    choice.step = sm_alloc(count * triangles, sizeof *choice.step);
    choice.dual = sm_alloc(count * triangles, sizeof *choice.dual);
    choice.number = sm_alloc(BEAM * count, sizeof *choice.number);
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
    search(&choice);
    int found = choice.choices < wanted ? choice.choices : wanted;
    memcpy(number, choice.number, (size_t)found * count * sizeof *number);
    memcpy(score, choice.score, (size_t)found * sizeof *score);
    sm_free_all(choice.area, choice.step, choice.dual, choice.leave, choice.number);
    return found;
}
