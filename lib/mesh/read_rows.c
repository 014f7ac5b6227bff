/* Text of points, one a line: x y z, or x y z nx ny nz and perhaps more, which is not read. A count
 * may come first; where it is half of the lines, normals follow after all positions (PWN). */
#include <string.h>

#include "draft.h"

#define ROWS "give points as x y z, or as x y z nx ny nz"

static bool check_count(SmDraft *draft, double wanted, bool bare)
{
    double count = (double)draft->mesh.vertex_count;
    if (wanted < 0 || wanted == count) return true;
    if (!bare || 2 * wanted != count)
        return sm_draft_fail(draft,
                             "the first line counts %.17g points, and there are %.17g" SM_AGAIN,
                             wanted, count);
    draft->mesh.vertex_count /= 2;
    memcpy(draft->normal, draft->mesh.position + draft->mesh.vertex_count,
           (size_t)draft->mesh.vertex_count * sizeof *draft->normal);
    return true;
}

bool sm_read_rows(SmDraft *draft)
{
    double number[6], wanted = -1;
    int width = 0;
    draft->comment = '#';
    draft->commas = true;
    sm_draft_trim(draft);
    for (; sm_draft_find(draft); sm_draft_line(draft)) {
        int count = 0;
        for (; count < 6 && sm_draft_word(draft); count++)
            if (!sm_draft_decimal(draft, &number[count])) return false;
        bool first = !draft->mesh.vertex_count;
        if (first && wanted < 0 && count == 1 && number[0] >= 0) {
            wanted = number[0];
            continue;
        }
        if (first) width = count;
        if (count != width || (count != 3 && count != 6))
            return sm_draft_fail(draft, "a line of %d numbers; " ROWS, count);
        if (!sm_draft_vertex(draft, number, count == 6 ? number + 3 : NULL)) return false;
    }
    return check_count(draft, wanted, width == 3);
}
