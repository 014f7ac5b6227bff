"""See inside: what each toggle draws is where the engines have it, and a particle's figures are the engine's."""
import numpy
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from page_case import SIDES, PageCase

TOGGLES = ("lattice", "diagonals", "region", "rest", "difference")


class Inside(PageCase):
    def tearDown(self):
        self.show()
        super().tearDown()

    def show(self, *names):
        """Turns on these toggles alone, as a user does."""
        for name in TOGGLES:
            box = self.driver.find_element("id", f"inside-{name}")
            if box.is_selected() != (name in names):
                box.click()

    def seen(self, side, places):
        """The picture's colours within a pixel of places of the world, [places][9][3]; NaN out of the view."""
        colours = self.ask(SEEN, side, numpy.asarray(places, float).round(6).tolist())
        return numpy.array(colours, float).reshape(-1, 9, 3)

    def changes(self, side, places, before, after):
        """Of the places in the view, the share whose colour is another with one set of toggles than with the
        other."""
        self.show(*before)
        was = self.seen(side, places)
        self.show(*after)
        now = self.seen(side, places)
        there = ~numpy.isnan(was[:, 0, 0])
        self.assertGreater(there.sum(), 20)
        return float((numpy.abs(now - was).max(axis=(1, 2)) > 12)[there].mean())

    def inside(self, what, side):
        return numpy.array(self.ask("return [...shapebench.inside.data[values[0]](values[1])]", what, side))

    def links(self):
        flat, straight = self.ask("const l = shapebench.inside.data.links(0); return [[...l.ends], l.straight]")
        return numpy.array(flat).reshape(-1, 2), straight

    def test_links_and_cells_are_where_they_are(self):
        self.open("hand")
        self.ask("shapebench.advance(3)")
        points = self.inside("points", 0).reshape(-1, 3)
        links, straight = self.links()
        self.assertEqual(len(links), self.figure(0, "links"))
        every = links[:straight:29]
        middles = points[every].mean(axis=1)
        self.assertGreater(self.changes(0, middles, ("region",), ("lattice",)), 0.97)
        self.assertGreater(self.changes(0, middles[::3], ("lattice",), ("lattice", "diagonals")), 0.5)
        cells = self.inside("cells", 1).reshape(-1, 13)
        self.assertEqual(len(cells), self.figure(1, "particles"))
        edges = cells[:, :3] + 0.97 * (cells[:, 3:6] + cells[:, 6:9]) + 0.5 * cells[:, 9:12]
        self.assertGreater(self.changes(1, edges, ("region",), ("lattice",)), 0.9)
        self.assertGreater(self.changes(1, cells[:, :3], ("region",), ("lattice",)), 0.9)  # nodes
        corner = self.ask("const b = shapebench.engine.bounds(); return b.high")  # of the box: nothing is there
        self.assertEqual(self.changes(0, [corner] * 21, ("region",), ("lattice",)), 0)
        legend = self.driver.find_element("css selector", "#view-1 .legend").text
        self.assertEqual(sum(int(row.split()[2]) for row in legend.splitlines()), len(cells))

    def test_a_region_is_the_engines(self):
        """Of the particle under the mouse; FastLSM's counted by walks over the links that hold."""
        self.open("hand")
        self.ask("shapebench.advance(2)")
        self.show("region")
        for side in (0, 1):
            points = self.inside("points", side).reshape(-1, 3)
            at = self.ask(PLACE, side, points[int(points[:, 1].argmax())].tolist())
            chain = ActionChains(self.driver, duration=20)
            chain.w3c_actions.pointer_action.move_to_location(round(at[0]), round(at[1]))
            chain.perform()
            self.ask("shapebench.advance(0)")
            mark = self.ask("const m = shapebench.inside.marks[values[0]]; return { ...m, members: [...m.members] }",
                            side)
            off = numpy.array(self.ask(PLACE, side, points[mark["particle"]].tolist())) - at
            self.assertLess(numpy.abs(off).max(), 7, "another particle is marked than that under the mouse")
            members = numpy.array(mark["members"]).reshape(-1, 3)
            words = self.driver.find_element("css selector", f"#view-{side} .marked").text
            self.assertIn(f" {mark['particle']}: a region of {len(members)} ", words)
            if side == 0:
                self.assertEqual(set(members[:, 0]), self.walk(mark["particle"], 2))
                self.assertIn(f"{members[:, 1].max() + 1} bars in {members[:, 2].max() + 1} plates", words)
            else:
                self.assertIn(f"{members[:, 1].max() + 1} summation nodes", words)
            places = points[members[:, 0]]
            now = self.seen(side, places)
            self.ask("shapebench.inside.forget(); shapebench.inside.again()")
            self.assertGreater((numpy.abs(now - self.seen(side, places)).max(axis=(1, 2)) > 12).mean(), 0.9)

    def walk(self, start, steps):
        """What so many links lead to."""
        links, _ = self.links()
        reached = {start}
        for _ in range(steps):
            near = numpy.isin(links, list(reached))
            reached |= set(links[near.any(axis=1)].ravel())
        return reached

    def test_keys_reach_it(self):
        """Toggles by Tab and Space; i marks what is in the middle of the view in focus."""
        self.open("hand")
        box = self.driver.find_element("id", "inside-rest")
        self.driver.find_element("id", "inside-region").send_keys(Keys.TAB)
        self.assertEqual(self.driver.switch_to.active_element, box)
        box.send_keys(Keys.SPACE)
        self.assertTrue(box.is_selected())
        for side in (0, 1):
            self.driver.find_element("id", f"view-{side}").send_keys("i")
            self.ask("shapebench.advance(0)")
            words = self.driver.find_element("css selector", f"#view-{side} .marked").text
            self.assertRegex(words, r"^(Particle|Node) \d+: a region of \d+ ", SIDES[side])
        self.assertTrue(self.driver.find_element("id", "inside-region").is_selected())

    def test_ghost_and_difference(self):
        """The shape at rest is drawn where the body no longer is; colours are of the distance of each vertex
        from the other side's; after a cut it is said that there are none."""
        self.open("hand")
        self.ask("shapebench.advance(8)")
        rest = numpy.array(self.ask("return [...shapebench.inside.data.rest(0).points]")).reshape(-1, 3)
        now = [self.points(side) for side in (0, 1)]
        far = numpy.linalg.norm(rest - now[0], axis=1).argsort()[-400:]
        self.assertGreater(self.changes(0, rest[far], (), ("rest",)), 0.5)
        apart = numpy.linalg.norm(now[0] - now[1], axis=1) / self.figure(0, "cell")
        for side in (0, 1):
            self.assertLess(numpy.abs(self.inside("difference", side) - apart).max(), 1e-3)
            self.assertGreater(self.changes(side, now[side][::40], (), ("difference",)), 0.9)
            legend = self.driver.find_element("css selector", f"#view-{side} .legend").text
            self.assertGreaterEqual(float(legend.split()[-2]), apart.max())
        self.open("beam-cut")
        self.ask("shapebench.advance(26)")
        self.assertIn("has been cut", self.driver.find_element("css selector", "#inside .note").text)

    def test_many_changes_while_it_shows(self):
        """Other scenes, knobs and a cut with all toggles on; then nothing is left of it when they are off."""
        self.show(*TOGGLES)
        for name in ("beam-cut", "flower", "penguin"):
            self.open(name)
            self.ask("for (const side of [0, 1]) shapebench.inside.pick(side, "
                     "{ x: 0, y: 0, aspect: 1, half: 300 }, Infinity); shapebench.advance(values[0])",
                     26 if name == "beam-cut" else 3)
            text = self.ask("return shapebench.text()")
            self.assertFalse(self.ask("return shapebench.open(values[0], true)", text + "\ngravity = [0, -1, 0];"
                                      if "gravity" not in text else text))
            self.ask("shapebench.advance(2)")
        self.show()
        self.ask("shapebench.advance(1)")
        left = self.ask("return [...document.querySelectorAll('.legend, .marked, #inside .note')]"
                        ".map((element) => element.textContent).join('')")
        self.assertEqual(left, "")


# Where a place of the world is in the window.
PLACE = """
const view = document.getElementById(`view-${values[0]}`).getBoundingClientRect();
const at = shapebench.camera.project(values[1], view.width / view.height);
return [view.left + (at.x + 1) / 2 * view.width, view.top + (1 - at.y) / 2 * view.height];
"""

# The nine pixels around each of the places, drawn now.
SEEN = """
const canvas = document.getElementById('canvas'), gl = canvas.getContext('webgl2');
const view = document.getElementById(`view-${values[0]}`).getBoundingClientRect();
const whole = canvas.getBoundingClientRect(), scale = canvas.width / whole.width;
const all = new Uint8Array(4 * canvas.width * canvas.height), none = Array(27).fill(NaN);
shapebench.advance(0);
gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, all);
return values[1].map((place) => {
    const at = shapebench.camera.project(place, view.width / view.height);
    if (Math.abs(at.x) > 0.99 || Math.abs(at.y) > 0.99) return none;
    const x = Math.floor((view.left - whole.left + (at.x + 1) / 2 * view.width) * scale);
    const y = Math.floor((whole.bottom - view.bottom + (at.y + 1) / 2 * view.height) * scale);
    return [-1, 0, 1].flatMap((v) => [-1, 0, 1].flatMap((u) => {
        const first = 4 * ((y + v) * canvas.width + x + u);
        return [...all.subarray(first, first + 3)];
    }));
});
"""
