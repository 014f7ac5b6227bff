#!/usr/bin/env bash
# Records a short trajectory and has scripts/render.py draw it: the body is seen, and not everywhere;
# one that falls moves in the picture, and stands on nothing that is not there; a frame that there is not
# is an error. Obstacles and fields are drawn.
#
# usage: scripts/test_render.sh SHAPEBENCH
# exit codes: 0 passed, 1 failed, 77 skipped: what `scripts/setup pictures` installs is not there
set -eu
program=$(realpath -- "${1:?SHAPEBENCH missing}")
render=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)/render.py
out=$(mktemp -d)
trap 'rm -rf -- "$out"' EXIT
cd -- "$out"
lost() { echo "line ${BASH_LINENO[0]}: not as it should be; it said: $(cat said)" && exit 1; }
if ! /usr/bin/python3 -c 'import h5py, matplotlib, numpy, vtk' 2>/dev/null ||
    { [ -z "${DISPLAY-}" ] && ! { command -v xvfb-run && command -v xauth; } >/dev/null; }; then
    echo "skipped: scripts/setup pictures installs what it needs"
    exit 77
fi
"$program" run penguin --frames 2 --quiet -o penguin.vtkhdf >run.log || { cat run.log; exit 1; }
"$render" penguin.vtkhdf --size 160x120 -o penguin.png >said
grep -qx 'wrote penguin.png' said
/usr/bin/python3 - <<'PYTHON'
from matplotlib import image

pixels = image.imread("penguin.png")[:, :, :3]
assert pixels.shape == (120, 160, 3), pixels.shape
blue = pixels[:, :, 2] - pixels[:, :, 0] > 0.1  # the surface's colour; ground and background are grey
assert 0.05 < blue.mean() < 0.8, f"the surface covers {blue.mean():.0%} of the image"
assert blue[60, 80], "the body is not in the middle"
assert not blue[0].any() and not blue[:, 0].any() and not blue[:, -1].any(), "it touches the image's edge"
PYTHON
"$render" penguin.vtkhdf --edges --size 64x64 -o small.png >said
"$render" penguin.vtkhdf --size 64x64 -o plain.png >said
cmp small.png plain.png # its triangles are too small for edges
"$render" penguin.vtkhdf --edges --size 320x320 -o edges.png >said
"$render" penguin.vtkhdf --size 320x320 --overwrite -o plain.png >said
if cmp -s edges.png plain.png; then echo "no edges" && exit 1; fi
status=0
"$render" penguin.vtkhdf --frame 3 -o none.png 2>said || status=$?
[ "$status" -eq 2 ] && grep -q 'has 3 frames, no frame 3' said && ! [ -e none.png ] || lost

# A body that falls through empty space: the camera stays, the body moves down, and has no shadow.
cat >fall.cfg <<'SCENE'
mesh = "shape:penguin"; particles = 100; w = 2; h = 0.01; gravity = [0.0, -9.81, 0.0];
steps_per_frame = 30; frames = 2;
SCENE
"$program" run fall.cfg --quiet -o fall.vtkhdf >run.log || { cat run.log; exit 1; }
for frame in 0 2; do "$render" fall.vtkhdf --frame "$frame" --size 120x120 -o "fall$frame.png" >said; done
/usr/bin/python3 - <<'PYTHON'
from matplotlib import image

rows = []
for frame in (0, 2):
    pixels = image.imread(f"fall{frame}.png")[:, :, :3]
    blue = pixels[:, :, 2] - pixels[:, :, 0] > 0.05
    rows.append(blue.any(axis=1).nonzero()[0])
    below = pixels[rows[-1][-1] + 3 :]
    assert not below.size or below.min() > 0.96, "the body has something under it"
assert rows[0][-1] < rows[1][0], f"the body has not fallen: rows {rows}"
PYTHON

# Where there is a floor it is drawn, with a shadow under the body, and what stands on it.
cp fall.cfg floor.cfg
cat >>floor.cfg <<'SCENE'
planes = ( { point = [0.0, -1.5, 0.0]; normal = [0.0, 1.0, 0.0]; } );
spheres = ( { centre = [0.9, -1.3, 0.4]; radius = 0.2; } );
boxes = ( { low = [-1e5, -1e5, -1e5]; high = [1e5, -1.6, 1e5]; } );
capsules = ( { from = [-0.9, -1.4, 0.0]; to = [-0.9, -1.4, 0.0]; radius = 0.1; } );
SCENE
"$program" run floor.cfg --fields speed,piece --quiet -o floor.vtkhdf >run.log || { cat run.log; exit 1; }
"$render" floor.vtkhdf --frame 0 --size 120x120 -o floor.png >said
/usr/bin/python3 - <<'PYTHON'
from matplotlib import image

pixels = image.imread("floor.png")[:, :, :3]
warm, blue = (pixels[:, :, 0] - pixels[:, :, 2] > 0.01), (pixels[:, :, 2] - pixels[:, :, 0] > 0.05)
assert warm[-1].all() and not warm[0].any(), "no floor"
below = pixels[blue.any(axis=1).nonzero()[0][-1] + 6 :]
assert (abs(below - [0.80, 0.80, 0.81]).max(axis=2) < 0.02).sum() > 40, "no shadow"
PYTHON

# Colours of a field, with a scale beside it; a field that is not there is named.
for frame in 0 2; do
    "$render" floor.vtkhdf --colour speed --frame "$frame" --size 120x120 -o "speed$frame.png" >said
done
/usr/bin/python3 - <<'PYTHON'
from matplotlib import image

first, last = (image.imread(f"speed{frame}.png")[:, :, :3] for frame in (0, 2))
assert first.shape == (120, 220, 3), first.shape
assert (first[:, 120:] == last[:, 120:]).all(), "another scale for each frame"
still = first[:, :120, 1] < 0.6 * first[:, :120, 2]  # viridis begins in violet
assert still.sum() > 200, "a body at rest is not of the scale's first colour"
fast = (last[:, :120, 1] - last[:, :120, 2] > 0.1) & (last[:, :120, 1] > 0.4)
assert fast.sum() > 100, "a body that falls is not of its last colours"
PYTHON
status=0
"$render" floor.vtkhdf --colour strain -o none.png 2>said || status=$?
[ "$status" -eq 3 ] && grep -q "has no field 'strain' (it has piece, speed)" said && ! [ -e none.png ] || lost

# A damaged file, without frames or without values: one line, not a traceback.
cp floor.vtkhdf empty.vtkhdf
/usr/bin/python3 - <<'PYTHON'
import h5py

with h5py.File("empty.vtkhdf", "r+") as file:
    for name, kind in (("Steps/Values", "f8"), ("PointData/speed", "f4")):
        del file["VTKHDF"][name]
        file["VTKHDF"].create_dataset(name, (0,), kind)
PYTHON
for colour in "" "--colour speed"; do
    status=0
    # shellcheck disable=SC2086
    "$render" empty.vtkhdf $colour -o none.png 2>said || status=$?
    [ "$status" -eq 3 ] && [ "$(wc -l <said)" -eq 1 ] && ! [ -e none.png ] || lost
done

# Ctrl-C ends it with a line, and what lent it a display with it.
echo 'import os, signal; os.kill(os.getpid(), signal.SIGINT)' >vtk.py
status=0
rm said # what lent the one before its display may still write there
PYTHONPATH=. TMPDIR=$out "$render" penguin.vtkhdf -o none.png 2>said || status=$?
[ "$status" -eq 130 ] && [ "$(cat said)" = "render.py: interrupted: nothing was written" ] && ! [ -e none.png ] || lost
for _ in {1..50}; do
    compgen -G "$out/xvfb-run.*" >/dev/null || exit 0
    sleep 0.1
done
echo "xvfb-run has not ended: $(ls "$out")"
exit 1
