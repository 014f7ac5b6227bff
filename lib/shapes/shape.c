#include "shape.h"

#include <math.h>
#include <string.h>

#include "../printable.h"
#include "decimate.h"
#include "polygonise.h"
#include "sculpt.h"

/* How a shape is made: a sculpture polygonised with lattice cubes of `cell` (chosen to give about
 * 1.4 times the wanted triangles, or to resolve the thinnest part) and decimated to the count; or,
 * without a sculptor, a box of grid[] squares along its edges. The result is scaled to `length`
 * along `axis` and set on y = 0 with x and z centred. */
typedef struct {
    SmSculptor sculpt;
    double cell;
    int grid[3];
    double square; /* edge of the box's squares */
    int axis;
    double length;
} Recipe;

enum { SHAPES = 16 };

static const SmShape shapes[SHAPES] = {
    {"penguin", "cartoon penguin, 1 m tall (FastLSM's penguin)", 9874},
    {"statue", "laughing monk in a robe on a plinth, 1.98 m tall (for the Happy Buddha)", 200000},
    {"infant", "baby with its arms held out, 0.6 m tall (FastLSM's infant)", 16844},
    {"hand", "open hand with five separate fingers, 0.19 m long", 16000},
    {"liver", "liver of two lobes with a gall bladder, 0.22 m wide", 4400},
    {"flower", "flower with thin petals, a thin stem and two leaves, 0.4 m tall", 4500},
    {"balljoint", "upper end of a thigh bone, 0.2 m tall (for the meshless paper's balljoint)",
     40000},
    {"rabbit", "rabbit that sits, 0.3 m tall (for the meshless paper's rabbit)", 20000},
    {"santa", "santa with a sack, 0.3 m tall (for the meshless paper's santa)", 26000},
    {"rockerarm", "lever with a bore, 0.2 m long (for the meshless paper's rocker arm)", 80000},
    {"gargoyle", "gargoyle on a block, 0.3 m tall (for the meshless paper's gargoyle)", 80000},
    {"bunny", "the rabbit of more triangles (for the meshless paper's bunny)", 100000},
    {"bust", "bust of a woman, 0.3 m tall (for the meshless paper's Iphigenie)", 400434},
    {"block", "cube, 0.2 m", 768},
    {"beam", "beam, 0.8 m x 0.1 m x 0.1 m along x", 1088},
    {"bar", "bar, 0.56 m x 0.12 m x 0.12 m along x (for the meshless paper's beam)", 1488},
};

static const Recipe recipes[SHAPES] = {
    {sm_sculpt_penguin, 0.020, {0}, 0, 1, 1.0},    {sm_sculpt_statue, 0.0152, {0}, 0, 1, 1.98},
    {sm_sculpt_infant, 0.0085, {0}, 0, 1, 0.6},    {sm_sculpt_hand, 0.0028, {0}, 0, 1, 0.19},
    {sm_sculpt_liver, 0.0060, {0}, 0, 0, 0.22},    {sm_sculpt_flower, 0.0034, {0}, 0, 1, 0.4},
    {sm_sculpt_balljoint, 0.0018, {0}, 0, 1, 0.2}, {sm_sculpt_rabbit, 0.0030, {0}, 0, 1, 0.3},
    {sm_sculpt_santa, 0.0026, {0}, 0, 1, 0.3},     {sm_sculpt_rockerarm, 0.00085, {0}, 0, 0, 0.2},
    {sm_sculpt_gargoyle, 0.0016, {0}, 0, 1, 0.3},  {sm_sculpt_rabbit, 0.00134, {0}, 0, 1, 0.3},
    {sm_sculpt_bust, 0.00082, {0}, 0, 1, 0.3},     {NULL, 0, {8, 8, 8}, 0.025, 1, 0.2},
    {NULL, 0, {32, 4, 4}, 0.025, 0, 0.8},          {NULL, 0, {28, 6, 6}, 0.02, 0, 0.56},
};

const SmShape *sm_shapes(int *count)
{
    *count = SHAPES;
    return shapes;
}

const SmShape *sm_shape_find(const char *name)
{
    for (int i = 0; i < SHAPES; i++)
        if (strcmp(shapes[i].name, name) == 0) return &shapes[i];
    return NULL;
}

/* Six sides of squares cut in two; the sides' corners still have to be merged. */
static void make_box(const Recipe *recipe, SmMesh *mesh)
{
    const int *n = recipe->grid;
    long squares = 2L * (n[0] * n[1] + n[1] * n[2] + n[2] * n[0]);
    mesh->position = sm_alloc(4 * (size_t)squares, sizeof *mesh->position);
    mesh->triangle = sm_alloc(2 * (size_t)squares, sizeof *mesh->triangle);
    for (int side = 0; side < 6; side++) {
        int axis = side / 2, u = (axis + 1 + side % 2) % 3, w = (axis + 2 - side % 2) % 3;
        for (int s = 0; s < n[u] * n[w]; s++) {
            int first = (int)mesh->vertex_count;
            for (int c = 0; c < 4; c++) {
                double *p = mesh->position[mesh->vertex_count++];
                p[axis] = recipe->square * (side % 2 ? 0 : n[axis]);
                p[u] = recipe->square * (s % n[u] + (c == 1 || c == 2));
                p[w] = recipe->square * (s / n[u] + (c >= 2));
            }
            for (int half = 0; half < 2; half++) {
                int *t = mesh->triangle[mesh->triangle_count++];
                t[0] = first, t[1] = first + 1 + half, t[2] = first + 2 + half;
            }
        }
    }
    sm_mesh_merge(mesh);
}

static void make_sculpture(const Recipe *recipe, long triangles, SmMesh *mesh)
{
    SmImplicit solid = {0};
    recipe->sculpt(&solid);
    SmBox box = sm_implicit_bounds(&solid);
    /* Odd margins keep flat faces and the plane of symmetry off the lattice's planes. */
    for (int i = 0; i < 3; i++) {
        box.low[i] -= (2.137 + 0.071 * i) * recipe->cell;
        box.high[i] += 2 * recipe->cell;
    }
    sm_polygonise(&solid, &box, recipe->cell, mesh);
    sm_decimate(mesh, triangles);
    sm_implicit_free(&solid);
}

static void set_in_place(const Recipe *recipe, SmMesh *mesh)
{
    SmBox box = sm_box_around(mesh->vertex_count, (const double(*)[3])mesh->position);
    double scale = recipe->length / (box.high[recipe->axis] - box.low[recipe->axis]);
    for (long v = 0; v < mesh->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            double foot = i == 1 ? box.low[i] : 0.5 * (box.low[i] + box.high[i]);
            mesh->position[v][i] = scale * (mesh->position[v][i] - foot) + 0.0; /* no -0 */
        }
}

static SmCode refuse(const char *name, SmError *error)
{
    char names[512] = "";
    for (int i = 0; i < SHAPES; i++)
        sm_append(names, sizeof names, "%s%s",
                  !i               ? ""
                  : i < SHAPES - 1 ? ", "
                                   : " and ",
                  shapes[i].name);
    return sm_fail(error, SM_USAGE, "%s: no such shape; there are %s", name, names);
}

SmCode sm_shape_mesh(const char *name, SmMesh *mesh, SmError *error)
{
    const SmShape *shape = sm_shape_find(name);
    memset(mesh, 0, sizeof *mesh);
    if (!shape) return refuse(name, error);
    const Recipe *recipe = &recipes[shape - shapes];
    if (recipe->sculpt)
        make_sculpture(recipe, shape->triangles, mesh);
    else
        make_box(recipe, mesh);
    set_in_place(recipe, mesh);
    return SM_OK;
}
