#include "shell.h"

#include <stdlib.h>
#include <string.h>

#include "../../../lib/vector.h"

void ref_shell_free(RefShell *shell)
{
    ref_quadtree_free(&shell->tree);
    ref_nodes_free(&shell->nodes);
    ref_matrices_free(&shell->matrices);
    free(shell->X);
    free(shell->up);
    *shell = (RefShell){.X = NULL};
}

static double eta_of(const RefShellOptions *options)
{
    if (options->eta > 0) return options->eta;
    return options->basis == REF_MLS_PLANE_LINEAR ? 4 : 6;
}

SmCode ref_shell_build(const RefChart *chart, const RefShellOptions *options, RefShell *shell,
                       SmError *error)
{
    RefSamples samples = {0};
    *shell = (RefShell){.chart = *chart, .basis = options->basis};
    SmCode code =
        options->nodes
            ? ref_quadtree_of(&shell->chart, options->across, options->nodes, &shell->tree, error)
            : ref_quadtree_build(&shell->chart, options->across, INFINITY, &shell->tree, error);
    if (code != SM_OK) return code;
    ref_quadtree_nodes(&shell->tree, eta_of(options), &shell->nodes);
    code = ref_samples_take(&shell->tree, &shell->nodes, options->basis, &samples, error);
    if (code == SM_OK)
        code = ref_middle_fit(&shell->chart, &samples, shell->nodes.count, &shell->X, error);
    if (code == SM_OK)
        code = ref_thin_build((const double(*)[3])shell->X, &samples, shell->nodes.count,
                              options->thickness, &options->material, &shell->matrices,
                              &shell->soft, error);
    ref_samples_free(&samples);
    if (code != SM_OK) ref_shell_free(shell);
    return code;
}

int ref_shell_shape(const RefShell *shell, const double theta[3], RefShape *shape)
{
    if (shell->functions.at) return shell->functions.at(shell->functions.kept, theta, shape);
    const RefCell *cell = shell->tree.cell + ref_quadtree_at(&shell->tree, theta);
    double edge = ref_quadtree_edge(&shell->tree, cell);
    return ref_samples_shape(&shell->nodes, shell->basis, edge, theta, shape);
}

bool ref_shell_at(const RefShell *shell, const double theta[3], RefShape *shape, RefFrame *frame)
{
    if (!ref_shell_shape(shell, theta, shape)) return false;
    *frame = ref_middle_of((const double(*)[3])shell->X, shape);
    return true;
}

void ref_rows_lean(RefRows *rows, const RefShape *shape, const RefFrame *frame,
                   const double direction[3])
{
    const double *g = frame->inverse, (*a)[3] = frame->tangent;
    double along[2] = {sm_dot(a[0], direction), sm_dot(a[1], direction)};
    double up[2] = {g[0] * along[0] + g[2] * along[1], g[2] * along[0] + g[1] * along[1]};
    long at = ref_rows_begin(rows, 3 * shape->count);
    for (int n = 0; n < shape->count; n++)
        for (int d = 0; d < 3; d++, at++) {
            rows->column[at] = 3 * shape->node[n] + d;
            rows->value[at] =
                -frame->normal[d] * (shape->gradient[n][0] * up[0] + shape->gradient[n][1] * up[1]);
        }
}
