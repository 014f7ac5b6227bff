"""The page for people who cannot see colours, or use a mouse: axe-core's rules, in both themes and at both widths; and
keys alone."""
import pathlib
import shutil
import subprocess
import tempfile

from selenium.webdriver.common.keys import Keys

from page_case import SETTLE, PageCase

AXE = "axe-core@4.10.2"


class Access(PageCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.axe = None
        with tempfile.TemporaryDirectory() as folder:
            npm = shutil.which("npm")
            got = npm and subprocess.run([npm, "install", "--silent", "--no-audit", "--no-fund", "--ignore-scripts",
                                          "--prefix", folder, AXE], capture_output=True, timeout=120)
            if got and got.returncode == 0:
                cls.axe = (pathlib.Path(folder) / "node_modules/axe-core/axe.min.js").read_text()

    def test_rules(self):
        if not self.axe:
            self.skipTest(f"npm cannot install {AXE} here")
        self.open("hand")
        self.driver.execute_script(self.axe)
        for scene, width, theme in (("hand", 1400, "light"), ("hand", 1400, "dark"), ("hand", 390, "light"),
                                    ("hand", 390, "dark"), ("beam-elastic", 1400, "light"), ("rabbit", 390, "dark")):
            self.driver.set_window_size(width, 900)
            self.open(scene)
            self.ask("document.documentElement.dataset.theme = values[0]", theme)
            self.ask("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
            self.ask(SETTLE)
            with self.subTest(scene=scene, width=width, theme=theme):
                passed, found = self.ask(RULES)
                self.assertEqual(found, [])
                self.assertGreater(passed, 20)  # rules that found something to look at

    def test_keys_reach_everything(self):
        """Tab comes to each control that is shown, and shows that it is there."""
        self.open("hand")
        self.driver.set_window_size(1400, 900)
        self.driver.execute_script("document.activeElement.blur(); scrollTo(0, 0)")
        wanted = set(self.ask(CONTROLS))
        reached = set()
        for _ in range(3 * len(wanted)):
            self.driver.switch_to.active_element.send_keys(Keys.TAB)
            name, outline = self.ask(FOCUSED)
            if name:
                self.assertNotEqual(outline, "none", name)
            reached.add(name)
            if wanted <= reached:
                break
        self.assertEqual(wanted - reached, set())

    def tearDown(self):
        self.driver.set_window_size(1000, 640)
        super().tearDown()


RULES = """
const { passes, violations } = await axe.run();
const tell = ({ id, help, nodes }) => `${id}: ${help}: ${nodes.map((n) => n.html.slice(0, 120)).join(' | ')}`;
return [passes.length, violations.map(tell)];
"""
NAME = "(e) => e.id || e.name || e.textContent.trim().slice(0, 40)"
CONTROLS = f"""
const name = {NAME};
const all = document.querySelectorAll('button, select, input, textarea, summary, [tabindex="0"]');
const radios = new Set();
return [...all].filter((e) => e.checkVisibility() && !e.disabled && e.type !== 'file'
    && !(e.type === 'radio' && (!e.checked))).map(name);
"""
FOCUSED = f"""
const name = {NAME}, e = document.activeElement;
return [e === document.body ? '' : name(e), getComputedStyle(e).outlineStyle];
"""
