#!/usr/bin/python3
"""Draws random scenes and runs each with the program's own checks.

usage: test_scenes.py SHAPEBENCH [--scenes N | --seconds N] [--seed S] [--most PARTICLES] [--files FOLDER]

Bodies are built-in shapes and random meshes (boxes, blobs, tubes, sheets, needles, loose triangles); engine, size,
instances, w, fill, sums, layout, rotations, precision, threads, damping, strain limit, handles, forces, obstacles,
contacts, cuts, touches, an eye, and the octree's and the meshless engine's settings are drawn at random. `shapebench
run` holds the last state to brute force. What the program refuses, by one line and exit code 2 or 3, is counted; a
scene fails that is INVALID, ends otherwise, or takes longer than 300 s. The scene file that failed and its mesh are
kept in FOLDER, with all settings left out that it fails without, and the command that runs it is printed.

Scene n of a seed is always the same. Default: the first 100 scenes of seed 1, of at most 3000 particles a body, and a
new folder; --seconds 7200 --seed 2 goes on for two hours.
Exit codes: 0 none failed, 1 some did, 2 usage."""
import argparse
import math
import os
import random
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

TIMEOUT = 300  # s; what takes longer hangs: scenes are of a second
SHAPES = {"penguin": 1, "infant": 0.6, "hand": 0.2, "liver": 0.2, "flower": 0.4, "block": 0.2, "beam": 0.8, "bar": 0.5}
CUBE = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


# ---- Meshes: lists of vertices and of faces


def add(mesh, vertices, faces):
    first = len(mesh[0])
    mesh[0].extend(vertices)
    mesh[1].extend(tuple(first + v for v in face) for face in faces)


def add_box(mesh, low, high):
    add(mesh, [tuple((low, high)[c >> d & 1][d] for d in range(3)) for c in range(8)], CUBE)


def draw_boxes(r, mesh):
    """A random walk of cubes that overlap, and holes between them."""
    at = [0, 0, 0]
    for _ in range(r.randint(1, 12)):
        add_box(mesh, [a - 0.02 for a in at], [a + 1.02 for a in at])
        at[r.randrange(3)] += r.choice([-1, 1])


def draw_blob(r, mesh):
    """A sphere with waves."""
    rows, columns, waves = r.randint(3, 16), r.randint(3, 24), [r.uniform(-0.2, 0.2) for _ in range(4)]
    scale = [r.uniform(0.2, 1) for _ in range(3)]
    vertices = []
    for i in range(rows + 1):
        for j in range(columns):
            a, b = math.pi * i / rows, 2 * math.pi * j / columns
            radius = 1 + sum(w * math.sin((k + 1) * a) * math.cos(k * b) for k, w in enumerate(waves))
            way = (math.sin(a) * math.cos(b), math.cos(a), -math.sin(a) * math.sin(b))
            vertices.append(tuple(radius * s * x for s, x in zip(scale, way)))
    faces = []
    for i in range(rows):
        for j in range(columns):
            k = (j + 1) % columns
            faces.append((i * columns + j, (i + 1) * columns + j, (i + 1) * columns + k, i * columns + k))
    add(mesh, vertices, faces)


def draw_tubes(r, mesh):
    """Square tubes from one place to all sides."""
    for _ in range(r.randint(1, 6)):
        way, thick = [r.gauss(0, 1) for _ in range(3)], r.uniform(0.03, 0.3)
        side = [way[1], -way[0], 0.1]
        up = [way[1] * side[2] - way[2] * side[1], way[2] * side[0] - way[0] * side[2],
              way[0] * side[1] - way[1] * side[0]]
        side, up = ([thick * x / math.hypot(*v) for x in v] for v in (side, up))
        add(mesh, [tuple((c >> 2) * w + (c & 1) * s + (c >> 1 & 1) * u for w, s, u in zip(way, side, up))
                   for c in range(8)], CUBE)


def draw_sheet(r, mesh):
    high = [1, r.uniform(0.3, 1), r.uniform(0.3, 1)]
    high[r.randrange(3)] = r.uniform(0.005, 0.05)
    add_box(mesh, [0, 0, 0], high)


def draw_needles(r, mesh):
    """A fan of thin tetrahedra."""
    for _ in range(r.randint(2, 30)):
        way = [r.gauss(0, 1) for _ in range(3)]
        foot = [tuple(r.uniform(-0.02, 0.02) for _ in range(3)) for _ in range(3)]
        add(mesh, foot + [tuple(way)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])


def draw_triangles(r, mesh):
    """Loose triangles, most of them long and thin."""
    for _ in range(r.randint(1, 60)):
        at = [r.uniform(-1, 1) for _ in range(3)]
        add(mesh, [tuple(a + r.gauss(0, s) for a in at) for s in (0.01, 0.05, r.uniform(0.05, 1))], [(0, 1, 2)])


MESHES = [draw_boxes, draw_boxes, draw_blob, draw_blob, draw_tubes, draw_sheet, draw_needles, draw_triangles]


def write_mesh(r, path):
    """Writes a random mesh and returns the corners of its box, and whether it has no inside."""
    mesh, scale, away = ([], []), 10 ** r.uniform(-2, 1), [r.uniform(-3, 3) for _ in range(3)]
    drawn = [r.choice(MESHES) for _ in range(r.choice([1, 1, 1, 2]))]
    for draw_one in drawn:
        draw_one(r, mesh)
    vertices = [[scale * (x + a) for x, a in zip(v, away)] for v in mesh[0]]
    with open(path, "w", encoding="ascii") as file:
        file.writelines("v %.9g %.9g %.9g\n" % tuple(v) for v in vertices)
        file.writelines("f %s\n" % " ".join(str(v + 1) for v in face) for face in mesh[1])
    low, high = ([end(v[d] for v in vertices) for d in range(3)] for end in (min, max))
    return low, high, draw_triangles in drawn


# ---- Scenes: dictionaries of settings; values are numbers, texts, vectors (tuples), lists of groups, groups


class Scene:
    """Draws a scene's settings of a body within the box `low`, `high`."""

    def __init__(self, r, mesh, low, high, loose, most):
        self.r, self.low, self.high, self.most = r, low, high, most
        self.size = max(h - l for l, h in zip(low, high))
        self.settings = {"mesh": mesh}
        self.draw_body(loose)
        self.draw_motion()
        self.draw_held()
        engine = self.settings["engine"]
        if engine != "meshless": # whose bodies nothing stops
            self.draw_obstacles()
        if engine == "octree":
            self.draw_octree()
        elif engine == "meshless":
            self.draw_meshless()
        else:
            self.draw_lattice()
        self.draw_changes()

    def often(self, share):
        return self.r.random() < share

    def log(self, low, high):
        return math.exp(self.r.uniform(math.log(low), math.log(high)))

    def point(self, beyond=0.2):
        return tuple(l + (h - l) * self.r.uniform(-beyond, 1 + beyond) for l, h in zip(self.low, self.high))

    def draw_body(self, loose):
        s, r = self.settings, self.r
        s["engine"] = r.choices(["fastlsm", "octree", "meshless", "brute"], [50, 40, 5, 5])[0]
        s["fill"] = "shell" if loose or self.often(0.3) else "solid"
        s["particles"] = round(self.log(8, self.most))
        s["instances"] = 1 if s["engine"] == "meshless" or self.often(0.5) else r.randint(2, 40)
        most = self.most if s["engine"] == "brute" else 10 * self.most # brute force is slow
        s["particles"] = max(8, min(s["particles"], most // s["instances"]))
        s["spacing"] = r.choice([1.0, 1.2, 1.5, 3.0])
        if self.often(0.4):
            s["density"] = self.log(1, 1e4)

    def draw_motion(self):
        s, r = self.settings, self.r
        s["h"] = r.choice([0.001, 0.01, 0.02, 0.04])
        s["frames"], s["steps_per_frame"] = r.choice([1, 2, 5]), r.choice([1, 4, 20])
        if self.often(0.5):
            s["damping"] = r.choice([0.02, 0.1, 0.5, 1.0])
            s["damping_every"] = r.choice([1, 1, 2, 5])
        if self.often(0.6): # no more than a hundredth of the body a step and step
            s["gravity"] = tuple(self.size * r.uniform(-0.01, 0.01) / s["h"] ** 2 for _ in range(3))
        for name, most in (("bend", 1.5), ("twist", 2.0), ("squash", 0.5)):
            if self.often(0.4):
                s[name] = r.uniform(-most, most)
        s["kick"] = r.choice([0.0, 0.02, 0.1])

    def selection(self):
        """A slab at one end."""
        low, high, axis = [0.0] * 3, [1.0] * 3, self.r.randrange(3)
        if self.often(0.5):
            low[axis] = self.r.uniform(0.3, 0.9)
        else:
            high[axis] = self.r.uniform(0.1, 0.7)
        return {"box_low": tuple(low), "box_high": tuple(high)}

    def draw_held(self):
        s, r = self.settings, self.r
        while self.often(0.3):
            handle = self.selection()
            handle.update(velocity=tuple(self.size * r.uniform(-0.5, 0.5) for _ in range(3)),
                          axis=(0.0, 1.0, 0.0), centre=self.point(), rate=r.uniform(-2, 2))
            s.setdefault("handles", []).append(handle)
        if self.often(0.2):
            # as gravity, or a part of it: its particles of 1 kg, or as heavy as those of a full box
            mass = s.get("density", 0) * self.size ** 3 / s["particles"] or 1
            force = tuple(mass * self.size * r.uniform(-0.001, 0.001) / s["h"] ** 2 for _ in range(3))
            s["forces"] = [dict(self.selection(), force=force, start=0.0, stop=r.uniform(0, 0.1))]

    def draw_obstacles(self):
        s, r = self.settings, self.r
        friction = r.choice([0.0, 0.3, 1.0])
        if self.often(0.25):
            s["planes"] = [{"point": self.point(), "normal": (r.gauss(0, 1), 1.0, 0.2), "friction": friction}]
        if self.often(0.15):
            s["spheres"] = [{"centre": self.point(), "radius": self.size * r.uniform(0.05, 0.5)}]
        if self.often(0.15):
            low = self.point()
            s["boxes"] = [{"low": low, "high": tuple(l + self.size * r.uniform(0.1, 0.6) for l in low)}]
        if self.often(0.15):
            s["capsules"] = [{"from": self.point(), "to": self.point(), "radius": self.size * r.uniform(0.05, 0.3),
                              "friction": friction}]
        if self.often(0.3):
            s["collide"] = {"self": self.often(0.6), "bodies": self.often(0.6), "friction": friction}

    def draw_lattice(self):
        s, r = self.settings, self.r
        s["w"] = r.choices([1, 2, 3, 4, 5, 8, 12], [6, 6, 4, 3, 2, 1, 1])[0]
        if self.often(0.4):
            s["layout"] = r.choice(["lists", "blocks"])
        if s["instances"] == 1 or self.often(0.05): # others are refused
            s["summation"] = r.choice(["fast", "fast", "bars", "naive"])
            s["polar"] = r.choice(["fast", "fast", "jacobi"])
            if self.often(0.2):
                s["strain_limit"] = r.choice([1.05, 1.3, 2.0])

    def draw_octree(self):
        s, r, o = self.settings, self.r, {}
        s["epsilon"] = r.choice([0.0, 0.25, 0.5, 1.0])
        if self.often(0.6):
            o["levels"] = r.randint(1, 5)
        if self.often(0.3):
            o["bases"] = r.randint(1, 40)
        if self.often(0.4):
            o["nodes"] = round(self.log(1, self.most / 4))
        o["balance"] = self.often(0.3)
        kinds = [{"kind": "uniform"}, {"kind": "features"}, {"kind": "surface"},
                 {"kind": "sphere", "centre": self.point(0), "radius": self.size * r.uniform(0.05, 0.5)}]
        if self.often(0.5):
            o["criteria"] = r.sample(kinds, r.randint(1, 2))
        width = r.choice(["edges", "w", "both", "summation_nodes", "default"])
        if width in ("edges", "both"):
            o["edges"] = r.choice([0.75, 1.0, 1.5, 2.0, 3.0])
        if width in ("w", "both"):
            o["w"] = r.choice([1.0, 2.5, 4.0])
        if width == "summation_nodes":
            o["summation_nodes"] = r.uniform(2, 40)
        if self.often(0.3):
            o["widths"] = [{"low": tuple(self.low), "high": self.point(-0.3), "edges": r.choice([0.75, 2.0, 3.0])}]
        for name, words in (("masses", ["material", "volume"]), ("weighting", ["conserving", "plain"]),
                            ("goals", ["gather", "adjoint"])):
            if self.often(0.3):
                o[name] = r.choice(words)
        if self.often(0.2):
            o.update(**{"yield": r.uniform(0, 0.2), "creep": r.uniform(0, 1) / s["h"], "most": r.uniform(0.1, 1)})
        s["octree"] = o

    def draw_meshless(self):
        s, r = self.settings, self.r
        s["damping"] = r.choice([0.0, 0.02, 0.5])
        s["meshless"] = {"young": self.log(1e3, 1e7), "poisson": r.uniform(-0.5, 0.45), "points": 3000,
                         "nodes": r.randint(30, 300), "modes": r.randint(7, 40), "uniform": self.often(0.5)}

    def draw_changes(self):
        s, r = self.settings, self.r
        end = s["h"] * s["frames"] * s["steps_per_frame"]
        octree, start = s["engine"] == "octree", r.choice([0.0, 0.3 * end])
        alone = s["instances"] == 1 or self.often(0.05) # others are refused
        if alone and s["engine"] in ("fastlsm", "octree") and self.often(0.4):
            middle, beyond = self.point(0), self.size
            cut = {"base_from": (middle[0], middle[1] + beyond, middle[2] - beyond),
                   "tip_from": (middle[0] + 0.1 * beyond, middle[1] + beyond, middle[2] + beyond),
                   "base_to": (middle[0], middle[1] - beyond, middle[2] - beyond),
                   "tip_to": (middle[0], middle[1] - beyond, middle[2] + beyond),
                   "start": start, "stop": start + r.uniform(0.1, 0.9) * end}
            if octree and self.often(0.5):
                cut.update(level=r.randint(1, 5), reach=r.uniform(0, 4))
            s["cuts"] = [cut]
        if octree and self.often(0.25):
            s["touches"] = [{"instance": r.randint(1, s["instances"]), "centre": self.point(0),
                             "radius": self.size * r.uniform(0.05, 0.3), "level": r.randint(1, 5), "start": start,
                             "stop": start + 0.4 * end, "hold": r.choice([0.0, 0.2 * end])}]
        if octree and alone and self.often(0.25):
            s["view"] = {"eye_from": self.point(1), "eye_to": self.point(1), "start": 0.0, "stop": end,
                         "near": self.size * r.uniform(0.05, 0.5), "slack": 0.1, "level": r.randint(1, 5)}


def text_of(value):
    """A value as libconfig has it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        text = repr(value)
        return text if "." in text or "e" in text and "." in text else text.replace("e", ".0e") if "e" in text else text
    if isinstance(value, int):
        return str(value)
    if isinstance(value, str):
        return '"%s"' % value
    if isinstance(value, tuple):
        return "[" + ", ".join(text_of(float(v)) for v in value) + "]"
    if isinstance(value, list):
        return "( " + ", ".join(text_of(v) for v in value) + " )"
    return "{ " + " ".join(f"{name} = {text_of(v)};" for name, v in value.items()) + " }"


def write_scene(path, settings):
    with open(path, "w", encoding="ascii") as file:
        file.writelines(f"{name} = {text_of(value)};\n" for name, value in settings.items())


# ---- Runs


def command_of(program, path, options):
    return [program, "run", path, "--no-output", "--quiet", *options]


def run(command):
    """What is wrong, or None; and whether the scene was refused."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=TIMEOUT, check=False)
    except subprocess.TimeoutExpired:
        return f"no end after {TIMEOUT} s", False
    lines = done.stderr.strip().splitlines()
    said = lines[-1] if lines else ""
    if done.returncode in (2, 3):
        good = len(lines) == 1 and said.startswith("shapebench")
        return (None if good else f"refused in {len(lines)} lines: {done.stderr.strip()[:500]}"), True
    if done.returncode:
        why = f"signal {-done.returncode}" if done.returncode < 0 else f"exit code {done.returncode}"
        return f"{why}: {said[:500]}", False
    bad = any(word in done.stdout.lower().split() for word in ("nan", "-nan", "inf"))
    return ("a number is not finite:\n" + done.stdout if bad else None), False


def kind_of(wrong):
    """Two failures with the same beginning are taken for one."""
    return wrong.split(":")[0]


def reduce(program, path, settings, options, wrong):
    """Leaves out, one after the other, the settings without which it fails the same way."""
    for group in [settings, *(v for v in settings.values() if isinstance(v, dict))]:
        for name in [n for n in group if n not in ("mesh", "particles", "engine", "frames", "steps_per_frame")]:
            kept = dict(group)
            del group[name]
            write_scene(path, settings)
            again, _ = run(command_of(program, path, options))
            if not again or kind_of(again) != kind_of(wrong):
                group.clear()
                group.update(kept)
    write_scene(path, settings)


def draw(seed, number, folder, most):
    """The scene file, its settings, and the options it is run with."""
    r = random.Random(f"{seed}/{number}")
    if r.random() < 0.15:
        name, size = r.choice(list(SHAPES.items()))
        mesh, low, high = "shape:" + name, [-size / 3, 0, -size / 3], [size / 3, size, size / 3]
        loose = False
    else:
        mesh = f"{seed}-{number}.obj"
        low, high, loose = write_mesh(r, os.path.join(folder, mesh))
    settings = Scene(r, mesh, low, high, loose, most).settings
    path = os.path.join(folder, f"{seed}-{number}.cfg")
    write_scene(path, settings)
    options = ["--threads", str(r.choice([1, 1, 2, 3])), "--seed", str(r.randrange(1000))]
    if settings["engine"] in ("fastlsm", "octree"):
        options += ["--precision", r.choice(["single", "single", "double"])]
    return path, settings, options


def keep(program, path, settings, options, wrong, folder):
    """Keeps a scene that failed, reduced, and says how to run it."""
    os.makedirs(folder, exist_ok=True)
    kept = os.path.join(folder, os.path.basename(path))
    mesh = os.path.join(os.path.dirname(path), settings["mesh"])
    if os.path.exists(mesh):
        shutil.copy(mesh, folder)
    write_scene(kept, settings)
    print(f"\n{kept}: {wrong}\n  {shlex.join(command_of(program, kept, options))}", flush=True)
    if not wrong.startswith("no end"): # or it would take hours
        reduce(program, kept, settings, options, wrong)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--seconds", type=float, help="instead of --scenes: until then")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--most", type=int, default=3000, help="particles of a body")
    parser.add_argument("--files", help="folder of what failed (default: a new one)")
    given = parser.parse_args()
    program = os.path.abspath(given.program)
    if not os.access(program, os.X_OK):
        parser.error(f"{given.program} is not a program: build it")
    began, number, refused, failed = time.monotonic(), 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        while number < given.scenes if given.seconds is None else time.monotonic() - began < given.seconds:
            path, settings, options = draw(given.seed, number, folder, given.most)
            wrong, no = run(command_of(program, path, options))
            number, refused, failed = number + 1, refused + no, failed + bool(wrong)
            if wrong:
                given.files = os.path.abspath(given.files or tempfile.mkdtemp(prefix="scenes_"))
                keep(program, path, settings, options, wrong, given.files)
    print(f"seed {given.seed}: {number} scenes, {refused} refused, {failed} failed, "
          f"{time.monotonic() - began:.0f} s")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
