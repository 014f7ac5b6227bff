#!/usr/bin/python3
"""Damages stored files in many ways and hands them to everything that reads them: each must read or refuse, in one
line, with a documented exit code, without a crash, a traceback, much memory or much time.

usage: test_damage.py SHAPEBENCH [--rounds N] [--seed N] [--files FOLDER]

A round damages one file of every kind, and hands it to one reader: bits are flipped, bytes changed, ranges zeroed,
swapped or cut off, which must be refused or remarked on; or h5py sets attributes and datasets to wrong values, shapes
and types, which the reader must survive.
Default: 2 rounds (seconds); --rounds 300 takes an hour. A failure prints its seed and keeps the file in FOLDER.
Exit codes: 0 all as it should be, 1 not, 77 skipped: h5py is missing."""
import argparse
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile

from small_inputs import MAP, QUICK, has_maps, write_inputs

try:
    import h5py
    import numpy
except ImportError:
    print("skipped: /usr/bin/python3 has no h5py; scripts/setup installs it")
    sys.exit(77)

SCRIPTS = os.path.dirname(os.path.abspath(__file__))
MOST_MEMORY = 3 << 30  # bytes of address space; the readers' own libraries map most of one
MOST_SECONDS = 60  # of processor time, and ten times as long by the clock
MADE = {  # file: what makes it
    "rows.h5": ["tables", "--scene", "a.cfg", *QUICK],
    "sweep.h5": ["sweep", "--scene", "a.cfg", "--w", "1:2", "--epsilon", "0", "--frames", "2", *QUICK],
    "claims.h5": ["claims", "--claims", "mine.cfg", "--claim", "mine", "--quick"],
    "beam.h5": ["calibrate", "--scene", "beam.cfg", "--w", "1:2", "--epsilon", "0", "--across", "1", "--aspect", "none",
                "--step", "none"],
    "map.h5": MAP,
    "particles.vtkhdf": ["run", "a.cfg", "--record", "particles"],
    "nodes.vtkhdf": ["run", "a.cfg", "--engine", "octree", "--record", "nodes"],
}
COPIED = {"baselines.h5": "results/published/baselines.h5"}  # whose making needs Bullet, and minutes
READ = {  # file: what reads it; @ is the file, ! a new name
    "rows.h5": [["PROGRAM", "regress", "--baseline", "@", "--scene", "nothing"],
                ["PROGRAM", "report", "-o", "!.html", "@"]],
    "sweep.h5": [["PROGRAM", "sweep", "@"], ["PROGRAM", "report", "-o", "!.html", "@"],
                 ["plot_sweep.py", "@", "-o", "!.svg"]],
    "beam.h5": [["PROGRAM", "calibrate", "@"], ["PROGRAM", "report", "-o", "!.html", "@"],
                ["plot_calibration.py", "@", "-o", "!.svg"]],
    "claims.h5": [["PROGRAM", "report", "-o", "!.html", "@"]],
    "baselines.h5": [["PROGRAM", "report", "-o", "!.html", "@"]],
    "map.h5": [["plot_map.py", "@", "-o", "!.png"]],
    "particles.vtkhdf": [["brute_force.py", "@"]],
    "nodes.vtkhdf": [["brute_force.py", "@"]],
}
FINE = {0, 1, 2, 3}  # documented, of readers: done, a check failed, nothing to compare or no such scene, unusable


def flip(data, chance):
    at = chance.randrange(len(data))
    data[at] ^= 1 << chance.randrange(8)


def scatter(data, chance):
    for _ in range(1 << chance.randrange(7)):
        data[chance.randrange(len(data))] = chance.choice([0, 1, 255, 127, 128, chance.randrange(256)])


def blank(data, chance):
    at, size = chance.randrange(len(data)), 1 << chance.randrange(12)
    data[at:at + size] = bytes([chance.choice([0, 255])]) * len(data[at:at + size])


def swap(data, chance):
    size = 1 << chance.randrange(3, 11)
    a, b = (chance.randrange(max(1, len(data) - size)) for _ in "ab")
    data[a:a + size], data[b:b + size] = data[b:b + size], data[a:a + size]


def cut(data, chance):
    del data[chance.randrange(len(data)):]


def objects(group):
    """Every group and dataset below."""
    for name in group:
        if group.get(name, getclass=True, getlink=True) is not h5py.HardLink:
            continue
        node = group[name]
        yield node
        if isinstance(node, h5py.Group):
            yield from objects(node)


def odd_value(chance):
    return chance.choice([numpy.inf, -numpy.inf, numpy.nan, 0, -1, 2**31 - 1, -2**31, 2**62, 1e300, b"text", b"",
                          "é" * 300, numpy.zeros(3), numpy.zeros((2, 3), "i8"), numpy.zeros(0)])


def wrong_attribute(file, chance):
    node = chance.choice([n for n in [file, *objects(file)] if len(n.attrs)])
    name = chance.choice(sorted(node.attrs))
    if chance.random() < 0.3:
        del node.attrs[name]
    else:
        node.attrs[name] = odd_value(chance)


def wrong_number(file, chance):
    node = chance.choice([n for n in objects(file) if isinstance(n, h5py.Dataset) and n.size and not n.is_virtual
                          and n.dtype.kind in "iuf"])
    kinds = [numpy.inf, numpy.nan, -numpy.inf, 1e300, 0, -1] if node.dtype.kind == "f" else [
        0, numpy.iinfo(node.dtype).max, numpy.iinfo(node.dtype).min, 1]
    values = node[()]
    with numpy.errstate(all="ignore"):
        values.flat[chance.randrange(values.size)] = chance.choice(kinds)
    node[()] = values


def wrong_dataset(file, chance):
    node = chance.choice([n for n in objects(file) if isinstance(n, h5py.Dataset) and not n.is_virtual])
    name, shape, kind, parent = node.name, list(node.shape) or [1], node.dtype, node.parent
    del file[name]
    way = chance.randrange(5)
    if way == 1:
        shape[chance.randrange(len(shape))] = chance.choice([0, 1, 3, 1 << 16, 1 << 33])
        file.create_dataset(name, shape, kind, chunks=True if chance.random() < 0.5 else None)
    elif way == 2:
        file.create_dataset(name, [min(s, 10**4) for s in shape], chance.choice(["f4", "i1", "S7", "u8"]))
    elif way == 3:
        parent[name] = chance.choice([h5py.ExternalLink("/dev/zero", "x"), h5py.SoftLink("/nothing"),
                                      h5py.SoftLink("/"), h5py.SoftLink(name)])
    elif way == 4:
        parent[name] = parent  # a group that holds itself


BYTES = (flip, scatter, blank, swap, cut)
CONTENT = (wrong_attribute, wrong_number, wrong_dataset)


def damage(source, path, chance):
    """Writes a damaged copy; what was done, and whether it must be noticed."""
    if chance.random() < 0.4:
        way = chance.choice(CONTENT)
        shutil.copy(source, path)
        with h5py.File(path, "r+") as file:
            way(file, chance)
        return way.__name__, False
    with open(source, "rb") as file:
        data = bytearray(file.read())
    way, whole = chance.choice(BYTES), bytes(data)
    way(data, chance)
    with open(path, "wb") as file:
        file.write(data)
    return way.__name__, bytes(data) != whole


def limit():
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS))


def judge(words, must_notice):
    """What is wrong about how the command ends, or nothing."""
    try:
        done = subprocess.run(words, capture_output=True, timeout=10 * MOST_SECONDS, preexec_fn=limit, check=False,
                              env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})
    except subprocess.TimeoutExpired:
        return f"takes more than {10 * MOST_SECONDS} s"
    said = done.stderr.decode("utf-8", "replace")
    if done.returncode not in FINE:
        return f"exit code {done.returncode}: {said[-300:]}"
    if "Traceback" in said or "HDF5-DIAG" in said or "rror #" in said:
        return f"not one line: {said[-300:]}"
    if done.returncode == 3 and said.count("\n") != 1:
        return f"not one line: {said[:300]}"
    if must_notice and done.returncode != 3 and "written to by another program" not in said:
        return f"the damage is not noticed: exit code {done.returncode}"
    return ""


def make_files(program, folder):
    write_inputs(folder)
    for name, source in COPIED.items():
        shutil.copy(os.path.join(os.path.dirname(SCRIPTS), source), os.path.join(folder, name))
    if not has_maps(program):
        del MADE["map.h5"], READ["map.h5"]
    for name, words in MADE.items():
        done = subprocess.run([program, *words, "--quiet", "-o", name], cwd=folder, capture_output=True, text=True)
        if not os.path.exists(os.path.join(folder, name)):
            sys.exit(f"{name} was not made: {done.stderr}")


def one(program, folder, name, seed):
    """Damages the file once and has it read; whether that ends wrong."""
    chance = random.Random(f"{name} {seed}")
    path = os.path.join(folder, "damaged" + os.path.splitext(name)[1])
    way, must = damage(os.path.join(folder, name), path, chance)
    reader = [os.path.join(folder, word) if word == "a.cfg" else word for word in chance.choice(READ[name])]
    words = [word.replace("@", path).replace("!", os.path.join(folder, "new")) for word in reader]
    words[0] = program if words[0] == "PROGRAM" else os.path.join(SCRIPTS, words[0])
    why = judge(words, must)
    for left in os.listdir(folder):
        if left.startswith("new"):
            os.remove(os.path.join(folder, left))
    if why:
        kept = os.path.join(folder, f"wrong-{seed}-{name}")
        shutil.copy(path, kept)
        print(f"{kept}: {way}, {' '.join(reader)}: {why}", flush=True)
    return bool(why)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("program")
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--files", help="a folder to work in and keep (default: one that is removed if all is right)")
    options = parser.parse_args()
    folder = options.files or tempfile.mkdtemp(prefix="shapebench_damage_")
    os.makedirs(folder, exist_ok=True)
    make_files(os.path.abspath(options.program), folder)
    seeds = range(options.seed, options.seed + options.rounds)
    wrong = sum(one(os.path.abspath(options.program), folder, name, seed) for seed in seeds for name in READ)
    print(f"{options.rounds * len(READ)} damaged files, {wrong} wrong ends")
    if not wrong and not options.files:
        shutil.rmtree(folder)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
