#!/usr/bin/env bash
# Installs a build folder into a temporary prefix, then builds and runs a ten-line program against
# what is there, with the shared library and with the static one. The paths are set as the README says.
#
# usage: scripts/test_install.sh BUILD_FOLDER
set -eu
prefix=$(mktemp -d)
trap 'rm -rf -- "$prefix"' EXIT
build=${1:?BUILD_FOLDER missing}
cmake --install "$build" --prefix "$prefix" >"$prefix/log" || { cat "$prefix/log"; exit 1; }
export_line=$(sed -n 's/^ *export PKG_CONFIG_PATH=/export PKG_CONFIG_PATH=/p' "$(dirname -- "$0")/../README.md")
[ -n "$export_line" ] || { echo "no export PKG_CONFIG_PATH in README.md"; exit 1; }
eval "${export_line//PREFIX/\$prefix}"
for script in check_step.py render.py plots.py plot_calibration.py plot_slice.py plot_sweep.py report/main.py; do
    cmp -s "$(dirname -- "$0")/$script" "$prefix/share/shapebench/$script" ||
        { echo "not installed: $script"; exit 1; }
done
cat >"$prefix/program.c" <<'PROGRAM'
#include <shapebench/fastlsm/fastlsm.h>
#include <stdio.h>
#include <stdlib.h>

int main(void)
{
    SmVoxels block;
    sm_voxels_init(&block, 2, 3, 4, 0.1);
    for (int i = 0; i < 2 * 3 * 4; i++) sm_voxel_set(&block, i % 2, i / 2 % 3, i / 6);
    sm_voxels_count(&block);

    const SmEngineType *type = &fastlsm_engine_f32;
    SmEngineParams params = {.w = 2, .h = 0.01, .gravity = {0, -10, 0}};
    SmEngine *engine;
    SmError error;
    if (type->create(&block, &params, &engine, &error)) return fprintf(stderr, "%s\n", error.text), 1;
    for (int step = 0; step < 10; step++) type->step(engine, NULL);
    double(*x)[3] = calloc((size_t)block.particle_count, sizeof *x);
    type->get(engine, SM_POSITION, x);
    printf("%ld particles, the first at height %.4f\n", block.particle_count, x[0][1]);
    free(x);
    type->destroy(engine);
    sm_voxels_free(&block);
    return 0;
}
PROGRAM

# After 10 steps of free fall a particle is at -g h^2 (1 + ... + 10) = -0.055.
check() {
    local said
    said=$("$prefix/program")
    [ "$said" = "60 particles, the first at height -0.0550" ] || { echo "$1: $said"; exit 1; }
}

cc=${CC:-cc}
find "$prefix/include" -name "*.h" -print0 | while IFS= read -r -d "" header; do # each must compile alone
    "$cc" -std=c11 -Wall -Wextra -Werror -fsyntax-only -x c "$header"
done
read -ra flags < <(pkg-config --cflags --libs shapebench)
"$cc" -std=c11 -Wall -o "$prefix/program" "$prefix/program.c" "${flags[@]}"
check "shared library"
read -ra flags < <(pkg-config --cflags --libs --static shapebench)
"$cc" -std=c11 -Wall -o "$prefix/program" "$prefix/program.c" "${flags[@]/#-lshapebench/-l:libshapebench.a}"
unset LD_LIBRARY_PATH
check "static library"
