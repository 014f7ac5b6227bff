"""The page inside a report: opened by the buttons beside the tables."""
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
        self.ask("await shapebench.ready; shapebench.pause()")

    def test_a_button_opens_its_scene(self):
        scene, rows, report = self.folder / "mine.cfg", self.folder / "rows.h5", self.folder / "report.html"
        scene.write_text('mesh = "shape:block"; particles = 60; w = 1;\n')
        subprocess.run([PROGRAM, "tables", "--scene", "penguin", "--scene", scene, "--repeats", "2", "--quiet", "-o",
                        rows], check=True, stdout=subprocess.DEVNULL)
        subprocess.run([PROGRAM, "report", rows, "--quiet", "-o", report], check=True)
        self.driver.get(report.as_uri())
        names, text, moved, said = self.ask(PRESS)
        self.assertEqual(names[0], "penguin")
        self.assertIn('mesh = "shape:penguin"', text)
        self.assertGreater(moved, 0.01)
        self.assertEqual(said[0], "")
        self.assertIn("is not built in", said[1])


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
