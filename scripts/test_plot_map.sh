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
/usr/bin/python3 - <<'PYTHON'
there = {(i, j, 0) for i in range(5) for j in range(3)} - {(1, 1, 0), (3, 1, 0)}  # cubes around two holes
with open("two.obj", "w") as file:
    for n in range(48):
        print("v", n % 6, n // 6 % 4, n // 24, file=file)
    for cube in there:
        for d in range(3):
            for side in (0, 1):
                beside = tuple(c + (e == d) * (2 * side - 1) for e, c in enumerate(cube))
                if beside in there:
                    continue
                a, b = [e for e in range(3) if e != d]
                square = [[c + (side if e == d else 0) for e, c in enumerate(cube)] for _ in range(4)]
                for place, (u, v) in zip(square, ((0, 0), (1, 0), (1, 1), (0, 1))):
                    place[a] += u
                    place[b] += v
                if side == (d == 1):
                    square.reverse()
                print("f", *(1 + x + 6 * y + 24 * z for x, y, z in square), file=file)
PYTHON
"$program" info two.obj --map --nodes 60 -o two.h5 --quiet >/dev/null
"$plot" two.h5 >said
grep -qx 'wrote two.png' said || wrong "of two holes it says $(cat said)"
change() {
    cp "${2-block}.h5" changed.h5
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
change "f['cylinders/high'][0] = f['cylinders/low'][0]" two
change "f['joints/to'][0] = 3" two
change "f['joints/shift'][0] = 1e9" two
change "del f['joints/begin']" two
interrupted block.h5
