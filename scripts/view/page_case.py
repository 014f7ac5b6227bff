"""What tests of the page share: one page, with the hand in it, in a real browser without a screen."""
import atexit
import functools
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

try:
    import browser
    import numpy
    from selenium.webdriver.common.action_chains import ActionChains
except ImportError as missing:
    print(f"skipped: no {missing.name}: install chromium, chromium-driver, python3-selenium and python3-numpy")
    sys.exit(77)

for needed, package in (("wasm-ld", "lld"), ("llvm-ar", "llvm"), ("clang", "clang")):
    if not shutil.which(needed):
        print(f"skipped: install {package}")
        sys.exit(77)
HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parents[1] / "lib" / "mesh"))  # corpus of mesh files
PROGRAM = pathlib.Path(sys.argv[1]).resolve()
SIDES = ("fastlsm", "octree")


def make_page(page, *what):
    """Makes this clone's page as a user does; where its packages are missing, the test is skipped."""
    made = subprocess.run([HERE / "view", *what, "-o", page, "--overwrite"], stdin=subprocess.DEVNULL,
                          env={**os.environ, "SHAPEBENCH_PAGE_OF_CLONE": "1"})
    if made.returncode == 3:
        raise unittest.SkipTest("what the page is built with is not here")
    made.check_returncode()


@functools.cache
def open_page():
    """The browser with the page, the same for all tests."""
    folder = tempfile.TemporaryDirectory()
    atexit.register(folder.cleanup)
    page = pathlib.Path(folder.name) / "page.html"
    make_page(page, "hand")
    driver = browser.start(1000, 640)
    atexit.register(driver.quit)
    driver.get(page.as_uri())
    return driver


class PageCase(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.driver = open_page()
        cls.ask("shapebench.pause()")

    def setUp(self):
        self.ask("document.getElementById('more').open = true")  # all knobs

    @classmethod
    def ask(cls, body, *values):
        """What the body of an asynchronous function returns, in the page."""
        return browser.ask(cls.driver, f"await globalThis.shapebench?.ready.catch(() => 0); {body}", *values)

    def open(self, name):
        refused = self.ask("const e = shapebench.engine; const no = await shapebench.open("
                           "e.sceneText(values[0]), false); shapebench.pause(); scrollTo(0, 0); return no", name)
        self.assertFalse(refused, f"{name}: {refused}")
        self.driver.find_element("id", "look").click()  # all of it in the picture

    def points(self, side):
        flat = self.ask("return Array.from(shapebench.engine.surface(values[0]).points)", side)
        return numpy.array(flat).reshape(-1, 3)

    def figure(self, side, name):
        return self.ask("return shapebench.engine.figure(values[0], values[1])", side, name)

    def away(self, side, before):
        """How far a vertex is from where it was, at most, in cells."""
        return numpy.abs(self.points(side) - before[side]).max() / self.figure(side, "cell")

    def pull(self, at, by):
        """Presses at a place of the window and moves, without letting go."""
        chain = ActionChains(self.driver, duration=50)
        chain.w3c_actions.pointer_action.move_to_location(round(at["x"]), round(at["y"]))
        chain.w3c_actions.pointer_action.pointer_down()
        chain.w3c_actions.pointer_action.move_to_location(round(at["x"]) + by[0], round(at["y"]) + by[1])
        chain.perform()
        self.ask("await new Promise((done) => requestAnimationFrame(() => setTimeout(done, 100)))")  # it is there

    def toggle_inside(self):
        """Shows or hides all that the menu of insides has."""
        for name in ("lattice", "region", "rest", "difference"):
            self.driver.find_element("id", f"inside-{name}").click()

    def marked(self, steps):
        """What is said of the particle or node in the middle of the second view, some steps later."""
        view = self.driver.find_element("id", "view-1")
        view.click()
        view.send_keys("i")
        self.ask("shapebench.advance(values[0])", steps)
        return self.driver.find_element("css selector", "#view-1 .marked").text

    def tearDown(self):
        self.assertEqual(self.driver.get_log("browser"), [], "messages on the console")


# Waits until what has been asked of the page is done.
SETTLE = """
for (let i = 0; i < 8; i++) await new Promise((done) => requestAnimationFrame(() => setTimeout(done, 30)));
while (shapebench.busy()) await new Promise((done) => setTimeout(done, 20));
shapebench.pause();
"""

# Where a vertex is in the window.
WHERE = """
const at = shapebench.project(values[0], values[1]);
const canvas = document.getElementById('canvas'), box = canvas.getBoundingClientRect();
return { x: box.left + at.x * box.width / canvas.width, y: box.top + at.y * box.height / canvas.height };
"""

GESTURES = """
const e = shapebench.engine, held = [];
let seed = 1;
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
for (let i = 0; i < values[0]; i++) {
    const side = i % 2, count = e.surface(side).points.length / 3;
    if (held.length < 3) held.push(e.grab(side, Math.floor(random() * count), random()));
    e.drag(held[held.length - 1], [0, 1, 2].map(() => 20 * (random() - 0.5)));
    e.step(side, 1);
    if (random() < 0.3) e.release(held.shift());
}
held.forEach((grip) => e.release(grip));
return [0, 1].every((side) => e.surface(side).points.every(Number.isFinite));
"""

# The scene's text when it is another one, or null after a while.
CHANGED = """
for (let i = 0; i < 100 && (shapebench.text() === values[0] || shapebench.busy()); i++)
    await new Promise((done) => setTimeout(done, 30));
shapebench.pause();
return shapebench.text() === values[0] ? null : shapebench.text();
"""

# Each side's share of 300 vertices that are drawn in its colour, within a pixel, of those in its view.
LOOK = """
const canvas = document.getElementById('canvas'), gl = canvas.getContext('webgl2');
const shares = {}, pixel = new Uint8Array(36), whole = canvas.getBoundingClientRect();
shapebench.advance(1);
for (const side of shapebench.engine.present()) {
    const box = document.getElementById(`view-${side}`).getBoundingClientRect();
    const points = shapebench.engine.surface(side).points; // which takes long of a crowd
    const scale = canvas.width / whole.width, count = points.length / 3;
    let seen = 0, hit = 0;
    for (let i = 0; i < 300; i++) {
        const at = shapebench.project(side, Math.floor(i * count / 300), points);
        const x = at.x - (box.left - whole.left) * scale, y = at.y - (box.top - whole.top) * scale;
        if (!(x > 2 && y > 2 && x < box.width * scale - 2 && y < box.height * scale - 2)) continue;
        gl.readPixels(Math.round(at.x) - 1, Math.round(canvas.height - at.y) - 1, 3, 3, gl.RGBA,
            gl.UNSIGNED_BYTE, pixel);
        seen++;
        hit += [...Array(9).keys()].some((n) => Math.abs(pixel[4 * n] - pixel[4 * n + 2]) > 40);
    }
    shares[side] = [seen, hit];
}
return shares;
"""
