#include "scene_check.h"

#include <math.h>

#include "../engines.h"

static SmCode check_selection(BenchSelect *select, const char *what, int number,
                              const BenchScene *scene, SmError *error)
{
    select->sphere = select->radius > 0;
    if (select->sphere) return SM_OK;
    for (int d = 0; d < 3; d++)
        if (!(select->high[d] > select->low[d]))
            return sm_fail(error, SM_INPUT,
                           "%s: %s %d selects nothing: it needs 'box_low' below 'box_high', or "
                           "'sphere_centre' and 'sphere_radius'",
                           scene->file, what, number);
    return SM_OK;
}

static bool any(const double v[3])
{
    return v[0] != 0 || v[1] != 0 || v[2] != 0;
}

/* Places and widths that would not be looked at, and plasticity without its rate: mistakes, not to
 * be passed over. */
static SmCode check_octree(const BenchScene *scene, SmError *error)
{
    const OctOptions *o = &scene->octree;
    for (int i = 0; i < o->sampling.criteria_count; i++) {
        const OctCriterion *c = &o->sampling.criteria[i];
        if ((c->kind != OCT_BOX && (any(c->low) || any(c->high))) ||
            (c->kind != OCT_SPHERE && (any(c->centre) || c->radius > 0)))
            return sm_fail(error, SM_INPUT,
                           "%s: criterion %d: 'low' and 'high' are of the kind \"box\", 'centre' "
                           "and 'radius' of \"sphere\"",
                           scene->file, i + 1);
    }
    for (int i = 0; i < o->local_count; i++)
        if ((any(o->local[i].low) || any(o->local[i].high)) && o->local[i].radius > 0)
            return sm_fail(
                error, SM_INPUT,
                "%s: width %d has a box and a sphere: give 'low' and 'high', or 'centre' "
                "and 'radius'",
                scene->file, i + 1);
    if (o->summation_nodes > 0 && (o->width.cells > 0 || o->width.edges > 0))
        return sm_fail(error, SM_INPUT,
                       "%s: the width is searched for 'summation_nodes', or given by 'w' and "
                       "'edges': not both",
                       scene->file);
    if ((o->yield > 0 || o->most > 0) && !(o->creep > 0))
        return sm_fail(error, SM_INPUT,
                       "%s: 'yield' and 'most' are a plastic body's: give 'creep' too, in 1/s",
                       scene->file);
    return SM_OK;
}

/* Cuts, touches and an eye that would change nothing: mistakes too. */
static SmCode check_changes(BenchScene *scene, SmError *error)
{
    for (int i = 0; i < scene->cut_count; i++) {
        BenchCut *cut = &scene->cut[i];
        if (!(cut->stop > cut->start))
            return sm_fail(error, SM_INPUT,
                           "%s: cut %d ends before it begins: give a 'stop' after "
                           "its 'start'",
                           scene->file, i + 1);
        if (cut->reach == 0) cut->reach = 1;
    }
    if ((scene->cut_count > 0 || scene->view.level > 0) && scene->instances > 1)
        return sm_fail(error, SM_INPUT,
                       "%s: 'cuts' and 'view' are of a body alone, and here are %ld instances; of "
                       "those, 'touches' names one",
                       scene->file, scene->instances);
    for (int i = 0; i < scene->touch_count; i++) {
        BenchTouch *touch = &scene->touch[i];
        if (touch->instance == 0) touch->instance = 1;
        if (!(touch->radius > 0) || touch->level == 0)
            return sm_fail(error, SM_INPUT, "%s: touch %d needs a 'radius' and a 'level'",
                           scene->file, i + 1);
        if (touch->instance > scene->instances)
            return sm_fail(error, SM_INPUT, "%s: touch %d is on instance %ld, and there are %ld",
                           scene->file, i + 1, touch->instance, scene->instances);
    }
    if (scene->view.level > 0 && !(scene->view.near > 0))
        return sm_fail(error, SM_INPUT, "%s: 'view' needs 'near', a distance above 0", scene->file);
    if ((scene->touch_count > 0 || scene->view.level > 0) &&
        !bench_engine(scene->engine)->type[0]->refines)
        return sm_fail(error, SM_INPUT,
                       "%s: 'touches' and 'view' refine octrees: give engine = \"octree\", not "
                       "\"%s\"",
                       scene->file, scene->engine);
    return SM_OK;
}

static SmCode check_handle(BenchHandle *handle, int number, const BenchScene *scene, SmError *error)
{
    SmCode code = check_selection(&handle->select, "handle", number, scene, error);
    double length = hypot(hypot(handle->axis[0], handle->axis[1]), handle->axis[2]);
    bool turns = handle->rate != 0 || (handle->amplitude != 0 && handle->period > 0);
    if (!code && turns && !(length > 0))
        code =
            sm_fail(error, SM_INPUT, "%s: handle %d turns but has no 'axis'", scene->file, number);
    for (int d = 0; d < 3 && length > 0; d++) handle->axis[d] /= length;
    return code;
}

SmCode bench_scene_check(BenchScene *scene, SmError *error)
{
    if (!scene->mesh[0])
        return sm_fail(error, SM_INPUT, "%s: no 'mesh': give \"shape:NAME\" or a mesh file's path",
                       scene->file);
    if ((scene->voxel.particles > 0) + (scene->voxel.cell > 0) + (scene->cells > 0) != 1)
        return sm_fail(error, SM_INPUT, "%s: give one of 'particles', 'cell' and 'cells'",
                       scene->file);
    SmCode code = check_octree(scene, error);
    if (!code) code = check_changes(scene, error);
    for (int i = 0; i < scene->handle_count && !code; i++)
        code = check_handle(&scene->handle[i], i + 1, scene, error);
    for (int i = 0; i < scene->force_count && !code; i++)
        code = check_selection(&scene->force[i].select, "force", i + 1, scene, error);
    return code;
}
