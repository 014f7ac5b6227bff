#!/usr/bin/env bash
# Draws a small sweep by plot_sweep.py as SVG and PNG, and lets it refuse what is none.
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

# refused CODE ARGUMENTS...: one line on standard error, and that exit code
refused() {
    local code=0 wanted=$1
    shift
    "$scripts/plot_sweep.py" "$@" >out 2>err || code=$?
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
"$scripts/plot_sweep.py" lattice.h5
refused 3 small.cfg
refused 3 nothing.h5
refused 4 small.h5 -o nowhere/small.svg
refused 4 small.h5 -o small.docx
echo "drawn as SVG and PNG"
