#!/usr/bin/python3
"""What one would take instead, from the file that baselines.py stores to a table below the papers', in every format.

usage: test_tables.py PROGRAM      PROGRAM: the built shapebench"""
import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest

try:
    import h5py  # noqa: F401
    import numpy  # noqa: F401
except ImportError as reason:
    print(f"skipped: {reason}; scripts/setup run installs it")
    sys.exit(77)

import baselines

PROGRAM = ""
SCENE = 'mesh = "shape:block"; particles = 64; w = 1; engine = "brute"; bend = 0.3;\n'
ROWS = [("FastLSM, w 2", "w 2", 0.001, 9.98, 0.0284, 34.4, 28.4, 0.126),
        ("Bullet, finite elements", "E 1.2e+06 Pa", 0.001, 9.92, 3.76, 4558.0, 3760.0, 0.084),
        ("Bullet, clusters and springs", "64 iterations", 1 / 240, 75.1, 3.17, 3839.0, 761.0, float("nan"))]
PLAN = {"nodes": 825, "length": 0.8, "sag_percent": 10.0, "w": 2, "h": 0.001}


class Instead(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        with open(self.at("tiny.cfg"), "w", encoding="utf-8") as file:
            file.write(SCENE)
        os.environ["SHAPEBENCH_LIBRARY"] = os.path.join(os.path.dirname(PROGRAM), "libshapebench.so")
        self.machine = baselines.environment()
        self.store("instead.h5", self.machine)

    def at(self, name):
        return os.path.join(self.folder.name, name)

    def store(self, name, machine):
        rows = [dict(zip(baselines.COLUMNS, row)) for row in ROWS]
        baselines.store(rows, PLAN, machine, self.at(name), True)

    def tables(self, *arguments):
        return subprocess.run([PROGRAM, "tables", "--scene", "tiny.cfg", "--repeats", "1", "--block", "0.01", "--quiet",
                               *arguments], cwd=self.folder.name, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def with_baselines(self, form):
        done = self.tables("--baselines=instead.h5", "--format", form)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def test_text_has_a_table_and_what_can_be_compared(self):
        text = self.with_baselines("text")
        heading = f"What one would take instead, for a clamped beam of 825 nodes: on {self.machine['cpu']}"
        table = text.index(heading)
        self.assertLess(text.index("tiny"), table)
        self.assertIn(self.machine["git_commit"][:10], text[table:])
        for words in (baselines.COMPARABLE, baselines.NOT_COMPARABLE):
            self.assertIn(words, text[table:])
        lines = [line.split() for line in text[table:].splitlines() if line.startswith(("FastLSM", "Bullet"))]
        self.assertEqual([line[-1] for line in lines], ["1.00", "132", "26.8"])
        self.assertEqual([line[-6] for line in lines], ["yes", "yes", "no"])
        self.assertNotIn("another machine", text)

    def test_markdown_and_latex_have_it_too(self):
        text = self.with_baselines("markdown")
        self.assertIn("| Bullet, finite elements | E 1.2e+06 Pa | 0.001 | 9.92 | yes | 3.76 | 4558 | 3760 | 0.0840 | 132 |",
                      text)
        text = self.with_baselines("latex")
        self.assertEqual(text.count("\\begin{tabular}"), 2)
        self.assertIn("Bullet, finite elements & E 1.2e+06 Pa & 0.001 & 9.92 & yes & 3.76 & 4558 &", text)
        self.assertIn(f"% Not comparable: {baselines.NOT_COMPARABLE}.", text)

    def test_programs_read_all_of_it(self):
        rows, methods = self.with_baselines("csv").split("\n\n")
        self.assertEqual([row["scene"] for row in csv.DictReader(rows.splitlines())], ["tiny"])
        methods = list(csv.DictReader(methods.splitlines()))
        self.assertEqual([row["method"] for row in methods], [row[0] for row in ROWS])
        self.assertEqual([float(row["ns_node_step"]) for row in methods], [row[5] for row in ROWS])
        self.assertEqual((methods[2]["deviation_percent"], methods[2]["same_sag"]), ("", "0"))
        told = json.loads(self.with_baselines("json"))["baselines"]
        self.assertEqual([row["ms_second"] for row in told["methods"]], [row[6] for row in ROWS])
        self.assertEqual((told["nodes"], told["comparable"], told["other_machine"]), (825, baselines.COMPARABLE, None))
        self.assertEqual(told["environment"]["git_commit"], self.machine["git_commit"])

    def test_another_machine_is_said(self):
        self.store("instead.h5", self.machine | {"cpu": "Pentium 4"})
        self.assertIn("another machine: Pentium 4; this is ", self.with_baselines("text"))
        self.assertIn("Pentium 4", json.loads(self.with_baselines("json"))["baselines"]["other_machine"])

    def test_without_it_nothing_is_said(self):
        for form in ("text", "csv", "json"):
            self.assertNotIn("instead", self.tables("--format", form).stdout)

    def test_what_cannot_be_used_is_one_line(self):
        with open(self.at("instead.h5"), "r+b") as file:
            whole = file.read()
            file.truncate(len(whole) // 2)
        with open(self.at("damaged.h5"), "wb") as file:
            file.write(whole.replace(b"Bullet", b"Mullet", 1))
        self.assertEqual(self.tables("-o", "rows.h5").returncode, 0)
        for name, words in {"instead.h5": "cut off", "damaged.h5": "damaged, or changed by", "no.h5": "no such file",
                            "tiny.cfg": "not an HDF5 file", "rows.h5": "not a shapebench baselines file"}.items():
            done = self.tables("--baselines", name)
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (3, "", 1), done.stderr)
            self.assertIn(name, done.stderr)
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    PROGRAM = os.path.realpath(sys.argv.pop(1))
    unittest.main()
