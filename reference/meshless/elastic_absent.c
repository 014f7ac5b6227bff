/* What elastic.h and motion/grip_modes.h are without the libraries that find modes. */
#include "elastic.h"
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

SmCode ref_grip_modes(const RefBody *body, int grips, const RefGrip *grip, int count,
                      RefModes *modes, SmError *error)
{
    (void)body, (void)grips, (void)grip, (void)count;
    *modes = (RefModes){0};
    return absent(error);
}
