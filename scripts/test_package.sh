#!/usr/bin/env bash
# The Debian package of a build folder: what is in it, what it depends on, and that it works where it lies: the
# program runs, and CMake's find_package and pkg-config find the library, as shared and as static.
#
# usage: scripts/test_package.sh BUILD_FOLDER     exit codes: 0 passed, 1 failed, 77 not Debian's tools here
set -euo pipefail
here=$(cd -- "$(dirname -- "$0")" && pwd)
build=$(cd -- "${1:?BUILD_FOLDER missing}" && pwd)
for tool in cpack dpkg-deb dpkg-shlibdeps ldd cmake pkg-config; do
    command -v $tool >/dev/null || { echo "no $tool"; exit 77; }
done
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cpack --config "$build/CPackConfig.cmake" -B "$folder" -D CPACK_DEBIAN_COMPRESSION_TYPE=gzip -D CPACK_STRIP_FILES=OFF \
    >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
package=$(echo "$folder"/shapebench_*.deb)
root=$folder/root
dpkg-deb -x "$package" "$root"
fail() { echo "$*" && exit 1; }

# What is in it.
version=$("$build/shapebench" --version | sed -n '1s/^shapebench //p')
[ "$(dpkg-deb -f "$package" Package Version | paste -sd ' ')" = "Package: shapebench Version: $version" ] ||
    fail "the package is not of $version"
[ "$(basename "$package")" = "shapebench_${version}_$(dpkg --print-architecture).deb" ] || fail "it is called $package"
for file in bin/shapebench include/shapebench.h lib/libshapebench.so lib/libshapebench.so."$version" lib/libshapebench.a \
    lib/pkgconfig/shapebench.pc lib/cmake/shapebench/shapebenchConfig.cmake share/bash-completion/completions/shapebench \
    share/zsh/vendor-completions/_shapebench share/shapebench/report/main.py share/shapebench/page.html \
    share/shapebench/view/build.py share/doc/shapebench/copyright share/doc/shapebench/CHANGELOG.md; do
    [ -s "$root/usr/$file" ] || fail "$file is not in it"
done
if command -v help2man >/dev/null; then
    [ -s "$root/usr/share/man/man1/shapebench-run.1.gz" ] || fail "no manual in it"
fi
[ -z "$(find "$root" -path "$root/usr" -prune -o -type f -print)" ] || fail "files outside of /usr"
[ -z "$(find "$root" -name 'test_*' -o -name '__pycache__')" ] || fail "tests are in it"
! grep -rqF "$build" "$root/usr/lib/pkgconfig" "$root/usr/lib/cmake" || fail "the build folder's path is in it"

# What it depends on: the packages of the libraries that the program names, but for those that several packages
# have (/etc/alternatives: BLAS, LAPACK).
needs=", $(dpkg-deb -f "$package" Depends),"
ldd "$root/usr/bin/shapebench" >"$folder/found"
objdump -p "$root/usr/bin/shapebench" | sed -n 's/^ *NEEDED *//p' >"$folder/named"
checked=0
while read -r library _ path _; do
    if ! grep -qxF "$library" "$folder/named" || [[ $(readlink "$path") == /etc/* ]]; then continue; fi
    owner=$({ dpkg -S "$path" || dpkg -S "/usr$path"; } 2>/dev/null | sed -n '1s/:.*//p')
    [[ $needs == *", $owner"[\ ,]* ]] || fail "$library is of $owner, and it depends on $needs"
    checked=$((checked + 1))
done <"$folder/found"
[ "$checked" -ge 8 ] || fail "only $checked libraries' packages were found"

# It works from where it lies.
for program in "$root/usr/bin" "$build"; do
    "$program/shapebench" run penguin --frames 2 --no-output --hash | grep "^state after"
done >"$folder/hashes"
[ "$(sort -u "$folder/hashes" | wc -l) $(wc -l <"$folder/hashes")" = "1 2" ] || fail "it runs differently"

"$root/usr/bin/shapebench" view penguin --quiet -o "$folder/view.html" && grep -qF 'One penguin' "$folder/view.html" ||
    fail "view makes no page"

sed -n '/^#include <shapebench.h>/,/^```/{/^```/!p}' "$here/../lib/README.md" >"$folder/program.c"
cat >"$folder/CMakeLists.txt" <<'PROJECT'
cmake_minimum_required(VERSION 3.22)
project(strangers C)
PROJECT
sed -n '/^find_package(shapebench/,/^```/{/^```/!p}' "$here/../lib/README.md" >>"$folder/CMakeLists.txt"
sed -i 's/^target_link/add_executable(program program.c)\n&/' "$folder/CMakeLists.txt"
cat >>"$folder/CMakeLists.txt" <<'PROJECT'
add_executable(alone program.c)
target_link_libraries(alone shapebench::static)
find_package(shapebench 99 QUIET)
if(shapebench_FOUND)
  message(FATAL_ERROR "any version is taken for 99")
endif()
PROJECT
{
    cmake -S "$folder" -B "$folder/made" -DCMAKE_PREFIX_PATH="$root/usr" && cmake --build "$folder/made"
} >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
check() {
    [ "$("${@:2}")" = "the first particle at height -0.0550" ] || fail "$1: $("${@:2}" 2>&1)"
}
check "find_package, shared" "$folder/made/program"
check "find_package, static" "$folder/made/alone"
for program in program alone; do ldd "$folder/made/$program" >"$folder/$program.needs"; done
grep -qF "$root/usr/lib/libshapebench.so.${version%%.*}" "$folder/program.needs" || fail "another shared library"
! grep -q libshapebench "$folder/alone.needs" || fail "the static library is shared"

# Python's module, where this clone has one.
if [ -d "$here/../lib/python/shapebench" ] && /usr/bin/python3 -c 'import numpy' 2>"$folder/log"; then
    said=$(cd "$folder" && PYTHONPATH=$root/usr/lib/python3/dist-packages /usr/bin/python3 -B -c \
        'import shapebench; print(shapebench.__file__, shapebench.__version__)')
    [ "$said" = "$root/usr/lib/python3/dist-packages/shapebench/__init__.py $version" ] || fail "Python: $said"
fi

export PKG_CONFIG_LIBDIR=$root/usr/lib/pkgconfig # alone: no other package's headers are needed
read -ra flags < <(pkg-config --cflags --libs "shapebench = $version")
"${CC:-cc}" -o "$folder/by-pkg-config" "$folder/program.c" "${flags[@]}"
check "pkg-config" env LD_LIBRARY_PATH="$root/usr/lib" "$folder/by-pkg-config"
