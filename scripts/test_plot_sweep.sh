#!/usr/bin/env bash
# Draws a small sweep by plot_sweep.py and a small calibration by plot_calibration.py as SVG and PNG, and lets them
# refuse what is none.
#
# usage: test_plot_sweep.sh BUILD-FOLDER     exit codes: 0 right, 1 wrong, 77 h5py or matplotlib is missing
set -eu
scripts=$(cd -- "$(dirname -- "$0")" && pwd)
build=$1
if ! /usr/bin/python3 -c 'import h5py, matplotlib' 2>/dev/null; then
    echo "skipped: /usr/bin/python3 has no h5py or no matplotlib; scripts/setup installs them"
    exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"

wrong() {
    echo "wrong: $*" >&2
    exit 1
}

# refused SCRIPT CODE ARGUMENTS...: one line on standard error, and that exit code
refused() {
    local script=$1 code=0 wanted=$2
    shift 2
    "$scripts/$script" "$@" >out 2>err || code=$?
    [ "$code" -eq "$wanted" ] || wrong "exit code $code, not $wanted: $* $(cat err)"
    [ "$(wc -l <err)" -eq 1 ] || wrong "more than a line: $(cat err)"
}

echo 'mesh = "shape:block"; particles = 64; bend = 0.3;' >small.cfg
"$build/shapebench" sweep --scene small.cfg --w 7:8 --epsilon 0,0.5 --frames 2 --repeats 1 --block 0.1 \
    --quiet -o small.h5 >/dev/null
"$scripts/plot_sweep.py" small.h5
grep -q '</svg>' small.svg || wrong "no SVG"
"$scripts/plot_sweep.py" small.h5 -o small.png
[ "$(head -c 4 small.png | tail -c 3)" = PNG ] || wrong "no PNG"
"$build/shapebench" sweep --scene small.cfg --w 8 --engine fastlsm --repeats 1 --block 0.1 --quiet \
    -o lattice.h5 >/dev/null
"$scripts/plot_sweep.py" lattice.h5 -o lattice.png
refused plot_sweep.py 3 small.cfg
refused plot_sweep.py 3 nothing.h5
refused plot_sweep.py 4 small.h5 -o nowhere/small.svg
refused plot_sweep.py 4 small.h5 -o small.docx

printf '%s\n' 'v 0 0 0' 'v 0.3 0 0' 'v 0 0.1 0' 'v 0.3 0.1 0' 'v 0 0 0.1' 'v 0.3 0 0.1' 'v 0 0.1 0.1' 'v 0.3 0.1 0.1' \
    'f 1 3 2' 'f 2 3 4' 'f 5 6 7' 'f 6 8 7' 'f 1 2 5' 'f 2 6 5' 'f 3 7 4' 'f 4 7 8' 'f 1 5 3' 'f 3 5 7' 'f 2 4 6' \
    'f 4 8 6' >box.obj
echo 'mesh = "box.obj"; cell = 0.05; h = 0.001;' >beam.cfg
"$build/shapebench" calibrate --scene beam.cfg --w 1:2 --epsilon 0,0.5 --across 1 --aspect none --step none --quiet \
    -o beam.h5 >/dev/null
"$scripts/plot_calibration.py" beam.h5
grep -q '</svg>' beam.svg || wrong "no SVG"
"$scripts/plot_calibration.py" beam.h5 -o beam.png
[ "$(head -c 4 beam.png | tail -c 3)" = PNG ] || wrong "no PNG"
refused plot_calibration.py 3 small.h5
refused plot_calibration.py 3 nothing.h5
refused plot_calibration.py 4 beam.h5 -o nowhere/beam.svg
refused plot_sweep.py 3 beam.h5
echo "drawn as SVG and PNG"
