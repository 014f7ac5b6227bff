#!/usr/bin/env bash
# Shows that `shapebench regress` works on this machine: a program whose damping is made 5% slower is
# called slower there, and the program against itself, ten times over, never.
#
# The slow program is build/shapebench linked once more: its calls of lsm_damp_f32() go through a
# function that first waits for 5% of what the call takes. Nothing in the sources knows of it.
#
# With --replay it records a long series of samples of each scene and replays fifty comparisons of the
# program with itself from it: the samples, in their order, are dealt out to builds and rounds as
# `regress` does, and judged by the same code (bench/regress/replay.c). Scenes of long steps take minutes each.
#
# usage: scripts/check_regress.sh [SCENE [ROUNDS [TIMES]]]     default: infant 8 10
#        scripts/check_regress.sh --replay [SCENE...]          default: all but the three slowest
# exit codes: 0 as it should be, 1 not caught or a false alarm, 2 not so called, 3 no build/shapebench (scripts/run makes it)
set -u
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd) || exit 1
usage() {
    echo "usage: scripts/check_regress.sh [SCENE [ROUNDS [TIMES]]] | --replay [SCENE...]" >&2
    exit 2
}
cd -- "$root" || exit 1
[ -x build/shapebench ] || { echo "$0: no build/shapebench; scripts/run makes it" >&2 && exit 3; }
scratch=$(mktemp -d) || exit 1
trap 'rm -rf -- "$scratch" build/shapebench-slow build/shapebench-same' EXIT

# Samples for fifty comparisons of eight rounds, so many in each turn of a build.
record() {
    build/shapebench tables --quiet --scene "$1" --repeats $((50 * 8 * 4 * $2)) --block 0.05 --overwrite \
        -o "$scratch/series.h5" >/dev/null
}

replay() {
    local start=$SECONDS took
    record "$1" 1 || return 1
    took=$((SECONDS - start))
    if [ "$took" -lt 3 ]; then
        record "$1" 5 || return 1
    elif [ "$took" -lt 6 ]; then
        record "$1" 2 || return 1
    fi
    build/replay 50 8 "$scratch/series.h5"
}

if [ "${1:-}" = --replay ]; then
    shift
    ninja -C build replay >/dev/null || exit 1
    slowest=' hand-lattice-naive hand-lattice-plain hand-regular-jacobi '
    if [ $# -eq 0 ]; then
        for file in bench/scenes/*.cfg; do
            scene=$(basename "$file" .cfg)
            case $slowest in *" $scene "*) ;; *) set -- "$@" "$scene" ;; esac
        done
    fi
    failed=0
    for scene; do
        if ! replay "$scene" >"$scratch/said"; then failed=1; fi
        head -n 1 "$scratch/said"
    done
    exit "$failed"
fi

scene=${1:-infant} rounds=${2:-8} times=${3:-10}
revision=${REVISION:-HEAD}
case $scene in -*) usage ;; esac
for number in "$rounds" "$times"; do
    case $number in *[!0-9]* | "") usage ;; esac
done
[ $# -le 3 ] || usage

cat >"$scratch/slow.c" <<'C'
#include <time.h>

void __real_lsm_damp_f32(void *lsm);
void __wrap_lsm_damp_f32(void *lsm);

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void __wrap_lsm_damp_f32(void *lsm)
{
    static double last, least;
    double start = now();
    while (now() - start < 0.05 * (last < 2 * least ? last : least)) continue;
    start = now();
    __real_lsm_damp_f32(lsm);
    last = now() - start;
    if (least == 0 || last < least) least = last;
}
C
cc -O2 -c "$scratch/slow.c" -o "$scratch/slow.o" || exit 1
link=$(ninja -C build -t commands shapebench | tail -n 1)
link=${link/ -o shapebench / -o shapebench-slow -Wl,--wrap=lsm_damp_f32 $scratch/slow.o }
(cd build && eval "$link") || exit 1

cp build/shapebench build/shapebench-same || exit 1 # a build meanwhile does not matter

failed=0
build/shapebench-slow regress --revision "$revision" --scene "$scene" --rounds "$rounds" \
    --format json -o "$scratch/slow.json"
code=$?
said=$(/usr/bin/python3 -c '
import json, sys
for c in json.load(open(sys.argv[1]))["comparisons"]:
    print("   %-15s %.3f (%.3f to %.3f), threshold %.3f: %s" % (
        c["time"], c["ratio"], c["low"], c["high"], c["threshold"], c["verdict"]))' "$scratch/slow.json")
printf 'damping 5%% slower: exit code %d\n%s\n' "$code" "$said"
case $code:$said in
5:*damping*slower*) ;;
*) failed=1 ;;
esac
for ((i = 1; i <= times; i++)); do
    build/shapebench-same regress --revision "$revision" --scene "$scene" --rounds "$rounds" >"$scratch/same.txt"
    code=$?
    printf 'itself, %d of %d: exit code %d: %s\n' "$i" "$times" "$code" "$(tail -n 1 "$scratch/same.txt")"
    [ "$code" -eq 0 ] || failed=1
done
[ "$failed" -eq 0 ] || echo "$0: not as it should be" >&2
exit "$failed"
