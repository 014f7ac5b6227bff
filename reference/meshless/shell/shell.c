#include "shell.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
