#include "local_triangles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../../lib/polar.h"
#include "cloud.h"

enum { NEAR = 32, FIT = 14, MOST_CORNERS = NEAR + 8, MOST_AROUND = 24 };

/* A triangle of points, rising, and how many of them have it. */
typedef struct {
    int point[3], votes;
} Claim;

typedef struct {
    long count;
    const double (*position)[3];
    int (*near)[NEAR + 1]; /* [count] the nearest points, itself among them, or -1 */
    bool *again;           /* [count] at the position of an earlier point: has no triangle */
    double (*normal)[3];   /* [count] of unit length */
    double (*axis)[2][3];  /* [count] across the normals */
    long claims, room;
    Claim *claim;
    int (*around)[MOST_AROUND]; /* [count] the triangles that were taken, by number */
    int *degree;                /* [count] how many those are */
    SmMesh *mesh;
} Work;

/* The direction of least extent, of the 3 x 3 matrix of second moments. */
static void least_direction(double moment[9], double direction[3])
{
    double V[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    int least = 0;
    sm_jacobi(3, moment, V, 1e-15);
    for (int k = 1; k < 3; k++)
        if (moment[4 * k] < moment[4 * least]) least = k;
    for (int d = 0; d < 3; d++) direction[d] = V[3 * d + least];
}

/* The normal of the plane that fits points. */
static void fit_plane(const double (*position)[3], int count, const int *point, double normal[3])
{
    double mean[3] = {0}, moment[9] = {0};
    for (int n = 0; n < count; n++)
        for (int d = 0; d < 3; d++) mean[d] += position[point[n]][d] / count;
    for (int n = 0; n < count; n++) {
        double way[3];
        sm_subtract(position[point[n]], mean, way);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) moment[3 * i + j] += way[i] * way[j];
    }
    least_direction(moment, normal);
}

/* Two axes across a normal. */
static void span(const double normal[3], double axis[2][3])
{
    int least = 0;
    for (int d = 1; d < 3; d++)
        if (fabs(normal[d]) < fabs(normal[least])) least = d;
    double other[3] = {least == 0, least == 1, least == 2};
    sm_cross(normal, other, axis[0]);
    sm_normalize(axis[0]);
    sm_cross(normal, axis[0], axis[1]);
}

/* From one point to another, in the first one's plane. */
static void flatten(const Work *work, long from, long to, double way[2])
{
    double x[3];
    sm_subtract(work->position[to], work->position[from], x);
    for (int k = 0; k < 2; k++) way[k] = sm_dot(x, work->axis[from][k]);
}

/* A point's Voronoi cell in its plane: corners in turn, each with the neighbour behind the side
 * that begins there, or -1. */
typedef struct {
    int corners;
    double corner[MOST_CORNERS][2];
    long behind[MOST_CORNERS];
} Cell;

/* Cuts off what is nearer to a place than to the origin. */
static void clip(Cell *cell, const double place[2], long point)
{
    double off[MOST_CORNERS], half = (place[0] * place[0] + place[1] * place[1]) / 2;
    bool cuts = false;
    for (int n = 0; n < cell->corners; n++) {
        off[n] = cell->corner[n][0] * place[0] + cell->corner[n][1] * place[1] - half;
        cuts = cuts || off[n] > 0;
    }
    if (!cuts || cell->corners + 2 > MOST_CORNERS) return;
    Cell kept = {0};
    for (int n = 0; n < cell->corners; n++) {
        int next = (n + 1) % cell->corners;
        if (off[n] <= 0) {
            memcpy(kept.corner[kept.corners], cell->corner[n], sizeof *kept.corner);
            kept.behind[kept.corners++] = cell->behind[n];
        }
        if ((off[n] <= 0) == (off[next] <= 0)) continue;
        double share = off[n] / (off[n] - off[next]);
        for (int d = 0; d < 2; d++)
            kept.corner[kept.corners][d] =
                cell->corner[n][d] + share * (cell->corner[next][d] - cell->corner[n][d]);
        kept.behind[kept.corners++] = off[n] <= 0 ? point : cell->behind[n];
    }
    *cell = kept;
}

static void claim(Work *work, long a, long b, long c)
{
    int point[3] = {(int)a, (int)b, (int)c};
    for (int k = 1; k < 3; k++)
        for (int j = k; j > 0 && point[j - 1] > point[j]; j--) {
            int other = point[j];
            point[j] = point[j - 1];
            point[j - 1] = other;
        }
    sm_make_room(work->claim, work->room, work->claims + 1);
    work->claim[work->claims++] = (Claim){{point[0], point[1], point[2]}, 1};
}

/* Claims the Delaunay triangles of a point whose circles are no larger than half the distance
 * within which all its neighbours are known. What lies above or below more than beside, or looks
 * the other way, is another sheet's. */
static void claim_around(Work *work, long p)
{
    double reach = 0, way[2];
    const int *near = work->near[p];
    Cell cell = {.corners = 4};
    for (int n = 0; n <= NEAR && near[n] >= 0; n++)
        reach = sqrt(sm_square_between(work->position[p], work->position[near[n]])) / 2;
    for (int n = 0; n < 4; n++) {
        cell.corner[n][0] = 1.5 * (n == 0 || n == 3 ? reach : -reach);
        cell.corner[n][1] = 1.5 * (n < 2 ? reach : -reach);
        cell.behind[n] = -1;
    }
    for (int n = 0; n <= NEAR && near[n] >= 0; n++) {
        double distance = sqrt(sm_square_between(work->position[p], work->position[near[n]]));
        flatten(work, p, near[n], way);
        if (!work->again[near[n]] && hypot(way[0], way[1]) > 0.7 * distance &&
            sm_dot(work->normal[p], work->normal[near[n]]) > 0)
            clip(&cell, way, near[n]);
    }
    for (int n = 0; n < cell.corners; n++) {
        long last = cell.behind[(n + cell.corners - 1) % cell.corners], next = cell.behind[n];
        if (last < 0 || next < 0 || last == next) continue;
        if (hypot(cell.corner[n][0], cell.corner[n][1]) <= reach) claim(work, p, last, next);
    }
}

static void find_near(Work *work, const RefCloud *cloud)
{
    long near[NEAR + 1];
    double distance[NEAR + 1];
    for (long p = 0; p < work->count; p++) {
        int found = ref_cloud_nearest(cloud, work->position[p], NEAR + 1, near, distance);
        for (int n = 0; n <= NEAR; n++) work->near[p][n] = n < found ? (int)near[n] : -1;
        for (int n = 0; n < found && distance[n] == 0; n++)
            work->again[p] = work->again[p] || near[n] < p;
    }
}

/* Links of points that look the same way, waiting to be followed: by how much they do. */
enum { LEVELS = 64 };
typedef struct {
    long count, room;
    int (*link)[2];
} Waiting;

static void wait_around(const Work *work, int p, const bool *settled, Waiting *waiting)
{
    for (int n = 0; n < FIT && work->near[p][n] >= 0; n++) {
        int q = work->near[p][n];
        if (settled[q]) continue;
        double alike = fabs(sm_dot(work->normal[p], work->normal[q]));
        Waiting *level = waiting + (int)((LEVELS - 1) * fmin(alike, 1));
        sm_make_room(level->link, level->room, level->count + 1);
        level->link[level->count][0] = p;
        level->link[level->count++][1] = q;
    }
}

/* Turns normals to look as their neighbours' do, over the links along which they turn least (Hoppe
 * et al. 1992). */
static void spread_sides(const Work *work, bool *settled, Waiting *waiting)
{
    for (int level = LEVELS - 1; level >= 0;) {
        if (waiting[level].count == 0) {
            level--;
            continue;
        }
        const int *link = waiting[level].link[--waiting[level].count];
        int p = link[0], q = link[1];
        if (settled[q]) continue;
        settled[q] = true;
        if (sm_dot(work->normal[p], work->normal[q]) < 0)
            for (int d = 0; d < 3; d++) work->normal[q][d] *= -1;
        wait_around(work, q, settled, waiting);
        level = LEVELS - 1;
    }
}

/* A point's coordinate along x, to be sorted. */
typedef struct {
    double x;
    int point;
} Along;

static int farther(const void *a, const void *b)
{
    const Along *p = a, *q = b;
    return (p->x < q->x) - (p->x > q->x);
}

/* Gives normals that were found a side: that of given ones nearby, and where there are none, out of
 * the point that is farthest along x. */
static void choose_sides(const Work *work, bool *settled)
{
    Waiting waiting[LEVELS] = {{0}};
    Along *along = sm_alloc((size_t)work->count, sizeof *along);
    for (int p = 0; p < work->count; p++) {
        along[p] = (Along){work->position[p][0], p};
        if (settled[p]) wait_around(work, p, settled, waiting);
    }
    qsort(along, (size_t)work->count, sizeof *along, farther);
    spread_sides(work, settled, waiting);
    for (long n = 0; n < work->count; n++) {
        int p = along[n].point;
        if (settled[p]) continue;
        settled[p] = true;
        for (int d = 0; d < 3 && work->normal[p][0] < 0; d++) work->normal[p][d] *= -1;
        wait_around(work, p, settled, waiting);
        spread_sides(work, settled, waiting);
    }
    for (int level = 0; level < LEVELS; level++) free(waiting[level].link);
    free(along);
}

/* Whether given normals do not say which side is which: over one pair of neighbours in ten look
 * apart, and not as two sheets do, whose points all lie behind or all before each other. How far
 * behind is taken by both normals, so that what the surface bends by cancels. */
static bool are_at_odds(const Work *work)
{
    double behind = 0, off = 0;
    long pairs = 0, apart = 0;
    for (long p = 0; p < work->count; p++)
        for (int n = 0; n < FIT && work->near[p][n] >= 0; n++) {
            int q = work->near[p][n];
            const double *a = work->normal[p], *b = work->normal[q];
            double way[3];
            pairs += q != p;
            if (!(sm_dot(a, b) < 0)) continue;
            apart++;
            sm_subtract(work->position[q], work->position[p], way);
            double ahead = sm_dot(way, a) - sm_dot(way, b);
            behind -= ahead;
            off += fabs(ahead);
        }
    return 10 * apart > pairs && fabs(behind) <= off / 2;
}

/* Normals and planes. */
static void find_planes(Work *work, const double (*normal)[3])
{
    bool *settled = sm_alloc((size_t)work->count, sizeof *settled);
    for (long p = 0; p < work->count; p++) {
        if (normal) memcpy(work->normal[p], normal[p], sizeof *normal);
        settled[p] = sm_normalize(work->normal[p]);
    }
    if (are_at_odds(work)) memset(settled, 0, (size_t)work->count * sizeof *settled);
    for (long p = 0; p < work->count; p++) {
        int fit = 0;
        if (settled[p]) continue;
        while (fit < FIT && work->near[p][fit] >= 0) fit++;
        fit_plane(work->position, fit, work->near[p], work->normal[p]);
        sm_normalize(work->normal[p]);
    }
    choose_sides(work, settled);
    for (long p = 0; p < work->count; p++) span(work->normal[p], work->axis[p]);
    free(settled);
}

static int by_points(const void *a, const void *b)
{
    const Claim *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p->point[k] != q->point[k]) return p->point[k] < q->point[k] ? -1 : 1;
    return 0;
}

/* Claims of the same triangle become one with so many votes. */
static void count_votes(Work *work)
{
    long kept = 0;
    if (work->claims == 0) return;
    qsort(work->claim, (size_t)work->claims, sizeof *work->claim, by_points);
    for (long n = 0; n < work->claims; n++)
        if (kept > 0 && by_points(work->claim + kept - 1, work->claim + n) == 0)
            work->claim[kept - 1].votes++;
        else
            work->claim[kept++] = work->claim[n];
    work->claims = kept;
}

/* Twice the area between two ways. */
static double between(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

/* Whether direction x is strictly inside the angle from a to b, which is below half a turn. */
static bool inside(const double a[2], const double b[2], const double x[2])
{
    double tiny = 1e-9 * (hypot(a[0], a[1]) + hypot(b[0], b[1])) * hypot(x[0], x[1]);
    return between(a, x) > tiny && between(x, b) > tiny;
}

/* Whether triangles a and b, which share point p, lie over each other there: in its plane. */
static bool overlap_at(const Work *work, int p, const int a[3], const int b[3])
{
    double side[2][2][2];
    int end[2][2] = {{0}};
    for (int t = 0; t < 2; t++) {
        const int *triangle = t ? b : a;
        for (int k = 0, found = 0; k < 3; k++)
            if (triangle[k] != p) end[t][found++] = triangle[k];
        for (int k = 0; k < 2; k++) flatten(work, p, end[t][k], side[t][k]);
        if (between(side[t][0], side[t][1]) < 0) {
            double way[2];
            int other = end[t][0];
            memcpy(way, side[t][0], sizeof way);
            memcpy(side[t][0], side[t][1], sizeof way);
            memcpy(side[t][1], way, sizeof way);
            end[t][0] = end[t][1];
            end[t][1] = other;
        }
    }
    for (int k = 0; k < 2; k++) {
        if (end[0][k] == end[1][k]) return true; /* from one edge to the same side */
        if (end[0][0] != end[1][k] && end[0][1] != end[1][k] &&
            inside(side[0][0], side[0][1], side[1][k]))
            return true;
        if (end[1][0] != end[0][k] && end[1][1] != end[0][k] &&
            inside(side[1][0], side[1][1], side[0][k]))
            return true;
    }
    return false;
}

/* Whether a triangle that is there runs along an edge from p to q. */
static bool runs_along(const Work *work, int p, int q)
{
    for (int n = 0; n < work->degree[p]; n++) {
        const int *triangle = work->mesh->triangle[work->around[p][n]];
        for (int k = 0; k < 3; k++)
            if (triangle[k] == p && triangle[(k + 1) % 3] == q) return true;
    }
    return false;
}

/* Whether a triangle fits beside those that are there. */
static bool fits(const Work *work, const int point[3])
{
    for (int k = 0; k < 3; k++) {
        int p = point[k];
        if (work->degree[p] == MOST_AROUND || runs_along(work, p, point[(k + 1) % 3])) return false;
        for (int n = 0; n < work->degree[p]; n++)
            if (overlap_at(work, p, point, work->mesh->triangle[work->around[p][n]])) return false;
    }
    return true;
}

/* Turns a triangle to look as its points do. */
static void face(const Work *work, const int point[3], int corner[3])
{
    double area[3], side = 0;
    sm_area_vector(work->position[point[0]], work->position[point[1]], work->position[point[2]],
                   area);
    for (int k = 0; k < 3; k++) side += sm_dot(area, work->normal[point[k]]);
    for (int k = 0; k < 3; k++) corner[k] = point[side < 0 ? 2 - k : k];
}

static void take_all(Work *work)
{
    SmMesh *mesh = work->mesh;
    mesh->triangle = sm_realloc(mesh->triangle, (size_t)work->claims + 1, sizeof *mesh->triangle);
    for (int votes = 3; votes > 0; votes--)
        for (long n = 0; n < work->claims; n++) {
            int corner[3];
            if (work->claim[n].votes != votes) continue;
            face(work, work->claim[n].point, corner);
            if (!fits(work, corner)) continue;
            for (int k = 0; k < 3; k++)
                work->around[corner[k]][work->degree[corner[k]]++] = (int)mesh->triangle_count;
            memcpy(mesh->triangle[mesh->triangle_count++], corner, sizeof corner);
        }
}

static SmCode check(long count, const double (*position)[3], const char *name, SmError *error)
{
    if (count < REF_LEAST_POINTS)
        return sm_fail(error, SM_INPUT, "%s: %ld points are too few for a surface: %d or more",
                       name, count, REF_LEAST_POINTS);
    for (long p = 0; p < count; p++)
        for (int d = 0; d < 3; d++)
            if (!(fabs(position[p][d]) < 1e30))
                return sm_fail(error, SM_INPUT,
                               "%s: point %ld has a coordinate that is no number, or beyond 1e30",
                               name, p + 1);
    return SM_OK;
}

SmCode ref_local_triangles(long count, const double (*position)[3], const double (*normal)[3],
                           const char *name, SmMesh *mesh, SmError *error)
{
    *mesh = (SmMesh){0};
    SmCode code = check(count, position, name, error);
    if (code != SM_OK) return code;
    size_t size = (size_t)count;
    *mesh = sm_mesh_new(count, 0);
    memcpy(mesh->position, position, size * sizeof *position);
    Work work = {.count = count,
                 .position = position,
                 .near = sm_alloc(size, sizeof *work.near),
                 .again = sm_alloc(size, sizeof *work.again),
                 .normal = sm_alloc(size, sizeof *work.normal),
                 .axis = sm_alloc(size, sizeof *work.axis),
                 .around = sm_alloc(size, sizeof *work.around),
                 .degree = sm_alloc(size, sizeof *work.degree),
                 .mesh = mesh};
    RefPoints points = {.count = count, .position = mesh->position, .normal = work.normal};
    RefCloud cloud;
    ref_cloud_create(&points, &cloud);
    find_near(&work, &cloud);
    ref_cloud_free(&cloud);
    find_planes(&work, normal);
    for (long p = 0; p < count; p++)
        if (!work.again[p]) claim_around(&work, p);
    count_votes(&work);
    take_all(&work);
    sm_free_all(work.near, work.again, work.normal, work.axis, work.claim, work.around,
                work.degree);
    if (mesh->triangle_count > 0) return SM_OK;
    sm_mesh_free(mesh);
    return sm_fail(error, SM_INPUT, "%s: the %ld points lie in no surface", name, count);
}

SmCode ref_local_triangles_read(const char *path, SmMesh *mesh, SmError *error)
{
    long count;
    double(*position)[3], (*normal)[3];
    *mesh = (SmMesh){0};
    SmCode code = ref_points_rows(path, true, &count, &position, &normal, error);
    if (code != SM_OK) return code;
    code = ref_local_triangles(count, (const double(*)[3])position, (const double(*)[3])normal,
                               path, mesh, error);
    sm_free_all(position, normal);
    return code;
}
