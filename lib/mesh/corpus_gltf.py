"""Scenes of glTF and GLB whose right answer is known by construction; see corpus_files.py."""
import base64
import codecs
import itertools
import json
import math
import struct

from corpus_files import CHANGES, FAR, FAR_WHOLE, NAMES, TETRA, TRIANGLES, Body, Case, files, zipped

COMPONENT = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}
WIDTH = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
DRACO = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}


class Gltf:
    """Collects a scene's JSON and the bytes of its buffer."""

    def __init__(self, body=TETRA, code="f", index="H", stride=0, normalized=False, **primitive):
        self.data = bytearray()
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                     "accessors": [], "bufferViews": []}
        position = self.accessor(code, body.vertices, stride, **({"normalized": True} if normalized else {}))
        self.primitive = {"attributes": {"POSITION": position}, **primitive}
        if index:
            self.primitive["indices"] = self.accessor(index, [(i,) for face in body.faces for i in face])
        self.json["meshes"] = [{"primitives": [self.primitive]}]

    def view(self, data, **more):
        self.data += bytes(-len(self.data) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data), **more})
        self.data += data
        return len(self.json["bufferViews"]) - 1

    def accessor(self, code, rows, stride=0, **more):
        packed = [struct.pack(f"<{len(row)}{code}", *row).ljust(stride, b"\x7f") for row in rows]
        view = self.view(b"".join(packed), **({"byteStride": stride} if stride else {}))
        self.json["accessors"].append({"bufferView": view, "componentType": COMPONENT[code], "count": len(rows),
                                       "type": WIDTH[len(rows[0])], **more})
        return len(self.json["accessors"]) - 1

    def put(self, **more):
        self.json.update(more)
        return self

    def node(self, **more):
        return self.put(nodes=[{"mesh": 0, **more}])

    def uses(self, name, required=True):
        return self.put(extensionsUsed=[name], **({"extensionsRequired": [name]} if required else {}))

    def text(self, uri=None):
        uri = uri or "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return json.dumps({**self.json, "buffers": [{"byteLength": len(self.data), "uri": uri}]}, indent=1).encode()

    def binary(self, text=None, version=2, length=None, more=()):
        """Makes a GLB; `text`, `version` and `length` stand for the right ones, `more` are chunks."""
        text = text or json.dumps({**self.json, "buffers": [{"byteLength": len(self.data)}]}).encode()
        chunks = b""
        for kind, data, fill in ((b"JSON", text, b" "), (b"BIN\0", bytes(self.data), b"\0"), *more):
            data += fill * (-len(data) % 4)
            chunks += struct.pack("<I4s", len(data), kind) + data
        return struct.pack("<4sII", b"glTF", version, length or 12 + len(chunks)) + chunks


def gltf_sparse(code, base):
    """Makes positions of which two, or without a base all but (0, 0, 0), come from a sparse accessor."""
    scene = Gltf(TETRA._replace(vertices=[(0, 0, 0), (7, 7, 7), (0, 1, 0), (7, 7, 7)]))
    accessor, chosen = scene.json["accessors"][0], (1, 3) if base else (1, 2, 3)
    values = scene.view(b"".join(struct.pack("<3f", *TETRA.vertices[i]) for i in chosen))
    indices = scene.view(struct.pack(f"<{len(chosen)}{code}", *chosen))
    accessor["sparse"] = {"count": len(chosen), "values": {"bufferView": values},
                          "indices": {"bufferView": indices, "componentType": COMPONENT[code]}}
    if not base:
        del accessor["bufferView"]
    return scene


def gltf_instances(required=True, node=(), **attributes):
    scene = Gltf().uses("EXT_mesh_gpu_instancing", required)
    numbers = {name: scene.accessor("f", rows) for name, rows in attributes.items()}
    return scene.node(extensions={"EXT_mesh_gpu_instancing": {"attributes": numbers}}, **dict(node))


def gltf_skinned(**node):
    """Makes a skin whose joint's transform is the inverse of its bind matrix: the mesh as stored."""
    scene = Gltf()
    scene.primitive["attributes"].update(JOINTS_0=scene.accessor("B", [(0, 0, 0, 0)] * 4),
                                         WEIGHTS_0=scene.accessor("f", [(1, 0, 0, 0)] * 4))
    bind = scene.accessor("f", [(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -5, 0, 0, 1)])
    return scene.put(nodes=[{"mesh": 0, "skin": 0, **node}, {"translation": [5, 0, 0]}], scenes=[{"nodes": [0, 1]}],
                     skins=[{"joints": [1], "inverseBindMatrices": bind}])


def gltf_primitives():
    """Yields names, scenes, and the bodies in them: how a mesh is stored."""
    whole = TRIANGLES.at(FAR_WHOLE)
    corners = [TETRA.vertices[i] for face in TETRA.faces for i in face]
    strip = (0, 2, 1, 3, 0, 2)
    for index in "BHI":
        yield "index-" + index, Gltf(whole, index=index), whole
        yield f"sparse-{index}", gltf_sparse(index, True), TETRA
        yield f"sparse-zeros-{index}", gltf_sparse(index, False), TETRA
    yield "no-index", Gltf(Body(corners, []), index=None), TETRA
    yield "stride", Gltf(stride=20, mode=4), TETRA
    apart = Gltf(TETRA._replace(vertices=[x for v in TETRA.vertices for x in ((7, 7, 7), v)]), stride=12)
    apart.json["bufferViews"][0]["byteStride"] = 24
    apart.json["accessors"][0].update(byteOffset=12, count=4)
    yield "interleaved", apart, TETRA
    yield "strip", Gltf(TETRA._replace(faces=[strip]), mode=5), TETRA
    yield "strip-no-index", Gltf(Body([TETRA.vertices[i] for i in strip], []), index=None, mode=5), TETRA
    fans, lines = Gltf(TETRA._replace(faces=[(3, 0, 1, 2, 0)]), mode=6), Gltf()
    fans.json["meshes"][0]["primitives"].append({**fans.primitive, "indices": fans.accessor("B", [(0,), (2,), (1,)])})
    yield "fans", fans, TETRA
    lines.json["meshes"][0]["primitives"] += [{**lines.primitive, "mode": mode} for mode in range(4)]
    yield "points-lines", lines, TETRA
    for code, normalized in itertools.product("bBhH", (False, True)):
        size = 2 ** (8 * struct.calcsize(code) - (code in "bh")) - 1 if normalized else 2
        scene = Gltf(code=code, stride=4 * struct.calcsize(code), normalized=normalized).uses("KHR_mesh_quantization")
        wanted = TETRA.mapped(lambda *x, scale=1 if normalized else 2: tuple(scale * a + o for a, o in zip(x, FAR)))
        yield f"quantized-{NAMES[code].split()[1]}-{normalized}", scene.node(scale=[size] * 3, translation=FAR), wanted
    yield "skin", gltf_skinned(), TETRA
    yield "skin-scaled", gltf_skinned(scale=(3, 3, 3), translation=FAR), TETRA
    yield "morph-zero", Gltf(targets=[{"POSITION": 0}]), TETRA
    yield "unknown-used", Gltf().uses("EXT_nobody_knows", required=False), TETRA


def gltf_nodes():
    """Yields names, scenes, and the bodies in them: where meshes are."""
    turned = TETRA.mapped(lambda x, y, z: (FAR[0] - y, FAR[1] + 2 * x, FAR[2] + z))
    mirrored = TETRA.mapped(lambda x, y, z: (-x, y, z), mirrored=True)
    doubled = TETRA.mapped(lambda *x: tuple(o + 2 * a for o, a in zip(FAR, x)))
    four, moves = TETRA.and_copy((10, 0, 0)).and_copy((0, 20, 0)), [(0, 0, 0), (10, 0, 0), (0, 20, 0), (10, 20, 0)]
    moved = [{"mesh": 0, "translation": move} for move in moves]
    unnumbered = Gltf()
    del unnumbered.json["scene"]
    yield "no-scene-number", unnumbered, TETRA
    yield "translation", Gltf().node(translation=FAR), TETRA.at(FAR)
    yield "trs", Gltf().node(translation=FAR, rotation=(0, 0, math.sqrt(0.5), math.sqrt(0.5)), scale=(2, 1, 1)), turned
    yield "matrix", Gltf().node(matrix=(0, 2, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, *FAR, 1)), turned
    yield "mirrored", Gltf().node(scale=(-1, 1, 1)), mirrored
    yield "mirrored-twice", Gltf().put(nodes=[{"children": [1], "scale": (1, -1, 1)}, {"mesh": 0, "scale": (-1, 1, 1)}]), \
        TETRA.mapped(lambda x, y, z: (-x, -y, z))
    yield "nested", Gltf().put(nodes=[{"children": [1], "translation": FAR}, {"mesh": 0, "scale": (2, 2, 2)}]), doubled
    yield "four-nodes", Gltf().put(nodes=moved, scenes=[{"nodes": [0, 1, 2, 3]}]), four
    yield "other-scene", Gltf().put(nodes=moved, scenes=[{"nodes": [0, 2]}, {"nodes": [1]}], scene=1), TETRA.at(moves[1])
    yield "instances", gltf_instances(TRANSLATION=moves), four
    yield "instances-used", gltf_instances(required=False, TRANSLATION=moves), four
    yield "instances-far", gltf_instances(node={"translation": FAR}, TRANSLATION=moves), four.at(FAR)
    yield "instances-trs", gltf_instances(TRANSLATION=moves[1:2], ROTATION=[(0, 0, 1, 0)], SCALE=[(2, 1, 1)]), \
        TETRA.mapped(lambda x, y, z: (10 - 2 * x, -y, z))
    yield "instances-mirrored", gltf_instances(SCALE=[(-1, 1, 1)]), mirrored


def gltf_files():
    for name, scene, body in (*gltf_primitives(), *gltf_nodes()):
        says = {"points-lines": "points.*lines", "other-scene": "scene"}.get(name, "")
        yield Case(f"gltf-{name}.gltf", scene.text(), body, says=says)
        yield Case(f"gltf-{name}.glb", scene.binary(), body, says=says)
    good, weighted = Gltf(), Gltf(targets=[{"POSITION": 0}])
    beside = {"b c.bin": bytes(good.data), "sub/b.bin": bytes(good.data)}
    yield Case("gltf-beside.gltf", good.text("b%20c.bin"), TETRA, beside=beside)
    yield Case("gltf-beside-below.gltf", good.text("./sub/b.bin"), TETRA, beside=beside)
    yield Case("gltf-beside.glb", good.binary(good.text("b%20c.bin")), TETRA, beside=beside)
    yield Case("below/gltf-outside.gltf", good.text("../b%20c.bin"), None, beside=beside)
    yield from files("gltf", TETRA, {name: CHANGES[name](good.text()) for name in ("crlf", "cr", "bom", "tabs", "blank")})
    yield from files("gltf", TETRA, {"mime": good.text().replace(b"octet-stream", b"gltf-buffer")})
    yield from files("glb", TETRA, {"chunks": good.binary(more=((b"ABCD", b"1234", b" "),))})
    yield from files("glb", TETRA, {"length": good.binary(length=100)}, may_refuse=True)
    yield Case("gltf-gz.gltf.gz", zipped(good.text()), TETRA)
    yield Case("gltf-gz.glb.gz", zipped(good.binary()), TETRA)
    yield from files("gltf", None, {"utf16": codecs.BOM_UTF16_LE + good.text().decode().encode("utf-16-le")}, says="UTF-16")
    for owner, other in (("meshes", "nodes"), ("nodes", "meshes")):  # a node's weights count, where it has any
        weighted.json[owner][0]["weights"], weighted.json[other][0]["weights"] = [1], [0]
        wanted = TETRA if other == "nodes" else TETRA.mapped(lambda *x: tuple(2 * a for a in x))
        yield from files("gltf", wanted, {"morph-" + owner: weighted.text()}, may_refuse=other == "meshes")
    del weighted.json["nodes"][0]["weights"]
    weighted.json["meshes"][0]["weights"] = [1]
    yield from files("gltf", TETRA.mapped(lambda *x: tuple(2 * a for a in x)), {"morph": weighted.text()}, may_refuse=True)
    for name, says in (("EXT_nobody_knows",) * 2, ("KHR_draco_mesh_compression", "Draco"), ("EXT_meshopt_compression",) * 2):
        yield from files("gltf", None, {"required-" + name: Gltf().uses(name).text()}, says=says)
        yield from files("glb", None, {"required-" + name: Gltf().uses(name).binary()}, says=says)
    texture = "KHR_texture_transform"
    yield from files("gltf", TETRA, {"required-texture": Gltf().uses(texture).text()}, may_refuse=True, says=texture)
    yield from files("gltf", TETRA, {"draco-used": Gltf(extensions=DRACO).uses(*DRACO, required=False).text()}, True, "Draco")


def gltf_bad():
    good = Gltf()
    text = good.text()
    yield from files("gltf", None, {
        "bad-empty": "", "bad-cut": text[:-20], "bad-object": "{}", "bad-missing": good.text("none.bin"),
        "bad-web": good.text("http://a/b.bin"),
        "bad-version": text.replace(b'"2.0"', b'"1.0"'), "bad-short": text.replace(b'"byteLength": 72', b'"byteLength": 720'),
        "bad-cycle": Gltf().node(children=[0]).text(), "bad-index": Gltf(TETRA._replace(faces=[(0, 1, 4)])).text(),
        "bad-no-mesh": Gltf().put(nodes=[{}]).text(), "bad-mesh": Gltf().put(nodes=[{"mesh": 7}]).text(),
        "bad-restart": Gltf(TETRA._replace(faces=[(0, 1, 2, 255, 1, 2, 3)]), index="B", mode=5).text(),
        "bad-nan": Gltf(TETRA.at((math.nan, 0, 0))).text(), "bad-count": text.replace(b'"count": 4', b'"count": 400')})
    yield from files("glb", None, {"bad-cut": good.binary()[:-1], "bad-version": good.binary(version=1),
                                   "bad-words": "glTF but not quite", "bad-json": good.binary(b"{")})


def cases():
    """Returns all files."""
    return [*gltf_files(), *gltf_bad()]
