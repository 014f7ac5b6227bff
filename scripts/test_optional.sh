#!/usr/bin/env bash
# Configures where every optional library is broken in a way that packages are: MPI's compiler without the
# headers that it names (as python3-vtk9 brings it), libraries that are there and cannot be linked. All are
# to be left out, each with a line.
#
# usage: scripts/test_optional.sh
set -eu
root=$(cd -- "$(dirname -- "$0")/.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
mkdir "$folder/bin" "$folder/pc" "$folder/lib"
for library in mpi cmocka arpack assimp cholmod lapack; do : >"$folder/lib/lib$library.so"; done
cat >"$folder/bin/mpicc" <<MPICC
#!/bin/sh
case \$* in
*showme:compile*) echo "-I$folder/absent" ;;
*showme:link*) echo "-L$folder/lib -lmpi" ;;
*) exec cc "\$@" ;;
esac
MPICC
chmod +x "$folder/bin/mpicc"
for module in mpi-c cmocka arpack assimp; do
    printf '%s\n' "Name: $module" "Description: broken" "Version: 1" "Cflags: -I$folder/absent" \
        "Libs: -L$folder/lib -l${module%-c}" >"$folder/pc/$module.pc"
done
# HDF5 is found by its other name, too
printf '%s\n' "Name: hdf5" "Description: the serial library" "Version: 1" "Cflags: $(pkg-config --cflags hdf5-serial)" \
    "Libs: $(pkg-config --libs hdf5-serial)" >"$folder/pc/hdf5.pc"
printf '%s\n' "Name: hdf5-serial" "Description: broken" "Version: 1" "Requires: absent" >"$folder/pc/hdf5-serial.pc"
if ! PATH=$folder/bin:$PATH PKG_CONFIG_PATH=$folder/pc cmake -S "$root" -B "$folder/build" -G Ninja \
    -DCHOLMOD_LIBRARY="$folder/lib/libcholmod.so" -DLAPACK_LIBRARY="$folder/lib/liblapack.so" \
    >"$folder/log" 2>&1; then
    cat "$folder/log"
    exit 1
fi
for line in "No MPI" "No unit tests" "No meshless bodies" "No meshes but OBJ"; do
    grep -q -- "-- $line" "$folder/log" || { echo "no line '$line'"; cat "$folder/log"; exit 1; }
done
