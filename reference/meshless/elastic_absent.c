/* What elastic.h, motion/grip_modes.h, solve/modes.h and cracks of solids are without the library
 * that finds modes: a body that cracks gets others. */
#include <stdlib.h>

#include "body/cracked_body.h"
#include "elastic.h"
#include "motion/cracked_motion.h"
#include "motion/grip_modes.h"

static SmCode absent(SmError *error)
{
    return sm_fail(error, SM_USAGE,
                   "an elastic body's modes are found when the page is built, and it carries none "
                   "of this body as it is here: build a page of this scene (scripts/run view)");
}

SmCode ref_elastic_body(const RefMeshlessOptions *options, bool cuttable, long *count,
                        double (**x)[3], RefElastic *elastic, SmError *error)
{
    (void)options, (void)cuttable, (void)count, (void)x, (void)elastic;
    return absent(error);
}

SmCode ref_elastic_modes(const RefMeshlessOptions *options, RefElastic *elastic, SmError *error)
{
    (void)options, (void)elastic;
    return absent(error);
}

SmCode ref_modes_find(const RefMatrices *matrices, const RefRows *rows, int count, RefModes *modes,
                      SmError *error)
{
    (void)matrices, (void)rows, (void)count;
    *modes = (RefModes){0};
    return absent(error);
}

SmCode ref_grip_modes(const RefBody *body, int grips, const RefGrip *grip, int count,
                      RefModes *modes, SmError *error)
{
    (void)body, (void)grips, (void)grip, (void)count;
    *modes = (RefModes){0};
    return absent(error);
}

/* No body has cracks here: what would make some is never called. */
void ref_body_cracks_free(RefBodyCracks *cracks)
{
    (void)cracks;
}

SmCode ref_body_crack(const RefBody *body, const SmCut *cut, long first, const RefField *field,
                      const RefMaterial *material, long count, const double (*shown)[3],
                      RefBody *cracked, SmError *error)
{
    (void)body, (void)cut, (void)first, (void)field, (void)material, (void)count, (void)shown;
    (void)cracked;
    return absent(error);
}

void ref_motion_take_cracked(const RefBody *body, const RefBody *before, double density,
                             RefMotion *from, double h, RefMotion *motion)
{
    (void)body, (void)before, (void)density, (void)from, (void)h, (void)motion;
    abort();
}
