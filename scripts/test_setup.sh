#!/usr/bin/env bash
# What scripts/setup asks of apt-get where no package is installed: never to remove any, and no second VTK
# where Python has one. The package tools are stand-ins here; nothing is installed. Then what its function
# build says: how far it is on a terminal, nothing in a pipe.
#
# usage: scripts/test_setup.sh     exit codes: 0 passed, 1 failed, 77 this is not Debian 12
set -eu
grep -qs '^VERSION_ID="12"$' /etc/os-release && grep -qs '^ID=debian$' /etc/os-release || exit 77
setup=$(dirname -- "$0")/setup
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
mkdir "$folder/bin" "$folder/vtk"
printf '#!/bin/sh\n' >"$folder/bin/dpkg-query"
printf '#!/bin/sh\nshift\nexec "$@"\n' >"$folder/bin/sudo"
printf '#!/bin/sh\necho "$*" >>"%s"\n' "$folder/asked" >"$folder/bin/apt-get"
chmod +x "$folder"/bin/*

# asked WHAT [PYTHONPATH]: the line that installs.
asked() {
    : >"$folder/asked"
    PATH=$folder/bin:$PATH PYTHONPATH=${2-} "$setup" "$1" 2>/dev/null
    grep ' install ' "$folder/asked"
}

for what in run package test pictures view film; do
    asked "$what" | grep -q -- ' --no-remove ' || { echo "$what: apt-get may remove packages"; exit 1; }
done
touch "$folder/vtk/vtk.py"
! asked pictures "$folder/vtk" | grep -q vtk || { echo "a second VTK is asked for"; exit 1; }
echo 'raise ImportError' >"$folder/vtk/vtk.py"
asked pictures "$folder/vtk" | grep -q python3-vtk9 || { echo "no VTK is asked for"; exit 1; }

mkdir "$folder/clone" "$folder/clone/scripts"
cp "$setup" "$folder/clone/scripts/setup"
printf '%s\n' 'cmake_minimum_required(VERSION 3.22)' 'project(p C)' 'add_executable(p p.c)' \
    >"$folder/clone/CMakeLists.txt"
echo 'int main(void) { return 0; }' >"$folder/clone/p.c"
echo ". '$folder/clone/scripts/setup'; build made p" >"$folder/clone/build"
[ -z "$(bash "$folder/clone/build" 2>&1)" ] || { echo "a build in a pipe is not quiet"; exit 1; }
[ -x "$folder/clone/made/p" ] || { echo "nothing was built"; exit 1; }
if command -v script >/dev/null; then
    touch "$folder/clone/p.c"
    script -qec "bash '$folder/clone/build'" /dev/null </dev/null | grep -q 'building: 1/2' ||
        { echo "a terminal is not told how far the build is"; exit 1; }
fi
echo 'int main(void) { return no; }' >"$folder/clone/p.c"
if bash "$folder/clone/build" >"$folder/said" 2>&1; then echo "a broken build passes"; exit 1; fi
grep -q 'undeclared' "$folder/said" || { cat "$folder/said"; exit 1; }
