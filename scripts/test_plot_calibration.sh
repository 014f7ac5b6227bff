#!/usr/bin/env bash
# Draws a small calibration by plot_calibration.py as SVG and PNG, and lets it refuse what is none.
#
# usage: test_plot_calibration.sh BUILD-FOLDER
source "$(dirname -- "$0")/test_plots.bash"

printf '%s\n' 'v 0 0 0' 'v 0.3 0 0' 'v 0 0.1 0' 'v 0.3 0.1 0' 'v 0 0 0.1' 'v 0.3 0 0.1' 'v 0 0.1 0.1' 'v 0.3 0.1 0.1' \
    'f 1 3 2' 'f 2 3 4' 'f 5 6 7' 'f 6 8 7' 'f 1 2 5' 'f 2 6 5' 'f 3 7 4' 'f 4 7 8' 'f 1 5 3' 'f 3 5 7' 'f 2 4 6' \
    'f 4 8 6' >box.obj
echo 'mesh = "box.obj"; cell = 0.05; h = 0.001;' >beam.cfg
"$program" calibrate --scene beam.cfg --w 1:2 --epsilon 0,0.5 --across 1 --aspect none --step none --quiet \
    -o beam.h5 >/dev/null
draws beam.h5
refused 3 beam.cfg
refused 3 nothing.h5
/usr/bin/python3 -c 'import h5py; h5py.File("other.h5", "w").attrs["kind"] = "else"'
refused 3 other.h5
cp beam.h5 half.h5
/usr/bin/python3 -c 'import h5py; del h5py.File("half.h5", "r+")["specimens/young"]'
refused 3 half.h5
interrupted beam.h5
refused 4 beam.h5 -o nowhere/beam.svg
grep -q ': nowhere/beam.svg: cannot be written: No such file or directory$' err || wrong "it says $(cat err)"
/usr/bin/python3 - <<'PYTHON'
import h5py

with h5py.File("beam.h5", "r+") as file:
    some = file["specimens"]
    some["valid"][:] = [text != b"grid" for text in some["set"][:]]
PYTHON
refused 3 beam.h5
echo "drawn as SVG and PNG"
