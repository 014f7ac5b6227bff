#!/usr/bin/python3
"""Ends every command that writes at moments drawn by chance: by kill -9, by each signal that ends a program, and by a
full disk (a limit on file sizes, and a small tmpfs where one may be mounted). The file that it was to write must then
be as before or whole, never a part of one; but for kill -9 nothing else may be left; and it must run well afterwards.

usage: test_writers.py SHAPEBENCH [--rounds N] [--seed N]
Default: 1 round, every command ended once (half a minute); --rounds 100 takes half an hour.
Exit codes: 0 all as it should be, 1 not, 77 skipped: h5py or matplotlib is missing."""
import argparse
import importlib.util
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from small_inputs import MAP, QUICK, has_maps, write_inputs

if not all(importlib.util.find_spec(name) for name in ("h5py", "matplotlib", "jinja2")):
    print("skipped: h5py, matplotlib or jinja2 is missing; scripts/setup installs them")
    sys.exit(77)

SCRIPTS = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(1, os.path.join(SCRIPTS, "report"))
import stored

PROGRAM = "PROGRAM"  # stands for shapebench
COMMANDS = {  # what is written: the command, without its output; it comes last
    "rows.h5": [PROGRAM, "tables", "--scene", "a.cfg", *QUICK, "-o"],
    "sweep.h5": [PROGRAM, "sweep", "--scene", "a.cfg", "--w", "1:3", "--epsilon", "0", "--frames", "2", *QUICK, "-o"],
    "claims.h5": [PROGRAM, "claims", "--claims", "mine.cfg", "--claim", "mine", "--quick", "-o"],
    "beam.h5": [PROGRAM, "calibrate", "--scene", "beam.cfg", "--w", "1:2", "--epsilon", "0", "--across", "1",
                "--aspect", "none", "--step", "none", "-o"],
    "map.h5": [PROGRAM, *MAP, "-o"],
    "motion.vtkhdf": [PROGRAM, "run", "a.cfg", "--frames", "3000", "--record", "particles", "-o"],
    "mesh.obj": [PROGRAM, "scenes", "penguin", "--write-mesh"],
    "compared.json": [PROGRAM, "regress", "--baseline", "kept-rows.h5", "--scene", "a.cfg", "--rounds", "1", "--format", "json", "-o"],
    "page.html": [PROGRAM, "report", "kept-rows.h5", "-o"],
    "folder": [PROGRAM, "report", "kept-rows.h5", "-o"],
    "sweep.svg": ["plot_sweep.py", "kept-sweep.h5", "-o"],
    "sweep.png": ["plot_sweep.py", "kept-sweep.h5", "-o"],
}
KEPT = {"kept-" + name: name for name in ("rows.h5", "sweep.h5")}
GOES_ON = ("sweep.h5", "beam.h5")  # from a file that is there; the others replace it
ENDS = (signal.SIGKILL, signal.SIGHUP, signal.SIGINT, signal.SIGTERM, signal.SIGQUIT, signal.SIGUSR1, signal.SIGXCPU)
WHOLE = {".obj": b"\n", ".json": b"}\n", ".html": b"</html>", ".svg": b"</svg>", ".png": b"IEND\xaeB`\x82"}
REGRESS_CODES = (0, 5, 7)  # what it finds is no matter here
EVER = 300  # s
LEAST = 1024  # bytes that clang's OpenMP must be allowed to write


class Wrong(Exception):
    """Something is not as it should be."""


class Trial:
    """A folder in which commands are started and ended."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.seconds, self.size = {}, {}
        self.inputs = set()
        self.mounts = subprocess.run(["unshare", "-rm", "mount", "-t", "tmpfs", "tmpfs", folder],
                                     capture_output=True, check=False).returncode == 0

    def at(self, name):
        return os.path.join(self.folder, name)

    def words(self, name, overwrite):
        words = [self.program if word == PROGRAM else word for word in COMMANDS[name]]
        if words[0].endswith(".py"):
            words[0] = os.path.join(SCRIPTS, words[0])
        if "OUTPUT" in words:
            words[words.index("OUTPUT")] = name
        else:
            words.append(name)
        return words + (["--overwrite"] if overwrite and name not in GOES_ON else [])

    def start(self, words, **how):
        return subprocess.Popen(words, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                env={**os.environ, "TMPDIR": self.at("tmp"), "MPLCONFIGDIR": self.at("matplotlib"),
                                     "OMP_NUM_THREADS": "1"}, **how)

    def ends_well(self, name, overwrite=True):
        """Runs the command to its end, which is a good one."""
        done = self.start(self.words(name, overwrite))
        said = done.communicate(timeout=EVER)[1]
        if done.returncode and not (name == "compared.json" and done.returncode in REGRESS_CODES):
            raise Wrong(f"undisturbed it ends with {done.returncode}: {said}")
        if not self.whole(name):
            raise Wrong("undisturbed it writes no whole file")

    def whole(self, name):
        """Is the file or folder there and complete?"""
        path = self.at(name)
        if name == "folder":
            return os.path.exists(os.path.join(path, "index.html"))
        ending = os.path.splitext(name)[1]
        if ending in WHOLE:
            with open(path, "rb") as file:
                data = file.read()
            return WHOLE[ending] in data[-64:] and data.count(b"\n") > 3
        with stored.opened(path, stored.print_remark):
            return stored.checksum_holds(path)

    def content(self, name):
        """The file's bytes, the names in the folder, or nothing."""
        path = self.at(name)
        if os.path.isdir(path):
            return sorted(os.listdir(path))
        if not os.path.exists(path):
            return None
        with open(path, "rb") as file:
            return file.read()

    def prepare(self):
        """The inputs, and how long every command takes."""
        write_inputs(self.folder)
        if not has_maps(self.program):
            del COMMANDS["map.h5"]
        os.mkdir(self.at("tmp"))
        os.mkdir(self.at("matplotlib"))
        for name in COMMANDS:
            start = time.monotonic()
            self.ends_well(name, overwrite=False)
            self.seconds[name] = time.monotonic() - start
            self.size[name] = 0 if name == "folder" else os.path.getsize(self.at(name))
            for kept, of in KEPT.items():
                if of == name:
                    shutil.copy(self.at(name), self.at(kept))
        self.inputs = {entry for entry in os.listdir(self.folder) if entry not in COMMANDS and ".xdmf" not in entry}

    def remove_output(self, name):
        shutil.rmtree(self.at(name), ignore_errors=True)
        for entry in (name, name + ".xdmf"):
            if os.path.isfile(self.at(entry)):
                os.remove(self.at(entry))

    def check_rest(self, name, before, killed):
        """What is there after the end: as before or whole, and nothing else."""
        after = self.content(name)
        if after is not None and after != before and not self.whole(name):
            raise Wrong("a part of a file is left")
        if before is not None and after is None and name != "folder":
            raise Wrong("the file that was there is gone")
        left = {e for e in os.listdir(self.folder) if e not in self.inputs and e not in COMMANDS and not e.endswith(".xdmf")}
        left |= set(os.listdir(self.at("tmp")))
        if left and not killed:
            raise Wrong(f"left behind: {sorted(left)}")
        for entry in left:
            path = self.at(entry) if os.path.lexists(self.at(entry)) else os.path.join(self.at("tmp"), entry)
            shutil.rmtree(path) if os.path.isdir(path) else os.remove(path)

    def by_signal(self, name, chance):
        """Ends it by a signal; what was done."""
        number = chance.choice(ENDS)
        moment = chance.random() * 1.1 * self.seconds[name]
        done = self.start(self.words(name, True))
        try:
            said = done.communicate(timeout=moment)[1]
        except subprocess.TimeoutExpired:
            done.send_signal(number)
            said = done.communicate(timeout=EVER)[1]
        fine = {0, -number, 128 + number, *(REGRESS_CODES if name == "compared.json" else ())}
        if done.returncode not in fine or "Traceback" in said and number != signal.SIGINT:
            raise Wrong(f"{number.name} after {moment:.2f} s: exit code {done.returncode}: {said}")
        return f"{number.name} after {moment:.2f} s", number == signal.SIGKILL

    def by_limit(self, name, chance):
        """Ends it by a limit on file sizes, which stands in for a full disk."""
        size = max(1, self.size[name] or 2000)
        limit = chance.randrange(min(LEAST, size - 1), size)
        done = self.start(self.words(name, True), preexec_fn=lambda: resource.setrlimit(
            resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY)))
        said = done.communicate(timeout=EVER)[1]
        if done.returncode != 4 and not (done.returncode == 0 and name in GOES_ON):
            raise Wrong(f"files of at most {limit} bytes: exit code {done.returncode}: {said}")
        if "Traceback" in said or "HDF5-DIAG" in said:
            raise Wrong(f"files of at most {limit} bytes: {said}")
        return f"files of at most {limit} bytes", False

    def by_full_disk(self, name, chance):
        """Runs it in a tmpfs of a few pages, where one may be mounted; its files lie outside."""
        if not self.mounts or name in ("folder", "motion.vtkhdf"):
            return "nothing", False
        size = 4096 * chance.randrange(1, 3 + self.size[name] // 8192)
        script = ('mount -t tmpfs -o size="$1" tmpfs tmp/small || exit 99; shift; '
                  '"$@" >/dev/null 2>tmp/said; code=$?; ls -A tmp/small; exit $code')
        words = self.words(name, False)
        words[words.index(name)] = os.path.join("tmp/small", name)
        os.mkdir(self.at("tmp/small"))
        done = subprocess.run(["unshare", "-rm", "sh", "-c", script, "sh", str(size), *words], cwd=self.folder,
                              stdout=subprocess.PIPE, text=True, timeout=EVER, check=False,
                              env={**os.environ, "MPLCONFIGDIR": self.at("matplotlib")})
        os.rmdir(self.at("tmp/small"))
        with open(self.at("tmp/said"), encoding="utf-8") as file:
            said = file.read()
        os.remove(self.at("tmp/said"))
        left = set(done.stdout.split()) - ({name} if name in GOES_ON else set())
        if done.returncode != 4 or left or "Traceback" in said:
            raise Wrong(f"a disk of {size} bytes: exit code {done.returncode}, left {left}: {said}")
        return f"a disk of {size} bytes", False

    def end_once(self, name, chance):
        way = chance.choice((self.by_signal, self.by_signal, self.by_limit, self.by_full_disk))
        if chance.random() < 0.5:
            self.remove_output(name)
        before = self.content(name)
        how, killed = way(name, chance)
        try:
            self.check_rest(name, before, killed)
        except (Wrong, stored.Unusable, OSError) as error:
            raise Wrong(f"{how}: {error}") from None
        if killed:
            self.ends_well(name)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("program")
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    folder = tempfile.mkdtemp(prefix="shapebench_writers_")
    trial = Trial(os.path.abspath(options.program), folder)
    wrong = ended = 0
    name = "at first"
    try:
        trial.prepare()
        for seed in range(options.seed, options.seed + options.rounds):
            for name in COMMANDS:
                chance = random.Random(f"{name} {seed}")
                ended += 1
                try:
                    trial.end_once(name, chance)
                except Wrong as error:
                    wrong += 1
                    print(f"{' '.join(COMMANDS[name])} (seed {seed}): {error}")
    except Wrong as error:
        wrong += 1
        print(f"{name}: {error}")
    finally:
        shutil.rmtree(folder)
    if not trial.mounts:
        print("no tmpfs may be mounted here: no disk was full, only files were limited in size")
    print(f"{ended} commands were ended early, {wrong} wrong")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
