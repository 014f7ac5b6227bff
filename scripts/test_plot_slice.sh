#!/usr/bin/env bash
# Draws a slice of a block by plot_slice.py: it is blue inside and red outside; lets it refuse what is
# none.
#
# usage: test_plot_slice.sh BUILD-FOLDER
source "$(dirname -- "$0")/test_plots.bash"

"$program" info shape:block --slice y=0.5 -o block.h5 --quiet
"$plot" block.h5 >said
grep -qx 'wrote block.png' said || wrong "it says $(cat said)"
"$plot" block.h5 -o block.svg >/dev/null
grep -q '<svg' block.svg || wrong "no SVG"
/usr/bin/python3 - <<'PYTHON'
from matplotlib import image

pixels = image.imread("block.png")[:, :, :3]
left = pixels[:, : pixels.shape[1] * 3 // 4]  # the colour bar is on the right
red, blue = left[:, :, 0] - left[:, :, 2], left[:, :, 2] - left[:, :, 0]
assert (blue > 0.3).mean() > 0.05, "nothing is blue: inside"
assert (red > 0.3).mean() > 0.05, "nothing is red: outside"
PYTHON
refuses_others block.h5
cp block.h5 half.h5
/usr/bin/python3 -c 'import h5py; del h5py.File("half.h5", "r+").attrs["low"]'
refused 3 half.h5
interrupted block.h5
