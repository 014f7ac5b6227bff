"""Mesh files of every format whose right answer is known by construction; test_corpus.py compares readers with it."""
import codecs
import gzip
import itertools
import json
import math
import os
import struct
from typing import NamedTuple, Optional

FAR = (10000000.25, -7654321.5, 3000000.125)  # exact in 12 digits
FAR_WHOLE = (10000000, -7654321, 3000000)  # exact in 32 bits
NAN, INF = math.nan, math.inf


class Body(NamedTuple):
    vertices: list
    faces: list  # polygons, counter-clockwise seen from outside
    components: int = 1

    def facts(self):
        """Returns what a reader must find, by the names that `shapebench info --format json` has for it."""
        low, high = ([end(axis) for axis in zip(*self.vertices)] for end in (min, max))
        return {"triangles": sum(len(face) - 2 for face in self.faces), "vertices": len(self.vertices),
                "components": self.components, "low": low, "high": high, "volume": self.volume(),
                **dict.fromkeys(("open_edges", "nonmanifold_edges", "flipped_edges", "degenerate", "duplicates"), 0)}

    def volume(self):
        total = 0
        for face in self.triangles().faces:
            p, q, r = ([x - o for x, o in zip(self.vertices[i], self.vertices[0])] for i in face)
            total += sum(p[d] * (q[d - 2] * r[d - 1] - q[d - 1] * r[d - 2]) for d in range(3))
        return total / 6

    def triangles(self):
        return self._replace(faces=[(face[0], *pair) for face in self.faces for pair in zip(face[1:], face[2:])])

    def mapped(self, function, mirrored=False):
        return self._replace(vertices=[function(*vertex) for vertex in self.vertices],
                             faces=[face[::-1] if mirrored else face for face in self.faces])

    def at(self, offset):
        return self.mapped(lambda *x: tuple(a + o for a, o in zip(x, offset)))

    def and_copy(self, offset):
        faces = [tuple(i + len(self.vertices) for i in face) for face in self.faces]
        return Body(self.vertices + self.at(offset).vertices, self.faces + faces, 2 * self.components)


def prism(outline):
    n = len(outline)
    sides = [(i, (i + 1) % n, (i + 1) % n + n, i + n) for i in range(n)]
    return Body([(x, y, z) for z in (0, 1) for x, y in outline], [tuple(range(n))[::-1], tuple(range(n, 2 * n)), *sides])


PRISM = prism(((0, 0), (1, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2)))  # an L; one corner is straight, one reflex
# Fans from the reflex corner have no flat triangle.
TRIANGLES = PRISM._replace(faces=[(4, 3, 2, 1, 0, 6, 5), (11, 12, 13, 7, 8, 9, 10), *PRISM.faces[2:]]).triangles()
TETRA = Body([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])
ROUND = prism([(round(math.cos(t / 48), 9), round(math.sin(t / 48), 9)) for t in range(300)])


class Case(NamedTuple):
    name: str
    data: bytes
    wanted: Optional[Body]  # None: must be refused
    may_refuse: bool = False  # a refusal is right, too
    says: str = ""  # regular expression: in a refusal, or in the remark on what was left out
    beside: dict = {}  # other files, by name
    points: int = 0  # of a file of points


def files(suffix, body, texts, may_refuse=False, says=""):
    """Yields a case of each text or bytes."""
    for name, text in texts.items():
        data = text if isinstance(text, bytes) else text.encode("latin-1")
        yield Case(f"{suffix}-{name}.{suffix}", data, body, may_refuse, says)


def damaged(suffix, good, changes, others):
    """Yields a case that must be refused of each change of a good text, and of other texts or bytes."""
    texts = {name: good.replace(*change) for name, change in changes.items()}
    assert good not in texts.values()
    yield from files(suffix, None, {"bad-" + name: text for name, text in {"empty": "", **texts, **others}.items()})


def spell(*numbers):
    return " ".join(f"{x:.12g}" for x in numbers)


def zipped(data):
    return gzip.compress(data, mtime=0)


CHANGES = {  # of texts whose lines end with LF
    "crlf": lambda text: text.replace(b"\n", b"\r\n"),
    "cr": lambda text: text.replace(b"\n", b"\r"),
    "cut": lambda text: text.rstrip(b"\n"),
    "bom": lambda text: codecs.BOM_UTF8 + text,
    "bom-crlf": lambda text: codecs.BOM_UTF8 + text.replace(b"\n", b"\r\n"),
    "tabs": lambda text: text.replace(b" ", b"\t"),
    "indent": lambda text: text.replace(b"\n", b"\n \t "),
    "blank": lambda text: text.replace(b"\n", b"  \n\n"),
}


def changed(name, suffix, text, body):
    """Yields the text in other line ends, encodings and wraps."""
    head, rest = text.split(b"end_header\n") if suffix == "ply" else (b"", text)
    for change, to in CHANGES.items():
        whole = suffix != "ply" or change not in ("indent", "blank")  # those lines of a PLY header have no blanks
        yield Case(f"{name}-{change}.{suffix}", to(text) if whole else head + b"end_header\n" + to(rest), body)
    yield Case(f"{name}-padded.{suffix}", text + bytes(2), body, may_refuse=suffix != "obj")  # as raptor_allquads.obj is
    yield Case(f"{name}-gz.{suffix}.gz", zipped(text), body)
    yield Case(f"{name}-gz-cut.{suffix}.gz", zipped(text)[:-9], None)
    yield Case(f"{name}-gz-unnamed.{suffix}", zipped(text), body, may_refuse=True)
    for end, mark in (("le", codecs.BOM_UTF16_LE), ("be", codecs.BOM_UTF16_BE)):
        wide = text.decode("latin-1").encode("utf-16-" + end)
        yield Case(f"{name}-utf16-{end}.{suffix}", mark + wide, None, says="UTF-16")
        yield Case(f"{name}-utf16-{end}-bare.{suffix}", wide, None)


def obj(body, vertex="{}", corner="{0}", extra=""):
    """Makes an OBJ file; `corner` is given a vertex' number from 1, and from the end."""
    count = len(body.vertices)
    lines = ["v " + vertex.format(spell(*v)) for v in body.vertices]
    lines += [line for line in ("vt 0.5 0.5", "vn 0 0 1") if "/" in corner for _ in range(count)]
    faces = ["f " + " ".join(corner.format(i + 1, i - count) for i in face) for face in body.faces]
    return "\n".join(lines + [extra] * bool(extra) + faces + [""])


def obj_files(offset):
    body, copy = PRISM.at(offset), (10, 0, 0)
    plain = obj(body)
    soup = [obj(Body([body.vertices[i] for i in face], [range(len(face))]), corner="{1}") for face in body.faces]
    yield from files("obj", body, {
        "plain": plain, "vt": obj(body, corner="{0}/{0}"), "vn": obj(body, corner="{0}//{0}"), "soup": "".join(soup),
        "vt-vn": obj(body, corner="{0}/{0}/{0}"), "negative": obj(body, corner="{1}"), "w": obj(body, vertex="{} 1.0"),
        "negative-vt-vn": obj(body, corner="{1}/{1}/{1}"), "colours": obj(body, vertex="{} 0.5 0.25 1"),
        "rgba": obj(body, vertex="{} 0.5 0.25 1 1"), "long-comment": "#" + 300000 * "x" + "\n" + plain,
        "comments": "# a\\\n" + obj(body, vertex="{} # here # too", extra="# another\\") + "# end\\\n",
        "continued": plain.replace(" ", " \\\n"), "continued-crlf": plain.replace(" ", " \\\r\n"),
        "continued-cr": plain.replace("\n", "\r").replace(" ", " \\\r"),
        "names": obj(body, extra="mtllib none.mtl\no Gr\xf6\xdfe \xe9\ng a b\ns off\nusemtl \xfc\ns 1"),
        "nan-normal": obj(body, extra="vn nan nan nan"),
        "numbers": "".join(f"v {x:+.12E} {y:+.3f} {z:012.3f}\n" for x, y, z in body.vertices) + plain[plain.index("f"):]})
    yield from files("obj", body, {"points-lines": obj(body, extra="p 1 2\nl 1 2 3\nvp 0.5")}, says="points.*lines")
    yield from files("obj", body.and_copy(copy), {"two": obj(body.and_copy(copy), extra="o a")})
    yield from files("obj", body, {"late": "".join(sorted(plain.splitlines(True), key=lambda line: line[0]))}, may_refuse=True)


def obj_others():
    yield from files("obj", ROUND, {"round": obj(ROUND)})
    decimal = TRIANGLES.mapped(lambda x, y, z: (10000000.1 + 1.3 * x, 4200000.1 + 1.3 * y, 0.1 + 1.3 * z))
    yield from files("obj", decimal, {"decimal": obj(decimal)})
    good, last = obj(TETRA), "f 1 4 3\n"
    yield from damaged("obj", good, {
        "nan": ("v 1", "v nan"), "inf": ("v 1", "v -inf"), "huge": ("v 1", "v 1e999"), "word": ("v 1", "v one"),
        "comma": ("v 1 ", "v 1,5 "), "two-numbers": ("v 1 0 0", "v 1 0"), "zero": (last, "f\0 1\n"),
        "index-5": (last, "f 1 5 3\n"), "index-0": (last, "f 0 4 3\n"), "index-minus-5": (last, "f 1 -5 3\n"),
        "index-2-32": (last, "f 1 4294967300 3\n"), "index-word": (last, "f 1 4 3b\n")},
        {"no-faces": good[:good.index("f")], "cut": good[:-4], "words": "these are words\n"})


NAMES = {"b": "char int8", "B": "uchar uint8", "h": "short int16", "H": "ushort uint16", "i": "int int32", "I": "uint uint32",
         "f": "float float32", "d": "double float64"}
CODE = {name: code for code, names in NAMES.items() for name in names.split()}
HELD = {"b": (-100, 100, 7), "B": (200, 100, 0), "h": (30000, -30000, 10), "H": (60000, 30000, 0), "i": FAR_WHOLE,
        "I": (4000000000, 3000000000, 10), "f": FAR_WHOLE, "d": FAR}  # offsets that the type can hold
FORMS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
XYZ = ("double x", "double y", "double z")
CORNERS = "list uchar int vertex_indices"


def ply(form, *elements, extra="comment Gr\xf6\xdfe, end_header \\\nobj_info none\n"):
    """Makes a PLY file of elements: a name, the properties, and rows of values."""
    head, data, order = f"ply\nformat {form} 1.0\n{extra}", bytearray(), FORMS[form]
    for name, properties, rows in elements:
        head += f"element {name} {len(rows)}\n" + "".join(f"property {p}\n" for p in properties)
        for row in rows:
            for words, value in zip([p.split() for p in properties], row):
                values = [(CODE[words[-2]], v) for v in (value if words[0] == "list" else [value])]
                values[:0] = [(CODE[words[1]], len(value))] if words[0] == "list" else []
                data += b"".join(struct.pack(order + c, v if c in "fd" else int(v)) if order else (spell(v) + " ").encode()
                                 for c, v in values)
            data += b"" if order else b"\n"
    return head.encode("latin-1") + b"end_header\n" + data


def ply_elements(body):
    """Yields names and elements that all make the body."""
    points = body.vertices
    faces, vertex = ("face", (CORNERS,), [(face,) for face in body.faces]), ("vertex", XYZ, points)
    normal, colour = ("float nx", "float ny", "float nz"), ("uchar red", "uchar green", "uchar alpha")
    many = [f"float p{i}" for i in range(40)]
    yield "plain", (vertex, faces)
    yield "zyx", (("vertex", XYZ[::-1], [v[::-1] for v in points]), faces)
    yield "colours", (("vertex", XYZ + colour, [v + (1, 2, 255) for v in points]), faces)
    yield "normals-first", (("vertex", normal + XYZ, [(0, 0, 1, *v) for v in points]), faces)
    yield "nan-quality", (("vertex", (*XYZ, "float quality", "double q"), [v + (NAN, INF) for v in points]), faces)
    between = [(x, 10, y, -7, z) for x, y, z in points]
    yield "between", (("vertex", (XYZ[0], "uchar a", XYZ[1], "short s", XYZ[2]), between), faces)
    lists = [((9, 9)[:i % 3], *v) for i, v in enumerate(points)]
    yield "list-in-vertex", (("vertex", ("list ushort double w", *XYZ), lists), faces)
    yield "texcoord", (vertex, ("face", ("list uchar float texcoord", CORNERS, "int texnumber", "list int8 uint8 tags"),
                                [((0.5,) * 6, face, -1, ()) for face in body.faces]))
    yield "vertex_index", (vertex, ("face", ("uchar red", "list int uint vertex_index"), [(7, face) for face in body.faces]))
    yield "faces-first", (faces, vertex)
    yield "others", (("material", ("float x", CORNERS), [(5, (1, 2, 3))] * 2), vertex, ("camera", XYZ, [(1, 2, 3)]), faces,
                     ("edge", ("int vertex1", "int vertex2"), [(0, 1)] * 3))
    yield "40-properties", (("vertex", (*XYZ, *many), [v + (0.5,) * 40 for v in points]), faces)
    yield "20-elements", (*((f"e{i}", ("int8 a",), [(1,)]) for i in range(20)), vertex, faces)
    yield "unused", (("vertex", XYZ, points + [(0, 0, 0)]), faces)


STRIPS = {"one": [(0, 2, 1, 3, 0, 2)], "ends": [(0, 2, 1, 3, 0, 2, -1)], "two": [(0, 2, 1, -1, 1, 2, 3, 0, -1, 0, 1, 3)],
          "rows": [(0, 2, 1, 3), (1, 3, 0), (0, 3, 2, -1)], "joined": [(0, 2, 1, 1, 2, 2, 1, 3, 0, 2)]}  # of TETRA


def ply_types():
    """Yields every scalar type of coordinates, and of lists."""
    for form, name in itertools.product(FORMS, CODE):
        body = PRISM.at(HELD[CODE[name]])
        vertex = ("vertex", [f"{name} {axis}" for axis in "xyz"], body.vertices)
        yield Case(f"ply-{form}-{name}.ply", ply(form, vertex, ("face", (CORNERS,), [(face,) for face in body.faces])), body)
    for i, (kinds, form) in enumerate(zip(itertools.product("bBhHiI", repeat=2), itertools.cycle(FORMS))):
        count, index = (NAMES[code].split()[i % 2] for code in kinds)
        faces = ("face", (f"list {count} {index} vertex_indices",), [(face,) for face in PRISM.faces])
        yield Case(f"ply-list-{count}-{index}.ply", ply(form, ("vertex", XYZ, PRISM.vertices), faces), PRISM)


def ply_files():
    for form in FORMS:
        for name, elements in ply_elements(PRISM.at(FAR)):
            yield Case(f"ply-{name}-{form}.ply", ply(form, *elements), PRISM.at(FAR))
        for name, rows in STRIPS.items():
            strips = ("tristrips", ("list int int vertex_indices",), [(row,) for row in rows])
            yield Case(f"ply-strips-{name}-{form}.ply", ply(form, ("vertex", XYZ, TETRA.at(FAR).vertices), strips), TETRA.at(FAR))
        body = TRIANGLES.at((10, 13, 10))  # the first byte of little-endian data is a line feed
        vertex = ("vertex", ("int x", "uint y", "float z"), body.vertices)
        data = ply(form, vertex, ("face", (CORNERS,), [(face,) for face in body.faces]))
        head, rest = data.split(b"end_header\n", 1)
        for end, change in (("crlf", b"\r\n"), ("cr", b"\r")):
            yield Case(f"ply-head-{end}-{form}.ply", (head + b"end_header\n").replace(b"\n", change) + rest, body)
        yield Case(f"ply-gz-{form}.ply.gz", zipped(data), body)
        floats = ply(form, vertex, ("face", ("list uchar float vertex_indices",), [(face,) for face in body.faces]))
        for name, other in (("bom", codecs.BOM_UTF8 + data), ("trailing", data + b"0 0 0 0\n"), ("float-index", floats)):
            yield Case(f"ply-{name}-{form}.ply", other, body, may_refuse=True)
    text = ply("ascii", *dict(ply_elements(PRISM.at(FAR)))["plain"])
    yield from changed("ply", "ply", text, PRISM.at(FAR))
    head, rest = text.split(b"end_header\n")
    yield Case("ply-one-line.ply", head + b"end_header\n" + rest.replace(b"\n", b" "), PRISM.at(FAR))
    yield Case("ply-words.ply", head + b"end_header\n" + rest.replace(b" ", b"\n"), PRISM.at(FAR))


def ply_bad():
    good = ply("ascii", *dict(ply_elements(TETRA))["plain"], extra="").decode()
    yield from damaged("ply", good, {
        "no-format": ("format ascii 1.0\n", ""), "form": ("ascii", "binary_middle_endian"), "type": ("double", "quad"),
        "count": ("vertex 4", "vertex -4"), "many": ("vertex 4", "vertex 4000000000"), "no-z": ("double z", "double depth"),
        "nan": ("1 0 0", "nan 0 0"), "inf": ("1 0 0", "1 inf 0"), "word": ("1 0 0", "1 a 0"), "list": ("3 1 2 3", "-3 1 2 3"),
        "index-4": ("1 2 3", "1 2 4"), "index-minus": ("1 2 3", "1 2 -1"), "cut": ("3 0 3 2 \n", ""), "cut-face": ("3 2 \n", "")},
        {"head": good[:good.index("end_header")]})
    for form, bad in itertools.product(("binary_little_endian", "binary_big_endian"), ("nan", "inf", "index", "cut", "count")):
        first = (float(bad), 1, 0) if bad in ("nan", "inf") else (0, 0, 0)
        faces = ("face", (CORNERS,), [((0, 1, 4 if bad == "index" else 3),)])
        data = ply(form, ("vertex", XYZ, [first, *TETRA.vertices[1:]]), faces)
        data = data.replace(b"face 1", b"face 2000000000") if bad == "count" else data
        yield Case(f"ply-bad-{bad}-{form}.ply", data[:-1] if bad == "cut" else data, None)


def stl(body, name=" body", normal="0 0 0"):
    text = f"solid{name}\n"
    for face in body.faces:
        corners = "".join(f"      vertex {spell(*body.vertices[i])}\n" for i in face)
        text += f"  facet normal {normal}\n    outer loop\n{corners}    endloop\n  endfacet\n"
    return text + f"endsolid{name}\n"


def stl_binary(body, header=b"", attribute=0, count=None):
    data = header.ljust(80, b" ") + struct.pack("<I", len(body.faces) if count is None else count)
    return data + b"".join(struct.pack("<12fH", NAN, NAN, NAN, *(x for i in face for x in body.vertices[i]), attribute)
                           for face in body.faces)


HEADERS = {"spaces": b"", "zeros": bytes(80), "colour": b"COLOR=\1\2\3\4,MATERIAL=", "solid": b"solid body", "upper": b"SOLID\n",
           "facet": b"solid x\n facet normal 0 0 1\n outer loop\n vertex 0 0 0\n", "high": bytes(range(176, 256))}


def stl_files(offset):
    body, whole = TRIANGLES.at(offset), TRIANGLES.at([int(x) for x in offset])
    plain, copy = stl(body), (10, 0, 0)
    yield from files("stl", body, {
        "plain": plain, "upper": plain.upper(), "title": plain.title(), "nameless": stl(body, ""),
        "latin": stl(body, " Gr\xf6\xdfe"), "name": stl(body, " facet normal vertex 1 2 3"),
        "normals": stl(body, normal="nan -nan inf"), "exponents": plain.replace(" 3000000.125", " 3.000000125E+06")})
    yield from files("stl", body.and_copy(copy), {"two": plain + stl(body.at(copy), " b")})
    yield from files("stl", body, {"no-end": plain[:plain.index("endsolid")]}, may_refuse=True)
    binary = {name: stl_binary(whole, header) for name, header in HEADERS.items()}
    yield from files("stl", whole, {"binary-" + name: data for name, data in binary.items()})
    yield from files("stl", whole, {"binary-attributes": stl_binary(whole, attribute=0xffff)})
    yield from files("stl", whole, {"trailing-" + name: data + b"\n\n" for name, data in binary.items()}, may_refuse=True)
    yield from files("stl", whole, {f"count-{n:x}": stl_binary(whole, count=n) for n in (0, 0xffffffff)}, may_refuse=True)
    yield Case("stl-binary.stl.gz", zipped(stl_binary(whole)), whole)


def stl_bad():
    good, binary = stl(TETRA), stl_binary(TETRA)
    yield from files("stl", TETRA, {"one-line": stl(TETRA, "").replace("\n", " ")}, may_refuse=True)
    yield from damaged("stl", good, {
        "nan": ("vertex 1", "vertex nan"), "inf": ("vertex 1", "vertex inf"), "word": ("vertex 1 0", "vertex a 0"),
        "two-corners": ("      vertex 1 0 0\n", "", 1)}, {
            "no-facets": "solid x\nendsolid x\n", "cut": good[:good.rindex("endloop")],
            "cut-number": good[:good.rindex("vertex") + 8], "cut-binary": binary[:-1], "header": binary[:84],
            "short": binary[:60], "many": stl_binary(TETRA, count=0x7fffffff), "one-more": stl_binary(TETRA, count=5),
            "nan-binary": stl_binary(TETRA.at((NAN, 0, 0)))})


def off(body, key="OFF\n", vertex="{}", face="{}", counts="{} {} 0"):
    lines = [key + counts.format(len(body.vertices), len(body.faces))] + [vertex.format(spell(*v)) for v in body.vertices]
    return "\n".join(lines + [face.format(spell(len(f), *f)) for f in body.faces] + [""])


def off_binary(body, key="OFF", more=()):
    """Makes a binary OFF file; `more` are numbers of each vertex. Faces have 0, 3 or 4 numbers of a colour."""
    data = b"".join(struct.pack(f">{3 + len(more)}f", *vertex, *more) for vertex in body.vertices)
    for face, colour in zip(body.faces, itertools.cycle((0, 3, 4))):
        data += struct.pack(f">{len(face) + 2}i{colour}f", len(face), *face, colour, *(0.5,) * colour)
    return f"{key} BINARY\n".encode() + struct.pack(">3i", len(body.vertices), len(body.faces), 0) + data


def off_files(offset):
    body, whole = PRISM.at(offset), PRISM.at([int(x) for x in offset])
    plain = off(body)
    head, faces = plain[4:plain.index("\n7 ")], plain[plain.index("\n7 "):]
    commented = off(body, "OFF # key\n# before\n", "{} # v\n\n# next", "{} # f", "{} {} # edges\n 0 # counts")
    yield from files("off", body, {
        "plain": plain, "colours": off(body, "COFF\n", "{} 255 0 0 255"), "float-colours": off(body, "COFF\n", "{} 1.0 0.5 0 1"),
        "normals": off(body, "NOFF\n", "{} 0 0 1"), "nan-normals": off(body, "NOFF\n", "{} nan nan nan"),
        "texture": off(body, "STOFF\n", "{} 0.5 0.5"), "edges-below": off(body, counts="{} {}\n99"),
        "key-line": off(body, "OFF "), "all": off(body, "STCNOFF\n", "{} 0 0 1 0.1 0.2 0.3 1 0.5 0.5"),
        "face-rgb": off(body, face="{} 255 0 0"), "face-rgba": off(body, face="{} 0.1 0.2 0.3 1"),
        "face-index": off(body, face="{} 3"), "edges": off(body, counts="{} {} 99"), "modelnet": off(body, "OFF"),
        "comments": "# first\n" + commented + "# last", "words": "OFF\n" + head.replace(" ", "\n") + faces})
    yield from files("off", body, {"points-lines": off(body._replace(faces=body.faces + [(0, 1), (2,)]))}, says="points.*lines")
    yield from files("off", body, {
        "no-edges": off(body, counts="{} {}"), "no-edges-key-line": off(body, "OFF ", counts="{} {}"), "no-key": off(body, ""),
        "rgb": off(body, "COFF\n", "{} 255 0 0"), "unannounced": off(body, vertex="{} 255 0 0 255"), "lower": off(body, "off\n")},
        may_refuse=True)
    yield from files("off", whole, {"binary": off_binary(whole), "binary-colours": off_binary(whole, "COFF", (1, 0, 0, 1)),
                                    "binary-normals": off_binary(whole, "NOFF", (0, 0, 1))})


def off_bad():
    good, binary = off(TETRA), off_binary(TETRA)
    yield from files("off", None, {"4OFF": off(TETRA, "4OFF\n", "{} 1")}, says="4OFF")
    yield from files("off", TETRA, {"nOFF": off(TETRA, "nOFF\n3\n")}, may_refuse=True)
    yield from damaged("off", good, {
        "nan": ("\n1 ", "\nnan "), "inf": ("\n1 ", "\n-inf "), "word": ("\n1 ", "\na "), "index-4": ("3 1 2 3", "3 1 2 4"),
        "index-minus": ("3 1 2 3", "3 1 2 -1"), "index-2-32": ("3 1 2 3", "3 1 2 4294967299"), "corners": ("3 1 2 3", "4 1 2 3"),
        "count": ("4 4 0", "-4 4 0"), "many": ("4 4 0", "4 4000000000 0"), "key": ("OFF", "OFT")},
        {"only-key": "OFF\n", "cut": good[:-9], "cut-face": good[:-3], "cut-binary": binary[:-5],
         "index-binary": off_binary(TETRA._replace(faces=[(0, 1, 7)]))})


def point_files(offset):
    """Yields balls of points with and without normals."""
    count = 60
    ups = [2 * (k + 0.5) / count - 1 for k in range(count)]
    normals = [[round(x, 8) for x in (math.sqrt(1 - y * y) * math.cos(2.4 * k), y, math.sqrt(1 - y * y) * math.sin(2.4 * k))]
               for k, y in enumerate(ups)]
    points = [[x + o for x, o in zip(normal, offset)] for normal in normals]
    rows, ends = (["{:.8f} {:.8f} {:.8f}".format(*x) for x in of] for of in (points, normals))
    both = [f"{row} {end}" for row, end in zip(rows, ends)]
    text = "\n".join(["# x y z", *both, ""]).encode()
    found = {f"{name}.{suffix}": "\n".join([*lines, ""]).encode() for name, lines in (("normals", both), ("bare", rows))
             for suffix in ("xyz", "pts", "txt", "asc", "pwn")}
    found.update({"count.pts": "\n".join([str(count), *rows]).encode(),
                  "count-normals.pts": "\n".join([str(count), *both]).encode(),
                  "blocks.pwn": "\n".join([str(count), *rows, *ends]).encode(), "commas.txt": text.replace(b" ", b","),
                  "gz.xyz.gz": zipped(text), **{f"{name}.xyz": change(text) for name, change in CHANGES.items()}})
    ball = ("vertex", XYZ + ("float nx", "float ny", "float nz"), [(*p, *n) for p, n in zip(points, normals)])
    found.update({f"{form}.ply": ply(form, ball) for form in FORMS})
    for name, data in found.items():
        yield Case(f"points-{name}", data, None, may_refuse=name in ("bare.pwn", "blocks.pwn"), points=count)


def cases():
    """Returns all files, each with its own name."""
    found = [*obj_others(), *ply_types(), *ply_files(), *ply_bad(), *stl_bad(), *off_bad()]
    for place, offset in (("near", (0, 0, 0)), ("far", FAR)):
        there = [*obj_files(offset), *stl_files(offset), *off_files(offset), *point_files(offset)]
        found += [case._replace(name=case.name.replace(".", f"-{place}.", 1)) for case in there]
    for case in list(found):
        name, _, suffix = case.name.partition(".")
        if name in ("obj-plain-far", "obj-comments-far", "stl-plain-far", "off-plain-far", "off-colours-far", "off-comments-far"):
            found += changed(name[:-4], suffix, case.data, case.wanted)
    assert len({case.name for case in found}) == len(found)
    return found


def write(chosen, folder):
    """Writes files, those beside them, and expected.json: what a reader in another language must find."""
    expected = {}
    for case in chosen:
        for name, data in {case.name: case.data, **case.beside}.items():
            path = os.path.join(folder, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "wb") as file:
                file.write(data)
        expected[case.name] = {"facts": case.wanted and case.wanted.facts(), "may_refuse": case.may_refuse, "says": case.says,
                               "points": case.points}
    with open(os.path.join(folder, "expected.json"), "w", encoding="utf-8") as file:
        json.dump(expected, file, indent=1)
