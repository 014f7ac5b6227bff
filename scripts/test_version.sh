#!/usr/bin/env bash
# One version: the program's --version, the newest entry of CHANGELOG.md, CITATION.cff, shapebench.h,
# pkg-config's file, CMake's, and the package's.
#
# usage: scripts/test_version.sh BUILD_FOLDER     exit codes: 0 passed, 1 failed
set -euo pipefail
root=$(cd -- "$(dirname -- "$0")/.." && pwd)
build=${1:?BUILD_FOLDER missing}
version=$("$build/shapebench" --version | sed -n '1s/^shapebench //p')
[[ $version =~ ^[0-9]+\.[0-9]+\.[0-9]+$ ]] || { echo "--version says '$version'"; exit 1; }

# same WHERE COMMAND...: prints the version, too.
same() {
    local said
    said=$("${@:2}")
    [ "$said" = "$version" ] || { echo "$1 says '$said', the program $version"; exit 1; }
}
same CHANGELOG.md sed -nE '/^## /{s/^## ([0-9.]+).*/\1/p;q}' "$root/CHANGELOG.md"
same CITATION.cff sed -n 's/^version: //p' "$root/CITATION.cff"
same shapebench.pc sed -n 's/^Version: //p' "$build/shapebench.pc"
same shapebenchConfigVersion.cmake sed -n 's/^set(PACKAGE_VERSION "\(.*\)")/\1/p' "$build/shapebenchConfigVersion.cmake"
same CPackConfig.cmake sed -n 's/^set(CPACK_PACKAGE_VERSION "\(.*\)")/\1/p' "$build/CPackConfig.cmake"
of_header() {
    sed -nE 's/^#define SHAPEBENCH_VERSION_(MAJOR|MINOR|PATCH) ([0-9]+)$/\2/p' "$root/lib/public/shapebench.h" | paste -sd .
}
same shapebench.h of_header
of_addon() {
    sed -nE 's/^    "version": \(([0-9]+), ([0-9]+), ([0-9]+)\),$/\1.\2.\3/p' "$root/lib/python/blender/__init__.py"
}
same "the Blender add-on" of_addon
