"""Blender add-on: the active mesh as a deformable body, baked as shape keys or as a point cache.

The panel is in the Physics tab. The body starts at rest at the scene's first frame, in the world's coordinates, and
falls by the scene's gravity; vertices of a vertex group are held, or follow another object."""

bl_info = {
    "name": "shapebench",
    "description": "Deformable bodies by fast lattice and by octree shape matching, baked",
    "author": "shapebench authors",
    "version": (1, 0, 0),
    "blender": (3, 3, 0),
    "location": "Properties > Physics",
    "category": "Physics",
}

import os

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty
from mathutils import Matrix
from mathutils.kdtree import KDTree

try:
    from . import shapebench as sb  # the add-on's zip has it within
except ImportError:
    try:
        import shapebench as sb
    except ImportError:
        sb = None

NAME = "shapebench"  # of the modifier, and how baked shape keys begin
NEAR = 0.87  # cells: in a cell nothing is farther than this from all of its corners
MISSING = "the Python module shapebench is missing: install the add-on's zip, or the wheel into Blender's Python"


class Settings(bpy.types.PropertyGroup):
    """What a mesh is simulated with."""

    engine: EnumProperty(name="Engine", items=[
        ("fastlsm", "Lattice", "Fast lattice shape matching: regions of equal cells"),
        ("octree", "Octree", "Octree shape matching: small cells only where the shape needs them")])
    particles: IntProperty(name="Particles", default=2000, min=8, soft_max=100000,
                           description="Wanted particles of the lattice; of the octree, corners of its finest cells")
    fill: EnumProperty(name="Fill", items=[("solid", "Solid", "With its inside"), ("shell", "Shell", "The surface alone")])
    w: IntProperty(name="Stiffness (w)", default=2, min=1, max=32,
                   description="Half-width of the lattice's regions, cells: larger is stiffer")
    width: FloatProperty(name="Stiffness (w)", default=1, min=0.1, soft_max=8,
                         description="Half-width of the octree's regions, edges of each node's cell: larger is stiffer")
    epsilon: FloatProperty(name="Epsilon", default=0.5, min=0, soft_max=1,
                           description="How far beyond w a region of the octree may reach, to be made of fewer nodes")
    damping: FloatProperty(name="Damping", default=0.1, min=0, max=1,
                           description="Share of a region's relative motion that a step takes away")
    steps: IntProperty(name="Steps a frame", default=5, min=1, soft_max=100,
                       description="Time steps from one frame to the next: more are stiffer, and slower")
    pins: StringProperty(name="Pins", description="Vertex group: where its weight is above a half, the body is held")
    leader: PointerProperty(name="Follow", type=bpy.types.Object,
                            description="An object whose motion the pins follow; none: they stay")
    ground: BoolProperty(name="Ground", description="A plane that the body does not fall through")
    height: FloatProperty(name="Height", unit="LENGTH", description="The ground's, along the world's z")
    collide: BoolProperty(name="Self-collisions", description="The body does not pass through itself")
    target: EnumProperty(name="Bake to", items=[
        ("KEYS", "Shape keys", "One for each frame, in the file"),
        ("CACHE", "Point cache", "A PC2 file, and a Mesh Cache modifier that reads it")])
    path: StringProperty(name="File", subtype="FILE_PATH", description="PC2 file; empty: beside the .blend, by the "
                         "object's name")


def world(matrix, points):
    """Points [n, 3] through a Blender matrix."""
    m = np.array(matrix)
    return points @ m[:3, :3].T + m[:3, 3]


def vertices_of(mesh):
    x = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", x)
    return x.reshape(-1, 3).astype(float)


def triangles_of(mesh):
    mesh.calc_loop_triangles()
    corner = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", corner)
    return corner.reshape(-1, 3)


def tree_of(points):
    tree = KDTree(len(points))
    for i, x in enumerate(points):
        tree.insert(x, i)
    tree.balance()
    return tree


def pinned_vertices(obj):
    """Of the vertex group that is named, which must be there."""
    name = obj.shapebench.pins
    if not name:
        return []
    group = obj.vertex_groups.get(name)
    if not group:
        raise sb.UsageError(f"{obj.name}: there is no vertex group '{name}'")
    return [vertex.index for vertex in obj.data.vertices
            if any(member.group == group.index and member.weight > 0.5 for member in vertex.groups)]


def pinned_particles(rest, points, cell):
    """The particles that are nearest to the points, and those at the corners of their cells."""
    tree, found = tree_of(rest), set()
    for x in points:
        found.add(tree.find(x)[1])
        found.update(index for _, index, _ in tree.find_range(x, NEAR * cell))
    return sorted(found)


class Simulation:
    """A mesh as a body, from the scene's first frame on."""

    def __init__(self, obj, scene):
        how = obj.shapebench
        self.obj, self.scene, self.how = obj, scene, how
        self.local = vertices_of(obj.data)
        x = world(obj.matrix_world, self.local)
        mirrored = obj.matrix_world.determinant() < 0
        surface = sb.Mesh(x, triangles_of(obj.data)[:, ::-1 if mirrored else 1])
        voxels = sb.Voxels(surface, particles=how.particles, fill=how.fill, fewer=True)
        frame = scene.render.fps_base / scene.render.fps
        octree = sb.OctreeParams(epsilon=how.epsilon, width_edges=how.width) if how.engine == "octree" else None
        self.body = sb.Body(voxels, surface, engine=how.engine, octree=octree, w=how.w, h=frame / how.steps,
                            damping=how.damping, collide_self=how.collide,
                            gravity=tuple(scene.gravity) if scene.use_gravity else None)
        if how.ground:
            self.body.add_plane((0, 0, how.height), (0, 0, 1), friction=0.3)
        self._carry(x)
        self._pin(x, voxels.facts().cell)

    def _carry(self, x):
        """Which of the surface's vertices carries each of the mesh's: equal ones were merged, loose ones left out."""
        rest = self.body.surface_rest()
        tree = tree_of(rest)
        self.carrier = np.array([tree.find(point)[1] for point in x])
        self.offset = x - rest[self.carrier]

    def _pin(self, x, cell):
        pins = pinned_vertices(self.obj)
        self.handle = None
        if pins:
            self.handle = self.body.hold(pinned_particles(self.body.rest(), x[pins], cell))
        self.start = self.leader()

    def leader(self):
        """The leader's place, its scale left out, or None."""
        if not self.how.leader or not self.handle:
            return None
        place, turn, _ = self.how.leader.matrix_world.decompose()
        return Matrix.Translation(place) @ turn.to_matrix().to_4x4()

    def lead(self, before, after, share):
        """Moves the pins to where the leader is between two frames."""
        place = before.to_translation().lerp(after.to_translation(), share)
        turn = before.to_quaternion().slerp(after.to_quaternion(), share)
        motion = Matrix.Translation(place) @ turn.to_matrix().to_4x4() @ self.start.inverted()
        self.handle.move(rigid(motion))

    def advance(self, frame):
        """To the scene's frame, which is the next one."""
        before = self.leader()
        self.scene.frame_set(frame)
        after = self.leader()
        if before is None:
            self.body.step(self.how.steps)
            return
        for step in range(self.how.steps):
            self.lead(before, after, (step + 1) / self.how.steps)
            self.body.step()

    def points(self):
        """[n, 3]: the mesh's vertices now, in the object's own coordinates."""
        x = self.body.surface()[self.carrier] + self.offset
        return world(self.obj.matrix_world.inverted(), x).astype(np.float32)


def rigid(matrix):
    """[3, 4] of a Blender matrix, whose numbers are single: its rotation made exact."""
    m = np.array(matrix)
    u, _, v = np.linalg.svd(m[:3, :3])
    return np.column_stack((u @ v, m[:3, 3]))


def frames(simulation, scene, progress):
    """The mesh's vertices at each of the scene's frames."""
    for frame in range(scene.frame_start, scene.frame_end + 1):
        if frame > scene.frame_start:
            simulation.advance(frame)
        progress(frame)
        yield frame, simulation.points()


def clear(obj):
    """Takes away what was baked, but for files."""
    keys = obj.data.shape_keys
    baked = [key for key in keys.key_blocks if key.name.startswith(NAME + " ")] if keys else []
    for key in baked:
        path = key.path_from_id("value")
        curve = keys.animation_data and keys.animation_data.action and keys.animation_data.action.fcurves.find(path)
        if curve:
            keys.animation_data.action.fcurves.remove(curve)
        obj.shape_key_remove(key)
    if baked and len(keys.key_blocks) == 1 and NAME in keys:
        obj.shape_key_remove(keys.key_blocks[0])  # the basis, which was made for them
    if NAME in obj.modifiers:
        obj.modifiers.remove(obj.modifiers[NAME])


def add_key(obj, frame, points):
    """A shape key that is seen at this frame, and fades towards its neighbours."""
    if not obj.data.shape_keys:
        obj.shape_key_add(name="Basis", from_mix=False)
        obj.data.shape_keys[NAME] = True
    key = obj.shape_key_add(name=f"{NAME} {frame}", from_mix=False)
    key.data.foreach_set("co", points.ravel())
    keys = obj.data.shape_keys
    if not keys.animation_data:
        keys.animation_data_create()
    if not keys.animation_data.action:
        keys.animation_data.action = bpy.data.actions.new(f"{obj.name} {NAME}")
    curve = keys.animation_data.action.fcurves.new(key.path_from_id("value"))
    curve.keyframe_points.add(3)
    for point, place in zip(curve.keyframe_points, ((frame - 1, 0), (frame, 1), (frame + 1, 0))):
        point.co, point.interpolation = place, "LINEAR"
    curve.extrapolation = "CONSTANT"
    curve.update()


def cache_path(obj):
    """Where the point cache goes, as Blender writes it."""
    if obj.shapebench.path:
        return obj.shapebench.path
    if not bpy.data.filepath:
        raise sb.UsageError("the file has no place yet: save it, or name the cache's file")
    return f"//{bpy.path.clean_name(obj.name)}.pc2"


def bake_cache(obj, scene, steps):
    path = cache_path(obj)
    where = os.path.abspath(bpy.path.abspath(path))
    sb.export.write_pc2(where, (points for _, points in steps), overwrite=True)
    clear(obj)
    modifier = obj.modifiers.new(NAME, "MESH_CACHE")
    modifier.cache_format, modifier.filepath, modifier.frame_start = "PC2", path, scene.frame_start
    modifier.forward_axis, modifier.up_axis = "POS_Y", "POS_Z"
    with bpy.context.temp_override(object=obj):
        bpy.ops.object.modifier_move_to_index(modifier=NAME, index=0)


def bake_keys(obj, _, steps):
    baked = list(steps)
    clear(obj)
    for frame, points in baked:
        add_key(obj, frame, points)


def bake(obj, scene, progress=lambda frame: None):
    """Simulates the mesh over the scene's frames, and keeps what comes of it in place of what was baked before, which
    stays where it cannot be done."""
    current = scene.frame_current
    try:
        scene.frame_set(scene.frame_start)
        simulation = Simulation(obj, scene)
        with simulation.body:
            {"KEYS": bake_keys, "CACHE": bake_cache}[obj.shapebench.target](obj, scene, frames(simulation, scene, progress))
    finally:
        scene.frame_set(current)


class OnMesh(bpy.types.Operator):
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.object and context.object.type == "MESH" and context.object.mode == "OBJECT"


class Bake(OnMesh):
    """Simulate the mesh over the scene's frames, and bake its motion in place of an earlier one"""

    bl_idname, bl_label = "object.shapebench_bake", "Bake"

    def execute(self, context):
        if sb is None:
            self.report({"ERROR"}, MISSING)
            return {"CANCELLED"}
        scene, manager = context.scene, context.window_manager
        manager.progress_begin(scene.frame_start, scene.frame_end)
        try:
            bake(context.object, scene, manager.progress_update)
        except (sb.Error, ImportError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        except OSError as error:
            self.report({"ERROR"}, f"{error.filename}: {error.strerror}")
            return {"CANCELLED"}
        finally:
            manager.progress_end()
        return {"FINISHED"}


class Clear(OnMesh):
    """Take the baked motion away; a point cache's file stays"""

    bl_idname, bl_label = "object.shapebench_clear", "Clear"

    def execute(self, context):
        clear(context.object)
        return {"FINISHED"}


class Panel(bpy.types.Panel):
    bl_idname, bl_label = "PHYSICS_PT_shapebench", "Shape matching"
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "physics"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.object and context.object.type == "MESH"

    def draw(self, context):
        obj, column = context.object, self.layout.column()
        how = obj.shapebench
        column.use_property_split = True
        octree = how.engine == "octree"
        for name in ("engine", "particles", "fill", *(("width", "epsilon") if octree else ("w",)), "damping", "steps"):
            column.prop(how, name)
        column.prop_search(how, "pins", obj, "vertex_groups")
        for name in ("leader", "ground", *(("height",) if how.ground else ()), "collide", "target",
                     *(("path",) if how.target == "CACHE" else ())):
            column.prop(how, name)
        row = column.row()
        row.operator(Bake.bl_idname)
        row.operator(Clear.bl_idname)


CLASSES = (Settings, Bake, Clear, Panel)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Object.shapebench = PointerProperty(type=Settings)


def unregister():
    del bpy.types.Object.shapebench
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
