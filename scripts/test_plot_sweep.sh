#!/usr/bin/env bash
# Draws a small sweep by plot_sweep.py as SVG and PNG, and lets it refuse what is none.
#
# usage: test_plot_sweep.sh BUILD-FOLDER
source "$(dirname -- "$0")/test_plots.bash"

echo 'mesh = "shape:block"; particles = 64; bend = 0.3;' >small.cfg
"$program" sweep --scene small.cfg --w 7:8 --epsilon 0,0.5 --frames 2 --repeats 1 --block 0.1 \
    --quiet -o small.h5 >/dev/null
draws small.h5
"$program" sweep --scene small.cfg --w 8 --engine fastlsm --repeats 1 --block 0.1 --quiet \
    -o lattice.h5 >/dev/null
"$plot" lattice.h5 -o lattice.png
refused 3 small.cfg
refused 3 nothing.h5
cp small.h5 half.h5
/usr/bin/python3 -c 'import h5py; del h5py.File("half.h5", "r+")["points/path_rms"]'
refused 3 half.h5
"$program" tables --scene small.cfg --repeats 1 --block 0.01 --quiet -o rows.h5 >/dev/null
refused 3 rows.h5
refused 4 small.h5 -o nowhere/small.svg
grep -q ': nowhere/small.svg: cannot be written: No such file or directory$' err || wrong "it says $(cat err)"
refused 4 small.h5 -o small.docx
interrupted small.h5
echo "drawn as SVG and PNG"
