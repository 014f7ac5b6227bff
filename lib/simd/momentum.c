#include "momentum.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../error.h"
#include "../vector.h"

/* What is summed of every piece, with r = x - about: m r, m v, m r X v, the upper half of m r r^T,
 * and m v^2. */
enum { MASS_R, MASS_V = 3, MOMENT = 6, SPREAD = 9, ENERGY = 15, SUMS = MOMENTUM_SUMS };

/* Of a vector for every SM_LANES ways; abreast each lane has its own body. Runs are cut after
 * RUN_LENGTH terms of each way, which are summed in `real`; RUNS_AT_ONCE are summed before they are
 * added up in double precision. Rounding is the same whatever the threads. */
enum { VECTORS = MOMENTUM_WAYS / SM_LANES, RUN_LENGTH = 32, RUNS_AT_ONCE = 64 };

/* What is over is expected to be over again: the share of it that the expectation gains each time,
 * and the share of the expectation that stays. */
static const double LEARNT = 0.125, LASTING = 0.97;

/* The share of its spread by which a body may be changed from outside between two times. */
static const double STRUCK = 0.25;

typedef real RunSum[MOMENTUM_WAYS][SUMS];

Momentum *momentum_build(long blocks, long bodies, bool abreast, int every, int threads)
{
    Momentum *m = sm_alloc(1, sizeof *m);
    *m = (Momentum){
        .bodies = bodies, .abreast = abreast, .every = every, .threads = threads, .age = 1};
    m->sum = sm_alloc(RUNS_AT_ONCE, sizeof(RunSum));
    momentum_room(m, blocks);
    return m;
}

static long slots_of(const Momentum *m)
{
    return m->abreast ? m->blocks : m->blocks * SM_LANES;
}

static long all_blocks(const Momentum *m)
{
    return m->abreast ? m->blocks * ((m->bodies + SM_LANES - 1) / SM_LANES) : m->blocks;
}

/* Of an array that is there, or not yet: zero then. */
static void *room(void *array, size_t count, size_t size)
{
    return array ? sm_realloc(array, count, size) : sm_alloc(count, size);
}

void momentum_room(Momentum *m, long blocks)
{
    m->blocks = blocks;
    size_t slots = (size_t)slots_of(m) + 1;
    bool again = m->mass;
    m->mass = room(m->mass, slots, sizeof *m->mass);
    m->label = room(m->label, slots, sizeof *m->label);
    m->run = room(m->run, (size_t)all_blocks(m) + 1, sizeof *m->run);
    if (m->frame) m->frame = room(m->frame, slots, sizeof *m->frame);
    if (again) memset(m->mass, 0, slots * sizeof *m->mass);
    if (m->frame) memset(m->frame, 0, slots * sizeof *m->frame);
    m->runs = 0;
    if (m->notes.noted) momentum_notes(m);
    momentum_forget(m);
}

/* Of all bodies, and one more. */
static size_t noted_blocks(const Momentum *m)
{
    return (size_t)(m->abreast ? all_blocks(m) : m->bodies * m->blocks) + 1;
}

void momentum_notes(Momentum *m)
{
    size_t blocks = noted_blocks(m);
    m->notes.noted = room(m->notes.noted, blocks, sizeof *m->notes.noted);
    m->notes.before = room(m->notes.before, blocks * 6 * SM_LANES, sizeof *m->notes.before);
    memset(m->notes.noted, 0, blocks * sizeof *m->notes.noted);
}

void momentum_frames(Momentum *m)
{
    if (!m->frame) m->frame = sm_alloc((size_t)slots_of(m) + 1, sizeof *m->frame);
}

/* A lane's piece, by its place in m->piece less that of the body, and frame. */
typedef struct {
    long piece, frame;
} Lane;

static void lanes_of(const Momentum *m, long block, Lane lane[SM_LANES])
{
    for (int l = 0; l < SM_LANES; l++) {
        long slot = m->abreast ? block % m->blocks : block * SM_LANES + l, body = 0;
        if (m->abreast) body = block / m->blocks * SM_LANES + l;
        lane[l] = (Lane){body < m->bodies ? body * m->pieces + m->label[slot] : -1,
                         m->frame ? m->frame[slot] : 0};
    }
}

/* An empty slot goes with one beside it, so that runs are long. */
static void label_empty(Momentum *m)
{
    long slots = slots_of(m), first = 0;
    while (first < slots - 1 && m->label[first] < 0) first++;
    for (long slot = 0; slot < slots; slot++) {
        if (m->label[slot] >= 0) continue;
        long beside = slot < first ? first : slot - 1;
        m->label[slot] = m->label[beside];
        if (m->frame) m->frame[slot] = m->frame[beside];
    }
}

static bool all_the_same(const Lane lane[SM_LANES])
{
    for (int l = 1; l < SM_LANES; l++)
        if (lane[l].piece != lane[0].piece || lane[l].frame != lane[0].frame) return false;
    return true;
}

/* Has a block's SM_LANES entries what the block before has? */
static bool repeats(const int *of, long block)
{
    const int *here = of + block * SM_LANES;
    return !memcmp(here, here - SM_LANES, SM_LANES * sizeof *here);
}

/* Are its lanes of the pieces and frames of those of the block before? Abreast labels are of all
 * lanes, and only the last group of bodies has fewer. */
static bool like_before(const Momentum *m, long block)
{
    Lane here[SM_LANES], before[SM_LANES];
    if (!m->abreast) return repeats(m->label, block) && (!m->frame || repeats(m->frame, block));
    lanes_of(m, block, here);
    lanes_of(m, block - 1, before);
    return !memcmp(here, before, sizeof here);
}

/* What pieces weigh: added up in the order of slots. */
static void add_masses(Momentum *m)
{
    for (long first = 0, end; first < slots_of(m); first = end) {
        int label = m->label[first];
        double *mass = &m->piece[label].mass, sum = *mass;
        for (end = first; end < slots_of(m) && m->label[end] == label; end++)
            sum += (double)m->mass[end];
        *mass = sum;
    }
    for (long body = 1; body < m->bodies; body++)
        for (long p = 0; p < m->pieces; p++) m->piece[body * m->pieces + p].mass = m->piece[p].mass;
}

void momentum_divide(Momentum *m, long pieces)
{
    Lane here[SM_LANES];
    long most = (m->abreast ? 1 : VECTORS) * RUN_LENGTH;
    label_empty(m);
    m->pieces = pieces;
    if (m->bodies * pieces > m->piece_room) {
        m->piece_room = m->bodies * pieces;
        m->piece = sm_realloc(m->piece, (size_t)m->piece_room, sizeof *m->piece);
    }
    memset(m->piece, 0, (size_t)(m->bodies * pieces) * sizeof *m->piece);
    add_masses(m);
    m->runs = 0;
    for (long block = 0; block < all_blocks(m); block++) {
        bool same = block > 0 && like_before(m, block);
        if (!same || block - m->run[m->runs - 1].first == most) {
            lanes_of(m, block, here);
            m->run[m->runs++] = (MomentumRun){block, all_the_same(here) ? here[0].piece : -1};
        }
    }
    m->run[m->runs].first = all_blocks(m);
    momentum_forget(m);
}

void momentum_forget(Momentum *m)
{
    if (!m) return;
    m->age++;
    m->steps = 0;
    m->begun = m->moving = false;
}

static bool is_known(const Momentum *m, const MomentumPiece *p)
{
    return p->since == m->age;
}

/* What a run's lanes are measured about and have too much. */
typedef struct {
    vec about[3], shift[3], push[3], turn[3];
} Frame;

/* Of one piece as numbers: [about, shift, push, turn][d]. */
static void frame_values(const Momentum *m, const MomentumPiece *p, const double origin[3],
                         real value[4][3])
{
    bool known = is_known(m, p);
    for (int d = 0; d < 3; d++) {
        value[0][d] = (real)(p->about[d] - origin[d]);
        value[1][d] = known ? (real)p->shift[d] : 0;
        value[2][d] = known ? (real)p->push[d] : 0;
        value[3][d] = known ? (real)p->turn[d] : 0;
    }
}

static const double *origin_of(const double (*origin)[3], const Lane *lane)
{
    static const double zero[3];
    return origin ? origin[lane->frame] : zero;
}

/* Most runs are of one piece. */
static void frame_of(const Momentum *m, const MomentumPiece *piece, const double (*origin)[3],
                     long run, Frame *frame)
{
    vec *part[4] = {frame->about, frame->shift, frame->push, frame->turn};
    real value[4][3], lanes[4][3][SM_LANES] = {0};
    Lane lane[SM_LANES];
    long same = m->run[run].piece;
    lanes_of(m, m->run[run].first, lane);
    if (same >= 0) frame_values(m, &piece[same], origin_of(origin, lane), value);
    for (int l = 0; l < SM_LANES && same < 0; l++) {
        if (lane[l].piece < 0) continue;
        frame_values(m, &piece[lane[l].piece], origin_of(origin, &lane[l]), value);
        for (int i = 0; i < 12; i++) lanes[i / 3][i % 3][l] = value[i / 3][i % 3];
    }
    for (int i = 0; i < 12; i++)
        part[i / 3][i % 3] =
            same >= 0 ? lanes_set(value[i / 3][i % 3]) : lanes_load(lanes[i / 3][i % 3]);
}

/* Corrects a block, and adds what it has to `sum`. */
SM_INLINE void keep_block(const Frame *f, vec mass, real *x, real *v, vec sum[SUMS])
{
    vec r[3], u[3];
    load3(x, r);
    load3(v, u);
    for (int d = 0; d < 3; d++) r[d] -= lanes_and(f->shift[d], mass > 0);
    store3(x, r);
    for (int d = 0; d < 3; d++) r[d] -= f->about[d];
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, g = (d + 2) % 3;
        vec over = f->push[d] + (f->turn[e] * r[g] - f->turn[g] * r[e]);
        u[d] -= lanes_and(over, mass > 0);
    }
    store3(v, u);
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, g = (d + 2) % 3;
        vec here = mass * r[d], next = mass * r[e];
        sum[MASS_R + d] += here;
        sum[MASS_V + d] += mass * u[d];
        sum[MOMENT + d] += next * u[g] - mass * r[g] * u[e];
        sum[SPREAD + d] += here * r[d];
        sum[SPREAD + 3 + d] += next * r[g];
        sum[ENERGY] += mass * u[d] * u[d];
    }
}

static void keep_run(const Momentum *m, const MomentumPiece *piece, const double (*origin)[3],
                     long run, real *x, real *v, RunSum total)
{
    Frame frame;
    vec sum[VECTORS][SUMS] = {{{0}}};
    frame_of(m, piece, origin, run, &frame);
    for (long block = m->run[run].first; block < m->run[run + 1].first; block++) {
        vec mass = m->abreast ? lanes_set(m->mass[block % m->blocks])
                              : lanes_load(m->mass + block * SM_LANES);
        keep_block(&frame, mass, x + block * 3 * SM_LANES, v + block * 3 * SM_LANES,
                   sum[m->abreast ? 0 : block % VECTORS]);
    }
    for (int i = 0; i < VECTORS; i++)
        for (int part = 0; part < SUMS; part += SM_LANES) { /* to rows of lanes */
            lanes_interleave(sum[i] + part, SM_LANES);
            for (int lane = 0; lane < SM_LANES; lane++)
                lanes_store(total[i * SM_LANES + lane] + part, sum[i][part + lane]);
        }
}

/* omega of J omega = L, J the inertia of a spread S. What lies within a tenth of a cell of a line,
 * or nearly, has no such inertia about it, and rounding does not tell how it turns there: that part
 * of L, of a point all of it, goes to `lost`, and omega leaves it as it is.
 *
 * omega is used `steps` later, when the piece of spin `spin` has turned. Of a long piece that turns
 * fast J is another one by then: omega about its old axis would change the spin by up to the ratio
 * of its inertias too much, and the next correction by that ratio once more. L / trace S never is
 * too much, since no inertia exceeds the trace. False: it is that.
 *
 * Nor is what a piece that swells and shrinks has when it is small: a body squashed so far that it
 * springs back within a step has many times that inertia one step later, and would be corrected as
 * many times too much, in every swing again. So its widest trace lately counts. */
static bool angular_velocity(const double S[6], double mass, const double spin[3], double steps,
                             double widest, const double L[3], double omega[3], double lost[3])
{
    double trace = S[0] + S[1] + S[2], C[3][3], axis[3], det = 0, minors = 0;
    double full[3][3] = {{S[0], S[5], S[4]}, {S[5], S[1], S[3]}, {S[4], S[3], S[2]}}, J[3][3];
    int most = S[0] > S[1] ? (S[0] > S[2] ? 0 : 2) : (S[1] > S[2] ? 1 : 2);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) J[i][k] = (i == k ? trace : 0) - full[i][k];
    for (int i = 0; i < 3; i++) sm_cross(J[(i + 1) % 3], J[(i + 2) % 3], C[i]);
    for (int i = 0; i < 3; i++) det += J[0][i] * C[0][i];
    for (int i = 0; i < 3; i++) minors += C[i][i]; /* det / minors: at most the least inertia */
    bool solid = minors > 0 && det > 0.01 * mass * minors, point = !(trace > 0.01 * mass);
    double length = point ? 1 : sqrt(sm_dot(full[most], full[most])), now[3];
    for (int i = 0; i < 3; i++) now[i] = sm_dot(C[i], spin);
    bool swells = widest > 2 * trace;
    bool lasts =
        !swells && (!solid || 2 * steps * sqrt(sm_dot(now, now)) * trace * minors <= det * det);
    double bound = swells ? widest : trace;
    for (int i = 0; i < 3; i++) axis[i] = full[most][i] / length;
    for (int i = 0; i < 3; i++) {
        lost[i] = solid ? 0 : point ? L[i] : sm_dot(axis, L) * axis[i];
        omega[i] = point ? 0 : solid && lasts ? sm_dot(C[i], L) / det : (L[i] - lost[i]) / bound;
    }
    return lasts;
}

/* A piece's momenta: its centre, the velocity of that, and what turns about it. */
typedef struct {
    double place[3], velocity[3], spin[3], spread[6];
} Momenta;

static void momenta_of(const MomentumPiece *p, Momenta *is)
{
    const double *L = p->sum + MOMENT, *V = p->sum + MASS_V;
    double off[3], inverse = 1 / p->mass;
    for (int d = 0; d < 3; d++) {
        off[d] = p->sum[MASS_R + d] * inverse;
        is->velocity[d] = V[d] * inverse;
        is->place[d] = p->about[d] + off[d];
    }
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        is->spin[d] = L[d] - (off[e] * V[f] - off[f] * V[e]);
        is->spread[d] = p->sum[SPREAD + d] - p->mass * off[d] * off[d];
        is->spread[3 + d] = p->sum[SPREAD + 3 + d] - p->mass * off[e] * off[f];
    }
}

/* Adds up a run's sums by pieces. */
static void add_run(const Momentum *m, long run, RunSum total, MomentumPiece *piece)
{
    Lane of[SM_LANES];
    long same = m->run[run].piece;
    double all[SUMS] = {0};
    if (same < 0) lanes_of(m, m->run[run].first, of);
    for (int way = 0; way < MOMENTUM_WAYS; way++) {
        const Lane *lane = of + way % SM_LANES;
        if (same < 0 && lane->piece < 0) continue;
        double *sum = same >= 0 ? all : piece[lane->piece].sum;
        for (int i = 0; i < SUMS; i++) sum[i] += (double)total[way][i];
    }
    for (int i = 0; i < SUMS && same >= 0; i++) piece[same].sum[i] += all[i];
}

/* Sums of all pieces of a body, corrected where they are known; the first of them. */
static MomentumPiece *measure(Momentum *m, long body, const double (*origin)[3], real *x, real *v,
                              long *count)
{
    *count = m->abreast ? m->bodies * m->pieces : m->pieces;
    MomentumPiece *piece = m->piece + (m->abreast ? 0 : body * *count);
    RunSum *total = (RunSum *)m->sum;
    for (long p = 0; p < *count; p++) memset(piece[p].sum, 0, sizeof piece->sum);
    bool alone = m->threads == 1 || m->runs <= 4; /* a team of one costs more than it measures */
    for (long first = 0; first < m->runs; first += RUNS_AT_ONCE) {
        long end = m->runs - first < RUNS_AT_ONCE ? m->runs : first + RUNS_AT_ONCE;
        for (long r = first; alone && r < end; r++)
            keep_run(m, piece, origin, r, x, v, total[r - first]);
        if (!alone) {
#pragma omp parallel for schedule(static) num_threads(m->threads)
            for (long r = first; r < end; r++)
                keep_run(m, piece, origin, r, x, v, total[r - first]);
        }
        for (long r = first; r < end; r++) add_run(m, r, total[r - first], piece);
    }
    return piece;
}

void momentum_begin(Momentum *m, long body, const double (*origin)[3], real *x, real *v)
{
    long count;
    Momenta is;
    if (is_known(m, m->piece + body * m->pieces)) return;
    m->steps = 0; /* contacts may have ended in the last step, which was counted */
    for (int time = 0; time < 2; time++) { /* about anywhere, then about the centre */
        MomentumPiece *piece = measure(m, body, origin, x, v, &count);
        for (MomentumPiece *p = piece; p < piece + count; p++) {
            momenta_of(p, &is);
            for (int d = 0; d < 3; d++) {
                p->about[d] = rint(is.place[d]);
                p->place[d] = is.place[d];
                p->velocity[d] = is.velocity[d];
                p->spin[d] = is.spin[d];
                p->shift[d] = p->push[d] = p->turn[d] = p->drift[d] = p->twist[d] = 0;
            }
            p->widest = is.spread[0] + is.spread[1] + is.spread[2];
            p->struck = 0;
            p->since = time > 0 ? m->age : 0;
            if (!(p->sum[ENERGY] == 0)) m->moving = true;
        }
    }
    m->begun = true;
}

/* A piece's sums have changed by p->sum, `n` steps after it was measured. */
static void change_piece(MomentumPiece *p, double n, const real gravity[3])
{
    double off[3], velocity[3], by[3], faster[3], moment[2][3];
    for (int d = 0; d < 3; d++) {
        double fall = (double)gravity[d];
        by[d] = p->sum[MASS_R + d] / p->mass;
        faster[d] = p->sum[MASS_V + d] / p->mass;
        off[d] = p->place[d] + n * p->velocity[d] + fall * n * (n + 1) / 2 - p->about[d];
        p->velocity[d] += faster[d];
        p->place[d] += by[d] - n * faster[d]; /* from where it would be here with this velocity */
        velocity[d] = p->velocity[d] + n * fall;
    }
    sm_cross(off, faster, moment[0]); /* what the momentum of the whole changes about `about` */
    sm_cross(by, velocity, moment[1]);
    for (int d = 0; d < 3; d++)
        p->spin[d] += p->sum[MOMENT + d] - p->mass * (moment[0][d] + moment[1][d]);
}

void momentum_pushed(Momentum *m, long body, long slot, const MomentumChange *change,
                     const real gravity[3], long ahead)
{
    if (!m) return;
    MomentumPiece *p = &m->piece[body * m->pieces + m->label[slot]];
    double mass = (double)m->mass[slot], r[3], u[3], moment[2][3];
    memset(p->sum, 0, sizeof p->sum);
    for (int d = 0; d < 3; d++) {
        m->moving |= change->dx[d] != 0 || change->dv[d] != 0;
        p->sum[MASS_R + d] = mass * change->dx[d];
        p->sum[MASS_V + d] = mass * change->dv[d];
        r[d] = change->x[d] - p->about[d];
        u[d] = change->v[d] + change->dv[d];
        p->struck += mass * (change->dx[d] * change->dx[d] + change->dv[d] * change->dv[d]);
    }
    sm_cross(r, change->dv, moment[0]);
    sm_cross(change->dx, u, moment[1]);
    for (int d = 0; d < 3; d++) p->sum[MOMENT + d] = mass * (moment[0][d] + moment[1][d]);
    if (!is_known(m, p)) return;
    change_piece(p, (double)(m->steps + ahead), gravity);
    if (p->struck > STRUCK * p->widest) momentum_forget(m);
}

/* What the lanes of a block add to their pieces' sums. `from`: where those are taken about. */
typedef double Lanes[SM_LANES];
static void changes_of(const real *mass, bool abreast, const real *before, const real *x,
                       const real *v, Lanes from[3], Lanes change[SPREAD])
{
    Lanes r[2][3], u[2][3];
    for (int d = 0; d < 3; d++)
        for (int l = 0, at = d * SM_LANES; l < SM_LANES; l++, at++) {
            r[0][d][l] = (double)before[at] - from[d][l];
            r[1][d][l] = (double)x[at] - from[d][l];
            u[0][d][l] = (double)before[3 * SM_LANES + at];
            u[1][d][l] = (double)v[at];
        }
    for (int d = 0; d < 3; d++) {
        int e = (d + 1) % 3, f = (d + 2) % 3;
        for (int l = 0; l < SM_LANES; l++) {
            double m = (double)mass[abreast ? 0 : l];
            change[MASS_R + d][l] = m * (r[1][d][l] - r[0][d][l]);
            change[MASS_V + d][l] = m * (u[1][d][l] - u[0][d][l]);
            change[MOMENT + d][l] = m * (r[1][e][l] * u[1][f][l] - r[1][f][l] * u[1][e][l] -
                                         (r[0][e][l] * u[0][f][l] - r[0][f][l] * u[0][e][l]));
        }
    }
}

/* Adds the changes of a block of a run, whose lanes are given, in the order of slots. */
static void add_changes(const Momentum *m, long run, long block, const Lane lane[SM_LANES],
                        MomentumPiece *piece, const double (*origin)[3], const real *before,
                        const real *x, const real *v)
{
    Lanes from[3], change[SPREAD];
    long same = m->run[run].piece;
    for (int l = 0; l < SM_LANES; l++) {
        long of = same >= 0 ? same : lane[l].piece < 0 ? 0 : lane[l].piece;
        const double *at = origin_of(origin, &lane[l]);
        for (int d = 0; d < 3; d++) from[d][l] = piece[of].about[d] - at[d];
    }
    changes_of(m->mass + (m->abreast ? block % m->blocks : block * SM_LANES), m->abreast, before, x,
               v, from, change);
    for (int i = 0; i < SPREAD && same >= 0; i++) {
        double sum = piece[same].sum[i];
        for (int l = 0; l < SM_LANES; l++) sum += change[i][l];
        piece[same].sum[i] = sum;
    }
    for (int l = 0; l < SM_LANES && same < 0; l++)
        for (int i = 0; i < SPREAD && lane[l].piece >= 0; i++)
            piece[lane[l].piece].sum[i] += change[i][l];
}

void momentum_settle(Momentum *m, long body, const double (*origin)[3], const real *x,
                     const real *v, const real gravity[3])
{
    if (!m->notes.noted) return;
    long first = m->abreast ? 0 : body * all_blocks(m), count = m->pieces;
    if (m->abreast) count *= m->bodies;
    MomentumPiece *piece = m->piece + (m->abreast ? 0 : body * count);
    bool *noted, any = false;
    Lane lane[SM_LANES];
    for (long run = 0; run < m->runs; run++) {
        long end = m->run[run + 1].first, block = m->run[run].first, begin = block;
        while ((noted = memchr(m->notes.noted + first + block, true, (size_t)(end - block)))) {
            block = noted - m->notes.noted - first;
            for (MomentumPiece *p = piece; !any && p < piece + count; p++)
                memset(p->sum, 0, sizeof p->sum);
            any = m->moving = true;
            *noted = false;
            if (begin >= 0) lanes_of(m, begin, lane);
            begin = -1;
            add_changes(m, run, block, lane, piece, origin,
                        m->notes.before + (first + block) * 6 * SM_LANES, x + block * 3 * SM_LANES,
                        v + block * 3 * SM_LANES);
        }
    }
    for (MomentumPiece *p = piece; any && p < piece + count; p++)
        if (is_known(m, p)) change_piece(p, (double)(m->steps + 1), gravity);
}

/* How much of an expectation is taken in advance, so that in the n steps to the next time a body is
 * too slow as long as it is too fast: else friction, which brings it to rest on the whole, would
 * leave too little as the momentum that it should have, and it would creep. What is taken in the
 * end is 1 + leak times the expectation, (n + 1) / 2 n of it has to be left over with the other
 * sign. */
static double in_advance(double n)
{
    double leak = (1 - LASTING) / LEARNT;
    return leak + (1 + leak) * (n + 1) / (2 * n);
}

void momentum_keep(Momentum *m, long body, const double (*origin)[3], real *x, real *v,
                   const real gravity[3])
{
    long count;
    double n = (double)m->every, ahead = in_advance(n);
    MomentumPiece *piece = measure(m, body, origin, x, v, &count);
    for (MomentumPiece *p = piece; p < piece + count; p++) {
        Momenta is;
        double over[3], lost[3], off[3], aside[3];
        momenta_of(p, &is);
        if (!(p->sum[ENERGY] == 0)) m->moving = true;
        for (int d = 0; d < 3; d++) {
            double fall = (double)gravity[d], fast;
            p->place[d] += n * p->velocity[d] + fall * n * (n + 1) / 2;
            p->velocity[d] += n * fall;
            fast = is.velocity[d] - p->velocity[d] + ahead * p->drift[d];
            over[d] = is.spin[d] - p->spin[d] + ahead * p->twist[d];
            /* what was over the last times will be again */
            p->drift[d] = LASTING * p->drift[d] + LEARNT * fast;
            p->twist[d] = LASTING * p->twist[d] + LEARNT * over[d];
            p->push[d] = fast + p->drift[d];
            over[d] += p->twist[d];
            p->shift[d] = is.place[d] - p->place[d];
            double next = is.place[d] + n * is.velocity[d];
            p->about[d] = rint(next);
            off[d] = next - p->about[d];
        }
        p->widest = fmax(LASTING * p->widest, is.spread[0] + is.spread[1] + is.spread[2]);
        p->struck = 0;
        bool lasts =
            angular_velocity(is.spread, p->mass, is.spin, n, p->widest, over, p->turn, lost);
        for (int d = 0; d < 3; d++) {
            p->spin[d] += lost[d];
            if (!lasts || lost[d] != 0) p->twist[d] = 0;
        }
        sm_cross(p->turn, off, aside); /* it turns about the centre */
        for (int d = 0; d < 3; d++) p->push[d] -= aside[d];
    }
}

void momentum_shift(Momentum *m, long body, const double by[3])
{
    for (MomentumPiece *p = m->piece + body * m->pieces; p < m->piece + (body + 1) * m->pieces; p++)
        for (int d = 0; d < 3; d++) {
            p->place[d] -= by[d];
            p->about[d] -= by[d];
        }
}

void momentum_free(Momentum *m)
{
    if (!m) return;
    sm_free_all(m->mass, m->label, m->frame, m->piece, m->run, m->sum, m->notes.noted,
                m->notes.before, m);
}
