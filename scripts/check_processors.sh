#!/usr/bin/env bash
# Tests the core (SHAPEBENCH_CORE) for processors that this machine is not, its scalar form under
# every sanitizer, and all of the program under clang's:
#   arm        64-bit ARM under qemu; where its bodies come to lie is held to where this machine's do
#   avx2       x86-64 with AVX2 under qemu, where this machine has none
#   clang      all tests as clang compiles them, under its address and undefined sanitizer
#   portable   SHAPEBENCH_SCALAR under the address and undefined, then under the thread sanitizer
#   wasm       WebAssembly with simd128: that the core compiles
# Emulated, arithmetic is some fifty times slower: the tests that take longest are left out unless TESTS, a
# regular expression of names, asks for them.
#
# usage: scripts/check_processors.sh arm|avx2|clang|portable|wasm [TESTS]
# exit codes: 0 all passed, 1 something failed, 2 not so called, 3 packages are missing and were named
set -u
# shellcheck source=scripts/setup
. "$(dirname -- "${BASH_SOURCE[0]}")/setup"
export OMP_WAIT_POLICY=passive
quick='^(lib_(csr|isa|lanes|polar|rigid|shapebench)|fastlsm_(sums|engine|window)|octree_(engine|octree))'

# tests FOLDER TESTS [CMAKE OPTIONS]: builds the core there and runs its tests.
tests() {
    build "$1" all -DSHAPEBENCH_CORE=ON "${@:3}" || exit 1
    ctest --test-dir "$root/$1" -j "$(nproc)" --output-on-failure --no-tests=error -R "$2" || return 1
}

# arm_libraries FOLDER: unpacks there what ARM's tests are linked with, by lists and archives of its own: the system stays as it is.
arm_libraries() {
    local apt=$1/apt
    local -a options=(-qq -o APT::Architecture=arm64 -o APT::Architectures::=arm64 -o Dir::State="$apt/state"
        -o Dir::State::status="$apt/status" -o Dir::Cache="$apt/cache" -o APT::Sandbox::User=)
    [ ! -e "$1/whole" ] || return 0
    mkdir -p "$apt/state/lists/partial" "$apt/cache/archives/partial" && : >"$apt/status" &&
        apt-get "${options[@]}" update && (cd "$apt" && apt-get "${options[@]}" download \
        libcmocka-dev:arm64 libcmocka0:arm64 libgsl-dev:arm64 libgsl27:arm64 libgslcblas0:arm64) || return
    for archive in "$apt"/*.deb; do dpkg -x "$archive" "$1" || return; done
    : >"$1/whole"
}

arm() {
    local arm_root=$root/build-arm/libraries positions=$root/build-arm/positions
    arm_libraries "$arm_root" || { say "no ARM libraries: is a Debian archive in reach?" && exit 3; }
    rm -f -- "$positions"
    export SHAPEBENCH_POSITIONS=$positions
    tests build-native '^lib_isa$' -DCMAKE_BUILD_TYPE=Release -DSHAPEBENCH_NATIVE=ON '-DSHAPEBENCH_TESTS=^lib_isa$' || exit 1
    export PKG_CONFIG_SYSROOT_DIR=$arm_root
    export PKG_CONFIG_LIBDIR=$arm_root/usr/lib/aarch64-linux-gnu/pkgconfig
    tests build-arm "$1" -DCMAKE_BUILD_TYPE=Release -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 \
        -DCMAKE_C_COMPILER=aarch64-linux-gnu-gcc \
        "-DCMAKE_CROSSCOMPILING_EMULATOR=qemu-aarch64;-L;/usr/aarch64-linux-gnu;-E;LD_LIBRARY_PATH=$arm_root/usr/lib/aarch64-linux-gnu"
    local status=$?
    grep -h 'another machine' "$root/build-arm/Testing/Temporary/LastTest.log"
    return "$status"
}

portable() {
    local archer
    archer=$(clang -print-file-name=libarcher.so)
    tests build-portable-asan "$1" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DSHAPEBENCH_SCALAR=ON \
        -DSHAPEBENCH_SANITIZE=address,undefined &&
        OMP_TOOL_LIBRARIES=$archer TSAN_OPTIONS=ignore_noninstrumented_modules=1 tests build-portable-tsan \
            "$1" -DCMAKE_C_COMPILER=clang -DCMAKE_BUILD_TYPE=RelWithDebInfo -DSHAPEBENCH_SCALAR=ON \
            -DSHAPEBENCH_SANITIZE=thread
}

case ${1-} in
arm | avx2 | clang | portable | wasm) ;;
*) say "usage: scripts/check_processors.sh arm|avx2|clang|portable|wasm [TESTS]" && exit 2 ;;
esac
case $1 in
arm) setup_packages core gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user ;;
avx2) setup_packages core qemu-user ;;
clang) setup_packages test ;;
portable) setup_packages core clang libomp-dev libclang-rt-NN-dev ;;
wasm) setup_packages core clang lld llvm wasi-libc libclang-rt-NN-dev-wasm32 ;;
esac
case $1 in
avx2) # qemu 7.2 reads what a masked load leaves out, so lib_lanes fails there, not on a processor
    tests build-avx2 "${2-${quick/lanes|/}(_avx2(_f64)?)?\$}" -DCMAKE_BUILD_TYPE=Release \
        "-DCMAKE_CROSSCOMPILING_EMULATOR=qemu-x86_64;-cpu;max" ;;
clang)
    export LSAN_OPTIONS="suppressions='$root/scripts/leaks.supp':print_suppressions=0"
    tests build-clang-asan "${2-.}" -DSHAPEBENCH_CORE=OFF -DCMAKE_C_COMPILER=clang -DCMAKE_BUILD_TYPE=RelWithDebInfo \
        -DSHAPEBENCH_SANITIZE=address,undefined -DSHAPEBENCH_NATIVE=ON
    ;;
wasm) PKG_CONFIG_LIBDIR=/dev/null build build-wasm all -DSHAPEBENCH_CORE=ON "-DCMAKE_TOOLCHAIN_FILE=$root/scripts/wasm.cmake" ;;
*) "$1" "${2-$quick(_f64)?\$}" ;;
esac
