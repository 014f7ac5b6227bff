/* surface_map.h - conformal parameters of a surface that is given by a mesh or by points (meshless
 * section 4.2; Gu and Yau 2003).
 *
 * Every surface here gets a flat metric that is conformal to its own, and cut open it is a
 * rectangle (chart.h), or several:
 *     - a disk has four corners on its rim, and a part of the rim along each side;
 *     - an annulus (a tube) closes around the first axis, with rims above and below;
 *     - a cap, a disk that bulges, does so, too, but is folded above;
 *     - a torus closes around both axes, with a shift;
 *     - a sphere is folded above and below;
 *     - a multitorus, a closed surface of genus 2 and more, is as many cylinders as 3 genus - 3, in
 *       a row in the plane, that are joined along intervals (multitorus.h, body/cylinders.h);
 *     - a holed surface, of three rims and more, or of a handle and a rim, is cylinders, too, at
 *       which a rim is a side, or intervals of two sides.
 * Taken twice and glued along a cut, what has a fold is an annulus or a torus, of which it is the
 * half that half a turn leaves. Harmonic one-forms are found on these (harmonic.h): their energies
 * say the rectangle's shape, and their integrals are the parameters. Edges of the triangulation are
 * turned before to a Delaunay one, whose weights are not negative. */
#ifndef REF_SURFACE_MAP_H
#define REF_SURFACE_MAP_H

#include "../../../lib/mesh/mesh.h"
#include "../shell/chart.h"
#include "triangulation.h"

typedef enum {
    REF_MAP_DISK,
    REF_MAP_CAP,
    REF_MAP_ANNULUS,
    REF_MAP_TORUS,
    REF_MAP_SPHERE,
    REF_MAP_MULTITORUS,
    REF_MAP_HOLED
} RefMapKind;

typedef struct {
    RefMapKind kind;
    RefChart chart;     /* its area is the surface's; it lives as long as the map */
    long vertices;      /* the mesh's */
    double (*theta)[2]; /* [vertices] in the chart's rectangle; of those that no triangle has, or
                           a piece that was dropped, that of the nearest place */
    double *factor;     /* [vertices] L */
    /* Of the triangulation's angles, on the surface and in the plane: the median of the differences
     * and what 95% of them are below, in degrees. */
    double angle_median, angle_95;
    long dropped;          /* the mesh's triangles that are doubled, or of small other pieces */
    int handles;           /* that were cut */
    int closed;            /* rims: short ones, and those with which there is no map */
    long triangles, flips; /* flips: turned over in the plane, or collapsed */
    double seconds;
    struct RefMapSurface *surface; /* private */
} RefSurfaceMap;

/* Maps the surface. Pieces of up to 1% of the triangles are dropped. Rims are closed, each with a
 * vertex in its middle but those of two edges, that are shorter than a tenth of the root of the
 * area, or than a half if they have three edges; triangles of an only rim of so few are cut in
 * four. Handles that one rectangle does not take are cut where a line around them or through their
 * tunnel is shorter than a tenth, and both sides closed. Three and more rims that are all shorter
 * than a half and make no handles, holes of a scan, are closed. Where no map of several cylinders
 * is found that turns no triangle over, the shortest of rims and such lines is closed or cut, too,
 * then two more, then four more, up to a half, and the best map is kept. The mesh has passed
 * sm_mesh_prepare() or is ref_local_triangles()'s, and is no longer needed afterwards; `name` is
 * for messages. Up to three factorisations of [vertices], for a cap or a sphere one of them and one
 * of [2 * vertices]; as many again where a triangle is turned over at first, or for each of those
 * that are tried. The caller frees. Of triangles between points (`of_points`,
 * surface/local_triangles.h) pieces of up to 5% are dropped, and rims of up to twelve edges are
 * closed, too, up to half the root of the area. Errors: triangulation.h's and solver.h's; SM_INPUT,
 * one whose triangles are but lines, one of several cylinders of whose maps each turns a triangle
 * over, and one whose parts stick out so far that over 1% of the triangles collapse in double
 * precision. */
SmCode ref_surface_map_create(const SmMesh *mesh, bool of_points, const char *name,
                              RefSurfaceMap *map, SmError *error);

/* The parameters of points near the surface: those of the nearest place of the triangles around the
 * four vertices that are nearest to each. What the mesh's vertices have is map->theta. O(log n) for
 * each point, after O(n log n). */
void ref_surface_map_feet(const RefSurfaceMap *map, long count, const double (*x)[3],
                          double (*theta)[2]);

void ref_surface_map_free(RefSurfaceMap *map);

/* The triangles that are mapped, as long as the map lives: the mesh's that were not dropped, with
 * those that close it, and edges turned. */
const RefTriangulation *ref_surface_map_triangles(const RefSurfaceMap *map);

/* One of them in the plane, counter-clockwise unless it is turned over: its first corner in the
 * rectangle, or its middle in one of several, the rest next to it, maybe beyond a seam; L at its
 * corners; and how far its angles there are off, in degrees. */
typedef struct {
    double theta[3][2], factor[3], off[3];
} RefMapTriangle;

RefMapTriangle ref_surface_map_triangle(const RefSurfaceMap *map, long triangle);

/* disk, cap, annulus, torus, sphere, multitorus or holed surface. */
const char *ref_map_kind_name(RefMapKind kind);

#endif
