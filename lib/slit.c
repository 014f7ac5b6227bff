#include "slit.h"

#include <stdlib.h>
#include <string.h>

#include "vector.h"
#include "wedge.h"

/* Of a cell: what a cut takes away, and what does not matter. */
static const double thickness = 1e-4, slack = 1e-10;

enum { TRIES = 5 };

void sm_slit_change_free(SmSlitChange *change)
{
    sm_carve_change_free(&change->mesh);
    free(change->side);
    *change = (SmSlitChange){0};
}

static bool is_inside_out(const SmMesh *mesh)
{
    double volume = 0;
    for (long t = 0; t < mesh->triangle_count; t++) {
        double u[3], v[3], w[3], cross[3];
        const double *o = mesh->position[0];
        for (int d = 0; d < 3; d++) {
            u[d] = mesh->position[mesh->triangle[t][0]][d] - o[d];
            v[d] = mesh->position[mesh->triangle[t][1]][d] - o[d];
            w[d] = mesh->position[mesh->triangle[t][2]][d] - o[d];
        }
        sm_cross(v, w, cross);
        volume += sm_dot(u, cross);
    }
    return volume < 0;
}

/* The new vertices from `from` on: which vertices of the cut they are, and on which side. */
static void note_sides(SmSlitChange *change, long from, const SmWedgeOrigin *origin)
{
    long count = change->mesh.vertices;
    if (count > change->side_room) {
        change->side_room = 2 * count;
        change->side = sm_realloc(change->side, (size_t)change->side_room, sizeof *change->side);
    }
    for (long n = from; n < count; n++) {
        int *solid = &change->mesh.origin[n].solid;
        change->side[n] = *solid < 0 ? 0 : origin[*solid].side;
        if (*solid >= 0) *solid = origin[*solid].vertex;
    }
}

typedef struct {
    SmMesh *mesh;
    const SmCut *cut;
    double cell;
    bool inside_out;
    SmSlitChange *change;
} Slit;

/* One solid for triangles first .. last - 1; other random moves, and at last without closing. */
static SmSlitResult carve(const Slit *s, long first, long last)
{
    static const SmSlitResult meaning[] = {SM_SLIT_MISSED, SM_SLIT_CLOSED, SM_SLIT_OPEN};
    SmCarveOptions options = {s->inside_out, true, slack * s->cell};
    for (int try = 0; try < 2 * TRIES; try++) {
        SmMesh solid;
        SmWedgeOrigin *origin;
        SmWedgeOptions wedge = {thickness * s->cell, (unsigned)(first * 2 * TRIES + try)};
        if (!sm_wedge_make(s->cut, first, last, &wedge, &solid, &origin)) return SM_SLIT_LEFT;
        options.close = try < TRIES;
        long from = s->change->mesh.vertices;
        SmCarveResult result = sm_carve(s->mesh, &solid, &options, &s->change->mesh);
        note_sides(s->change, from, origin);
        sm_mesh_free(&solid);
        free(origin);
        if (result != SM_CARVE_FAILED) return meaning[result];
    }
    return SM_SLIT_LEFT;
}

static bool has_area(const SmCut *cut, long t, double least)
{
    double u[3], v[3], normal[3];
    for (int d = 0; d < 3; d++) {
        u[d] = cut->vertex[cut->triangle[t][1]][d] - cut->vertex[cut->triangle[t][0]][d];
        v[d] = cut->vertex[cut->triangle[t][2]][d] - cut->vertex[cut->triangle[t][0]][d];
    }
    sm_cross(u, v, normal);
    return sqrt(sm_dot(normal, normal)) > least;
}

/* A solid for every triangle: they overlap, and each is simple. */
static SmSlitResult carve_each(const Slit *s, long first)
{
    SmSlitResult worst = SM_SLIT_MISSED;
    bool left = false;
    for (long t = first; t < s->cut->triangles; t++) {
        SmSlitResult result = carve(s, t, t + 1);
        if (result == SM_SLIT_LEFT)
            left |= has_area(s->cut, t, 0.01 * s->cell * s->cell);
        else if (result > worst)
            worst = result;
    }
    return left ? SM_SLIT_LEFT : worst;
}

static SmMesh copy_mesh(const SmMesh *mesh)
{
    SmMesh copy = sm_mesh_new(mesh->vertex_count, mesh->triangle_count);
    memcpy(copy.position, mesh->position, (size_t)mesh->vertex_count * sizeof *copy.position);
    memcpy(copy.triangle, mesh->triangle, (size_t)mesh->triangle_count * sizeof *copy.triangle);
    return copy;
}

SmSlitResult sm_slit(SmMesh *mesh, const SmCut *cut, long first, double cell, SmSlitChange *change)
{
    SmSlitChange unused = {0};
    Slit s = {mesh, cut, cell, is_inside_out(mesh), change ? change : &unused};
    SmSlitResult result = carve(&s, first, cut->triangles);
    if (result == SM_SLIT_LEFT && cut->triangles > first) {
        SmMesh before = copy_mesh(mesh);
        SmCarveChange counts = s.change->mesh;
        result = carve_each(&s, first);
        if (result == SM_SLIT_LEFT) {
            sm_mesh_free(mesh);
            *mesh = before;
            s.change->mesh.vertices = counts.vertices;
            s.change->mesh.triangles = counts.triangles;
            s.change->mesh.dead = counts.dead;
        } else {
            sm_mesh_free(&before);
        }
    }
    sm_slit_change_free(&unused);
    return result;
}
