#include "draft.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "polygon.h"

static const double most_cut = 1e9; /* squares of polygons' corners: seconds of cutting */

static long place_of_draft(const SmDraft *draft)
{
    return draft->line ? draft->line : (long)(draft->at - draft->begin);
}

bool sm_draft_fail(SmDraft *draft, const char *format, ...)
{
    char text[sizeof draft->error->text], place[40] = "";
    va_list arguments;
    va_start(arguments, format);
    sm_write_line(text, sizeof text, format, arguments);
    va_end(arguments);
    if (draft->at)
        snprintf(place, sizeof place, "%s %ld: ", draft->line ? "line" : "byte",
                 place_of_draft(draft));
    sm_fail(draft->error, SM_INPUT, "%s: %s%s", draft->file->name, place, text);
    return false;
}

static void set_rooms(SmDraft *draft, long vertices, long triangles)
{
    SmMesh *mesh = &draft->mesh;
    size_t v = (size_t)vertices, t = (size_t)triangles;
    if (vertices > draft->vertex_room) {
        mesh->position = sm_realloc(mesh->position, v, sizeof *mesh->position);
        if (draft->of_points) draft->normal = sm_realloc(draft->normal, v, sizeof(double[3]));
        draft->vertex_room = vertices;
    }
    if (triangles > draft->triangle_room) {
        mesh->triangle = sm_realloc(mesh->triangle, t, sizeof *mesh->triangle);
        draft->triangle_room = triangles;
    }
}

void sm_draft_reserve(SmDraft *draft, long vertices, long triangles)
{
    set_rooms(draft, draft->mesh.vertex_count + vertices, draft->mesh.triangle_count + triangles);
}

static bool fail_parts(SmDraft *draft)
{
    return sm_draft_fail(draft,
                         "it uses its parts so often that they make more than %.2g million "
                         "triangles, which a file of its size does not hold: export one of each "
                         "part",
                         draft->most / 1e6);
}

bool sm_draft_vertex(SmDraft *draft, const double position[3], const double normal[3])
{
    static const double none[3];
    long v = draft->mesh.vertex_count;
    if (v == INT_MAX)
        return sm_draft_fail(draft, "more than %d vertices; divide the mesh", INT_MAX);
    if ((double)v >= 3 * draft->most) return fail_parts(draft);
    for (int d = 0; d < 3; d++)
        if (!isfinite(position[d]))
            return sm_draft_fail(draft,
                                 "the %c of a vertex is not a finite number (nan, inf or too "
                                 "large); correct it, or export the mesh again",
                                 "xyz"[d]);
    if (v == draft->vertex_room) set_rooms(draft, 2 * v + 64, 0);
    memcpy(draft->mesh.position[v], position, sizeof *draft->mesh.position);
    if (draft->of_points) memcpy(draft->normal[v], normal ? normal : none, sizeof none);
    draft->mesh.vertex_count++;
    return true;
}

bool sm_draft_corner(SmDraft *draft, double vertex)
{
    if (!(vertex >= 0 && vertex < INT_MAX && vertex == rint(vertex)))
        return sm_draft_fail(draft, "a face names vertex %.17g (counted from 0)" SM_AGAIN, vertex);
    sm_make_room(draft->corner, draft->corner_room, draft->corners + 1);
    draft->corner[draft->corners++] = (int)vertex;
    if ((long)vertex > draft->largest) {
        draft->largest = (long)vertex;
        draft->largest_at = place_of_draft(draft);
    }
    return true;
}

bool sm_draft_face(SmDraft *draft)
{
    SmMesh *mesh = &draft->mesh;
    long count = draft->corners, first = mesh->triangle_count, all = first + count - 2;
    draft->corners = 0;
    draft->left_out.lines += count == 2;
    draft->left_out.points += count == 1;
    if (count < 3) return true;
    if (all > INT_MAX)
        return sm_draft_fail(draft, "more than %d triangles; divide the mesh", INT_MAX);
    if ((double)all > draft->most) return fail_parts(draft);
    if (all > draft->triangle_room) set_rooms(draft, 0, 2 * all + 64);
    memcpy(mesh->triangle[first], draft->corner, (size_t)count * sizeof *draft->corner);
    mesh->triangle_count = all;
    if (count == 3) return true;
    sm_make_room(draft->polygon, draft->polygon_room, draft->polygons + 1);
    draft->polygon[draft->polygons][0] = first;
    draft->polygon[draft->polygons++][1] = count;
    return true;
}

bool sm_draft_finish(SmDraft *draft)
{
    SmMesh *mesh = &draft->mesh;
    draft->at = NULL;
    if (draft->largest >= mesh->vertex_count)
        return sm_draft_fail(draft,
                             "%s %ld: a face names vertex %ld of %ld (counted from 1)" SM_AGAIN,
                             draft->line ? "line" : "byte", draft->largest_at, draft->largest + 1,
                             mesh->vertex_count);
    double cost = 0;
    for (long p = 0; p < draft->polygons; p++) {
        long first = draft->polygon[p][0], count = draft->polygon[p][1];
        if (count > 8) cost += (double)count * (double)count;
        if (cost > most_cut)
            return sm_draft_fail(draft,
                                 "its polygons have too many corners to be cut; export it as "
                                 "triangles");
        memcpy(draft->corner, mesh->triangle[first], (size_t)count * sizeof *draft->corner);
        sm_polygon_cut((const double(*)[3])mesh->position, draft->corner, (int)count,
                       mesh->triangle + first);
    }
    return true;
}
