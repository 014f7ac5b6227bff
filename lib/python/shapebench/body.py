"""Bodies, and what holds, stops, cuts and refines them."""

from __future__ import annotations

import ctypes
import math
import threading
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Callable, Iterator, List, Optional, Sequence, Tuple, Type, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import face
from .geometry import Made, Mesh, Voxels
from .picture import draw

Doubles = NDArray[np.float64]
Numbers = NDArray[np.int64]
Ints = NDArray[np.int32]
Choice = Union[str, int, None]  # of an enum: a member's name, without what all begin with, or its number

CHOICES = {"precision": "SB_SINGLE", "summation": "SB_SUM_FAST", "polar": "SB_POLAR_FAST",
           "layout": "SB_LAYOUT_AUTO", "kind": "SB_CELLS_ALL", "mass_rule": "SB_MASS_MATERIAL",
           "symmetry": "SB_SYMMETRY_UNION", "weighting": "SB_WEIGHT_CONSERVING", "goals": "SB_GOALS_GATHER"}


@dataclass
class Criterion:
    """Which cells of an octree are split (octree section 4.1): "all"; "features": where a coarse cell would weld what is
    apart; at the "surface"; that meet a "box"; that meet a "sphere". `level` is the deepest to split to; 0: the deepest
    there is."""

    kind: str
    level: int = 0
    low: Optional[ArrayLike] = None
    high: Optional[ArrayLike] = None
    centre: Optional[ArrayLike] = None
    radius: Optional[float] = None


@dataclass
class LocalWidth:
    """The width of regions of nodes in a box, or in a ball if `radius` > 0; `cells` and `edges` as width_cells and
    width_edges in OctreeParams."""

    cells: float = 0
    edges: float = 0
    low: Optional[ArrayLike] = None
    high: Optional[ArrayLike] = None
    centre: Optional[ArrayLike] = None
    radius: Optional[float] = None


@dataclass
class OctreeParams:
    """What the octree asks beyond what all engines do; sb_octree_params in shapebench.h. None: the library's default."""

    levels: Optional[int] = None  # a base cell is 2^levels finest cells wide, 1 to 12; 0: chosen by the size
    balance: Optional[int] = None  # 1: cells that touch differ by one level at most
    nodes: Optional[int] = None  # wanted simulation nodes; 0: what the criteria give
    bases: Optional[int] = None  # wanted base cells; 0: what the corner gives
    corner: Optional[ArrayLike] = None  # of the base lattice, finest cells; not used with `bases`
    criteria: Sequence[Criterion] = ()  # 16 at most; none: "features"
    epsilon: Optional[float] = None  # octree section 4.3: 0 or more
    width_cells: Optional[float] = None  # w_i = cells + edges * (the node's own edge), in finest cells
    width_edges: Optional[float] = None  # both 0: one edge
    summation_nodes: Optional[float] = None  # wanted per region on average: edges are searched for; 0: not
    widths: Sequence[LocalWidth] = ()  # 16 at most; the last that holds a node's centre counts
    mass_rule: Choice = None  # "material": a node weighs its material; "volume": as its cell were it full
    symmetry: Choice = None  # of regions: "union", "intersection", "none" (with goals "adjoint")
    weighting: Choice = None  # "conserving" keeps momentum; "plain": octree eqs. 6 and 7 as printed
    goals: Choice = None  # "gather" or "adjoint"
    yield_: Optional[float] = None  # plasticity (octree eq. 9) from this strain on
    creep: Optional[float] = None  # rate, 0 (elastic) to 1 / h per second
    most: Optional[float] = None  # largest plastic strain; 0: 1


@dataclass
class MeshlessParams:
    """What the meshless engine asks beyond what all do; sb_meshless_params in shapebench.h. None: the library's
    default. Units are the mesh's, kg and s: pascals where it is in metres."""

    young: Optional[float] = None  # Young's modulus
    poisson: Optional[float] = None  # Poisson's ratio, -0.99 to 0.49
    density: Optional[float] = None
    stiffness_damping: Optional[float] = None  # Rayleigh's b, s
    points: Optional[int] = None  # on the surface, of which the body is made; 0: 12000, of thin bodies more
    nodes: Optional[int] = None  # wanted; 0: 1000
    modes: Optional[int] = None  # natural ones, 7 to 1000; 0: 64


@dataclass
class ShellParams:
    """What a thin shell asks beyond what all engines do; sb_shell_params in shapebench.h. None: the library's default.
    Units are the mesh's, kg and s: pascals where it is in metres. One that cracks has other vertices in its surface, of
    two sheets a thickness apart, after each step() in which a crack grew."""

    young: Optional[float] = None  # Young's modulus
    poisson: Optional[float] = None  # Poisson's ratio, -0.99 to 0.49
    density: Optional[float] = None
    stiffness_damping: Optional[float] = None  # Rayleigh's b, s
    nodes: Optional[int] = None  # wanted; 0: 450
    thickness: Optional[float] = None  # 0: a hundredth of the mesh's longest extent
    covers: Optional[float] = None  # width of nodes' linear functions, edges of their cells, to 12; 0: quadratic
    strength: Optional[float] = None  # it cracks where its largest principal stress is above this; 0: never
    branching: Optional[float] = None  # times the strength from which on a crack goes on in two; 0: never
    pressure: Optional[float] = None  # inside a closed one; it acts along the normals at rest
    pulse: Optional[float] = None  # seconds from the beginning in which the pressure acts


@dataclass(frozen=True)
class Counts:
    """What a body is and has done; sb_body_counts in shapebench.h."""

    particles: int  # of all instances; particle p of instance k is number k * n + p, n = particles / instances
    instances: int
    steps: int  # done so far
    time: float  # steps * h
    regions: int  # different ones of one instance; of meshless bodies and shells nodes
    links: int  # between neighbours, unbroken, of one instance
    broken: int
    contacts: int  # of the last step, but those with obstacles
    bytes: int  # of memory that making the engine took; 0: not known
    build_seconds: float  # that creation took
    summation_nodes: float  # mean per region; octree
    cut_triangles: int  # that its cut consists of
    surface_vertices: int  # of one instance, like the next; both 0 without a surface
    surface_triangles: int
    surface_incomplete: int  # 1: some of a cut could not be made in the surface, which crosses itself there
    stopped: int  # 1: a crack of a shell could not be followed: it stands still


def _names() -> List[str]:
    """Of all engines, by number."""
    names: List[str] = []
    while (name := face.text("sb_engine_name", len(names))) is not None:
        names.append(name)
    return names


def _engine(engine: Choice) -> Choice:
    """Its number; other numbers are the library's to judge."""
    if not isinstance(engine, str):
        return engine
    names = _names()
    if engine not in names:
        raise face.UsageError(f"'engine' is '{engine}': it is one of {', '.join(names)}")
    return names.index(engine)


def engines() -> List[str]:
    """Names of the engines of which this library can make bodies: "fastlsm", "octree", "brute", "meshless", "shell"."""
    return [name for number, name in enumerate(_names()) if face.library().sb_engine_available(number)]


def pose(translation: ArrayLike = (0, 0, 0), *, axis: ArrayLike = (0, 0, 1), angle: float = 0,
         centre: ArrayLike = (0, 0, 0)) -> Doubles:
    """The rigid motion [3, 4] that turns by `angle` radians about `axis` through `centre`, and then moves on."""
    a, c = face.array(axis, np.float64, "axis", 3), face.array(centre, np.float64, "centre", 3)
    length = np.linalg.norm(a)
    if not 0 < length < math.inf:
        raise face.UsageError("'axis' has no direction")
    x, y, z = a / length
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    move = c - turn @ c + face.array(translation, np.float64, "translation", 3)
    return np.column_stack((turn, move))


def _members(of: Any) -> Iterator[Tuple[str, Any]]:
    return ((name.rstrip("_"), value) for name, value in vars(of).items())


def _octree(octree: OctreeParams) -> Any:
    """The struct, with its arrays of structs and how many of each."""
    plain = [(name, value) for name, value in _members(octree) if name not in ("criteria", "widths")]
    made = face.params("sb_octree_params", plain, CHOICES)
    for name, count in (("criteria", "criteria_count"), ("widths", "width_count")):
        items = getattr(octree, name)
        if len(items) > len(getattr(made, name)):
            raise face.UsageError(f"'{name}' has {len(items)} entries: {len(getattr(made, name))} at most")
        for place, item in zip(getattr(made, name), items):
            for member, value in _members(item):
                if value is not None:
                    face.put(place, member, value, CHOICES)
        setattr(made, count, len(items))
    return made


def _mass(mass: ArrayLike, voxels: Voxels) -> Doubles:
    return face.array(mass, np.float64, "mass", voxels.facts().particles)


class Body(Made):
    """A deformable body of `voxels`, at rest, that may carry the mesh `surface`; a "meshless" body is made of it, closed,
    and a "shell", of one component, whose particles are its vertices.

    What is None is the library's default, which is said here. O(particles), up to a few microseconds each.

        engine             "fastlsm"; "octree", and in double precision alone "brute", "meshless", "shell"
        precision          "single" (twice as fast) where the engine has it; "double"
        w                  2; half-width of FastLSM's regions in cells, 1 to 32: larger is stiffer
        threads            0: OpenMP's number, at most the cores of affinity and container's quota; any number gives
                           the same bits
        h                  0.01; time step, s; dt is the same
        gravity            (0, 0, 0)
        damping            0; of regions' motion relative to rigid, 0 to 1 (fastlsm eq. 14)
        damping_every      1; n: in every n-th step
        cuttable           False; cut() and blades work. The octree's bodies always are; FastLSM's cost some memory more,
                           and meshless ones' modes are found anew at every cut
        strain_limit       0: none; a link of FastLSM longer than this times its rest length breaks, above 1
        summation          "fast"; "bars", "naive": fastlsm section 3, prefix sums along bars only, and none
        polar              "fast"; "jacobi": how rotations are found
        layout             "auto"; "lists", "blocks": of FastLSM, same results, to rounding
        collide_self       False; the body with itself
        collide_instances  False; instances with each other
        collide_friction   0; share of tangential velocity lost on contact, 0 to 1
        instances          1; bodies of the same voxels, which share memory
        pose               at rest; [instances, 3, 4]: from rest to where each starts
        mass               1 each, of the octree 1 a cell; [particles of the voxels], kg
        octree             what this engine asks beyond that,
        meshless, shell    and what these do

    Use it with `with`, or close() it, to have its memory back at once; else it goes with the last reference.

    Threads: a body lets in one thread at a time; others wait. The interpreter's lock is released in every call, so that
    other threads run, and step other bodies, meanwhile. Ctrl-C is seen after the call: step a long time in parts. A
    process that was forked (multiprocessing's "fork") must use threads=1 or not step; "spawn" is free of that."""

    _free = "sb_body_free"

    def __init__(self, voxels: Voxels, surface: Optional[Mesh] = None, *, engine: Choice = None, precision: Choice = None,
                 w: Optional[int] = None, threads: Optional[int] = None, h: Optional[float] = None,
                 gravity: Optional[ArrayLike] = None, damping: Optional[float] = None, damping_every: Optional[int] = None,
                 cuttable: Optional[bool] = None, strain_limit: Optional[float] = None, summation: Choice = None,
                 polar: Choice = None, layout: Choice = None, collide_self: Optional[bool] = None,
                 collide_instances: Optional[bool] = None, collide_friction: Optional[float] = None,
                 instances: Optional[int] = None, pose: Optional[ArrayLike] = None, mass: Optional[ArrayLike] = None,
                 octree: Optional[OctreeParams] = None, meshless: Optional[MeshlessParams] = None,
                 shell: Optional[ShellParams] = None, dt: Optional[float] = None) -> None:
        if dt is not None and h is not None:
            raise face.UsageError("'h' and 'dt' are both the time step: give one of them")
        h = h if dt is None else dt
        if precision is None and engine in ("brute", "meshless", "shell"):
            precision = "double"
        given = [("engine", _engine(engine)), ("precision", precision), ("w", w), ("threads", threads), ("h", h),
                 ("gravity", gravity), ("damping", damping), ("damping_every", damping_every), ("cuttable", cuttable),
                 ("strain_limit", strain_limit), ("summation", summation), ("polar", polar), ("layout", layout),
                 ("collide_self", collide_self), ("collide_instances", collide_instances),
                 ("collide_friction", collide_friction), ("instances", instances),
                 ("pose", None if pose is None else face.array(pose, np.float64, "pose", max(1, instances or 1), 12)),
                 ("mass", None if mass is None else _mass(mass, voxels)),
                 ("octree", octree and _octree(octree)),
                 ("meshless", meshless and face.params("sb_meshless_params", _members(meshless), {})),
                 ("shell", shell and face.params("sb_shell_params", _members(shell), {}))]
        params = face.params("sb_body_params", given, CHOICES)
        self._lock = threading.RLock()
        self._sizes: Optional[Counts] = None  # as long as nothing has changed them
        self._take("sb_body_create", Voxels._of(voxels, "voxels"),
                   None if surface is None else Mesh._of(surface, "surface"), ctypes.byref(params))

    def __repr__(self) -> str:
        if self._handle is None:
            return "<Body: closed>"
        counts = self.counts()
        bodies = f"{counts.instances} bodies, " if counts.instances > 1 else ""
        return f"<Body: {bodies}{counts.particles} particles, {counts.steps} steps, {counts.time:g} s>"

    def __enter__(self) -> "Body":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 where: Optional[TracebackType]) -> None:
        self.close()

    def close(self) -> None:
        """Frees the body, once no thread is in it. Twice does no harm."""
        with self._lock:
            self._handle = None
            self._end()

    def _call(self, name: str, *arguments: Any) -> None:
        with self._lock:
            if self._handle is None:
                raise face.UsageError("the body is closed: make another one")
            face.call(name, self._handle, *arguments)

    def _number(self, name: str, kind: Any, *arguments: Any) -> int:
        """A call that gives a number."""
        number = kind()
        self._call(name, *arguments, ctypes.byref(number))
        return int(number.value)

    def _change(self, name: str, *arguments: Any) -> int:
        """A call after which numbers may be others, and which may say how much has changed."""
        with self._lock:
            self._sizes = None
            return self._number(name, ctypes.c_int64, *arguments)

    # ---- steps and counts

    def step(self, steps: int = 1) -> None:
        """Steps of h seconds (fastlsm eqs. 1 and 2), all in one call. 20 to 200 ns a particle, step and thread."""
        with self._lock:
            self._sizes = None  # links and cracks that break part the surface, too
            self._call("sb_body_step", face.whole(steps, "steps"))

    def counts(self) -> Counts:
        """What the body is and has done."""
        with self._lock:
            if self._handle is None:
                raise face.UsageError("the body is closed: make another one")
            return Counts(**face.filled("sb_body_counts", "sb_body_count", self._handle))

    def _size(self, member: str) -> int:
        with self._lock:
            if self._sizes is None or self._handle is None:
                self._sizes = self.counts()
            return int(getattr(self._sizes, member))

    @property
    def particle_count(self) -> int:
        """Of all instances."""
        return self._size("particles")

    # ---- particles

    def _read(self, name: str, out: Optional[NDArray[Any]], kind: Any, count: Callable[[], int], *columns: int,
              first: Tuple[Any, ...] = ()) -> NDArray[Any]:
        """What `name` fills with `count()` rows, in `out` where it is given."""
        with self._lock:
            values = face.room(out, kind, count(), *columns)
            self._call(name, *first, face.pointer(values), len(values))
        return values

    def _field(self, field: str, out: Optional[Doubles]) -> Doubles:
        number = (face.header.constant[field],)
        return self._read("sb_body_read", out, np.float64, lambda: self.particle_count, 3, first=number)

    def _own(self) -> int:
        """Particles of one instance."""
        return self.particle_count // self._size("instances")

    def rest(self, out: Optional[Doubles] = None) -> Doubles:
        """[particles, 3]: where they rest, the instances' poses in it. FastLSM's particles are the lattice's vertices,
        the octree's are simulation nodes, in the middle of their cells. `out`, here and below, is filled instead of a
        new array."""
        return self._field("SB_REST", out)

    def positions(self, out: Optional[Doubles] = None) -> Doubles:
        """[particles, 3]: where they are."""
        return self._field("SB_POSITION", out)

    def velocities(self, out: Optional[Doubles] = None) -> Doubles:
        """[particles, 3]."""
        return self._field("SB_VELOCITY", out)

    def goals(self, out: Optional[Doubles] = None) -> Doubles:
        """[particles, 3]: goal positions (fastlsm eq. 12) of the present positions; about half a step. Not of a
        shell."""
        return self._field("SB_GOAL", out)

    def _write(self, field: str, values: ArrayLike, name: str) -> None:
        rows = face.array(values, np.float64, name, None, 3)
        self._call("sb_body_write", face.header.constant[field], face.pointer(rows), len(rows))

    def set_positions(self, positions: ArrayLike) -> None:
        """Of all particles, within 1e9 cells of the body's rest; not of a shell, which handles and pushes move."""
        self._write("SB_POSITION", positions, "positions")

    def set_velocities(self, velocities: ArrayLike) -> None:
        """Of all particles, within 1e9 cells a step; not of a shell."""
        self._write("SB_VELOCITY", velocities, "velocities")

    def push(self, particles: ArrayLike, impulses: ArrayLike) -> None:
        """Adds impulse / mass to the velocities of some particles, N s: a force f over the next step is the impulse
        f * h."""
        numbers = face.array(particles, np.int64, "particles", None)
        shares = face.array(impulses, np.float64, "impulses", len(numbers), 3)
        self._call("sb_body_push", len(numbers), face.pointer(numbers), face.pointer(shares))

    def masses(self, out: Optional[Doubles] = None) -> Doubles:
        """[particles of one instance], kg."""
        return self._read("sb_body_read_masses", out, np.float64, self._own)

    def region(self, particle: int) -> Numbers:
        """Members of a particle's region, rising; not of a shell."""
        return self._list("sb_body_read_region", np.int64, face.whole(particle, "particle"))

    def _list(self, name: str, kind: Any, *first: Any) -> NDArray[Any]:
        """What nobody knows how long it is."""
        count = ctypes.c_int64()
        with self._lock:
            self._call(name, *first, None, 0, ctypes.byref(count))
            values = np.empty(count.value, kind)
            self._call(name, *first, face.pointer(values), len(values), ctypes.byref(count))
        return values

    def shapes(self, out: Optional[Doubles] = None) -> Doubles:
        """[particles, 3, 3]: rest shapes of all particles' regions, what a plastic body has kept (octree eq. 9)."""
        return self._read("sb_body_read_shapes", out, np.float64, lambda: self.particle_count, 3, 3)

    def set_shapes(self, shapes: ArrayLike) -> None:
        """Of a plastic body."""
        rows = face.array(shapes, np.float64, "shapes", None, 9)
        self._call("sb_body_write_shapes", face.pointer(rows), len(rows))

    def select_box(self, low: ArrayLike, high: ArrayLike) -> Numbers:
        """Particles that rest in a box, faces included: their numbers, rising."""
        a, b = face.array(low, np.float64, "low", 3), face.array(high, np.float64, "high", 3)
        return self._list("sb_body_select_box", np.int64, face.pointer(a), face.pointer(b))

    def select_ball(self, centre: ArrayLike, radius: float) -> Numbers:
        """Particles that rest in a ball."""
        c = face.array(centre, np.float64, "centre", 3)
        return self._list("sb_body_select_ball", np.int64, face.pointer(c), radius)

    def contacts(self) -> NDArray[Any]:
        """Contacts of the present positions, in any order: records of sb_contact, particle, cell, depth, out [3], weight
        [8]. None of a body whose parameters ask for no collisions."""
        return self._list("sb_body_read_contacts", np.dtype(face.header.struct["sb_contact"]))

    def levels(self) -> Ints:
        """[particles of one instance]: level of every particle's cell, 0 of a base cell; of an octree."""
        return self._read("sb_body_read_levels", None, np.int32, self._own)

    def pieces(self) -> Ints:
        """[particles of one instance]: the piece that every particle is in, numbered from 0; not of a shell that
        cracks."""
        with self._lock:
            values = np.empty(self._own(), np.int32)
            self._number("sb_body_read_pieces", ctypes.c_int64, face.pointer(values), len(values))
        return values

    # ---- handles and obstacles

    def hold(self, particles: ArrayLike) -> "Handle":
        """Holds particles where they rest, none of which may be held already; the Handle moves them."""
        numbers = face.array(particles, np.int64, "particles", None)
        return Handle(self, self._number("sb_body_add_handle", ctypes.c_int, len(numbers), face.pointer(numbers)))

    def add_plane(self, point: ArrayLike, normal: ArrayLike, friction: float = 0) -> "Obstacle":
        """`normal` leads towards the free side. `friction`, here and below, is the share of tangential velocity that is
        lost on contact, 0 to 1. Thin obstacles stop only what moves by less than half their thickness in a step."""
        return self._obstacle("sb_body_add_plane", point, normal, friction)

    def add_sphere(self, centre: ArrayLike, radius: float, friction: float = 0) -> "Obstacle":
        return self._obstacle("sb_body_add_sphere", centre, radius, friction)

    def add_box(self, low: ArrayLike, high: ArrayLike, friction: float = 0) -> "Obstacle":
        return self._obstacle("sb_body_add_box", low, high, friction)

    def add_capsule(self, a: ArrayLike, b: ArrayLike, radius: float, friction: float = 0) -> "Obstacle":
        """What is within `radius` of the segment from `a` to `b`."""
        return self._obstacle("sb_body_add_capsule", a, b, radius, friction)

    def _obstacle(self, name: str, *arguments: Any) -> "Obstacle":
        kept = [value if np.isscalar(value) else face.array(value, np.float64, "a point", 3) for value in arguments]
        sent = [face.pointer(value) if isinstance(value, np.ndarray) else value for value in kept]
        return Obstacle(self, self._number(name, ctypes.c_int, *sent))

    # ---- cuts, and resampling an octree while it runs; numbers of an octree's particles change

    def cut(self, vertices: ArrayLike, triangles: ArrayLike) -> None:
        """Cuts material and surface where the triangles pass, which are given in the rest position, before any pose; they
        may reach beyond it. Of a body of one instance that is `cuttable`, or an octree. O(triangles), and what is near
        them."""
        x = face.array(vertices, np.float64, "vertices", None, 3)
        corners = face.array(triangles, np.int32, "triangles", None, 3)
        with self._lock:
            self._sizes = None
            self._call("sb_body_cut", len(x), face.pointer(x), len(corners), face.pointer(corners))

    def add_blade(self, level: int = 0, reach: float = 0) -> "Blade":
        """A blade, nowhere yet. An octree's cells within `reach` of its cut are split down to `level`; 0: none."""
        return Blade(self, self._number("sb_body_add_blade", ctypes.c_int, face.whole(level, "level", 32), reach))

    def add_detail(self) -> "Detail":
        """What will be split for one reason, and merged again when that is gone; of an octree."""
        return Detail(self, self._number("sb_body_add_detail", ctypes.c_int))

    # ---- the surface (fastlsm section 4, octree section 7)

    def _surface_size(self) -> int:
        return self._size("instances") * self._size("surface_vertices")

    def surface(self, out: Optional[Doubles] = None, *, normals: Optional[Doubles] = None) -> Doubles:
        """[instances * vertices, 3]: where the surface's vertices are, one instance after the other. `normals` [the
        same] is filled with unit normals; one that has none is 0."""
        with self._lock:
            count = self._surface_size()
            values = face.room(out, np.float64, count, 3)
            unit = None if normals is None else face.room(normals, np.float64, count, 3)
            self._call("sb_body_read_surface", face.pointer(values), face.pointer(unit), count)
        return values

    def surface_triangles(self) -> Ints:
        """[m, 3] of one instance; the numbers of vertices stay through cuts, new ones follow, but for a shell that
        cracks."""
        return self._read("sb_body_read_surface_triangles", None, np.int32, lambda: self._size("surface_triangles"), 3)

    def surface_rest(self) -> Doubles:
        """[vertices, 3] of one instance at rest, before any pose: for textures, and for what cuts have added."""
        return self._read("sb_body_read_surface_rest", None, np.float64, lambda: self._size("surface_vertices"), 3)

    def plot(self, ax: Any = None) -> Any:
        """A picture of the first instance's surface with y up: by PyVista where it is installed, else by matplotlib, in
        the axes `ax` where they are given. Returns the plotter, or the axes."""
        return draw(self.surface()[:self._size("surface_vertices")], self.surface_triangles(), ax)


class Part:
    """Something of a body, by its number."""

    def __init__(self, body: Body, number: int) -> None:
        self.body, self.number = body, number


class Handle(Part):
    """Particles that follow a rigid motion."""

    def move(self, pose: ArrayLike) -> None:
        """Where the particles are from the next step on: pose * (rest, 1), of a rigid motion [3, 4] such as pose()
        makes; one step goes all the way."""
        motion = face.array(pose, np.float64, "pose", 12)
        self.body._call("sb_body_move_handle", self.number, face.pointer(motion))

    def release(self) -> None:
        """Lets the particles go."""
        self.body._call("sb_body_remove_handle", self.number)


class Obstacle(Part):
    """What stops particles, and does not move."""

    def remove(self) -> None:
        self.body._call("sb_body_remove_obstacle", self.number)


class Blade(Part):
    """What cuts while it moves through a body."""

    def sweep(self, a: ArrayLike, b: ArrayLike) -> int:
        """Moves it straight to the segment from `a` to `b`, in the world, and cuts what it sweeps over; the first time it
        is only put there. How many triangles the cut has gained: none while it has moved less than half a cell through
        material since it last cut."""
        ends = [face.array(end, np.float64, "end", 3) for end in (a, b)]
        return self.body._change("sb_body_sweep_blade", self.number, *map(face.pointer, ends))

    def lift(self) -> None:
        """Takes it out: where it is moved next, it is only put."""
        self.body._call("sb_body_lift_blade", self.number)


class Detail(Part):
    """Cells of an octree that are split while there is a reason (octree section 5). To be called before every step or
    every few; both give how many cells were split and merged."""

    def ball(self, centre: ArrayLike, radius: float, level: int, hold: float = 0) -> int:
        """Splits cells that meet the ball, given at rest, down to `level`. What was split before and is not in it is
        merged once `hold` seconds have passed since it last was; radius 0: the detail ends."""
        c = face.array(centre, np.float64, "centre", 3)
        return self.body._change("sb_body_detail_ball", self.number, face.pointer(c), radius,
                                 face.whole(level, "level", 32), hold)

    def eye(self, eye: ArrayLike, near_distance: float, level: int, slack: float = 0, hold: float = 0) -> int:
        """The same of cells nearer than `near_distance` to an eye, down to `level`, and to a level less with every
        doubling of the distance; cells that are split stay so until farther by the share `slack`."""
        e = face.array(eye, np.float64, "eye", 3)
        return self.body._change("sb_body_detail_eye", self.number, face.pointer(e), near_distance, slack,
                                 face.whole(level, "level", 32), hold)

