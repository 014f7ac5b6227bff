#!/usr/bin/env bash
# What scripts/setup asks of each system's package manager, and names where it may not install: the managers are
# stand-ins here, nothing is installed. Then its function build: what it says on a terminal and in a pipe, a disk that
# fills, a tree that cannot be written; and the version in a tree without .git.
#
# usage: scripts/test_setup.sh     exit codes: 0 passed, 1 failed
set -eu
scripts=$(cd -- "$(dirname -- "$0")" && pwd)
folder=$(mktemp -d)
setup=$folder/clone/scripts/setup # of a tree in which nothing is built yet
trap 'umount "$folder/disk" 2>/dev/null || :; rm -rf -- "$folder"' EXIT
fail() { echo "$*"; exit 1; }

mkdir -p "$folder/clone/scripts"
cp "$scripts/setup" "$scripts/run" "$folder/clone/scripts"

# stand_in PROGRAM LINE...: a program of $folder/bin.
stand_in() {
    printf '%s\n' '#!/bin/sh' "${@:2}" >"$folder/bin/$1"
    chmod +x "$folder/bin/$1"
}

# A system of its own: nothing but the shell's tools, with the programs that stand_in made.
fresh_system() {
    local tool
    rm -rf -- "${folder:?}/bin" "$folder/tools"
    mkdir "$folder/bin" "$folder/tools"
    for tool in bash sh env dirname basename cat sed grep head tail rm mkdir true; do
        ln -s -- "$(type -P "$tool")" "$folder/tools/$tool"
    done
    stand_in id 'echo 1000'
}

# answer WHAT [PYTHONPATH]: what setup says, and the lines that apt-get was given.
answer() {
    : >"$folder/asked"
    PATH=$folder/bin:$folder/tools PYTHONPATH=${2-} "$setup" "$1" 2>&1 || [ $? -eq 3 ] || echo "exit code"
    cat -- "$folder/asked"
}

# apt_system CLANG: apt-get whose archive has clang CLANG, and no clang 15's runtime for WebAssembly.
apt_system() {
    fresh_system
    stand_in dpkg-query
    stand_in sudo 'shift; exec "$@"'
    stand_in apt-get "echo \"\$*\" >>'$folder/asked'"
    stand_in apt-cache 'case $* in' "'depends clang') echo '  Depends: clang-$1' ;;" \
        "policy) echo ' 500 http://archive Packages' ;;" \
        "*) grep -o '[a-zA-Z0-9.+-]*' '$setup' | sed 's/NN/$1/; /-15-dev-wasm32/d' ;; esac"
}

for clang in 15 19; do
    apt_system "$clang"
    for what in run package test view film; do
        said=$(answer "$what")
        grep -q -- '^.* install -y --no-remove ' <<<"$said" || fail "$what: not installed, or others may go: $said"
    done
    [ "$(grep -c "no package is known here for libclang-rt-15-dev-wasm32:" <<<"$said")" = 1 ] || [ "$clang" != 15 ] ||
        fail "not one word: $said"
    answer test | grep -q " libclang-rt-$clang-dev " || fail "not clang $clang's runtime"
    ! answer view | grep -q 'install.*libclang-rt-15-dev-wasm32' || fail "a name that does not exist is asked for"
done
stand_in apt-get 'echo no net; exit 100'
said=$(TMPDIR=/nonexistent answer run)
grep -q 'no net' <<<"$said" && grep -q 'apt-get failed' <<<"$said" || fail "what apt-get said is lost: $said"
stand_in apt-get "echo \"\$*\" >>'$folder/asked'; case \$* in *install*arpack*) exit 100 ;; esac"
[[ $(answer run) = *'optional: libarpack2-dev; missing without it'*'libassimp-dev'* ]] || fail "not each for itself: $(answer run)"
stand_in apt-get
[[ $(TMPDIR=/nonexistent answer run) != *failed* ]] || fail "a TMPDIR that is not there stops set-up"

rm "$folder/bin/sudo"
said=$(answer run)
! grep -q sudo <<<"$said" || fail "sudo is named where there is none: $said"
grep -q '^    apt-get install .* libhdf5-dev' <<<"$said" || fail "no line to type: $said"
stand_in pkg-config 'case $* in *gsl) exit 1 ;; esac'
[[ $(answer run) = *' libgsl-dev'* && $(answer run) != *' libjansson-dev'* ]] || fail "asked for what is there: $(answer run)"
rm "$folder/bin/pkg-config"
stand_in sudo 'exit 1'
answer run | grep -q '^    sudo apt-get install ' || fail "sudo is not named"

while read -r manager command hdf5 wasm; do # elsewhere
    fresh_system
    stand_in "$manager"
    answer run | grep -q "^    ${command//_/ } .*$hdf5" || fail "$manager: $(answer run)"
    answer run | grep -q "optional: .*arpack.*meshless" || fail "$manager: no optional package is named"
    answer view | grep -q "^    .* python.*" || fail "$manager: view does not name python"
    [ -z "$(answer test | grep '^    ' | tr ' ' '\n' | grep . | sort | uniq -d)" ] || fail "named twice: $(answer test)"
    [[ $(answer view | grep '^    ') != *wasm_runtime* ]] || fail "$manager: what is no package is to be installed"
    answer view | grep -q " $wasm" || fail "$manager: view does not name wasi-libc or the runtime: $(answer view)"
done <<'SYSTEMS'
dnf dnf_install hdf5-devel wasi-libc-devel
pacman pacman_-S_--needed hdf5 wasi-libc wasi-compiler-rt
brew brew_install hdf5 wasi-libc wasi-runtimes
none (names_in_Debian) libhdf5-dev wasi-libc libclang-rt-dev-wasm32
SYSTEMS
fresh_system # the library by either of its names; optional packages alone stop nothing
stand_in pacman
stand_in pkg-config 'case $* in *serial) exit 1 ;; *arpack | *mpi* | *ompi*) exit 1 ;; esac'
for tool in cc cmake ninja flock; do stand_in "$tool"; done
stand_in python3
said=$(PATH=$folder/bin:$folder/tools "$setup" run 2>&1) || fail "absent optional packages stop set-up: $said"
for word in "arpack; missing without it: meshless bodies" "openmpi; missing without it: mpirun"; do
    grep -q "optional: $word" <<<"$said" || fail "no line on $word: $said"
done

apt_system 19
mkdir "$folder/vtk"
touch "$folder/vtk/vtk.py"
! answer pictures "$folder/vtk" | grep -q 'install.*vtk' || fail "a second VTK is asked for"
echo 'raise ImportError' >"$folder/vtk/vtk.py"
answer pictures "$folder/vtk" | grep -q 'install.*python3-vtk9' || fail "no VTK is asked for"

printf '%s\n' 'cmake_minimum_required(VERSION 3.22)' 'project(p C)' 'add_executable(p p.c)' \
    >"$folder/clone/CMakeLists.txt"
echo 'int main(void) { return 0; }' >"$folder/clone/p.c"
echo ". '$folder/clone/scripts/setup'; build made p" >"$folder/clone/build"
[ -z "$(bash "$folder/clone/build" 2>&1)" ] || fail "a build in a pipe is not quiet"
[ -x "$folder/clone/made/p" ] || fail "nothing was built"
if command -v script >/dev/null; then
    touch "$folder/clone/p.c"
    script -qec "bash '$folder/clone/build'" /dev/null </dev/null | grep -q 'building: 1/2' ||
        fail "a terminal is not told how far the build is"
fi
echo 'int main(void) { return no; }' >"$folder/clone/p.c"
if bash "$folder/clone/build" >"$folder/said" 2>&1; then fail "a broken build passes"; fi
grep -q 'undeclared' "$folder/said" || { cat "$folder/said"; exit 1; }
echo 'int main(void) { return 0; }' >"$folder/clone/p.c"
rm "$folder/clone/made/build.ninja" "$folder/clone/made/p"
bash "$folder/clone/build" && [ -x "$folder/clone/made/p" ] || fail "half a configuration is not made again"
echo '#error No space left on device' >"$folder/clone/p.c"
if said=$(bash "$folder/clone/build" 2>&1); then fail "a full disk passes"; fi
[[ $said = *'is full: make room'* && $said != *$'\n'* ]] || fail "not one line on a full disk: $said"

# A small disk that fills while a build is configured, then has room; and one that cannot be written.
mkdir "$folder/disk"
if mount -t tmpfs -o size=2m tmpfs "$folder/disk" 2>/dev/null; then
    cp -r "$folder/clone/scripts" "$folder/clone/CMakeLists.txt" "$folder/disk"
    echo 'int main(void) { return 0; }' >"$folder/disk/p.c"
    printf '%s\n' "cd '$folder/disk'" '. scripts/setup' 'build made p' >"$folder/build"
    head -c 1900k /dev/zero >"$folder/disk/filler"
    if said=$(bash "$folder/build" 2>&1); then fail "a full disk passes"; fi
    [[ $said = *'is full: make room'* && $said != *$'\n'* ]] || fail "not one line on a full disk: $said"
    [ ! -e "$folder/disk/made/build.ninja" ] || fail "the disk was not full while the build was configured"
    rm "$folder/disk/filler"
    bash "$folder/build" || fail "a disk that was full stays so"
    mount -o remount,ro "$folder/disk"
    if said=$("$folder/disk/scripts/run" 2>&1); then fail "a read-only tree passes"; fi
    [[ $said = *'cannot write in'* && $said != *$'\n'* ]] || fail "not one line on a read-only tree: $said"
else
    echo '[  SKIPPED ] setup_full_disk'
fi

cmake -DSOURCE="$folder/clone" -DHEADER="$folder/provenance.h" -DVERSION=1.2.3 -P "$scripts/provenance.cmake"
grep -q 'VERSION "1.2.3"' "$folder/provenance.h" && grep -q 'COMMIT "unknown"' "$folder/provenance.h" ||
    fail "no version without .git"
