#!/usr/bin/python3
"""Tests of the Python module against the program's own trajectories, the C compiler, and what the header says. CTest
runs them.

usage: test_shapebench.py SHAPEBENCH LIBRARY [unittest's arguments]"""
import contextlib
import ctypes
import dataclasses
import gc
import importlib.util
import inspect
import io
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import types
import unittest
import unittest.mock

HERE = pathlib.Path(__file__).resolve().parent
if not all(importlib.util.find_spec(name) for name in ("numpy", "h5py")):
    print("skipped: numpy or h5py is missing; scripts/setup installs them")
    sys.exit(77)
PROGRAM, LIBRARY = (os.path.abspath(sys.argv.pop(1)) for _ in range(2))
os.environ["SHAPEBENCH_LIBRARY"] = LIBRARY
sys.path.insert(0, str(HERE))

import numpy as np  # noqa: E402

import shapebench as sb  # noqa: E402
from shapebench import body as bodies, face  # noqa: E402

SCENE = """mesh = "shape:beam"; fill = "solid"; particles = 300; w = 2; h = 0.004; damping = 0.1;
gravity = [0.0, -9.81, 0.0]; handles = ( { box_low = [0.0, 0.0, 0.0]; box_high = [0.2, 1.0, 1.0]; } );
steps_per_frame = 5; frames = 6;"""
OCTREE = """
engine = "octree"; epsilon = 0.5; octree = { levels = 1; };"""
SHELL = """
engine = "shell"; meshless = { metre = 1.0; young = 2e5; thickness = 0.01; nodes = 80; %s };"""
BREAKS = {"covers": 4.5, "strength": 2e3, "branching": 2, "pressure": 1e4, "pulse": 0.005}


def beam(**how):
    """The beam of SCENE, not held."""
    mesh = sb.Mesh.shape("beam")
    voxels = sb.Voxels(mesh, particles=300)
    return sb.Body(voxels, mesh, **{"w": 2, "h": 0.004, "damping": 0.1, "gravity": (0, -9.81, 0), **how})


def block(*cells, **how):
    """A block of cells of edge 0.1, one particle a corner."""
    return sb.Body(sb.Voxels.from_cells(np.ones(cells), 0.1), **how)


def members(kind, *without):
    return [name for name, _ in face.header.struct[kind]._fields_ if name not in without]


def fields(kind):
    return [field.name.rstrip("_") for field in dataclasses.fields(kind)]


class Declarations(unittest.TestCase):
    """What the module reads from the header is what a C compiler does."""

    def test_structs_and_constants_are_the_compilers(self):
        compiler = shutil.which(os.environ.get("CC", "cc"))
        if not compiler:
            self.skipTest("no C compiler")
        wanted, lines = {}, []
        for kind, struct in face.header.struct.items():
            wanted[f"sizeof({kind})"] = ctypes.sizeof(struct)
            for name, of in struct._fields_:
                wanted[f"offsetof({kind}, {name})"] = getattr(struct, name).offset
                wanted[f"sizeof((({kind} *)0)->{name})"] = ctypes.sizeof(of)
        wanted.update(face.header.constant)
        lines = [f'    printf("%lld\\n", (long long)({text}));' for text in wanted]
        program = "#include <stddef.h>\n#include <stdio.h>\n#include <shapebench.h>\nint main(void)\n{\n" + "\n".join(lines) + "\n}\n"
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "sizes")
            path.with_suffix(".c").write_text(program, encoding="ascii")
            subprocess.run([compiler, "-I", HERE / "shapebench", "-o", path, path.with_suffix(".c")], check=True)
            said = subprocess.run([path], capture_output=True, text=True, check=True).stdout.split()
        self.assertEqual(dict(zip(wanted, map(int, said))), wanted)
        self.assertGreater(len(wanted), 150)

    def test_every_function_of_the_header_is_read_and_used(self):
        text = (HERE / "shapebench" / "shapebench.h").read_text(encoding="utf-8")
        names = set(re.findall(r"^[a-z].*?\b(sb_\w+)\(", text, re.MULTILINE))
        self.assertEqual(set(face.header.function), names)
        source = "".join(path.read_text(encoding="utf-8") for path in (HERE / "shapebench").glob("*.py"))
        unused = {name for name in names if name not in source and name.removesuffix("_init") not in source}
        self.assertEqual(unused, set())

    def test_python_names_are_the_members_of_the_structs(self):
        self.assertEqual(fields(sb.Counts), members("sb_body_counts"))
        self.assertEqual(fields(sb.MeshFacts), members("sb_mesh_facts"))
        self.assertEqual(fields(sb.VoxelFacts), members("sb_voxel_facts"))
        self.assertEqual(fields(sb.OctreeParams), members("sb_octree_params", "criteria_count", "width_count"))
        self.assertEqual(fields(sb.MeshlessParams), members("sb_meshless_params"))
        self.assertEqual(fields(sb.ShellParams), members("sb_shell_params"))
        self.assertEqual(fields(sb.Criterion), members("sb_criterion"))
        self.assertEqual(fields(sb.LocalWidth), members("sb_local_width"))
        keywords = list(inspect.signature(sb.Body.__init__).parameters)[3:]
        self.assertEqual(keywords.pop(), "dt")
        self.assertEqual(keywords, members("sb_body_params"))
        self.assertEqual(sorted(face.header.choices["SB_GOALS_GATHER"]), ["adjoint", "gather"])
        for name in bodies.CHOICES:
            self.assertIn(name, members("sb_body_params") + members("sb_octree_params") + members("sb_criterion"))

    def test_the_version_is_the_librarys(self):
        self.assertEqual(face.text("sb_version_text"), sb.__version__)

    def test_types_are_whole(self):
        mypy = shutil.which("mypy")
        if not mypy:
            self.skipTest("no mypy")
        ran = subprocess.run([mypy, "--cache-dir", os.devnull], cwd=HERE, capture_output=True, text=True, check=False)
        self.assertEqual(ran.returncode, 0, ran.stdout)


class Program(unittest.TestCase):
    """A scene through the module has the bits of the program's trajectory."""

    def played(self, scene, *options):
        """The trajectory of the program."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        place = pathlib.Path(folder.name)
        (place / "beam.cfg").write_text(scene, encoding="ascii")
        subprocess.run([PROGRAM, "run", "beam.cfg", *options, "--quiet", "-o", "beam.vtkhdf"], cwd=place, check=True,
                       capture_output=True)
        motion = sb.results.Trajectory(place / "beam.vtkhdf")
        self.addCleanup(motion.close)
        return motion

    def same(self, motion, body, group=None):
        low, high = body.rest().min(axis=0), body.rest().max(axis=0)
        held = body.select_box(low, [low[0] + 0.2 * (high - low)[0], *high[1:]])
        if group:
            record = motion.file[group]
            np.testing.assert_array_equal(body.rest(), record["rest"][:])
            np.testing.assert_array_equal(body.masses(), record["mass"][:])
            np.testing.assert_array_equal(held, np.flatnonzero(record["held"][:]))
        self.assertGreater(len(held), 4)
        body.hold(held)
        for frame in range(len(motion)):
            stored = motion.points(frame)
            self.assertEqual(stored.tobytes(), body.surface().astype(stored.dtype).tobytes(), frame)
            np.testing.assert_array_equal(motion.triangles(frame), body.surface_triangles())
            self.assertAlmostEqual(motion.times[frame], body.counts().time, 12)
            body.step(5)

    def test_every_engine_and_precision(self):
        octree = {"engine": "octree", "octree": sb.OctreeParams(levels=1, epsilon=0.5)}
        for scene, how, group in ((SCENE, {}, "particles"), (SCENE + OCTREE, octree, "nodes")):
            for precision in ("single", "double"):
                with self.subTest(engine=how.get("engine"), precision=precision):
                    motion = self.played(scene, "--record", group, "--precision", precision)
                    with beam(precision=precision, **how) as body:
                        self.same(motion, body, group)

    def test_shells_whole_and_broken(self):
        if "shell" not in sb.engines():
            self.skipTest("the library was built without CHOLMOD and ARPACK")
        for breaks in ({}, BREAKS):
            with self.subTest(breaks=bool(breaks)):
                settings = " ".join(f"{name} = {float(value)};" for name, value in breaks.items())
                motion = self.played(SCENE + SHELL % settings)
                how = sb.ShellParams(young=2e5, thickness=0.01, nodes=80, **breaks)
                with beam(engine="shell", precision="double", shell=how) as body:
                    self.same(motion, body)
                self.assertEqual(len(motion.points(0)) < len(motion.points(len(motion) - 1)), bool(breaks))

    def test_particles_step_by_step(self):
        motion = self.played(SCENE, "--record", "particles", "--precision", "double", "--threads", "2")
        record = motion.file["particles"]
        with beam(precision="double", threads=1) as body:
            body.hold(np.flatnonzero(record["held"][:]))
            for step, x, v, g in zip(record["step"][:], record["x"], record["v"], record["g"]):
                body.step(int(step) - body.counts().steps)
                self.assertEqual(body.positions().tobytes(), x.tobytes(), step)
                self.assertEqual(body.velocities().tobytes(), (v + 0.0).tobytes(), step)  # it starts from -0
                if not np.isnan(g).any():
                    self.assertEqual(body.goals().tobytes(), g.tobytes(), step)


class Refusals(unittest.TestCase):
    """Errors are exceptions with the library's sentences."""

    def refused(self, kind, text, what, *arguments, **how):
        with self.assertRaises(kind) as caught:
            what(*arguments, **how)
        self.assertIn(text, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))

    def test_sentences_are_the_librarys(self):
        mesh = sb.Mesh.shape("beam")
        voxels = sb.Voxels(mesh, particles=300)
        self.refused(sb.UsageError, "'particles' is 0 and 'cell' is 0: give one of them, above 0", sb.Voxels, mesh)
        self.refused(sb.InputError, "region half-width w = 99: must be 1 to 32", sb.Body, voxels, w=99)
        self.refused(sb.UsageError, "'engine' is 9: there is no such engine", sb.Body, voxels, engine=9)
        self.refused(sb.UsageError, "'levels' is 30: it is from 0 to 12", sb.Body, voxels, engine="octree",
                     octree=sb.OctreeParams(levels=30))
        self.refused(sb.UsageError, "'pose' is no rigid motion", sb.Body, voxels, pose=np.zeros(12))
        self.refused(sb.InputError, "no such file", sb.Mesh.load, "/nowhere.obj")
        self.refused(ValueError, "there are penguin", sb.Mesh.shape, "nothing")
        with beam() as body:
            self.refused(sb.UsageError, "'steps' is -1: it is 0 or more", body.step, -1)
            self.refused(sb.UsageError, "there is no particle 999999", body.hold, [999999])
            self.refused(sb.UsageError, "", body.add_sphere, (0, 0, 0), float("nan"))

    def test_choices_are_named(self):
        voxels = sb.Voxels(sb.Mesh.shape("beam"), particles=300)
        self.refused(ValueError, "'engine' is 'fem': it is one of fastlsm, octree, brute, meshless, shell", sb.Body, voxels,
                     engine="fem")
        self.refused(ValueError, "'layout' is 'rows': it is one of auto, lists, blocks", sb.Body, voxels, layout="rows")

    def test_numbers_are_not_cut_off(self):
        with beam() as body:
            self.refused(ValueError, "does not fit 64 bits", body.step, 1 << 64)
            self.refused(TypeError, "whole number", body.step, 1.5)
            self.refused(TypeError, "whole numbers", body.hold, [0.5])
            self.refused(TypeError, "of bool: whole numbers", body.hold, body.rest()[:, 0] < 0)
            self.refused(ValueError, "do not fit int64", body.hold, np.array([1 << 63], np.uint64))
        self.refused(ValueError, "do not fit int32", sb.Mesh, np.eye(3), [[0, 1, 1 << 32]])
        self.refused(ValueError, "does not fit 32 bits", beam, w=(1 << 32) + 2)
        self.refused(TypeError, "numbers are wanted", sb.Mesh, np.eye(3, dtype=complex), [[0, 1, 2]])
        self.refused(ValueError, "n x 3", sb.Mesh, np.ones(4), [[0, 1, 2]])
        self.refused(ValueError, "'gravity' has the shape (2,): 3", beam, gravity=(0, 1))
        x, quads = np.random.default_rng(0).random((8, 3)), np.arange(24, dtype=np.int32).reshape(6, 4) % 8
        self.refused(ValueError, "'triangles' has the shape (6, 4): n x 3", sb.Mesh, x, quads)
        self.refused(ValueError, "'vertices' has the shape (3, 8): n x 3", sb.Mesh, x.T, quads[:, :3])
        self.refused(ValueError, "'vertices' has masked", sb.Mesh, np.ma.masked_greater(x, 0.5), quads[:, :3])
        self.refused(ValueError, "'mass' has the shape (2,)", beam, mass=[1, 1])

    def test_what_a_file_holds_beside_its_mesh_is_said(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "lines.obj"
            path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2\nl 2 3\n", encoding="ascii")
            with self.assertWarnsRegex(UserWarning, "lines.obj: 2 points, lines, curves or scenes are left out"):
                mesh = sb.Mesh.load(path)
        self.assertEqual((mesh.facts().left_out, mesh.facts().triangles), (2, 1))

    def test_a_file_name_is_whole(self):
        self.refused(ValueError, "0 character", sb.Mesh.load, "a\0b")

    def test_a_library_that_is_not_there_is_named(self):
        for library, text in (("/nowhere.so", "/nowhere.so"), ("libm.so.6", "it has no sb_")):
            said = subprocess.run([sys.executable, "-c", "import shapebench; shapebench.engines()"], capture_output=True,
                                  text=True, check=False, env={**os.environ, "SHAPEBENCH_LIBRARY": library,
                                                               "PYTHONPATH": str(HERE)}).stderr
            self.assertIn("ImportError", said.splitlines()[-1])
            self.assertIn(text, said.splitlines()[-1])

    def test_without_a_name_the_loader_has_the_library(self):
        clean = {name: value for name, value in os.environ.items() if name != "SHAPEBENCH_LIBRARY"}
        soname = pathlib.Path(LIBRARY).with_name(f"libshapebench.so.{sb.__version__.partition('.')[0]}")
        self.assertTrue(soname.is_file())
        said = subprocess.run([sys.executable, "-c", "import shapebench; print(shapebench.engines()[0])"], text=True,
                              capture_output=True, check=False, env={**clean, "LD_LIBRARY_PATH": str(soname.parent),
                                                                     "PYTHONPATH": str(HERE)})
        self.assertEqual(said.stdout, "fastlsm\n", said.stderr)

    def test_a_needed_package_is_named(self):
        made = "libnothing.so.5: cannot open shared object file: No such file or directory"
        with unittest.mock.patch.object(ctypes, "CDLL", side_effect=OSError(made)):
            self.refused(ImportError, "Debian's libnothing5", face.load, "libshapebench.so")


class Arrays(unittest.TestCase):
    """Arrays go in and out without copies where they are laid out as the library's."""

    def test_what_fits_is_taken_as_it_is(self):
        for given in (np.zeros((4, 3)), np.zeros((4, 3))[1:]):
            self.assertEqual(face.array(given, np.float64, "x", None, 3).ctypes.data, given.ctypes.data)
        other = np.asfortranarray(np.arange(12.0).reshape(4, 3))
        np.testing.assert_array_equal(face.array(other, np.float64, "x", None, 3), other)

    def test_out_is_filled(self):
        with beam() as body:
            x = np.empty((body.particle_count, 3))
            for read in (body.rest, body.positions, body.velocities, body.goals):
                x.fill(np.nan)
                self.assertIs(read(out=x), x)
                np.testing.assert_array_equal(x, read())
            surface, normals = body.surface(), np.empty_like(body.surface())
            self.assertIs(body.surface(out=surface, normals=normals), surface)
            np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-12)

    def test_out_of_another_kind_is_refused(self):
        with beam() as body:
            n = body.particle_count
            frozen = np.empty((n, 3))
            frozen.flags.writeable = False
            for out in (np.empty((n, 3), np.float32), np.empty((n + 1, 3)), np.empty((3, n)).T, np.empty((n, 6))[:, ::2],
                        frozen, [[0.0] * 3] * n):
                with self.assertRaises(sb.UsageError):
                    body.positions(out=out)

    def test_meshes_and_voxels_come_back(self):
        mesh = sb.Mesh.shape("penguin")
        again = sb.Mesh(mesh.vertices, mesh.triangles)
        np.testing.assert_array_equal(again.vertices, mesh.vertices)
        np.testing.assert_array_equal(again.triangles, mesh.triangles)
        self.assertEqual(mesh.facts().watertight, 1)
        voxels = sb.Voxels(mesh, particles=500)
        facts = voxels.facts()
        same = sb.Voxels.from_cells(voxels.cells(), facts.cell, facts.origin)
        np.testing.assert_array_equal(same.particles(), voxels.particles())
        self.assertEqual(int(voxels.cells().sum()), facts.material)
        self.assertAlmostEqual(voxels.masses(1000).sum(), 1000 * facts.cell**3 * facts.material)
        shell = sb.Voxels(mesh, cell=facts.cell, fill="shell")
        self.assertLess(shell.facts().material, facts.material)
        cells = np.zeros((4, 3, 2))
        cells[3, 1, 0] = 1  # z, y, x
        low = sb.Voxels.from_cells(cells, 0.5, (1, 2, 3)).particles()[0]
        np.testing.assert_array_equal(low, (1, 2.5, 4.5))

    def test_a_file_is_read(self):
        with tempfile.TemporaryDirectory() as folder:
            mesh = sb.Mesh.shape("block")
            path = pathlib.Path(folder, "block é.obj")
            sb.export.write_obj(path, mesh.vertices, mesh.triangles)
            facts, wanted = (dataclasses.astuple(of.facts()) for of in (sb.Mesh.load(path), mesh))
            self.assertEqual(facts[:-3], wanted[:-3])
            np.testing.assert_allclose(np.hstack(facts[-3:]), np.hstack(wanted[-3:]), rtol=1e-6)  # read as float


class Bodies(unittest.TestCase):
    """What bodies do."""

    def test_free_fall(self):
        with block(4, 3, 2, gravity=(0, -10, 0), precision="double") as body:
            x = body.positions()
            body.step(10)
            np.testing.assert_allclose(body.positions() - x, [[0, -0.055, 0]] * 60, atol=1e-12)
            self.assertEqual(body.counts().steps, 10)

    def test_state_can_be_written_and_played_again(self):
        with beam(precision="double") as body:
            body.set_velocities(np.random.default_rng(1).normal(size=(body.particle_count, 3)) * 0.01)
            x, v = body.positions(), body.velocities()
            body.step(7)
            after = body.positions()
            body.set_positions(x)
            body.set_velocities(v)
            body.step(7)
            np.testing.assert_allclose(body.positions(), after, rtol=0, atol=1e-14)

    def test_pushes_masses_and_instances(self):
        start = np.stack((sb.pose(), sb.pose((1, 0, 0), axis=(0, 0, 2), angle=np.pi / 2)))
        mass = np.linspace(1, 2, 60)
        with block(4, 3, 2, instances=2, pose=start, mass=mass, precision="double") as body:
            np.testing.assert_allclose(body.masses(), mass, rtol=1e-15)
            x = body.rest()
            np.testing.assert_allclose(x[60:], x[:60] @ [[0, 1, 0], [-1, 0, 0], [0, 0, 1]] + [1, 0, 0], atol=1e-15)
            body.push([3, 63], [[1, 2, 3], [4, 5, 6]])
            v = np.zeros((120, 3))
            v[[3, 63]] = np.array([[1, 2, 3], [4, 5, 6]]) / mass[3]
            np.testing.assert_allclose(body.velocities(), v, rtol=1e-12)

    def test_handles_lead_and_let_go(self):
        with block(4, 3, 2) as body:
            end = body.select_box((-1, -1, -1), (1, 1, 0.05))
            np.testing.assert_array_equal(end, np.flatnonzero(body.rest()[:, 2] < 0.05))
            self.assertEqual(len(body.select_ball((0, 0, 0), 0.11)), 4)
            handle = body.hold(end)
            motion = sb.pose((0, 0.1, 0), axis=(1, 0, 0), angle=0.3, centre=(0, 0.2, 0))
            handle.move(motion)
            body.step()
            np.testing.assert_allclose(body.positions()[end], body.rest()[end] @ motion[:, :3].T + motion[:, 3], atol=1e-6)
            handle.release()
            body.hold(end)

    def test_obstacles_stop(self):
        with block(2, 2, 2, gravity=(0, -10, 0), h=0.005) as body:
            floor = body.add_plane((0, -0.1, 0), (0, 1, 0), friction=0.5)
            for other in (body.add_sphere((9, 9, 9), 1), body.add_box((8, 8, 8), (9, 9, 9)),
                          body.add_capsule((9, 9, 9), (9, 9, 8), 1)):
                other.remove()
            body.step(200)
            self.assertGreater(body.positions()[:, 1].min(), -0.1001)
            floor.remove()
            body.step(100)
            self.assertLess(body.positions()[:, 1].max(), -0.1)

    def test_regions(self):
        with block(5, 5, 5, w=1) as body:
            x = body.rest()
            for particle in (0, 43, 107):
                near = np.flatnonzero(np.abs(x - x[particle]).max(axis=1) < 0.11)
                np.testing.assert_array_equal(body.region(particle), near)

    def test_contacts(self):
        start = np.stack((sb.pose(), sb.pose((0.05, 0, 0))))
        with block(2, 2, 2, instances=2, pose=start, collide_instances=True) as body:
            found = body.contacts()
            self.assertGreater(len(found), 0)
            self.assertEqual(found["out"].shape, (len(found), 3))
            np.testing.assert_allclose(np.linalg.norm(found["out"], axis=1), 1, atol=1e-6)
            self.assertTrue(((0 <= found["particle"]) & (found["particle"] < 54)).all())

    def test_cuts_take_pieces_apart(self):
        square = ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
        mesh = sb.Mesh.shape("block")
        low, high = np.array(mesh.facts().low), np.array(mesh.facts().high)
        plane = low - 0.5 * (high - low) + 2 * (high - low) * np.array(square[0])
        plane[:, 2] = 0.51 * low[2] + 0.49 * high[2]
        for engine in ("fastlsm", "octree", "meshless"):
            if engine not in sb.engines():
                continue
            precision = "double" if engine == "meshless" else "single"
            with sb.Body(sb.Voxels(mesh, particles=400), mesh, engine=engine, precision=precision,
                         cuttable=True) as body:
                self.assertEqual(body.pieces().max(), 0)
                before = body.counts()
                body.cut(plane, square[1])
                self.assertEqual(set(body.pieces()), {0, 1}, engine)
                self.assertGreater(body.counts().surface_triangles, before.surface_triangles)
                self.assertEqual(len(body.surface()), len(body.surface_rest()))
                self.assertLess(body.surface_triangles().max(), len(body.surface()))
                self.assertEqual(len(body.positions()), body.counts().particles)

    def test_the_surface_parts_where_links_break(self):
        mesh = sb.Mesh.shape("beam")
        with sb.Body(sb.Voxels(mesh, particles=300), mesh, strain_limit=1.2) as body:
            before = len(body.surface())
            pull = np.sign(body.rest()[:, :1] - body.rest()[:, 0].mean()) * (1, 0, 0)
            body.set_velocities(20 * pull)
            body.step(3)
            self.assertGreater(body.counts().broken, 0)
            self.assertGreater(len(body.surface()), before)
            self.assertEqual(len(body.surface_triangles()), body.counts().surface_triangles)

    def test_a_blade_cuts_what_it_sweeps_over(self):
        with block(6, 6, 6, cuttable=True) as body:
            blade = body.add_blade()
            self.assertEqual(blade.sweep((0.32, -0.1, -0.1), (0.32, -0.1, 0.7)), 0)
            self.assertGreater(blade.sweep((0.32, 0.7, -0.1), (0.32, 0.7, 0.7)), 0)
            blade.lift()
            self.assertEqual(set(body.pieces()), {0, 1})

    def test_details_refine_an_octree_while_they_last(self):
        criteria = [sb.Criterion("box", 1, low=(0, 0, 0), high=(0.2, 0.2, 0.2))]
        how = sb.OctreeParams(levels=2, criteria=criteria, widths=[sb.LocalWidth(edges=1.5, low=(0, 0, 0), high=(1, 1, 1))],
                              yield_=0.1, creep=5, most=0.5)
        with block(8, 8, 8, engine="octree", octree=how) as body:
            coarse = body.particle_count
            self.assertEqual(set(body.levels()), {0, 1})
            self.assertEqual(body.shapes().shape, (coarse, 3, 3))
            body.set_shapes(body.shapes())
            detail = body.add_detail()
            self.assertGreater(detail.ball((0.8, 0.8, 0.8), 0.1, 2), 0)
            self.assertGreater(len(body.positions()), coarse)
            detail.ball((0.8, 0.8, 0.8), 0, 2)
            self.assertEqual(len(body.positions()), coarse)
            self.assertGreater(body.add_detail().eye((2, 0.4, 0.4), 2, 2), 0)

    def test_the_references_step_too(self):
        for engine in sb.engines()[2:]:
            extra = {"meshless": sb.MeshlessParams(points=800, nodes=60, modes=12), "shell": sb.ShellParams(nodes=60)}
            with beam(engine=engine, precision="double", **extra) as body:
                body.step(3)
                self.assertTrue(np.isfinite(body.surface()).all())


class Threads(unittest.TestCase):
    """Bodies in threads, and their ends."""

    def test_the_interpreter_runs_while_a_body_steps(self):
        """Were the lock kept, this thread could look at most once between the steps' start and their end."""
        with beam(threads=1) as body:
            started, ended, looks = threading.Event(), threading.Event(), 0

            def play():
                started.set()
                body.step(20000)
                ended.set()

            thread = threading.Thread(target=play)
            thread.start()
            started.wait()
            while not ended.is_set():
                looks += 1
            thread.join()
            self.assertGreater(looks, 1000)

    def test_one_thread_at_a_time(self):
        """Two threads step one body: as many steps as both have made, and the same bits as of one."""
        with beam() as body, beam() as alone:
            threads = [threading.Thread(target=lambda: [body.step(3) for _ in range(50)]) for _ in range(2)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            alone.step(300)
            self.assertEqual(body.counts().steps, 300)
            self.assertEqual(body.positions().tobytes(), alone.positions().tobytes())

    def test_closing_waits_and_what_is_closed_is_refused(self):
        body = beam()
        handle = body.hold([0])
        started = threading.Event()
        done = []

        def play():
            with body._lock:
                started.set()
                body.step(2000)
                done.append(body.counts().steps)

        thread = threading.Thread(target=play)
        thread.start()
        started.wait()
        body.close()
        thread.join()
        self.assertEqual(done, [2000])
        body.close()
        for use in (body.step, body.counts, body.positions, body.surface, handle.release):
            with self.assertRaisesRegex(sb.UsageError, "the body is closed"):
                use()

    def test_a_body_outlives_what_it_is_made_of_and_is_freed(self):
        for _ in range(3):
            body = beam()
            gc.collect()
            body.step(3)
            end = body._end
            del body
            self.assertFalse(end.alive)

    def test_a_mesh_is_read_by_several(self):
        mesh = sb.Mesh.shape("penguin")
        found = []
        threads = [threading.Thread(target=lambda: found.append(mesh.vertices.tobytes())) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(found, [mesh.vertices.tobytes()] * 4)


class Simulate(unittest.TestCase):
    """A simulation in one call, other libraries' meshes, and pictures."""

    HOW = {"w": 2, "gravity": (0, -9.81, 0)}

    def test_it_is_what_steps_make(self):
        mesh = sb.Mesh.shape("beam")
        motion = sb.simulate(mesh, particles=300, steps=25, every=10, pins=range(9), dt=0.004, **self.HOW)
        self.assertEqual(motion.times.tolist(), [0, 0.04, 0.08, 0.1])
        with sb.Body(sb.Voxels(mesh, particles=300), mesh, h=0.004, **self.HOW) as body:
            body.hold(range(9))
            for frame, steps in enumerate((0, 10, 10, 5)):
                body.step(steps)
                self.assertEqual(motion.surface[frame].tobytes(), body.surface().tobytes())
                self.assertEqual(motion.particles[frame].tobytes(), body.positions().tobytes())
            self.assertIs(motion.triangles[0], motion.triangles[-1])
            self.assertEqual(motion.triangles[0].tobytes(), body.surface_triangles().tobytes())
            self.assertEqual(repr(body), f"<Body: {body.particle_count} particles, 25 steps, 0.1 s>")
        self.assertEqual(repr(body), "<Body: closed>")
        self.assertEqual(repr(motion), f"<Motion: 4 frames, 0.1 s, {motion.counts.particles} particles>")
        self.assertEqual(repr(mesh), "<Mesh: 546 vertices, 1088 triangles, watertight>")

    def test_pins_of_all_kinds_are_the_same(self):
        mesh = sb.Mesh.shape("beam")

        def end(pins):
            return sb.simulate(mesh, particles=300, steps=5, pins=pins, **self.HOW).surface[-1].tobytes()

        rest = sb.Voxels(mesh, particles=300).particles()
        mask = rest[:, 0] < rest[:, 0].min() + 0.05
        ends = {end(mask), end(np.flatnonzero(mask)), end(lambda x: x[:, 0] < rest[:, 0].min() + 0.05)}
        self.assertEqual(len(ends), 1)
        self.assertNotEqual(end(None), end(mask))
        for wrong in ([], mask[1:], lambda x: x[:, 0] > 9):
            with self.assertRaisesRegex(sb.UsageError, "'pins'"):
                end(wrong)
        for wrong in ({"every": 0}, {"steps": -1}):
            with self.assertRaisesRegex(sb.UsageError, "'every'"):
                sb.simulate(mesh, **wrong)

    def test_meshes_of_other_libraries(self):
        mesh = sb.Mesh.shape("penguin")
        x, t = mesh.vertices, mesh.triangles
        kinds = (types.SimpleNamespace(vertices=x, faces=t),
                 types.SimpleNamespace(vertices=x.tolist(), triangles=t.tolist()),
                 types.SimpleNamespace(points=x, cells_dict={"triangle": t, "line": t[:, :2]}))
        for other in kinds:
            self.assertEqual(sb.Mesh(other).triangles.tobytes(), t.tobytes())
        for cells in ({"triangle": t, "quad": t}, {"line": t}):
            with self.assertRaisesRegex(sb.UsageError, "it has cells of .*: triangles alone are wanted"):
                sb.Mesh(types.SimpleNamespace(points=x, cells_dict=cells))
        with self.assertRaisesRegex(sb.UsageError, "a int is no mesh"):
            sb.Mesh(3)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "penguin.off")
            rows = [" ".join(map(repr, row)) for row in x.tolist()] + [f"3 {a} {b} {c}" for a, b, c in t.tolist()]
            path.write_text(f"OFF\n{len(x)} {len(t)} 0\n" + "\n".join(rows), encoding="ascii")
            self.assertEqual(sb.load(path).vertices.tobytes(), x.tobytes())
            motions = [sb.simulate(given, particles=300, steps=1) for given in (path, kinds[0], mesh)]
        self.assertEqual(len({motion.surface[-1].tobytes() for motion in motions}), 1)

    def test_the_step_has_two_names_and_every_engine_a_precision(self):
        with self.assertRaisesRegex(sb.UsageError, "'h' and 'dt' are both"):
            block(2, 2, 2, h=0.01, dt=0.01)
        with block(2, 2, 2, engine="brute", dt=0.02) as body:
            body.step()
            self.assertEqual(body.counts().time, 0.02)

    def test_one_thing_is_not_taken_for_another(self):
        mesh = sb.Mesh.shape("block")
        voxels = sb.Voxels(mesh, particles=8)
        for make in (lambda: sb.Body(mesh), lambda: sb.Body(voxels, voxels), lambda: sb.Voxels(voxels, particles=8),
                     lambda: sb.Voxels("block", particles=8)):
            with self.assertRaisesRegex(sb.UsageError, "' is a .*: a (Mesh|Voxels) is wanted"):
                make()

    def test_progress_is_told(self):
        with unittest.mock.patch.dict(sys.modules, {"tqdm": None, "tqdm.auto": None}), \
                contextlib.redirect_stderr(io.StringIO()) as said:
            sb.simulate(sb.Mesh.shape("beam"), particles=100, steps=20, progress=True)
        self.assertEqual(said.getvalue(), "\rframe 1 of 2\rframe 2 of 2\n")

    def test_pictures(self):
        pyvista = unittest.mock.MagicMock()
        with beam() as body, unittest.mock.patch.dict(sys.modules, {"pyvista": pyvista}):
            self.assertIs(body.plot(), pyvista.Plotter())
            self.assertEqual(pyvista.make_tri_mesh.call_args.args[0].tobytes(), body.surface().tobytes())
        if not importlib.util.find_spec("matplotlib"):
            self.skipTest("no matplotlib")
        import matplotlib

        matplotlib.use("agg")
        motion = sb.simulate(sb.Mesh.shape("beam"), particles=300, steps=10)
        with unittest.mock.patch.dict(sys.modules, {"pyvista": None}):
            drawn = motion.plot().collections[0]
        self.assertEqual(len(drawn._vec[0]), 3 * len(motion.triangles[-1]))


if __name__ == "__main__":
    unittest.main()
