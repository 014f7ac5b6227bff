#include "recommendation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../engines.h"
#include "../system/statistic.h"

static const double near_enough = 0.1, alike = 0.1; /* of a modulus */

/* Appends to a sentence. */
#define SAY(text, ...) sm_append(text, BENCH_WORDS, __VA_ARGS__)

/* Values of valid specimens that are narrow or wide, or both (2): what is picked of each. */
static int gather(const BenchSpecimen *specimen, long count, int wide,
                  double (*pick)(const BenchSpecimen *s), double *value)
{
    int number = 0;
    for (long i = 0; i < count; i++)
        if (specimen[i].valid && (wide == 2 || specimen[i].wide == wide))
            value[number++] = pick(&specimen[i]);
    return number;
}

static double first_gap(const BenchSpecimen *s)
{
    return 100 * fabs(bench_specimen_youngs(s)[1] / bench_specimen_youngs(s)[0] - 1);
}

static double theory_gap(const BenchSpecimen *s)
{
    return 100 * (s->young_timoshenko[0] / s->young_meshless[0] - 1);
}

static double spread_of(const BenchSpecimen *s)
{
    return 100 * s->spread;
}

static double loss_of(const BenchSpecimen *s)
{
    return fabs(s->loss[0]);
}

/* "6.8% (at most 14%)" */
static void say_percent(double *value, int count, char *text)
{
    SAY(text, "%.2g%% (at most %.2g%%)", bench_quantile(value, count, 0.5),
        bench_quantile(value, count, 1));
}

/* How far what sag and frequencies say is apart. */
static void say_alike(const BenchSpecimen *specimen, long count, char *text)
{
    static const char *const where[] = {"where regions are narrower than the beam is thick",
                                        "where they are wider than it"};
    double *value = sm_alloc((size_t)count, sizeof *value);
    int all = gather(specimen, count, 2, first_gap, value), number;
    if (all) {
        SAY(text,
            "An elastic beam behaves alike: in %d valid specimens of %ld Young's moduli by the "
            "static sag and by the first frequency differ by ",
            all, count);
        say_percent(value, all, text);
        for (int wide = 0; wide < 2; wide++) {
            if (!(number = gather(specimen, count, wide, spread_of, value))) continue;
            SAY(text, ", those by the sag and three frequencies by ");
            say_percent(value, number, text);
            SAY(text, " %s", where[wide]);
        }
        number = gather(specimen, count, 2, theory_gap, value);
        double theory = bench_quantile(value, number, 0.5); /* NaN without the reference */
        if (isfinite(theory))
            SAY(text, "; Timoshenko's theory says %+.2g%% by the sag (median)", theory);
        number = gather(specimen, count, 2, loss_of, value);
        SAY(text, "; the first mode loses at most %.2g (loss factor).",
            bench_quantile(value, number, 1));
    }
    free(value);
}

static void say_laws(const BenchStiffnessFit *law, int laws, char *text)
{
    for (int i = 0; i < laws; i++) {
        const BenchStiffnessFit *l = &law[i];
        SAY(text, "%s%s c = %.3f (%.3f to %.3f) and d = %.3f (%.3f to %.3f), off by %.2g%%",
            i ? "; " : "It follows E = " BENCH_STIFFNESS_LAW ": ", l->engine, l->c[0], l->c[1],
            l->c[2], l->d[0], l->d[1], l->d[2], 100 * l->scatter);
    }
    if (laws) SAY(text, ".");
}

/* Largest and least of a modulus over what differs from `of` in one thing alone. */
static double ratio_over(const BenchSpecimen *specimen, long count, const char *set, bool epsilon)
{
    double most = NAN;
    for (long i = 0; i < count; i++)
        for (long j = 0; j < count; j++) {
            const BenchSpecimen *a = &specimen[i], *b = &specimen[j];
            bool same = a->valid && b->valid && !strcmp(a->engine, b->engine) && a->w == b->w;
            if (!same || a->across != b->across || a->h != b->h) continue;
            if (epsilon ? a->aspect != b->aspect : a->epsilon != b->epsilon) continue;
            if (!epsilon && strcmp(a->set, set) != 0 && strcmp(b->set, set) != 0) continue;
            most = fmax(most, a->young / b->young);
        }
    return most;
}

/* The first w of the scene's beam whose regions are wider than it is thick. */
static const BenchSpecimen *find_wide(const BenchSpecimen *specimen, long count)
{
    const BenchSpecimen *found = NULL;
    for (long i = 0; i < count; i++) {
        const BenchSpecimen *s = &specimen[i];
        if (!strcmp(s->set, "grid") && s->wide && (!found || s->w < found->w)) found = s;
    }
    return found;
}

static void say_range(const BenchSpecimen *specimen, long count, char *text)
{
    double aspect = ratio_over(specimen, count, "aspect", false),
           epsilon = ratio_over(specimen, count, "", true), linear = INFINITY, least = INFINITY,
           most = 0;
    int looked = 0, apart = 0;
    for (long i = 0; i < count; i++) {
        const BenchSpecimen *s = &specimen[i];
        if (isfinite(s->linear_to)) linear = fmin(linear, s->linear_to), looked++;
        if (!s->valid || s->spread <= alike) continue;
        double wide_as = (2 * s->w + 1.0) / s->across;
        least = fmin(least, wide_as), most = fmax(most, wide_as), apart++;
    }
    const BenchSpecimen *wide = find_wide(specimen, count);
    SAY(text, "It is no material's constant:");
    if (wide)
        SAY(text,
            " from w %d on regions are wider than this beam of %d cells, and resist its bending by "
            "their length;",
            wide->w, wide->across);
    if (aspect > 1)
        SAY(text, " one setting is up to %.2g%% stiffer on one length than on another;",
            100 * (aspect - 1));
    if (epsilon > 1) SAY(text, " epsilon makes the octree up to %.2g times as stiff;", epsilon);
    if (looked)
        SAY(text, " sags are in proportion to the load to %g%% of the length (%d looked at);",
            100 * linear, looked);
    SAY(text, " sag and three frequencies are more than %g%% apart in %d specimens", 100 * alike,
        apart);
    if (apart)
        SAY(text, ", whose regions are %.2g to %.2g times as wide as the beam is thick", least,
            most);
    SAY(text, ".");
}

void bench_recommendation_found(const BenchSpecimen *specimen, long count,
                                const BenchStiffnessFit *law, int laws,
                                char found[BENCH_FOUND][BENCH_WORDS])
{
    for (int i = 0; i < BENCH_FOUND; i++) found[i][0] = '\0';
    say_alike(specimen, count, found[0]);
    say_laws(law, laws, found[1]);
    if (found[0][0]) say_range(specimen, count, found[2]);
}

/* ---- the other way round */

/* Its Young's modulus at the wished density. */
static double young_of(const BenchSpecimen *s, const BenchYoung *wish)
{
    return s->young * wish->density / wish->measured;
}

static double off(const BenchSpecimen *s, const BenchYoung *wish)
{
    return fabs(log(young_of(s, wish) / wish->young));
}

static bool better(const BenchSpecimen *a, const BenchSpecimen *b, const BenchYoung *wish)
{
    double far = log(1 + near_enough), off_a = off(a, wish), off_b = off(b, wish);
    if (off_a <= far && off_b <= far) return a->spread < b->spread;
    return off_a < off_b;
}

/* The time step that hits the wish: moduli go with (a/h)^2. */
static double find_step(const BenchSpecimen *s, const BenchYoung *wish)
{
    return s->h * wish->cell / s->spacing * sqrt(young_of(s, wish) / wish->young);
}

long bench_recommendation_young(const BenchSpecimen *specimen, long count, const BenchYoung *wish,
                                char sentence[BENCH_WORDS])
{
    long best = -1;
    double low = INFINITY, high = 0;
    sentence[0] = '\0';
    for (long i = 0; i < count; i++) {
        const BenchSpecimen *s = &specimen[i];
        if (!s->valid || strcmp(s->set, "grid") != 0) continue;
        low = fmin(low, young_of(s, wish)), high = fmax(high, young_of(s, wish));
        if (best < 0 || better(s, &specimen[best], wish)) best = i;
    }
    if (best < 0) {
        SAY(sentence, "No recommendation: no specimen of the grid is valid.");
        return best;
    }
    const BenchSpecimen *s = &specimen[best];
    bool hit = off(s, wish) <= log(1 + near_enough);
    if (!hit)
        SAY(sentence, "No w and epsilon is within %g%% of %.4g Pa (%.3g to %.3g Pa there are). ",
            100 * near_enough, wish->young, low, high);
    SAY(sentence, "For %.4g Pa at %.4g kg/m^3 %s %s with w %d", wish->young, wish->density,
        hit ? "take" : "the nearest is", s->engine, s->w);
    if (bench_engine(s->engine)->sampled) SAY(sentence, " and epsilon %g", s->epsilon);
    SAY(sentence,
        ", spacing %.3g m and time step %.3g s: %.3g Pa, sag and frequencies %.2g%% apart, loss "
        "factor %.1g. With cells of %.4g m a time step of %.4g s hits it.",
        s->spacing, s->h, young_of(s, wish), 100 * s->spread, fabs(s->loss[0]), wish->cell,
        find_step(s, wish));
    return best;
}

void bench_recommendation_settings(const BenchSpecimen *s, const BenchYoung *wish, double damping,
                                   char settings[BENCH_WORDS])
{
    settings[0] = '\0';
    SAY(settings, "    engine = \"%s\";\n", s->engine);
    if (bench_engine(s->engine)->sampled)
        SAY(settings,
            "    epsilon = %.6g;\n"
            "    octree = { edges = %d.0; criteria = ( { kind = \"uniform\"; } ); };\n",
            s->epsilon, s->w);
    else
        SAY(settings, "    w = %d;\n", s->w);
    SAY(settings, "    h = %.6g;\n", find_step(s, wish));
    if (damping > 0) SAY(settings, "    damping = %.6g;\n", damping);
    SAY(settings, "    density = %.6g;\n", wish->density);
}
