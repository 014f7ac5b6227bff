#!/usr/bin/env bash
# Draws the map of a block by plot_map.py: a board of two colours on the surface, squares of one kind
# as often as of the other; lets it refuse what is none.
#
# usage: test_plot_map.sh BUILD-FOLDER
source "$(dirname -- "$0")/test_plots.bash"

"$program" info shape:block --map --nodes 60 -o block.h5 --quiet >/dev/null 2>said || {
    grep -q libsuitesparse said && echo "skipped: $(cat said)" && exit 77
    wrong "$(cat said)"
}
"$plot" block.h5 >said
grep -qx 'wrote block.png' said || wrong "it says $(cat said)"
"$plot" block.h5 block.h5 -o two.svg >/dev/null
grep -q '<svg' two.svg || wrong "no SVG"
/usr/bin/python3 - <<'PYTHON'
from matplotlib import image

pixels = image.imread("block.png")[:, :, :3]
left = pixels[pixels.shape[0] // 8 :, : pixels.shape[1] // 3]  # the board, below its title
dark = (left.max(2) < 0.97).mean()
blue = (left[:, :, 2] - left[:, :, 0] > 0.15).mean()
assert dark > 0.2, f"no surface: {dark}"
assert 0.3 < blue / dark < 0.7, f"no board: {blue} of {dark}"
PYTHON
refuses_others block.h5
change() {
    cp block.h5 changed.h5
    /usr/bin/python3 -c "import h5py
with h5py.File('changed.h5', 'r+') as f: $1"
    refused 3 changed.h5
}
change "del f['surface/parameters']"
change "f['surface/triangles'][0, 0] = 1 << 30"
change "f['cells/factor'][0] = float('nan')"
change "f.attrs['high'] = f.attrs['low']"
change "f.attrs['angle_error'] = b'text'"
change "f['nodes/points'][0] = 1e9"
interrupted block.h5
