"""The page: opens every scene, looks at what is drawn, pulls, turns knobs, and holds the steps of the engines in
it to those of the program."""
import os
import re
import subprocess
import tempfile

import h5py
import numpy
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from page_case import CHANGED, GESTURES, LOOK, PROGRAM, SETTLE, SIDES, WHERE, PageCase

SCENES = ("hand-lattice", "hand-sampled", "penguin", "infant-bones", "liver", "flowers", "beam", "statue-shell",
          "penguins-collide", "beam-elastic", "balljoint", "rockerarm")


class Page(PageCase):
    def test_scenes_draw(self):
        """Where a vertex of the surface is projected, the picture has the body's colour."""
        self.assertLessEqual(set(SCENES), set(self.ask("return shapebench.engine.sceneNames()")))
        for name in SCENES:
            with self.subTest(name):
                self.open(name)
                drawn = self.ask(LOOK)
                self.assertGreaterEqual(len(drawn), 1)
                for side, (seen, hit) in drawn.items():
                    self.assertGreater(seen, 250, f"{name}, {SIDES[int(side)]}: out of the picture")
                    hidden = 0.5 if name == "penguins-collide" else 0.01  # by icicles
                    self.assertGreaterEqual(hit, (1 - hidden) * seen, f"{name}, {SIDES[int(side)]}")

    def test_steps_are_the_programs(self):
        """A hundred steps and more of a scene's own engine, surface against surface, in cells."""
        for name, frames, side in (("penguin", 25, 0), ("beam", 7, 0), ("hand-sampled", 50, 1), ("liver-drop", 25, 0),
                                   ("beam-elastic", 120, 1), ("balljoint", 120, 1)):
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, "out.vtkhdf")
                subprocess.run([PROGRAM, "run", name, "--frames", str(frames), "-o", path], check=True,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                with h5py.File(path) as file:
                    stored = file["VTKHDF/Points"][()]
                    stored = stored[file["VTKHDF/Steps/PointOffsets"][-1]:]
                self.open(name)
                self.ask("shapebench.advance(values[0])", frames)
                away = numpy.abs(self.points(side) - stored).max() / self.figure(side, "cell")
                self.assertLess(away, 2e-3, f"{name}: {away} cells")
                print(f"{name}: {frames} frames, at most {away:.2g} cells from the program's", flush=True)

    def test_a_drag_moves_both(self):
        """What is dragged is where the pointer is, on both sides: a fingertip, and the top of a block, which
        comes back to rest (the hand swings for minutes)."""
        hand = self.ask("return shapebench.engine.sceneText('hand').replace('bend = 0.7', 'bend = 0.0')")
        for text, returns in ((hand, False), (BLOCK, True)):
            self.assertFalse(self.ask("return shapebench.open(values[0], false)", text))
            before = [self.points(side) for side in (0, 1)]
            for side in (0, 1):
                self.drag(side, before)
                if not returns:
                    continue
                self.ask("shapebench.advance(2000)")
                for s in (0, 1):
                    self.assertLess(self.away(s, before), 0.05, f"{SIDES[s]} has not come back")

    def drag(self, side, before):
        """Pulls the highest vertex of a side by the mouse, and lets it go."""
        self.ask("shapebench.pause()")
        top = int(before[side][:, 1].argmax())
        at = self.ask(WHERE, side, top)
        self.pull({"x": at["x"], "y": at["y"] + 6}, (40, 30))  # not on its outline
        self.ask("shapebench.advance(10)")
        now = self.ask(WHERE, side, top)
        self.assertLess(abs(now["x"] - at["x"] - 40) + abs(now["y"] - at["y"] - 30), 15, SIDES[side])
        moved = [self.away(s, before) for s in (0, 1)]
        self.assertGreater(moved[1 - side], 0.5 * moved[side], "the other side stays behind")
        ActionChains(self.driver).release().perform()

    def test_random_gestures_stay_finite(self):
        """Grabs and throws at random, faster than any hand."""
        self.open("penguin")
        finite = self.ask(GESTURES, 10000)
        self.assertTrue(finite)

    def test_a_setting_is_changed_in_its_text(self):
        """Knobs change the scene's text: its line alone, not what looks like it in comments and strings."""
        cases = (("w = 2;", "w", "3", "w = 3;"),
                 ("# w = 7;\nt = \"w = 8; {\"; /* w = 1; */ w : 2", "w", "3",
                  "# w = 7;\nt = \"w = 8; {\"; /* w = 1; */ w : 3"),
                 ("handles = ( { w = 5; } );\n", "w", "3", "handles = ( { w = 5; } );\nw = 3;\n"),
                 ("octree = {\n    nodes = 9;\n};", "octree.levels", "4",
                  "octree = {\n    levels = 4;\n    nodes = 9;\n};"),
                 ("w = 1;\n", "octree.levels", "4", "w = 1;\noctree = { levels = 4; };\n"),
                 ("damping = 0.5", "h", "0.01", "damping = 0.5\nh = 0.01;\n"))
        for text, path, value, wanted in cases:
            self.assertEqual(self.ask(SET, text, path, value), wanted)
            self.assertEqual(self.ask(GET, wanted, path), float(value))
        numbers = self.ask("return (await import('view/scene_text')).getNumbers(...values)",
                           "gravity = [0.0, /* 1, */ -9.81, # up, 2\n 0.5];", "gravity")
        self.assertEqual(numbers, [0, -9.81, 0.5])
        whole = self.ask("return shapebench.engine.sceneText('liver')")
        self.ask("const m = await import('view/scene_text'); for (let end = 0; end <= values[0].length; end++) "
                 "m.getNumber(m.setSetting(values[0].slice(0, end), 'w', 4), 'w')", whole)  # it ends

    def test_links_carry_scenes(self):
        """A copied link opens the scene with its settings in another page; a damaged one is said to be so."""
        self.open("penguin")
        self.turn("w", "3")
        link = self.ask("document.getElementById('link').click(); "
                        "await new Promise((done) => setTimeout(done, 300)); return location.href")
        self.driver.get("about:blank")
        self.driver.get(link)
        self.ask("shapebench.pause()")
        self.assertIn("w = 3;", self.ask("return shapebench.text()"))
        said = self.ask("location.hash = '#scene=zzzz'; await new Promise((done) => setTimeout(done, 300)); "
                        "return document.getElementById('status').textContent")
        self.assertIn("damaged", said)
        self.assertIn("w = 3;", self.ask("return shapebench.text()"))

    def turn(self, name, value):
        """Sets what the scene file says, as its knob does."""
        text = self.ask("return shapebench.text()")
        changed = re.sub(rf"^{name} = .*;", f"{name} = {value};", text, flags=re.MULTILINE)
        self.assertFalse(self.ask("return shapebench.open(values[0], true)", changed))

    def test_every_knob_changes_its_setting(self):
        """By the keyboard: the scene's text says what the knob does, the engines take it, and nothing is refused."""
        self.open("hand-sampled")
        for knob in self.driver.find_elements("css selector", "[id|=knob]:is(input, select)"):
            if not knob.is_displayed():
                continue  # another engine's
            before = self.ask("return shapebench.text()")
            name = knob.get_attribute("id")
            options = [option.text for option in knob.find_elements("tag name", "option")]
            for value in options[1:] or [None]:
                knob.send_keys(Keys.ARROW_DOWN if options else Keys.ARROW_LEFT * 3)
                after = self.ask(CHANGED, before)
                note = self.driver.find_element("id", f"{name}-note").text
                self.assertFalse(note, f"{name} {value}")
                self.assertIsNotNone(after, f"{name} {value}")
                before = after
        for setting in ('weighting = "plain"', "widths = ( {", "near = ", 'polar = "jacobi"', 'summation = "naive"'):
            self.assertIn(setting, before)

    def test_gravity_of_other_units(self):
        """A body of hundreds of units falls by hundreds of them, and the knob goes as far."""
        self.assertFalse(self.ask("return shapebench.open(values[0], false)", BLOCK + "gravity = [0.0, -463.0, 0.0];"))
        knob = self.driver.find_element("id", "knob-gravity")
        self.assertAlmostEqual(float(knob.get_attribute("value")), -463, delta=15)
        before = self.ask("return shapebench.text()")
        knob.send_keys(Keys.ARROW_RIGHT)
        after = float(re.search(r"gravity = \[0.0, (.*), 0.0\]", self.ask(CHANGED, before)).group(1))
        self.assertTrue(-463 < after < -400, after)
        self.open("penguin")
        self.assertEqual(float(knob.get_attribute("min")), -19.62)

    def test_one_side_alone(self):
        """It fills the view, and the other takes no time; both begin anew together."""
        self.open("penguin")
        show = self.driver.find_element("id", "sides")
        wide = self.driver.find_element("id", "views").rect["width"]
        for keys, side in ((Keys.ARROW_DOWN, 0), (Keys.ARROW_DOWN, 1)):
            show.send_keys(keys)
            self.ask(SETTLE)
            self.assertAlmostEqual(self.driver.find_element("id", f"view-{side}").rect["width"], wide, delta=2)
            self.ask("shapebench.advance(20)")
            self.assertGreater(self.figure(side, "time"), 0)
            self.assertEqual(self.figure(1 - side, "time"), 0)
            self.assertEqual(list(self.ask(LOOK)), [str(side)])
        show.send_keys(Keys.ARROW_UP * 2)
        self.ask(SETTLE)
        self.assertEqual([self.figure(side, "time") for side in (0, 1)], [0, 0])

    def test_the_papers_shares_stand_beside(self):
        self.open("statue-shell")
        self.ask("shapebench.advance(60)")
        cells = [cell.text for cell in self.driver.find_elements("css selector", "#stages td:nth-child(2)")]
        for cell, percent in zip(cells, (20, 21, 8, 35, 16)):
            self.assertIn(f"(paper {percent} %)", cell)

    def test_settings_change_what_they_should(self):
        self.open("hand")
        particles = self.figure(0, "particles")
        self.turn("particles", "1500")
        self.assertLess(self.figure(0, "particles"), 0.5 * particles)
        refused = self.ask("return shapebench.open(shapebench.text().replace('w = 2', 'w = 99'), true)")
        self.assertIn("'w' must be", refused)


BLOCK = """
mesh = "shape:block"; particles = 700; w = 2; damping = 0.3; octree = { levels = 1; };
handles = ( { box_low = [0.0, 0.0, 0.0]; box_high = [1.0, 0.2, 1.0]; } );
"""
SET = "return (await import('view/scene_text')).setSetting(...values)"
GET = "return (await import('view/scene_text')).getNumber(...values)"
