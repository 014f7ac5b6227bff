"""Meshes of one's own on the page: what their bytes make is the same as in the program, mesh, particles or the line that
refuses them; what was open goes on where a file is refused; a page carries its mesh."""
import base64
import os
import pathlib
import re
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor

from page_case import HERE, PROGRAM, PageCase, make_page

import corpus_files
import corpus_gltf
import test_corpus

SHARED = pathlib.Path(os.environ.get("SHAPEBENCH_MESHES", HERE.parents[2] / "shared" / "meshes"))
SOME = ("bad_house_ngons.obj", "bad_huge_coordinates_city.obj", "bad_cycloidal.ply", "bad_rounding_gaps.STL",
        "bad_hourglass_one_hole.stl", "bunny_zipper_flipped.ply", "hand_closed.obj")

CASES = {case.name: case for case in corpus_files.cases() + corpus_gltf.cases() if not case.points}
DROPPED = [CASES[name] for name in (
    "obj-plain-near.obj", "obj-plain-gz.obj.gz", "off-colours-near.off", "ply-plain-ascii.ply",
    "ply-plain-binary_big_endian.ply", "stl-plain-near.stl", "stl-binary-solid-near.stl", "gltf-beside.gltf", "gltf-trs.glb")]
OBJ, OFF = (CASES[f"{suffix}-plain-near.{suffix}"].data for suffix in ("obj", "off"))
BAD = {
    "empty.obj": (b"", "the file is empty"),
    "open.obj": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "no inside to fill"),
    "lost.gltf": (CASES["gltf-beside.gltf"].data, "'b c.bin'"),
    "mesh.dae": (b"<COLLADA>", "the page cannot open it"),
    "no name": (b"x", "the page cannot open it"),
    "bad.cfg": (b'mesh = "shape:hand"; particles = 500; w = 99;', "'w' must be"),
}


def particles_of_program(path):
    """Those of a mesh that the program drops, as it says."""
    ran = subprocess.run([PROGRAM, "run", path, "--no-output", "--frames", "0"], stdout=subprocess.PIPE,
                         stderr=subprocess.STDOUT, text=True, check=False)
    found = re.search(r": (\d+) particles, (\d+) unique regions", ran.stdout)
    return (int(found[1]), int(found[2])) if found else ran.stdout


class Meshes(PageCase):
    def drop(self, *files):
        """Drops files, each a name and bytes, at once; what the page says of them."""
        return self.ask(DROP, [[name, base64.b64encode(data).decode()] for name, data in files])

    def count(self):
        return int(self.figure(0, "particles")), int(self.figure(0, "regions"))

    def opens(self, name, data, wanted, *beside):
        with self.subTest(name):
            self.assertEqual(self.drop((name, data), *beside), "")
            self.assertEqual(self.count(), wanted)
            self.assertIn(f"{name} dropped on the ground", self.driver.find_element("id", "title").text)

    def test_corpus(self):
        """Every file is read as by the program, to the 12 digits that it prints, or refused in the same words."""
        def by_program(name):
            path = os.path.join(folder, name)
            facts, said = test_corpus.read_by_program(PROGRAM, path)
            if not facts:
                return [None, said.replace(path, os.path.basename(name))]
            return [[*(facts[count] for count in test_corpus.COUNTS), *facts["low"], *facts["high"], facts["volume"]], ""]

        with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
            corpus_files.write(CASES.values(), folder)
            for case, wanted in zip(CASES.values(), pool.map(by_program, CASES)):
                with self.subTest(case.name):
                    files = {case.name: case.data, **case.beside}
                    facts, said = self.ask(READ, [[os.path.basename(name), base64.b64encode(data).decode()]
                                                  for name, data in files.items()])
                    self.assertEqual([facts and [fact and float(f"{fact:.12g}") for fact in facts], said], wanted)

    def test_formats(self):
        """A file of every format is a body of as many particles as in the program, and moves: it falls."""
        with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
            corpus_files.write(DROPPED, folder)
            paths = [pathlib.Path(folder, case.name) for case in DROPPED]
            for case, wanted in zip(DROPPED, pool.map(particles_of_program, paths)):
                self.opens(case.name, case.data, wanted, *case.beside.items())
        before = [self.points(side)[:, 1].mean() for side in (0, 1)]
        self.ask("shapebench.advance(10)")
        for side in (0, 1):
            self.assertLess(self.points(side)[:, 1].mean(), before[side])

    def test_by_hand(self):
        """What a hand does: a file that comes from outside the page, over it and let go, or is chosen."""
        with tempfile.TemporaryDirectory() as folder:
            for name, bring in (("dropped.obj", self.drag_in), ("chosen.obj", self.choose)):
                path = pathlib.Path(folder, name)
                path.write_bytes(OBJ)
                bring(path)
                self.ask("await shapebench.files.last; shapebench.pause()")
                self.assertIn(f"{name} dropped on", self.driver.find_element("id", "title").text)
                self.assertEqual(self.ask("return document.body.className"), "")

    def drag_in(self, path):
        for kind in ("dragEnter", "dragOver", "drop"):
            self.driver.execute_cdp_cmd("Input.dispatchDragEvent", {"type": kind, "x": 200, "y": 300, "data": {
                "items": [], "files": [str(path)], "dragOperationsMask": 1}})
            if kind == "dragOver":
                self.assertEqual(self.ask("return document.body.className"), "dropping")

    def choose(self, path):
        self.driver.find_element("id", "files").send_keys(str(path))

    def test_what_is_no_mesh_is_said(self):
        """... in one line that names the file, and the scene that was open goes on."""
        self.drop(("plain.obj", OBJ))
        text, count = self.ask("return shapebench.text()"), self.count()
        for name, (data, part) in BAD.items():
            with self.subTest(name):
                said = self.drop((name, data))
                self.assertIn(part, said)
                self.assertNotIn("\n", said)
                self.assertTrue(said.startswith("scene:" if name == "bad.cfg" else f"{name}: "), said)
                self.assertNotIn("Error", said)
        self.assertIn("no inside to fill", self.drop(("plain.obj", BAD["open.obj"][0])))  # of the same name
        self.assertEqual(self.ask("return shapebench.text()"), text)
        self.assertFalse(self.ask("return shapebench.open(shapebench.text().replace('w = 2', 'w = 3'), true)"))
        self.assertEqual(self.count(), count)
        self.assertIn("left out: ", self.drop(("lines.obj", OBJ + b"l 1 2\n")))

    def test_scenes_with_meshes(self):
        """A scene file opens with its mesh, dropped with it or after it; its link says what it lacks."""
        scene = b'mesh = "meshes/of scene.obj"; particles = 600; w = 3;'
        said = self.drop(("my.cfg", scene))
        self.assertIn("'of scene.obj' is not in this page", said)
        self.assertEqual(self.drop(("of scene.obj", OBJ)), "")
        self.assertEqual(self.ask("return shapebench.text()"), scene.decode())
        self.assertLess(abs(self.count()[0] - 600), 60)
        self.assertEqual(self.drop(("my.cfg", scene + b"damping = 0.3;"), ("of scene.obj", OBJ)), "")
        link, said = self.copy_link()
        self.assertIn("does not carry the mesh", said)
        self.driver.get("about:blank")
        self.driver.get(link)
        said = self.ask("shapebench.pause(); "
                        "return document.getElementById('status').textContent")
        self.assertIn("'of scene.obj' is not in this page", said)
        self.assertEqual(self.drop(("of scene.obj", OBJ)), "")
        self.assertIn("damping = 0.3;", self.ask("return shapebench.text()"))

    def test_a_trap_leaves_the_mesh(self):
        """An engine that stops begins anew with the mesh that was open."""
        self.drop(("plain.obj", OBJ))
        count = self.count()
        said = self.ask("const { call } = shapebench.engine; shapebench.engine.call = { ...call, view_open() {"
                        "throw new Error('a trap'); } }; return shapebench.open(shapebench.text(), false)")
        self.assertIn("has begun anew: a trap", said)
        self.assertEqual(self.count(), count)

    def test_shared_meshes(self):
        if not SHARED.is_dir():
            print(f"skipped: no meshes in {SHARED}: SHAPEBENCH_MESHES names their folder", flush=True)
            return
        paths = [SHARED / name for name in SOME]
        with ThreadPoolExecutor(2) as pool:
            for path, wanted in zip(paths, pool.map(particles_of_program, paths)):
                self.opens(path.name, path.read_bytes(), wanted)

    def test_a_page_carries_its_mesh(self):
        """What `view` is given a mesh or a scene with a mesh file opens with it; others are refused."""
        with tempfile.TemporaryDirectory() as folder:
            files = {"mine.OFF": OFF, "mine.cfg": b'particles = 500;\nmesh = "mine.OFF";\n',
                     "lost.cfg": b'particles = 500;\nmesh = "lost.obj";\n', "mine.dae": b"", "bad.ply": b"ply",
                     "none.stl": b"",
                     "mine.gltf": CASES["gltf-beside-below.gltf"].data, **CASES["gltf-beside-below.gltf"].beside}
            pathlib.Path(folder, "sub").mkdir()
            for name, data in files.items():
                pathlib.Path(folder, name).write_bytes(data)
            page = pathlib.Path(folder, "page.html")
            opened = [("mine.OFF", "dropped"), ("mine.gltf", "dropped"), ("mine.cfg", "particles = 500")]
            refused = [("lost.cfg", "lost.obj"), ("mine.dae", "cannot open it"), ("none.stl", "an empty one")]
            if (HERE.parents[1] / "build" / "shapebench").exists():  # which reads it first
                refused.append(("bad.ply", "bad.ply: "))
            else:
                opened.append(("bad.ply", "shape:hand"))
            for name, part in opened:
                make_page(page, pathlib.Path(folder, name))
                self.visit(page, part, "bad.ply: " if name == "bad.ply" else "")
            for name, part in refused:
                ran = subprocess.run([HERE / "view", pathlib.Path(folder, name), "-o", page, "--overwrite"],
                                     stderr=subprocess.PIPE, text=True, check=False)
                self.assertEqual(ran.returncode, 3, ran.stderr)
                self.assertIn(part, ran.stderr)

    def visit(self, page, part, says):
        """Looks at another page, and again by a link to it, and comes back."""
        before, address = self.driver.current_url, page.as_uri()
        for _ in range(2):
            self.driver.get("about:blank")
            self.driver.get(address)
            text, said = self.ask("shapebench.pause(); return [shapebench.text(), "
                                  "document.getElementById('status').textContent]")
            self.assertIn(part, text)
            self.assertEqual(said[:len(says) or None], says)
            address = self.copy_link()[0]
        self.driver.get(before)
        self.ask("shapebench.pause()")

    def copy_link(self):
        """The link, and what is said of it."""
        return self.ask("document.getElementById('link').click(); await new Promise((done) => "
                        "setTimeout(done, 300)); return [location.href, "
                        "document.getElementById('status').textContent]")


READ = """
const { given, call } = shapebench.engine;
const bytes = (base64) => Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
const refused = given.read(values[0].map(([name, base64]) => ({ name, bytes: bytes(base64) })));
return [refused ? null : shapebench.engine.doubles(call.view_given_facts(), 15), refused];
"""

DROP = """
const data = new DataTransfer();
for (const [name, base64] of values[0])
    data.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
window.dispatchEvent(new DragEvent('drop', { dataTransfer: data, cancelable: true }));
await shapebench.files.last;
shapebench.pause();
return document.getElementById('status').textContent;
"""
