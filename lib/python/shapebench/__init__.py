"""Deformable bodies by shape matching: fast lattice shape matching (Rivers and James 2007), octree shape matching
(Steinemann, Otaduy and Gross 2008), their double-precision reference, and meshless elastic solids and thin shells (Guo and
Qin 2009).

    import shapebench as sb

    mesh = sb.Mesh.shape("penguin")
    voxels = sb.Voxels(mesh, particles=2000)
    with sb.Body(voxels, mesh, gravity=(0, -9.81, 0)) as body:
        body.hold(body.select_box(*feet))
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

__all__ = ["Blade", "Body", "Counts", "Criterion", "Detail", "Error", "Handle", "InputError", "LocalWidth", "Mesh",
           "MeshFacts", "MeshlessParams", "Obstacle", "OctreeParams", "ShellParams", "UsageError", "VoxelFacts", "Voxels",
           "__version__", "engines", "export", "pose", "results", "shapes"]
