/* Maps of surfaces, by the program: what is printed and stored of them, checked from the stored
 * numbers alone; and what has none. */
#include "../../lib/test_frame.h"
#include "../../reference/meshless/map/test_surfaces.h"
#include "../../reference/meshless/test_solver.h"
#include "../cli/test_program.h"

static unsigned seed = 7;

static void on_torus(double u, double v, double x[3])
{
    double out = 3 + cos(2 * M_PI * v);
    x[0] = out * cos(2 * M_PI * u);
    x[1] = out * sin(2 * M_PI * u);
    x[2] = sin(2 * M_PI * v);
}

static void on_vase(double u, double v, double x[3])
{
    double out = 1 + 0.4 * sin(5 * v);
    x[0] = out * cos(2 * M_PI * u);
    x[1] = 4 * v;
    x[2] = out * sin(2 * M_PI * u);
}

static void on_wave(double u, double v, double x[3])
{
    x[0] = 2 * u;
    x[1] = v;
    x[2] = 0.3 * sin(4 * u) * cos(3 * v);
}

/* The file of a map, looked at by its arrays alone: angles, areas and factors agree, corners of
 * triangles at one point are one place but for seams, and cells fill the rectangle, balanced. */
static const char look[] =
    "import h5py, math, numpy as np, sys\n"
    "path, kind = sys.argv[1:]\n"
    "with h5py.File(path) as f:\n"
    "    a = dict(f.attrs)\n"
    "    g = {}\n"
    "    f.visititems(lambda n, d: g.update({n: d[()]}) if hasattr(d, 'shape') else None)\n"
    "assert a['kind'] == b'shapebench map' and a['surface_kind'].decode() == kind, a\n"
    "assert all(np.isfinite(v).all() for v in g.values())\n"
    "x, t, p = g['surface/points'], g['surface/triangles'], g['surface/parameters']\n"
    "low, high, off = a['low'], a['high'], g['surface/angle_error']\n"
    "assert off.shape == t.shape == p.shape[:2] and len(g['surface/factor']) == len(x)\n"
    "assert len(g['given/parameters']) == len(g['given/factor']) > 0\n"
    "assert np.median(off) <= a['angle_error'][0] * 1.001 <= a['angle_error'][1] * 1.001\n"
    "assert abs((off <= a['angle_error'][1]).mean() - 0.95) < 0.01\n"
    "def angles(q):\n"
    "    e, l = np.roll(q, -1, 1) - q, np.roll(q, 1, 1) - q\n"
    "    cos = (e * l).sum(2) / np.linalg.norm(e, axis=2) / np.linalg.norm(l, axis=2)\n"
    "    return np.degrees(np.arccos(cos.clip(-1, 1)))\n"
    "own = abs(angles(x[t]) - angles(p))\n" /* edges that were turned are no chords */
    "assert (abs(own - off) < 0.5).mean() > 0.9, abs(own - off).max()\n"
    "assert abs(np.median(own) - np.median(off)) < 0.1 * np.median(off) + 1e-6\n"
    "flat = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) / 2\n"
    "area = np.linalg.norm(np.cross(x[t][:, 1] - x[t][:, 0], x[t][:, 2] - x[t][:, 0]), axis=1) / "
    "2\n"
    "assert (flat > 0).all() and a['flips'] == 0\n"
    "parts = [(low, high)]\n"
    "if 'cylinders/low' in g: parts = list(zip(g['cylinders/low'], g['cylinders/high']))\n"
    "rectangle = sum((b - a).prod() for a, b in parts)\n"
    "assert abs(flat.sum() / rectangle - 1) < 1e-6 and abs(area.sum() / rectangle - 1) < 0.01\n"
    "L = (g['surface/factor'][t] ** 2).mean(1)\n"
    "assert abs((L * flat).sum() / rectangle - 1) < 0.05\n"
    "seams = list(zip(g['seams/shift'], g['seams/turned']))\n"
    "first, size = np.zeros((len(x), 2)), np.linalg.norm(high - low)\n"
    "first[t.ravel()] = p.reshape(-1, 2)\n"
    "def images(q):\n"
    "    return [q] + [s - q if turned else s + q for s, turned in seams]\n"
    "there = [q for one in images(p.reshape(-1, 2)) for q in images(one)]\n"
    "if 'joints/up' in g:\n" /* within a rectangle, or across a joint, each beside itself */
    "    j = {n: g['joints/' + n] for n in ('from', 'to', 'begin', 'end', 'shift')}\n"
    "    wide = np.array([b[0] - a[0] for a, b in parts])\n"
    "    steps = {(round(x, 6), 0.0) for w in wide for x in (-w, 0, w)}\n"
    "    for f, s in zip(j['from'], j['shift']):\n"
    "        steps |= {(s[0] + k * wide[f], s[1]) for k in (-1, 0, 1)}\n"
    "    sides = [(j['end'] - j['begin'])[j['from'] == k].sum() / w for k, w in enumerate(wide)]\n"
    "    rims, whole = j['to'] < 0, 2 * len(wide) - sum(sides)\n"
    "    assert np.allclose(sides, np.rint(sides), atol=1e-9), sides\n"
    "    assert (whole + rims.sum() / 2 > 1.9) == (kind == 'holed surface')\n"
    "    assert sorted(j['from'][~rims]) == sorted(j['to'][~rims])\n"
    "    there = [q for s in steps for e in (-1, 0, 1) for w in wide\n"
    "             for q in [p.reshape(-1, 2) + s + [e * w, 0]]]\n"
    "away = np.min([np.linalg.norm(q - first[t.ravel()], axis=1) for q in there], 0)\n"
    "if 'joints/up' in g: away = np.sort(away)[:-200]\n" /* at zeros joints follow each other */
    "assert away.max() < 1e-6 * size, away.max() / size\n"
    "lo, hi, cells = g['cells/low'], g['cells/high'], len(g['cells/low'])\n"
    "assert abs((hi - lo).prod(1).sum() / rectangle - 1) < 1e-9 and len(g['cells/factor']) == "
    "cells\n"
    "n = g['nodes/parameters']\n"
    "held = ((n[:, None] >= lo - 1e-9 * size) & (n[:, None] <= hi + 1e-9 * size)).all(2)\n"
    "assert held.any(1).all() and held.any(0).all()\n"
    "gap = np.maximum(lo[:, None] - hi, lo - hi[:, None]) / size\n"
    "touch = (gap.max(2) < 1e-9) & (gap.min(2) < -1e-9)\n" /* along a piece of an edge */
    "ratio = (hi - lo)[:, None, 0] / (hi - lo)[:, 0]\n"
    "assert ratio[touch].max() < 2.01, ratio[touch].max()\n"
    "away = np.linalg.norm(g['nodes/points'][:, None] - x, axis=2).min(1)\n"
    "assert away.max() < np.sqrt(area.max()) * 2, away.max()\n";

static void check_map(const char *mesh, const char *kind)
{
    Result result;
    char command[512], wanted[64];
    snprintf(command, sizeof command, "info %s --map --nodes 60 --overwrite -o map.h5", mesh);
    run(command, &result);
    if (result.code || result.err[0]) fail_msg("%s: %d, %s", mesh, result.code, result.err);
    snprintf(wanted, sizeof wanted, "  surface       %s: genus ", kind);
    assert_non_null(strstr(result.out, wanted));
    assert_non_null(strstr(result.out, "wrote map.h5\n"));
    snprintf(command, sizeof command, "cd %s && /usr/bin/python3 look.py map.h5 '%s'", folder,
             kind);
    if (system(command)) fail_msg("%s: see above", mesh);
}

TEST(maps_are_stored_whole)
{
    needs_solver();
    needs_python("h5py");
    write_text("look.py", look);
    write_obj(path_in("ball.obj"), sphere_mesh(9, 0.3, &seed));
    check_map("ball.obj", "sphere");
    write_obj(path_in("half.obj"), ball_mesh(9, true, 0.3, &seed));
    check_map("half.obj", "disk");
    write_obj(path_in("torus.obj"), grid_mesh(45, 15, true, true, on_torus, 0.3, &seed));
    check_map("torus.obj", "torus");
    write_obj(path_in("vase.obj"), grid_mesh(30, 18, true, false, on_vase, 0.3, &seed));
    check_map("vase.obj", "annulus");
    write_obj(path_in("double.obj"), tori_mesh(&double_torus, 40, &seed));
    check_map("double.obj", "multitorus");
    write_obj(path_in("plate.obj"), plate_mesh(&two_holes, 40, 0.05, &seed));
    check_map("plate.obj", "holed surface");
    SmMesh open = tori_mesh(&double_torus, 40, &seed);
    long kept = 0; /* but for an end of it: with a handle and two rims */
    for (long t = 0; t < open.triangle_count; t++)
        if (open.position[open.triangle[t][0]][0] > -1)
            memcpy(open.triangle[kept++], open.triangle[t], sizeof *open.triangle);
    open.triangle_count = kept;
    write_obj(path_in("open.obj"), open);
    check_map("open.obj", "holed surface");
    write_obj(path_in("wave.obj"), grid_mesh(24, 12, false, false, on_wave, 0.3, &seed));
    check_map("wave.obj", "disk");
}

/* What it says is what the engine runs with. */
TEST(the_engine_has_the_same_map)
{
    needs_solver();
    Result looked, ran;
    char nodes[64];
    double off;
    write_obj(path_in("ball.obj"), sphere_mesh(9, 0.3, &seed));
    run("info ball.obj --map --nodes 80", &looked);
    run("run ball.obj --engine shell --nodes 80 --frames 1 --no-output", &ran);
    assert_int_equal(looked.code, 0);
    assert_int_equal(ran.code, 0);
    const char *angles = strstr(looked.out, "off by "), *same = strstr(ran.out, "off by ");
    assert_non_null(angles);
    assert_non_null(same);
    off = strtod(angles + 7, NULL);
    assert_true(off > 0 && fabs(strtod(same + 7, NULL) / off - 1) < 0.05);
    const char *count = strstr(looked.out, "nodes         ");
    assert_non_null(count);
    snprintf(nodes, sizeof nodes, "carried by %ld nodes of a sphere", strtol(count + 14, NULL, 10));
    assert_non_null(strstr(ran.out, nodes));
}

/* Cubes of a grid, five by three, of which some are there. */
static void write_cubes(const char *name, const char *there)
{
    static const int face[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                   {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    static const int beyond[6][2] = {{0, 0}, {0, 0}, {0, -1}, {0, 1}, {-1, 0}, {1, 0}};
    FILE *file = fopen(path_in(name), "w");
    assert_non_null(file);
    for (int n = 0; n < 2 * 4 * 6; n++) fprintf(file, "v %d %d %d\n", n % 6, n / 6 % 4, n / 24);
    for (int c = 0; c < 15; c++)
        for (int f = 0; f < 6 && there[c] == '#'; f++) {
            int i = c % 5 + beyond[f][0], j = c / 5 + beyond[f][1];
            if (f > 1 && i >= 0 && i < 5 && j >= 0 && j < 3 && there[5 * j + i] == '#') continue;
            fputc('f', file);
            for (int k = 3; k >= 0; k--) {
                int corner = face[f][k];
                fprintf(file, " %d",
                        1 + (c % 5 + (corner & 1)) + 6 * (c / 5 + (corner >> 1 & 1)) +
                            24 * (corner >> 2));
            }
            fputc('\n', file);
        }
    fclose(file);
}

TEST(a_triangle_alone_is_a_shell)
{
    needs_solver();
    Result result;
    write_text("loose.obj", "v 0 0 0\nv 3 1 2\nv 1 3 1\nf 1 2 3\n");
    run("run loose.obj --engine shell --nodes 60 --frames 1 --no-output", &result);
    assert_int_equal(result.code, 0);
    assert_non_null(strstr(result.out, "nodes of a disk"));
}

TEST(what_has_no_map_is_one_clear_line)
{
    needs_solver();
    write_cubes("apart.obj", "#.#............");
    write_obj(path_in("torus.obj"), grid_mesh(45, 15, true, true, on_torus, 0.3, &seed));
    static const Mistake mistakes[] = {
        {"info apart.obj --map", 3, "apart.obj: the mesh: 2 surfaces that do not hang together"},
        {"info absent.obj --map -o a.h5", 3, "absent.obj"},
        {"info torus.obj --map -o no/such/a.h5", 4, "no/such/a.h5"},
    };
    make_mistakes(mistakes, sizeof mistakes / sizeof *mistakes);
    Result result;
    write_cubes("one.obj", "####.#.######..");
    run("info one.obj --map --nodes 40", &result);
    assert_int_equal(result.code, 0);
    assert_non_null(strstr(result.out, "torus: genus 1, 0 rims"));
    /* too coarse for a map: each of its 112 triangles becomes four */
    write_cubes("two.obj", "######.#.######");
    run("info two.obj --map --nodes 40", &result);
    assert_int_equal(result.code, 0);
    assert_non_null(strstr(result.out, "multitorus: genus 2, 0 rims"));
    assert_non_null(strstr(result.out, "; 0 triangles turned over"));
    run("run two.obj --engine shell --nodes 200 --frames 2 --no-output", &result);
    assert_int_equal(result.code, 0);
    run("run two.obj --engine shell --nodes 200 --frames 2 --strength 100 --no-output", &result);
    assert_int_equal(result.code, 0);
    assert_non_null(strstr(result.out, "with the surface"));
}

TEST(wrong_options_are_said)
{
    static const Mistake mistakes[] = {
        {"info --map", 2, "which MESH?"},
        {"info shape:bar shape:block --map", 2, "--map: of one mesh"},
        {"info shape:bar --map --format json", 2, "--map: of one mesh, without --format"},
        {"info shape:bar --map --particles 90", 2, "--map: of one mesh, without --format"},
        {"info shape:bar --nodes 90", 2, "--nodes goes with --map"},
        {"info shape:bar --map --nodes 7", 2, "--nodes: '7'"},
        {"info shape:bar --map --overwrite", 2, "--overwrite needs --output"},
    };
    make_mistakes(mistakes, sizeof mistakes / sizeof *mistakes);
}
