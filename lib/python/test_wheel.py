#!/usr/bin/python3
"""Makes the wheel, installs it in a new environment, and runs the README's example there, without anything of this
checkout. CTest runs it.

usage: test_wheel.py WHEEL_LIBRARY WHOLE_LIBRARY"""
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import venv

HERE = pathlib.Path(__file__).resolve().parent
for needed, package in (("numpy", "numpy"), ("matplotlib", "matplotlib"), ("ensurepip", "venv")):
    if not importlib.util.find_spec(needed):
        print(f"skipped: python3-{package} is missing; scripts/setup installs it")
        sys.exit(77)
CORE, WHOLE = (os.path.abspath(sys.argv.pop(1)) for _ in range(2))
STATE = """
import hashlib, sys, shapebench as sb
mesh = sb.Mesh.shape("penguin")
for engine in ("fastlsm", "octree"):
    with sb.Body(sb.Voxels(mesh, particles=300), mesh, engine=engine, gravity=(0, -9.81, 0)) as body:
        body.hold([0])
        body.step(20)
        print(engine, hashlib.sha256(body.surface().tobytes()).hexdigest())
"""


class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        made = subprocess.run([HERE.parent.parent / "scripts" / "wheel.py", CORE, folder.name], capture_output=True,
                              text=True, check=True)
        cls.wheel = pathlib.Path(made.stdout.splitlines()[0])
        venv.create(cls.folder / "env", system_site_packages=True, with_pip=True)
        cls.python(cls, "-m", "pip", "install", "--no-index", "--quiet", "--disable-pip-version-check", cls.wheel)

    def python(self, *words):
        clean = {name: value for name, value in os.environ.items()
                 if name not in ("PYTHONPATH", "SHAPEBENCH_LIBRARY", "LD_LIBRARY_PATH")}
        ran = subprocess.run([self.folder / "env" / "bin" / "python", *words], cwd=self.folder, capture_output=True,
                             text=True, check=False, env={**clean, "MPLBACKEND": "agg"})
        if ran.returncode:
            raise AssertionError(ran.stderr)
        return ran.stdout

    def test_the_readmes_examples_run(self):
        bend, compare, cut = re.findall(r"```python\n(import.*?)```", (HERE / "README.md").read_text(encoding="utf-8"),
                                        re.DOTALL)
        self.python("-c", bend + "assert min(heights) < heights[-1] < 0.1")
        sags = [float(line.split()[-2]) for line in self.python("-c", compare).splitlines()]
        self.assertEqual(len(sags), 4)
        self.assertTrue(sags[0] > sags[1] > sags[2] > 0, sags)
        self.assertIn("30 steps, 0.3 s> 2 pieces", self.python("-c", cut))
        for picture in ("sag.png", "cut.png"):
            self.assertGreater((self.folder / picture).stat().st_size, 5000)

    def test_its_library_is_within_and_has_the_same_bits(self):
        whole = subprocess.run([sys.executable, "-c", STATE], capture_output=True, text=True, check=True,
                               env={**os.environ, "SHAPEBENCH_LIBRARY": WHOLE, "PYTHONPATH": str(HERE)}).stdout
        self.assertEqual(self.python("-c", STATE), whole)
        maps = self.python("-c", "import shapebench; shapebench.engines(); print(open('/proc/self/maps').read())")
        for name in ("libshapebench.so", "libgomp.so.1"):
            places = set(re.findall(rf"\S*/{name}\S*", maps))
            self.assertEqual(len(places), 1, places)
            self.assertIn(str(self.folder), places.pop())

    def test_what_it_has_not_is_said(self):
        said = self.python("-c", """if True:
            import shapebench as sb
            print(sb.engines())
            open("my.obj", "w").write("v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nv 0 0 1\\nf 1 3 2\\nf 1 2 4\\nf 2 3 4\\nf 1 4 3\\n")
            open("my.dae", "w").write("<COLLADA/>")
            print(sb.Mesh.load("my.obj").facts().triangles)
            for refused in (lambda: sb.Mesh.load("my.dae"),
                            lambda: sb.Body(sb.Voxels.from_cells([[[1]]], 1), engine="brute", precision="double")):
                try:
                    refused()
                except sb.InputError as error:
                    print(error)""").splitlines()
        self.assertEqual(said[0], "['fastlsm', 'octree']")
        self.assertEqual(said[1], "4")
        self.assertIn("my.dae: formats other than OBJ, PLY, STL, OFF and glTF are read with Assimp", said[2])
        self.assertIn("the engine brute is not in this library", said[3])

    def test_the_same_files_make_the_same_wheel(self):
        before = self.wheel.read_bytes()
        subprocess.run([HERE.parent.parent / "scripts" / "wheel.py", CORE, self.folder], capture_output=True, check=True)
        self.assertEqual(self.wheel.read_bytes(), before)


if __name__ == "__main__":
    unittest.main()
