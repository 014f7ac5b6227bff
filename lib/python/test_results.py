#!/usr/bin/python3
"""Tests of what the Python module reads of the program's files, and of what it writes for others. CTest runs them.

usage: test_results.py SHAPEBENCH [unittest's arguments]"""
import importlib.util
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
if not all(importlib.util.find_spec(name) for name in ("numpy", "h5py")):
    print("skipped: numpy or h5py is missing; scripts/setup installs them")
    sys.exit(77)
PROGRAM = os.path.abspath(sys.argv.pop(1))
sys.path[1:1] = [str(HERE), str(HERE.parent.parent / "scripts")]

import h5py  # noqa: E402
import numpy as np  # noqa: E402
from small_inputs import MAP, QUICK, has_maps, write_inputs  # noqa: E402

from shapebench import InputError, UsageError, export, results  # noqa: E402

BASELINES = HERE.parent.parent / "results" / "published" / "baselines.h5"  # of scripts/baselines.py, which needs Bullet
COMMANDS = {
    "rows.h5": ["tables", "--scene", "a.cfg", *QUICK],
    "sweep.h5": ["sweep", "--scene", "a.cfg", "--w", "1:2", "--epsilon", "0", "--engine", "fastlsm", "--frames", "1", *QUICK],
    "claims.h5": ["claims", "--claims", "mine.cfg", "--claim", "mine", "--quick"],
    "beam.h5": ["calibrate", "--scene", "beam.cfg", "--w", "1:2", "--epsilon", "0", "--across", "1", "--aspect", "none",
                "--step", "none"],
    "map.h5": MAP,
    "still.vtkhdf": ["run", "a.cfg", "--frames", "3", "--fields", "speed,displacement"],
    "cut.vtkhdf": ["run", "beam-cut", "--frames", "25", "--steps", "20", "--particles", "300"],
}


class Results(unittest.TestCase):
    """Every kind of file that the program writes."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        write_inputs(folder.name)
        if not has_maps(PROGRAM):
            del COMMANDS["map.h5"]
        for name, words in COMMANDS.items():
            ran = subprocess.run([PROGRAM, *words, "-o", name], cwd=cls.folder, capture_output=True, text=True, check=False)
            if ran.returncode not in (0, 1):  # what is measured here may be noise
                raise AssertionError(ran.stderr)

    def at(self, name):
        return self.folder / name

    def test_rows_are_records(self):
        read = results.read(self.at("rows.h5"))
        rows = read["rows"]
        self.assertEqual((read.kind, read.schema, len(rows)), ("shapebench results", 4, 1))
        with h5py.File(self.at("rows.h5")) as file:
            self.assertEqual(set(rows.columns) - {"name", "stage", "total"}, set(file["rows/000"].attrs))
            np.testing.assert_array_equal(rows["total"][0], file["rows/000/total"])
            np.testing.assert_equal(rows["total_ms"][0], file["rows/000"].attrs["total_ms"])  # none of a busy row
            self.assertEqual(read.groups["machine"]["cpu"], file["machine"].attrs["cpu"].decode())
        row = next(iter(rows))
        self.assertEqual((row["engine"], row["particles"]), ("fastlsm", rows["particles"][0]))
        self.assertEqual(rows.records()["scene"][0], row["scene"])
        self.assertIn("[ms]", read.groups["columns"]["total_ms"])

    def test_columns_are_tables(self):
        for name, table in (("sweep.h5", "points"), ("beam.h5", "specimens"), ("beam.h5", "laws"),
                            ("claims.h5", "experiments"), (BASELINES, "methods")):
            read = results.read(self.at(name))
            with h5py.File(self.at(name)) as file:
                self.assertEqual(set(read[table].columns), set(file[table]))
                for column, values in file[table].items():
                    wanted = values.asstr()[()] if values.dtype.kind == "S" else values[()]
                    np.testing.assert_array_equal(read[table][column], wanted)
            self.assertGreater(len(read[table]), 0)
            self.assertEqual(len(list(read[table])), len(read[table]))
            self.assertEqual(len(read[table].records()), len(read[table]))
        self.assertEqual(results.read(self.at("sweep.h5")).groups["plan"]["w"].tolist(), [1, 2])

    def test_claims_have_curves(self):
        read = results.read(self.at("claims.h5"))
        self.assertEqual(read["claims"]["statement"].tolist(), ["s"])
        self.assertEqual(read["curves"]["name"].tolist(), ["polar.cold-sweeps"])
        self.assertEqual(len(read["rows"]), 0)

    def test_a_map_has_groups_of_arrays(self):
        if "map.h5" not in COMMANDS:
            self.skipTest("the program was built without libsuitesparse-dev")
        read = results.read(self.at("map.h5"))
        self.assertEqual(read.groups["nodes"]["points"].shape[1:], (3,))
        self.assertEqual(len(read.groups["nodes"]["points"]), len(read.groups["nodes"]["parameters"]))

    def test_rows_that_differ_are_objects(self):
        table = results.Table({"a": results._column([np.ones(2), np.ones(3), None]), "b": results._column([1, 2, 3])})
        self.assertEqual([table["a"].dtype.kind, table["b"].dtype.kind], ["O", "i"])
        self.assertIsNone(table.records()["a"][2])

    def test_pandas_where_it_is(self):
        table = results.read(self.at("sweep.h5"))["points"]
        if not importlib.util.find_spec("pandas"):
            with self.assertRaisesRegex(ImportError, "python3-pandas"):
                table.frame()
            return
        frame = table.frame()
        self.assertEqual(frame["w"].tolist(), table["w"].tolist())
        np.testing.assert_array_equal(np.stack(frame["stage_ms"]), table["stage_ms"])

    def test_damage_is_an_error_of_one_line(self):
        whole = self.at("rows.h5").read_bytes()
        self.at("damaged.h5").write_bytes(whole[:3000] + bytes([whole[3000] ^ 1]) + whole[3001:])
        self.at("cut.h5").write_bytes(whole[:-100])
        self.at("text.h5").write_bytes(b"no")
        with h5py.File(self.at("foreign.h5"), "w", libver="v110") as file:
            file["x"] = 1
        with h5py.File(self.at("old.h5"), "w") as file:
            file["x"] = 1
        for name, text in (("damaged.h5", "damaged"), ("cut.h5", "cut"), ("text.h5", "not an HDF5 file"),
                           ("foreign.h5", "no file of shapebench's"), ("old.h5", "convert it: h5repack"), ("nothing.h5", "no such file"),
                           ("still.vtkhdf", "Trajectory")):
            with self.assertRaisesRegex(InputError, text) as caught:
                results.read(self.at(name))
            self.assertIn(name, str(caught.exception))
        self.at("short.vtkhdf").write_bytes(self.at("still.vtkhdf").read_bytes()[:-64])
        self.at("bare.vtkhdf").write_bytes(self.at("still.vtkhdf").read_bytes())
        with h5py.File(self.at("bare.vtkhdf"), "r+") as file:
            del file["VTKHDF/Steps"]
        for name, text in (("rows.h5", "not a trajectory"), ("nothing", "no such file"),
                           ("short.vtkhdf", "cut off"), ("bare.vtkhdf", "missing or damaged")):
            with self.assertRaisesRegex(InputError, f"{name}: .*{text}"):
                results.Trajectory(self.at(name))

    def test_what_another_program_has_written_to_is_read_with_a_warning(self):
        self.at("changed.h5").write_bytes(self.at("rows.h5").read_bytes())
        with h5py.File(self.at("changed.h5"), "r+") as file:
            file.attrs["note"] = "mine"
        with self.assertWarnsRegex(UserWarning, "changed.h5: written to by another program"):
            changed = results.read(self.at("changed.h5"))
        self.assertEqual(changed.values["note"], "mine")

    @unittest.skipUnless(shutil.which("h5repack"), "hdf5-tools is missing")
    def test_the_old_format_is_converted_as_its_refusal_says(self):
        with h5py.File(self.at("old.h5"), "w") as file, h5py.File(self.at("rows.h5")) as rows:
            for name in rows:
                rows.copy(name, file)
            file.attrs.update(rows.attrs)
            file["plain"], file["empty"] = np.arange(9.0), np.zeros(0)
        with self.assertRaises(InputError) as caught:
            results.read(self.at("old.h5"))
        words = str(caught.exception).split("convert it: ")[1].replace("NEW.h5", str(self.at("new.h5")))
        subprocess.run(words.split(), check=True)
        with self.assertWarnsRegex(UserWarning, "checksums hold"):
            new = results.read(self.at("new.h5"))
        self.assertEqual(len(new["rows"]), 1)

    def test_what_is_lost_while_it_is_open_is_not_called_unwritable(self):
        self.at("lost.vtkhdf").write_bytes(self.at("still.vtkhdf").read_bytes())
        with results.Trajectory(self.at("lost.vtkhdf")) as motion:
            os.truncate(self.at("lost.vtkhdf"), 2048)
            with self.assertRaisesRegex(InputError, "lost.vtkhdf: cannot be read"):
                motion.points(3)
            with self.assertRaises(KeyError):
                motion.field("weight", 3)
            with self.assertRaises(IndexError):
                motion.points(4)

    def test_trajectories(self):
        with results.Trajectory(self.at("still.vtkhdf")) as motion, h5py.File(self.at("still.vtkhdf")) as file:
            self.assertEqual(len(motion), 4)
            self.assertEqual(motion.fields, ["displacement", "speed"])
            for frame in range(4):
                np.testing.assert_array_equal(motion.points(frame), file[f"frames/{frame}"])
                np.testing.assert_array_equal(motion.field("speed", frame), file[f"fields/speed/{frame}"])
                self.assertEqual(motion.topology(frame), 0)
            np.testing.assert_array_equal(motion.triangles(3).ravel(), file["topologies/0"])

    def test_topologies_follow_cuts(self):
        with results.Trajectory(self.at("cut.vtkhdf")) as motion, h5py.File(self.at("cut.vtkhdf")) as file:
            self.assertGreater(motion.topology(len(motion) - 1), 0)
            for frame in range(len(motion)):
                triangles = motion.triangles(frame)
                np.testing.assert_array_equal(triangles.ravel(), file[f"topologies/{motion.topology(frame)}"])
                self.assertEqual(len(motion.points(frame)), len(file[f"frames/{frame}"]))
                self.assertLess(triangles.max(), len(motion.points(frame)))
            with self.assertRaisesRegex(InputError, "the same points all along"):
                export.write_pc2(self.at("cut.pc2"), map(motion.points, range(len(motion))))

    def exported(self, *words):
        return subprocess.run([sys.executable, "-m", "shapebench.export", *words], cwd=self.folder, capture_output=True,
                              text=True, check=False, env={**os.environ, "PYTHONPATH": str(HERE)})

    def test_obj_sequences_keep_every_digit(self):
        self.assertEqual(self.exported("still.vtkhdf", "objs").returncode, 0)
        paths = sorted(self.at("objs").iterdir())
        self.assertEqual([path.name for path in paths], [f"still_{frame:04}.obj" for frame in range(4)])
        with results.Trajectory(self.at("still.vtkhdf")) as motion:
            for frame, path in enumerate(paths):
                lines = [line.split() for line in path.read_text(encoding="ascii").splitlines()]
                x = np.array([line[1:] for line in lines if line[0] == "v"], np.float32)
                faces = np.array([line[1:] for line in lines if line[0] == "f"], int) - 1
                self.assertEqual(x.tobytes(), motion.points(frame).tobytes())
                np.testing.assert_array_equal(faces, motion.triangles(frame))
        again = self.exported("still.vtkhdf", "objs")
        self.assertEqual(again.returncode, 4)
        self.assertIn("--overwrite", again.stderr)
        self.assertEqual(self.exported("still.vtkhdf", "objs", "--overwrite").returncode, 0)
        self.assertEqual(self.exported("rows.h5", "objs").returncode, 3)

    def test_point_caches(self):
        self.assertEqual(self.exported("still.vtkhdf", "still.pc2").returncode, 0)
        data = self.at("still.pc2").read_bytes()
        with results.Trajectory(self.at("still.vtkhdf")) as motion:
            points = len(motion.points(0))
            self.assertEqual(struct.unpack("<12siiffi", data[:32]), (b"POINTCACHE2\0", 1, points, 0, 1, 4))
            x = np.frombuffer(data, "<f4", offset=32).reshape(4, points, 3)
            np.testing.assert_array_equal(x, [motion.points(frame) for frame in range(4)])
        self.assertTrue(self.at("still.obj").is_file())
        with self.assertRaises(UsageError):
            export.write_pc2(self.at("empty.pc2"), [])
        self.assertFalse(self.at("empty.pc2").exists())

    def test_a_file_is_written_whole_or_stays(self):
        place = self.folder / "whole"
        place.mkdir()
        (place / "there.pc2").write_bytes(b"old")
        (place / "link.pc2").symlink_to("there.pc2")
        for name in ("there.pc2", "link.pc2", "new.pc2"):
            with self.assertRaises(InputError):
                export.write_pc2(place / name, [np.zeros((3, 3)), np.zeros((2, 3))], overwrite=True)
        with self.assertRaises(FileExistsError):
            export.write_pc2(place / "link.pc2", [np.zeros((3, 3))])
        with self.assertRaisesRegex(OSError, "no file"):
            export.write_pc2(place, [np.zeros((3, 3))], overwrite=True)
        self.assertEqual((place / "there.pc2").read_bytes(), b"old")
        self.assertEqual(export.write_pc2(place / "link.pc2", [np.zeros((3, 3))], overwrite=True), 1)
        self.assertEqual(len((place / "there.pc2").read_bytes()), 32 + 36)
        self.assertEqual({path.name for path in place.iterdir()}, {"there.pc2", "link.pc2"})
        refused = self.exported("still.vtkhdf", "nowhere/motion.pc2")
        self.assertEqual((refused.returncode, "cannot be written" in refused.stderr), (4, True), refused.stderr)


if __name__ == "__main__":
    unittest.main()
