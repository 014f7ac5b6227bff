#include "field_transfer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"
#include "field_place.h"

/* What a sample has of the fields: both energies are sums of squares. */
typedef struct {
    double root[6], velocity[3];
} Seen;

/* Sums over the samples of a cell. */
typedef struct {
    double area, squares, momentum[3], energy;
} Sums;

/* Of a cell that was split: over its samples, and over those of its parts. */
typedef struct {
    Sums was, is;
} Balance;

RefFieldsBefore ref_fields_before(const RefCracked *cracked, const RefCrackedFields *fields)
{
    const RefShell *shell = cracked->shell;
    size_t nodes = (size_t)shell->nodes.count;
    RefFieldsBefore before = {.nodes = ref_nodes_copy(&shell->nodes),
                              .X = sm_copy(shell->X, nodes, sizeof(double[3])),
                              .fields = fields ? fields->count : 0};
    before.nodes.cut.cracks = &cracked->cracks_before;
    before.shape = ref_shape_create(&before.nodes);
    before.part = sm_alloc((size_t)before.nodes.most, sizeof *before.part);
    before.field = sm_alloc((size_t)before.fields, sizeof *before.field);
    for (int f = 0; f < before.fields; f++)
        before.field[f] = sm_copy(fields->field[f], nodes, sizeof(double[3]));
    return before;
}

void ref_fields_before_free(RefFieldsBefore *before)
{
    for (int f = 0; f < before->fields; f++) free(before->field[f]);
    for (long c = 0; c < before->cells; c++) ref_samples_free(before->samples + c);
    ref_nodes_free(&before->nodes);
    ref_shape_free(&before->shape);
    sm_free_all(before->X, before->part, before->field, before->samples);
    *before = (RefFieldsBefore){.fields = 0};
}

/* A place among the functions that there were, of the cell that was terminal then. */
static RefFieldPlace place_before(const RefCracked *cracked, long cell, const double theta[3],
                                  RefFieldsBefore *before)
{
    const RefShell *shell = cracked->shell;
    RefShape *shape = &before->shape;
    double edge = ref_quadtree_edge(&shell->tree, shell->tree.cell + cell);
    ref_samples_shape(&before->nodes, shell->basis, edge, theta, shape);
    for (int n = 0; n < shape->count; n++) ref_samples_part(shape, n, before->part[n]);
    return (RefFieldPlace){shape->count, shape->node, (const double(*)[6])before->part, NULL};
}

/* The field there, and a quarter a split of what the parameters of the cell that was split were
 * above it. */
void ref_fields_place(const RefCracked *cracked, const RefCrackedCell *cell, int node,
                      RefFieldsBefore *before, const RefCrackedFields *fields)
{
    const RefCrackedCell *from = cracked->cell + cell->from;
    int parent = from->node[0];
    double share = ldexp(1, -2 * (cell->splits - from->splits));
    const double *at[2] = {cracked->shell->nodes.position[node], before->nodes.position[parent]};
    for (int f = 0; f < fields->count; f++)
        for (int d = 0; d < 3; d++)
            fields->field[f][3 * (long)node + d] = share * before->field[f][parent][d];
    for (int k = 0; k < 2; k++) {
        RefFieldPlace place = place_before(cracked, cell->from, at[k], before);
        for (int f = 0; f < fields->count; f++) {
            double value[3];
            place.u = (const double(*)[3])before->field[f];
            ref_field_value(&place, value);
            for (int d = 0; d < 3; d++)
                fields->field[f][3 * (long)node + d] += k ? -share * value[d] : value[d];
        }
    }
}

/* What a sample has of displacements and velocities; where its functions are not stiff, no strains.
 */
static Seen see(const RefSamples *samples, long p, bool stiff, const RefShellOptions *options,
                const double *u, const double *v)
{
    Seen seen = {.velocity = {0}};
    RefFieldPlace place = ref_field_sample(samples, p, (const double(*)[3])u);
    if (stiff)
        ref_field_root(&place, samples->frame + p, options->thickness, &options->material,
                       seen.root);
    place.u = (const double(*)[3])v;
    ref_field_value(&place, seen.velocity);
    return seen;
}

/* Whether functions are, at sample p of `like`, whose areas and traces before any crack count. */
static bool is_stiff(const RefSamples *samples, long p, const RefSamples *like)
{
    return samples->start[p] < samples->start[p + 1] &&
           ref_thin_is_stiff(samples->frame + p, like->area[p] / like->weight[p], like->trace[p]);
}

/* What there was at sample p, of functions that there were. */
static Seen seen_before(const RefCracked *cracked, const RefSamples *samples, long p,
                        const RefSamples *like, const RefFieldsBefore *before)
{
    return see(samples, p, is_stiff(samples, p, like), &cracked->options, *before->field[0],
               *before->field[1]);
}

static void add_seen(const Seen *seen, double area, Sums *sums)
{
    sums->area += area;
    sums->squares += area * sm_dot(seen->velocity, seen->velocity);
    for (int d = 0; d < 3; d++) sums->momentum[d] += area * seen->velocity[d];
    for (int i = 0; i < 6; i++) sums->energy += area * seen->root[i] * seen->root[i];
}

/* Sums of squares about the mean. */
static double variance(const Sums *sums)
{
    return fmax(sums->squares - sm_dot(sums->momentum, sums->momentum) / sums->area, 0);
}

/* What samples of a cell's parts are to have, so that they have the cell's momentum, and no more
 * energy: strains and what velocities differ by from their mean are made smaller. */
static Seen adjusted(const Seen *seen, const Balance *balance)
{
    const Sums *was = &balance->was, *is = &balance->is;
    Seen changed = *seen;
    double strained = is->energy > was->energy ? sqrt(was->energy / is->energy) : 1;
    double varied = variance(was) < variance(is) ? sqrt(variance(was) / variance(is)) : 1;
    for (int i = 0; i < 6; i++) changed.root[i] *= strained;
    for (int d = 0; d < 3; d++)
        changed.velocity[d] =
            (was->momentum[d] + varied * (is->area * seen->velocity[d] - is->momentum[d])) /
            is->area;
    return changed;
}

void ref_fields_take_samples(RefCracked *cracked, RefFieldsBefore *before)
{
    before->cells = cracked->shell->tree.count;
    before->samples = sm_alloc((size_t)before->cells, sizeof *before->samples);
    for (long c = 0; c < before->cells; c++) {
        before->samples[c] = cracked->cell[c].samples;
        cracked->cell[c].samples = (RefSamples){.count = 0};
    }
}

/* Whether a cell is new: part of one that was split. */
static bool is_new(const RefCracked *cracked, const RefFieldsBefore *before, long c)
{
    return cracked->cell[c].samples.count > 0 && before->samples[c].count == 0;
}

/* What samples of new cells have of the old fields, cell by cell, and the sums over cells that were
 * split. */
static Seen *see_parts(const RefCracked *cracked, RefFieldsBefore *before, Balance *balance)
{
    const RefShell *shell = cracked->shell;
    long parts = 0, cells = before->cells;
    for (long c = 0; c < cells; c++)
        if (is_new(cracked, before, c)) parts += REF_SAMPLES_PER_CELL;
    Seen *part = sm_alloc((size_t)parts, sizeof *part), *next = part;
    RefSamplesWork work = ref_samples_work(&before->nodes, shell->basis, &cracked->cracks_before);
    for (long c = 0; c < cells; c++) {
        const RefCrackedCell *cell = cracked->cell + c;
        const RefSamples *old = before->samples + c;
        RefSamples had = {.count = 0};
        for (long p = 0; cell->samples.count == 0 && p < old->count; p++) {
            Seen seen = seen_before(cracked, old, p, old, before);
            add_seen(&seen, old->area[p], &balance[c].was);
        }
        if (!is_new(cracked, before, c)) continue;
        double edge = ref_quadtree_edge(&shell->tree, shell->tree.cell + cell->from);
        ref_samples_of(&shell->tree, c, edge, &work, &had);
        ref_middle_frames((const double(*)[3])before->X, &had);
        for (long p = 0; p < had.count; p++) {
            *next = seen_before(cracked, &had, p, &cell->samples, before);
            add_seen(next++, cell->samples.area[p], &balance[cell->from].is);
        }
        ref_samples_free(&had);
    }
    ref_samples_work_free(&work);
    return part;
}

/* Whether a sample has the functions that it had, of a surface that is what it was. */
static bool is_as_before(const RefCracked *cracked, const RefFieldsBefore *before,
                         const RefSamples *old, const RefSamples *now, long p)
{
    long from = old->start[p], at = now->start[p], count = old->start[p + 1] - from;
    if (now->start[p + 1] - at != count) return false;
    for (long e = 0; e < count; e++) { /* numbers of nodes that are gone may be those of new ones */
        int node = now->node[at + e];
        if (old->node[from + e] != node ||
            memcmp(old->part[from + e], now->part[at + e], sizeof *now->part) ||
            memcmp(before->X[node], cracked->shell->X[node], sizeof *before->X))
            return false;
    }
    return true;
}

/* What is left of the fields at a sample. */
static void add_residual(const RefCracked *cracked, const RefSamples *samples, long p,
                         const Seen *seen, const RefCrackedFields *fields)
{
    const RefShellOptions *options = &cracked->options;
    double area = samples->area[p], mass = options->material.density * options->thickness * area;
    RefFieldPlace place = ref_field_sample(samples, p, NULL);
    bool stiff = is_stiff(samples, p, samples);
    Seen left = see(samples, p, stiff, options, fields->field[0], fields->field[1]);
    for (int i = 0; i < 6; i++) left.root[i] = seen->root[i] - left.root[i];
    if (stiff)
        ref_field_pull(&place, samples->frame + p, options->thickness, &options->material,
                       left.root, area, (double(*)[3])fields->residual[0]);
    for (int n = 0; n < place.count; n++)
        for (int d = 0; d < 3; d++)
            fields->residual[1][3 * (long)place.node[n] + d] +=
                mass * place.part[n][0] * (seen->velocity[d] - left.velocity[d]);
}

void ref_fields_residuals(const RefCracked *cracked, RefFieldsBefore *before,
                          const RefCrackedFields *fields)
{
    Balance *balance = sm_alloc((size_t)before->cells, sizeof *balance);
    Seen *part = see_parts(cracked, before, balance), *next = part;
    for (long c = 0; c < before->cells; c++) {
        const RefCrackedCell *cell = cracked->cell + c;
        const RefSamples *old = before->samples + c;
        for (long p = 0; p < cell->samples.count; p++) {
            Seen seen;
            if (old->count && is_as_before(cracked, before, old, &cell->samples, p)) continue;
            if (old->count)
                seen = seen_before(cracked, old, p, old, before);
            else
                seen = adjusted(next++, balance + cell->from);
            add_residual(cracked, &cell->samples, p, &seen, fields);
        }
    }
    sm_free_all(balance, part);
}
