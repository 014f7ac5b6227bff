"""What hands do on the page beside pulling: strokes that cut, touches that refine, wind; by mouse and by keys."""
import numpy
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from page_case import SETTLE, SIDES, PageCase


class Tools(PageCase):
    def choose(self, tool):
        self.driver.find_element("css selector", f"#tools input[value={tool}]").click()
        self.ask(SETTLE)

    def tearDown(self):
        self.choose("pull")
        super().tearDown()

    def stroke(self, side, places):
        """Drags over places of a side's view, which go from 0 to 1; the button stays down."""
        box = self.driver.find_element("id", f"view-{side}").rect
        points = [(round(box["x"] + x * box["width"]), round(box["y"] + y * box["height"])) for x, y in places]
        chain = ActionChains(self.driver, duration=100)
        chain.w3c_actions.pointer_action.move_to_location(*points[0])
        chain.w3c_actions.pointer_action.pointer_down()
        for point in points[1:]:
            chain.w3c_actions.pointer_action.move_to_location(*point)
        chain.perform()
        self.ask(SETTLE)

    def let_go(self):
        ActionChains(self.driver).release().perform()
        self.ask(SETTLE)

    def pieces(self, side):
        """Vertices in each piece of a side's surface, which must be closed, largest first."""
        flat = self.ask("return Array.from(shapebench.engine.surface(values[0]).indices)", side)
        triangles = numpy.array(flat).reshape(-1, 3)
        edges = numpy.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        ways = numpy.unique(edges, axis=0, return_counts=True)[1]
        self.assertTrue((ways == 1).all(), "two triangles run along an edge the same way")
        there = {tuple(edge) for edge in edges}
        self.assertTrue(all((b, a) in there for a, b in there), f"{SIDES[side]}: the surface is open")
        parent = list(range(triangles.max() + 1))

        def root(vertex):
            while parent[vertex] != vertex:
                parent[vertex] = parent[parent[vertex]]
                vertex = parent[vertex]
            return vertex

        for a, b in edges:
            parent[root(a)] = root(b)
        return sorted(numpy.unique([root(v) for v in set(triangles.flat)], return_counts=True)[1], reverse=True)

    def test_a_stroke_cuts_the_liver(self):
        """Two closed surfaces on both sides, and the lower one falls."""
        self.open("liver")
        self.assertEqual([len(self.pieces(side)) for side in (0, 1)], [1, 1])
        nodes = self.figure(1, "particles")
        low = [self.points(side)[:, 1].min() for side in (0, 1)]
        self.choose("cut")
        left, top, right, bottom = self.ask(SEEN, 0)
        height = 0.5 * top + 0.5 * bottom
        self.stroke(0, [(left - 0.05, height), ((left + right) / 2, height), (right + 0.05, height)])
        self.let_go()
        self.assertGreater(self.figure(1, "particles"), nodes)
        self.ask("shapebench.advance(40)")
        for side in (0, 1):
            pieces = self.pieces(side)
            self.assertGreaterEqual(len(pieces), 2, SIDES[side])
            self.assertGreater(pieces[1], 50, SIDES[side])
            self.assertLess(self.points(side)[:, 1].min(), low[side] - 2 * self.figure(side, "cell"), SIDES[side])

    def test_a_touch_refines_one_flower(self):
        self.open("flowers")
        nodes = self.figure(1, "particles")
        self.choose("touch")
        left, top, right, bottom = self.ask(SEEN, 1, int(self.points(1)[:, 1].argmax()))
        at = (left, top + 0.005)
        self.stroke(1, [at, at])
        self.ask("shapebench.advance(10)")
        self.assertGreater(self.figure(1, "particles"), nodes)
        self.let_go()
        self.ask("shapebench.advance(30)")
        self.assertEqual(self.figure(1, "particles"), nodes)

    def test_wind_blows_while_it_is_dragged(self):
        self.open("penguin")
        before = [self.points(side)[:, 0].mean() for side in (0, 1)]
        self.choose("wind")
        self.stroke(1, [(0.4, 0.5), (0.9, 0.5)])
        self.ask("shapebench.advance(5)")
        self.let_go()
        for side in (0, 1):
            self.assertGreater(self.points(side)[:, 0].mean(), before[side] + 0.5 * self.figure(side, "cell"))

    def test_keys_cut_too(self):
        self.open("liver")
        self.choose("cut")
        view = self.driver.find_element("id", "view-1")
        view.send_keys("g")
        self.ask(SETTLE)
        whole = self.ask(COUNT)
        view.send_keys(Keys.ARROW_UP * 30, Keys.ENTER)
        self.ask(SETTLE)
        self.assertGreater(self.ask(COUNT), whole)
        self.pieces(1)

    def test_a_crowd_is_not_cut(self):
        self.open("flowers")
        self.choose("cut")
        self.assertIn("alone", self.driver.find_element("id", "status").text)
        opened = self.ask("let n = 0; const e = shapebench.engine, open = e.open.bind(e); "
                          "e.open = (...all) => { n++; return open(...all); }; window.opened = () => n; return n")
        for _ in range(2):  # it is not tried again and again
            self.stroke(0, [(0.1, 0.1), (0.2, 0.1)])
            self.let_go()
        self.assertEqual(self.ask("return window.opened()"), opened)

    def test_the_camera_stays_above_the_floor(self):
        self.open("penguin")
        above = "const { floor } = shapebench.camera; return shapebench.camera.eye()[1] - floor.middle[1]"
        for move in ("orbit(0.1, 0.2)", "zoom(1.2)", "pan(0, 0.1)"):
            self.ask(f"for (let i = 0; i < 40; i++) shapebench.camera.{move}")
            self.assertGreater(self.ask(above), 0, move)

    def test_what_hands_do_ends_with_its_tool_and_its_scene(self):
        self.open("penguin")
        self.choose("wind")
        self.stroke(0, [(0.4, 0.5), (0.8, 0.5)])
        self.choose("pull")  # with the button down
        view = self.driver.find_element("id", "view-0")
        self.assertEqual(self.ask(TRAIL), "")
        self.ask("shapebench.advance(1)")
        eye = self.ask("return shapebench.camera.eye()")
        self.stroke_on((0.5, 0.3))
        self.assertEqual(self.ask("return shapebench.camera.eye()"), eye, "the rest of the drag turns the camera")
        self.let_go()
        self.choose("cut")
        view.send_keys("g", Keys.ARROW_LEFT)
        self.open("liver")
        self.assertEqual(self.ask(TRAIL), "")

    def stroke_on(self, place):
        box = self.driver.find_element("id", "view-0").rect
        chain = ActionChains(self.driver, duration=50)
        chain.w3c_actions.pointer_action.move_to_location(round(box["x"] + place[0] * box["width"]),
                                                          round(box["y"] + place[1] * box["height"]))
        chain.perform()
        self.ask(SETTLE)


COUNT = "return shapebench.engine.surface(1).indices.length"

TRAIL = "return document.querySelector('#view-0 polyline').getAttribute('points')"

# The box that a side's vertices are seen in, or one of them: left, top, right, bottom, as shares of its view.
SEEN = """
const [side, vertex] = values, canvas = document.getElementById('canvas');
const whole = canvas.getBoundingClientRect(), scale = canvas.width / whole.width;
const box = document.getElementById(`view-${side}`).getBoundingClientRect();
const count = shapebench.engine.surface(side).points.length / 3, x = [], y = [];
for (let v = vertex ?? 0; v < (vertex === undefined ? count : vertex + 1); v++) {
    const at = shapebench.project(side, v);
    x.push((at.x / scale + whole.left - box.left) / box.width);
    y.push((at.y / scale + whole.top - box.top) / box.height);
}
return [Math.min(...x), Math.min(...y), Math.max(...x), Math.max(...y)];
"""
