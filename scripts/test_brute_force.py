#!/usr/bin/python3
"""Every built-in scene that can be recorded, at small size: brute_force.py must find its steps as the papers have them.

    scripts/test_brute_force.py SHAPEBENCH [--particles N] [--frames N] [--precision P] [SCENE...]

Also alters a recorded file, and expects to be told. Exit code 0: all agree; 1: not; 77: numpy or h5py are missing.
"""
import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import h5py
    import brute_force
except ImportError as missing:
    print(f"SKIPPED: {missing} (apt-get install python3-numpy python3-h5py)")
    sys.exit(77)

# Settings of scenes that are not recorded: `run --record` must refuse these, and no others.
NOT_RECORDED = {"cuts": "is cut: regions change", "strain_limit": "breaks: regions change",
                "touches": "is refined: regions change",
                "view": "is refined: regions change",
                'engine = "meshless"': "steps are of modes, not of particles",
                'engine = "shell"': "steps are of nodes' parameters, not of particles"}
ALTERED = (1e-3, float("nan"))  # cells by which one particle's place, velocity or goal is altered


def shown(program, *arguments):
    return subprocess.run([program, "scenes", *arguments], check=True, capture_output=True, text=True).stdout


def record(program, scene, text, options, folder):
    """Records the scene's first steps; returns the file, or None and why it is left out."""
    path = Path(folder, f"{scene}-{options.precision or 'default'}.vtkhdf")
    what = "nodes" if 'engine = "octree"' in text else "particles"
    more = ["--precision", options.precision] if options.precision else []
    nodes, fewer = re.search(r"^ *nodes = (\d+);", text, re.M), options.particles // 4
    if nodes and fewer < int(nodes[1]):  # as many as the scene's cannot be had of so few cells
        more += ["--nodes", str(fewer)]
    ran = subprocess.run([program, "run", scene, "--record", what, "--particles", str(options.particles), "--frames",
                          str(options.frames), "--steps", "1", "--quiet", "--output", path, *more],
                         capture_output=True, text=True)
    if ran.returncode == 2:
        return None, ran.stderr.strip()
    if not path.exists():
        raise SystemExit(f"{scene}: run ended with {ran.returncode}: {ran.stderr}")
    return path, "" if ran.returncode == 0 else "run's own check: " + ran.stdout.strip().replace("\n", "; ")


def judge(scene, text, path):
    """What is wrong with the recorded steps."""
    with brute_force.opened(str(path)) as file:
        allowed, worst, count = brute_force.check(file)
    print(f"{scene}: allowed {allowed:.2g}:", brute_force.told(worst, count), flush=True)
    wrong = brute_force.beyond(allowed, worst)
    if not count["compared"]:
        wrong.append("nothing was compared")
    if count["pushed"] and not re.search(r"^(forces|collide|planes|spheres|boxes|capsules) =", text, re.M):
        wrong.append(f"{count['pushed']} velocities changed between steps, and nothing pushes")
    return wrong


def unnoticed(path):
    """Which datasets can be altered without brute_force's notice, and by how many cells."""
    with h5py.File(path, "r+") as file:
        group = file["nodes" if "nodes" in file else "particles"]
        free = [i for i, held in enumerate(group["held"]) if not held][0]
        for name, size in (("x", 1), ("v", 1 / group.attrs["h"]), ("g", 1)):
            kept = group[name][1, free]
            for by in ALTERED:
                group[name][1, free] = kept + by * group.attrs["cell"] * size
                allowed, worst, _ = brute_force.check(file)
                if not brute_force.beyond(allowed, worst):
                    yield name, by
            group[name][1, free] = kept


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program")
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--particles", type=int, default=300)
    parser.add_argument("--frames", type=int, default=2)
    parser.add_argument("--precision", choices=("single", "double"))
    options = parser.parse_args()
    listed = re.findall(r"^  (\S+)", shown(options.program).split("\n\n")[0], re.M)
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        for scene in options.scenes or listed:
            text = shown(options.program, scene)
            expected = [why for setting, why in NOT_RECORDED.items() if re.search("^" + setting, text, re.M)]
            path, said = record(options.program, scene, text, options, folder)
            if expected or not path:
                print(f"{scene}: left out: {' and '.join(expected)}" if expected and not path else
                      f"{scene}: " + (f"recorded, though it {expected[0]}" if path else f"not recorded: {said}"))
                failed |= not expected or path is not None
                continue
            wrong = judge(scene, text, path) + [said] * bool(said)
            if scene in ("penguin", "hand-sampled"):
                wrong += [f"{name} altered by {by} cells goes unnoticed" for name, by in unnoticed(path)]
            for line in wrong:
                print(f"{scene}: WRONG: {line}")
            failed |= bool(wrong)
            path.unlink()
    return failed


if __name__ == "__main__":
    sys.exit(main())
