#!/usr/bin/python3
"""Every link in the documents leads somewhere, every command in them runs, and the front page is short.

usage: test_documents.py PROGRAM      PROGRAM: the built shapebench

The commands are the lines that are indented by four spaces and begin with scripts/, build/, mpirun or for. Those of a
document run one after the other in one folder of scratch, the program with fewer frames, repeats and points (small()).
ELSEWHERE has those that other tests run."""
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from small_inputs import BOX, write_inputs

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), ".."))
PROGRAM = ""
MOST_WORDS = 700
TUTORIAL = os.path.join("bench", "TUTORIAL.md")
ELSEWHERE = {
    r"scripts/run view|scripts/view/film.py": "scripts/view/run_tests.py",
    r"scripts/run regress --revision": "scripts/check_regress.sh",
    r"scripts/run regress --baseline": "bench/regress/test_regress.c; a stored file wants a quiet machine",
    r"scripts/run kernels.*(oct-|resampling)": "bench/kernels/test_kernels.c",
    r"for |scripts/render.py .*\{": "whoever makes the pictures anew; scripts/test_render.sh",
    r"scripts/publish|scripts/view/pictures|scripts/test|scripts/setup": "CI, or whoever publishes",
    r"mpirun": "bench/sweep/test_sweep_run.c",
    r"scripts/brute_force.py": "scripts/test_brute_force.py, bench/play/test_step_record.c",
    r"scripts/check_|scripts/readme.py": "by hand",
    r"scripts/baselines.py": "scripts/test_baselines.py",
    r"cmake|cc |export ": "scripts/test_install.sh",
}
# What a command of the program is given in the place of what the document says, and what it is not given.
SMALL = {
    "run": {"--frames": "1", "--steps": "1"},
    "tables": {"--repeats": "2", "--block": "0.01", "--quiet": None},
    "claims": {"--paper": "fastlsm", "--claim": "cold-sweeps", "--quick": None, "--quiet": None},
    "sweep": {"--frames": "1", "--repeats": "1", "--block": "0.01", "--quiet": None, "--w": "1:2", "--epsilon": "0"},
    "calibrate": {"--scene": "beam.cfg", "--w": "1", "--epsilon": "0", "--across": "none", "--aspect": "none",
                  "--step": "none", "--quiet": None},
    "report": {"--no-page": None, "--quiet": None},
    "kernels": {"--only": "polar", "--repeats": "1", "--quiet": None},
}
ELASTIC = {"--nodes": "100", "--modes": "8", "--points": "4000"}  # of these scenes, and of the engine meshless
ELASTIC_SCENES = {"beam-elastic", "balljoint", "rabbit", "santa", "meshless"}
SHELLS = {"rockerarm", "gargoyle", "bunny", "shell"}
LIGHT = {"fastlsm": "penguin", "octree": "hand-sampled", "meshless": "beam-elastic"}


def documents():
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=ROOT, text=True,
                            stdout=subprocess.PIPE).stdout.split()
    if listed:
        return listed
    return [os.path.relpath(os.path.join(folder, name), ROOT) for folder, _, names in os.walk(ROOT) for name in names
            if name.endswith(".md") and "build" not in folder]


def text_of(document):
    with open(os.path.join(ROOT, document), encoding="utf-8") as file:
        return file.read()


def anchors(text):
    """As a heading becomes one: lower case, without punctuation, hyphens for blanks."""
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
            for heading in re.findall(r"^#+ (.*)", text, re.MULTILINE)}


def commands(text):
    """The document's commands in order, continued lines joined."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    lines = [line[4:] for line in re.sub(r"\\\n *", "", text).splitlines() if line.startswith("    ")]
    found, loop = [], ""
    for line in lines:
        loop += line + "\n"
        if line.startswith("for ") and not line.rstrip().endswith("done"):
            continue
        if "\n" in loop.rstrip("\n") and not loop.rstrip().endswith("done"):
            continue
        if re.match(r"(scripts/|build/|mpirun|cmake|export |cc |for )", loop):
            found.append(loop.strip())
        loop = ""
    return found


def small(arguments):
    """The program's arguments for little work."""
    command = arguments[0] if arguments and arguments[0] in SMALL else ""
    wanted = dict(SMALL.get(command, {}))
    if command in ("sweep", "calibrate") and arguments[1].endswith(".h5"):
        wanted = {}  # a question to a stored one
    if command == "run" and ELASTIC_SCENES.intersection(arguments):
        wanted.update({} if "POINTS.xyz" in arguments else ELASTIC, **{"--nodes": "100", "--modes": "8"})
    if command == "run" and SHELLS.intersection(arguments):
        wanted["--nodes"] = "100"
    if "--map" in arguments:
        wanted["--nodes"] = "100"
    if command == "tables":
        arguments = [re.sub("^hand(?=$|=)", LIGHT["octree"], word) for word in arguments]
        scene = arguments[arguments.index("--scene") + 1] if "--scene" in arguments else ""
        paper = arguments[arguments.index("--paper") + 1] if "--paper" in arguments else "fastlsm"
        if not scene:
            wanted["--scene"] = LIGHT[paper]
    kept, skip = [], False
    for word in arguments:
        if not skip and word not in wanted:
            kept.append(word)
        skip = not skip and word in wanted and wanted[word] is not None
    return kept + [word for name, value in wanted.items() for word in (name, value) if word is not None]


def shim():
    """What stands for scripts/run in a document's folder."""
    arguments = small(sys.argv[1:]) if len(sys.argv) > 1 else small(["tables"])
    os.execv(os.environ["SHAPEBENCH_PROGRAM"], ["shapebench"] + arguments)


def furnish(folder):
    """Scratch with the files that the documents' readers have, and scripts/ with a small program."""
    os.mkdir(os.path.join(folder, "results"))
    os.mkdir(os.path.join(folder, "scripts"))
    os.mkdir(os.path.join(folder, "build"))
    for name in os.listdir(os.path.join(ROOT, "scripts")):
        if name != "run":
            os.symlink(os.path.join(ROOT, "scripts", name), os.path.join(folder, "scripts", name))
    for name in ("scripts/run", "build/shapebench"):
        path = os.path.join(folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(f'#!/bin/sh\nexec /usr/bin/python3 "{os.path.realpath(__file__)}" --shim "$@"\n')
        os.chmod(path, 0o755)
    write_inputs(folder)
    for name in ("MESH.obj", "my.obj", "hand_closed.obj", "LARGE.obj"):
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(BOX.replace("0.", "") if name == "LARGE.obj" else BOX)
    write_ball(os.path.join(folder, "POINTS.xyz"))
    os.symlink(os.path.join(ROOT, "results", "published"), os.path.join(folder, "results", "published"))
    for published, names in {"fastlsm": ("fastlsm", "monday", "tuesday", "base"), "claims": ("claims",),
                             "sweep": ("hand",), "calibration": ("beam",), "baselines": ("baselines",)}.items():
        for name in names:
            if not os.path.exists(os.path.join(folder, name + ".h5")):
                shutil.copy(os.path.join(ROOT, "results", "published", published + ".h5"),
                            os.path.join(folder, name + ".h5"))


def write_files(text, folder):
    """The files that a document tells its reader to write, <!-- file: NAME --> before a block."""
    for name, content in re.findall(r"^<!-- file: (\S+) -->\n```\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(content)


def write_ball(path):
    """Points with normals on a ball, along a spiral."""
    count = 2000
    with open(path, "w", encoding="utf-8") as file:
        for k in range(count):
            z = 1 - (2 * k + 1) / count
            r, a = (1 - z * z) ** 0.5, 2.399963 * k
            x, y = r * math.cos(a), r * math.sin(a)
            file.write(f"{x} {y} {z} {x} {y} {z}\n")


def has_vtk():
    return subprocess.run(["/usr/bin/python3", "-c", "import vtk"], stderr=subprocess.DEVNULL).returncode == 0


class Documents(unittest.TestCase):
    def test_front_page_is_short(self):
        words = sum(any(map(str.isalnum, word)) for word in text_of("README.md").split())
        self.assertLessEqual(words, MOST_WORDS)

    def test_links_lead_somewhere(self):
        for document in documents():
            text = text_of(document)
            for target in re.findall(r"\]\(([^)\s]+)\)", text):
                if re.match(r"[a-z]+:", target):
                    continue
                path, _, anchor = target.partition("#")
                file = os.path.normpath(os.path.join(ROOT, os.path.dirname(document), path)) if path else \
                    os.path.join(ROOT, document)
                with self.subTest(document=document, target=target):
                    self.assertTrue(os.path.exists(file))
                    if anchor:
                        self.assertIn(anchor, anchors(text_of(os.path.relpath(file, ROOT))))

    def test_commands_run(self):
        self.assertGreater(sum(self.follow(document) for document in documents() if document != TUTORIAL), 20)

    def test_tutorial_on_a_mesh_of_ones_own(self):
        particles = []

        def after(line, said, folder):
            if "--write-mesh" in line:  # a larger one in the place of the tutorial's: 3 m long
                shutil.copy(os.path.join(folder, "LARGE.obj"), os.path.join(folder, "my.obj"))
            if " calibrate " in line:
                self.paste(said, os.path.join(folder, "my.cfg"))
            particles.extend(re.findall(r"^my: fastlsm, .*: (\d+) particles", said, re.MULTILINE))

        self.assertGreater(self.follow(TUTORIAL, after), 8)
        self.assertEqual(len(particles), 4)
        self.assertEqual(len(set(particles)), 1)  # also of what calibrate printed

    def paste(self, said, scene):
        """Puts the settings that calibrate prints into a scene's file, in the place of its own of their names."""
        with open(scene, encoding="utf-8") as file:
            text = file.read()
        settings = re.findall(r"^    ((\w+) = .*;\n)", said, re.MULTILINE)
        self.assertGreater(len(settings), 3)
        for setting, name in settings:
            text = re.sub(rf"^{name} = .*\n", "", text, flags=re.MULTILINE) + setting
        with open(scene, "w", encoding="utf-8") as file:
            file.write(text)

    def follow(self, document, after=lambda line, said, folder: None):
        """Runs a document's commands in order, and what follows each; returns how many there were."""
        vtk, ran = has_vtk(), 0
        with tempfile.TemporaryDirectory() as folder:
            furnish(folder)
            write_files(text_of(document), folder)
            for line in commands(text_of(document)):
                if any(re.match(pattern, line) for pattern in ELSEWHERE) or ("render.py" in line and not vtk):
                    continue
                with self.subTest(document=document, command=line):
                    after(line, self.run_line(line, folder), folder)
                    ran += 1
        return ran

    def run_line(self, line, folder):
        for name in re.findall(r"(?:-o|--write-mesh) (\S+)", line):  # made by an earlier line, or furnished
            for made in (os.path.join(folder, name), os.path.join(folder, name + ".xdmf")):
                if os.path.isfile(made):
                    os.remove(made)
                elif os.path.isdir(made):
                    shutil.rmtree(made)
        environment = dict(os.environ, SHAPEBENCH_PROGRAM=PROGRAM)
        done = subprocess.run(["bash", "-e", "-c", line], cwd=folder, env=environment, text=True, timeout=300,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        self.assertEqual(done.returncode, 0, done.stdout[-2000:])
        return done.stdout


if __name__ == "__main__":
    if sys.argv[1:2] == ["--shim"]:
        sys.argv.pop(1)
        shim()
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        sys.exit("usage: test_documents.py PROGRAM")
    PROGRAM = os.path.realpath(sys.argv.pop(1))
    unittest.main(verbosity=1)
