#include "engines.h"

#include <stdio.h>
#include <string.h>

#include "../fastlsm/fastlsm.h"
#include "../octree/engine.h"
#include "../reference/brute.h"
#include "../reference/meshless/engine.h"
#include "cli/suggest.h"
#include "cli/summary.h"
#include "measure/elastic_row.h"
#include "measure/room.h"
#include "measure/tree_row.h"

enum { TYPES = 2, MOST = 16 };

static void set_cells(BenchScene *scene, double w, double epsilon, bool cells)
{
    (void)epsilon, (void)cells;
    scene->params.w = (int)w;
}

static void set_octree(BenchScene *scene, double w, double epsilon, bool cells)
{
    scene->params.summation = SM_SUM_FAST; /* it has only one way */
    scene->params.polar = SM_POLAR_FAST;
    scene->params.layout = SM_LAYOUT_AUTO;
    scene->octree.width = cells ? (OctWidth){.cells = w} : (OctWidth){.edges = w};
    scene->octree.epsilon = epsilon;
}

const BenchEngine bench_fastlsm = {.type = {&fastlsm_engine_f32, &fastlsm_engine_f64},
                                   .planned = true,
                                   .yardstick = true,
                                   .set_width = set_cells,
                                   .carrier = &bench_lattice_carrier,
                                   .twin = &bench_lattice_twin,
                                   .checker = &bench_matching_checker,
                                   .room = bench_room_lattice};

const BenchEngine bench_octree = {.type = {&octree_engine_f32, &octree_engine_f64},
                                  .sampled = true,
                                  .planned = true,
                                  .set_width = set_octree,
                                  .carrier = &bench_octree_carrier,
                                  .twin = &bench_octree_twin,
                                  .checker = &bench_matching_checker,
                                  .explain = bench_tree_row_explain,
                                  .describe = bench_summary_octree,
                                  .structure = oct_engine_structure,
                                  .room = bench_room_octree};

const BenchEngine bench_brute = {.type = {&ref_brute_engine},
                                 .carrier = &bench_lattice_carrier,
                                 .twin = &bench_lattice_twin,
                                 .checker = &bench_matching_checker,
                                 .room = bench_room_brute};

const BenchEngine bench_meshless = {.type = {&ref_meshless_engine},
                                    .elastic = true,
                                    .carrier = &bench_lattice_carrier,
                                    .describe = bench_summary_meshless,
                                    .measure = bench_elastic_measure,
                                    .explain = bench_elastic_row_text,
                                    .room = bench_room_lattice};

const BenchEngine *bench_engine(const char *name)
{
    static const SmEngineType none_type = {.name = "", .precision = ""};
    static const BenchEngine none = {.type = {&none_type}};
    for (int e = 0; bench_engine_list[e]; e++)
        if (!strcmp(bench_engine_list[e]->type[0]->name, name)) return bench_engine_list[e];
    return &none;
}

SmCode bench_engine_find(const char *name, const char *precision, const SmEngineType **type,
                         SmError *error)
{
    char known[256] = "", near[BENCH_SUGGEST_TEXT];
    const char *names[MOST + 1] = {NULL};
    for (int i = 0; bench_engine_list[i / TYPES]; i++) {
        const SmEngineType *t = bench_engine_list[i / TYPES]->type[i % TYPES];
        if (!t) continue;
        if (i / TYPES < MOST) names[i / TYPES] = t->name;
        if (!strcmp(t->name, name) && (!precision || !strcmp(t->precision, precision))) {
            *type = t;
            return SM_OK;
        }
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s (%s)", used ? ", " : "", t->name,
                 t->precision);
    }
    return sm_fail(error, SM_USAGE, "no engine '%.32s'%s%s%s; there are: %s%s", name,
                   precision ? " in " : "", precision ? precision : "",
                   precision ? " precision" : "", known, bench_suggest_among(name, names, near));
}

const BenchEngine *bench_engine_planned(const char *engines, int i)
{
    bool all = !strcmp(engines, bench_engine_choices()[0]);
    for (const BenchEngine *const *engine = bench_engine_list; *engine; engine++)
        if ((*engine)->planned && (all || !strcmp((*engine)->type[0]->name, engines)) && i-- == 0)
            return *engine;
    return NULL;
}

const char *const *bench_engine_choices(void)
{
    static const char *choices[BENCH_MOST_PLANNED + 2] = {"both"};
    int count = 1;
    for (const BenchEngine *const *engine = bench_engine_list; *engine; engine++)
        if ((*engine)->planned && count <= BENCH_MOST_PLANNED)
            choices[count++] = (*engine)->type[0]->name;
    return choices;
}
