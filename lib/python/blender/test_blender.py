#!/usr/bin/python3
"""Tests of the Blender add-on in Blender without a window: installed from its zip, as its users do. CTest runs them.

usage: test_blender.py WHEEL_LIBRARY      skipped (77) where there is no Blender"""
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

HERE = pathlib.Path(__file__).resolve().parent
FRAMES = 12
try:
    import bpy
    import numpy as np
    from mathutils import Matrix
except ImportError:
    bpy = None


def run_in_blender():
    """Of this file, with a user's folder of its own."""
    blender = shutil.which("blender")
    if not blender:
        print("skipped: blender is missing: apt-get install blender")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        packed = subprocess.run([HERE.parent.parent.parent / "scripts" / "wheel.py", sys.argv[1], folder],
                                capture_output=True, text=True, check=True).stdout.splitlines()[1]
        clean = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "SHAPEBENCH_LIBRARY")}
        return subprocess.run([blender, "--background", "--factory-startup", "--python-exit-code", "1", "--python",
                               __file__, "--", packed, folder], check=False,
                              env={**clean, "BLENDER_USER_SCRIPTS": folder, "HOME": folder}).returncode


class AddOn(unittest.TestCase):
    """What it bakes."""

    def setUp(self):
        bpy.ops.wm.read_homefile(use_empty=True)
        if "shapebench_blender" not in bpy.context.preferences.addons:
            bpy.ops.preferences.addon_install(filepath=ADD_ON)
            bpy.ops.preferences.addon_enable(module="shapebench_blender")
        self.scene = bpy.context.scene
        self.scene.frame_start, self.scene.frame_end, self.scene.render.fps = 1, FRAMES, 25
        self.scene.frame_set(7)

    def beam(self, **how):
        """A bar 2 long, its low end in the group "pins"; turned, scaled, and away from the origin."""
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=4, size=2)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0, 0, 2)})
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.normals_make_consistent()
        bpy.ops.object.mode_set(mode="OBJECT")
        obj = bpy.context.object
        obj.matrix_world = Matrix.Translation((3, 1, 2)) @ Matrix.Rotation(0.4, 4, "Z") @ Matrix.Diagonal((1, 0.2, 0.2, 1))
        group = obj.vertex_groups.new(name="pins")
        group.add([v.index for v in obj.data.vertices if v.co.x < -0.95], 1, "REPLACE")
        for name, value in {"particles": 400, "pins": "pins", **how}.items():
            setattr(obj.shapebench, name, value)
        return obj

    def seen(self, obj, frame):
        """Vertices at this frame, in the world, as Blender evaluates them."""
        self.scene.frame_set(frame)
        evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
        x = np.empty(3 * len(evaluated.data.vertices), np.float32)
        evaluated.data.vertices.foreach_get("co", x)
        m = np.array(evaluated.matrix_world)
        return x.reshape(-1, 3) @ m[:3, :3].T + m[:3, 3]

    def alone(self, obj, octree=False):
        """The same motion through the module: the mesh's vertices in the world at every frame."""
        from shapebench_blender import shapebench as sb
        obj.data.calc_loop_triangles()
        m = np.array(obj.matrix_world)
        x = np.array([v.co for v in obj.data.vertices]) @ m[:3, :3].T + m[:3, 3]
        mesh = sb.Mesh(x, [t.vertices for t in obj.data.loop_triangles])
        self.assertEqual(len(mesh.vertices), len(x))
        voxels = sb.Voxels(mesh, particles=400)
        how = {"engine": "octree", "octree": sb.OctreeParams(epsilon=0.5, width_edges=1)} if octree else {"w": 2}
        with sb.Body(voxels, mesh, h=0.04 / 5, damping=0.1, gravity=self.scene.gravity, **how) as body:
            rest, cell = body.rest(), voxels.facts().cell
            ends = x[[v.index for v in obj.data.vertices if v.co.x < -0.95]]
            away = np.linalg.norm(rest[:, None] - ends[None], axis=2)
            body.hold(sorted({*np.flatnonzero(away.min(axis=1) <= 0.87 * cell), *away.argmin(axis=0)}))
            yield body.surface()
            for _ in range(FRAMES - 1):
                body.step(5)
                yield body.surface()

    def compare(self, obj, octree=False):
        rest = self.seen(obj, 1)
        for frame, wanted in enumerate(self.alone(obj, octree), 1):
            np.testing.assert_allclose(self.seen(obj, frame), wanted, atol=2e-6, err_msg=f"frame {frame}")
        moved = np.abs(wanted - rest).max(axis=1)
        self.assertGreater(moved.max(), 0.05)
        held = moved[[v.index for v in obj.data.vertices if v.co.x < -0.95]]
        self.assertLess(held.max(), (0.2 if octree else 0.05) * moved.max())  # others carry it, too

    def test_shape_keys_are_the_modules_motion(self):
        obj = self.beam()
        self.assertEqual(bpy.ops.object.shapebench_bake(), {"FINISHED"})
        self.assertEqual(self.scene.frame_current, 7)
        self.assertEqual(len(obj.data.shape_keys.key_blocks), FRAMES + 1)
        self.compare(obj)
        between = self.seen(obj, 4), self.seen(obj, 5)
        self.scene.frame_set(4, subframe=0.5)
        evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
        middle = np.array([obj.matrix_world @ v.co for v in evaluated.data.vertices])
        np.testing.assert_allclose(middle, (between[0] + between[1]) / 2, atol=2e-6)

    def test_a_point_cache_of_the_octree(self):
        obj = self.beam(engine="octree", target="CACHE", path=os.path.join(FOLDER, "beam.pc2"))
        obj.modifiers.new("Bevel", "BEVEL").show_viewport = False
        self.assertEqual(bpy.ops.object.shapebench_bake(), {"FINISHED"})
        self.assertEqual([modifier.name for modifier in obj.modifiers], ["shapebench", "Bevel"])
        self.compare(obj, octree=True)
        self.assertEqual([name for name in os.listdir(FOLDER) if ".tmp" in name], [])

    def test_baking_again_replaces_and_clear_takes_away(self):
        obj = self.beam()
        bpy.ops.object.shapebench_bake()
        first = self.seen(obj, FRAMES)
        bpy.ops.object.shapebench_bake()
        np.testing.assert_array_equal(self.seen(obj, FRAMES), first)
        self.assertEqual(len(obj.data.shape_keys.key_blocks), FRAMES + 1)
        bpy.ops.object.shapebench_clear()
        self.assertIsNone(obj.data.shape_keys)
        obj.shapebench.target, obj.shapebench.path = "CACHE", os.path.join(FOLDER, "again.pc2")
        bpy.ops.object.shapebench_bake()
        np.testing.assert_allclose(self.seen(obj, FRAMES), first, atol=2e-6)
        bpy.ops.object.shapebench_clear()
        self.assertEqual(len(obj.modifiers), 0)

    def test_what_was_there_before_stays(self):
        """An earlier bake where a new one fails, and the user's own basis and keys."""
        obj = self.beam()
        obj.shape_key_add(name="Mine", from_mix=False)
        for target in ("KEYS", "CACHE"):
            obj.shapebench.target, obj.shapebench.path = target, os.path.join(FOLDER, "stays.pc2")
            bpy.ops.object.shapebench_bake()
            wanted = self.seen(obj, FRAMES)
            obj.shapebench.pins = "nothing"
            with self.assertRaises(RuntimeError):
                bpy.ops.object.shapebench_bake()
            np.testing.assert_array_equal(self.seen(obj, FRAMES), wanted)
            obj.shapebench.pins = "pins"
        bpy.ops.object.shapebench_clear()
        self.assertEqual([key.name for key in obj.data.shape_keys.key_blocks], ["Mine"])

    def test_pins_follow_an_object(self):
        obj = self.beam()
        bpy.ops.object.empty_add(location=(3, 1, 2))
        leader = bpy.context.object
        leader.scale = (2, 2, 2)
        leader.keyframe_insert("location", frame=1)
        leader.keyframe_insert("rotation_euler", frame=1)
        leader.location, leader.rotation_euler = (3, 1, 3), (math.pi / 2, 0, 0)
        leader.keyframe_insert("location", frame=FRAMES)
        leader.keyframe_insert("rotation_euler", frame=FRAMES)
        obj.shapebench.leader = leader
        bpy.context.view_layer.objects.active = obj
        self.scene.gravity = (0, 0, 0)
        bpy.ops.object.shapebench_bake()
        pins = [v.index for v in obj.data.vertices if v.co.x < -0.95]
        rest, moved = self.seen(obj, 1)[pins], self.seen(obj, FRAMES)[pins]
        centre = np.array((3, 1, 2))
        turned = (rest - centre) @ np.array(Matrix.Rotation(math.pi / 2, 3, "X")).T + centre + (0, 0, 1)
        np.testing.assert_allclose(moved, turned, atol=0.02)

    def test_the_ground_stops(self):
        obj = self.beam(pins="", ground=True, height=1.5, steps=8)
        self.scene.frame_end = 40
        bpy.ops.object.shapebench_bake()
        lowest = [self.seen(obj, frame)[:, 2].min() for frame in (1, 20, 40)]
        self.assertGreater(lowest[0], 1.6)
        self.assertTrue(all(1.4 < z < 1.6 for z in lowest[1:]), lowest)

    def test_loose_and_double_vertices_and_a_mirror_are_carried(self):
        obj = self.beam()
        mesh = obj.data
        count = len(mesh.vertices)
        mesh.vertices.add(2)
        mesh.vertices[count].co, mesh.vertices[count + 1].co = mesh.vertices[5].co, (1.1, 0, 1)
        obj.matrix_world = obj.matrix_world @ Matrix.Diagonal((1, -1, 1, 1))
        bpy.ops.object.shapebench_bake()
        x, rest = self.seen(obj, FRAMES), self.seen(obj, 1)
        np.testing.assert_allclose(x[count], x[5], atol=1e-6)
        self.assertGreater(rest[count + 1][2] - x[count + 1][2], 0.02)

    def test_what_cannot_be_baked_is_said(self):
        obj = self.beam(pins="nothing")
        with self.assertRaisesRegex(RuntimeError, "there is no vertex group 'nothing'"):
            bpy.ops.object.shapebench_bake()
        obj.shapebench.pins, obj.shapebench.target = "", "CACHE"
        with self.assertRaisesRegex(RuntimeError, "save it, or name the cache's file"):
            bpy.ops.object.shapebench_bake()
        obj.shapebench.path = os.path.join(FOLDER, "no", "where.pc2")
        with self.assertRaisesRegex(RuntimeError, "where.pc2.*: No such file"):
            bpy.ops.object.shapebench_bake()
        self.assertEqual(len(obj.modifiers), 0)
        obj.data.clear_geometry()
        with self.assertRaisesRegex(RuntimeError, "'vertices' is 0"):
            bpy.ops.object.shapebench_bake()
        self.assertEqual(self.scene.frame_current, 7)

    def test_the_version_is_the_modules(self):
        import shapebench_blender
        self.assertEqual(".".join(map(str, shapebench_blender.bl_info["version"])), shapebench_blender.sb.__version__)

    def test_the_panel_shows_what_there_is(self):
        """Blender draws no panel without a window: a stand-in for its layout notes what is asked of it."""
        obj, shown = self.beam(), []
        layout = unittest.mock.Mock()
        layout.column.return_value = layout.row.return_value = layout
        layout.prop.side_effect = lambda how, name: shown.append((name, getattr(how, name)))
        panel = bpy.types.PHYSICS_PT_shapebench
        self.assertTrue(panel.poll(bpy.context))
        for engine, target, ground in (("fastlsm", "KEYS", False), ("octree", "CACHE", True)):
            obj.shapebench.engine, obj.shapebench.target, obj.shapebench.ground = engine, target, ground
            panel.draw(unittest.mock.Mock(layout=layout), bpy.context)
        settings = {name for name in obj.shapebench.bl_rna.properties.keys() if name not in ("rna_type", "name", "pins")}
        self.assertEqual({name for name, _ in shown}, settings)
        self.assertEqual([call.args[0] for call in layout.operator.call_args_list[:2]],
                         ["object.shapebench_bake", "object.shapebench_clear"])


if __name__ == "__main__":
    if not bpy:
        sys.exit(run_in_blender())
    ADD_ON, FOLDER = sys.argv[sys.argv.index("--") + 1:]
    ran = unittest.main(argv=["test_blender.py"], exit=False).result
    sys.exit(not ran.wasSuccessful())
