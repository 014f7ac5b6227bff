"""Meshes of one's own on the page: of every format and of shared/meshes bodies of as many particles as the program
makes of them; files that are no mesh are said to be so, and what was open goes on; a page carries its mesh."""
import base64
import os
import pathlib
import random
import re
import struct
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor

from page_case import HERE, PROGRAM, PageCase, make_page

SHARED = pathlib.Path(os.environ.get("SHAPEBENCH_MESHES", HERE.parents[2] / "shared" / "meshes"))
SOME = ("bad_house_ngons.obj", "bad_huge_coordinates_city.obj", "bad_cycloidal.ply", "bad_rounding_gaps.STL",
        "bad_hourglass_one_hole.stl", "bunny_zipper_flipped.ply", "hand_closed.obj")

# A prism over a polygon of six corners, one of them concave.
CORNERS = ((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2))
POINTS = [(x, y, z) for z in (0, 0.75) for x, y in CORNERS]
POLYGONS = [(5, 4, 3, 2, 1, 0), (6, 7, 8, 9, 10, 11)] + [(i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6) for i in range(6)]
TRIANGLES = [(0, 2, 1), (0, 3, 2), (0, 4, 3), (0, 5, 4), (6, 7, 8), (6, 8, 9), (6, 9, 10), (6, 10, 11)] + [
    triangle for a, b, c, d in POLYGONS[2:] for triangle in ((a, b, c), (a, c, d))]


def words(*numbers):
    return " ".join(map(str, numbers)) + "\n"


def obj(corner="{0}", polygons=POLYGONS, end="\n"):
    """Corners are numbered from 1 in {0}, and from the end in {1}."""
    lines = [f"v {words(*p)}" for p in POINTS] + ["vt 0 0\n", "vn 0 0 1\n", "# f 1 2 3\n", "usemtl f\n"]
    lines += ["f " + " ".join(corner.format(i + 1, i - len(POINTS)) for i in face) + "\n" for face in polygons]
    return "".join(lines).replace("\n", end).encode()


def off(keyword="OFF\n", more="", polygons=POLYGONS):
    points = "".join(f"{words(*p)[:-1]} {more}\n" for p in POINTS)
    faces = "".join(words(len(face), *face) for face in polygons)
    return f"{keyword}{len(POINTS)} {len(polygons)} 0\n# data\n\n{points}{faces}".encode()


NAMES = {"d": "double", "f": "float", "i": "int", "B": "uchar", "H": "ushort"}


def ply(order=None, number="f", count="B", index="i", polygons=POLYGONS):
    """Of text, or of that byte order; z stands before x, faces before vertices, and with other properties."""
    kind = {None: "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    header = (f"ply\nformat {kind} 1.0\ncomment made by a test\nelement face {len(polygons)}\n"
              f"property list uchar float texture\nproperty list {NAMES[count]} {NAMES[index]} vertex_indices\n"
              f"element edge 1\nproperty int a\nelement vertex {len(POINTS)}\n"
              + "".join(f"property {kind} {name}\n" for kind, name in (
                  ("uchar", "red"), *((NAMES[number], axis) for axis in "zxy"))) + "end_header\n")
    rows = [(f"B2f{count}{len(face)}{index}", (2, 0.5, 0.25, len(face), *face)) for face in polygons]
    rows += [("i", (7,))] + [(f"B3{number}", (255, p[2], p[0], p[1])) for p in POINTS]
    if not order:
        return (header + "".join(words(*row) for _, row in rows)).encode()
    return header.encode() + b"".join(struct.pack(order + form, *row) for form, row in rows)


def stl(binary=None, triangles=TRIANGLES):
    """Of text, or binary with that header."""
    if binary is not None:
        facets = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for i in t for x in POINTS[i]), 0) for t in triangles)
        return binary.ljust(80) + struct.pack("<I", len(triangles)) + facets
    facets = ("facet normal 0 0 0\n outer loop\n" + "".join(f"  vertex {words(*POINTS[i])}" for i in t)
              + " endloop\nendfacet\n" for t in triangles)
    return ("solid vertex facet\n" + "".join(facets) + "endsolid\n").encode()


READABLE = {
    "plain.obj": obj(), "slashes.obj": obj("{0}/1/1"), "normals.OBJ": obj("{1}//1", end="\r\n"),
    "triangles.obj": obj(polygons=TRIANGLES), "returns.obj": obj(end="\r"),
    "plain.off": off(), "one line.off": off("OFF "), "text.ply": ply(), "little.ply": ply("<", "d", "i", "H"),
    "big.ply": ply(">"), "text.stl": stl(), "binary.stl": stl(b"binary"), "solid.STL": stl(b"solid but binary"),
}
ONLY_HERE = {"colour.off": off("# of one's own\nCOFF\n", "255 0 0 255")}  # Assimp reads none
BAD = {
    "empty.obj": (b"", "the file is empty"),
    "words.obj": (b"these are words\n", "holds no triangles"),
    "points.obj": (b"v 0 0 0\nv 1 1 1\n", "only points or lines"),
    "nan.obj": (obj() + b"v nan 0 0\n", "the x of a vertex is not a finite number"),
    "infinite.obj": (obj() + b"v 0 1e999 0\n", "the y of a vertex is not a finite number"),
    "word.obj": (b"v 0 0 0\nv 1 x 0\nv 0 1 0\nf 1 2 3\n", "line 2: 'x' where a number should be"),
    "short.obj": (b"v 0 0 0\nv 1 0\n", "line 2: a number is missing"),
    "zero.obj": (obj() + b"f 0 1 2\n", "names vertex 0"),
    "beyond.obj": (obj() + b"f 1 2 13\n", "names a vertex that is not there"),
    "below.obj": (obj() + b"f 1 2 -13\n", "names a vertex that is not there"),
    "huge.obj": (obj() + b"f 1 2 1" + 400 * b"0", "names a vertex that is not there"),
    "one.obj": (obj(polygons=TRIANGLES[:1]), "no inside to fill"),
    "flat.obj": (b"v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "all vertices are at one point"),
    "cut.off": (off()[:-20], "cut off"),
    "four.off": (off("4OFF\n", "1"), "not of three dimensions"),
    "no keyword.off": (off(""), "does not begin with 'OFF'"),
    "counts.off": (b"OFF\n99999999999 99999999999 0\n0 0 0\n", "cut off"),
    "cut.ply": (ply()[:-8], "cut off"),
    "cut big.ply": (ply(">")[:-8], "cut off"),
    "more.ply": (ply() + b"1 2 3\n", "more numbers than its header says"),
    "type.ply": (ply().replace(b"double", b"number").replace(b"float", b"number"), "'number' is none of PLY's"),
    "counts.ply": (ply("<").replace(b"face 8", b"face 99999999"), "cut off"),
    "axes.ply": (ply().replace(b"float y", b"float u"), "no x, y and z"),
    "cut.stl": (stl()[:-40], "it ends within a facet"),
    "cut solid.stl": (stl(b"solid")[:-1], "facets, which take"),
    **{f"bytes.{suffix}": (random.Random(1).randbytes(3000), "") for suffix in ("obj", "off", "ply", "stl")},
    "mesh.glb": (b"glTF", "a page opens meshes"),
    "no name": (b"x", "a page opens meshes"),
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

    def opens(self, name, data, wanted):
        with self.subTest(name):
            self.assertEqual(self.drop((name, data)), "")
            self.assertEqual(self.count(), wanted)
            self.assertIn(f"{name} dropped on the ground", self.driver.find_element("id", "title").text)

    def test_formats(self):
        """The same body in every format is the program's, and moves: it falls."""
        with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
            paths = [pathlib.Path(folder, name) for name in READABLE]
            for path in paths:
                path.write_bytes(READABLE[path.name])
            for path, wanted in zip(paths, pool.map(particles_of_program, paths)):
                self.opens(path.name, READABLE[path.name], wanted)
        for name, data in ONLY_HERE.items():
            self.opens(name, data, wanted)
        before = [self.points(side)[:, 1].mean() for side in (0, 1)]
        self.ask("shapebench.advance(10)")
        for side in (0, 1):
            self.assertLess(self.points(side)[:, 1].mean(), before[side])

    def test_by_hand(self):
        """What a hand does: a file that comes from outside the page, over it and let go, or is chosen."""
        with tempfile.TemporaryDirectory() as folder:
            for name, bring in (("dropped.stl", self.drag_in), ("chosen.ply", self.choose)):
                path = pathlib.Path(folder, name)
                path.write_bytes(READABLE[f"text{path.suffix}"])
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
        self.drop(("plain.obj", READABLE["plain.obj"]))
        text, count = self.ask("return shapebench.text()"), self.count()
        for name, (data, part) in BAD.items():
            with self.subTest(name):
                said = self.drop((name, data))
                self.assertIn(part, said)
                self.assertNotIn("\n", said)
                self.assertTrue(said.startswith("scene:" if name == "bad.cfg" else f"{name}: "), said)
                self.assertNotIn("Error", said)
        self.assertIn("no inside to fill", self.drop(("plain.obj", BAD["one.obj"][0])))  # of the same name
        self.assertEqual(self.ask("return shapebench.text()"), text)
        self.assertFalse(self.ask("return shapebench.open(shapebench.text().replace('w = 2', 'w = 3'), true)"))
        self.assertEqual(self.count(), count)

    def test_scenes_with_meshes(self):
        """A scene file opens with its mesh, dropped with it or after it; its link says what it lacks."""
        scene = b'mesh = "meshes/of scene.obj"; particles = 600; w = 3;'
        said = self.drop(("my.cfg", scene))
        self.assertIn("'of scene.obj' is not in this page", said)
        self.assertEqual(self.drop(("of scene.obj", obj())), "")
        self.assertEqual(self.ask("return shapebench.text()"), scene.decode())
        self.assertLess(abs(self.count()[0] - 600), 60)
        self.assertEqual(self.drop(("my.cfg", scene + b"damping = 0.3;"), ("of scene.obj", obj())), "")
        link, said = self.copy_link()
        self.assertIn("does not carry the mesh", said)
        self.driver.get("about:blank")
        self.driver.get(link)
        said = self.ask("await shapebench.ready; shapebench.pause(); "
                        "return document.getElementById('status').textContent")
        self.assertIn("'of scene.obj' is not in this page", said)
        self.assertEqual(self.drop(("of scene.obj", obj())), "")
        self.assertIn("damping = 0.3;", self.ask("return shapebench.text()"))

    def test_a_trap_leaves_the_mesh(self):
        """An engine that stops begins anew with the mesh that was open."""
        self.drop(("plain.obj", obj()))
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
            files = {"mine.OFF": off(), "mine.cfg": b'particles = 500;\nmesh = "mine.OFF";\n',
                     "lost.cfg": b'particles = 500;\nmesh = "lost.obj";\n', "mine.glb": b"glTF", "bad.ply": b"ply"}
            for name, data in files.items():
                pathlib.Path(folder, name).write_bytes(data)
            page = pathlib.Path(folder, "page.html")
            for name, part in (("mine.OFF", "dropped"), ("mine.cfg", "particles = 500"), ("bad.ply", "shape:hand")):
                make_page(page, pathlib.Path(folder, name))
                self.visit(page, part, "bad.ply: has no header" if name == "bad.ply" else "")
            for name, part in (("lost.cfg", "lost.obj"), ("mine.glb", "export it")):
                ran = subprocess.run([HERE / "view", pathlib.Path(folder, name), "-o", page],
                                     stderr=subprocess.PIPE, text=True, check=False)
                self.assertEqual(ran.returncode, 3, ran.stderr)
                self.assertIn(part, ran.stderr)

    def visit(self, page, part, says):
        """Looks at another page, and again by a link to it, and comes back."""
        before, address = self.driver.current_url, page.as_uri()
        for _ in range(2):
            self.driver.get("about:blank")
            self.driver.get(address)
            text, said = self.ask("await shapebench.ready; shapebench.pause(); return [shapebench.text(), "
                                  "document.getElementById('status').textContent]")
            self.assertIn(part, text)
            self.assertEqual(said[:len(says) or None], says)
            address = self.copy_link()[0]
        self.driver.get(before)
        self.ask("await shapebench.ready; shapebench.pause()")

    def copy_link(self):
        """The link, and what is said of it."""
        return self.ask("document.getElementById('link').click(); await new Promise((done) => "
                        "setTimeout(done, 300)); return [location.href, "
                        "document.getElementById('status').textContent]")


DROP = """
const data = new DataTransfer();
for (const [name, base64] of values[0])
    data.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
window.dispatchEvent(new DragEvent('drop', { dataTransfer: data, cancelable: true }));
await shapebench.files.last;
shapebench.pause();
return document.getElementById('status').textContent;
"""
