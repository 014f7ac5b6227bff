#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../lib/printable.h"
#include "../../lib/voxel/voxelise.h"
#include "../scene/body.h"
#include "../scene/map.h"
#include "../store/draft.h"
#include "command.h"
#include "machine_info.h"

typedef struct {
    BenchCommon common;
    long particles;
    const char *format; /* NULL: not given */
    bool overwrite;
    bool map;
    long nodes;         /* of the map's shell; 0: not given */
    const char *output; /* of the map; NULL: none */
} Options;

/* What is said of one mesh. */
typedef struct {
    SmMeshInfo mesh;
    bool solid; /* can be simulated as a solid */
    char verdict[512];
    long particles, cells;
    double cell;
} Facts;

static const char *const formats[] = {"text", "json", NULL};

static const BenchSetting settings[] = {
    {BENCH_OPTION("format", "FORMAT", 1, "text or json (default: text)"), BENCH_IN(Options, format),
     BENCH_CHOICES(formats)},
    {BENCH_OPTION("particles", "N", 1,
                  "Particle count of the lattice that is tried (default: 2000)"),
     BENCH_IN(Options, particles), 8, 1000000000},
    {BENCH_OPTION("map", NULL, 2,
                  "Instead, of one mesh or of points: the conformal map of its surface, and the "
                  "nodes that the shell engine puts into it; with --output also stored"),
     BENCH_IN(Options, map)},
    {BENCH_OPTION("nodes", "N", 2, "Wanted nodes of the map's shell (default: 450)"),
     BENCH_IN(Options, nodes), 8, 1e6},
    {BENCH_OUTPUT_OPTION("FILE.h5", 2, "HDF5 file of the map; scripts/plot_map.py draws it"),
     BENCH_IN(Options, output)},
    BENCH_OVERWRITE_OPTION(Options, overwrite, 2),
    {0},
};

static void check(const struct argp_state *state, void *record)
{
    Options *options = record;
    if (!options->common.words && (options->map || options->particles))
        bench_usage(state, "which MESH?");
    if (options->nodes && !options->map) bench_usage(state, "--nodes goes with --map");
    if (options->output && !options->map) bench_usage(state, "--output goes with --map");
    if (options->overwrite && !options->output)
        bench_usage(state, "--overwrite needs --output: it replaces that file");
    if (options->map && (options->common.words > 1 || options->format || options->particles))
        bench_usage(state, "--map: of one mesh, without --format and --particles");
}

static const char help[] =
    "Without a mesh, say what this machine and this program are: processor, caches, cores, "
    "instruction sets, compiler, libraries, and whether the processor's counters can be read. Else "
    "say what is in mesh files (OBJ, PLY, STL, OFF, glTF and what else Assimp reads, or "
    "shape:NAME): triangles, vertices, components, edges that are open, shared by more than two "
    "triangles or flipped, bounding box, volume (of closed ones), cavities, and whether it can be "
    "simulated as a solid.\v"
    "With several meshes each gets its say; the exit code is that of the last one that cannot be "
    "read. --format json prints one array with an object for every mesh, or one object of the "
    "machine.\n" BENCH_EXIT_CODES;

static SmCode look(const char *name, long particles, Facts *facts, SmError *error)
{
    SmMesh mesh;
    memset(facts, 0, sizeof *facts);
    SmCode code = bench_mesh_load(name, &mesh, error);
    if (code) return code;
    facts->mesh = sm_mesh_info(&mesh);
    SmVoxels voxels;
    SmVoxelReport report;
    SmError why;
    SmVoxelParams params = {.fill = SM_SOLID, .particles = particles, .fewer = true};
    facts->solid = !sm_voxelise_report(&mesh, &params, name, &voxels, &report, &why);
    if (facts->solid) {
        snprintf(facts->verdict, sizeof facts->verdict, "%s", sm_voxel_verdict(&report));
        facts->particles = voxels.particle_count;
        facts->cells = voxels.cell_count;
        facts->cell = voxels.cell;
        sm_voxels_free(&voxels);
    } else {
        const char *text = why.text;
        size_t length = strlen(name);
        if (!strncmp(text, name, length) && !strncmp(text + length, ": ", 2)) text += length + 2;
        snprintf(facts->verdict, sizeof facts->verdict, "%s", text);
    }
    sm_mesh_free(&mesh);
    return SM_OK;
}

static double box_volume(const SmMeshInfo *m)
{
    return (m->high[0] - m->low[0]) * (m->high[1] - m->low[1]) * (m->high[2] - m->low[2]);
}

static void print_volume(const SmMeshInfo *m)
{
    bool some = fabs(m->volume) > 1e-12 * box_volume(m); /* not rounding's sign */
    if (isfinite(m->volume))
        printf("  volume        %.6g%s\n", some ? m->volume : 0,
               some && m->volume < 0 ? " (inside out)" : "");
    else
        printf("  volume        none: %s\n",
               m->open_edges ? "the surface is open"
                             : "the triangles do not agree which side is outside");
}

static void print_name(const char *name)
{
    char shown[BENCH_PATH];
    snprintf(shown, sizeof shown, "%s", name);
    sm_printable(shown);
    printf("%s\n", shown);
}

static void print_text(const char *name, const Facts *facts)
{
    const SmMeshInfo *m = &facts->mesh;
    print_name(name);
    printf("  triangles     %ld\n", m->triangles);
    printf("  vertices      %ld\n", m->vertices);
    printf("  components    %ld\n", m->components);
    printf("  watertight    %s", m->watertight ? "yes\n" : "no: ");
    if (!m->watertight)
        printf("%ld open edges, %ld edges of more than two triangles\n", m->open_edges,
               m->nonmanifold_edges);
    if (m->flipped_edges || m->degenerate || m->duplicates)
        printf("  irregular     %ld flipped edges, %ld triangles without area, %ld duplicates\n",
               m->flipped_edges, m->degenerate, m->duplicates);
    printf("  bounding box  %.9g %.9g %.9g  to  %.9g %.9g %.9g\n", m->low[0], m->low[1], m->low[2],
           m->high[0], m->high[1], m->high[2]);
    printf("  size          %.6g x %.6g x %.6g\n", m->high[0] - m->low[0], m->high[1] - m->low[1],
           m->high[2] - m->low[2]);
    print_volume(m);
    if (m->cavities)
        printf("  cavities      %ld, of volume %.6g: a lattice fills them\n", m->cavities,
               m->cavity_volume);
    printf("  solid         %s: %s\n", facts->solid ? "yes" : "no", facts->verdict);
    if (facts->solid)
        printf("  lattice       %ld particles, %ld cells of %.6g\n", facts->particles, facts->cells,
               facts->cell);
}

static json_t *to_json(const char *name, const Facts *facts)
{
    const SmMeshInfo *m = &facts->mesh;
    json_t *text = json_string(name);
    return json_pack(
        "{s:o, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:b, s:[fff], s:[fff], "
        "s:o, s:b, s:o, s:f}",
        "mesh", text ? text : json_string("(name is no UTF-8)"), "triangles",
        (json_int_t)m->triangles, "vertices", (json_int_t)m->vertices, "components",
        (json_int_t)m->components, "open_edges", (json_int_t)m->open_edges, "nonmanifold_edges",
        (json_int_t)m->nonmanifold_edges, "flipped_edges", (json_int_t)m->flipped_edges,
        "degenerate", (json_int_t)m->degenerate, "duplicates", (json_int_t)m->duplicates,
        "particles", (json_int_t)facts->particles, "cells", (json_int_t)facts->cells, "cavities",
        (json_int_t)m->cavities, "cavity_volume", m->cavity_volume, "watertight",
        (int)m->watertight, "low", m->low[0], m->low[1], m->low[2], "high", m->high[0], m->high[1],
        m->high[2], "volume", isfinite(m->volume) ? json_real(m->volume) : json_null(), "solid",
        (int)facts->solid, "verdict", bench_json_text(facts->verdict), "cell", facts->cell);
}

static void print_map(const char *name, const BenchMap *all)
{
    const RefSurfaceMap *map = &all->map;
    const RefTriangulation *surface = ref_surface_map_triangles(map);
    const RefChart *chart = &map->chart;
    print_name(name);
    printf("  points        %ld\n", map->vertices);
    printf("  surface       %s: genus %d, %d rims; %ld triangles\n", ref_map_kind_name(map->kind),
           surface->genus, surface->rims, map->triangles);
    printf("  repaired      %ld triangles dropped, %d rims closed, %d handles cut\n", map->dropped,
           map->closed, map->handles);
    printf("  parameters    ");
    for (int c = 0; c < (chart->cylinders ? chart->cylinders->count : 1); c++) {
        const RefCylinder *one = chart->cylinders ? chart->cylinders->cylinder + c : NULL;
        const double *low = one ? one->low : chart->low, *high = one ? one->high : chart->high;
        printf("%s%.6g x %.6g", c ? ", " : "", high[0] - low[0], high[1] - low[1]);
    }
    printf(", in %.3g s\n", map->seconds);
    printf("  angles        off by %.3g degrees (median), %.3g (95%%); %ld triangles turned over\n",
           map->angle_median, map->angle_95, map->flips);
    printf("  factor        %.3g to %.3g, median %.3g\n", all->factors[0], all->factors[2],
           all->factors[1]);
    printf("  nodes         %ld in %ld cells, in %.3g s\n", all->shell.nodes.count,
           all->shell.tree.leaves, all->shell_seconds);
    printf("  spread        %.3g%% of cells' edges on the surface\n", 100 * all->spread);
    printf("  covers        %ld at least of a point, %.3g on average; %ld points have too few\n",
           all->least_covers, all->mean_covers, all->uncovered);
}

static SmCode look_at_map(const Options *options, SmError *error)
{
    const char *mesh = options->common.word[0];
    BenchMap *map = sm_alloc(1, sizeof *map);
    SmCode code =
        options->output ? bench_draft_reserve(options->output, options->overwrite, error) : SM_OK;
    if (!code) code = bench_map_make(mesh, options->nodes, map, error);
    if (!code) {
        print_map(mesh, map);
        if (options->output) code = bench_map_write(map, mesh, options->output, error);
        bench_map_free(map);
    }
    if (!code && options->output && !options->common.quiet) printf("wrote %s\n", options->output);
    free(map);
    return code;
}

static SmCode perform(void *record, int argc, char **argv, SmError *error)
{
    const Options *options = record;
    bool json = options->format && !strcmp(options->format, "json");
    if (!options->common.words) {
        BenchMachine machine;
        bench_machine_read(argc, argv, options->common.threads, &machine);
        bench_machine_info(&machine, json);
        return SM_OK;
    }
    if (options->map) return look_at_map(options, error);
    long particles = options->particles ? options->particles : 2000;
    SmCode code = SM_OK;
    json_t *list = json_array();
    for (int i = 0; i < options->common.words; i++) {
        const char *name = options->common.word[i];
        Facts facts;
        SmError why;
        SmCode failed = look(name, particles, &facts, &why);
        if (failed) {
            bench_option_fail(argv[0], &why);
            code = failed;
        } else if (json) {
            json_array_append_new(list, to_json(name, &facts));
        } else {
            print_text(name, &facts);
        }
    }
    if (json) {
        json_dumpf(list, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
        putchar('\n');
    }
    json_decref(list);
    return code;
}

const BenchCommand bench_command_info = {
    .name = "info",
    .summary = "say what is in a mesh, or, alone, what this machine has",
    .line = {settings, BENCH_TAKES_QUIET | BENCH_TAKES_THREADS, "[MESH...]", help, check,
             .most = -1},
    .size = sizeof(Options),
    .perform = perform,
};
