#include "breaking.h"

#include <stdlib.h>

void ref_breaking_free(RefBreaking *breaking)
{
    if (breaking->sheet) ref_cracked_free(&breaking->cracked);
    *breaking = (RefBreaking){.sheet = NULL};
}

SmCode ref_breaking_create(RefSheet *sheet, const RefCrackedOptions *cracked,
                           const RefFractureOptions *options, RefBreaking *breaking, SmError *error)
{
    *breaking = (RefBreaking){.options = *options};
    if (!(options->strength > 0))
        return sm_fail(error, SM_USAGE, "a shell's strength is %g; give one above 0",
                       options->strength);
    if (!(cracked->least_share >= 0 && cracked->least_share <= 1))
        return sm_fail(error, SM_USAGE, "cells are split below a share of %g; give one of 0..1",
                       cracked->least_share);
    if (cracked->most_splits < 0 || options->most_starts < 0)
        return sm_fail(error, SM_USAGE,
                       "%d splits of a cell and %d cracks a step; give none below 0",
                       cracked->most_splits, options->most_starts);
    breaking->sheet = sheet;
    ref_cracked_create(&sheet->shell, &sheet->options.shell, cracked, &breaking->cracked);
    SmCode code = ref_breaking_update(breaking, error); /* to the matrices of one that cracks */
    if (code != SM_OK) ref_breaking_free(breaking);
    return code;
}

SmCode ref_breaking_update(RefBreaking *breaking, SmError *error)
{
    RefSheet *sheet = breaking->sheet;
    size_t size = 3 * (size_t)sheet->shell.nodes.count;
    double *field[3] = {sm_copy(sheet->steps.u, size, sizeof(double)),
                        sm_copy(sheet->steps.v, size, sizeof(double)),
                        sm_copy(sheet->warp.moved, size, sizeof(double))};
    double *residual[2] = {NULL, NULL};
    const RefCrackedFields fields = {3, field, residual};
    RefCrackedSaved saved = ref_cracked_save(&breaking->cracked);
    ref_cracked_update(&breaking->cracked, &fields);
    SmCode code = ref_sheet_renew(sheet, field[0], field[1], field[2], residual, error);
    if (code == SM_OK) {
        ref_sheet_anchor(sheet);
        ref_cracked_saved_free(&saved);
    } else
        ref_cracked_restore(&breaking->cracked, &saved);
    sm_free_all(field[0], field[1], field[2], residual[0], residual[1]);
    return code;
}

SmCode ref_breaking_step(RefBreaking *breaking, bool *changed, SmError *error)
{
    ref_sheet_step(breaking->sheet);
    *changed = ref_fracture_grow(&breaking->cracked, &breaking->options,
                                 (const double(*)[3])breaking->sheet->steps.u) > 0;
    SmCode code = *changed ? ref_breaking_update(breaking, error) : SM_OK;
    *changed = *changed && code == SM_OK;
    return code;
}
