"""Deformable bodies by shape matching: fast lattice shape matching (Rivers and James 2007), octree shape matching
(Steinemann, Otaduy and Gross 2008), their double-precision reference, and meshless elastic solids and thin shells (Guo and
Qin 2009).

    import shapebench as sb

    mesh = sb.load("my.obj")  # or sb.Mesh.shape("penguin")
    motion = sb.simulate(mesh, w=3, gravity=(0, -9.81, 0), pins=lambda rest: rest[:, 1] < 0.1, steps=100)
    motion.plot()

    with sb.Body(sb.Voxels(mesh, particles=2000), mesh, engine="octree") as body:  # step by step
        body.step(100)
        print(body.surface())

Lengths are the mesh's, whatever they are; seconds, kilograms, radians. Arrays are NumPy's: what is passed in is copied
by the library, without another copy on the way if it is C-contiguous and of float64 (particles int64, triangles int32).
What the library refuses raises UsageError (a ValueError) or InputError, both Error, with the library's own line.
shapebench.results reads the files that the program shapebench writes."""

from . import export, results
from .body import (Blade, Body, Counts, Criterion, Detail, Handle, LocalWidth, MeshlessParams, Obstacle, OctreeParams,
                   ShellParams, engines, pose)
from .face import Error, InputError, UsageError, version as __version__
from .geometry import Mesh, MeshFacts, VoxelFacts, Voxels, shapes
from .simulate import Motion, simulate

load = Mesh.load

__all__ = ["Blade", "Body", "Counts", "Criterion", "Detail", "Error", "Handle", "InputError", "LocalWidth", "Mesh",
           "MeshFacts", "MeshlessParams", "Motion", "Obstacle", "OctreeParams", "ShellParams", "UsageError",
           "VoxelFacts", "Voxels", "__version__", "engines", "export", "load", "pose", "results", "shapes", "simulate"]
