#include "grips.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/polar.h"
#include "../../lib/vector.h"

void view_grips_create(const BenchPlayback *play, ViewGrips *grips)
{
    *grips = (ViewGrips){.groups = play->count};
    grips->held = sm_alloc((size_t)play->count, sizeof *grips->held);
}

/* Keeps the handles of hands that hold something; the others' material is let go. */
static void keep_used(ViewHeld *held, const ViewHand *hand, bool anew)
{
    int kept = 0;
    for (int i = 0; i < held->count; i++) {
        if (anew || !hand[held->hand[i]].holds) {
            free((void *)held->handle[i].particle);
            continue;
        }
        held->handle[kept] = held->handle[i];
        held->hand[kept] = held->hand[i];
        memmove(held->start[kept++], held->start[i], sizeof held->start[i]);
    }
    held->count = kept;
}

void view_grips_free(ViewGrips *grips)
{
    static const ViewHand none[VIEW_HANDS];
    for (int g = 0; g < grips->groups; g++) keep_used(&grips->held[g], none, true);
    free(grips->held);
    *grips = (ViewGrips){0};
}

/* The particle nearest to the point, but for `other`, of those of one body that nothing holds, and
 * how far it is; -1: there is none. */
static long nearest(const BenchRunner *runner, const char *taken, const double point[3], long other,
                    double *away)
{
    long found = -1;
    *away = INFINITY;
    for (long p = 0; p < runner->count; p++) {
        double distance = sqrt(sm_square_between(runner->x0[p], point));
        if (taken[p] || p == other || distance >= *away) continue;
        *away = distance;
        found = p;
    }
    return found;
}

/* Particles at a hand that nothing holds yet, of which `taken` then says so: those in its ball,
 * which is so large at least that the nearest and its neighbours are in it. What is drawn is
 * carried by several of an octree's large cells. */
static long choose(const BenchRunner *runner, long instance, const ViewHand *hand, char *taken,
                   long *particle)
{
    long count = 0, first = instance * runner->count;
    double away, apart;
    long p = nearest(runner, taken + first, hand->rest, -1, &away);
    if (p < 0) return 0;
    nearest(runner, taken + first, runner->x0[p], p, &apart);
    double reach = fmax(hand->radius, isfinite(apart) ? away + apart : away);
    for (p = 0; p < runner->count; p++)
        if (!taken[first + p] && sm_square_between(runner->x0[p], hand->rest) <= reach * reach)
            particle[count++] = first + p;
    for (long i = 0; i < count; i++) taken[particle[i]] = 1;
    return count;
}

/* The field of the particles that a handle holds. */
static void read_held(const BenchRunner *runner, SmField field, const SmHandle *handle,
                      double (*value)[3])
{
    double(*all)[3] = sm_alloc((size_t)runner->particles, sizeof *all);
    runner->type->get(runner->engine, field, all);
    for (long i = 0; i < handle->count; i++)
        memcpy(value[i], all[handle->particle[i]], sizeof *value);
    free(all);
}

/* The rigid motion that takes the particles from where they rest to where they are, most nearly. */
static void fit_pose(const BenchRunner *runner, SmHandle *handle)
{
    size_t count = (size_t)handle->count;
    double(*from)[3] = sm_alloc(count, sizeof *from), (*to)[3] = sm_alloc(count, sizeof *to);
    double A[9] = {0}, R[9], middle[2][3] = {{0}};
    static const double upright[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    read_held(runner, SM_REST, handle, from);
    read_held(runner, SM_POSITION, handle, to);
    for (size_t i = 0; i < count; i++)
        for (int d = 0; d < 3; d++) {
            middle[0][d] += from[i][d] / (double)count;
            middle[1][d] += to[i][d] / (double)count;
        }
    for (size_t i = 0; i < count; i++)
        for (int e = 0; e < 9; e++)
            A[e] += (to[i][e / 3] - middle[1][e / 3]) * (from[i][e % 3] - middle[0][e % 3]);
    sm_polar_robust(A, upright, 1e-6, R);
    for (int d = 0; d < 3; d++) {
        handle->pose[d][3] = middle[1][d];
        for (int e = 0; e < 3; e++) {
            handle->pose[d][e] = R[3 * d + e];
            handle->pose[d][3] -= R[3 * d + e] * middle[0][e];
        }
    }
    free(from);
    free(to);
}

/* Adds what the hand holds to the group, if it is of one of its bodies. */
static void take(BenchGroup *group, ViewHeld *held, const ViewHand *hand, const double followed[3],
                 char *taken)
{
    const BenchRunner *runner = &group->runner;
    for (long k = 0; k < group->body.instances; k++) {
        if (group->instance[k] != hand->instance) continue;
        long *particle = sm_alloc((size_t)runner->count, sizeof *particle);
        long count = choose(runner, k, hand, taken, particle);
        SmHandle *handle = &held->handle[held->count];
        *handle = (SmHandle){.count = count, .particle = particle};
        if (!count) {
            free(particle);
            continue;
        }
        fit_pose(runner, handle);
        for (int d = 0; d < 3; d++) held->start[held->count][d] = handle->pose[d][3] - followed[d];
        held->count++;
    }
}

/* Its place among what is held, or -1. */
static int place_of(const ViewHeld *held, int hand)
{
    for (int i = 0; i < held->count; i++)
        if (held->hand[i] == hand) return i;
    return -1;
}

static void mark(const SmHandle *handle, int count, char *taken)
{
    for (int i = 0; i < count; i++)
        for (long p = 0; p < handle[i].count; p++) taken[handle[i].particle[p]] = 1;
}

void view_grips_hold(ViewGrips *grips, BenchPlayback *play, const ViewHand *hand, bool anew)
{
    for (int i = 0; i < VIEW_HANDS; i++)
        if (!hand[i].holds) memset(grips->followed[i], 0, sizeof grips->followed[i]);
    for (int g = 0; g < grips->groups; g++) {
        BenchRunner *runner = &play->group[g].runner;
        ViewHeld *held = &grips->held[g];
        char *taken = sm_alloc((size_t)runner->particles, 1);
        mark(runner->bound, runner->bound_count - runner->grips, taken); /* the scene's handles */
        keep_used(held, hand, anew);
        mark(held->handle, held->count, taken);
        for (int i = 0; i < VIEW_HANDS; i++) {
            if (!hand[i].holds || place_of(held, i) >= 0) continue;
            held->hand[held->count] = i;
            take(&play->group[g], held, &hand[i], grips->followed[i], taken);
        }
        bench_runner_grip(runner, held->count, held->handle);
        free(taken);
    }
}

bool view_grips_are_lost(const ViewGrips *grips, const BenchPlayback *play)
{
    for (int g = 0; g < grips->groups; g++)
        if (play->group[g].runner.grips != grips->held[g].count) return true;
    return false;
}

void view_grips_follow(ViewGrips *grips, const ViewHand *hand, double share)
{
    for (int i = 0; i < VIEW_HANDS; i++)
        for (int d = 0; d < 3 && hand[i].holds; d++)
            grips->followed[i][d] += share * (hand[i].moved[d] - grips->followed[i][d]);
    for (int g = 0; g < grips->groups; g++) {
        ViewHeld *held = &grips->held[g];
        for (int i = 0; i < held->count; i++)
            for (int d = 0; d < 3; d++)
                held->handle[i].pose[d][3] = held->start[i][d] + grips->followed[held->hand[i]][d];
    }
}

bool view_grips_middle(const ViewGrips *grips, const BenchPlayback *play, int hand,
                       double middle[3])
{
    int g = 0, i = -1;
    for (; g < grips->groups; g++)
        if ((i = place_of(&grips->held[g], hand)) >= 0) break;
    if (i < 0) return false;
    const SmHandle *handle = &grips->held[g].handle[i];
    double(*x)[3] = sm_alloc((size_t)handle->count, sizeof *x);
    read_held(&play->group[g].runner, SM_POSITION, handle, x);
    for (int d = 0; d < 3; d++) {
        middle[d] = 0;
        for (long p = 0; p < handle->count; p++) middle[d] += x[p][d] / (double)handle->count;
    }
    free(x);
    return true;
}
