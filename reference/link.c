#include "link.h"

#include <stdlib.h>
#include <string.h>

#include "../lib/csr.h"
#include "../lib/system/team.h"

enum { RING = 26 };

typedef struct {
    const SmVoxels *voxels;
    const int (*coordinate)[3];
    const int (*broken)[2]; /* sorted, lower number first */
    long broken_count;
} Lattice;

/* Canonical order: z, then y, then x. */
static int compare_places(const void *a, const void *b)
{
    const int *p = a, *q = b;
    for (int axis = 2; axis > 0; axis--)
        if (p[axis] != q[axis]) return p[axis] < q[axis] ? -1 : 1;
    return (p[0] > q[0]) - (p[0] < q[0]);
}

int ref_particle_at(const int (*coordinate)[3], long count, const int place[3])
{
    const int(*at)[3] =
        bsearch(place, coordinate, (size_t)count, sizeof *coordinate, compare_places);
    return at ? (int)(at - coordinate) : -1;
}

/* Does a material cell hold both the vertex at `place` and the one a step `d` (-1..1) away? */
static bool share_cell(const SmVoxels *voxels, const int place[3], const int d[3])
{
    int low[3], high[3];
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = d[axis] > 0 ? place[axis] : place[axis] - 1;
        high[axis] = d[axis] < 0 ? place[axis] - 1 : place[axis];
    }
    for (int k = low[2]; k <= high[2]; k++)
        for (int j = low[1]; j <= high[1]; j++)
            for (int i = low[0]; i <= high[0]; i++)
                if (sm_voxel_get(voxels, i, j, k)) return true;
    return false;
}

static bool is_broken(const Lattice *lattice, int p, int q)
{
    int pair[2] = {p < q ? p : q, p < q ? q : p};
    return lattice->broken_count && bsearch(pair, lattice->broken, (size_t)lattice->broken_count,
                                            sizeof pair, sm_compare_pairs);
}

/* Writes the neighbours of p, rising, and returns how many. */
static int one_ring(const Lattice *lattice, long p, int neighbour[RING])
{
    const int *place = lattice->coordinate[p];
    long count = lattice->voxels->particle_count;
    int found = 0;
    for (int n = 0; n < 27; n++) {
        const int d[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        if (n == 13 || !share_cell(lattice->voxels, place, d)) continue;
        const int there[3] = {place[0] + d[0], place[1] + d[1], place[2] + d[2]};
        int q = ref_particle_at(lattice->coordinate, count, there);
        if (!is_broken(lattice, (int)p, q)) neighbour[found++] = q;
    }
    return found;
}

static int (*sort_pairs(const int (*broken)[2], long count))[2]
{
    int(*sorted)[2] = sm_alloc((size_t)count, sizeof *sorted);
    for (long b = 0; b < count; b++) {
        bool ordered = broken[b][0] < broken[b][1];
        sorted[b][0] = broken[b][!ordered];
        sorted[b][1] = broken[b][ordered];
    }
    qsort(sorted, (size_t)count, sizeof *sorted, sm_compare_pairs);
    return sorted;
}

void ref_links_build(const SmVoxels *voxels, const int (*broken)[2], long broken_count,
                     RefLinks *links)
{
    long count = voxels->particle_count;
    int(*coordinate)[3] = sm_alloc((size_t)count, sizeof *coordinate);
    sm_voxels_particles(voxels, coordinate);
    int(*sorted)[2] = sort_pairs(broken, broken_count);
    Lattice lattice = {voxels, (const int(*)[3])coordinate, (const int(*)[2])sorted, broken_count};

    SmCsr rows;
    SmCsrParts neighbours;
    sm_csr_parts_init(&neighbours, count);
#pragma omp parallel for num_threads(sm_team(0)) if (count > REF_SERIAL)
    for (long block = 0; block < neighbours.blocks; block++)
        for (long p = sm_csr_parts_from(block); p < sm_csr_parts_to(&neighbours, block); p++) {
            int neighbour[RING];
            sm_csr_parts_add(&neighbours, p, neighbour, one_ring(&lattice, p, neighbour));
        }
    sm_csr_parts_join(&neighbours, &rows, 0);
    *links = (RefLinks){.count = count, .start = rows.first, .neighbour = rows.item};
    free(sorted);
    free(coordinate);
}

bool ref_linked(const RefLinks *links, int p, int q)
{
    for (long n = links->start[p]; n < links->start[p + 1]; n++)
        if (links->neighbour[n] == q) return true;
    return false;
}

void ref_links_free(RefLinks *links)
{
    free(links->start);
    free(links->neighbour);
    memset(links, 0, sizeof *links);
}
