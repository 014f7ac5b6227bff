"""Meshes and voxels: what bodies are made of."""

from __future__ import annotations

import ctypes
import os
import warnings
import weakref
from dataclasses import dataclass
from typing import Any, List, Optional, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import face

Three = Tuple[float, float, float]


@dataclass(frozen=True)
class MeshFacts:
    """What a mesh is; sb_mesh_facts in shapebench.h."""

    vertices: int
    triangles: int
    components: int  # connected through shared vertices
    open_edges: int  # used by one triangle
    nonmanifold_edges: int  # used by more than two
    flipped_edges: int  # used by two triangles of opposite orientation
    degenerate: int  # triangles without area
    duplicates: int  # triangles whose corners an earlier one has, too
    watertight: int  # 1: no open and no non-manifold edge
    low: Three  # bounding box
    high: Three
    volume: float  # below 0 if inside out; NaN of a mesh that bounds none
    left_out: int  # points, lines, curves and further scenes of its file, which it lacks


@dataclass(frozen=True)
class VoxelFacts:
    """What a lattice of cells with material is; sb_voxel_facts in shapebench.h."""

    cells: Tuple[int, int, int]  # along x, y, z
    inside: int  # how the inside was found: 0 not, 1 exactly, 2 holes narrower than a cell, 3 rays have decided
    origin: Three  # corner of cell (0, 0, 0)
    cell: float  # edge of a cell
    material: int  # cells with material
    particles: int  # vertices of these
    shell_cells: int  # that a triangle touches
    flooded_cells: int  # that the outside cannot reach
    voted_cells: int  # that rays have added


def shapes() -> List[str]:
    """Names of the procedural models that Mesh.shape() makes."""
    names: List[str] = []
    while (name := face.text("sb_shape_name", len(names))) is not None:
        names.append(name)
    return names


class Made:
    """What the library has made, and frees with the last reference to it."""

    _free: str

    @classmethod
    def _of(cls, value: Any, name: str) -> Any:
        """The handle of one of these; of anything else the library would take the bytes for it."""
        if not isinstance(value, cls):
            raise face.UsageError(f"'{name}' is a {type(value).__name__}: a {cls.__name__} is wanted")
        return value._handle

    def _take(self, function: str, *arguments: Any) -> None:
        handle = ctypes.c_void_p()
        face.call(function, *arguments, ctypes.byref(handle))
        self._handle: Optional[ctypes.c_void_p] = handle
        self._end = weakref.finalize(self, getattr(face.library(), self._free), handle)
        self._end.atexit = False  # the system takes it all back then


def _arrays_of(mesh: Any) -> Tuple[Any, Any]:
    """Vertices and triangles of another library's mesh, by its names for them."""
    for points, corners in (("vertices", "faces"), ("vertices", "triangles"), ("points", "cells_dict")):
        if hasattr(mesh, points) and hasattr(mesh, corners):
            found = getattr(mesh, corners)
            if corners == "cells_dict":  # points and lines bound nothing
                if set(found) - {"vertex", "line"} != {"triangle"}:
                    raise face.UsageError(f"it has cells of {', '.join(sorted(found))}: triangles alone are wanted")
                found = found["triangle"]
            return np.asarray(getattr(mesh, points)), np.asarray(found)
    raise face.UsageError(f"a {type(mesh).__name__} is no mesh: give vertices [n, 3] and triangles [m, 3]")


class Mesh(Made):
    """Triangles, closed or not: `vertices` [n, 3], and `triangles` [m, 3] that name three of them each,
    counter-clockwise seen from outside; or, alone, an object that has them: a mesh of trimesh (vertices, faces), Open3D
    (vertices, triangles) or meshio (points, cells of triangles). Equal positions are merged, and triangles that
    then repeat a vertex dropped, so numbers may differ from the caller's. It does not change, and may be read by
    several threads."""

    _free = "sb_mesh_free"

    def __init__(self, vertices: Any, triangles: Optional[ArrayLike] = None) -> None:
        if triangles is None:
            vertices, triangles = _arrays_of(vertices)
        x = face.array(vertices, np.float64, "vertices", None, 3)
        corners = face.array(triangles, np.int32, "triangles", None, 3)
        self._take("sb_mesh_make", len(x), face.pointer(x), len(corners), face.pointer(corners))

    @classmethod
    def load(cls, path: Union[str, "os.PathLike[str]"], *, seconds: float = 0, megabytes: float = 0) -> "Mesh":
        """Reads OBJ, PLY, STL, OFF, glTF and GLB, also compressed (.gz): polygons are triangulated, equal positions merged.
        A warning says how much else the file holds. Other formats are read where the library has Assimp, which the wheel's
        has not, in a child process within these limits; 0: 20 s and one more for each MB of the file, 4096 MB."""
        limits = face.params("sb_load_params", [("seconds", seconds), ("megabytes", megabytes)], {})
        made = cls.__new__(cls)
        made._take("sb_mesh_load", face.chars(os.fspath(path), "path"), ctypes.byref(limits))
        if left_out := made.facts().left_out:
            warnings.warn(f"{path}: {left_out} points, lines, curves or scenes are left out", stacklevel=2)
        return made

    @classmethod
    def shape(cls, name: str) -> "Mesh":
        """A procedural model, "penguin" for instance (shapes() lists them): closed, one unit a metre, y up."""
        made = cls.__new__(cls)
        made._take("sb_mesh_shape", face.chars(name, "name"))
        return made

    def facts(self) -> MeshFacts:
        """Counts, bounding box, volume, and what is wrong with it. O(triangles)."""
        values = face.filled("sb_mesh_facts", "sb_mesh_measure", self._handle)
        return MeshFacts(**values)

    def __repr__(self) -> str:
        facts = self.facts()
        watertight = "watertight" if facts.watertight else "not watertight"
        return f"<Mesh: {facts.vertices} vertices, {facts.triangles} triangles, {watertight}>"

    @property
    def vertices(self) -> NDArray[np.float64]:
        """[n, 3], a copy."""
        values = np.empty((self.facts().vertices, 3))
        face.call("sb_mesh_read_vertices", self._handle, face.pointer(values), len(values))
        return values

    @property
    def triangles(self) -> NDArray[np.int32]:
        """[m, 3], a copy."""
        values = np.empty((self.facts().triangles, 3), np.int32)
        face.call("sb_mesh_read_triangles", self._handle, face.pointer(values), len(values))
        return values


class Voxels(Made):
    """Material on a lattice of cubic cells (fastlsm section 2): every cell that a triangle of the mesh touches, and of
    a "solid" what they enclose; of a "shell" only these. One of `cell`, an edge's length, and `particles`, wanted
    vertices of material cells, must be given; with `fewer`, fewer will do where so many take too large a lattice. They
    do not change, and may be read by several threads."""

    _free = "sb_voxels_free"

    def __init__(self, mesh: Mesh, *, cell: Optional[float] = None, particles: Optional[int] = None,
                 fill: str = "solid", fewer: bool = False) -> None:
        how = face.params("sb_voxel_params", [("fill", fill), ("cell", cell), ("particles", particles),
                                              ("fewer", int(fewer))], {"fill": "SB_SOLID"})
        self._take("sb_voxels_of_mesh", Mesh._of(mesh, "mesh"), ctypes.byref(how))

    @classmethod
    def from_cells(cls, filled: ArrayLike, cell: float, origin: ArrayLike = (0, 0, 0)) -> "Voxels":
        """Material in the cells [z, y, x] that are not 0; `origin` is the corner of cell (0, 0, 0)."""
        given = np.asarray(filled)
        if given.ndim != 3:
            raise face.UsageError(f"'filled' has the shape {given.shape}: cells [z, y, x] are wanted")
        material = np.ascontiguousarray(given != 0).view(np.uint8)
        corner = face.array(origin, np.float64, "origin", 3)
        cells = np.array(material.shape[::-1], np.int32)
        made = cls.__new__(cls)
        made._take("sb_voxels_make", face.pointer(cells), cell, face.pointer(corner), face.pointer(material))
        return made

    def __repr__(self) -> str:
        facts = self.facts()
        return f"<Voxels: {facts.material} cells of {facts.cell:g}, {facts.particles} particles>"

    def facts(self) -> VoxelFacts:
        """Sizes, and how the inside was found."""
        values = face.filled("sb_voxel_facts", "sb_voxels_measure", self._handle)
        return VoxelFacts(**values)

    def cells(self) -> NDArray[np.uint8]:
        """[z, y, x]: 1 where there is material."""
        values = np.empty(self.facts().cells[::-1], np.uint8)
        face.call("sb_voxels_read_cells", self._handle, face.pointer(values), values.size)
        return values

    def particles(self) -> NDArray[np.float64]:
        """[n, 3]: rest positions of the lattice's vertices at material, in the order z, y, x with x fastest: the
        particles of FastLSM, and what Body's `mass` is given for."""
        values = np.empty((self.facts().particles, 3))
        face.call("sb_voxels_read_particles", self._handle, face.pointer(values), len(values))
        return values

    def masses(self, density: float) -> NDArray[np.float64]:
        """[n]: what these particles weigh if each has an eighth of every material cell at it, kg; `density` is in kg per
        unit of volume."""
        values = np.empty(self.facts().particles)
        face.call("sb_voxels_weigh", self._handle, density, face.pointer(values), len(values))
        return values
