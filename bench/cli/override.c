#include "override.h"

#include "option.h"

enum { KEY_ENGINE = 0x3000, KEY_PRECISION, KEY_LAYOUT, KEY_MESH };

static const struct argp_option option_list[] = {
    {"engine", KEY_ENGINE, "NAME", 0,
     "fastlsm, octree, brute or meshless (default: as the scene says)", 1},
    {"precision", KEY_PRECISION, "P", 0, "single or double (default: the engine's first)", 1},
    {"layout", KEY_LAYOUT, "HOW", 0, BENCH_LAYOUT_HELP " (default: as the scene says)", 1},
    {"mesh", KEY_MESH, "NAME=FILE", 0,
     "Use the mesh FILE in the place of scene NAME's, scaled and moved to its size and place", 1},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    BenchOverride *chosen = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        *chosen = (BenchOverride){.layout = -1};
        return 0;
    case KEY_ENGINE:
        chosen->engine = text;
        return 0;
    case KEY_PRECISION:
        chosen->precision =
            bench_precisions[bench_option_choice(state, "--precision", text, bench_precisions)];
        return 0;
    case KEY_LAYOUT:
        chosen->layout = bench_option_choice(state, "--layout", text, bench_layouts);
        return 0;
    case KEY_MESH:
        bench_substitute_add(state, text, &chosen->substitutes);
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const struct argp argp = {option_list, parse, NULL, NULL, NULL, NULL, NULL};
const struct argp_child bench_override_children[] = {{&argp, 0, NULL, 0}, {0}};
