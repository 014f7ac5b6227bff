#!/usr/bin/python3
"""What one would take instead: Bullet's soft bodies beside shapebench's engines, on the same body and machine.

usage: baselines.py [--cells N] [--w W] [--h S] [--sag SHARE] [--format text|markdown|csv|json] [-o FILE.h5 [--overwrite]]

The body is a beam of N x N cells through (4) and 8 N along, clamped at one end, of 1,000 kg/m^3. Gravity is chosen so that
the lattice engine with half-width W (2) and step S (0.001 s) sags by SHARE (0.1) of its length. Every other method gets
the same nodes, masses and gravity, and the stiffness with which it sags as much at rest, or the largest it has; then
  ms/step         median of 100 steps from rest
  ns/node/step    the same a node
  ms/s            milliseconds for a simulated second, at the step that stands beside it
  deviation %     how far its nodes at rest are from those of the elastic reference (engine meshless) that sags as much,
                  rms, of the beam's length
  same sag        within 2% of SHARE
  times           its ms/s by FastLSM's
What is comparable and what is not stands below the table and in FILE.h5 (results/README.md), which is for `shapebench
report`.
Exit codes: 0 done; 2 usage; 3 Bullet (libbullet-dev, g++), the library or the program is not there; 4 FILE.h5 cannot be
written."""
import argparse
import csv
import io
import itertools
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

import numpy

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), ".."))
sys.path.insert(0, os.path.join(ROOT, "lib", "python"))
sys.path.insert(1, os.path.join(ROOT, "scripts", "report"))
import draft
os.environ.setdefault("SHAPEBENCH_LIBRARY", os.path.join(ROOT, "build", "libshapebench.so"))
os.environ["OMP_NUM_THREADS"] = "1"

DENSITY, THICK, TIMED, MOST_ITERATIONS = 1000.0, 0.1, 100, 64
STORED = ("method", "stiffness", "step", "sag_percent", "ms_step", "ns_node_step", "ms_second", "deviation_percent")
COMPARABLE = "nodes, masses, gravity, machine, one thread, and stiffness where the sag is the same"
NOT_COMPARABLE = ("finite elements are implicit and keep their stiffness at any step, while that of FastLSM and of clusters "
                  "goes with 1/step^2; damping; collisions, which are off")
COLUMNS = ("method", "stiffness", "step s", "sag %", "ms/step", "ns/node/step", "ms/s", "deviation %")


class Beam:
    """Cells, lattice vertices, tetrahedra (six a cell) and masses; its first two layers of nodes are held."""

    def __init__(self, cells, sb):
        self.counts, self.cell = (8 * cells, cells, cells), THICK / cells
        self.length = THICK * 8
        self.voxels = sb.Voxels.from_cells(numpy.ones(self.counts[::-1], dtype=numpy.uint8), self.cell)
        self.mesh = box_mesh(sb, [count * self.cell for count in self.counts])
        self.nodes = self.voxels.particles()
        self.masses = self.voxels.masses(DENSITY)
        self.held = numpy.flatnonzero(self.nodes[:, 0] < 1.5 * self.cell)
        middle = numpy.abs(self.nodes - [self.length, THICK / 2, THICK / 2]).max(axis=1)
        self.tip = int(middle.argmin())

    def sag(self, positions):
        return float(self.nodes[self.tip, 1] - positions[self.tip, 1]) / self.length

    def tetrahedra(self):
        number = {tuple(key): n for n, key in enumerate(numpy.rint(self.nodes / self.cell).astype(int))}
        for low in itertools.product(*map(range, self.counts)):
            for order in itertools.permutations(range(3)):
                corner, path = list(low), [number[low]]
                for axis in order:
                    corner[axis] += 1
                    path.append(number[tuple(corner)])
                swaps = sum(order[a] > order[b] for a in range(3) for b in range(a + 1, 3))
                yield path if swaps % 2 == 0 else [path[0], path[1], path[3], path[2]]


def box_mesh(sb, size):
    corners = [[size[d] * (k >> d & 1) for d in range(3)] for k in range(8)]
    faces = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6],
             [1, 3, 5], [3, 7, 5]]
    return sb.Mesh(numpy.array(corners, dtype=float), numpy.array(faces, dtype=numpy.int32))


def engine_body(sb, beam, gravity, **parameters):
    if parameters["engine"] != "meshless":  # whose material has a density
        parameters["mass"] = beam.masses
    body = sb.Body(beam.voxels, beam.mesh, gravity=(0, -gravity, 0), threads=1, **parameters)
    rest = body.rest()
    body.hold(numpy.flatnonzero(rest[:, 0] < 1.5 * beam.cell))
    return body


def settle(body, steps):
    """Until it lies still: kinetic energy is taken away as it goes."""
    for _ in range(steps):
        body.step(10)
        body.set_velocities(0.8 * body.velocities())
    return body.positions()


def time_engine(body):
    samples = []
    for _ in range(TIMED):
        start = time.perf_counter()
        body.step(10)
        samples.append((time.perf_counter() - start) / 10)
    return statistics.median(samples)


def row(method, stiffness, step, beam, seconds, count, positions, reference):
    deviation = float("nan")
    if reference is not None and positions.shape == reference.shape:
        deviation = 100 * numpy.sqrt(((positions - reference) ** 2).sum(axis=1).mean()) / beam.length
    return dict(zip(COLUMNS, (method, stiffness, step, 100 * beam.sag(positions), 1e3 * seconds, 1e9 * seconds / count,
                              1e3 * seconds / step, deviation)))


def match(sag_of, wanted, low, high, tolerance=0.01, most=16):
    """The stiffness between two with which the sag is as wanted, by bisection of its logarithm; `high` where that sags
    more. One that is still a little in motion has no better answer than the last."""
    if sag_of(high) > wanted * (1 + tolerance):
        return high
    for _ in range(most):
        middle = (low * high) ** 0.5
        sag = sag_of(middle)
        if abs(sag / wanted - 1) < tolerance:
            return middle
        low, high = (middle, high) if sag > wanted else (low, middle)
    return middle


def bullet(beam, gravity, method, stiffness, step, timed, settle_step, settled):
    """Seconds of the steps, and positions at rest."""
    held = set(beam.held.tolist())
    lines = [f"{method} {stiffness} {step} 0 {-gravity} 0 {timed} {settle_step} {settled}", str(len(beam.nodes))]
    lines += [f"{x} {y} {z} {0 if n in held else beam.masses[n]}" for n, (x, y, z) in enumerate(beam.nodes)]
    tetrahedra = list(beam.tetrahedra())
    lines += [str(len(tetrahedra))] + [" ".join(map(str, corner)) for corner in tetrahedra]
    done = subprocess.run([adapter()], input="\n".join(lines), stdout=subprocess.PIPE, text=True, check=True)
    found = {line.split()[0]: numpy.array(line.split()[1:], dtype=float) for line in done.stdout.splitlines()}
    return statistics.median(found["seconds"]), found["positions"].reshape(-1, 3)


def adapter():
    return os.path.join(ROOT, "build", "baseline-bullet")


def build_adapter():
    source = os.path.join(ROOT, "bench", "baselines", "bullet.cpp")
    if os.path.exists(adapter()) and os.path.getmtime(adapter()) > os.path.getmtime(source):
        return
    if not shutil.which("g++") or subprocess.run(["pkg-config", "--exists", "bullet"]).returncode:
        sys.exit(missing("Bullet is not there: apt-get install g++ pkg-config libbullet-dev"))
    flags = subprocess.run(["pkg-config", "--cflags", "--libs", "bullet"], stdout=subprocess.PIPE, text=True).stdout.split()
    flags = [flag.replace("-I", "-isystem") if flag.startswith("-I") else flag for flag in flags]
    with tempfile.TemporaryDirectory(dir=os.path.dirname(adapter())) as folder:
        made = os.path.join(folder, "bullet")
        subprocess.run(["g++", "-O3", "-march=native", "-w", "-o", made, source] + flags, check=True)
        os.replace(made, adapter())


def missing(text):
    print(f"baselines.py: {text}", file=sys.stderr)
    return 3


def measure(sb, options):
    beam = Beam(options.cells, sb)
    lattice = {"engine": "fastlsm", "w": options.w, "h": options.h, "damping": 0.1}
    gravity = 1.0
    for _ in range(6):
        lies = settle(engine_body(sb, beam, gravity, **lattice), options.settle)
        if abs(beam.sag(lies) / options.sag - 1) < 0.005:
            break
        gravity *= options.sag / beam.sag(lies)
    sag = beam.sag(lies)
    note(f"gravity {gravity:.3g} m/s^2: the lattice engine sags by {100 * sag:.2f}% of its length")
    reference = elastic(sb, beam, gravity, sag)
    rows = [row(f"FastLSM, w {options.w}", f"w {options.w}", options.h, beam, time_engine(engine_body(sb, beam, gravity,
                **lattice)), len(beam.nodes), lies, reference)]
    rows += [elements(beam, gravity, sag, step, reference) for step in (options.h, 1 / 240)]
    rows += [clusters(beam, gravity, sag, step, reference) for step in (options.h, 1 / 240)]
    return rows, {"nodes": len(beam.nodes), "length": beam.length, "sag_percent": 100 * sag, "w": options.w, "h": options.h}


def elastic(sb, beam, gravity, sag):
    """Nodes at rest of the meshless elastic body that sags as much; None where the library has none."""
    if "meshless" not in sb.engines():
        note("no elastic reference: the library was built without it")
        return None
    found = {}

    def sag_of(young):
        body = engine_body(sb, beam, gravity, engine="meshless", precision="double", h=0.01, damping=0.05,
                           meshless=sb.MeshlessParams(young=young, poisson=0.3, density=DENSITY, nodes=600, modes=32))
        found[young] = settle(body, 60)
        return beam.sag(found[young])
    young = match(sag_of, sag, 1e3, 1e9)
    note(f"elastic reference: Young's modulus {young:.4g} Pa")
    return found[young]


def elements(beam, gravity, sag, step, reference):
    def lies(young):  # their rest does not depend on the step
        return bullet(beam, gravity, "elements", young, 0.01, 1, 0.02, 300)[1]
    young = match(lambda young: beam.sag(lies(young)), sag, 1e4, 1e8)
    seconds, _ = bullet(beam, gravity, "elements", young, step, TIMED, step, 0)
    return row("Bullet, finite elements", f"E {young:.4g} Pa", step, beam, seconds, len(beam.nodes), lies(young), reference)


def clusters(beam, gravity, sag, step, reference):
    """The stiffest where none is stiff enough: the column of the sag says so."""
    steps = int(6 / step)
    stiffness = match(lambda k: beam.sag(bullet(beam, gravity, "clusters", k, step, 1, step, steps)[1]), sag, 1e-3,
                      MOST_ITERATIONS)
    seconds, lies = bullet(beam, gravity, "clusters", stiffness, step, TIMED, step, steps)
    return row("Bullet, clusters and springs", f"k {stiffness:.3g}" if stiffness <= 1 else f"{round(stiffness)} iterations",
               step, beam, seconds, len(beam.nodes), lies, reference)


def note(text):
    print(f"baselines.py: {text}", file=sys.stderr, flush=True)


def cell_text(value):
    return value if isinstance(value, str) else "-" if value != value else f"{value:.4g}"


def compared(rows, sag):
    """The rows with what follows from them: is the sag that of all, and how many times FastLSM's is the time?"""
    return [each | {"same sag": "yes" if abs(each["sag %"] / sag - 1) < 0.02 else "no",
                    "times": each["ms/s"] / rows[0]["ms/s"]} for each in rows]


def write(rows, form, file):
    columns = list(rows[0])
    texts = [[cell_text(value) for value in each.values()] for each in rows]
    if form == "json":
        json.dump(rows, file, indent=1)
        file.write("\n")
    elif form == "csv":
        csv.writer(file).writerows([columns] + [list(each.values()) for each in rows])
    else:
        widths = [max(map(len, column)) for column in zip(columns, *texts)]
        lines = [[text.ljust(width) if i < 2 else text.rjust(width) for i, (text, width) in enumerate(zip(line, widths))]
                 for line in [columns] + texts]
        if form == "markdown":
            lines.insert(1, ["---" if i < 2 else "---:" for i in range(len(columns))])
        for line in lines:
            file.write(("| " + " | ".join(line) + " |" if form == "markdown" else "  ".join(line).rstrip()) + "\n")


def environment():
    """The machine, and what was built: as every result file has it. Raises OSError and CalledProcessError."""
    program = os.path.join(os.path.dirname(os.environ["SHAPEBENCH_LIBRARY"]), "shapebench")
    said = subprocess.run([program, "info", "--format", "json"], stdout=subprocess.PIPE, check=True).stdout
    command = " ".join(["baselines.py"] + sys.argv[1:])
    return json.loads(said)["environment"] | {"threads": 1, "command": command[:1000]}


def attributes(node, values):
    """Texts of fixed length, and truth as a number: as every result file has them."""
    for name, value in values.items():
        if isinstance(value, str):
            value = numpy.bytes_(value.encode())
        node.attrs[name] = int(value) if isinstance(value, bool) else value


def store(rows, plan, machine, output, overwrite):
    """The rows for reports, whole or not at all; raises draft.Refused and OSError."""
    import h5py
    import stored
    room = io.BytesIO()
    text = h5py.string_dtype("utf-8", 64)
    with h5py.File(room, "w", **stored.FORMAT) as h5:
        attributes(h5, {"kind": "shapebench baselines", "schema": 2})
        attributes(h5.create_group("machine"), machine)
        attributes(h5.create_group("plan"), plan | {"comparable": COMPARABLE, "not_comparable": NOT_COMPARABLE})
        methods = h5.create_group("methods")
        for name, column in zip(STORED, COLUMNS):
            values = [each[column] for each in rows]
            methods.create_dataset(name, data=values, dtype=text if isinstance(values[0], str) else float,
                                   fletcher32=True)
    stored.write_checksum(room)
    with draft.begun(output, overwrite) as file:
        file.write(room.getvalue())


def main(arguments):
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1].removeprefix("usage: "))
    parser.add_argument("--cells", type=int, default=4, choices=range(2, 17), metavar="N")
    parser.add_argument("--w", type=int, default=2, choices=range(1, 11), metavar="W")
    parser.add_argument("--h", type=float, default=0.001)
    parser.add_argument("--sag", type=float, default=0.1)
    parser.add_argument("--settle", type=int, default=600, help=argparse.SUPPRESS)
    parser.add_argument("--format", default="text", choices=("text", "markdown", "csv", "json"))
    parser.add_argument("-o", "--output")
    parser.add_argument("--overwrite", action="store_true")
    options = parser.parse_args(arguments)
    if not 1e-5 <= options.h <= 0.1 or not 0.001 <= options.sag <= 0.3:
        parser.error("--h is 1e-5 to 0.1, --sag 0.001 to 0.3")
    try:
        import shapebench as sb
        sb.engines()
        if options.output:
            import h5py  # noqa: F401, before what takes minutes
        machine = environment() if options.output else {}
    except (ImportError, OSError, subprocess.CalledProcessError) as reason:
        return missing(f"{reason}; cmake --build build makes the library and the program")
    build_adapter()
    try:
        if options.output:
            draft.check(options.output, options.overwrite)  # before what takes minutes
        rows, plan = measure(sb, options)
        write(compared(rows, plan["sag_percent"]), options.format, sys.stdout)
        if options.format in ("text", "markdown"):
            print(f"\nComparable: {COMPARABLE}.\n" + "\n" * (options.format == "markdown")
                  + f"Not comparable: {NOT_COMPARABLE}.", flush=True)
        if options.output:
            store(rows, plan, machine, options.output, options.overwrite)
    except (draft.Refused, OSError) as reason:
        print(f"baselines.py: {reason}", file=sys.stderr)
        return 4
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
