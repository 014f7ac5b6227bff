/* engine.c - FastLSM behind engine.h: one body, or many that share a lattice. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../lib/engine/boundary.h"
#include "../lib/simd/momentum.h"
#include "../lib/system/team.h"
#include "build.h"
#include "contacts.h"
#include "fastlsm.h"
#include "fracture.h"
#include "lattice/axis_order.h"
#include "match.h"
#include "step.h"

struct SmEngine {
    Lsm *lsm;
    long count; /* particles of one body */
    long bodies;
    int turn;             /* axis_order.h */
    int *inner;           /* [count] particle numbers in the lattice as turned; NULL: the same */
    double (*pose)[3][4]; /* [bodies] */
    SmHandles handles;
    LsmContacts *contacts; /* NULL: nothing collides */
    Momentum *momentum;
    real rounding;            /* of a body at rest (integrate.h) */
    SmPieces pieces;          /* of its particles, by the lattice's numbers; kept if it can break */
    long divided_at;          /* links broken when its pieces were found */
    long recentred, recentre; /* steps when origins moved last, and are to move next */
    double build_seconds;
};

/* The number in the lattice of a particle of any instance. */
static long inner_of(const SmEngine *e, long number)
{
    long p = number < e->count ? number : number % e->count;
    return e->inner ? e->inner[p] : p;
}

static void rest_position(const SmEngine *e, long number, double x0[3])
{
    const LsmLattice *l = &e->lsm->lattice;
    double rest[3];
    const int *at = l->coord[inner_of(e, number)];
    for (int d = 0; d < 3; d++) rest[(d + e->turn) % 3] = l->origin[d] + l->cell * at[d];
    sm_pose_apply((const double(*)[4])e->pose[number / e->count], rest, x0);
}

/* Where component d of a particle is in x, v or g, and the origin that goes with it. */
static long index_of(const SmEngine *e, long number, int d, const double **origin)
{
    long body = number / e->count;
    *origin = e->lsm->origin[body];
    return place_of(e->lsm, body, inner_of(e, number)) + d * SM_LANES;
}

static real *field_of(const SmEngine *e, SmField field)
{
    return field == SM_VELOCITY ? e->lsm->v : field == SM_GOAL ? e->lsm->g : e->lsm->x;
}

static void engine_goals(SmEngine *e)
{
    lsm_goals(e->lsm);
}

/* Numbers of NULL are 0 to count - 1. */
static void engine_get_some(SmEngine *e, SmField field, long count, const long *numbers,
                            double (*values)[3])
{
    if (field == SM_GOAL && !e->lsm->g) engine_goals(e);
    const real *from = field_of(e, field);
    double to_velocity = e->lsm->cell / e->lsm->params.h;
#pragma omp parallel for schedule(static) num_threads(sm_team_for(count))
    for (long i = 0; i < count; i++) {
        long number = numbers ? numbers[i] : i;
        if (field == SM_REST) rest_position(e, number, values[i]);
        for (int d = 0; d < 3 && field != SM_REST; d++) {
            const double *origin;
            double value = (double)from[index_of(e, number, d, &origin)];
            values[i][d] =
                field == SM_VELOCITY ? value * to_velocity : origin[d] + value * e->lsm->cell;
        }
    }
}

static void engine_get(SmEngine *e, SmField field, double (*values)[3])
{
    engine_get_some(e, field, e->bodies * e->count, NULL, values);
}

/* Of a particle: `values`, or where they are NULL its place at rest. */
static void value_of(const SmEngine *e, const double (*values)[3], long number, double value[3])
{
    if (values)
        memcpy(value, values[number], 3 * sizeof *value);
    else
        rest_position(e, number, value);
}

/* Single precision resolves positions best near zero: each body's origin goes to its middle. Summed
 * in the order of particles, whatever the threads. */
static void centre_on(SmEngine *e, const double (*position)[3])
{
    enum { AT_ONCE = 1 << 17 };
    long most = e->count < AT_ONCE ? e->count : AT_ONCE;
    double(*part)[3] = sm_alloc((size_t)most, sizeof *part);
    for (long body = 0; body < e->bodies; body++) {
        double sum[3] = {0, 0, 0};
        for (long first = 0; first < e->count; first += most) {
            long count = e->count - first < most ? e->count - first : most;
#pragma omp parallel for schedule(static) num_threads(sm_team_for(count))
            for (long i = 0; i < count; i++)
                value_of(e, position, body * e->count + first + i, part[i]);
            for (long i = 0; i < count; i++)
                for (int d = 0; d < 3; d++) sum[d] += part[i][d];
        }
        for (int d = 0; d < 3; d++) e->lsm->origin[body][d] = sum[d] / (double)e->count;
    }
    free(part);
}

static void shift_obstacles(Lsm *lsm)
{
    long lanes = (lsm->bodies + SM_LANES - 1) / SM_LANES * SM_LANES;
    for (long body = 0; body < lanes; body++)
        for (int d = 0; d < 3; d++) {
            const double *origin = lsm->origin[lsm->bodies > 1 ? body : 0];
            lsm->shift[body / SM_LANES][d][body % SM_LANES] =
                (real)((origin[d] - lsm->home[d]) / lsm->cell);
        }
}

/* Positions of NULL are those at rest. */
static void engine_set(SmEngine *e, SmField field, const double (*values)[3])
{
    assert(field == SM_POSITION || (field == SM_VELOCITY && values));
    momentum_forget(e->momentum);
    if (field == SM_POSITION) centre_on(e, values);
    if (field == SM_POSITION) shift_obstacles(e->lsm);
    real *to = field_of(e, field);
    double from_velocity = e->lsm->params.h / e->lsm->cell;
#pragma omp parallel for schedule(static) num_threads(sm_team_for(e->bodies * e->count))
    for (long number = 0; number < e->bodies * e->count; number++) {
        double value[3];
        value_of(e, values, number, value);
        for (int d = 0; d < 3; d++) {
            const double *origin;
            long at = index_of(e, number, d, &origin);
            to[at] = (real)(field == SM_VELOCITY ? value[d] * from_velocity
                                                 : (value[d] - origin[d]) / e->lsm->cell);
        }
    }
}

/* Where an instance's pose turns it, a tie goes to the rotation of the pose. */
static void turn_last(SmEngine *e, long body)
{
    const Lsm *lsm = e->lsm;
    bool one = e->bodies == 1;
    vec R[9];
    for (int i = 0; i < 9; i++) R[i] = lanes_set((real)e->pose[body][i / 3][(i % 3 + e->turn) % 3]);
    short turned[6 * SM_LANES];
    last_store(turned, R);
    long first = one ? 0 : lsm->layer_tile[body / SM_LANES],
         end = one ? lsm->tiles : lsm->layer_tile[body / SM_LANES + 1];
#pragma omp parallel for schedule(static) num_threads(sm_team_for((end - first) * SM_LANES))
    for (long tile = first; tile < end; tile++)
        for (int i = 0; i < 6 * SM_LANES; i++)
            if (one || i % SM_LANES == body % SM_LANES)
                lsm->last[tile * 6 * SM_LANES + i] = turned[i];
}

/* Lanes without a body copy the first one's rest shape, so that they stay finite and do nothing. */
static void fill_empty_lanes(SmEngine *e)
{
    const LsmLattice *l = &e->lsm->lattice;
    for (long body = e->bodies; e->bodies > 1 && body % SM_LANES; body++)
        for (long p = 0; p < e->count; p++)
            for (int d = 0; d < 3; d++)
                e->lsm->x[place_of(e->lsm, body, p) + d * SM_LANES] =
                    (real)(l->coord[p][d] - l->size[d] / 2);
}

/* Links p with those of its neighbours before it, from number `first` on. What hangs together by
 * the links of the particle before it along x is left out; where none is broken particles that are
 * linked lie in a cell, and one of each row is enough. */
static void link_particle(const Lsm *lsm, const int *number, long first, long p, SmPieces *pieces)
{
    const LsmLattice *l = &lsm->lattice;
    const int *c = l->coord[p];
    bool joins = l->link[p] >> (LSM_SELF - 1) & 1;
    if (joins) sm_pieces_link(pieces, number ? number[p - 1] : p - 1, number ? number[p] : p);
    uint32_t news = l->link[p] & (lsm->broken ? ~(uint32_t)0 : 02222) & 07777;
    if (joins) news &= ~(l->link[p - 1] >> 1 & 03333);
    for (; news; news &= news - 1) {
        int bit = __builtin_ctz(news);
        long q =
            lsm_lattice_find(l, c[0] + bit % 3 - 1, c[1] + bit / 3 % 3 - 1, c[2] + bit / 9 - 1);
        if (q >= first) sm_pieces_link(pieces, number ? number[q] : q, number ? number[p] : p);
    }
}

/* Links of the lattice make pieces of `pieces`, whose members are the particles by the numbers
 * given, or by the lattice's where they are NULL. Threads have consecutive planes each, which are
 * then linked; a piece's first member is the same whatever comes first. */
static void link_pieces(const Lsm *lsm, const int *number, SmPieces *pieces)
{
    const LsmLattice *l = &lsm->lattice;
    int shares = number ? 1 : sm_team_for(l->count), planes = l->size[2];
#pragma omp parallel for schedule(static) num_threads(shares)
    for (int s = 0; s < shares; s++) {
        long first = lsm_lattice_plane(l, planes * s / shares),
             end = lsm_lattice_plane(l, planes * (s + 1) / shares);
        for (long p = first; p < end; p++) link_particle(lsm, number, first, p, pieces);
    }
    for (int s = 1; s < shares; s++) {
        int z = planes * s / shares;
        for (long p = lsm_lattice_plane(l, z); p < lsm_lattice_plane(l, z + 1); p++)
            link_particle(lsm, number, 0, p, pieces);
    }
}

/* What keeps its momentum, now that as many links are broken. */
static void divide_momentum(SmEngine *e)
{
    Momentum *m = e->momentum;
    bool again = e->pieces.piece;
    if (again)
        sm_pieces_again(e->count, &e->pieces);
    else
        sm_pieces_init(e->count, &e->pieces);
    link_pieces(e->lsm, NULL, &e->pieces);
    sm_pieces_finish(&e->pieces, NULL, e->count);
    for (long slot = 0; slot < (m->abreast ? e->count : m->blocks * SM_LANES); slot++)
        m->label[slot] = -1;
#pragma omp parallel for schedule(static) num_threads(sm_team_for(e->count))
    for (long p = 0; p < e->count; p++) {
        long slot = e->lsm->slot[p];
        m->mass[slot] = (real)mass_of(e->lsm, p);
        m->label[slot] = e->pieces.piece[p];
    }
    momentum_divide(m, e->pieces.count);
    e->divided_at = e->lsm->broken;
    if (!(e->lsm->params.strain_limit > 0)) sm_pieces_free(&e->pieces);
}

static int longest(const LsmLattice *l)
{
    int most = l->size[0] > l->size[1] ? l->size[0] : l->size[1];
    return l->size[2] > most ? l->size[2] : most;
}

/* How often momenta are kept: the more particles there are, the better their roundings cancel, and
 * the more it costs when they do not stay in the cache. */
static int keep_steps(long particles)
{
    return particles <= 4096 ? 4 : particles <= 131072 ? 8 : 16;
}

static void start_at_rest(SmEngine *e)
{
    rest_position(e, 0, e->lsm->home);
    engine_set(e, SM_POSITION, NULL);
    for (long body = 0; body < e->bodies; body++) turn_last(e, body);
    fill_empty_lanes(e);
}

/* The body in the turned lattice, with masses in its numbering. */
static void build_turned(SmEngine *e, const SmVoxels *voxels, const SmEngineParams *params)
{
    SmEngineParams own = *params;
    SmVoxels turned = {0};
    double *mass = NULL;
    own.layout = lsm_axes_choose(voxels, params, SM_LANES, &e->turn);
    if (e->turn) {
        lsm_axes_voxels(voxels, e->turn, &turned);
        e->inner = lsm_axes_numbers(voxels, e->turn, &turned);
    }
    if (params->mass && e->turn) {
        own.mass = mass = sm_alloc((size_t)e->count, sizeof(double));
        for (long p = 0; p < e->count; p++) mass[e->inner[p]] = params->mass[p];
    }
    e->lsm = lsm_build(e->turn ? &turned : voxels, &own);
    sm_voxels_free(&turned);
    free(mass);
}

static SmCode engine_create(const SmVoxels *voxels, const SmEngineParams *params, SmEngine **engine,
                            SmError *error)
{
    double start = sm_now();
    if (params->instances > 1 && params->strain_limit > 0)
        return sm_fail(error, SM_INPUT,
                       "strain_limit: instances share one lattice and cannot break; "
                       "use one instance, or strain_limit 0");
    if (params->instances > 1 &&
        (params->summation == SM_SUM_NAIVE || params->polar == SM_POLAR_JACOBI))
        return sm_fail(error, SM_INPUT,
                       "instances are summed by bars and plates and matched by the fast "
                       "polar method only; use one instance, or the defaults");
    SmCode code = lsm_check(voxels, params, error);
    if (code) return code;
    int team = sm_team_enter(params->threads);
    SmEngine *e = sm_alloc(1, sizeof *e);
    e->bodies = params->instances > 1 ? params->instances : 1;
    e->count = voxels->particle_count;
    build_turned(e, voxels, params);
    Lsm *lsm = e->lsm;
    e->pose = sm_alloc((size_t)e->bodies, sizeof *e->pose);
    for (long body = 0; body < e->bodies; body++) sm_engine_pose(params, body, e->pose[body]);
    for (int d = 0; d < 3; d++)
        lsm->gravity[d] = (real)(params->gravity[d] * params->h * params->h / lsm->cell);
    start_at_rest(e);
    e->rounding = rounding_square(longest(&lsm->lattice), lsm->w);
    e->contacts = lsm_contacts_build(lsm, e->rounding);
    bool abreast = e->bodies > 1;
    e->momentum = momentum_build(abreast ? e->count : lsm->blocks, e->bodies, abreast,
                                 keep_steps(e->count), lsm->threads);
    lsm->obstacles.notes = &e->momentum->notes;
    divide_momentum(e);
    sm_team_leave(team);
    e->build_seconds = sm_now() - start;
    *engine = e;
    return SM_OK;
}

static void engine_destroy(SmEngine *e)
{
    if (!e) return;
    sm_handles_free(&e->handles);
    lsm_contacts_free(e->contacts);
    momentum_free(e->momentum);
    sm_pieces_free(&e->pieces);
    lsm_free(e->lsm);
    free(e->inner);
    free(e->pose);
    free(e);
}

/* Keeps where the held particles are before the step. */
static void note_held(SmEngine *e)
{
    long at = 0;
    const real *x = field_of(e, SM_POSITION);
    for (int i = 0; i < e->handles.count; i++)
        for (long k = 0; k < e->handles.handle[i].count; k++, at++)
            for (int d = 0; d < 3; d++) {
                const double *origin;
                double value = (double)x[index_of(e, e->handles.handle[i].particle[k], d, &origin)];
                e->handles.before[at][d] = origin[d] + value * e->lsm->cell;
            }
}

/* A held particle goes where its handle takes it, whatever the step made of it. */
static void move_held(SmEngine *e)
{
    long at = 0;
    real *x = field_of(e, SM_POSITION), *v = field_of(e, SM_VELOCITY);
    for (int i = 0; i < e->handles.count; i++)
        for (long k = 0; k < e->handles.handle[i].count; k++, at++) {
            double x0[3], to[3];
            long number = e->handles.handle[i].particle[k];
            MomentumChange change;
            rest_position(e, number, x0);
            sm_pose_apply((const double(*)[4])e->handles.handle[i].pose, x0, to);
            const double *origin;
            long index = index_of(e, number, 0, &origin);
            lsm_moved_from(e->lsm, index, &change);
            for (int d = 0; d < 3; d++, index += SM_LANES) {
                x[index] = (real)((to[d] - origin[d]) / e->lsm->cell);
                v[index] = (real)((to[d] - e->handles.before[at][d]) / e->lsm->cell);
                change.dx[d] = (double)x[index] - change.x[d];
                change.dv[d] = (double)v[index] - change.v[d];
            }
            momentum_pushed(e->momentum, number / e->count, e->lsm->slot[inner_of(e, number)],
                            &change, e->lsm->gravity, 1);
        }
}

static void begin_momentum(SmEngine *e)
{
    momentum_begin(e->momentum, 0, NULL, field_of(e, SM_POSITION), field_of(e, SM_VELOCITY));
    const real *fall = e->lsm->gravity;
    bool rests = momentum_rests(e->momentum) && fall[0] == 0 && fall[1] == 0 && fall[2] == 0;
    e->lsm->rounding = rests ? e->rounding : 0;
}

/* Of a body that has broken since the last time, pieces are found again, and keep what they have.
 */
static void keep_momentum(SmEngine *e)
{
    real *x = field_of(e, SM_POSITION), *v = field_of(e, SM_VELOCITY);
    if (!momentum_due(e->momentum)) return;
    if (e->lsm->broken != e->divided_at)
        divide_momentum(e);
    else
        momentum_keep(e->momentum, 0, NULL, x, v, e->lsm->gravity);
    momentum_kept(e->momentum);
}

/* The middle of each lane's body in whole cells, from blocks `first` to before `end`. */
static void find_middles(const SmEngine *e, long first, long end, double middle[SM_LANES][3])
{
    const int vectors = e->bodies > 1 ? 1 : MOMENTUM_WAYS / SM_LANES;
    vec sum[MOMENTUM_WAYS / SM_LANES][3] = {{{0}}};
    for (long block = first; block < end; block++)
        for (int d = 0; d < 3; d++)
            sum[(block - first) % vectors][d] += lanes_load(e->lsm->x + (block * 3 + d) * SM_LANES);
    for (int d = 0; d < 3; d++) {
        double all = 0;
        for (int way = 0; way < vectors * SM_LANES; way++)
            all += (double)sum[way / SM_LANES][d][way % SM_LANES];
        for (int lane = 0; lane < SM_LANES; lane++)
            middle[lane][d] =
                rint((e->bodies > 1 ? (double)sum[0][d][lane] : all) / (double)e->count);
    }
}

/* Moves x of blocks `first` to before `end`, and the origins of their bodies, from `body` on. */
static void move_origins(SmEngine *e, long body, long first, long end, double middle[SM_LANES][3])
{
    Lsm *lsm = e->lsm;
    real by[3][SM_LANES];
    for (int lane = 0; lane < SM_LANES; lane++)
        for (int d = 0; d < 3; d++) by[d][lane] = (real)middle[lane][d];
    for (int lane = 0; lane < (e->bodies > 1 ? SM_LANES : 1); lane++) {
        for (int d = 0; d < 3; d++) lsm->origin[body + lane][d] += middle[lane][d] * lsm->cell;
        if (body + lane < e->bodies) momentum_shift(e->momentum, body + lane, middle[lane]);
    }
    for (long block = first; block < end; block++) {
        const ParticleConst *k = &lsm->particle_const[lsm->block_const[block]];
        for (int d = 0; d < 3; d++) {
            real *x = lsm->x + (block * 3 + d) * SM_LANES;
            lanes_store(x, lanes_load(x) - lanes_and(lanes_load(by[d]), k->inverse_count > 0));
        }
    }
}

/* Origins go to bodies' middles, by whole cells, because single precision resolves positions best
 * near zero: the next time before one is likely to be some cells off again. One body does not move
 * by one cell. */
static void recentre(SmEngine *e)
{
    double far = 0, least = e->bodies > 1 ? 0 : 1;
    long groups = e->bodies > 1 ? e->lsm->layers : 1, blocks = e->lsm->blocks / groups;
    for (long group = 0; group < groups; group++) {
        double middle[SM_LANES][3], off = 0;
        find_middles(e, group * blocks, (group + 1) * blocks, middle);
        for (int i = 0; i < 3 * SM_LANES; i++) off = fmax(off, fabs(middle[i / 3][i % 3]));
        if (off > least)
            move_origins(e, group * SM_LANES, group * blocks, (group + 1) * blocks, middle);
        far = fmax(far, off);
    }
    shift_obstacles(e->lsm);
    long since = e->lsm->steps - e->recentred;
    e->recentred = e->lsm->steps;
    e->recentre = e->recentred + sm_recentre_after(since, far);
}

static void engine_step(SmEngine *e, SmLaps *laps)
{
    Lsm *lsm = e->lsm;
    note_held(e);
    begin_momentum(e);
    if (e->contacts) {
        lsm_contacts_before(e->contacts);
        sm_lap(laps, SM_OTHER);
    }
    lsm_step(lsm, laps);
    momentum_settle(e->momentum, 0, NULL, field_of(e, SM_POSITION), field_of(e, SM_VELOCITY),
                    lsm->gravity); /* before others change what obstacles have pushed */
    move_held(e);
    if (e->contacts) lsm_contacts_after(e->contacts, e->momentum);
    if (lsm->params.strain_limit > 0 && isfinite(lsm->params.strain_limit)) lsm_fracture(lsm);
    keep_momentum(e);
    if (lsm->steps >= e->recentre) recentre(e);
    sm_lap(laps, SM_OTHER);
}

static SmCode check_breakable(const SmEngine *e, const char *how, SmError *error)
{
    if (e->lsm->params.strain_limit > 0) return SM_OK;
    return sm_fail(error, SM_USAGE,
                   "%s: the body was not made to break; create it with a strain_limit, INFINITY if "
                   "it is to break in no other way",
                   how);
}

static SmCode engine_cut(SmEngine *e, const SmCut *cut, long first, SmError *error)
{
    SmCode code = check_breakable(e, "cut", error);
    if (!code) lsm_cut(e->lsm, e->turn, cut, first);
    return code;
}

static SmCode engine_break_links(SmEngine *e, long count, const int (*pair)[2], SmError *error)
{
    const LsmLattice *l = &e->lsm->lattice;
    SmCode code = check_breakable(e, "break_links", error);
    if (code || count == 0) return code;
    LsmLink *link = sm_alloc((size_t)count, sizeof *link);
    for (long n = 0; n < count; n++) {
        long p = inner_of(e, pair[n][0]), q = inner_of(e, pair[n][1]);
        int bit = LSM_SELF, stride[3] = {1, 3, 9};
        for (int d = 0; d < 3; d++) {
            int step = l->coord[q][d] - l->coord[p][d];
            assert(abs(step) <= 1);
            bit += stride[d] * step;
        }
        assert(bit != LSM_SELF);
        link[n] = (LsmLink){(int)p, bit};
    }
    lsm_break(e->lsm, count, link);
    free(link);
    return SM_OK;
}

/* The engine's number of each particle of the lattice; the caller frees. */
static int *outer_numbers(const SmEngine *e)
{
    int *outer = sm_alloc((size_t)e->count, sizeof *outer);
    for (long p = 0; p < e->count; p++) outer[inner_of(e, p)] = (int)p;
    return outer;
}

/* Contacts go over from the lattice's numbers and corners to the engine's. */
static long engine_contacts(SmEngine *e, double (*turn)[9], SmContact **contact)
{
    (void)turn;
    *contact = NULL;
    if (!e->contacts) return 0;
    long count = lsm_contacts_list(e->contacts, contact);
    int *outer = outer_numbers(e);
    for (SmContact *k = *contact; k < *contact + count; k++) {
        double weight[8];
        memcpy(weight, k->weight, sizeof weight);
        k->particle = k->particle / e->count * e->count + outer[k->particle % e->count];
        k->cell = k->cell / e->count * e->count + outer[k->cell % e->count];
        for (int c = 0; c < 8; c++) {
            int corner = 0;
            for (int d = 0; d < 3; d++) corner |= (c >> d & 1) << (d + e->turn) % 3;
            k->weight[corner] = weight[c];
        }
    }
    free(outer);
    return count;
}

/* Links go over from the lattice's numbers to the engine's. */
static void engine_pieces(SmEngine *e, SmPieces *pieces)
{
    int *outer = outer_numbers(e);
    sm_pieces_init(e->count, pieces);
    link_pieces(e->lsm, outer, pieces);
    sm_pieces_finish(pieces, NULL, e->count);
    free(outer);
}

static double kilograms(const SmEngine *e, long number)
{
    return e->lsm->mass_unit * mass_of(e->lsm, inner_of(e, number));
}

static void engine_push(SmEngine *e, long count, const long *particle, const double (*impulse)[3])
{
    real *v = field_of(e, SM_VELOCITY);
    for (long i = 0; i < count; i++) {
        assert(particle[i] >= 0 && particle[i] < e->bodies * e->count);
        double scale = e->lsm->params.h / (e->lsm->cell * kilograms(e, particle[i]));
        MomentumChange change;
        const double *origin;
        long index = index_of(e, particle[i], 0, &origin);
        lsm_moved_from(e->lsm, index, &change);
        for (int d = 0; d < 3; d++) {
            change.dv[d] = impulse[i][d] * scale;
            v[index + d * SM_LANES] += (real)change.dv[d];
        }
        long p = inner_of(e, particle[i]);
        momentum_pushed(e->momentum, particle[i] / e->count, e->lsm->slot[p], &change,
                        e->lsm->gravity, 0);
    }
}

static void copy_obstacles(Lsm *lsm, const SmBoundary *boundary)
{
    Obstacles *o = &lsm->obstacles;
    free(o->obstacle);
    o->count = boundary->obstacle_count;
    o->obstacle = sm_alloc((size_t)o->count, sizeof *o->obstacle);
    for (int i = 0; i < o->count; i++)
        o->obstacle[i] = obstacle_in_cells(&boundary->obstacle[i], lsm->home, lsm->cell);
    shift_obstacles(lsm);
}

static void fix_held(SmEngine *e)
{
    long at = 0, *held = sm_alloc((size_t)e->handles.particles, sizeof *held);
    for (int i = 0; i < e->handles.count; i++)
        for (long k = 0; k < e->handles.handle[i].count; k++) {
            long number = e->handles.handle[i].particle[k];
            held[at++] = number / e->count * e->count + inner_of(e, number);
        }
    lsm_contacts_fix(e->contacts, at, held);
    free(held);
}

static void engine_bound(SmEngine *e, const SmBoundary *boundary)
{
    if (boundary->obstacle_count) momentum_notes(e->momentum);
    sm_handles_set(&e->handles, boundary, e->bodies * e->count);
    if (e->contacts) fix_held(e);
    copy_obstacles(e->lsm, boundary);
}

static void engine_masses(SmEngine *e, double *mass)
{
    for (long p = 0; p < e->count; p++) mass[p] = kilograms(e, p);
}

static void engine_count(SmEngine *e, SmCounts *counts)
{
    const Lsm *lsm = e->lsm;
    double sweeps = 0;
    for (int l = 0; l < lsm->layers; l++) sweeps += lsm->sweeps[l];
    *counts = (SmCounts){
        .particles = e->bodies * e->count,
        .regions = lsm_unique(e->lsm),
        .links = lsm_lattice_links(&lsm->lattice),
        .broken = lsm->broken,
        .contacts = e->contacts ? lsm_contacts_count(e->contacts) : 0,
        .build_seconds = e->build_seconds,
        .jacobi_sweeps = sweeps / (double)(e->count - lsm->copies),
    };
}

typedef struct {
    long number;
    int row; /* region.h */
} Member;

static int compare_members(const void *a, const void *b)
{
    const Member *x = a, *y = b;
    return (x->number > y->number) - (x->number < y->number);
}

/* A region's members by rising number; the caller frees. */
static Member *find_members(const SmEngine *e, long number, long *count)
{
    const Lsm *lsm = e->lsm;
    long centre = inner_of(e, number), first = number / e->count * e->count;
    const int *c = lsm->lattice.coord[centre];
    LsmRow rows[LSM_MAX_SIDE * LSM_MAX_SIDE];
    long most = lsm_region_rows(&lsm->lattice, &lsm->interior, centre, rows);
    int *outer = outer_numbers(e);
    Member *all = sm_alloc((size_t)most, sizeof *all);
    *count = 0;
    for (int row = 0; row < lsm->side * lsm->side; row++)
        for (LsmRow rest = rows[row]; rest; rest &= rest - 1) {
            long p =
                lsm_lattice_find(&lsm->lattice, c[0] - lsm->w + lsm_row_first(rest),
                                 c[1] - lsm->w + row % lsm->side, c[2] - lsm->w + row / lsm->side);
            all[(*count)++] = (Member){first + outer[p], row};
        }
    qsort(all, (size_t)*count, sizeof *all, compare_members);
    free(outer);
    return all;
}

static long engine_region(SmEngine *e, long number, long *member, long room)
{
    long count;
    Member *all = find_members(e, number, &count);
    for (long i = 0; i < count && i < room; i++) member[i] = all[i].number;
    free(all);
    return count;
}

/* A bar is a row of the region's window, a plate a plane of such (subsum_lists.h). */
static long engine_bars(SmEngine *e, long number, int *bar, int *plate)
{
    int side = e->lsm->side, bars = 0, plates = 0, last = -1;
    int name[LSM_MAX_SIDE * LSM_MAX_SIDE], of[LSM_MAX_SIDE * LSM_MAX_SIDE] = {0};
    long count;
    if (e->lsm->params.summation == SM_SUM_NAIVE) return 0;
    Member *all = find_members(e, number, &count);
    for (long i = 0; i < count; i++) of[all[i].row] = 1;
    for (int row = 0; row < side * side; row++) {
        if (!of[row]) continue;
        if (row / side != last) plates++;
        last = row / side;
        name[row] = bars++;
        of[row] = plates - 1;
    }
    for (long i = 0; i < count; i++) bar[i] = name[all[i].row], plate[i] = of[all[i].row];
    free(all);
    return bars;
}

static long engine_links(SmEngine *e, int (*link)[2], long room)
{
    const LsmLattice *l = &e->lsm->lattice;
    long all = lsm_lattice_links(l), count = 0;
    int *outer = room > 0 ? outer_numbers(e) : NULL;
    for (long p = 0; p < l->count && count < room; p++)
        for (uint32_t rest = l->link[p] >> (LSM_SELF + 1); rest && count < room; rest &= rest - 1) {
            int bit = LSM_SELF + 1 + __builtin_ctz(rest), a = outer[p];
            int b = outer[lsm_lattice_find(l, l->coord[p][0] + bit % 3 - 1,
                                           l->coord[p][1] + bit / 3 % 3 - 1,
                                           l->coord[p][2] + bit / 9 - 1)];
            link[count][0] = a < b ? a : b;
            link[count++][1] = a < b ? b : a;
        }
    free(outer);
    return all;
}

const SmEngineType SM_NAME(fastlsm_engine) = {
    .name = "fastlsm",
    .precision = SM_REAL_BITS == 32 ? "single" : "double",
    .by_cells = true,
    .create = engine_create,
    .destroy = engine_destroy,
    .step = engine_step,
    .goals = engine_goals,
    .get = engine_get,
    .get_some = engine_get_some,
    .set = engine_set,
    .push = engine_push,
    .bound = engine_bound,
    .masses = engine_masses,
    .count = engine_count,
    .cut = engine_cut,
    .break_links = engine_break_links,
    .contacts = engine_contacts,
    .pieces = engine_pieces,
    .region = engine_region,
    .bars = engine_bars,
    .links = engine_links,
};
