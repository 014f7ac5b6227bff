#!/usr/bin/python3
"""Tests of `shapebench report` on files that the program itself writes. CTest runs it.

usage: test_report.py PROGRAM"""
import base64
import csv
import gzip
import html.parser
import io
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

try:
    import h5py
    import jinja2  # noqa: F401
    import matplotlib  # noqa: F401
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}; scripts/setup run installs it")
    sys.exit(77)

import change_point  # noqa: E402
import claim_figures  # noqa: E402
import draft  # noqa: E402
import drawing  # noqa: E402
import headline  # noqa: E402
import history  # noqa: E402
import main  # noqa: E402
import row_figures  # noqa: E402
import sources  # noqa: E402
import stored  # noqa: E402
import tables  # noqa: E402
import ticks  # noqa: E402

PROGRAM = sys.argv.pop(1)
SOURCES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(1, os.path.join(SOURCES, "scripts"))
import baselines  # noqa: E402


CHANGED = "written to by another program; HDF5's own checksums hold"


class Page(html.parser.HTMLParser):
    """What a page holds: open tags left over, pictures without words, addresses, text."""

    VOID = {"meta", "img", "br", "link", "input"}

    def __init__(self, text):
        super().__init__()
        self.open, self.wordless, self.addresses, self.text, self.figures = [], 0, [], "", 0
        self.scripts, self.buttons = [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.figures += tag == "figure"
        if tag in ("script", "button"):
            (self.scripts if tag == "script" else self.buttons).append("")
        self.addresses += [values[name] for name in ("href", "src") if name in values]
        if tag == "svg" and not values.get("aria-label") or tag == "img" and not values.get("alt"):
            self.wordless += 1
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.addresses += [v for k, v in attributes if k in ("href", "src", "xlink:href")]

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, f"</{tag}> closes {self.open[-1:]}"
        self.open.pop()

    def handle_data(self, data):
        if self.open and self.open[-1] == "script":
            self.scripts[-1] += data
        else:
            if "button" in self.open:
                self.buttons[-1] += data
            self.text += data


class ChangePoint(unittest.TestCase):
    """Series that change where they are made to, or nowhere."""

    def setUp(self):
        self.rng = np.random.default_rng(5)

    def times(self, *parts, noise=0.01):
        """Parts of so many values, each of about one time."""
        return np.concatenate([value * np.exp(self.rng.normal(0, noise, count)) for count, value in parts])

    def test_a_change_is_found_where_it_is(self):
        for trial in range(8):
            values = self.times((5 + trial, 1), (9 + 2 * trial, 1.1 if trial % 2 else 0.9))
            found = change_point.find_changes(values)
            self.assertIn(5 + trial, found)
            self.assertTrue(all(0 < p <= change_point.LEVEL for p in found.values()))
            self.assertEqual(found, change_point.find_changes(values))
            x = np.log(values)  # the statistic as equations 5 to 7 have it, from all pairs

            def q(m, k, x=x):
                within = [np.abs(part[:, None] - part).sum() / (len(part) * (len(part) - 1)) for part in (x[:m], x[m:k])]
                return m * (k - m) / k * (2 * np.abs(x[:m, None] - x[m:k]).mean() - sum(within))

            best = max((q(m, k), m) for m in range(3, len(x) - 2) for k in range(m + 3, len(x) + 1))
            self.assertEqual(change_point.split(x)[1], best[1])
            self.assertAlmostEqual(change_point.split(x)[0], best[0], places=12)

    def test_several_changes_are_found_and_how_large_they_are(self):
        values = self.times((20, 1), (15, 1.2), (25, 0.8))
        self.assertEqual(list(change_point.find_changes(values)), [20, 35])
        ratio, low, high = change_point.ratio(values[:20], values[20:35])
        self.assertTrue(1.18 < low < ratio < high < 1.22, (low, ratio, high))
        # medians' error is 1.25 times a mean's; 95% of errors lie within 3.9 times it
        self.assertTrue(0.8 < np.log(high / low) / (3.9 * 1.25 * 0.01 * np.sqrt(1 / 20 + 1 / 15)) < 1.2)

    def test_a_series_that_does_not_change_has_no_change(self):
        """One of a hundred has; of 40 more than 3 in one run of a thousand. One slow file is no change either."""
        alarms = 0
        for trial in range(40):
            values = self.times((20, 1), noise=0.01 if trial % 2 else 0.2)
            values[11] *= 3 if trial % 4 == 0 else 1
            alarms += bool(change_point.find_changes(values))
        self.assertLessEqual(alarms, 3)

    def test_few_values_or_equal_ones_have_no_change(self):
        self.assertEqual(change_point.find_changes([1] * 30), {})
        self.assertEqual(change_point.find_changes([1] * 4 + [2] * 5), {})
        self.assertEqual(list(change_point.find_changes([1] * 6 + [2] * 6)), [6])

    def test_a_series_is_of_the_same_work(self):
        """What an older file does not state is not judged; rows that are BUSY, or INVALID, are left out."""
        row = {"scene": "x", "engine": "octree", "precision": "single", "threads": 1, "particles": 9, "w": 1, "epsilon": 0.0,
               "h": 0.01, "valid": 1, "total_ms": 2.0, "total_low_ms": 1.0, "total_high_ms": 3.0}
        rows = [row, row | {"input_hash": 7}, row | {"epsilon": 0.5}, row | {"total_ms": float("nan")}, row | {"valid": 0},
                row | {"input_hash": 8}, row | {"isa": "avx2", "input_hash": 7}]
        files = [mock.Mock(rows=[row], machine={"kernel": "unknown" if n == 3 else str(n > 4)}) for n, row in enumerate(rows)]
        found = [[point["file"] for point in points] for points in history.find_series(files)]
        self.assertEqual(found, [[0, 1, 6], [2], [5]])
        self.assertEqual(list(history.find_marks(files)), [{"file": 5, "what": "kernel", "old": "False", "new": "True"}])


def shapebench(*words):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, timeout=300)


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="shapebench_report_")
        cls.rows = os.path.join(cls.folder, "rows.h5")
        for _ in range(20):  # until there are times
            done = shapebench("tables", "--scene", "penguin", "--repeats", "2", "--overwrite", "-o", cls.rows)
            assert done.returncode == 0, done.stderr
            if "BUSY" not in done.stdout:
                return
        shutil.rmtree(cls.folder)
        print("skipped: other programs take the processors: no row has times")
        sys.exit(77)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def at(self, name):
        return os.path.join(self.folder, name)

    def copy(self, name, change):
        path = self.at(name)
        shutil.copy(self.rows, path)
        with h5py.File(path, "r+") as file:
            change(file)
        with open(path, "r+b") as file:
            stored.write_checksum(file)
        return path

    def page(self, *files, remarks=0):
        output = self.at("page.html")
        done = shapebench("report", "--overwrite", "-o", output, *files)
        said = done.stderr.splitlines()
        self.assertEqual((done.returncode, said), (0, [f"{files[0]}: {CHANGED}"] * remarks))
        with open(output, encoding="utf-8") as file:
            page = Page(file.read())
        self.assertEqual(page.open, [])
        self.assertEqual(page.wordless, 0)
        for address in page.addresses:
            self.assertRegex(address, "^(#|data:)")
        return page

    def refused(self, path, words):
        done = shapebench("report", "-o", self.at("none.html"), path)
        self.assertEqual(done.returncode, 3)
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertIn(path, done.stderr)
        self.assertIn(words, done.stderr)
        self.assertFalse(os.path.exists(self.at("none.html")))

    def test_a_page_has_the_measured_values(self):
        page = self.page(self.rows)
        with h5py.File(self.rows) as file:
            row = file["rows/000"].attrs
            self.assertIn(f"{row['total_ms'] / row['particles'] * 1e6:.3g}"[:4], page.text)
            self.assertIn(file["machine"].attrs["git_commit"].decode(), page.text)
        self.assertIn("VALID", page.text)
        self.assertGreaterEqual(page.figures, 2)

    def test_what_the_page_does_not_know_is_named_by_the_file(self):
        def change(file):
            file["columns"].attrs["novelty"] = np.bytes_("what nobody has heard of [furlongs]")
            file["rows/000"].attrs["novelty"] = 42.5

        page = self.page(self.copy("novelty.h5", change))
        self.assertRegex(page.text, r"novelty\s*furlongs\s*42.5\s*what nobody has heard of\n")

    def test_files_without_meanings_are_read(self):
        def change(file):
            del file["columns"]

        self.assertNotIn("All that was stored", self.page(self.copy("older.h5", change)).text)

    def test_a_meaning_that_is_no_text_is_refused(self):
        for name in ("total_ms", "of two words"):
            path = self.copy("meaning.h5", lambda file, name=name: file["columns"].attrs.__setitem__(name, 5))
            self.refused(path, f"'{name}'")

    def test_an_invalid_row_has_no_times(self):
        def spoil(file):
            row = file["rows/000"].attrs
            row["valid"], row["reason"], row["total_ms"] = 0, b"goals are off", 123.456

        page = self.page(self.copy("invalid.h5", spoil))
        self.assertIn("INVALID: goals are off", page.text)
        self.assertNotIn("123", page.text.split("Where these were measured")[0])

    def test_a_busy_row_has_no_times(self):
        def disturb(file):
            row = file["rows/000"].attrs
            row["busy"], row["reason"], row["total_ms"] = 1, b"throttled: quota of 0.5 cores", float("nan")

        text = self.page(self.copy("busy.h5", disturb)).text
        self.assertIn("BUSY: throttled: quota of 0.5 cores", text)
        self.assertIn("left no undisturbed time to", text)

    def test_the_headline_is_made_of_the_rows(self):
        def two(file):
            file.copy("rows/000", "rows/001")
            file.copy("rows/000", "rows/002")
            for n, scene, ms in ((0, b"slow", 2.0), (1, b"fast", 0.5), (2, b"hearsay", 0.1)):
                row = file[f"rows/00{n}"].attrs
                row["scene"], row["total_ms"], row["paper_total_ms"], row["paper_total_status"] = scene, ms, 10.0, b"quoted"
            file["rows/002"].attrs["paper_total_status"] = b"second-hand"
            file["machine"].attrs["cpu"] = b"Abacus"

        words = " ".join(self.page(self.copy("two.h5", two)).text.split())
        self.assertIn("Speed FastLSM: a step is 5.00 times (slow) to 20.0 times (fast) as fast as the paper's figure, on 1 thread. "
                      "Such factors are of machines too, and not of programs alone: Abacus here, there a Pentium 4", words)
        self.assertIn("Checks 3 rows were measured; each was checked on the very scene timed: all are VALID.", words)
        self.assertNotIn("Claims", words)

    def test_the_headline_names_no_point_of_a_sweep_without_its_stiffness(self):
        source = sources.read(os.path.join(SOURCES, "results", "published", "sweep.h5"))
        told = list(headline.recommendations(PROGRAM, source))
        self.assertEqual(len(told), 3)
        for choice, sentence in zip(("soft", "middle", "stiff"), told):
            self.assertRegex(sentence, rf"^Hand, {choice} \(a beam of \S+ Hz\): fastlsm w \d+ sags \S+%, \S+ ms a step; "
                                       r"octree w \d+ and epsilon \S+ sags \S+%, \S+ ms a step\.$")

    def test_the_headline_counts_the_verdicts(self):
        def claim(name, verdict, value, kind="method"):
            return {"kind": kind, "paper": "mine", "name": name, "verdict": verdict, "count": 1, "values": 1,
                    "measured": [value], "paper_value": [1.0]}

        source = mock.Mock(claims=[
            claim("a", "reproduced", 9.0), claim("b", "differs", 0.25), claim("c", "differs", 3.0),
            claim("d", "undecided", 2.0), claim("e", "differs", 1.5), claim("f", "measured", 99.0, "machine")])
        self.assertEqual(list(headline.claims(source)), [
            "Of 5 claims of method 1 is undecided, 1 is reproduced and 3 differ. Farthest off: mine b, 0.250 where the paper has "
            "1.00; mine c, 3.00 where the paper has 1.00; mine d, 2.00 where the paper has 1.00."])

    def test_a_card_has_its_picture_where_there_is_one(self):
        def name(file):
            file.copy("rows/000", "rows/001")
            file["rows/001"].attrs["scene"] = b"../scenes/penguin"

        page = self.page(self.copy("cards.h5", name))
        pictures = [address for address in page.addresses if address.startswith("data:image/webp")]
        with open(os.path.join(SOURCES, "results", "scenes", "penguin.webp"), "rb") as file:
            self.assertEqual([base64.b64decode(address.split(",")[1]) for address in pictures], [file.read()])
        self.assertEqual(page.buttons, ["penguin", "../scenes/penguin"])

    def test_words_of_curves_and_axes(self):
        curve = {"y_name": "most_summation", "exponent": 2.0, "exponent_low": 1.0, "exponent_high": 3.0}
        self.assertEqual(claim_figures.label("regions.hand-whole.most_summation.asymmetric.n1-8.4", curve),
                         "hand-whole, not made symmetric")
        self.assertEqual(claim_figures.label("smoothing.w3.profile", curve), "w = 3")
        self.assertEqual(claim_figures.label("size.octree.sums.n10-33.6", curve),
                         "octree, the sums alone: power 2.00 (1.00 to 3.00)")
        for name, text in (("sums, ms/step", "sums, milliseconds a step"), ("what_nobody_knows", "what nobody knows"),
                           ("fast summation, ns/particle/step", "fast summation, nanoseconds a particle and step")):
            self.assertEqual(claim_figures.words(name), text)

    def test_a_curve_is_no_part_of_its_profiles(self):
        def curve(x_name, count, valid=1):
            nothing = float("nan")
            return {"valid": valid, "x": np.arange(1.0, count + 1), "y": np.arange(2.0, count + 2),
                    "low": np.full(count, nothing), "high": np.full(count, nothing), "x_name": x_name, "y_name": "cells",
                    "exponent": nothing, "exponent_low": nothing, "exponent_high": nothing}

        curves = {"smoothing.w1-6.6": curve("w", 5), "smoothing.w3.profile": curve("cells along the bar", 27),
                  "sums.fast.w1-4.4": curve("w", 4), "sums.fast.w1-6.12": curve("w", 6),
                  "sums.bars.w1-4.4": curve("w", 4), "sums.bars.w1-6.12": curve("w", 6, valid=0)}
        self.assertEqual([name for name in curves if claim_figures.is_part(name, curves[name], curves)], ["sums.fast.w1-4.4"])
        figures = {figure.name: figure for figure in claim_figures.figures(mock.Mock(curves=curves))}
        self.assertEqual({line[0] for line in figures["smoothing"].data}, {"smoothing.w1-6.6"})
        self.assertEqual({line[0] for line in figures["smoothing-profile"].data}, {"smoothing.w3.profile"})

    def test_logarithmic_axes_have_numbers(self):
        """Two labels at least that stand in the picture, and no powers where plain numbers do."""
        for low, high in ((0.22, 4.5), (3, 11), (1.5, 2.1), (0.02, 900), (4e4, 3e6)):
            figure, axes = drawing.canvas()
            axes.plot([low, high], [low, high])
            axes.set_xscale("log")
            ticks.label_logarithms(figure)
            figure.draw_without_rendering()
            left, right = axes.get_xlim()
            shown = [label.get_text() for minor in (False, True) for label in axes.get_xticklabels(minor=minor)
                     if label.get_text() and left <= label.get_position()[0] <= right]
            drawing.pyplot.close(figure)
            self.assertGreaterEqual(len(shown), 2, (low, high))
            for text in shown:
                self.assertRegex(text, r"^[\d.,]+$")
        self.assertEqual((ticks.power(2e8), ticks.power(1e-7), ticks.plain(1200.0)), ("2·10$^{8}$", "10$^{-7}$", "1,200"))

    def test_a_calibration_says_what_it_found(self):
        path = self.at("beam.h5")
        with open(self.at("box.obj"), "w", encoding="utf-8") as file:
            file.writelines(f"v {0.3 * (i & 1)} {0.1 * (i >> 1 & 1)} {0.1 * (i >> 2)}\n" for i in range(8))
            file.writelines(f"f {text}\n" for text in ("1 3 2", "2 3 4", "5 6 7", "6 8 7", "1 2 5", "2 6 5", "3 7 4",
                                                      "4 7 8", "1 5 3", "3 5 7", "2 4 6", "4 8 6"))
        with open(self.at("beam.cfg"), "w", encoding="utf-8") as file:
            file.write('mesh = "box.obj"; cell = 0.05; h = 0.001;')
        done = shapebench("calibrate", "--scene", self.at("beam.cfg"), "--w", "1:2", "--epsilon", "0", "--across", "1",
                          "--aspect", "none", "--step", "none", "--quiet", "-o", path)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.page(path)
        with h5py.File(path, "r+") as file:
            for n in (1, 2, 3):
                self.assertIn(file["laws"].attrs[f"found_{n}"].decode(), page.text)
            self.assertIn(drawing.number(1e-6 * float(file["specimens/young"][0])), page.text)
            self.assertEqual(page.figures, 3)
            file["specimens/valid"][0], file["specimens/young"][0] = 0, float("nan")
        self.assertIn("INVALID", self.page(path, remarks=1).text)
        with h5py.File(path, "r+") as file:
            del file["laws/scatter"]
        self.refused(path, "missing")

    def test_what_one_would_take_instead_has_its_table(self):
        path = self.at("baselines.h5")
        line = dict(zip(baselines.COLUMNS, ("ours", "w 2", 0.001, 9.98, 0.0284, 55.5, 28.4, 1.25)))
        other = line | {"method": "theirs", "ms/step": 11.7, "deviation %": float("nan")}
        plan = {"nodes": 825, "length": 0.8, "sag_percent": 9.98, "w": 2, "h": 0.001}
        machine = {"cpu": "one of ours", "git_commit": "0123", "utc": "2026-11-25T12:00:00Z"}
        baselines.store([line, other, other | {"step s": 1 / 240, "ms/step": 19.7}], plan, machine, path, False)
        page = self.page(path)
        said = ("A clamped beam of 825 nodes that sags by 9.98% of its length costs 0.0284 ms a step with ours, at the same "
                "step of 0.001 s 11.7 ms with theirs.")
        self.assertEqual(page.text.count(said), 2)  # in the headline, and above the table
        for text in ("55.5", "19.7", "0.00417", baselines.COMPARABLE, baselines.NOT_COMPARABLE):
            self.assertIn(text, page.text)
        with self.assertRaises(draft.Refused):
            baselines.store([line], plan, machine, path, False)

    def test_the_papers_values_are_those_of_tables(self):
        rows = sources.read(self.rows).rows
        self.assertAlmostEqual(rows[0]["paper_ns"], 0.28e6 / 150)
        table = tables.measured(sources.read(self.rows))
        ours, paper = (cells for _, cells in table.lines)
        self.assertEqual((ours[0], paper[3]), ("penguin", "1,867"))
        self.assertNotIn("damping ms", table.headings)

        def silent(file):
            for name in ("paper_particles", "paper_stage_percent"):
                del file["rows/000"].attrs[name]

        old = tables.measured(sources.read(self.copy("old.h5", silent)))
        paper = old.lines[1][1]
        self.assertEqual((paper[3], paper[old.headings.index("polar ms")]), ("–", "0.100"))

    def test_meshless_bodies_and_shells_have_the_tables_of_the_program(self):
        """The columns and rows, ours and the paper's, that `shapebench tables` printed of the same file."""
        published = os.path.join(SOURCES, "results", "published", "meshless")
        with open(published + ".txt", encoding="utf-8") as file:
            printed = re.findall(r"^scene .*?(?=\n\n)", file.read(), re.DOTALL | re.MULTILINE)
        source = sources.read(published + ".h5")
        made = [tables.elastic(source), tables.shells(source)]
        self.assertEqual(len(printed), len(made))
        for block, table in zip(printed, made):
            heading, *lines = [re.split(r"  +", line.strip()) for line in block.split("\n")]
            self.assertEqual([text.replace("motion ms", "motion").replace("skin ms", "skin") for text in table.headings],
                             heading[:-2] + ["times as fast as the paper"])  # that all are VALID the note says
            self.assertEqual(len(lines), len(table.lines))
            stages = range(heading.index("motion"), heading.index("skin") + 1)  # of which the program has percents alone
            for line, (_, cells) in zip(lines, table.lines):
                own = [text.replace(",", "").replace("–", "-") for text in cells if text]
                self.assertEqual([text for i, text in enumerate(own) if i not in stages],
                                 [text.rstrip("x") for i, text in enumerate(line[:len(own)]) if i not in stages])
            self.assertEqual(set(table.classes()[1:]), {""})
        with mock.patch("papers.FOLDERS", (self.at("none"),)):
            paper = tables.shells(source).lines[1][1]
        self.assertEqual(paper, ["paper", "40,000", "–", "–", "–", "–", "–", "20.0", ""])

    def test_the_octree_papers_thirds_are_beside_its_examples(self):
        rows = sources.read(os.path.join(SOURCES, "results", "published", "octree.h5")).rows
        figure = row_figures.stage_shares(rows)
        of_paper = {line[0]: line[2:] for line in figure.data if line[1] == "paper"}
        self.assertEqual(set(of_paper), {row["scene"] for row in rows if row["engine"] == "octree"})
        self.assertEqual(of_paper["liver"], [None, None, 33.3, 33.3, None, ""])
        self.assertIn("octree paper's are thirds", figure.caption)
        with mock.patch("papers.FOLDERS", (self.at("none"),)):
            figure = row_figures.stage_shares(rows)
        self.assertNotIn("paper", [line[1] for line in figure.data])
        self.assertNotIn("thirds", figure.caption)

    def test_what_all_rows_have_alike_is_said_above_them(self):
        table = tables.measured(sources.read(self.rows))
        for heading in ("engine", "precision", "threads", "w", "check", "sums / region"):
            self.assertNotIn(heading, table.headings)
        self.assertTrue(table.note.endswith("All: fastlsm, single precision, 1 thread, w 2, VALID."), table.note)

        def differ(file):
            file.copy("rows/000", "rows/001")
            row = file["rows/001"].attrs
            row["threads"], row["valid"], row["reason"] = 2, 0, b"goals are off"

        table = tables.measured(sources.read(self.copy("differ.h5", differ)))
        self.assertEqual([cells[table.headings.index("threads")] for kind, cells in table.lines if kind != "paper"], [1, 2])
        self.assertIn("check", table.headings)
        self.assertTrue(table.note.endswith("All: fastlsm, single precision, w 2."), table.note)
        self.assertEqual({len(cells) for _, cells in table.lines}, {len(table.headings)})

    def test_numbers_are_told_from_words(self):
        self.assertEqual([tables.class_of([text]) for text in ("0.0245 (-0.0647 to 0.114)", "12.0 / 26.0 /\n36.0*", "VALID",
                                                               "at most 5.00% more than theirs")], ["", "", "word", "text"])

    def test_doubtful_values_of_a_paper_keep_their_marks(self):
        def doubt(file):
            row = file["rows/000"].attrs
            row["paper_total_status"], row["paper_rate_status"] = b"derived", b"second-hand"
            row["paper_stage_status"] = b"quoted damaged quoted quoted derived"

        page = self.page(self.copy("doubt.h5", doubt))
        for words in ("0.280*", "0.0700 (26%)?", "0.0300 (12%)", "A question mark is behind", "a star is behind",
                      "shape matching of penguin (?)"):
            self.assertIn(words, page.text)
        self.assertNotIn("0.0300 (12%)?", page.text)
        self.assertNotIn("a star is behind", self.page(self.rows).text)
        self.refused(self.copy("few.h5", lambda f: f["rows/000"].attrs.__setitem__("paper_stage_status", b"quoted")),
                     "the number of stages")

    def test_a_claim_of_a_doubtful_value_has_its_mark(self):
        with open(self.at("mine.cfg"), "w", encoding="utf-8") as file:
            file.write('claims = ( { kind = "method"; paper = "octree"; name = "mine"; statement = "s"; '
                       'number = "liver-growth"; test = "near"; tolerance = 100.0; '
                       'measure = { experiment = "polar"; field = "cold-sweeps"; }; } );')
        done = shapebench("claims", "--claims", self.at("mine.cfg"), "--claim", "mine", "--quick", "-o", self.at("c.h5"))
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.page(self.at("c.h5"))
        self.assertIn("4.19*", page.text)
        self.assertIn("A star is behind", page.text)
        self.assertIn("1 claim of the papers was measured (c.h5): 1 method (reproduced 1).", page.text)

    def test_claims_of_each_kind_have_their_table(self):
        with open(self.at("kinds.cfg"), "w", encoding="utf-8") as file:
            file.write('claims = ( { kind = "machine"; paper = "mine"; name = "speed"; statement = "s"; value = 1e6; '
                       'test = "at_most"; measure = { experiment = "polar"; field = "cold-ns"; }; },\n'
                       '{ kind = "by construction"; paper = "mine"; name = "set"; statement = "s"; value = 2.2; '
                       'test = "near"; tolerance = 0.5; measure = { experiment = "polar"; field = "cold-sweeps"; }; '
                       'unset = { experiment = "polar"; field = "warm-sweeps"; }; } );')
        done = shapebench("claims", "--claims", self.at("kinds.cfg"), "--paper", "mine", "--quick", "-o", self.at("k.h5"))
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.page(self.at("k.h5"))
        for words in ("1 machine (measured 1); 1 by construction (as set 1).", "Machine: claims", "times as fast",
                      "By construction: claims", "Of k.h5.", "not set /curves/polar.warm-sweeps"):
            self.assertIn(words, page.text)
        self.assertNotIn("Method: claims", page.text)
        with h5py.File(self.at("k.h5"), "r+") as file:
            next(iter(file["claims"].values())).attrs["count"] = 0.5
        self.refused(self.at("k.h5"), "'count'")

    def test_texts_are_escaped(self):
        def name(file):
            file["machine"].attrs["hostname"] = b"<script>x</script>"
            file["rows/000"].attrs["scene"] = "a<b & \u00e9".encode()

        page = self.page(self.copy("names.h5", name))
        self.assertIn("<script>x</script>", page.text)
        self.assertIn("a<b & \u00e9", page.text)

    def test_commits_make_a_history(self):
        def older(file):
            file["machine"].attrs["git_commit"] = np.bytes_("0123456789abcdef")
            file["machine"].attrs["utc"] = np.bytes_("2020-01-01T00:00:00Z")

        page = self.page(self.rows, self.copy("older.h5", older))
        self.assertIn("A scene from file to file", page.text)

    def test_two_files_of_one_commit_are_compared(self):
        def slower(file):
            row = file["rows/000"].attrs
            for name in ("total_ms", "total_low_ms", "total_high_ms"):
                row[name] *= 1.25

        page = self.page(self.rows, self.copy("b.h5", slower))
        self.assertIn("A scene from file to file", page.text)
        self.assertIn("Side by side: the oldest file and the newest", page.text)
        self.assertRegex(page.text, r"A: rows.h5 \(.*\)\. B: b.h5 \(")
        self.assertIn("(1.250 times; quartiles", page.text)
        self.assertIn("b.h5", page.text)

    def days(self, change):
        """Files of twelve days: `change` receives each one's row, machine and number."""
        def of(day):
            def alter(file):
                row, machine = file["rows/000"], file["machine"].attrs
                machine["git_commit"] = np.bytes_(f"{day:010d}abc")
                machine["utc"] = np.bytes_(f"2026-03-{day:02d}T10:00:00Z")
                factor = change(machine, day) * (1 + (7919 * day % 17 - 8) / 1000)
                for name in ("total_ms", "total_low_ms", "total_high_ms"):
                    row.attrs[name] *= factor
                row["total"][:] *= factor
            return self.copy(f"day{day:02d}.h5", alter)
        return [of(day) for day in range(1, 13)]

    def test_a_change_is_drawn_and_told_where_it_is(self):
        def change(machine, day):
            if day >= 7:
                machine["kernel"] = np.bytes_("Linux 99")
            return 1.25 if day >= 7 else 1

        page = self.page(*self.days(change))
        words = " ".join(page.text.split())
        self.assertRegex(words, r"penguin is slower from day07.h5 \(2026-03-07, 0000000007\+?\) on: 1.2[45]\d times "
                                r"\(1\.\d+ to 1\.\d+, p 0.002\); there the kernel changed\.")
        self.assertIn("History penguin is slower from day07.h5", words)
        self.assertRegex(words, r"From day07.h5 .{,40} on the kernel is Linux 99, before ")
        self.assertIn("11 files whose scenes newer ones have are shown here alone.", words)
        self.assertRegex(words, r"A: day01.h5 \([^)]*\)\. B: day12.h5 \(")
        self.assertRegex(words, r"penguintotal[\d.]+ to [\d.]+%too few samples")
        data = next(base64.b64decode(address.split(",")[1]).decode() for address in page.addresses
                    if address.startswith("data:text/csv") and b"machine_changed" in base64.b64decode(address.split(",")[1]))
        lines = list(csv.DictReader(io.StringIO(data)))
        self.assertEqual([(line["file"], line["changed"], line["machine_changed"]) for line in lines],
                         [(f"day{day:02d}.h5", "1" if day == 7 else "0", "kernel" if day == 7 else "") for day in range(1, 13)])

    def test_a_history_without_a_change_says_so(self):
        words = " ".join(self.page(*self.days(lambda machine, day: 1)).text.split())
        self.assertIn("No scene changed", words)
        self.assertNotIn("is slower from", words)
        few = " ".join(self.page(self.at("day01.h5"), self.at("day02.h5")).text.split())
        self.assertIn("No change can be told from noise in fewer than ten files", few)

    def test_a_number_is_rounded_once(self):
        def tell(file):
            row = file["rows/000"].attrs
            row["ns_per_particle_step"] = 58.746  # 58.75 in two digits, and that 58.8 in one
            row["paper_total_ms"], row["paper_particles"] = 0.28, 150.0

        page = self.page(self.copy("round.h5", tell))
        self.assertIn("58.7 against", page.text)
        self.assertNotIn("58.8", page.text)

    def test_a_folder_has_every_figure_with_its_data(self):
        output = self.at("folder")
        for _ in range(2):  # the second takes the first's place
            self.assertEqual(shapebench("report", "--overwrite", "-o", output, self.rows).returncode, 0)
        self.assertEqual(shapebench("report", "-o", output, self.rows).returncode, 4)
        names = os.listdir(output)
        self.assertIn("index.html", names)
        figures = [name[:-4] for name in names if name.endswith(".svg")]
        self.assertGreaterEqual(len(figures), 2)
        for name in figures:
            self.assertGreater(os.path.getsize(os.path.join(output, name + ".png")), 1000)
            with open(os.path.join(output, name + ".csv"), encoding="utf-8") as file:
                lines = list(csv.reader(io.StringIO(file.read())))
            self.assertGreater(len(lines), 1)
            self.assertEqual({len(line) for line in lines}, {len(lines[0])})
        self.assertEqual([name for name in os.listdir(self.folder) if name.endswith(".tmp")], [])

    def test_texts_of_figures_are_texts(self):
        output = self.at("page.html")
        self.page(self.rows)
        with open(output, encoding="utf-8") as file:
            picture = file.read().split("<svg")[1].split("</svg>")[0]
        self.assertRegex(picture, "<text [^>]*>penguin</text>")
        self.assertNotIn("<metadata", picture)
        self.assertLess(len(picture), 20000)

    def test_the_live_page_is_in_it(self):
        """Once, and a button for each scene; --no-page leaves it out, and where it is not there a line says so."""
        page = self.page(self.rows, self.rows)
        with open(os.path.join(SOURCES, "results", "page.html"), "rb") as file:
            self.assertEqual(gzip.decompress(base64.b64decode(page.scripts[0])), file.read())
        self.assertEqual(len(page.scripts), 2)
        self.assertIn("it runs in this page", page.text)
        self.assertEqual(page.buttons, ["penguin"])
        done = shapebench("report", "--no-page", "-o", self.at("small.html"), self.rows)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with open(self.at("small.html"), encoding="utf-8") as file:
            small = Page(file.read())
        self.assertEqual((small.scripts, small.buttons, "it runs in this page" in small.text), ([], [], False))
        self.assertEqual(len([address for address in small.addresses if address.startswith("data:image/webp")]), 1)

        part = main.Part("scenes", "Scenes", cards=[main.live.Card("penguin")])
        options = mock.Mock(no_page=False)
        with mock.patch("main.live.FOLDERS", (self.at("none"),)), mock.patch("sys.stderr", io.StringIO()) as said:
            self.assertIsNone(main.find_page(options, [part]))
        self.assertRegex(said.getvalue(), "^shapebench report: there is no page.html, .*\n$")

    def test_an_older_report_is_kept_until_the_new_one_is_there(self):
        old, new = self.at("old"), self.at("new.tmp")
        for folder in (old, new):
            os.mkdir(folder)
            with open(os.path.join(folder, "index.html"), "w", encoding="utf-8") as file:
                file.write(folder)
        rename = os.rename

        def failing(source, target):
            if source == new:
                raise OSError(28, "No space left on device")
            rename(source, target)

        with mock.patch("os.rename", failing), self.assertRaises(OSError):
            main.take_place(new, old)
        with open(os.path.join(old, "index.html"), encoding="utf-8") as file:
            self.assertEqual(file.read(), old)
        main.take_place(new, old)
        with open(os.path.join(old, "index.html"), encoding="utf-8") as file:
            self.assertEqual(file.read(), new)
        self.assertEqual([name for name in os.listdir(self.folder) if name.endswith((".old", ".tmp"))], [])

    def test_bad_files_are_named(self):
        self.refused(self.at("nothing.h5"), "no such file")
        self.refused(self.folder, "is a directory")
        with open(self.at("text.h5"), "w", encoding="utf-8") as file:
            file.write("no HDF5")
        self.refused(self.at("text.h5"), "not an HDF5 file")
        with open(self.rows, "rb") as file:
            whole = file.read()
        with open(self.at("cut.h5"), "wb") as file:
            file.write(whole[:len(whole) // 2])
        self.refused(self.at("cut.h5"), "cut off")
        self.refused(self.copy("kind.h5", lambda f: f.attrs.__setitem__("kind", b"music")), "music")
        self.refused(self.copy("schema.h5", lambda f: f.attrs.__setitem__("schema", 1)), "schema 1")
        self.refused(self.copy("newer.h5", lambda f: f.attrs.__setitem__("schema", 99)), "use a newer shapebench")
        self.refused(self.copy("less.h5", lambda f: f["rows/000"].attrs.__delitem__("total_ms")), "missing")
        self.refused(self.copy("bare.h5", lambda f: f.__delitem__("machine")), "missing")

    def test_damaged_bytes_are_refused_or_read(self):
        with open(self.rows, "rb") as file:
            whole = file.read()
        refused = 0
        for seed in range(60):
            chance, damaged = random.Random(seed), bytearray(whole)
            for _ in range(4 << seed % 6):
                damaged[chance.randrange(100, len(whole))] = chance.randrange(256)
            with open(self.at("damaged.h5"), "wb") as file:
                file.write(damaged)
            stored.checksum_holds.cache_clear()  # these are written faster than their times of change differ
            try:
                sources.read(self.at("damaged.h5"))
            except sources.Unusable as error:
                refused += 1
                self.assertIn("damaged.h5: ", str(error))
                self.assertNotIn("\n", str(error))
        self.assertGreater(refused, 20)

    def test_an_interrupt_is_one_line_from_the_first_import_on(self):
        with open(self.at("jinja2.py"), "w", encoding="utf-8") as file:
            file.write("import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n")
        done = subprocess.run([PROGRAM, "report", "-o", self.at("none.html"), self.rows], capture_output=True, text=True,
                              timeout=300, env={**os.environ, "PYTHONPATH": self.folder})
        self.assertEqual((done.returncode, done.stderr), (130, "shapebench report: interrupted: nothing was written\n"))
        self.assertFalse(os.path.exists(self.at("none.html")))

    def test_what_a_process_of_the_same_number_left_is_no_error(self):
        left = [self.at(f"left.html.{os.getpid()}{more}.tmp") for more in ("", "-1")]
        os.symlink(self.at("elsewhere"), left[0])
        with open(left[1], "wb"):
            pass
        with draft.begun(self.at("left.html"), False) as file:
            file.write(b"new")
        with open(self.at("left.html"), "rb") as file:
            self.assertEqual(file.read(), b"new")
        self.assertFalse(os.path.exists(self.at("elsewhere")))
        self.assertEqual(sorted(name for name in os.listdir(self.folder) if name.startswith("left.html.")),
                         sorted(map(os.path.basename, left)))
        for name in left:
            os.remove(name)

    def test_a_place_that_cannot_be_written(self):
        done = shapebench("report", "-o", "/proc/none/page.html", self.rows)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (4, 1))
        full = shapebench("report", "-o", "/dev/full/page", self.rows)
        self.assertEqual((full.returncode, full.stderr.count("\n")), (4, 1))

    def example(self, language):
        """The README's example of reading a results file."""
        with open(os.path.join(SOURCES, "results", "README.md"), encoding="utf-8") as file:
            return file.read().split(f"```{language}\n")[1].split("```")[0]

    def test_the_readme_s_examples_run(self):
        for name, language in (("example.py", "python"), ("example.c", "c")):
            with open(self.at(name), "w", encoding="utf-8") as file:
                file.write(self.example(language))
        with h5py.File(self.rows) as file:
            wanted = f"{file['rows/000'].attrs['total_ms']:.4g} ms"
        python = subprocess.run([sys.executable, self.at("example.py"), self.rows], capture_output=True, text=True)
        self.assertIn("penguin " + wanted, python.stdout, python.stderr)
        flags = subprocess.run(["pkg-config", "--cflags", "--libs", "hdf5-serial"], capture_output=True, text=True)
        built = subprocess.run(["cc", "-Wall", "-Werror", self.at("example.c"), "-o", self.at("example"),
                                *flags.stdout.split()], capture_output=True, text=True)
        self.assertEqual(built.returncode, 0, built.stderr)
        said = subprocess.run([self.at("example"), self.rows], capture_output=True, text=True)
        self.assertIn(wanted, said.stdout)

    def test_a_folder_of_something_else_is_kept(self):
        os.makedirs(self.at("mine"), exist_ok=True)
        with open(self.at("mine/letter"), "w", encoding="utf-8"):
            pass
        done = shapebench("report", "-o", self.at("mine"), self.rows)
        self.assertEqual(done.returncode, 4)
        self.assertTrue(os.path.exists(self.at("mine/letter")))

    def test_a_report_with_something_else_and_other_pages_are_kept(self):
        output = self.at("pages")
        self.assertEqual(shapebench("report", "-o", output, self.rows).returncode, 0)
        for name, content in (("letter", "mine"), ("index.html", "<p>my page</p>")):
            with open(os.path.join(output, name), "w", encoding="utf-8") as file:
                file.write(content)
            self.assertEqual(shapebench("report", "-o", output, self.rows).returncode, 4)
            with open(os.path.join(output, name), encoding="utf-8") as file:
                self.assertEqual(file.read(), content)
            if name == "letter":
                os.remove(os.path.join(output, name))


if __name__ == "__main__":
    unittest.main()
