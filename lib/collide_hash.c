#include "collide_hash.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

static int cube_of(double x)
{
    static const double most = 1e9;
    double floored = floor(x);
    return floored > -most ? (int)(floored < most ? floored : most) : (int)-most;
}

/* Cubes that follow each other along x have places that do. */
static unsigned place_of(const SmCollideHash *hash, const int cube[3])
{
    unsigned row = (unsigned)cube[1] * 73856093u + (unsigned)cube[2] * 19349663u;
    return ((unsigned)cube[0] + (row ^ row >> 15)) & hash->mask;
}

void sm_collide_hash_start(SmCollideHash *hash, long most, double width)
{
    unsigned size = 16;
    while (size < (1u << 30) && (long)size < 2 * most) size *= 2;
    if (size > hash->table_room) {
        free(hash->start);
        hash->start = sm_alloc((size_t)size + 1, sizeof *hash->start);
        hash->table_room = size;
    }
    if (most > hash->room) {
        free(hash->place);
        free(hash->noted);
        free(hash->entry);
        hash->place = sm_alloc((size_t)most, sizeof *hash->place);
        hash->noted = sm_alloc((size_t)most, sizeof *hash->noted);
        hash->entry = sm_alloc((size_t)most, sizeof *hash->entry);
        hash->room = most;
    }
    hash->mask = size - 1;
    hash->count = 0;
    hash->inverse = 1 / width;
}

void sm_collide_hash_add(SmCollideHash *hash, long item, const double x[3])
{
    SmCollideEntry *entry = &hash->noted[hash->count];
    entry->item = (int)item;
    for (int d = 0; d < 3; d++) {
        entry->x[d] = x[d];
        entry->cube[d] = cube_of(x[d] * hash->inverse);
    }
    hash->place[hash->count++] = place_of(hash, entry->cube);
}

void sm_collide_hash_finish(SmCollideHash *hash)
{
    unsigned size = hash->mask + 1;
    int sum = 0;
    memset(hash->start, 0, ((size_t)size + 1) * sizeof *hash->start);
    for (long i = 0; i < hash->count; i++) hash->start[hash->place[i]]++;
    for (unsigned p = 0; p <= size; p++) { /* ends, which filling from the back makes starts */
        sum += p < size ? hash->start[p] : 0;
        hash->start[p] = sum;
    }
    for (long i = hash->count; i-- > 0;)
        hash->entry[--hash->start[hash->place[i]]] = hash->noted[i];
}

void sm_collide_hash_free(SmCollideHash *hash)
{
    free(hash->start);
    free(hash->place);
    free(hash->noted);
    free(hash->entry);
    *hash = (SmCollideHash){0};
}

long sm_collide_hash_bytes(const SmCollideHash *hash)
{
    return hash->room * (long)(2 * sizeof(SmCollideEntry) + sizeof(unsigned)) +
           ((long)hash->table_room + 1) * (long)sizeof(int);
}

/* The row of cubes, from query->x on, as far as its places do not start again from 0. */
static void enter(const SmCollideHash *hash, SmCollideQuery *query)
{
    unsigned place = place_of(hash, (int[3]){query->x, query->row[0], query->row[1]});
    unsigned more = (unsigned)query->high[0] - (unsigned)query->x;
    if (more > hash->mask - place) more = hash->mask - place;
    query->at = hash->start[place];
    query->end = hash->start[place + more + 1];
    query->from = query->x;
    query->to = query->x + (int)more;
}

void sm_collide_hash_query(const SmCollideHash *hash, const double low[3], const double high[3],
                           SmCollideQuery *query)
{
    bool empty = false;
    for (int d = 0; d < 3; d++) {
        query->low[d] = cube_of(low[d] * hash->inverse);
        query->high[d] = cube_of(high[d] * hash->inverse);
        empty |= !(high[d] >= low[d]);
    }
    if (empty)
        for (int d = 0; d < 3; d++) query->high[d] = query->low[d];
    query->x = query->low[0];
    query->row[0] = query->low[1];
    query->row[1] = query->low[2];
    enter(hash, query);
    if (empty) query->end = query->at;
}

/* The next row of cubes of the box, or the rest of this one. */
static bool advance(const SmCollideHash *hash, SmCollideQuery *query)
{
    if (query->to < query->high[0]) {
        query->x = query->to + 1;
    } else {
        query->x = query->low[0];
        if (query->row[0]++ == query->high[1]) {
            query->row[0] = query->low[1];
            if (query->row[1]++ == query->high[2]) return false;
        }
    }
    enter(hash, query);
    return true;
}

const SmCollideEntry *sm_collide_hash_next(const SmCollideHash *hash, SmCollideQuery *query)
{
    do {
        while (query->at < query->end) {
            const SmCollideEntry *entry = &hash->entry[query->at++];
            if (entry->cube[1] == query->row[0] && entry->cube[2] == query->row[1] &&
                entry->cube[0] >= query->from && entry->cube[0] <= query->to)
                return entry;
        }
    } while (advance(hash, query));
    return NULL;
}
