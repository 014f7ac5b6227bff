#!/usr/bin/env python3
"""export.py: usage: test_export.py PROGRAM. What it makes of files that the program has stored, and of made verdicts."""
import json
import pathlib
import subprocess
import sys
import unittest
import xml.etree.ElementTree as xml

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = sys.argv.pop(1)
STORED = HERE.parent / "results/published/fastlsm.h5"


def export(what, found):
    text = found if isinstance(found, str) else json.dumps(found)
    return subprocess.run([sys.executable, HERE / "export.py", what], input=text, capture_output=True, text=True)


def asked(*words):
    done = subprocess.run([PROGRAM, *words, "--format", "json"], stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout)


class Export(unittest.TestCase):
    def test_a_file_against_itself(self):
        found = asked("regress", "--quiet", STORED, STORED)
        runs = json.loads(export("gbench", found).stdout)["benchmarks"]
        self.assertGreater(len(runs), 20)
        for run in runs:
            self.assertTrue(run["name"].startswith(("old/", "new/")) and run["real_time"] > 0 and run["time_unit"] == "ns")
        suite = xml.fromstring(export("junit", found).stdout)
        self.assertEqual(int(suite.get("tests")), len(found["comparisons"]))
        for kind in ("failure", "error", "skipped"):
            self.assertEqual(int(suite.get(kind + "s" * (kind != "skipped"))), len(suite.findall(f"testcase/{kind}")))

    def test_verdicts_and_texts(self):
        side = {"ms": 2, "samples": [0.002]}
        found = {"baseline": "<&\">", "verdict": "slower", "remarks": ["é"], "comparisons": [
            {"scene": "a <&\">", "time": "total", "verdict": verdict, "reason": reason, "ratio": 1.25, "low": 1.2,
             "high": 1.3, "old": side, "new": side} for verdict, reason in
            (("slower", None), ("same", None), ("INVALID", "off"), ("too noisy", "few"), ("no baseline", "none"))]}
        suite = xml.fromstring(export("junit", found).stdout)
        self.assertEqual([suite.get(k) for k in ("tests", "failures", "errors", "skipped")], ["5", "1", "1", "2"])
        self.assertEqual(suite[0].get("classname"), "a <&\">")
        self.assertEqual(suite[0][0].get("message"), "slower: 1.2500 times (1.2000 to 1.3000)")

    def test_rows_have_a_name_each(self):
        row = {"scene": "tiny", "engine": "brute", "isa": "avx2", "valid": True, "total_ms": 1, "total_low_ms": 0.9,
               "total_high_ms": 1.1, "samples_ms": [1, 2]}
        found = {"rows": [row, row, row, row, {**row, "valid": False}], "environment": {"utc": "2026-03-16T10:00:00Z"}}
        metrics = json.loads(export("bencher", found).stdout)
        self.assertEqual(list(metrics), ["tiny", "tiny (brute)", "tiny (avx2)", "tiny (2)"])
        self.assertEqual(metrics["tiny"]["latency"], {"value": 1e6, "lower_value": 9e5, "upper_value": 1.1e6})
        self.assertEqual(len(json.loads(export("gbench", found).stdout)["benchmarks"]), 8)

    def test_mistakes(self):
        for what, text in (("pdf", "{}"), ("junit", "{}"), ("bencher", "no JSON"), ("gbench", "[1]")):
            done = export(what, text)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertEqual(len(done.stderr.splitlines()), 1 if what != "pdf" else 2)


if __name__ == "__main__":
    unittest.main()
