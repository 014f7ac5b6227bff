#include "window_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "step_check.h"

/* A window of a block: particles from `low` on. */
typedef struct {
    int low[3], size[3];
    long count, middle; /* the number of the particle that it is for */
    long *number;       /* [count] in the block */
} Window;

static int draw(unsigned *seed, int count)
{
    return (int)(rand_r(seed) / (RAND_MAX + 1.0) * count);
}

static void open_window(const BenchWindows *w, bool inside, unsigned *seed, Window *window)
{
    int at[3], reach = 5 * w->params->w;
    *window = (Window){.count = 1};
    for (int d = 0; d < 3; d++) {
        int n = w->size[d], face = draw(seed, 3);
        at[d] = inside || face == 0 ? draw(seed, n) : face == 1 ? 0 : n - 1;
        window->low[d] = at[d] > reach ? at[d] - reach : 0;
        window->size[d] = (at[d] + reach < n ? at[d] + reach + 1 : n) - window->low[d];
        window->count *= window->size[d];
    }
    window->number = sm_alloc((size_t)window->count, sizeof *window->number);
    for (long i = 0; i < window->count; i++) {
        long place[3] = {i % window->size[0], i / window->size[0] % window->size[1],
                         i / window->size[0] / window->size[1]};
        for (int d = 0; d < 3; d++) place[d] += window->low[d];
        window->number[i] = place[0] + w->size[0] * (place[1] + w->size[1] * place[2]);
        if (place[0] == at[0] && place[1] == at[1] && place[2] == at[2]) window->middle = i;
    }
}

static void push_window(const BenchWindows *w, const Window *window, unsigned *seed)
{
    double(*impulse)[3] = sm_alloc((size_t)window->count, sizeof *impulse);
    for (long i = 0; i < window->count; i++)
        for (int d = 0; d < 3; d++)
            impulse[i][d] = (rand_r(seed) / (double)RAND_MAX - 0.5) * 0.2 / w->params->h;
    w->type->push(w->engine, window->count, window->number, (const double(*)[3])impulse);
    free(impulse);
}

/* What one particle's goal, and position and velocity after a step are by brute force, and how far
 * off rounding may take the step, in cells. */
typedef struct {
    double goal[3], position[3], velocity[3], allowed;
} State;

/* A window by itself, and what the engine has there. */
typedef struct {
    RefRegions regions;
    double (*rest)[3], (*x)[3], (*v)[3], (*g)[3], (*u)[3], (*origin)[3];
    double *mass, *weight; /* 1, and shared among the regions that a particle is in */
} Twin;

static void open_twin(const BenchWindows *w, const Window *window, Twin *t)
{
    SmVoxels voxels;
    size_t n = (size_t)window->count;
    double(**field[])[3] = {&t->rest, &t->x, &t->v, &t->g, &t->u, &t->origin};
    for (int i = 0; i < 6; i++) *field[i] = sm_alloc(n, sizeof **field[i]);
    t->mass = sm_alloc(n, sizeof *t->mass);
    t->weight = sm_alloc(n, sizeof *t->weight);
    sm_voxels_block(&voxels, window->size[0] - 1, window->size[1] - 1, window->size[2] - 1, 1);
    for (int d = 0; d < 3; d++) voxels.origin[d] = window->low[d];
    sm_voxels_rest(&voxels, t->rest);
    ref_regions_build(&voxels, w->params->w, NULL, 0, &t->regions);
    sm_voxels_free(&voxels);
    for (size_t p = 0; p < n; p++) {
        t->mass[p] = 1;
        t->weight[p] = 1 / (double)(t->regions.start[p + 1] - t->regions.start[p]);
        for (int d = 0; d < 3; d++) t->origin[p][d] = (w->size[d] - 1) / 2.0;
    }
    w->type->get_some(w->engine, SM_POSITION, window->count, window->number, t->x);
    w->type->get_some(w->engine, SM_VELOCITY, window->count, window->number, t->v);
}

static void close_twin(Twin *t)
{
    ref_regions_free(&t->regions);
    sm_free_all(t->rest, t->x, t->v, t->g, t->u, t->origin, t->mass, t->weight);
}

/* The share of the largest velocity by which rounding may change the middle's damping: that of the
 * worst of its regions, and at most all of it, both ways. */
static double damping_rounding(const Twin *t, const RefSums *sums, long middle)
{
    double worst = 0;
    for (long i = t->regions.start[middle]; i < t->regions.start[middle + 1]; i++) {
        RefCondition found;
        long r = t->regions.member[i]; /* as it is in this one's region, so is this one in its */
        ref_condition(&t->regions, t->weight, (const double(*)[3])t->rest, (const double(*)[3])t->x,
                      r, 0, &found);
        worst = fmax(worst, bench_check_rounding(&found, sums, r));
    }
    return fmin(worst, 2);
}

/* Goals (eq. 12), velocities (eqs. 1 and 14) and positions (eq. 2). */
static void step_twin(const BenchWindows *w, const Window *window, State *state)
{
    Twin t;
    long middle = window->middle;
    double h = w->params->h, k = w->params->damping, fastest = 0;
    double epsilon = bench_check_epsilon(w->type->precision);
    open_twin(w, window, &t);
    const RefSums sums = {(const double(*)[3])t.origin, epsilon, epsilon > 1e-10 ? 1e-5 : 1e-10};
    ref_goals(&t.regions, (const double(*)[3])t.rest, t.mass, (const double(*)[3])t.x, t.g);
    for (long p = 0; p < window->count; p++) {
        for (int d = 0; d < 3; d++) t.v[p][d] += (t.g[p][d] - t.x[p][d]) / h;
        fastest = fmax(fastest, h * hypot(hypot(t.v[p][0], t.v[p][1]), t.v[p][2]));
    }
    ref_rigid_velocity(&t.regions, t.mass, (const double(*)[3])t.x, (const double(*)[3])t.v, &sums,
                       t.u);
    for (int d = 0; d < 3; d++) {
        state->goal[d] = t.g[middle][d];
        state->velocity[d] = t.v[middle][d] + k * (t.u[middle][d] - t.v[middle][d]);
        state->position[d] = t.x[middle][d] + h * state->velocity[d];
    }
    state->allowed = fastest * k * damping_rounding(&t, &sums, middle);
    close_twin(&t);
}

static double distance_to(const BenchWindows *w, const Window *window, SmField field,
                          const double wanted[3])
{
    double value[1][3], *a = value[0];
    w->type->get_some(w->engine, field, 1, &window->number[window->middle], value);
    return hypot(hypot(a[0] - wanted[0], a[1] - wanted[1]), a[2] - wanted[2]);
}

/* What goals may be off: check.h; of a body so large that rounding of its outermost coordinates
 * comes near that, four times this. */
static double limit_of(const BenchWindows *w)
{
    int longest = w->size[0] > w->size[1] ? w->size[0] : w->size[1];
    if (w->size[2] > longest) longest = w->size[2];
    double rounding = bench_check_epsilon(w->type->precision) * longest / 2;
    return fmax(bench_check_tolerance(w->type->precision), 4 * rounding);
}

/* The larger of two, of which NaN is infinite. */
static double worse(double worst, double off)
{
    return off <= worst ? worst : isfinite(off) ? off : INFINITY;
}

static void compare(const BenchWindows *w, const Window *window, State *state,
                    BenchWindowsFound *found)
{
    w->type->step(w->engine, NULL);
    for (int i = 0; i < w->samples; i++) step_twin(w, &window[i], &state[i]);
    w->type->goals(w->engine);
    for (int i = 0; i < w->samples; i++)
        found->goal = worse(found->goal, distance_to(w, &window[i], SM_GOAL, state[i].goal));
    w->type->step(w->engine, NULL);
    for (int i = 0; i < w->samples; i++) {
        double allowed = found->limit + state[i].allowed;
        double x = distance_to(w, &window[i], SM_POSITION, state[i].position),
               v = w->params->h * distance_to(w, &window[i], SM_VELOCITY, state[i].velocity);
        found->step = worse(found->step, fmax(x, v));
        found->share = worse(found->share, fmax(x, v) / allowed);
    }
}

bool bench_windows_check(const BenchWindows *w, BenchWindowsFound *found, size_t room, char *reason)
{
    unsigned seed = w->seed;
    size_t samples = (size_t)w->samples;
    Window *window = sm_alloc(samples, sizeof *window);
    State *state = sm_alloc(samples, sizeof *state);
    *found = (BenchWindowsFound){.limit = limit_of(w)};
    for (int i = 0; i < w->samples; i++) {
        open_window(w, i % 2, &seed, &window[i]);
        push_window(w, &window[i], &seed);
    }
    compare(w, window, state, found);
    for (int i = 0; i < w->samples; i++) free(window[i].number);
    free(window);
    free(state);
    if (found->goal <= found->limit && found->share <= 1) return true;
    snprintf(reason, room,
             "of %d of its particles goals are up to %.2g cells off brute force, at most %.2g, and "
             "a step up to %.2g, %.2g times what rounding allows",
             w->samples, found->goal, found->limit, found->step, found->share);
    return false;
}
