#include "voxel_search.h"

#include <math.h>
#include <stdlib.h>

#define CELL_SIZES 12
#define SHIFTS     47
#define WORDS      67108864.0 /* of all lattices: some seconds */

typedef struct {
    double cell; /* 0: none yet */
    double count;
} Sample;

typedef struct {
    SmVoxeliser *voxeliser;
    long wanted;
    SmVoxels best;
    SmVoxelReport report; /* of the best */
    Sample few, many;     /* nearest samples to either side */
    Sample last;
    double words; /* that more lattices may have together */
    bool limited; /* a cell size was beyond the limits */
    int tried;
} Search;

/* Whether a lattice of this cell size is within the limits, and within those of the search. */
static bool affordable(Search *s, double cell)
{
    double words = sm_voxeliser_words(s->voxeliser, cell);
    if (!(words <= s->words)) return false;
    s->words -= words;
    return true;
}

static long miss(const Search *s)
{
    return labs(s->best.particle_count - s->wanted);
}

/* Makes one lattice and keeps it when it is nearer than the best. */
static SmCode try_lattice(Search *s, double cell, const double shift[3], SmError *error)
{
    SmVoxels voxels;
    SmVoxelReport report;
    SmCode code = sm_voxeliser_build(s->voxeliser, cell, shift, &voxels, &report, error);
    if (code) return code;
    s->tried++;
    s->last = (Sample){cell, (double)voxels.particle_count};
    if (!s->best.bits || labs(voxels.particle_count - s->wanted) < miss(s)) {
        SmVoxels swap = s->best;
        s->best = voxels;
        voxels = swap;
        s->report = report;
    }
    sm_voxels_free(&voxels);
    return SM_OK;
}

/* A cell size without the last bits, in which libraries' powers and logarithms differ: machines are
 * to simulate the same particles. */
static double rounded(double cell)
{
    return (double)(float)cell;
}

/* The cell size to try next. Counts go as a power of the cell size, -2 for a shell to -3 for a
 * solid; interpolated between the nearest samples or extrapolated from the last. */
static double next_cell(const Search *s, bool halve)
{
    if (s->few.cell == 0 || s->many.cell == 0) {
        double power = s->voxeliser->fill == SM_SHELL ? 2 : 2.7;
        double cell = s->last.cell * pow(s->last.count / (double)s->wanted, 1 / power);
        return fmin(cell, s->voxeliser->longest);
    }
    if (halve || isinf(s->many.count)) return sqrt(s->few.cell * s->many.cell);
    double part = log((double)s->wanted / s->few.count) / log(s->many.count / s->few.count);
    return s->few.cell * pow(s->many.cell / s->few.cell, part);
}

/* Places a sample in the bracket. Returns whether it replaced the side that the one before did. */
static bool narrow(Search *s, Sample sample, bool *was_many)
{
    bool is_many = sample.count >= (double)s->wanted, same = is_many == *was_many;
    *(is_many ? &s->many : &s->few) = sample;
    *was_many = is_many;
    return same;
}

static SmCode search_cell(Search *s, SmError *error)
{
    double cell = s->voxeliser->longest / 24;
    bool was_many = false, same = false;
    for (int i = 0; i < CELL_SIZES; i++) {
        if (!affordable(s, cell)) {
            s->limited = true;
            same = narrow(s, (Sample){cell, INFINITY}, &was_many);
        } else {
            SmCode code = try_lattice(s, cell, (double[3]){0, 0, 0}, error);
            if (code) return code;
            if (miss(s) * 1000 <= s->wanted) return SM_OK;
            same = narrow(s, s->last, &was_many) && i > 1;
        }
        double next = rounded(next_cell(s, same));
        if (fabs(next - cell) <= cell * 1e-9) return SM_OK;
        cell = next;
    }
    return SM_OK;
}

/* Where the count jumps with the cell size, other positions of the lattice have counts between:
 * first half a cell along some axes, then anywhere (the R4 sequence of Roberts, 2018, whose points
 * spread evenly) with a cell size between those to either side. */
static SmCode search_shift(Search *s, SmError *error)
{
    const double step[4] = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                            0.5385972572236101};
    double least = s->many.cell && isfinite(s->many.count) ? s->many.cell : s->best.cell;
    double most = s->few.cell ? s->few.cell : s->best.cell, centred = s->best.cell;
    for (int i = 1; i <= SHIFTS && miss(s) * 100 > s->wanted; i++) {
        double shift[3], part = fmod(i * step[3], 1);
        double cell = i < 8 ? centred : rounded(least * pow(most / least, 1.5 * part - 0.25));
        for (int d = 0; d < 3; d++) shift[d] = i < 8 ? (i >> d & 1) * 0.5 : fmod(i * step[d], 1);
        if (!affordable(s, cell)) continue;
        SmCode code = try_lattice(s, cell, shift, error);
        if (code) return code;
    }
    return SM_OK;
}

SmCode sm_voxel_search(SmVoxeliser *voxeliser, const SmVoxelParams *params, SmVoxels *voxels,
                       SmVoxelReport *report, SmError *error)
{
    Search s = {.voxeliser = voxeliser, .wanted = params->particles, .words = WORDS};
    SmCode code = search_cell(&s, error);
    if (!code) code = search_shift(&s, error);
    if (!code && s.limited && !params->fewer && miss(&s) * 50 > s.wanted)
        code =
            sm_fail(error, SM_INPUT,
                    "%s: %ld particles need too large a lattice (most of its box would be empty); "
                    "%ld were reached: ask for that many",
                    voxeliser->name, s.wanted, s.best.particle_count);
    if (code) {
        sm_voxels_free(&s.best);
        return code;
    }
    *voxels = s.best;
    *report = s.report;
    report->voxelisations = s.tried;
    return SM_OK;
}
