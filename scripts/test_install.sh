#!/usr/bin/env bash
# Installs a build folder into a temporary prefix, then builds and runs the README's program against
# what is there, with the shared library and with the static one, and the like in C++ and Python. The
# paths are set as the README says.
#
# usage: scripts/test_install.sh BUILD_FOLDER
set -eu
here=$(dirname -- "$0")
prefix=$(mktemp -d)
trap 'rm -rf -- "$prefix"' EXIT
build=${1:?BUILD_FOLDER missing}
cmake --install "$build" --prefix "$prefix" >"$prefix/log" || { cat "$prefix/log"; exit 1; }
export_line=$(sed -n 's/^ *export PKG_CONFIG_PATH=/export PKG_CONFIG_PATH=/p' "$here/../lib/README.md")
[ -n "$export_line" ] || { echo "no export PKG_CONFIG_PATH in lib/README.md"; exit 1; }
eval "${export_line//PREFIX/\$prefix}"
for script in brute_force.py render.py plots.py plot_calibration.py plot_map.py plot_sweep.py report/main.py report/live.js; do
    cmp -s "$here/$script" "$prefix/share/shapebench/$script" ||
        { echo "not installed: $script"; exit 1; }
done
for file in results/page.html results/scenes/penguin.webp reference/papers.cfg; do
    cmp -s "$here/../$file" "$prefix/share/shapebench/${file#*/}" || { echo "not installed: $file"; exit 1; }
done

# One header, its functions and no others.
headers=$(cd "$prefix/include" && find . -type f)
[ "$headers" = ./shapebench.h ] || { echo "headers installed: $headers"; exit 1; }
nm -D --defined-only "$prefix/lib/libshapebench.so" | awk '{print $3}' | sort >"$prefix/shown"
grep -oE '\bsb_[a-z_]+\(' "$prefix/include/shapebench.h" | tr -d '(' | sort -u >"$prefix/declared"
diff "$prefix/declared" <(grep -xFf "$prefix/declared" "$prefix/shown") ||
    { echo "declared, but not in the library"; exit 1; }
diff "$prefix/shown" <(grep -xFf "$prefix/declared" "$prefix/shown") ||
    { echo "in the library, but not declared"; exit 1; }

# After 10 steps of free fall a particle is at -g h^2 (1 + ... + 10) = -0.055.
check() {
    local said
    said=$("${@:2}")
    [ "$said" = "the first particle at height -0.0550" ] || { echo "$1: $said"; exit 1; }
}

cc=${CC:-cc}
sed -n '/^#include <shapebench.h>/,/^```/{/^```/!p}' "$here/../lib/README.md" >"$prefix/program.c"
"$cc" -std=c99 -Wall -Wextra -Werror -pedantic -fsyntax-only -x c "$prefix/include/shapebench.h"
read -ra flags < <(pkg-config --cflags --libs shapebench)
"$cc" -std=c11 -Wall -Wextra -o "$prefix/program" "$prefix/program.c" "${flags[@]}"
check "shared library" "$prefix/program"

if command -v c++ >"$prefix/log"; then
    cat >"$prefix/program.cc" <<'PROGRAM'
#include <shapebench.h>
#include <cstdio>
#include <vector>

int main()
{
    sb_voxels *block = nullptr;
    sb_body *body = nullptr;
    sb_body_params params;
    sb_body_counts counts;
    const int cells[] = {2, 3, 4};
    sb_body_params_init(&params);
    params.gravity[1] = -10;
    if (sb_voxels_make(cells, 0.1, nullptr, nullptr, &block, nullptr) != SB_OK) return 1;
    if (sb_body_create(block, nullptr, &params, &body, nullptr) != SB_OK) return 1;
    sb_body_step(body, 10, nullptr);
    sb_body_count(body, &counts, nullptr);
    std::vector<double> x(3 * counts.particles);
    sb_body_read(body, SB_POSITION, x.data(), counts.particles, nullptr);
    std::printf("the first particle at height %.4f\n", x[1]);
    sb_body_free(body);
    sb_voxels_free(block);
}
PROGRAM
    c++ -std=c++11 -Wall -Wextra -Werror -pedantic -o "$prefix/program++" "$prefix/program.cc" "${flags[@]}"
    check "C++" "$prefix/program++"
else
    echo "no C++ compiler: not tested from C++"
fi

if /usr/bin/python3 -c 'import numpy' 2>"$prefix/log"; then
    engines=$(cd "$prefix" && env -u LD_LIBRARY_PATH /usr/bin/python3 -c \
        'import shapebench; print(*shapebench.engines())')
    [[ $engines == "fastlsm octree brute"* ]] || { echo "the module's engines: $engines"; exit 1; }
else
    echo "no NumPy: not tested from Python"
fi

read -ra flags < <(pkg-config --cflags --libs --static shapebench)
"$cc" -std=c11 -Wall -o "$prefix/program" "$prefix/program.c" "${flags[@]/#-lshapebench/-l:libshapebench.a}"
unset LD_LIBRARY_PATH
check "static library" "$prefix/program"
