"""Elastic bodies beside FastLSM: hands, pins, throws and knobs on them, what is seen of their inside, and the page
that has none. That they move as the program's own do is test_page.py's."""
import math
import pathlib
import subprocess
import tempfile

import numpy
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

from page_case import CHANGED, GESTURES, HERE, SETTLE, SIDES, WHERE, PageCase

# The elastic beam, whose end stays where it is.
STILL = "return shapebench.engine.sceneText('beam-elastic').replace('amplitude = 1.0', 'amplitude = 0.0')"


class Elastic(PageCase):
    def open_still(self, *changes):
        """Opens the beam at rest under no gravity, or as `changes` have it."""
        text = self.ask(STILL)
        for old, new in changes or (("-9.81", "0.0"),):
            self.assertIn(old, text)
            text = text.replace(old, new)
        self.assertFalse(self.ask("return shapebench.open(values[0], false)", text))
        self.ask("shapebench.pause()")
        self.driver.find_element("id", "look").click()
        return text

    def step(self, steps):
        """Without drawing what is between."""
        self.ask("for (const side of [0, 1]) shapebench.engine.step(side, values[0])", steps)

    def middle(self, side):
        """The vertex in the middle of the beam's upper face."""
        points = self.points(side)
        return int((points[:, 1] - numpy.abs(points[:, 0]) - numpy.abs(points[:, 2])).argmax())

    def test_the_menu_says_what_they_are(self):
        groups = self.ask("return [...document.querySelectorAll('#scene optgroup')].map((group) => "
                          "[group.label, [...group.children].map((option) => option.value)])")
        groups = dict(groups)
        self.assertEqual(sorted(groups["Elastic body"]), ["balljoint", "beam-elastic"])  # those that the page has
        self.assertIn("penguin", groups["FastLSM"])
        self.assertIn("bunny", groups["Thin shell"])
        self.assertFalse(any("rabbit" in names for names in groups.values()))
        titles = [option.text for option in Select(self.driver.find_element("id", "scene")).options]
        self.assertIn("Elastic shell of a bunny, held at its feet, its ears pulled to and fro", titles)
        for scene, name in (("beam-elastic", "Elastic body"), ("hand", "Octree")):
            self.open(scene)
            seen = {place.text for place in self.driver.find_elements("css selector", "[data-name='1']")}
            self.assertEqual(seen, {name})
            view = self.driver.find_element("id", "view-1").get_attribute("aria-label")
            self.assertTrue(view.startswith(name), view)

    def test_one_that_is_not_there_is_said_to_be_so(self):
        self.open("rabbit")
        self.assertIn("found when the page is built", self.ask("return shapebench.engine.absent(1)"))
        self.assertFalse(self.ask("return shapebench.engine.absent(0)"))
        self.ask("shapebench.advance(5)")
        self.assertAlmostEqual(self.figure(0, "time"), 0.05)
        text = self.ask(STILL).replace("box_high = [0.05", "box_high = [0.2")  # held elsewhere: other modes
        self.assertFalse(self.ask("return shapebench.open(values[0], false)", text))
        self.assertIn("found when the page is built", self.ask("return shapebench.engine.absent(1)"))

    def test_a_page_without_says_why(self):
        text = (HERE.parents[1] / "bench/scenes/beam-elastic.cfg").read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder, "curved.cfg")
            scene.write_text(text.replace("meshless = {", 'meshless = { basis = "quadratic";'), encoding="utf-8")
            made = subprocess.run([HERE / "view", scene, "-o", pathlib.Path(folder, "page.html")],
                                  stderr=subprocess.PIPE, text=True, check=False)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertRegex(made.stderr, "no elastic bodies: .*curved.cfg: stored bodies are of the linear basis")
        self.assertNotIn("is not there", made.stderr)

    def test_damaged_ones_are_refused(self):
        said = self.ask("""
            const { engine } = shapebench, [body] = engine.bodies, other = body.slice(), old = body.slice();
            other[body.length >> 1] ^= 1;
            old['shapebench elastic body '.length] = '0'.charCodeAt(0);
            return [other, body.slice(0, -9), new Uint8Array(5), old, body].map((one) => engine.takeBody(one));""")
        for line, words in zip(said, ("damaged", "damaged", "no stored", "another version", "")):
            self.assertIn(words, line)
        self.assertEqual(said[-1], "")

    def test_a_drag_moves_both(self):
        """What is dragged is where the pointer is, on both sides, and the elastic body comes back to rest (FastLSM
        swings for minutes)."""
        self.open_still()
        before = [self.points(side) for side in (0, 1)]
        for side in (0, 1):
            top = self.middle(side)
            at = self.ask(WHERE, side, top)
            self.pull(at, (30, -40))
            self.ask("shapebench.advance(30)")
            now = self.ask(WHERE, side, top)
            self.assertLess(abs(now["x"] - at["x"] - 30) + abs(now["y"] - at["y"] + 40), 6, SIDES[side])
            moved = [self.away(s, before) for s in (0, 1)]
            self.assertGreater(moved[1 - side], 0.5 * moved[side], "the other side stays behind")
            ActionChains(self.driver).release().perform()
            self.step(600)
            self.assertLess(self.away(1, before), 0.01, "has not come back")
            self.ask("shapebench.open(shapebench.text(), false)")

    def pulled(self, steps, wait):
        """How fast the beam's middle goes upwards in the step after a hand let it go that had pulled it in so many
        steps and then waited; cells a step."""
        self.open_still(("-9.81", "0.0"), ("young = 1.0e6", "young = 1.0e4"))
        top, cell = self.middle(1), self.figure(1, "cell")
        start = self.points(1)[top]
        grip = self.ask("return shapebench.engine.grab(1, values[0], 2 * values[1])", top, cell)
        for step in range(1, steps + 1):
            self.ask("shapebench.engine.drag(values[0], [0, values[1], 0])", grip, step / steps * cell)
            self.step(1)
        self.step(wait)
        held = self.points(1)[top]
        self.assertLess(numpy.abs(held - start - [0, cell, 0]).max(), 0.2 * cell)
        self.ask("shapebench.engine.release(values[0])", grip)
        self.step(1)
        return (self.points(1)[top] - held)[1] / cell

    def test_a_pin_stays_and_a_throw_goes_on(self):
        """A hand that waits holds what it has; what is let go in its motion goes on, else it goes back."""
        self.assertGreater(self.pulled(5, 0), 0.01)
        self.assertLess(self.pulled(5, 200), -0.01)

    def test_random_gestures_stay_finite(self):
        for name in ("beam-elastic", "balljoint"):
            self.open(name)
            self.assertTrue(self.ask(GESTURES, 400), name)

    def test_youngs_modulus_is_exact(self):
        """Sag goes as its inverse, frequency as its root; a knob that is turned leaves motion as it was."""
        text = self.open_still(("amplitude", "amplitude"))  # with gravity
        top = self.middle(1)
        rest = self.ask("return Array.from(shapebench.inside.data.rest(1).points)")[3 * top + 1]
        self.step(1500)
        sag = rest - self.points(1)[top][1]
        before = self.points(1)
        stiff = text.replace("young = 1.0e6", "young = 4.0e6")
        self.assertFalse(self.ask("return shapebench.open(values[0], true)", stiff))
        self.ask("shapebench.pause()")
        self.assertLess(self.away(1, {1: before}), 0.01)
        self.step(1500)
        self.assertAlmostEqual((rest - self.points(1)[top][1]) / sag, 0.25, delta=0.005)
        periods = [self.period(value) for value in ("1.0e6", "4.0e6")]
        self.assertAlmostEqual(periods[0] / periods[1], 2, delta=0.1)

    def period(self, young):
        """Of the beam's swinging in its middle after gravity is turned on, in steps of 2 ms."""
        self.open_still(("young = 1.0e6", f"young = {young}"), ("h = 0.01", "h = 0.002"), ("damping = 0.02", "damping = 0.0"))
        heights = self.ask("""
            const { engine } = shapebench, heights = [];
            for (let i = 0; i < 150; i++) {
                engine.step(1, 1);
                heights.push(engine.surface(1).points[3 * values[0] + 1]);
            }
            return heights;""", self.middle(1))
        lows = [i for i in range(1, 149) if heights[i] < heights[i - 1] and heights[i] <= heights[i + 1]]
        return lows[0]

    def test_knobs_that_are_not_there_are_hidden(self):
        self.open("beam-elastic")
        shown = {knob.get_attribute("id") for knob in
                 self.driver.find_elements("css selector", "[id|=knob]:is(input, select)") if knob.is_displayed()}
        self.assertIn("knob-meshless-young", shown)
        self.assertFalse([name for name in shown if "octree" in name or "epsilon" in name])
        touch = self.driver.find_element("css selector", "#tools [value=touch]")
        self.assertFalse(touch.is_enabled())
        shown = sorted(shown, key=lambda name: (name == "knob-engine", name))  # after which it is elastic no more
        for name in shown:  # each of them does something, and nothing is refused
            before = self.ask("return shapebench.text()")
            knob = self.driver.find_element("id", name)
            down = Keys.ARROW_UP if name == "knob-engine" else Keys.ARROW_DOWN  # its own is the last
            knob.send_keys(down if knob.tag_name == "select" else Keys.ARROW_LEFT * 3)
            after = self.ask(CHANGED, before)
            self.assertIsNotNone(after, name)
            self.assertFalse(self.driver.find_element("id", f"{name}-note").text, name)
            self.assertFalse(self.ask("return shapebench.engine.absent(1)"), name)
            self.ask("shapebench.advance(5)")
            self.assertTrue(math.isfinite(self.figure(1, "kinetic")), name)
        self.open("hand")
        self.assertTrue(touch.is_enabled())
        self.assertFalse(self.driver.find_element("id", "knob-meshless-young").is_displayed())

    def test_a_tool_goes_with_its_engine(self):
        """A hand that touches pulls where nothing gets finer; one that cuts says that FastLSM alone is cut."""
        self.open("hand")
        self.driver.find_element("css selector", "#tools [value=touch]").click()
        self.open("beam-elastic")
        self.assertTrue(self.driver.find_element("css selector", "#tools [value=pull]").is_selected())
        self.driver.find_element("css selector", "#tools [value=cut]").click()
        self.ask(SETTLE)
        self.assertIn("FastLSM alone is cut", self.driver.find_element("id", "status").text)
        self.assertEqual(self.ask("return [0, 1].map((side) => shapebench.engine.mayCut(side))"), [True, False])
        self.driver.find_element("css selector", "#tools [value=pull]").click()

    def test_its_inside(self):
        """Nodes move with the body; the cover of one is as wide as the octants that it is of, and says what it holds."""
        self.open("beam-elastic")
        self.ask("shapebench.advance(20)")
        nodes = numpy.array(self.ask("return [...shapebench.inside.data.points(1)]")).reshape(-1, 3)
        self.assertEqual(len(nodes), self.figure(1, "particles"))
        skin = self.points(1)
        self.assertTrue((nodes > skin.min(axis=0)).all() and (nodes < skin.max(axis=0)).all())
        middle = int(numpy.abs(nodes - nodes.mean(axis=0)).sum(axis=1).argmin())
        mark = self.ask("const m = shapebench.inside.data.mark(1, values[0]); return { count: m.count, boxes: [...m.boxes], "
                        "members: [...m.members] }", middle)
        box = numpy.array(mark["boxes"][:24]).reshape(8, 3)
        edges = [numpy.linalg.norm(box[1 << d] - box[0]) for d in range(3)]
        self.assertLess(max(edges) - min(edges), 1e-6)
        members = nodes[mark["members"][::3]]
        self.assertIn(middle, mark["members"][::3])
        self.assertEqual(len(members), mark["count"])
        self.assertGreaterEqual(mark["count"], 27)
        self.assertLess(numpy.abs(members - nodes[middle]).max(), 0.75 * max(edges))
        numpy.testing.assert_allclose(box.mean(axis=0), nodes[middle], atol=1e-6)
        self.toggle_inside()
        words = self.marked(1)
        self.assertRegex(words, r"^Node \d+: it moves what is in its cover, where \d+ nodes stand$")
        self.toggle_inside()
        self.ask("shapebench.advance(1)")

    def test_its_figures(self):
        self.open("beam-elastic")
        self.ask("shapebench.advance(60)")
        cells = [cell.text for cell in self.driver.find_elements("css selector", "#stages td:nth-child(3)")]
        self.assertRegex(cells[1], r"^\d+ %, motion$")
        self.assertRegex(cells[4], r"^\d+ %, skin$")
        self.assertEqual([cells[0], *cells[2:4]], ["–"] * 3)
        mass = 0.56 * 0.12 * 0.12 * 1000  # of the beam, kg, on both sides
        for side in (0, 1):
            energy, momentum = self.figure(side, "kinetic"), self.figure(side, "momentum")
            self.assertTrue(0 < momentum ** 2 <= 2 * 1.05 * mass * energy, SIDES[side])  # Cauchy and Schwarz
