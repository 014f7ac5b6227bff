/* body.c - bodies of shapebench.h: creation, steps, reading and writing, handles and obstacles;
 * change.c has what changes them. */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../fastlsm/fastlsm.h"
#include "../../reference/brute.h"
#include "../../reference/meshless/engine.h"
#include "../../reference/meshless/shell_engine.h"
#include "../../reference/meshless/solve/solver.h"
#include "../box.h"
#include "../engine/boundary.h"
#include "../isa.h"
#include "../system/cores.h"
#include "../system/heap.h"
#include "../system/team.h"
#include "../vector.h"
#include "inner.h"

enum { MOST_COVERS = 12 }; /* wider functions cost much, and come to depend on one another */

static const char solvers[] = "CHOLMOD and ARPACK";

static const struct {
    const char *name;
    const SmEngineType *type[2]; /* by precision; NULL: it has none such */
    const char *needs;           /* NULL: it is in every library */
    const bool *built;           /* NULL: it is where its type is */
} engines[] = {
    [SB_FASTLSM] = {"fastlsm", {&fastlsm_engine_f32, &fastlsm_engine_f64}, NULL, NULL},
    [SB_OCTREE] = {"octree", {&octree_engine_f32, &octree_engine_f64}, NULL, NULL},
    [SB_BRUTE] = {"brute", {NULL, &ref_brute_engine}, "GSL", NULL},
    [SB_MESHLESS] = {"meshless", {NULL, &ref_meshless_engine}, solvers, &ref_solver_built},
    [SB_THIN_SHELL] = {"shell", {NULL, &ref_shell_engine}, solvers, &ref_solver_built},
};

const char *sb_engine_name(int engine)
{
    return engine >= 0 && engine < (int)(sizeof engines / sizeof *engines) ? engines[engine].name
                                                                           : NULL;
}

int sb_engine_available(int engine)
{
    return sb_engine_name(engine) && engines[engine].type[SB_DOUBLE]->create &&
           (!engines[engine].built || *engines[engine].built);
}

/* ---- creation */

void sb_body_params_init(sb_body_params *params)
{
    *params = (sb_body_params){.w = 2, .h = 0.01, .damping_every = 1, .instances = 1};
}

void sb_octree_params_init(sb_octree_params *params)
{
    *params = (sb_octree_params){0};
}

void sb_meshless_params_init(sb_meshless_params *params)
{
    *params = (sb_meshless_params){.young = 1e5, .poisson = 0.3, .density = 1000};
}

void sb_shell_params_init(sb_shell_params *params)
{
    *params = (sb_shell_params){.young = 1e5, .poisson = 0.3, .density = 1000};
}

/* Refuses an engine that is not there, or that does not do what is asked. */
static int check_engine(const sb_body_params *p, sb_error *error)
{
    const char *name = sb_engine_name(p->engine);
    if (!name)
        return sm_refuse(error, SB_USAGE, "'engine' is %d: there is no such engine", p->engine);
    if (!sb_engine_available(p->engine))
        return sm_refuse(error, SB_INPUT,
                         "the engine %s is not in this library, which was built without %s", name,
                         engines[p->engine].needs);
    int code = sm_check_range(p->precision, SB_SINGLE, SB_DOUBLE, "precision", error);
    if (code) return code;
    const SmEngineType *type = engines[p->engine].type[p->precision];
    if (!type)
        return sm_refuse(error, SB_INPUT, "the engine %s has double precision only: 'precision'",
                         name);
    if (p->cuttable && !type->cut && !type->refines)
        return sm_refuse(error, SB_INPUT, "'cuttable': the engine %s cuts no bodies", name);
    return SB_OK;
}

static int check_choices(const sb_body_params *p, sb_error *error)
{
    int code = sm_check_range(p->summation, SB_SUM_FAST, SB_SUM_NAIVE, "summation", error);
    if (!code) code = sm_check_range(p->polar, SB_POLAR_FAST, SB_POLAR_JACOBI, "polar", error);
    if (!code) code = sm_check_range(p->layout, SB_LAYOUT_AUTO, SB_LAYOUT_BLOCKS, "layout", error);
    if (!code) code = sm_check_range(p->threads, 0, SM_MOST_THREADS, "threads", error);
    if (!code) code = sm_check_range(p->damping_every, 0, INT_MAX, "damping_every", error);
    if (!code) code = sm_check_range((double)p->instances, 0, INT_MAX, "instances", error);
    return code;
}

/* A rotation to 1e-6, and a translation that is not far off. */
static int check_pose(const double *pose, double far, sb_error *error)
{
    int code = sm_check_finite(pose, 12, fmax(far, 2), "pose", error);
    for (int i = 0; i < 9 && !code; i++) {
        const double *a = pose + i / 3 * 4, *b = pose + i % 3 * 4;
        double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        if (!(fabs(dot - (i / 3 == i % 3)) <= 1e-6)) code = SB_USAGE;
    }
    double turned = 0;
    for (int d = 0; d < 3 && !code; d++)
        turned += pose[d] * (pose[4 + (d + 1) % 3] * pose[8 + (d + 2) % 3] -
                             pose[4 + (d + 2) % 3] * pose[8 + (d + 1) % 3]);
    if (!code && turned > 0) return SB_OK;
    return sm_refuse(
        error, SB_USAGE,
        "'pose' is no rigid motion: twelve finite numbers, three rows of a rotation and "
        "a translation of at most %g",
        far);
}

static int check_sizes(const sb_body_params *p, const SmVoxels *voxels, sb_error *error)
{
    const double cell = voxels->cell, particles = (double)voxels->particle_count;
    double bodies = p->instances > 1 ? (double)p->instances : 1;
    int code = SB_OK;
    if (!(p->h > 0 && p->h <= 1e6))
        return sm_refuse(error, SB_USAGE, "'h' is %g: a time step in seconds, above 0", p->h);
    for (int d = 0; d < 3; d++)
        if (!(fabs(p->gravity[d]) * p->h * p->h <= SB_FAR * cell))
            return sm_refuse(error, SB_USAGE,
                             "'gravity' is %g: a body would fly farther than 1e9 cells in a step",
                             p->gravity[d]);
    if (bodies * particles > 500e6)
        return sm_refuse(error, SB_INPUT,
                         "%g instances of %g particles: 500 million in all at most", bodies,
                         particles);
    if (p->cuttable && bodies > 1)
        return sm_refuse(error, SB_INPUT,
                         "'cuttable': instances share what would be cut: give one "
                         "body of its own to each");
    for (int64_t i = 0; p->pose && i < (int64_t)bodies && !code; i++)
        code = check_pose(p->pose + 12 * i, SB_FAR * cell, error);
    return code;
}

static int take_criteria(const sb_octree_params *p, OctOptions *to, sb_error *error)
{
    int code = sm_check_range(p->criteria_count, 0, OCT_MAX_CRITERIA, "criteria_count", error);
    for (int i = 0; i < p->criteria_count && !code; i++) {
        const sb_criterion *from = &p->criteria[i];
        OctCriterion *c = &to->sampling.criteria[i];
        code = sm_check_range(from->kind, SB_CELLS_ALL, SB_CELLS_SPHERE, "kind", error);
        *c = (OctCriterion){.kind = (OctCriterionKind)from->kind, .level = from->level};
        c->radius = from->radius;
        memcpy(c->low, from->low, sizeof c->low);
        memcpy(c->high, from->high, sizeof c->high);
        memcpy(c->centre, from->centre, sizeof c->centre);
    }
    to->sampling.criteria_count = p->criteria_count;
    return code;
}

static int take_widths(const sb_octree_params *p, OctOptions *to, sb_error *error)
{
    int code = sm_check_range(p->width_count, 0, OCT_MAX_WIDTHS, "width_count", error);
    for (int i = 0; i < p->width_count && !code; i++) {
        const sb_local_width *from = &p->widths[i];
        OctLocalWidth *w = &to->local[i];
        *w = (OctLocalWidth){.width = {from->cells, from->edges}, .radius = from->radius};
        memcpy(w->low, from->low, sizeof w->low);
        memcpy(w->high, from->high, sizeof w->high);
        memcpy(w->centre, from->centre, sizeof w->centre);
        code = sm_check_finite(&from->cells, 12, 1e30, "widths", error);
    }
    to->local_count = p->width_count;
    return code;
}

static int take_octree(const sb_octree_params *from, OctOptions *to, sb_error *error)
{
    const sb_octree_params p = from ? *from : (sb_octree_params){0};
    int code = sm_check_range(p.levels, 0, OCT_MAX_LEVELS, "levels", error);
    if (!code) code = sm_check_range((double)p.nodes, 0, 1e9, "nodes", error);
    if (!code) code = sm_check_range((double)p.bases, 0, 1e9, "bases", error);
    for (int d = 0; d < 3 && !code; d++)
        code = sm_check_range(p.corner[d], -OCT_MAX_WIDE, OCT_MAX_WIDE, "corner", error);
    if (!code) code = sm_check_range(p.mass_rule, 0, SB_MASS_VOLUME, "mass_rule", error);
    if (!code) code = sm_check_range(p.symmetry, 0, SB_SYMMETRY_NONE, "symmetry", error);
    if (!code) code = sm_check_range(p.weighting, 0, SB_WEIGHT_PLAIN, "weighting", error);
    if (!code) code = sm_check_range(p.goals, 0, SB_GOALS_ADJOINT, "goals", error);
    if (code) return code;
    *to = (OctOptions){.sampling = {.levels = p.levels,
                                    .nodes = p.nodes,
                                    .bases = p.bases,
                                    .balance = p.balance != 0},
                       .epsilon = p.epsilon,
                       .width = {p.width_cells, p.width_edges},
                       .summation_nodes = p.summation_nodes,
                       .masses = (OctMassRule)p.mass_rule,
                       .symmetry = (OctSymmetry)p.symmetry,
                       .weighting = (OctWeighting)p.weighting,
                       .form = (OctGoalForm)p.goals,
                       .yield = p.yield,
                       .creep = p.creep,
                       .most = p.most};
    memcpy(to->sampling.corner, p.corner, sizeof to->sampling.corner);
    code = take_criteria(&p, to, error);
    return code ? code : take_widths(&p, to, error);
}

/* Of bodies that are made of a material. */
static int check_elastic(const sb_body_params *p, sb_error *error)
{
    const char *name = sb_engine_name(p->engine);
    if (p->mass)
        return sm_refuse(error, SB_INPUT, "'mass': the engine %s's bodies weigh by 'density'",
                         name);
    for (int n = 0; p->pose && n < 12; n++)
        if (n % 4 < 3 && fabs(p->pose[n] - (n / 4 == n % 4)) > 1e-6)
            return sm_refuse(error, SB_INPUT,
                             "'pose' turns: the engine %s only moves a body to where it starts; "
                             "turn its mesh",
                             name);
    return SB_OK;
}

static int check_material(const RefMaterial *material, double stiffness_damping, int64_t nodes,
                          sb_error *error)
{
    int code = sm_check_range(material->young, 1e-30, 1e30, "young", error);
    if (!code) code = sm_check_range(material->poisson, -0.99, 0.49, "poisson", error);
    if (!code) code = sm_check_range(material->density, 1e-30, 1e30, "density", error);
    if (!code) code = sm_check_range(stiffness_damping, 0, 1e6, "stiffness_damping", error);
    if (!code && nodes) code = sm_check_range((double)nodes, 8, 1e6, "nodes", error);
    return code;
}

static int take_meshless(const sb_meshless_params *from, const sb_mesh *surface,
                         RefMeshlessOptions *to, sb_error *error)
{
    sb_meshless_params p;
    sb_meshless_params_init(&p);
    if (from) p = *from;
    *to = (RefMeshlessOptions){.mesh = &surface->mesh,
                               .points = p.points,
                               .nodes = p.nodes,
                               .modes = p.modes,
                               .material = {p.young, p.poisson, p.density},
                               .stiffness_damping = p.stiffness_damping};
    int code = check_material(&to->material, p.stiffness_damping, p.nodes, error);
    if (!code && p.modes) code = sm_check_range(p.modes, 7, 1000, "modes", error);
    if (!code && p.points)
        code = sm_check_range((double)p.points, REF_LEAST_POINTS, REF_MOST_POINTS, "points", error);
    return code;
}

/* No pressure is to make a shell faster than may be written, in one step. */
static int check_pressure(const RefMeshlessOptions *shell, double h, double cell, sb_error *error)
{
    SmBox box = sm_box_around(shell->mesh->vertex_count, shell->mesh->position);
    double thin = shell->thickness > 0 ? shell->thickness : REF_SHELL_THIN * sm_box_longest(&box);
    double most = SB_FAR * cell / (h * h) * thin * shell->material.density;
    if (shell->pressure == 0 || fabs(shell->pressure) <= most) return SB_OK;
    return sm_refuse(error, SB_USAGE,
                     "'pressure' is %g: above %g, it moves the shell by 1e9 cells in a step",
                     shell->pressure, most);
}

static int take_shell(const sb_body_params *body, double cell, const sb_mesh *surface,
                      RefMeshlessOptions *to, sb_error *error)
{
    sb_shell_params p;
    sb_shell_params_init(&p);
    if (body->shell) p = *body->shell;
    *to = (RefMeshlessOptions){.mesh = &surface->mesh,
                               .nodes = p.nodes,
                               .thickness = p.thickness,
                               .covers = p.covers,
                               .strength = p.strength,
                               .branching = p.branching,
                               .pressure = p.pressure,
                               .pulse = p.pulse,
                               .material = {p.young, p.poisson, p.density},
                               .stiffness_damping = p.stiffness_damping};
    int code = check_material(&to->material, p.stiffness_damping, p.nodes, error);
    if (!code) code = sm_check_range(p.thickness, 0, 1e30, "thickness", error);
    if (!code) code = sm_check_range(p.covers, 0, MOST_COVERS, "covers", error);
    if (!code) code = sm_check_range(p.strength, 0, 1e30, "strength", error);
    if (!code) code = sm_check_range(p.branching, 0, 1e6, "branching", error);
    if (!code) code = sm_check_range(p.pulse, 0, 1e9, "pulse", error);
    return code ? code : check_pressure(to, body->h, cell, error);
}

/* What one engine alone asks. */
static int take_own(const sb_body_params *p, double cell, const sb_mesh *surface,
                    OctOptions *octree, RefMeshlessOptions *meshless, sb_error *error)
{
    int code = take_octree(p->octree, octree, error);
    if (code || (p->engine != SB_MESHLESS && p->engine != SB_THIN_SHELL)) return code;
    if (!surface)
        return sm_refuse(error, SB_USAGE, "'surface' is NULL: the engine %s makes a body of it",
                         sb_engine_name(p->engine));
    code = check_elastic(p, error);
    if (code) return code;
    return p->engine == SB_MESHLESS ? take_meshless(p->meshless, surface, meshless, error)
                                    : take_shell(p, cell, surface, meshless, error);
}

static SmEngineParams engine_params(const sb_body_params *p, const SmEngineType *type,
                                    const OctOptions *octree, const RefMeshlessOptions *meshless)
{
    SmEngineParams to = {.w = p->w,
                         .h = p->h,
                         .damping = p->damping,
                         .damping_every = p->damping_every,
                         .strain_limit = p->strain_limit,
                         .summation = (SmSummation)p->summation,
                         .polar = (SmPolarMethod)p->polar,
                         .layout = (SmLayout)p->layout,
                         .threads = p->threads,
                         .mass = p->mass,
                         .instances = p->instances > 1 ? p->instances : 1,
                         .instance_pose = (const double(*)[3][4])p->pose,
                         .octree = octree,
                         .meshless = meshless,
                         .collide = {.self = p->collide_self != 0,
                                     .bodies = p->collide_instances != 0,
                                     .friction = p->collide_friction}};
    memcpy(to.gravity, p->gravity, sizeof to.gravity);
    if (p->cuttable && type->cut && to.strain_limit == 0)
        to.strain_limit = INFINITY; /* it breaks where it is cut */
    return to;
}

/* Everything beside the engine, which is there. */
static void complete(sb_body *body, const sb_voxels *voxels, const sb_mesh *surface,
                     double strain_limit)
{
    sm_voxels_copy(&voxels->voxels, &body->voxels);
    sm_count_particles(body);
    if (strain_limit > 0) {
        body->x0 = sm_alloc((size_t)body->particles, sizeof *body->x0);
        sb_voxels_read_particles(voxels, body->x0[0], body->particles, NULL);
    }
    int team = sm_team_enter(body->threads);
    sm_skin_create(body->type, body->engine, &body->voxels, body->instances,
                   (const double(*)[3])body->x0, strain_limit,
                   surface ? sm_mesh_copy(&surface->mesh) : (SmMesh){0}, &body->skin);
    sm_team_leave(team);
}

int sb_body_create(const sb_voxels *voxels, const sb_mesh *surface, const sb_body_params *params,
                   sb_body **body, sb_error *error)
{
    OctOptions octree;
    RefMeshlessOptions meshless;
    SmError why;
    int code = sm_begin(body, "body", error);
    if (!code) code = sm_check_given(voxels, "voxels", error);
    if (!code) code = sm_check_given(params, "params", error);
    if (!code && sm_isa_wanted(&why)) code = sm_refuse(error, SB_USAGE, "%s", why.text);
    if (code) return code;
    sb_body_params p = *params;
    code = check_engine(&p, error);
    if (!code) code = check_choices(&p, error);
    if (!code) code = check_sizes(&p, &voxels->voxels, error);
    if (!code) code = take_own(&p, voxels->voxels.cell, surface, &octree, &meshless, error);
    if (code) return code;
    if (!p.threads) p.threads = (int)fmin(sm_team(0), sm_cores(""));
    const SmEngineType *type = engines[p.engine].type[p.precision];
    SmEngineParams inner = engine_params(&p, type, &octree, &meshless);
    sb_body *made = sm_alloc(1, sizeof *made);
    *made = (sb_body){.type = type, .h = p.h, .threads = p.threads, .instances = inner.instances};
    made->bytes = -sm_heap_used();
    SmCode failed = type->create(&voxels->voxels, &inner, &made->engine, &why);
    made->bytes += sm_heap_used();
    if (made->bytes < 0) made->bytes = 0; /* another thread has freed more */
    if (failed) {
        free(made);
        return sm_done(failed, &why, error);
    }
    bool follows = (type->links || type->cut) && type->pieces; /* the surface does, what parts */
    complete(made, voxels, surface, follows ? inner.strain_limit : 0);
    *body = made;
    return sm_done(SM_OK, NULL, error);
}

void sb_body_free(sb_body *body)
{
    if (!body) return;
    body->type->destroy(body->engine);
    sm_skin_free(&body->skin);
    sm_voxels_free(&body->voxels);
    for (int i = 0; i < body->handle_count; i++) free((void *)(uintptr_t)body->handle[i].particle);
    for (int i = 0; i < body->blade_count; i++) sm_blade_free(&body->blade[i].blade);
    for (int i = 0; i < body->detail_count; i++) oct_refinement_free(&body->detail[i]);
    sm_free_all(body->handle, body->obstacle, body->blade, body->detail, body->x0);
    free(body);
}

/* ---- steps and counts */

/* Gives what holds and stops particles to the engine. */
static void bind(sb_body *body)
{
    SmHandle *handle = sm_alloc((size_t)body->handle_count, sizeof *handle);
    SmObstacle *obstacle = sm_alloc((size_t)body->obstacle_count, sizeof *obstacle);
    SmBoundary boundary = {0, handle, 0, obstacle};
    for (int i = 0; i < body->handle_count; i++)
        if (body->handle[i].count) handle[boundary.handle_count++] = body->handle[i];
    for (int i = 0; i < body->obstacle_count; i++)
        if (!body->obstacle[i].gone)
            obstacle[boundary.obstacle_count++] = body->obstacle[i].obstacle;
    body->type->bound(body->engine, &boundary);
    body->bind = false;
    free(handle);
    free(obstacle);
}

/* Where links have broken by strain, or cracks have grown, the surface comes apart. */
static void follow_tears(sb_body *body)
{
    long first = sm_skin_cut_triangles(&body->skin);
    sm_skin_draw(&body->skin);
    if (!sm_skin_tear(&body->skin)) return;
    int team = sm_team_enter(body->threads);
    sm_skin_follow_cut(&body->skin, first);
    sm_team_leave(team);
}

/* In single precision a place is known to a hundredth of a cell at 1e5 cells, where a step of that
 * length takes a body from its origin. Looks at one particle of each instance: the rest of a body
 * that is whole goes with it. */
static int check_speed(const sb_body *body, sb_error *error)
{
    const double most = 1e5 * body->voxels.cell / body->h;
    const long own = body->particles / body->instances;
    if (strcmp(body->type->precision, "single") != 0) return SB_OK;
    for (long first = 0; first < body->particles; first += own) {
        double v[3];
        body->type->get_some(body->engine, SM_VELOCITY, 1, &first, &v);
        if (!(sm_dot(v, v) <= most * most))
            return sm_refuse(error, SB_INPUT,
                             "a step of %g s took the body farther than 1e5 cells, where single "
                             "precision loses its shape: give a shorter 'h', or SB_DOUBLE",
                             body->h);
    }
    return SB_OK;
}

int sb_body_step(sb_body *body, int64_t steps, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code && steps < 0)
        code = sm_refuse(error, SB_USAGE, "'steps' is %lld: it is 0 or more", (long long)steps);
    if (code) return code;
    if (body->bind) bind(body);
    for (int64_t step = 0; step < steps; step++) body->type->step(body->engine, NULL);
    body->steps += steps;
    follow_tears(body);
    code = check_speed(body, error);
    return code ? code : sm_done(SM_OK, NULL, error);
}

int sb_body_count(const sb_body *body, sb_body_counts *counts, sb_error *error)
{
    SmCounts from;
    int code = sm_check_given(body, "body", error);
    if (!code) code = sm_check_given(counts, "counts", error);
    if (code) return code;
    body->type->count(body->engine, &from);
    *counts = (sb_body_counts){.particles = from.particles,
                               .instances = body->instances,
                               .steps = body->steps,
                               .time = (double)body->steps * body->h,
                               .regions = from.regions,
                               .links = from.links,
                               .broken = from.broken,
                               .contacts = from.contacts,
                               .bytes = body->bytes,
                               .build_seconds = from.build_seconds,
                               .summation_nodes = from.summation_nodes,
                               .cut_triangles = sm_skin_cut_triangles(&body->skin),
                               .surface_vertices = body->skin.surface.vertex_count,
                               .surface_triangles = body->skin.surface.triangle_count,
                               .surface_incomplete = body->skin.incomplete,
                               .stopped = from.stopped};
    return sm_done(SM_OK, NULL, error);
}

/* ---- particles */

/* Refuses what the body's engine has not. */
static int check_has(const sb_body *body, bool has, const char *lacks, sb_error *error)
{
    if (has) return SB_OK;
    return sm_refuse(error, SB_USAGE, "the engine %s %s", body->type->name, lacks);
}

int sb_body_read(sb_body *body, int field, double *values, int64_t room, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code) code = sm_check_range(field, SB_REST, SB_GOAL, "field", error);
    if (!code && field == SB_GOAL)
        code = check_has(body, body->type->goals, "matches no shapes: it has no goals", error);
    if (!code) code = sm_check_array(values, room, body->particles, "values", error);
    if (code) return code;
    if (field == SB_GOAL) body->type->goals(body->engine);
    body->type->get(body->engine, (SmField)field, (double(*)[3])values);
    return sm_done(SM_OK, NULL, error);
}

int sb_body_write(sb_body *body, int field, const double *values, int64_t count, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code)
        code = check_has(body, body->type->set,
                         "moves nodes that carry particles, which cannot be put elsewhere: use "
                         "handles and pushes",
                         error);
    if (!code) code = sm_check_range(field, SB_POSITION, SB_VELOCITY, "field", error);
    if (!code && count != body->particles)
        code = sm_refuse(error, SB_USAGE, "'count' is %lld, and the body has %ld particles",
                         (long long)count, body->particles);
    if (code) return code;
    double far = SB_FAR * body->voxels.cell;
    code = sm_check_finite(values, 3 * count, field == SB_POSITION ? far : far / body->h, "values",
                           error);
    if (code) return code;
    body->type->set(body->engine, (SmField)field, (const double(*)[3])values);
    return sm_done(SM_OK, NULL, error);
}

static int check_particles(const sb_body *body, int64_t count, const int64_t *particle,
                           sb_error *error)
{
    int code = SB_OK;
    if (count < 0)
        return sm_refuse(error, SB_USAGE, "'count' is %lld: it is 0 or more", (long long)count);
    if (count > 0) code = sm_check_given(particle, "particle", error);
    for (int64_t i = 0; i < count && !code; i++)
        if (particle[i] < 0 || particle[i] >= body->particles)
            code = sm_refuse(error, SB_USAGE, "there is no particle %lld: they are 0 to %ld",
                             (long long)particle[i], body->particles - 1);
    return code;
}

/* No impulse is to make a particle faster than may be written. */
static int check_impulses(const sb_body *body, int64_t count, const int64_t *particle,
                          const double *impulse, sb_error *error)
{
    long own = body->particles / body->instances;
    int code = sm_check_finite(impulse, 3 * count, 1e300, "impulse", error);
    if (code) return code;
    double *mass = sm_alloc((size_t)own, sizeof *mass), far = SB_FAR * body->voxels.cell / body->h;
    body->type->masses(body->engine, mass);
    for (int64_t i = 0; i < 3 * count && !code; i++)
        if (!(fabs(impulse[i]) <= far * mass[particle[i / 3] % own]))
            code = sm_refuse(error, SB_USAGE,
                             "impulse %lld is %g, on %g kg: faster than 1e9 cells in a step",
                             (long long)(i / 3), impulse[i], mass[particle[i / 3] % own]);
    free(mass);
    return code;
}

int sb_body_push(sb_body *body, int64_t count, const int64_t *particle, const double *impulse,
                 sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code) code = check_particles(body, count, particle, error);
    if (!code && count > 0) code = check_impulses(body, count, particle, impulse, error);
    if (code) return code;
    body->type->push(body->engine, count, (const long *)particle, (const double(*)[3])impulse);
    return sm_done(SM_OK, NULL, error);
}

int sb_body_read_masses(sb_body *body, double *mass, int64_t room, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code) code = sm_check_array(mass, room, body->particles / body->instances, "mass", error);
    if (code) return code;
    body->type->masses(body->engine, mass);
    return sm_done(SM_OK, NULL, error);
}

int sb_body_read_region(sb_body *body, int64_t particle, int64_t *member, int64_t room,
                        int64_t *count, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code)
        code = check_has(body, body->type->region,
                         "matches no shapes: it has no regions of particles", error);
    if (!code) code = check_particles(body, 1, &particle, error);
    if (!code) code = sm_check_list(member, room, count, "member", error);
    if (code) return code;
    *count = body->type->region(body->engine, particle, (long *)member, room);
    return sm_done(SM_OK, NULL, error);
}

static int check_plastic(bool plastic, sb_error *error)
{
    if (plastic) return sm_done(SM_OK, NULL, error);
    return sm_refuse(error, SB_USAGE,
                     "the body is elastic and keeps no shapes: create it as an "
                     "octree with 'creep' above 0");
}

int sb_body_read_shapes(sb_body *body, double *shape, int64_t room, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code) code = sm_check_array(shape, room, body->particles, "shape", error);
    if (code) return code;
    return check_plastic(
        body->type->get_shapes && body->type->get_shapes(body->engine, (double(*)[9])shape), error);
}

int sb_body_write_shapes(sb_body *body, const double *shape, int64_t count, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code && count != body->particles)
        code = sm_refuse(error, SB_USAGE, "'count' is %lld, and the body has %ld particles",
                         (long long)count, body->particles);
    if (!code) code = sm_check_finite(shape, 9 * count, 1e3, "shape", error);
    if (code) return code;
    return check_plastic(body->type->set_shapes &&
                             body->type->set_shapes(body->engine, (const double(*)[9])shape),
                         error);
}

/* Particles between the corners, or, with a radius of 0 or more, in the ball about `low`. */
static void select_particles(sb_body *body, const double low[3], const double high[3],
                             double radius, int64_t *particle, int64_t room, int64_t *count)
{
    double(*rest)[3] = sm_alloc((size_t)body->particles, sizeof *rest);
    body->type->get(body->engine, SM_REST, rest);
    *count = 0;
    for (long p = 0; p < body->particles; p++) {
        bool inside = true;
        double square = 0;
        for (int d = 0; d < 3; d++) {
            square += (rest[p][d] - low[d]) * (rest[p][d] - low[d]);
            if (high) inside &= rest[p][d] >= low[d] && rest[p][d] <= high[d];
        }
        if (!high) inside = square <= radius * radius;
        if (inside && *count < room) particle[*count] = p;
        *count += inside;
    }
    free(rest);
}

int sb_body_select_box(sb_body *body, const double low[3], const double high[3], int64_t *particle,
                       int64_t room, int64_t *count, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code) code = sm_check_finite(low, 3, INFINITY, "low", error);
    if (!code) code = sm_check_finite(high, 3, INFINITY, "high", error);
    if (!code) code = sm_check_list(particle, room, count, "particle", error);
    if (code) return code;
    select_particles(body, low, high, 0, particle, room, count);
    return sm_done(SM_OK, NULL, error);
}

int sb_body_select_ball(sb_body *body, const double centre[3], double radius, int64_t *particle,
                        int64_t room, int64_t *count, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code) code = sm_check_finite(centre, 3, 1e30, "centre", error);
    if (!code) code = sm_check_range(radius, 0, INFINITY, "radius", error);
    if (!code) code = sm_check_list(particle, room, count, "particle", error);
    if (code) return code;
    select_particles(body, centre, NULL, radius, particle, room, count);
    return sm_done(SM_OK, NULL, error);
}

/* ---- handles and obstacles */

static int check_unheld(const sb_body *body, int64_t count, const int64_t *particle,
                        sb_error *error)
{
    int code = SB_OK;
    unsigned char *held = sm_alloc((size_t)body->particles, 1);
    for (int i = 0; i < body->handle_count; i++)
        for (long k = 0; k < body->handle[i].count; k++) held[body->handle[i].particle[k]] = 1;
    for (int64_t k = 0; k < count && !code; k++) {
        if (held[particle[k]])
            code = sm_refuse(error, SB_USAGE, "particle %lld is held already, or given twice",
                             (long long)particle[k]);
        held[particle[k]] = 1;
    }
    free(held);
    return code;
}

int sb_body_add_handle(sb_body *body, int64_t count, const int64_t *particle, int *handle,
                       sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code) code = sm_check_given(handle, "handle", error);
    if (!code) code = check_particles(body, count, particle, error);
    if (!code && count == 0) code = sm_refuse(error, SB_USAGE, "a handle of no particles");
    if (!code) code = check_unheld(body, count, particle, error);
    if (code) return code;
    long *own = sm_alloc((size_t)count, sizeof *own);
    memcpy(own, particle, (size_t)count * sizeof *own);
    *handle = body->handle_count++;
    body->handle = sm_realloc(body->handle, (size_t)body->handle_count, sizeof *body->handle);
    body->handle[*handle] = (SmHandle){
        .count = count, .particle = own, .pose = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    body->bind = true;
    return sm_done(SM_OK, NULL, error);
}

static int find_handle(sb_body *body, int handle, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (code) return code;
    if (handle >= 0 && handle < body->handle_count && body->handle[handle].particle) return SB_OK;
    return sm_refuse(error, SB_USAGE, "there is no handle %d", handle);
}

int sb_body_move_handle(sb_body *body, int handle, const double pose[12], sb_error *error)
{
    int code = find_handle(body, handle, error);
    if (!code) code = sm_check_given(pose, "pose", error);
    if (!code) code = check_pose(pose, SB_FAR * body->voxels.cell, error);
    if (code) return code;
    memcpy(body->handle[handle].pose, pose, sizeof body->handle[handle].pose);
    body->bind = true;
    return sm_done(SM_OK, NULL, error);
}

int sb_body_remove_handle(sb_body *body, int handle, sb_error *error)
{
    int code = find_handle(body, handle, error);
    if (code) return code;
    free((void *)(uintptr_t)body->handle[handle].particle);
    body->handle[handle] = (SmHandle){0};
    body->bind = true;
    return sm_done(SM_OK, NULL, error);
}

static int add_obstacle(sb_body *body, const SmObstacle *o, int *obstacle, sb_error *error)
{
    double far = SB_FAR * body->voxels.cell;
    int code = sm_check_given(obstacle, "obstacle", error);
    if (!code && body->type->unstopped)
        code = sm_refuse(error, SB_USAGE, "obstacles do not stop the engine %s's bodies",
                         body->type->name);
    if (!code) code = sm_check_finite(o->a, 3, far, "place", error);
    if (!code) code = sm_check_finite(o->b, 3, fmax(far, 2), "place", error);
    if (!code) code = sm_check_range(o->radius, 0, far, "radius", error);
    if (!code) code = sm_check_range(o->friction, 0, 1, "friction", error);
    if (code) return code;
    *obstacle = body->obstacle_count++;
    body->obstacle =
        sm_realloc(body->obstacle, (size_t)body->obstacle_count, sizeof *body->obstacle);
    body->obstacle[*obstacle] = (SbObstacle){false, *o};
    body->bind = true;
    return sm_done(SM_OK, NULL, error);
}

static int check_place(sb_body *body, const double *a, const double *b, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (!code) code = sm_check_finite(a, 3, 1e30, "place", error);
    return code ? code : sm_check_finite(b, 3, 1e30, "place", error);
}

int sb_body_add_plane(sb_body *body, const double point[3], const double normal[3], double friction,
                      int *obstacle, sb_error *error)
{
    int code = check_place(body, point, normal, error);
    if (code) return code;
    double length = hypot(hypot(normal[0], normal[1]), normal[2]);
    if (!(length > 0))
        return sm_refuse(error, SB_USAGE, "'normal' is 0: it leads to the free side");
    SmObstacle o = {SM_PLANE, {point[0], point[1], point[2]}, {0}, 0, friction};
    for (int d = 0; d < 3; d++) o.b[d] = normal[d] / length;
    return add_obstacle(body, &o, obstacle, error);
}

int sb_body_add_sphere(sb_body *body, const double centre[3], double radius, double friction,
                       int *obstacle, sb_error *error)
{
    int code = check_place(body, centre, centre, error);
    if (code) return code;
    SmObstacle o = {SM_SPHERE, {centre[0], centre[1], centre[2]}, {0}, radius, friction};
    return add_obstacle(body, &o, obstacle, error);
}

int sb_body_add_box(sb_body *body, const double low[3], const double high[3], double friction,
                    int *obstacle, sb_error *error)
{
    int code = check_place(body, low, high, error);
    for (int d = 0; d < 3 && !code; d++)
        if (!(low[d] < high[d]))
            code = sm_refuse(error, SB_USAGE, "the box is empty: 'low' must be below 'high'");
    if (code) return code;
    SmObstacle o = {SM_BOX, {low[0], low[1], low[2]}, {high[0], high[1], high[2]}, 0, friction};
    return add_obstacle(body, &o, obstacle, error);
}

int sb_body_add_capsule(sb_body *body, const double a[3], const double b[3], double radius,
                        double friction, int *obstacle, sb_error *error)
{
    int code = check_place(body, a, b, error);
    if (code) return code;
    SmObstacle o = {SM_CAPSULE, {a[0], a[1], a[2]}, {b[0], b[1], b[2]}, radius, friction};
    return add_obstacle(body, &o, obstacle, error);
}

int sb_body_remove_obstacle(sb_body *body, int obstacle, sb_error *error)
{
    int code = sm_check_given(body, "body", error);
    if (code) return code;
    if (obstacle < 0 || obstacle >= body->obstacle_count || body->obstacle[obstacle].gone)
        return sm_refuse(error, SB_USAGE, "there is no obstacle %d", obstacle);
    body->obstacle[obstacle].gone = true;
    body->bind = true;
    return sm_done(SM_OK, NULL, error);
}
