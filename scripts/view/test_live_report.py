"""A report in a browser: its cards open the page in it, and it fits its window."""
import pathlib
import subprocess
import tempfile

from page_case import PROGRAM, PageCase


class LiveReport(PageCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.page = self.driver.current_url
        self.addCleanup(self.go_back)

    def go_back(self):
        self.driver.get("about:blank")
        self.driver.get(self.page)
        self.ask("shapebench.pause()")

    def test_a_button_opens_its_scene(self):
        scene, rows, report = self.folder / "mine.cfg", self.folder / "rows.h5", self.folder / "report.html"
        scene.write_text('mesh = "shape:block"; particles = 60; w = 1;\n')
        subprocess.run([PROGRAM, "tables", "--scene", "penguin", "--scene", scene, "--repeats", "2", "--quiet", "-o",
                        rows], check=True, stdout=subprocess.DEVNULL)
        subprocess.run([PROGRAM, "report", rows, "--quiet", "-o", report], check=True)
        self.driver.get(report.as_uri())
        names, text, moved, said = self.ask(PRESS)
        self.assertEqual(names, ["penguin", "mine"])
        self.assertIn('mesh = "shape:penguin"', text)
        self.assertGreater(moved, 0.01)
        self.assertEqual(said[0], "")
        self.assertIn("is not built in", said[1])

    def test_it_fits_its_window(self):
        """At either width nothing but tables and figures scrolls sideways, in their boxes; at the wider no table must."""
        report = self.folder / "report.html"
        subprocess.run([PROGRAM, "report", "--no-page", *PUBLISHED, "--quiet", "-o", report], check=True)
        self.addCleanup(self.driver.execute_cdp_cmd, "Emulation.clearDeviceMetricsOverride", {})
        for width in (1400, 390):
            self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
                "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500})
            self.driver.get(report.as_uri())
            whole, window, tables, wrapped = self.ask(FIT)
            self.assertEqual((whole, window), (width, width))
            self.assertEqual(wrapped, [])
            if width == 1400:
                self.assertEqual(tables, [])


HERE = pathlib.Path(__file__).resolve().parent
PUBLISHED = sorted((HERE.parent.parent / "results" / "published").glob("*.h5"))

# How wide the page and its window are, which tables are wider than their boxes, and which numbers are on two lines.
FIT = """
const root = document.documentElement;
const wide = [...document.querySelectorAll('.wide')].filter((box) => !box.closest('details') && box.scrollWidth > box.clientWidth);
const numbers = [...document.querySelectorAll('.wide td:not([class])')].filter((cell) => !cell.textContent.includes('\\n'));
const broken = numbers.filter((cell) => {
    const range = document.createRange();
    range.selectNodeContents(cell);
    return new Set([...range.getClientRects()].map((box) => Math.round(box.top))).size > 1;
});
return [root.scrollWidth, innerWidth, wide.map((box) => box.getAttribute('aria-label')), broken.map((cell) => cell.textContent)];
"""

# Presses each button; what the page has then, how far it moves, and what is said.
PRESS = """
const buttons = [...document.querySelectorAll('.live button')];
const said = [];
for (const button of buttons) {
    const status = button.closest('.live').querySelector('[role=status]');
    status.textContent = '-';
    button.click();
    while (/^(-|Opening.*)$/.test(status.textContent)) await new Promise((done) => setTimeout(done, 20));
    said.push(status.textContent);
}
const page = document.querySelector('.live iframe').contentWindow.shapebench;
page.pause();
const before = page.engine.surface(0).points.slice();
page.advance(5);
const moved = Math.max(...page.engine.surface(0).points.map((x, i) => Math.abs(x - before[i])));
return [buttons.map((button) => button.textContent), page.text(), moved, said];
"""
